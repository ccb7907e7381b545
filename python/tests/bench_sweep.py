#!/usr/bin/env python3
"""How near sweeps of tiny cases come to the ideal: COUNT runs on two processes, by the program and by Python, against
half the time that so many single runs of the program take, each in a process of its own.

    KERF_PROGRAM=build/kerf PYTHONPATH=build/python python3 python/bench_sweep.py 1000
"""

import os
import pathlib
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


def timed(work):
    begin = time.monotonic()
    work()
    return time.monotonic() - begin


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

        single = timed(one_by_one) / len(singles)
        ideal = single * COUNT / JOBS
        print(f"a single run {1000 * single:.1f} ms, ideal of {COUNT} on {JOBS} processes {ideal:.2f} s")
        for what, work in [("kerf sweep", by_program), ("kerf.sweep", in_python)]:
            seconds = timed(work)
            print(f"{what}: {seconds:.2f} s, {100 * ideal / seconds:.1f} % of ideal")
            print(f"{what} again: {timed(work):.2f} s, all done already")


if __name__ == "__main__":
    main()
