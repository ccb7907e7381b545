"""What a job leaves: numbers, fields, files."""

import html
import json
import pathlib

import numpy


class Result:
    """The numbers of result.json as a dict, and the fields behind them as arrays of numpy.

    Fields live at corners: a vertex on a crack has a corner on either side, so that what jumps there does. Arrays are
    windows into the memory of the result, which they keep alive; they cannot be written to.

    ============================ ========= ==================================================
    ``points``, ``triangles``    (n,2) (m,3) the mesh
    ``corner_points``            (k,2)     where fields are known
    ``corner_triangles``         (m,3)     the same triangles, by numbers of corners
    ``corner_vertex``            (k,)      the point of every corner
    ``displacement``             (k,2)
    ``stress``                   (k,4)     s11, s12, s21, s22
    ``rotation``, ``von_mises``  (k,)
    ``error_indicator``          (m,)      per triangle; not with ``output.estimate = false``
    ``topological_derivative``   (k,)      with a map everywhere; also ``masked``, where the expansion cannot hold
    ``lower``, ``upper``         (k,)      with bounds of the map
    ============================ ========= ==================================================
    """

    def __init__(self, outcome, folder):
        self._outcome = outcome
        self.folder = pathlib.Path(folder)
        self.numbers = json.loads((self.folder / "result.json").read_text())
        self._arrays = outcome.arrays()

    @property
    def status(self):
        """"ok", or why not: "not converged", "infeasible", "failed"; then ``reason`` says more."""
        return self._outcome.status

    @property
    def reason(self):
        return self._outcome.reason

    def __getitem__(self, section):
        return self.numbers[section]

    def __contains__(self, section):
        return section in self.numbers

    def __getattr__(self, name):
        arrays = self.__dict__.get("_arrays", {})
        if name in arrays:
            return arrays[name]
        raise AttributeError(f"this result has no {name!r}; it has {', '.join(arrays)}")

    def __dir__(self):
        return [*super().__dir__(), *self._arrays]

    def __repr__(self):
        return f"<kerf.Result {self.numbers['case']!r}: {self.status}>"

    def summary(self):
        """What the program prints at the end."""
        return self._outcome.summary()

    def crack(self, name):
        """Along a crack, in the order of its path: ``s``, ``at``, ``jump_n``, ``jump_t``, ``sigma_n``, ``sigma_t``,
        ``fluid_pressure``, ``gap``, ``closed``, each an array."""
        return self._outcome.crack(name)

    def page(self):
        """The report as HTML."""
        return (self.folder / "report.html").read_text()

    def _repr_html_(self):
        if not (self.folder / "report.html").exists():
            return f"<pre>{html.escape(self.summary())}</pre>"
        page = html.escape(self.page(), quote=True)
        return f'<iframe sandbox="allow-scripts" srcdoc="{page}" style="width: 100%; height: 40em; border: 0"></iframe>'

    def triangulation(self, scale=0):
        """For matplotlib: ``plt.tripcolor(r.triangulation(), r.von_mises)``. ``scale`` times the displacement
        deforms it."""
        from matplotlib.tri import Triangulation

        at = self.corner_points + scale * self.displacement
        return Triangulation(at[:, 0], at[:, 1], self.corner_triangles)

    def _at_corners(self):
        names = ("displacement", "stress", "rotation", "von_mises", "topological_derivative", "masked", "lower", "upper")
        return {name: self._arrays[name] for name in names if name in self._arrays}

    def _on_triangles(self):
        return {name: self._arrays[name] for name in ("error_indicator",) if name in self._arrays}

    def to_meshio(self):
        """A meshio.Mesh with the fields."""
        import meshio

        points = numpy.column_stack([self.corner_points, numpy.zeros(len(self.corner_points))])
        data = {name: numpy.array(a, dtype=float) for name, a in self._at_corners().items()}
        data["displacement"] = numpy.column_stack([data["displacement"], numpy.zeros(len(points))])
        cells = {name: [numpy.array(a)] for name, a in self._on_triangles().items()}
        return meshio.Mesh(points, [("triangle", numpy.array(self.corner_triangles))], point_data=data, cell_data=cells)

    def to_vtk(self):
        """A vtkUnstructuredGrid with the fields."""
        from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import VTK_TRIANGLE, vtkCellArray, vtkUnstructuredGrid

        grid, points, cells = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
        at = numpy.column_stack([self.corner_points, numpy.zeros(len(self.corner_points))])
        points.SetData(numpy_to_vtk(at, deep=True))
        count = len(self.corner_triangles)
        offsets = numpy.arange(0, 3 * count + 1, 3, dtype=numpy.int64)
        cells.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True),
                      numpy_to_vtkIdTypeArray(self.corner_triangles.astype(numpy.int64).ravel(), deep=True))
        grid.SetPoints(points)
        grid.SetCells(VTK_TRIANGLE, cells)
        for name, values in self._at_corners().items():
            _add(grid.GetPointData(), name, numpy_to_vtk(numpy.array(values, dtype=float), deep=True))
        for name, values in self._on_triangles().items():
            _add(grid.GetCellData(), name, numpy_to_vtk(numpy.array(values), deep=True))
        return grid


def _add(data, name, values):
    values.SetName(name)
    data.AddArray(values)
