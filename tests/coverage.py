#!/usr/bin/env python3
"""coverage.py BUILD OUT: what the tests of a build with KERF_COVERAGE ran, by gcov: lines and branches per room in
OUT/summary.txt, the lines that nothing ran in OUT/missed.txt. Branches that only an exception takes are not counted."""
import json
import os
import subprocess
import sys
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOMS = ["geometry", "solver", "topo", "optimize", "io", "plot", "app", "include"]


def counts(data: Path) -> dict:
    text = subprocess.run(["gcov", "--branch-probabilities", "--json-format", "--stdout", str(data)], capture_output=True,
                          text=True, cwd=data.parent).stdout
    return json.loads(text) if text else {"files": []}


def main(build: Path, out: Path) -> None:
    root = Path(__file__).resolve().parent.parent
    # Objects of tests repeat headers alone: their inline functions count where they run.
    notes = sorted(build.rglob("*.gcno"))
    lines: dict = defaultdict(lambda: defaultdict(int))
    branches: dict = defaultdict(lambda: defaultdict(int))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for made, found in zip(notes, pool.map(counts, notes)):
            start = Path(found.get("current_working_directory", build))
            for file in found["files"]:
                path = (start / file["file"]).resolve()
                if not path.is_relative_to(root) or path.relative_to(root).parts[0] not in ROOMS:
                    continue
                name = str(path.relative_to(root))
                for line in file["lines"]:
                    lines[name][line["line_number"]] += line["count"]
                    for k, branch in enumerate(line["branches"]):
                        if not branch["throw"]:
                            branches[name][line["line_number"], k] += branch["count"]
    out.mkdir(parents=True, exist_ok=True)

    def share(of: dict, names: list) -> str:
        every = [count for name in names for count in of[name].values()]
        return f"{sum(c > 0 for c in every):7d} of {len(every):7d} {100 * sum(c > 0 for c in every) / max(1, len(every)):6.1f} %"

    table = [f"{'':10} {'lines':>26} {'branches':>26}"]
    for room in ROOMS + ["all"]:
        names = [name for name in lines if room == "all" or name.startswith(room + "/")]
        table.append(f"{room:10} {share(lines, names)} {share(branches, names)}")
    (out / "summary.txt").write_text("\n".join(table) + "\n")
    missed = [f"{name}:{number}" for name in sorted(lines) for number in sorted(lines[name]) if lines[name][number] == 0]
    (out / "missed.txt").write_text("\n".join(missed) + "\n")
    print("\n".join(table))
    print(f"lines that nothing ran: {out / 'missed.txt'}")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]))
