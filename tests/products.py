#!/usr/bin/env python3
"""products.py < LOG > docs/validation/products.md: the page of what `test_truth --gtest_filter='Drawn/ProductScene.*'`
said of every scene: cells, drawn, refused by name, open, and the worst, by perturbation and by load."""
import re
import sys
from collections import defaultdict

ROW = re.compile(r"^(\w+) / (\w+) / (\w+) / (\w+): (\d+) cells, (\d+) drawn, (\d+) refused, (\d+) open, (\d+) noted, "
                 r"(\d+) off, worst (\S+) \((?:.* / (\w+))?\)$")
REFUSED = re.compile(r"^  refused (\d+) times: (.*)$")
HEAD = """# Products of topological derivatives

Every perturbation under every load, in a state (plane strain, plane stress, thickness 5, orthotropic) and at a place (away
from all, beside a jump, beside a crack) that a seed draws, in {functionals} functionals. What the map says at a point is compared with
bodies that are drawn with the tables a person would write for the change, at three radii, on the mesh of the unchanged body,
extrapolated to radius 0. A cell is *drawn* where that is known to a tenth, else *open*, or *refused* by the program with a
sentence. *Worst* is the largest relative error of a drawn cell beyond what the radii leave open; up to 1 % is right. *Noted*
cells are off by up to 5 % where the program says so: clamped holes that move the contact of a crack. These are {scenes}
scenes. Written by

    build/test_truth --gtest_filter='Drawn/ProductScene.*' | python3 tests/products.py > docs/validation/products.md

"""


def main() -> None:
    by = {"perturbation": defaultdict(list), "load": defaultdict(list), "functional": defaultdict(float)}
    refusals: dict = defaultdict(int)
    rows = []
    for line in sys.stdin:
        line = line.rstrip("\n")
        if found := ROW.match(line):
            p, load, state, place, *numbers, worst, at = found.groups()
            row = (*map(int, numbers), float(worst), f"{at}, {load}, {state}, {place}" if at else "", p)
            rows.append(row)
            by["perturbation"][p].append(row)
            by["load"][load].append(row)
        elif found := REFUSED.match(line):
            refusals[found[2]] += int(found[1])
    if not rows:
        sys.exit("products.py: no scene in what was read")
    print(HEAD.format(functionals=max(r[0] for r in rows), scenes=len(rows)), end="")
    for what in ("perturbation", "load"):
        print(f"## By {what}\n\n| {what} | scenes | cells | drawn | refused | open | noted | off | worst | where |\n"
              "|---|---|---|---|---|---|---|---|---|---|")
        for name, some in [*by[what].items(), ("**all**", rows)]:
            sums = [sum(r[k] for r in some) for k in range(6)]
            worst = max(some, key=lambda r: r[6])
            where = worst[7] if what == "perturbation" and name != "**all**" else f"{worst[8]}, {worst[7]}"
            tail = f"{100 * worst[6]:.2g} % | {where}" if sums[1] else " | "
            print(f"| {name.replace('_', ' ')} | {len(some)} | {' | '.join(map(str, sums))} | {tail.replace('_', ' ')} |")
        print()
    print("## What is refused\n\n| cells | sentence (its beginning) |\n|---|---|")
    for why, times in sorted(refusals.items(), key=lambda item: (-item[1], item[0])):
        print(f"| {times} | {why.replace('|', ' ')} |")


if __name__ == "__main__":
    main()
