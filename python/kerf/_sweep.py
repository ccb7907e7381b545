"""One case with many values of some of its keys."""

import csv
import multiprocessing
import multiprocessing.connection
import os
import pathlib
import shlex
import sys
import traceback

from . import _kerf
from ._case import Case, assignments
from ._errors import CaseError, Error, SolveError
from ._missing import needed


class Sweep:
    def __init__(self, folder, words):
        self.folder = pathlib.Path(folder)
        self._words = words
        with open(self.folder / "sweep.csv", newline="") as file:
            self.rows = [{key: _number(cell) for key, cell in row.items()} for row in csv.DictReader(file)]
        self.failures = [row for row in self.rows if row["status"] == "failed"]

    def column(self, name):
        return [row[name] for row in self.rows]

    def __len__(self):
        return len(self.rows)

    def __repr__(self):
        return f"<kerf.Sweep: {self._words.splitlines()[0]}>"

    def summary(self):
        return self._words

    def to_pandas(self):
        return needed("pandas", "a table").DataFrame(self.rows)

    def _repr_html_(self):
        import html

        page = html.escape((self.folder / "sweep.html").read_text(), quote=True)
        return f'<iframe sandbox="" srcdoc="{page}" style="width: 100%; height: 40em; border: 0"></iframe>'


def _number(cell):
    try:
        return float(cell) if cell else None
    except ValueError:
        return cell


def sweep(case, over, *, folder, write=None, set=None, jobs=None, threads=1, client=None, on_run=None):
    folder = pathlib.Path(folder).absolute()
    folder.mkdir(parents=True, exist_ok=True)
    if not isinstance(case, Case):
        case = Case(case)
    case._read()
    origin, overrides = case._origin, case._overrides + assignments(set)
    base = origin[0]
    if not case._is_file:
        base = folder / "case.toml"
        case = Case(origin[0], name=origin[1], folder=origin[2])
        if not base.exists() or base.read_text() != case.text():
            case._case.keep(str(folder))
    values = [(key, [_kerf.toml(value) for value in _list(key, values)]) for key, values in dict(over).items()]
    plan = _kerf.SweepPlan(os.fspath(base), str(folder), overrides, values)
    if write is not None:
        if case._case.has_functions:
            raise CaseError("functions of Python cannot be written to a script; use expressions")
        return plan.write(write, threads, _collecting(base, folder, overrides, values))
    runs = plan.runs()
    todo = [(name, sets) for k, (name, sets) in enumerate(runs) if plan.is_to_do(k)]
    tell = on_run or (lambda name: None)
    if client is not None:
        _with_dask(client, origin, todo, folder, threads, tell)
    else:
        _with_processes(jobs or os.cpu_count() or 1, origin, todo, folder, threads, tell)
    return Sweep(folder, plan.collect()[3])


def _list(key, values):
    values = values.tolist() if hasattr(values, "tolist") else list(values)
    if not values:
        raise CaseError(f"{key}: a sweep needs values")
    return values


def _collecting(base, folder, overrides, values):
    words = ["kerf", "sweep", os.path.abspath(base), "-o", str(folder), "--collect"]
    for assignment in overrides:
        words += ["--set", assignment]
    for key, all_values in values:
        words += ["--over", f"{key}=[{', '.join(all_values)}]"]
    return shlex.join(words + ["--columns", "all"])


def _run_one(origin, overrides, folder, threads):
    """Makes one run; what goes wrong goes to failed.txt. Returns the exit code that the program would have."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "failed.txt").unlink(missing_ok=True)
    try:
        Case._overridden(origin, overrides)._run("run", folder, threads=threads, force=True)
        return 0
    except Error as error:
        failure = error
    except Exception as error:  # of a function of the case, of no memory
        (folder / "run.log").write_text(traceback.format_exc())
        failure = SolveError(f"{type(error).__name__}: {error}")
    _kerf.write_failure(str(folder), failure.exit_code, str(failure))
    return failure.exit_code


def _process(origin, overrides, folder, threads):
    code = _run_one(origin, overrides, folder, threads)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def _with_processes(jobs, origin, todo, folder, threads, tell):
    """Forked: a function of the case need not be sent, and Python and numpy are there at once."""
    context = multiprocessing.get_context("fork")
    going, todo = {}, list(todo)
    todo.reverse()
    try:
        while todo or going:
            while todo and len(going) < jobs:
                name, overrides = todo.pop()
                process = context.Process(target=_process, args=(origin, overrides, folder / name, threads))
                process.start()
                going[process.sentinel] = process, name
            for ended in multiprocessing.connection.wait(list(going)):
                process, name = going.pop(ended)
                process.join()
                if process.exitcode < 0:
                    where = folder / name
                    where.mkdir(parents=True, exist_ok=True)
                    _kerf.write_failure(str(where), 128 - process.exitcode, f"ended by signal {-process.exitcode}")
                process.close()
                tell(name)
    except BaseException:
        for process, _ in going.values():
            process.terminate()
            process.join()
        raise


def _with_dask(client, origin, todo, folder, threads, tell):
    from distributed import as_completed

    names = {client.submit(_run_one, origin, overrides, str(folder / name), threads, pure=False): name
             for name, overrides in todo}
    for future in as_completed(list(names)):
        name = names[future]
        if future.status == "error":  # the worker was lost
            (folder / name).mkdir(parents=True, exist_ok=True)
            _kerf.write_failure(str(folder / name), 128, f"the worker failed: {future.exception()}")
        tell(name)
