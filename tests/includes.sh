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
# Two types of one name in the same namespace are one to the linker: it keeps the destructor of one of them. Types of a
# single file belong into its anonymous namespace.
while IFS= read -r name; do
  echo "struct or class $name is defined in more than one header:" $(grep -lE "^(struct|class) $name( |$)[^;]*$" */*.hpp)
  status=1
done < <(grep -hoE "^(struct|class) [A-Za-z_]+( final)?( :[^;]*)? ?\{" geometry/*.hpp solver/*.hpp topo/*.hpp \
  optimize/*.hpp cases/*.hpp report/*.hpp bench/*.hpp app/*.hpp | awk '{print $2}' | sort | uniq -d)
exit $status
