#!/usr/bin/env python3
"""The researcher's tutorial as a script: rates, an objective of one's own, its validation. Takes about ten seconds."""

import numpy as np

import kerf

# [rates]
# A field with a known solution: u is the gradient of exp(x) cos(y), so it has no divergence, and its stress is in
# equilibrium without a body force.
YOUNG, POISSON = 1.0, 0.3
MU = YOUNG / (2 * (1 + POISSON))


def exact_stress(x, y):
    """s11, s12, s21, s22."""
    a, b = 2 * MU * np.exp(x) * np.cos(y), -2 * MU * np.exp(x) * np.sin(y)
    return np.stack([a, b, b, -a], axis=-1)


def smooth_case(size, degree):
    return kerf.Case({
        "domain": {"outline": [[0, 0], [1, 0], [1, 1], [0, 1]], "sides": ["a", "b", "c", "d"]},
        "material": {"young": YOUNG, "poisson": POISSON},
        "boundary": [{"on": ["a", "b", "c", "d"],
                      "displacement": [lambda x, y: np.exp(x) * np.cos(y), lambda x, y: -np.exp(x) * np.sin(y)]}],
        "mesh": {"size": size},
        "solver": {"element": "bdms", "degree": degree},
    })


def stress_error(result):
    """Relative, in L2: the mean over the corners of each triangle, weighted by its area."""
    corners = result.corner_points[result.corner_triangles]
    (ax, ay), (bx, by) = ((corners[:, i] - corners[:, 0]).T for i in (1, 2))
    area = (ax * by - ay * bx) / 2
    exact = exact_stress(corners[..., 0], corners[..., 1])
    difference = ((result.stress[result.corner_triangles] - exact) ** 2).sum(axis=2).mean(axis=1)
    return np.sqrt(area @ difference / (area @ (exact ** 2).sum(axis=2).mean(axis=1)))


def rates():
    print("degree   size      error   rate")
    last = {}
    for degree in (1, 2, 3):
        errors = []
        for size in (0.2, 0.1, 0.05):
            errors.append(stress_error(smooth_case(size, degree).solve()))
            rate = f"{np.log2(errors[-2] / errors[-1]):6.2f}" if len(errors) > 1 else ""
            print(f"{degree:6} {size:6} {errors[-1]:10.2e} {rate}")
        last[degree] = np.log2(errors[-2] / errors[-1])
    return last
# [end of rates]


# [own]
# How far does the upper left corner of a cracked plate move? The weight is a function of ours.
def corner(x, y):
    return np.exp(-4 * ((x + 1.5) ** 2 + (y - 1.5) ** 2))


plate = {
    "domain": {"outline": [[-2, -2], [2, -2], [2, 2], [-2, 2]], "sides": ["bottom", "right", "top", "left"]},
    "crack": [{"name": "c", "path": [[-1, 0], [1, 0]]}],
    "material": {"young": 1000, "poisson": 0.3},
    "boundary": [{"on": "bottom", "displacement": [0, 0]}, {"on": "top", "traction": [0, "0.1 + x"]}],
    "mesh": {"size": 0.15, "crack_tip_size": 0.004},
    "functional": {"kind": "displacement_tracking", "target": [0, 0], "weight": corner},
    "map": {"perturbation": "hole"},
}


def own_functional():
    result = kerf.Case(plate).map()
    worst = result["map"]["max"]
    print(f"J = {result['functional']['value']:.4g}; a hole costs most at {worst['at']}: {worst['value']:.3g} per area")
    return result
# [end of own]


# [validate]
# Is that map right? Holes of five radii are made at a point, and the plate is solved each time.
def validation():
    case = kerf.Case(plate | {"validate": {"points": [[0.2, 0.9]], "radii": {"largest": 0.16, "ratio": 0.5, "count": 5}}})
    point = case.validate()["validate"][0]
    print(point["verdict"] + ":", point["reason"])
    for row in point["rows"]:
        print(f"radius {row['radius']:<6} difference {row['difference']:10.3e} predicted {row['predicted']:10.3e}")
    return point["verdict"]
# [end of validate]


if __name__ == "__main__":
    found = rates()
    assert all(found[degree] > degree + 0.8 for degree in found), found
    own_functional()
    assert validation() == "holds"
