#!/usr/bin/env bash
# tutorial.sh SOURCE BUILD: the code of the developer's tutorial. Its patches are applied to a copy of the sources, what they touch is compiled and linked with the rest as
# built, and its programs run: the new element has the rate that its row says, the new perturbation is the worst one.
set -euo pipefail
source=$1 build=$2
tutorial=$source/docs/tutorials/developer
folder=$build/tutorial_test
rm -rf "$folder"
for name in element perturbation; do
  copy=$folder/$name
  mkdir -p "$copy"
  cp -r "$source/include" "$source/solver" "$source/topo" "$copy"
  patch -s -p1 -d "$copy" <"$tutorial/$name.patch"
done

python3 - "$source" "$build" "$folder" <<'PYTHON'
import json
import subprocess
import sys

source, build, folder = sys.argv[1:]
commands = {}
for entry in json.load(open(build + "/compile_commands.json")):
    commands.setdefault(entry["file"], entry["command"])  # of the library, before those of tests with factors
link = subprocess.run(["ninja", "-C", build, "-t", "commands", "test_topo"], check=True, capture_output=True, text=True)
link = link.stdout.strip().splitlines()[-1].split()

# What each patch touches or adds, and a source that is compiled alike.
touched = {"element": ["solver/element/element.cpp", "solver/element/local.cpp", "solver/element/local_afw_bubbles.cpp"],
           "perturbation": ["topo/formulas/kind.cpp", "topo/formulas/gouge.cpp"]}
alike = {"solver/element/local_afw_bubbles.cpp": "solver/element/local_afw.cpp", "topo/formulas/gouge.cpp": "topo/formulas/ellipse.cpp"}
for name, paths in touched.items():
    objects = []
    for path, kind in [(f"{folder}/{name}/{p}", alike.get(p, p)) for p in paths] + \
            [(f"{source}/docs/tutorials/developer/{name}.cpp", "topo/formulas/ellipse.cpp")]:
        like = f"{source}/{kind}"
        target = f"{folder}/{name}/{len(objects)}.o"
        words = commands[like].split()
        words[words.index("-o") + 1] = target
        words = [path if word == like else word for word in words]
        first = next(i for i, word in enumerate(words) if word.startswith("-I"))
        words[first:first] = [f"-I{folder}/{name}/include", f"-I{folder}/{name}"]
        subprocess.run(" ".join(words), shell=True, check=True, cwd=build)
        objects.append(target)
    words = [word for word in link if not word.startswith("CMakeFiles/test_topo.dir") and
             not any(part in word for part in ("gtest", "kerf_support"))]
    at = words.index("-o")
    words[at:at + 2] = objects + ["-o", f"{folder}/{name}/program"]
    subprocess.run(" ".join(words), shell=True, check=True, cwd=build)
PYTHON
"$folder/element/program"
"$folder/perturbation/program"
