#!/usr/bin/env python3
"""coverage.py BUILD OUT: what the tests of a build with KERF_COVERAGE ran, by gcov: lines and branches per room in
OUT/summary.txt, per file in OUT/files.txt; the lines that nothing ran in OUT/missed.txt, the lines that ran and whose
branches did not all run in OUT/missed_branches.txt. A line counts once, however many instances of a template or
objects it is in. What an exception alone reaches, as the end of a function that frees what it has, does not count
unless it ran, and whether a call returns or throws is no branch."""
import re
import subprocess
import sys
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

ROOMS = ["base", "growth", "geometry", "solver", "topo", "inspect", "optimize", "io", "plot", "app", "include"]
ROOT = Path(__file__).resolve().parent.parent
LINE = re.compile(r" *([^ :]+): *(\d+)(:|-block)")


class Counts:
    """Of one source file: per line how often it ran, and how often each of its branches did."""

    def __init__(self) -> None:
        self.lines: dict = defaultdict(int)
        self.branches: dict = defaultdict(int)
        self.line(0)

    def line(self, number: int) -> None:
        self.number, self.place = number, 0
        self.block(False)

    def block(self, freeing: bool) -> None:
        """`freeing`: on the way of an exception that never was. What ends a block with a call is its return or its
        exception, which gcov names as one only where the block ran."""
        self.freeing, self.called = freeing, False

    def branch(self, text: str) -> None:
        if self.called or "(throw)" in text:
            return
        if not self.freeing:
            taken = re.search(r"taken (\d+)", text)
            self.branches[self.number, self.place] += int(taken[1]) if taken else 0
        self.place += 1


def counts(notes: Path) -> dict:
    """By file of kerf, from the text that gcov makes of one object: JSON does not tell what exceptions alone reach."""
    build = next(folder for folder in notes.parents if (folder / "CMakeFiles").is_dir())  # where it was compiled
    text = subprocess.run(["gcov", "-a", "-b", "-c", "-t", str(notes)], capture_output=True, cwd=build).stdout
    found: dict = {}
    here = None
    for raw in text.split(b"\n"):
        if b":    0:Source:" in raw:
            path = (build / raw.split(b":    0:Source:")[1].decode()).resolve()
            here = None
            if path.is_relative_to(ROOT) and path.exists() and path.relative_to(ROOT).parts[0] in ROOMS:
                here = found.setdefault(str(path.relative_to(ROOT)), Counts())
            continue
        if here is None:
            continue
        line = raw.decode(errors="replace")
        if line.startswith("branch"):
            here.branch(line)
        elif line.startswith("call"):
            here.called = True
        elif match := LINE.match(line):
            mark, number = match[1], int(match[2])
            if match[3] == "-block":
                here.block(mark == "$$$$$")
                continue
            here.line(number)
            if mark not in ("-", "====="):
                here.lines[number] += 0 if mark == "#####" else int(mark.rstrip("*"))
    return {name: (dict(c.lines), dict(c.branches)) for name, c in found.items()}


def ranges(name: str, numbers: list) -> list:
    """file:12 and file:15-18 of sorted line numbers."""
    found: list = []
    for n in numbers:
        if found and found[-1][1] == n - 1:
            found[-1][1] = n
        else:
            found.append([n, n])
    return [f"{name}:{a}" if a == b else f"{name}:{a}-{b}" for a, b in found]


def main(build: Path, out: Path) -> None:
    lines: dict = defaultdict(lambda: defaultdict(int))
    branches: dict = defaultdict(lambda: defaultdict(int))
    # Objects of tests repeat headers alone: their inline functions count where they run.
    with ProcessPoolExecutor() as pool:
        for found in pool.map(counts, sorted(build.rglob("*.gcno"))):
            for name, (of_lines, of_branches) in found.items():
                for number, count in of_lines.items():
                    lines[name][number] += count
                for place, count in of_branches.items():
                    branches[name][place] += count
    out.mkdir(parents=True, exist_ok=True)

    def share(of: dict, names: list) -> str:
        every = [count for name in names for count in of[name].values()]
        return f"{sum(c > 0 for c in every):7d} of {len(every):7d} {100 * sum(c > 0 for c in every) / max(1, len(every)):6.1f} %"

    head = f"{'lines':>26} {'branches':>26}"
    table = [f"{'':10} {head}"]
    for room in ROOMS + ["all"]:
        names = [name for name in lines if room == "all" or name.startswith(room + "/")]
        table.append(f"{room:10} {share(lines, names)} {share(branches, names)}")
    files = [head] + [f"{share(lines, [name])} {share(branches, [name])}  {name}" for name in sorted(lines)]
    missed, untaken = [], []
    for name in sorted(lines):
        missed += ranges(name, [n for n in sorted(lines[name]) if lines[name][n] == 0])
        ran = {n for (n, _), count in branches[name].items() if count == 0 and lines[name][n] > 0}
        untaken += ranges(name, sorted(ran))
    for file, content in [("summary", table), ("files", files), ("missed", missed), ("missed_branches", untaken)]:
        (out / f"{file}.txt").write_text("\n".join(content) + "\n")
    print("\n".join(table))
    print(f"per file, lines and branches that nothing ran: {out}/files.txt, missed.txt, missed_branches.txt")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]))
