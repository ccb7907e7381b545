#!/usr/bin/env bash
# format.sh SOURCE: every source is as ./dev format leaves it. Other versions break lines elsewhere, so that the one of
# Debian 12 decides; where it is missing, nothing is checked.
set -euo pipefail
cd "$1"
version=14
for format in clang-format-$version clang-format none; do
  "$format" --version 2>/dev/null | grep -q "version $version\." && break
done
[ "$format" != none ] || { echo "skipped: clang-format $version is not installed"; exit 77; }
find app base bench examples geometry growth include inspect io optimize plot python solver tests topo \( -name '*.cpp' -o -name '*.hpp' \) -print0 |
  xargs -0 "$format" --dry-run --Werror || { echo "run ./dev format"; exit 1; }
