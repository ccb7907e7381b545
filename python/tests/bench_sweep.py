#!/usr/bin/env python3
"""How near sweeps of tiny cases come to the ideal: COUNT runs on two processes, by the program and by Python, against
half the time that so many single runs of the program take, each in a process of its own.

    KERF_PROGRAM=build/kerf PYTHONPATH=build/python python3 python/tests/bench_sweep.py 1000
"""

import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import kerf

PROGRAM, COUNT, JOBS = os.path.abspath(os.environ["KERF_PROGRAM"]), int(sys.argv[1]), 2
CASE = {
    "domain": {"outline": [[0, 0], [1, 0], [1, 1], [0, 1]], "sides": ["bottom", "right", "top", "left"]},
    "crack": [{"name": "c", "path": [[0.3, 0.5], [0.7, 0.5]]}],
    "material": {"young": 1000.0, "poisson": 0.3},
    "boundary": [{"on": ["bottom", "top"], "traction": [0, "ny"]}],
    "mesh": {"size": 0.1},
    "map": {"perturbation": "hole"},
    "output": {"vtk": False, "png": False, "html": False},
}


def processor_seconds():
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


def timed(work):
    """Seconds of the clock and of the processors: where others use the machine, too, the second tell more."""
    begin, processors = time.monotonic(), processor_seconds()
    work()
    return time.monotonic() - begin, processor_seconds() - processors


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        case = folder / "case.toml"
        case.write_text(kerf.Case(CASE).text())
        values = [round(0.4 * k / COUNT, 6) for k in range(COUNT)]
        singles = values[:: max(COUNT // 100, 1)]

        def one_by_one():
            for k, value in enumerate(singles):
                subprocess.run([PROGRAM, "run", case, "-o", folder / f"single_{k}", "--quiet", "--threads", "1",
                                "--log-level", "error", "--set", f"material.poisson={value}"], check=True)

        def by_program():
            subprocess.run([PROGRAM, "sweep", case, "-o", folder / "program", "--jobs", str(JOBS), "--quiet",
                            "--over", f"material.poisson={values}"], check=True)

        def in_python():
            assert not kerf.sweep(CASE, {"material.poisson": values}, folder=folder / "python", jobs=JOBS).failures

        single, used = (seconds / len(singles) for seconds in timed(one_by_one))
        ideal = single * COUNT / JOBS
        print(f"a single run {1000 * single:.1f} ms, of the processor {1000 * used:.1f} ms; "
              f"ideal of {COUNT} on {JOBS} processes {ideal:.2f} s")
        for what, work in [("kerf sweep", by_program), ("kerf.sweep", in_python)]:
            seconds, processors = timed(work)
            print(f"{what}: {seconds:.2f} s, {100 * ideal / seconds:.1f} % of ideal; by processor seconds "
                  f"{100 * used * COUNT / processors:.1f} %")
            print(f"{what} again: {timed(work)[0]:.2f} s, all done already")


if __name__ == "__main__":
    main()
