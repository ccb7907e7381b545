#!/usr/bin/env bash
# sanitize.sh BUILD JOBS PART: one part of the quick tests in a build with AddressSanitizer, UBSan and assertions: engine,
# program (500 fuzzed inputs), maps, designs, or files (with Python's module).
# What it leaves out takes more than a second in a Release build: there it runs in full (./dev test).
set -euo pipefail
build=$1 jobs=$2 part=$3
export OPENBLAS_NUM_THREADS=1
options=exitcode=99:handle_sigill=1
slow=$(dirname "$0")/slow_tests.txt
filter="-$(grep -v '^#' "$slow" | paste -sd:)"
status=0
by_ctest() {  # by_ctest REGEX
  ASAN_OPTIONS=detect_leaks=0:$options ctest --test-dir "$build" -R "$1" -j "$jobs" --no-tests=error --output-on-failure || status=1
}
# run LEAKS PROGRAM: in as many processes as there are jobs, each with every so manieth test.
run() {
  local leaks=$1 program=$2 pids=() shard
  echo "== $program"
  for ((shard = 0; shard < jobs; ++shard)); do
    GTEST_TOTAL_SHARDS=$jobs GTEST_SHARD_INDEX=$shard ASAN_OPTIONS=detect_leaks=$leaks:$options \
      "$build/$program" --gtest_brief=1 --gtest_filter="$filter" &
    pids+=($!)
  done
  for pid in "${pids[@]}"; do wait "$pid" || status=1; done
}
# Leaks are looked for in the tests of rooms alone: fontconfig, gmsh and VTK keep what they took until the end. Python itself
# has no sanitizers: CTest preloads libasan (python/CMakeLists.txt).
case $part in
  engine) run 1 test_geometry; run 1 test_solver ;;
  program) by_ctest '^fuzz$' ;;
  maps) run 1 test_topo ;;
  designs) run 1 test_optimize ;;
  files) run 0 test_io; run 0 test_plot; by_ctest '^python_test_api$' ;;
  *) echo "no part is called $part" >&2; exit 2 ;;
esac
exit $status
