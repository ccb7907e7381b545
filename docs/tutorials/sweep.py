"""A crack that moves through a plate: its stress intensity factors by one sweep, the map of one of them as arrays.

Run it with python3; it makes the folder crack_sweep and the picture map.png where it stands.
"""

import kerf

# 1. The case: a dict with the tables and keys of a case file. A function of Python may stand where a file has an
#    expression: here the traction that pulls at the top and the bottom, growing to the right.
plate = {
    "title": "A plate that is pulled more on the right",
    "domain": {"outline": [[-1, -1], [1, -1], [1, 1], [-1, 1]], "sides": ["bottom", "right", "top", "left"]},
    "crack": [{"name": "c", "path": [[-0.3, 0], [0.3, 0]]}],
    "material": {"young": 1000, "poisson": 0.3, "state": "plane stress"},
    "boundary": [{"on": ["bottom", "top"], "traction": [0, lambda x, y, nx, ny: ny * (1 + 0.5 * x)]}],
    "mesh": {"size": 0.15},
    "map": {"perturbation": "hole"},
}

# 2. One run. Numbers are those of result.json, fields are arrays of numpy at the corners of the triangles.
result = kerf.Case(plate).run()
print(result.summary())
K_I = [tip["K_I"] for tip in result["cracks"][0]["tips"]]
print(f"K_I at the left tip {K_I[0]:.4f}, at the right tip {K_I[1]:.4f}")
assert K_I[1] > K_I[0] > 0  # the right side is pulled more
print("the largest opening is", result.crack("c")["jump_n"].max())

# 3. A picture with matplotlib, if that is installed.
try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError:
    print("no picture: matplotlib is not installed")
else:
    figure, axes = plt.subplots()
    colors = axes.tripcolor(result.triangulation(), result.topological_derivative, shading="gouraud")
    figure.colorbar(colors, label="topological derivative")
    axes.set_aspect("equal")
    figure.savefig("map.png")
    plt.close(figure)

# 4. The sweep: three places of the crack and two values of Poisson's ratio. A run each, in folders of their own; the
#    same lines again find all of them done.
sweep = kerf.sweep(
    plate,
    {
        "crack.c.path": [[[x - 0.3, 0], [x + 0.3, 0]] for x in (-0.4, 0.0, 0.4)],
        "material.poisson": [0.2, 0.4],
    },
    folder="crack_sweep",
    set={"output": {"png": False, "vtk": False}},
)
print(sweep.summary())
assert not sweep.failures
right = sweep.column("cracks.c.tips[1].K_I")
for row in sweep.rows:
    print(row["run"], row["cracks.c.tips[1].K_I"])
assert right[0] < right[2] < right[4]  # farther right, more load
