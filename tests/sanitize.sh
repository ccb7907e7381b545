#!/usr/bin/env bash
# The quick tests in a build with AddressSanitizer, UBSan and assertions (./dev sanitize), in parts with a limit of time
# each; what does not end within it fails. tests/slow_tests.txt says what takes too long there: the full lane runs it.
#   sanitize.sh parts               the names of all parts
#   sanitize.sh touched < FILES     the parts that test the sources among these files
#   sanitize.sh targets PART        what has to be built for it
#   sanitize.sh run BUILD JOBS PART
set -euo pipefail
all=(engine program maps designs files)
describe() {  # describe PART: its rooms, targets and minutes
  case $1 in
    engine) rooms="growth geometry solver" targets="test_growth test_geometry test_solver" minutes=25 ;;
    program) rooms="app tests/fuzz" targets="kerf kerf_vtk_module kerf-fuzz" minutes=22 ;;
    maps) rooms="topo inspect" targets="test_topo test_inspect" minutes=20 ;;
    designs) rooms="optimize" targets="test_optimize" minutes=15 ;;
    files) rooms="io plot python" targets="kerf_python test_io test_plot" minutes=10 ;;
    *) echo "no part is called $1; there are ${all[*]}" >&2; exit 2 ;;
  esac
}
case ${1:-} in
  parts) echo "${all[@]}"; exit ;;
  targets) describe "$2"; echo "$targets"; exit ;;
  touched)
    files=$(cat)
    for part in "${all[@]}"; do
      describe "$part"
      for room in $rooms; do
        ! grep -qE "^(tests/)?$room/" <<<"$files" || { echo "$part"; break; }
      done
    done
    exit
    ;;
  run) build=$2 jobs=$3 part=$4; describe "$part" ;;
  *) sed -n '2,7s/^# *//p' "$0"; exit 2 ;;
esac

export OPENBLAS_NUM_THREADS=1
options=exitcode=99:handle_sigill=1
filter="-$(sed -nE 's/^(slow|nightly|sanitizers) +//p' "$(dirname "$0")/slow_tests.txt" | paste -sd:)"
end=$((SECONDS + 60 * minutes)) status=0
# limited COMMAND...: within what is left of the part's time.
limited() {
  local code=0
  timeout $((end > SECONDS ? end - SECONDS : 1)) "$@" || code=$?
  [ $code -ne 124 ] || echo "$part: did not end within $minutes minutes: $*"
  return $code
}
by_ctest() {  # by_ctest REGEX
  ASAN_OPTIONS=detect_leaks=0:$options limited ctest --test-dir "$build" -R "$1" -j "$jobs" --no-tests=error \
    --output-on-failure || status=1
}
# run LEAKS PROGRAM: in as many processes as there are jobs, each with every so manieth test.
run() {
  local leaks=$1 program=$2 pids=() shard
  echo "== $program"
  for ((shard = 0; shard < jobs; ++shard)); do
    GTEST_TOTAL_SHARDS=$jobs GTEST_SHARD_INDEX=$shard ASAN_OPTIONS=detect_leaks=$leaks:$options \
      limited "$build/$program" --gtest_brief=1 --gtest_filter="$filter" &
    pids+=($!)
  done
  for pid in "${pids[@]}"; do wait "$pid" || status=1; done
}
# Leaks are looked for in the tests of rooms alone: fontconfig, gmsh and VTK keep what they took until the end. Python itself
# has no sanitizers: CTest preloads libasan (python/CMakeLists.txt).
case $part in
  engine) run 1 test_growth; run 1 test_geometry; run 1 test_solver ;;
  program) by_ctest '^fuzz$' ;;
  maps) run 1 test_topo; run 1 test_inspect ;;
  designs) run 1 test_optimize ;;
  files) run 0 test_io; run 0 test_plot; by_ctest '^python_test_api$' ;;
esac
exit $status
