"""The mesh of a case."""


class Mesh:
    # Docstrings of what users see stand in __init__.pyi (_documented.py).

    def __init__(self, points, triangles, labels, cracks, regions):
        self.points, self.triangles = points, triangles
        self.labels, self.cracks, self.regions = labels, cracks, regions

    def __repr__(self):
        return f"<kerf.Mesh: {len(self.triangles)} triangles, {len(self.points)} points, sides {', '.join(self.labels)}>"

    def triangulation(self):
        from ._plot import matplotlib_triangulation

        return matplotlib_triangulation(self.points, self.triangles)

    def plot(self, ax=None):
        from ._plot import plot_mesh

        return plot_mesh(self, ax)
