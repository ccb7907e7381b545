#!/usr/bin/env bash
# build.sh FOLDER: makes bundle.js and bundle.css there, by Debian's esbuild, from the sources beside this file.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
to=$(realpath "$1")
cd "$here"
part=$(mktemp -d)
trap 'rm -r "$part"' EXIT
for kind in js css; do
  source=main.js; [ $kind = css ] && source=page.css
  esbuild "$source" --bundle --minify --target=es2020 --charset=utf8 --log-level=warning --outfile="$part/kerf.$kind"
done
# uPlot as its makers ship it; its license takes the place of the first line, a comment with an address.
{ echo "/* uPlot 1.6.32"; cat uplot/LICENSE; echo "*/"; tail -n +2 uplot/uPlot.iife.min.js; cat "$part/kerf.js"; } >"$to/bundle.js"
{ cat uplot/uPlot.min.css; echo; cat "$part/kerf.css"; } >"$to/bundle.css"
