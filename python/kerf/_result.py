"""What a job leaves: numbers, fields, files."""

import html
import json
import math
import os
import pathlib
import tomllib

import numpy

from . import _kerf
from ._errors import CaseError, FilesError
from ._functions import functions_in, put_back
from ._missing import needed
from ._plot import matplotlib_triangulation, plot
from ._read_fields import read_fields
from ._values import at_corners, values_at
from ._views import Named, Section, brief, viewed


class Tip(Section):
    # Docstrings of what users see stand in __init__.pyi (_documented.py).

    def __init__(self, name, numbers):
        super().__init__(numbers)
        self.name = name

    def __repr__(self):
        known = [f"{one} {brief(self[one])}" for one in ("K_I", "K_II", "G") if self.get(one) is not None]
        x, y = self["at"]
        return f"<kerf.Tip {self.name!r} at ({x:.4g}, {y:.4g}): {', '.join(known) or self.get('note', 'no K')}>"


class Crack(Section):
    def __init__(self, numbers, profile):
        super().__init__(numbers)
        self.profile = profile
        self.tips = Named(Tip(name, tip) for name, tip in zip(self._ends(), numbers.get("tips", [])))

    def _ends(self):
        tips = self._numbers.get("tips", [])
        if len(tips) != 1 or len(self.profile.get("at", ())) == 0:
            return "start", "end"
        from_start, from_end = (numpy.hypot(*(self.profile["at"][k] - tips[0]["at"])) for k in (0, -1))
        return ("start",) if from_start <= from_end else ("end",)

    def __getattr__(self, name):
        profile = self.__dict__.get("profile", {})
        return profile[name] if name in profile else super().__getattr__(name)

    def __dir__(self):
        return [*super().__dir__(), *self.profile]

    def __repr__(self):
        opening = f", opens by {brief(self['max_opening'])}" if "max_opening" in self else ""
        tips = "; ".join(f"{tip.name} K_I {brief(tip['K_I'])}" for tip in self.tips if tip.get("K_I") is not None)
        return f"<kerf.Crack {self['name']!r}: length {brief(self['length'])}{opening}{'; ' if tips else ''}{tips}>"


