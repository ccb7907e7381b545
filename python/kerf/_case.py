"""A case and its jobs."""

import os
import shutil
import tempfile
import weakref

from . import _kerf
from ._errors import SolveError
from ._result import Result


class Case:
    """What is computed: the path of a case file, or a dict with the same tables and keys.

    ``set`` changes keys, as ``--set`` of the program does: ``{"mesh.size": 0.02, "crack.c.contact": "open"}``.
    In a dict, a function ``f(x, y)``, or ``f(x, y, nx, ny)`` on boundaries, may stand where a file has an expression;
    what is known of such data is what they are at sampled points, and a note of the result says so. ``folder`` is
    where files lie that a dict names, the working folder by default.

    Raises CaseError with the place of what is wrong.
    """

    def __init__(self, source, *, set=None, name=None, folder=None):
        self._begin((source, name, folder), [f"{key}={_kerf.toml(value)}" for key, value in (set or {}).items()])

    @classmethod
    def _overridden(cls, origin, overrides):
        """With overrides as the program has them."""
        made = cls.__new__(cls)
        made._begin(origin, list(overrides))
        return made

    def _begin(self, origin, overrides):
        self._origin, self._overrides = origin, overrides
        source, name, folder = origin
        if isinstance(source, dict):
            self._case = _kerf.Case.of_document(source, name or "case", os.fspath(folder or ""), overrides)
        else:
            self._case = _kerf.Case.of_file(os.fspath(source), overrides)

    @property
    def name(self):
        return self._case.name

    @property
    def title(self):
        return self._case.title

    def __repr__(self):
        return f"<kerf.Case {self.title!r}>"

    def text(self):
        """The case as a file has it, with all that was set; functions stand there as their names."""
        return self._case.text()

    def check(self):
        """The geometry in numbers and what each label selected; solves nothing."""
        return self._case.check()

    def run(self, folder=None, **how):
        """Every job that the case names: solve, map, validate, optimize."""
        return self._run("run", folder, **how)

    def solve(self, folder=None, **how):
        """The state alone."""
        return self._run("solve", folder, **how)

    def map(self, folder=None, **how):
        """The state and the map of the topological derivative."""
        return self._run("map", folder, **how)

    def inspect(self, length=None, folder=None, **how):
        """The state and the worst cracks: ``result["edge_cracks"]`` has ``worst``, along the boundary, and ``inside``.
        With ``length`` cracks of that length; without it those of [map], whose perturbation is "edge_crack"."""
        case = self
        if length is not None:
            case = Case._overridden(self._origin, [*self._overrides, 'map.perturbation="edge_crack"',
                                                   f"map.length={_kerf.toml(length)}"])
        return case._run("map", folder, **how)

    def validate(self, folder=None, **how):
        """The expansion against computations with changes of finite size."""
        return self._run("validate", folder, **how)

    def grow(self, folder=None, *, on_step=None, resume=False, **how):
        """The state, and its cracks grown from their tips. ``on_step`` is called with a dict of numbers after every
        step; what it raises ends the growth. ``resume`` goes on with the checkpoint in the folder."""
        return self._run("grow", folder, on_step=on_step, resume=resume, **how)

    def optimize(self, folder=None, *, on_iteration=None, resume=False, **how):
        """The best design. ``on_iteration`` is called with a dict of numbers after every iteration; what it raises
        ends the optimization. ``resume`` goes on with the checkpoint in the folder."""
        return self._run("optimize", folder, on_iteration=on_iteration, resume=resume, **how)

    def _run(self, job, folder, *, threads=None, force=False, on_phase=None, on_iteration=None, on_step=None,
             resume=False):
        """Without a folder the files go to a temporary one, which goes with the result."""
        where = tempfile.mkdtemp(prefix="kerf-") if folder is None else os.fspath(folder)
        if threads is None:
            threads = min(max(os.cpu_count() or 1, 1), 256)
        try:
            outcome = self._case.run(
                job=job, folder=where, threads=threads, force=force, resume=resume, files=folder is not None,
                on_phase=on_phase, on_iteration=on_iteration, on_step=on_step)
            result = Result(outcome, where)
        except BaseException:
            if folder is None:
                shutil.rmtree(where, ignore_errors=True)
            raise
        if folder is None:
            weakref.finalize(result, shutil.rmtree, where, ignore_errors=True)
        if result.status != "ok":
            raise _unfinished(result)
        return result


def _unfinished(result):
    error = SolveError(result.reason or result.status)
    error.result = result
    return error
