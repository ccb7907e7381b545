#!/usr/bin/env bash
# Coverage-guided fuzzers, one per parser (tests/fuzz/parsers/*.cpp, whose first lines say what is promised), by libFuzzer
# with AddressSanitizer and UBSan. What one finds fails, and stays under out/fuzz.
#   parsers.sh list                            the names of all
#   parsers.sh build BUILD JOBS                by clang, into BUILD/parsers; needs kerf and its libraries in BUILD
#   parsers.sh run BUILD JOBS SECONDS [PARSER...]  each for so many seconds; corpus kept in BUILD/parsers/corpus
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
all=$(cd "$root/tests/fuzz/parsers" && ls ./*.cpp | sed 's|^\./||; s|\.cpp$||')

# seeds PARSER FOLDER: files to begin with, from cases, tests' data and results of kerf itself.
seeds() {
  local parser=$1 to=$2 f
  case $parser in
    case)
      for f in "$root"/cases/*.toml "$root"/tests/fuzz/corpus/*.toml; do
        { sed -E 's|"[^"]*\.msh"|"a.msh"|; s|"[^"]*\.csv"|"a.csv"|' "$f"
          if grep -qE '\.(msh|csv)"' "$f"; then
            printf '\n%%%%\n'; cat "$root/tests/fuzz/corpus/tiny.msh"
            printf '\n%%%%\n'; cat "$root/tests/fuzz/corpus/points.csv"
          fi; } >"$to/$(basename "$f")"
      done
      ;;
    design)
      for f in "$root"/cases/*.toml; do
        grep -q outline "$f" || continue
        awk '/^\[/ { body = /^\[+(domain|hole|crack|region|material)/ } body' "$f" >"$to/$(basename "$f")"
      done
      cp "$runs/level_set/design.toml" "$runs/drawn/design.toml" "$to" 2>/dev/null || true
      ;;
    formula)
      grep -hoE '"[^"]*[-+*/^?(<>][^"]*"' "$root"/cases/*.toml "$root"/tests/fuzz/corpus/*.toml | tr -d '"' | sort -u |
        split -l 1 - "$to/formula-"
      printf 'a=x^2+1\nb=a*sin(y)\nb > a ? sqrt(b) : atan2(a, -b)' >"$to/definitions"
      printf 'min(x,y,0.5)+max(abs(x),rint(y))-sign(x)*exp(-y)+log(2)*tanh(x)' >"$to/functions"
      ;;
    mesh) cp "$root"/tests/data/meshes/*.msh "$root"/cases/*.msh "$root"/tests/fuzz/corpus/*.msh "$to" ;;
    override) printf 'mesh.size=0.02\nhole[0].circle.radius=[1, 2]\nhole.h.name="g"\ntitle=a word\nx.y={ z = 1e3 }' >"$to/a" ;;
    table)
      cp "$root/tests/fuzz/corpus/points.csv" "$to"
      printf 'x, y ,u_x,note\n0,1.5,-1e-3,a\r\n\n2,0.25,1,\n' >"$to/readings.csv"
      cp "$runs"/solve/*.csv "$to" 2>/dev/null || true
      ;;
    arrays) for f in "$runs"/{solve,level_set,drawn}/report.bin; do cp "$f" "$to/$(basename "$(dirname "$f")")"; done ;;
    result)
      for f in "$runs"/*/result.json; do
        local folder
        folder=$(dirname "$f")
        { cat "$f"; printf '\n%%%%\n'; cat "$folder/history.csv" 2>/dev/null || true
          printf '\n%%%%\n'; cat "$folder/crack_c.csv" 2>/dev/null || true; } >"$to/$(basename "$folder")"
      done
      ;;
    checkpoint)  # without magic, version, length, and checksum
      for f in "$runs"/*/checkpoint.bin "$runs"/*/checkpoint.strip; do
        [ -f "$f" ] && head -c -8 "$f" | tail -c +21 >"$to/$(basename "$(dirname "$f")")-$(basename "$f")"
      done
      ;;
  esac
}

# make_runs KERF: results of small runs, whose files are seeds.
make_runs() {
  local small=$root/tests/fuzz/corpus/small.toml quick="--force --log-level off --set mesh.size=0.3 --set mesh.crack_tip_size=0.1"
  [ ! -d "$runs" ] || return 0
  mkdir -p "$runs.part"
  $1 solve "$small" -o "$runs.part/solve" $quick
  $1 run "$small" -o "$runs.part/run" $quick --set optimize.max_iterations=2 || true
  $1 optimize "$small" -o "$runs.part/level_set" $quick --set optimize.max_iterations=3 || true
  $1 optimize "$root/cases/inverse_hole.toml" -o "$runs.part/drawn" --force --log-level off --set mesh.size=0.3 \
    --set optimize.max_iterations=3 || true
  $1 solve "$root/cases/unloading_crack.toml" -o "$runs.part/steps" --force --log-level off --set mesh.size=0.3 || true
  rm -rf "$runs" && mv "$runs.part" "$runs"
}

