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

PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$source/tests python3 - "$source" "$build" "$folder" <<'PYTHON'
import sys

from compile_changed import Sources

source, build, folder = sys.argv[1:]
sources = Sources(source, build)
link = [word for word in sources.link_command("test_topo").split() if not word.startswith("CMakeFiles/test_topo.dir") and
        not any(part in word for part in ("gtest", "kerf_support"))]

# What each patch touches or adds, and a source that is compiled alike.
touched = {"element": ["solver/element/element.cpp", "solver/element/local.cpp", "solver/element/local_afw_bubbles.cpp"],
           "perturbation": ["topo/formulas/kind.cpp", "topo/formulas/gouge.cpp"]}
alike = {"solver/element/local_afw_bubbles.cpp": "solver/element/local_afw.cpp", "topo/formulas/gouge.cpp": "topo/formulas/ellipse.cpp"}
for name, paths in touched.items():
    copy = f"{folder}/{name}"
    objects = sources.compile(copy, paths, alike, copy)
    objects.append(sources.compile_like("topo/formulas/ellipse.cpp", f"{source}/docs/tutorials/developer/{name}.cpp",
                                        f"{copy}/program.o", copy))
    words = list(link)
    at = words.index("-o")
    words[at:at + 2] = objects + ["-o", f"{copy}/program"]
    sources.run(" ".join(words))
PYTHON
"$folder/element/program"
"$folder/perturbation/program"
