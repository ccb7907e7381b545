"""A parameter study: how much a hole concentrates the stress, by its radius, on two processes.

Run it with python3. Cases and results are sent between processes, so each worker returns a whole result.
"""

import concurrent.futures
import multiprocessing

import kerf

# Largest stress over the pull at the ends, of a long strip of width 2 (the exact solution of Howland, to three digits).
HOWLAND = {0.1: 3.03, 0.2: 3.14, 0.3: 3.36, 0.4: 3.74}

strip = kerf.Case({
    "domain": {"outline": [[-1, -3], [1, -3], [1, 3], [-1, 3]], "sides": ["bottom", "right", "top", "left"]},
    "hole": [{"name": "h", "circle": {"center": [0, 0], "radius": 0.3}}],
    "material": {"young": 1000.0, "poisson": 0.3, "state": "plane stress"},
    "boundary": [{"on": ["bottom", "top"], "traction": [0, "ny"]}],
    "mesh": {"size": 0.3},
    "output": {"margins": True},
}, name="strip")


def with_radius(radius):
    """A copy of the case with another hole. Tables of a case are read and changed like dicts."""
    case = kerf.Case(strip)
    case["hole"]["h"]["circle"]["radius"] = radius
    case["mesh"]["size"] = min(0.1, radius / 2)
    return case


def solved(case):
    return case.solve(threads=1)


if __name__ == "__main__":  # spawned processes import this file
    radii = list(HOWLAND)
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        results = list(pool.map(solved, map(with_radius, radii)))

    print("radius  largest stress  +-        Howland")
    for radius, result in zip(radii, results):
        peak = result["state"]["max_von_mises"]
        print(f"{radius:6} {peak['value']:12.4f}     {peak['margin']:.4f} {HOWLAND[radius]:10}")
        assert abs(peak["value"] / HOWLAND[radius] - 1) < 0.01
    print(results[0])

    # A line of points across the ligament: values between corners, also of a result from another process.
    line = results[2].at([[0.3 + 0.7 * k / 10, 0] for k in range(11)])
    print(line.stress[:, 3].round(3))
    assert line.stress[0, 3] > line.stress[-1, 3] > 0
