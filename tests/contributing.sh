#!/usr/bin/env bash
# contributing.sh SOURCE BUILD: the steps of CONTRIBUTING.md for a functional, followed in a copy of the sources: what they
# touch is compiled, linked with the rest as built, and validated by finite holes.
set -euo pipefail
source=$1 build=$2
folder=$build/contributing_test
rm -rf "$folder"
mkdir -p "$folder/copy/topo"
cp -r "$source/include" "$source/io" "$folder/copy"
cp -r "$source/topo/functional" "$folder/copy/topo"
cd "$folder/copy"

# 1. A function that returns a Term, in a file of its own.
sed -i 's|^Term crack_opening(.*|&\n/// int_body u_y.\nTerm deflection();|' include/kerf/functional.hpp
cat >topo/functional/deflection.cpp <<'CPP'
#include "kerf/functional.hpp"

namespace kerf {

Term deflection() {
  return {.kind = "deflection",
          .linear = true,
          .density =
              [](const FieldPoint& p) {
                return Density{.value = p.displacement.y(), .by_displacement = Vec2::UnitY()};
              },
          .uses_displacement = true,
          .uses_place = false};
}

}  // namespace kerf
CPP
# 2. Its reader, its word in the table of keys.
sed -i 's|^    if (kind == "volume") .*|&\n    if (kind == "deflection") return {deflection()};|' io/case/functional_sections.cpp
sed -i 's|std::array<View, 16> functional_kinds{|std::array<View, 17> functional_kinds{"deflection", |' io/case/keys.cpp

PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$source/tests python3 - "$source" "$build" "$folder" <<'PYTHON'
import sys

from compile_changed import Sources

source, build, folder = sys.argv[1:]
sources = Sources(source, build)
deflection = "topo/functional/deflection.cpp"
objects = sources.compile(f"{folder}/copy", ["io/case/functional_sections.cpp", "io/case/keys.cpp", deflection],
                          {deflection: "topo/functional/functionals.cpp"}, folder)
sources.run(sources.link_command("kerf").replace(" -o kerf ", f" {' '.join(objects)} -o {folder}/kerf "))
PYTHON

# 3. Adjoint, map and validation follow from the density.
cat >"$folder/beam.toml" <<'TOML'
[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides   = ["bottom", "right", "top", "left"]

[mesh]
size = 0.06

[material]
young = 100
poisson = 0.3
state = "plane stress"

[[boundary]]
on = "left"
displacement = [0, 0]

[[boundary]]
on = "right"
traction = [0, -1]

[functional]
kind = "deflection"

[validate]
points = [[0.9, 0.6]]
radii  = { largest = 0.08, ratio = 0.5, count = 4 }

[output]
vtk = false
png = false
html = false
TOML
ln -sf "$build/kerf_vtk.so" "$folder/kerf_vtk.so"
"$folder/kerf" validate "$folder/beam.toml" -o "$folder/out" --force >"$folder/log"
grep -q '"verdict": *"holds"' "$folder/out/result.json" || { cat "$folder/log"; exit 1; }
"$folder/kerf" keys functional.kind | grep -q deflection
echo "a functional was added in the steps of CONTRIBUTING.md, and its expansion holds"
