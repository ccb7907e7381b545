#!/usr/bin/env bash
# sanitize.sh BUILD JOBS: 500 fuzzed inputs, Python's module and the quick tests in a build with AddressSanitizer, UBSan and
# assertions.
# What it leaves out takes more than a second in a Release build: there it runs in full (./dev test).
set -euo pipefail
build=$1 jobs=$2
export OPENBLAS_NUM_THREADS=1
# What a time limit must not cut off comes first. Python itself has no sanitizers: CTest preloads libasan
# (python/CMakeLists.txt).
status=0
ASAN_OPTIONS=detect_leaks=0:exitcode=99:handle_sigill=1 ctest --test-dir "$build" -R '^(fuzz|python_test_api)$' \
  -j "$jobs" --output-on-failure || status=1
# Leaks are looked for in the tests of rooms alone: fontconfig, gmsh and VTK keep what they took until the end.
slow=$(dirname "$0")/slow_tests.txt
filter="-$(grep -v '^#' "$slow" | paste -sd:)"
run() {  # run LEAKS PROGRAM
  local leaks=$1 program=$2
  [ -x "$build/$program" ] || return 0
  echo "== $program"
  ASAN_OPTIONS=detect_leaks=$leaks:exitcode=99:handle_sigill=1 "$build/$program" --gtest_brief=1 --gtest_filter="$filter"
}
export -f run
export build filter
printf '%s\n' '1 test_solver' '1 test_topo' '1 test_optimize' '0 test_io' '1 test_geometry' '0 test_plot' |
  xargs -P "$jobs" -I{} bash -c 'run {}' || status=1
exit $status
