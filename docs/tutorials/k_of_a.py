"""A table K(a): the stress intensity factor of an edge crack by its length, with error bars, against a handbook.

Run it with python3. Programs for fatigue lives read such tables.
"""

import math

import kerf

WIDTH = 1.0
CASE = """
[domain]
outline = [[0, -1.5], [1, -1.5], [1, 1.5], [0, 1.5]]
sides   = ["bottom", "right", "top", "left"]

[[crack]]
name = "c"
path = [[0, 0], [0.1, 0]]       # from the side into the strip: its end is the tip

[material]
young   = 200e3
poisson = 0.3

[[boundary]]
on = ["bottom", "top"]
traction = [0, "ny"]

[mesh]
size = 0.2
"""


def handbook(a):
    """K of an edge crack in a strip that is pulled by 1 (polynomial of Brown and Srawley, within 0.5 %
    up to a = 0.6 widths)."""
    r = a / WIDTH
    return math.sqrt(math.pi * a) * (1.122 - 0.231 * r + 10.55 * r**2 - 21.72 * r**3 + 30.39 * r**4)


def intensity(a):
    """K and half the width of the interval in which the truth is expected."""
    tip = kerf.Case(CASE, set={"crack.c.path": [[0, 0], [a, 0]]}).solve().cracks["c"].tips["end"]
    return tip.K_I, tip.margin.K_I


if __name__ == "__main__":
    print("   a       K_I   +-         handbook")
    table = []
    for a in (0.1, 0.2, 0.3, 0.4, 0.5):
        K, margin = intensity(a)
        table.append((a, K))
        print(f"{a:4} {K:10.5f}   {margin:.1e}  {handbook(a):8.4f}")
        assert abs(K / handbook(a) - 1) < 0.006

    # The table as a function: between its rows K/sqrt(pi a) is smooth.
    def interpolated(a):
        (a0, K0), (a1, K1) = next(pair for pair in zip(table, table[1:]) if pair[0][0] <= a <= pair[1][0])
        F0, F1 = K0 / math.sqrt(math.pi * a0), K1 / math.sqrt(math.pi * a1)
        return math.sqrt(math.pi * a) * (F0 + (F1 - F0) * (a - a0) / (a1 - a0))

    # How many cycles from 0.1 to 0.5 by Paris' law da/dN = C dK^3? Midpoint rule in steps of 0.005.
    C, step = 1e-4, 0.005
    cycles = sum(step / (C * interpolated(0.1 + (k + 0.5) * step) ** 3) for k in range(80))
    print(f"{cycles:.0f} cycles from a = 0.1 to a = 0.5")
    exact = sum(step / (C * handbook(0.1 + (k + 0.5) * step) ** 3) for k in range(80))
    assert abs(cycles / exact - 1) < 0.06