class Result:
    def __init__(self, outcome, folder, *, case=None, arrays=None, loaded=False, why_no_fields=None):
        self._outcome = outcome
        self.folder = pathlib.Path(folder)
        self.numbers = json.loads((self.folder / "result.json").read_text())
        self._arrays = outcome.arrays() if arrays is None else arrays
        self._loaded, self._why_no_fields = loaded, why_no_fields
        self._functions = functions_in(case.document()) if case is not None and case.has_functions else {}
        self._kept = {"status": outcome.status, "reason": outcome.reason,
                      "profiles": {name: outcome.crack(name) for name in outcome.crack_names}}

    def __getstate__(self):
        """Numbers, arrays and designs: what another process can have. The solution itself stays behind."""
        state = dict(self.__dict__, _outcome=None, _functions={}, _kept=dict(self._kept, summary=self.summary()))
        state["_designs"] = {name: self._case_in(name) for name in ("design.toml", "grown.toml")
                             if not self._functions and self._has(name)}
        return state

    @property
    def status(self):
        return self._kept["status"]

    @property
    def reason(self):
        return self._kept["reason"]

    def __getitem__(self, section):
        return self.numbers[section]

    def __contains__(self, section):
        return section in self.numbers

    def __getattr__(self, name):
        arrays = self.__dict__.get("_arrays", {})
        if name in arrays:
            return arrays[name]
        why = self.__dict__.get("_why_no_fields")
        raise AttributeError(f"this result has no {name!r}; {why or 'it has ' + ', '.join(arrays)}")

    def __dir__(self):
        return [*super().__dir__(), *self._arrays]

    def __repr__(self):
        parts = []
        if "mesh" in self.numbers:
            parts.append(f"{self.numbers['mesh']['triangles']} triangles")
        state = self.numbers.get("state", {})
        if "unknowns" in state:
            parts.append(f"{state['unknowns']} unknowns")
        tips = [(math.hypot(tip["K_I"], tip["K_II"]), tip["K_I"], tip["K_II"], f"{crack.name}:{tip.name}")
                for crack in self.cracks for tip in crack.tips if None not in (tip.get("K_I"), tip.get("K_II"))]
        if tips:
            _, K_I, K_II, where = max(tips)
            parts.append(f"K_I {brief(K_I)} and K_II {brief(K_II)} at {where}")
        peak = state.get("max_von_mises")
        if peak:
            parts.append(f"von Mises up to {brief(peak.get('regular', peak)['value'])}")
        if "optimize" in self.numbers:
            parts.append(f"objective {brief(self.numbers['optimize']['objective'])}")
        origin = f" loaded from {os.fspath(self.folder)!r}" if self._loaded else ""
        return f"<kerf.Result {self.numbers['case']!r}{origin}: {', '.join([self.status, *parts])}>"

    def summary(self):
        return self._outcome.summary() if self._outcome is not None else self._kept["summary"]

    @property
    def cracks(self):
        return Named(Crack(crack, self._kept["profiles"].get(crack["name"], {}))
                     for crack in self.numbers.get("cracks", []))

    @property
    def load_cases(self):
        cases = self.numbers.get("load_cases", [])
        return viewed(cases) if cases else Named()

    def crack(self, name):
        return self._kept["profiles"][name]

    def _fields(self):
        if self._why_no_fields:
            raise FilesError(self._why_no_fields)
        return self._arrays

    def at(self, points):
        return values_at(points, self._outcome, self._fields())

    def _has(self, name):
        return (self.folder / name).exists()

    def _case_in(self, name):
        from ._case import Case

        if name in self.__dict__.get("_designs", {}):
            return self._designs[name].__copy__()
        if not self._functions:
            try:
                return Case(self.folder / name)
            except CaseError as error:
                if '"function ' not in str(error):
                    raise
                raise CaseError(f"{self.folder / name} was made with functions of Python, of which files and copies of a "
                                "result have the names alone; ask the result of the run itself") from error
        document = tomllib.loads((self.folder / name).read_text(encoding="utf-8"))
        return Case(put_back(document, self._functions), name=pathlib.Path(name).stem, folder=self.folder.absolute())

    def _case_or_sentence(self, name, what):
        if name in self.__dict__.get("_designs", {}) or self._has(name):
            return self._case_in(name)
        raise CaseError(what)

    @property
    def design(self):
        return self._case_or_sentence("design.toml", "this result has no design: optimize() makes one, or run() of a case "
                                                     "with a table [optimize]")

    @property
    def grown(self):
        return self._case_or_sentence("grown.toml", "this result has no grown body: grow() makes one, or run() of a case "
                                                    "with a table [grow]")

    def page(self):
        if not self._has("report.html"):
            raise FilesError(f"{self.folder} has no report.html: output.html = false, or the folder has gone")
        return (self.folder / "report.html").read_text()

    def _repr_html_(self):
        if not self._has("report.html"):
            return f"<pre>{html.escape(self.summary())}</pre>"
        page = html.escape(self.page(), quote=True)
        return f'<iframe sandbox="allow-scripts" srcdoc="{page}" style="width: 100%; height: 40em; border: 0"></iframe>'

    def triangulation(self, scale=0):
        fields = self._fields()
        at = fields["corner_points"]
        return matplotlib_triangulation(at + scale * fields["displacement"] if scale else at, fields["corner_triangles"])

    def plot(self, field="von_mises", *, ax=None, scale=0.0, cmap=None, vmin=None, vmax=None, log=False, edges=False,
             colorbar=True):
        self._fields()  # a sentence where there are none
        return plot(self, field, ax=ax, scale=scale, cmap=cmap, vmin=vmin, vmax=vmax, log=log, edges=edges,
                    colorbar=colorbar)

    def _at_corners(self):
        return {name: self._fields()[name] for name in at_corners if name in self._arrays}

    def _on_triangles(self):
        return {name: self._arrays[name] for name in ("error_indicator",) if name in self._arrays}

    def _in_space(self):
        """Points, and fields at corners as floats: vectors of three, stresses as they are."""
        data = {name: numpy.array(values, dtype=float) for name, values in self._at_corners().items()}
        zeros = numpy.zeros(len(self.corner_points))
        data["displacement"] = numpy.column_stack([data["displacement"], zeros])
        return numpy.column_stack([self.corner_points, zeros]), data

    def to_pandas(self, table="fields"):
        from . import _tables

        if table == "fields":
            return _tables.field_table(self._fields()["corner_points"], self._at_corners())
        if table == "tips":
            return _tables.tip_table(self.cracks)
        if table == "load_cases":
            return _tables.flat_rows(self.numbers.get("load_cases", []))
        if table == "history" and self._has("history.csv"):
            return _tables.history_table(self.folder / "history.csv")
        if table in self._kept["profiles"]:
            rows = self.crack(table)
            flat = {"s": rows["s"], "x": rows["at"][:, 0], "y": rows["at"][:, 1]} if rows else {}
            flat.update({name: values for name, values in rows.items() if name not in ("s", "at")})
            return needed("pandas", "a table").DataFrame(flat)
        known = ["fields", "tips", "load_cases", "history", *self._kept["profiles"]]
        raise ValueError(f"there is no table {table!r}; there is {', '.join(known)}")

    def to_pyvista(self):
        pyvista = needed("pyvista", "a grid of PyVista")
        points, data = self._in_space()
        triangles = numpy.asarray(self.corner_triangles)
        cells = numpy.column_stack([numpy.full(len(triangles), 3), triangles]).ravel()
        grid = pyvista.UnstructuredGrid(cells, numpy.full(len(triangles), 5, dtype=numpy.uint8), points)  # 5: triangles
        for name, values in data.items():
            grid.point_data[name] = values
        for name, values in self._on_triangles().items():
            grid.cell_data[name] = numpy.array(values)
        return grid

    def to_meshio(self):
        meshio = needed("meshio", "a mesh of meshio")
        points, data = self._in_space()
        cells = {name: [numpy.array(a)] for name, a in self._on_triangles().items()}
        return meshio.Mesh(points, [("triangle", numpy.array(self.corner_triangles))], point_data=data, cell_data=cells)

    def to_vtk(self):
        needed("vtkmodules", "a grid of VTK")
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


def load(folder):
    folder = pathlib.Path(folder)
    if folder.name == "result.json":
        folder = folder.parent
    if not (folder / "result.json").exists():
        raise FilesError(f"{folder}: there is no result.json in it; kerf run -o FOLDER, or run(folder), makes a folder of "
                         "results")
    outcome = _kerf.read_result(os.fspath(folder))
    if not outcome.status or not isinstance(json.loads((folder / "result.json").read_text()), dict):
        raise FilesError(f"{folder / 'result.json'} is no result that kerf has written")
    arrays, why = read_fields(folder)
    return Result(outcome, folder, arrays=arrays, loaded=True, why_no_fields=why)
