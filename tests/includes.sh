#!/usr/bin/env bash
# Rooms look down only, and each foreign library stays in its own translation unit.
set -u
cd "${1:-.}"
status=0
declare -A below=(
  [geometry]="geometry" [solver]="solver geometry" [topo]="topo solver geometry" [optimize]="optimize topo solver geometry" [cases]="cases optimize topo solver geometry"
  [report]="report optimize topo solver geometry" [bench]="bench report optimize topo solver geometry"
  [app]="app bench cases report optimize topo solver geometry"
)
for room in "${!below[@]}"; do
  while IFS=: read -r file line; do
    target=$(sed -E 's/.*"([a-z_]+)\/.*/\1/' <<<"$line")
    case " ${below[$room]} " in
      *" $target "*) ;;
      *) echo "$file looks up: $line"; status=1 ;;
    esac
  done < <(grep -HE '^#include "[a-z_]+/' "$room"/*.cpp "$room"/*.hpp)
done
only() {  # only PATTERN FILE...: the header may be included in those files alone
  while IFS= read -r file; do
    case " ${*:2} " in
      *" $file "*) ;;
      *) echo "$file includes $1, which belongs in ${*:2}"; status=1 ;;
    esac
  done < <(grep -lE "^#include <$1" {geometry,solver,topo,optimize,cases,report,bench,app}/*.[ch]pp 2>/dev/null)
}
only CGAL/ geometry/mesher.cpp
only cholmod solver/factor.cpp
only umfpack solver/lu.cpp
only nlopt optimize/minimise.cpp
only 'toml\+\+' cases/reader.cpp
only muParser cases/expression.cpp
only vtk report/vtk_module.cpp
only cairo report/pen.hpp
only nlohmann report/result.cpp bench/records.cpp
only CLI app/main.cpp
only spdlog app/progress.cpp
# One name, one struct: the linker would take either of two, and a destructor of the wrong one crashes.
for name in $(grep -hoE '^(struct|class) [A-Z][A-Za-z]+ \{' {geometry,solver,topo,optimize,cases,report,bench,app}/*.hpp | sort | uniq -d | cut -d' ' -f2); do
  echo "$name is defined in more than one header: $(grep -lE "^(struct|class) $name \{" */*.hpp | tr '\n' ' ')"; status=1
done
exit $status
