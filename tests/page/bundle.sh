#!/usr/bin/env bash
# The committed script and style of the page are what esbuild makes of their sources, byte by byte.
set -euo pipefail
from=$1/plot/page/browser
if ! command -v esbuild >/dev/null; then
  echo "skipped: esbuild is not installed"
  exit 77
fi
to=$(mktemp -d)
trap 'rm -r "$to"' EXIT
bash "$from/build.sh" "$to"
for file in bundle.js bundle.css; do
  cmp "$from/$file" "$to/$file" || { echo "$file is stale: run plot/page/browser/build.sh plot/page/browser"; exit 1; }
done