# words PARSER: a dictionary of libFuzzer.
words() {
  case $1 in
    case | design | override) "$kerf" keys --markdown | grep -oE '[A-Za-z_][A-Za-z_.-]{2,}' | sort -u ;;
    formula) printf '%s\n' sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh log log2 log10 ln exp sqrt sign rint \
      abs min max sum avg pi E nu x y nx ny '&&' '||' '<=' '>=' '==' '!=' '? 0 : 1' '1e308' '1e-308' ;;
    mesh) printf '%s\n' '$MeshFormat' '$EndMeshFormat' '$PhysicalNames' '$EndPhysicalNames' '$Entities' '$EndEntities' '$Nodes' \
      '$EndNodes' '$Elements' '$EndElements' '$PartitionedEntities' '$Comments' '2.2 0 8' '4.1 0 8' '4.1 1 8' 'crack:c' nan 1e308 \
      9223372036854775807 -2147483648 ;;
    arrays) printf '%s\n' 'kerf arrays 1' f32 u32 triangles points outline design.shots design.lines found.lines 1099511627776 ;;
    result) { cat "$runs"/*/result.json | grep -oE '"[A-Za-z_]+"' | tr -d '"' | sort -u; printf '%s\n' null 1e300 -1 true %%; } ;;
    checkpoint) printf '%s\n' scalars rows notes nucleated curves track best anchor best_bounds best_scalars stride last \
      last.boundary 0000 0000.boundary 0000.cracks ;;
    table) printf '%s\n' x,y,u_x nan inf 1e999 ;;
  esac | sed 's/\\/\\\\/g; s/"/\\"/g; s/.*/"&"/'
}

# fuzz PARSER SECONDS
fuzz() {
  local parser=$1 corpus=$build/parsers/corpus/$1 begin=$build/parsers/seeds/$1 most=20000 said=$build/parsers/$1.log code=0
  mkdir -p "$corpus" "$begin" "$found"
  seeds "$parser" "$begin"
  words "$parser" >"$build/parsers/$parser.dict"
  case $parser in mesh | checkpoint | arrays | result) most=100000 ;; esac
  # No leak is looked for: what is kept for the next evaluation is none. 1 GB and 10 s are the promise.
  ASAN_OPTIONS=detect_leaks=0:quarantine_size_mb=16:allocator_may_return_null=1 TMPDIR=$shared \
    "$build/parsers/$parser" -max_total_time="$2" -timeout=10 -rss_limit_mb=1024 -max_len=$most -len_control=20 -dict="$build/parsers/$parser.dict" \
    -artifact_prefix="$found/$parser-" -print_final_stats=1 "$corpus" "$begin" >"$said" 2>&1 || code=$?
  local last
  last=$(grep -E '^#[0-9]+.*cov:' "$said" | tail -n 1 || true)
  if [ $code -ne 0 ]; then
    grep -nE 'broken promise|ERROR:|runtime error|SUMMARY|Test unit written|Assertion|terminate' "$said" | head -n 20
    echo "$parser: FOUND something (exit $code); the input is $found/$parser-*, all that was said is $said"
    return 1
  fi
  echo "$parser: nothing found; $(sed -nE 's/^stat::number_of_executed_units: *//p' "$said") executions, $(
    sed -nE 's/.*cov: ([0-9]+) .*/\1/p' <<<"$last") edges, $(find "$corpus" -type f | wc -l) inputs kept"
}

case ${1:-} in
  list) echo $all; exit ;;
  build | run) ;;
  *) sed -n '2,7s/^# *//p' "$0"; exit 2 ;;
esac
build=$(realpath "$2") jobs=$3 kerf=$(realpath "$2")/kerf runs=$(realpath "$2")/parsers/runs found=${KERF_FOUND:-$root/out/fuzz}
compiler=$(command -v clang++-14 || command -v clang++ || true)
[ -n "$compiler" ] || { echo "clang++ is not installed (clang-14, libclang-rt-14-dev): skipped"; exit 77; }
if [ "$1" = build ] || [ ! -f "$build/parsers/build.ninja" ]; then
  cmake -S "$root/tests/fuzz/parsers" -B "$build/parsers" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DKERF_BUILD="$build" >/dev/null
fi
cmake --build "$build/parsers" -j "$jobs"
[ "$1" = run ] || exit 0

seconds=$4 failed=0
shift 4
shared=$(mktemp -d "$([ -w /dev/shm ] && echo /dev/shm || echo /tmp)/kerf-parsers-XXXXXX")
trap 'rm -rf "$shared"' EXIT
make_runs "$kerf"
pids=()
for parser in ${*:-$all}; do
  grep -qxF "$parser" <<<"$all" || { echo "no parser is called $parser; there are" $all >&2; exit 2; }
  while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do sleep 0.2; done
  fuzz "$parser" "$seconds" &
  pids+=($!)
done
for pid in "${pids[@]}"; do wait "$pid" || failed=1; done
exit $failed
