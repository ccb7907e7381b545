#!/usr/bin/env python3
"""same_results.py EXPECTED FOUND: an archive or a wheel wrote the same files and numbers as the build, to the bit, and drew the
same pictures. They have no gmsh, which writes design.step."""

import json
import pathlib
import sys

folders = [pathlib.Path(argument) for argument in sys.argv[1:3]]
# Of a run, not of its result; the page holds a copy of these.
OWN = ("time_s", "peak_memory_mb")
APART = (".html", ".bin")


def contents(folder):
    files = {p.name: p.read_bytes() for p in sorted(folder.iterdir()) if p.suffix not in APART}
    result = json.loads(files["result.json"])
    for key in OWN:
        del result[key]
    files["result.json"] = json.dumps(result)
    files["case.toml"] = files["case.toml"].split(b"\n", 2)[2]  # the second line is the command
    return files


expected, found = map(contents, folders)
expected.pop("design.step", None)
different = sorted(name for name in expected.keys() | found.keys() if expected.get(name) != found.get(name))
if different:
    sys.exit(f"{folders[0]} and {folders[1]} differ in: {', '.join(different)}")
print(f"{len(expected)} files are the same to the bit")
