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
