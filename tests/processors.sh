#!/usr/bin/env bash
# processors.sh KERF CASES: a state, an adjoint with its map, and ten iterations of each optimization loop have the same bits
# with the OpenBLAS kernels of three processors, which round otherwise.
set -euo pipefail
kerf=$1 cases=$2
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
run() {  # run NAME COMMAND CASE [SETTING...]
  local name=$1 command=$2 case=$3 settings=()
  shift 3
  for setting in "$@" output.vtk=false output.png=false output.html=false; do settings+=(--set "$setting"); done
  local code=0
  OPENBLAS_CORETYPE=$kernels "$kerf" "$command" "$cases/$case.toml" -o "$folder/$kernels/$name" --threads 1 --quiet "${settings[@]}" || code=$?
  # The tenth iteration is the end of the budget, not of the design.
  [ $code -eq 0 ] || { [ $code -eq 4 ] && [ "$command" = optimize ]; } || { echo "$kernels: $name ended with $code"; exit 1; }
}
compared=()
for kernels in HASWELL SKYLAKEX SANDYBRIDGE; do
  case $kernels in
    HASWELL) needs=avx2 ;;
    SKYLAKEX) needs=avx512f ;;
    SANDYBRIDGE) needs=avx ;;
  esac
  if ! grep -qw "$needs" /proc/cpuinfo; then
    echo "$kernels: left out, this processor has no $needs"
    continue
  fi
  run state solve partly_closed mesh.size=0.1
  run adjoint map tracking_map
  run level_set optimize cantilever optimize.max_iterations=10
  run drawn optimize cracked_plate optimize.max_iterations=10 mesh.size=0.15
  compared+=("$kernels")
done
[ ${#compared[@]} -ge 2 ] || { echo "skipped: one kernel alone has nothing to be compared with"; exit 77; }
python3 - "$folder" "${compared[@]}" <<'PYTHON'
import json
import pathlib
import sys

folder, kernels = pathlib.Path(sys.argv[1]), sys.argv[2:]


def numbers(at):
    """Every file by name; result.json without what a clock and an allocator say."""
    files = {}
    for path in sorted(p for p in at.rglob("*") if p.is_file() and p.suffix in (".json", ".csv")):
        text = path.read_text()
        if path.name == "result.json":
            result = json.loads(text)
            del result["time_s"], result["peak_memory_mb"]
            text = json.dumps(result, indent=1)
        files[str(path.relative_to(at))] = text
    return files


first = numbers(folder / kernels[0])
bad = 0
for other in kernels[1:]:
    there = numbers(folder / other)
    for name in sorted(first.keys() | there.keys()):
        if first.get(name) != there.get(name):
            print(f"{name}: {other} has other bits than {kernels[0]}")
            bad = 1
print(f"{len(first)} files, compared with the kernels of {', '.join(kernels)}")
sys.exit(bad)
PYTHON
