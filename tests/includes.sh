#!/usr/bin/env bash
# Who may include what: rooms look down only, a wing's header is private to its room, the public headers include each
# other alone, and each foreign library stays in its own translation unit.
set -u
cd "${1:-.}"
status=0
complain() {
  echo "$1"
  status=1
}
declare -A below=(
  [base]="base" [growth]="growth solver geometry base" [geometry]="geometry base" [solver]="solver geometry base" [topo]="topo solver geometry base"
  [inspect]="inspect growth topo solver geometry base"
  [optimize]="optimize topo solver geometry base"
  [io]="io optimize inspect topo solver geometry growth base" [plot]="plot io optimize inspect topo solver geometry growth base"
  [python]="python app plot io optimize inspect topo solver geometry growth base"
  [bench]="bench app plot io optimize inspect topo solver geometry growth base" [app]="app plot io optimize inspect topo solver geometry growth base"
)
# The room that a public header belongs to.
declare -A home=(
  [types]=base [stop]=base [shape]=geometry [mesh]=geometry [mesher]=geometry [folded]=geometry
  [material]=solver [field]=solver [scene]=solver [element]=solver [model]=solver [state]=solver [adjoint]=solver [recover]=solver
  [fracture]=solver [bounds]=solver [adaptive]=solver [growth]=growth [edge_cracks]=inspect
  [functional]=topo [max_stress]=topo [perturbation]=topo [analysis]=topo [map]=topo [derivative_bounds]=topo [second_order]=topo [validate]=topo [shape_gradient]=topo [units]=topo
  [design]=optimize [optimize]=optimize [inverse]=optimize
  [case_file]=io [mesh_file]=io [vtk]=io [kerf]=io
)
for header in include/kerf/*.hpp; do
  name=$(basename "$header" .hpp)
  [ -n "${home[$name]:-}" ] || complain "$header belongs to no room: name it in tests/includes.sh"
  while IFS= read -r line; do
    case "$line" in
      *'"kerf/'*) ;;
      *) complain "$header is public and includes what is not: $line" ;;
    esac
  done < <(grep -E '^#include "' "$header")
done
for room in "${!below[@]}"; do
  while IFS=: read -r file line; do
    path=${line#*\"} path=${path%%\"*}
    target=${path%%/*}
    case "$target" in
      kerf) name=${path#kerf/}; name=${name%.hpp}; target=${home[$name]:-unknown} ;;
      tests) [ "$room" = bench ] && continue ;;
      *)
        inside=${path#*/}
        if [ "$target" != "$room" ] && [[ "$inside" == */* ]]; then
          complain "$file includes $path, a private header of $target"
        fi
        ;;
    esac
    case " ${below[$room]} " in
      *" $target "*) ;;
      *) complain "$file looks up: $line" ;;
    esac
  done < <(grep -rHE '^#include "[a-z_]+/' "$room" --include=*.cpp --include=*.hpp)
done
# Tests of a room see its private headers and nobody else's.
while IFS=: read -r file line; do
  path=${line#*\"} path=${path%%\"*}
  target=${path%%/*}
  room=$(cut -d/ -f2 <<<"$file")
  [ "$room" = fuzz ] && room=io  # makes case files from the table of keys, and calls what reads
  [ "$file" = tests/fuzz/parsers/checkpoint.cpp ] && room=optimize
  inside=${path#*/}
  case "$target" in kerf | tests) continue ;; esac
  if [ "$target" != "$room" ] && [[ "$inside" == */* ]]; then
    complain "$file includes $path, a private header of $target"
  fi
done < <(grep -rHE '^#include "[a-z_]+/' tests --include=*.cpp --include=*.hpp)
only() {  # only PATTERN FILE...: the header may be included in those files alone
  while IFS= read -r file; do
    case " ${*:2} " in
      *" $file "*) ;;
      *) complain "$file includes $1, which belongs in ${*:2}" ;;
    esac
  done < <(grep -rlE "^#include <$1" include base growth geometry solver topo inspect optimize io plot bench app python --include=*.cpp --include=*.hpp)
}
only CGAL/ geometry/mesher/mesher.cpp
only cholmod solver/system/symbolic.cpp
only umfpack solver/system/lu.cpp
only nlopt optimize/parametric/minimize.cpp
only 'toml\+\+' io/case/reader.cpp
only muParser io/case/expression.cpp
only vtk io/result/vtk_module.cpp
only gmsh io/mesh/gmsh_module.cpp
only petsc app/parts/petsc_module.cpp
only mpi app/parts/petsc_module.cpp
only cairo plot/figure/pen.hpp
only png plot/figure/png.cpp
only nlohmann io/result/result.cpp io/result/leaves.cpp io/result/read.cpp io/result/bounded_json.cpp io/result/bounded_json.hpp io/case/key_schema.cpp bench/command/records.cpp bench/verify/records.cpp
only CLI app/command/command_line.cpp
only spdlog app/command/progress.cpp
only pybind11 python/module.cpp python/document.cpp python/document.hpp
# One door for writing: files are made, renamed and removed in base/whole_file.cpp, temporary ones where gmsh and forecasts
# need them; folders are made where --output says, and removals are those of the results of an earlier run.
doors() {  # doors PATTERN FILE...: what it finds may stand in those files alone
  while IFS= read -r file; do
    case " ${*:2} " in
      *" $file "*) ;;
      *) complain "$file writes past base/whole_file.hpp: $(grep -nE "$1" "$file" | head -n 1)" ;;
    esac
  done < <(grep -rlE "$1" base growth geometry solver topo inspect optimize io plot app python --include=*.cpp --include=*.hpp)
}
doors 'std::ofstream|O_CREAT|O_TRUNC|fopen\([^)]*"[wa]|freopen|copy_file|mkdtemp|mkstemp|[^_]rename(at)?\(|\bunlink(at)?\(' \
  base/whole_file.cpp io/mesh/confine.cpp io/mesh/gmsh.cpp app/run/forecast.cpp
doors 'create_directories\(|create_directory\(|mkdir(at)?\(' \
  base/whole_file.cpp app/run/run.cpp app/command/check.cpp app/sweep/sweep_run.cpp app/command/main.cpp
doors 'fs::remove|filesystem::remove|remove_all\(' \
  app/command/folder.cpp app/run/recorder.cpp app/command/program.cpp app/sweep/sweep_run.cpp app/run/forecast.cpp io/mesh/gmsh.cpp
# Two types of one name in the same namespace are one to the linker: it keeps the destructor of one of them. Types of a
# single file belong into its anonymous namespace.
headers=$(find include base growth geometry solver topo inspect optimize io plot bench app python -name '*.hpp')
while IFS= read -r name; do
  complain "struct or class $name is defined in more than one header: $(grep -lE "^(struct|class) $name( |$)[^;]*$" $headers | tr '\n' ' ')"
done < <(grep -hoE "^(struct|class) [A-Za-z_]+( final)?( :[^;]*)? ?\{" $headers | awk '{print $2}' | sort | uniq -d)
exit $status
