import meshio, numpy as np
nx, ny = 20, 12
xs, ys = np.linspace(-1, 1, nx + 1), np.linspace(-0.6, 0.6, ny + 1)
points = [(x, y, 0.0) for y in ys for x in xs]
at = lambda i, j: j * (nx + 1) + i
triangles = []
for j in range(ny):
    for i in range(nx):
        a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
        triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
sides = {1: [(at(i, 0), at(i + 1, 0)) for i in range(nx)], 2: [(at(nx, j), at(nx, j + 1)) for j in range(ny)],
         3: [(at(i + 1, ny), at(i, ny)) for i in range(nx)], 4: [(at(0, j + 1), at(0, j)) for j in range(ny)],
         5: [(at(i, 6), at(i + 1, 6)) for i in range(5, 14)]}
lines = [e for k in sides for e in sides[k]]
groups = np.array([k for k in sides for e in sides[k]], dtype=np.int32)
one = np.ones(len(triangles), dtype=np.int32)
m = meshio.Mesh(points, [("line", lines), ("triangle", triangles)],
    cell_data={"gmsh:physical": [groups, one], "gmsh:geometrical": [groups, one]},
    field_data={"bottom": np.array([1, 1]), "right": np.array([2, 1]), "top": np.array([3, 1]), "left": np.array([4, 1]),
                "crack:c": np.array([5, 1]), "body": np.array([1, 2])})
meshio.write("meshio.msh", m, file_format="gmsh22", binary=False)
