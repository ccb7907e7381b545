"""Small cases that the tests share."""


def plate(size=0.25):
    return {
        "domain": {"outline": [[0, 0], [1, 0], [1, 1], [0, 1]], "sides": ["bottom", "right", "top", "left"]},
        "crack": [{"name": "c", "path": [[0.3, 0.5], [0.7, 0.5]]}],
        "material": {"young": 1.0, "poisson": 0.3},
        "boundary": [{"on": ["bottom", "top"], "traction": [0, "ny"]}],
        "mesh": {"size": size},
        "map": {"perturbation": "hole"},
    }


def beam_with_a_hole(**of_hole):
    """The compliance of a beam by the place and the radius of a hole."""
    return {
        "domain": {"outline": [[0, 0], [2, 0], [2, 1], [0, 1]], "sides": ["bottom", "right", "top", "left"]},
        "material": {"young": 1.0, "poisson": 0.3},
        "boundary": [{"on": "left", "displacement": [0, 0]}, {"on": "right", "traction": [0, -1]}],
        "mesh": {"size": 0.25},
        "functional": {"kind": "compliance"},
        "optimize": {"method": "mma", "volume": {"at_most": 0.99}, "max_iterations": 4, "hole": [
            {**of_hole, "circle": {"center": [[0.5, 1.5], [0.3, 0.7]], "radius": [0.1, 0.2]},
             "start": {"center": [1.0, 0.5], "radius": 0.15}}]},
    }
