"""A case and its jobs."""

import os
import shutil
import tempfile
import weakref

from . import _kerf
from ._designs import Designs
from ._errors import SolveError
from ._mesh import Mesh
from ._result import Result
from ._views import copied, named, same


def assignments(values):
    """As --set of the program has them."""
    return [f"{key}={_kerf.toml(value)}" for key, value in (values or {}).items()]


class Case:
    # Docstrings of what users see stand in __init__.pyi (_documented.py).

    def __init__(self, source, *, set=None, name=None, folder=None):
        if isinstance(source, Case):
            source, name, folder = source._parts(name, folder)
        self._begin((source, name, folder), assignments(set))

    @classmethod
    def _overridden(cls, origin, overrides):
        """With overrides as the program has them."""
        made = cls.__new__(cls)
        made._begin(origin, list(overrides))
        return made

    def _begin(self, origin, overrides):
        source, name, folder = origin
        where = os.fspath(folder or "")
        if isinstance(source, dict):
            self._case = _kerf.Case.of_document(source, name or "case", where, overrides)
            origin = copied(source), name, folder
        elif self._is_text(source):
            self._case = _kerf.Case.of_text(source, name or "case", where, overrides)
        else:
            self._case = _kerf.Case.of_file(os.fspath(source), overrides)
        self._origin, self._overrides = origin, overrides
        self._document = self._seen = None  # made when it is asked for; what self._case was read from

    @staticmethod
    def _is_text(source):
        return isinstance(source, str) and "\n" in source

    @property
    def _is_file(self):
        return not isinstance(self._origin[0], dict) and not self._is_text(self._origin[0])

    def _tables(self):
        if self._document is None:
            self._document = named(self._case.document())
            self._seen = copied(self._document)
        return self._document

    def _read(self):
        """The case as it is now: read again where its tables were changed."""
        if self._document is not None and not same(self._document, self._seen):
            _, name, folder = self._parts()
            seen = copied(self._document)
            self._case = _kerf.Case.of_document(seen, name, folder, [])
            self._origin, self._overrides, self._seen = (seen, name, folder), [], seen
        return self._case

    def _parts(self, name=None, folder=None):
        """A document, what it is called, and where files lie that it names: what another process needs."""
        document = copied(self._document) if self._document is not None else self._case.document()
        return document, name or self._case.name, os.path.abspath(folder or self._case.folder or ".")

    def __copy__(self):
        made = type(self).__new__(type(self))
        made.__dict__.update(self.__dict__)
        made._document = copied(self._document)
        return made

    def __deepcopy__(self, memo):
        return self.__copy__()

    def __reduce__(self):
        self._read()
        return _remade, self._parts()

    def __getitem__(self, table):
        tables = self._tables()
        if table not in tables:
            raise KeyError(f"the case has no {table!r}; it has {', '.join(tables)}")
        return tables[table]

    def __setitem__(self, table, value):
        self._tables()[table] = named(value) if isinstance(value, (dict, list)) else value

    def __delitem__(self, table):
        del self._tables()[table]

    def __contains__(self, table):
        return table in self._tables()

    def __iter__(self):
        return iter(self._tables())

    def __len__(self):
        return len(self._tables())

    def keys(self):
        return self._tables().keys()

    def get(self, table, default=None):
        return self._tables().get(table, default)

    def to_dict(self):
        return copied(self._tables())

    @property
    def name(self):
        return self._read().name

    @property
    def title(self):
        return self._read().title

    def __repr__(self):
        cracks, holes, labels, element, degree = self._read().facts()
        parts = [_counted(holes, "hole"), _counted(cracks, "crack"), f"sides {', '.join(labels)}", f"{element} {degree}"]
        return f"<kerf.Case {self.title!r}: {', '.join(part for part in parts if part)}>"

    def text(self):
        return self._read().text()

    def check(self):
        return self._read().check()

    def mesh(self):
        return Mesh(**self._read().mesh())

    def designs(self, *, threads=None):
        return Designs(self._read().designs(_threads(threads)))

    def run(self, folder=None, *, threads=None, force=False, on_phase=None, on_iteration=None, on_step=None, resume=False):
        return self._run("run", folder, threads=threads, force=force, on_phase=on_phase, on_iteration=on_iteration,
                         on_step=on_step, resume=resume)

    def solve(self, folder=None, *, threads=None, force=False, on_phase=None):
        return self._run("solve", folder, threads=threads, force=force, on_phase=on_phase)

    def map(self, folder=None, *, threads=None, force=False, on_phase=None):
        return self._run("map", folder, threads=threads, force=force, on_phase=on_phase)

    def inspect(self, length=None, folder=None, *, threads=None, force=False, on_phase=None):
        case = self
        if length is not None:
            self._read()
            case = Case._overridden(self._origin, [*self._overrides, 'map.perturbation="edge_crack"',
                                                   f"map.length={_kerf.toml(length)}"])
        return case._run("map", folder, threads=threads, force=force, on_phase=on_phase)

    def validate(self, folder=None, *, threads=None, force=False, on_phase=None):
        return self._run("validate", folder, threads=threads, force=force, on_phase=on_phase)

    def grow(self, folder=None, *, threads=None, force=False, on_phase=None, on_step=None, resume=False):
        return self._run("grow", folder, threads=threads, force=force, on_phase=on_phase, on_step=on_step, resume=resume)

    def optimize(self, folder=None, *, threads=None, force=False, on_phase=None, on_iteration=None, resume=False):
        return self._run("optimize", folder, threads=threads, force=force, on_phase=on_phase, on_iteration=on_iteration,
                         resume=resume)

    def _run(self, job, folder, *, threads=None, force=False, on_phase=None, on_iteration=None, on_step=None,
             resume=False):
        """Without a folder the files go to a temporary one, which goes with the result."""
        case = self._read()
        where = tempfile.mkdtemp(prefix="kerf-") if folder is None else os.fspath(folder)
        try:
            outcome = case.run(
                job=job, folder=where, threads=_threads(threads), force=force, resume=resume, files=folder is not None,
                on_phase=on_phase, on_iteration=on_iteration, on_step=on_step)
            result = Result(outcome, where, case=case)
        except BaseException:
            if folder is None:
                shutil.rmtree(where, ignore_errors=True)
            raise
        if folder is None:
            weakref.finalize(result, shutil.rmtree, where, ignore_errors=True)
        if result.status != "ok":
            raise _unfinished(result)
        return result


def _remade(document, name, folder):
    return Case(document, name=name, folder=folder)


def _counted(count, what):
    return f"{count} {what}{'s' if count > 1 else ''}" if count else ""


def _threads(wanted):
    return min(max(os.cpu_count() or 1, 1), 256) if wanted is None else wanted


def _unfinished(result):
    error = SolveError(result.reason or result.status)
    error.result = result
    return error
