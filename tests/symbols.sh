#!/usr/bin/env bash
# symbols.sh BUILD: no weak symbol that names something of an unnamed namespace may be defined in two files: the linker keeps
# one of them, though they are different. g++ 13 and newer make such symbols of templates over constants (GCC 12 keeps them local).
# And no program or module may look for libraries in the folder where the user stands: an empty or relative part of its RUNPATH.
set -euo pipefail
cd "$1"
twice=$(nm --print-file-name --defined-only libkerf_*.a | awk '$2 ~ /^[WV]$/ && $3 ~ /_GLOBAL__N_/ {print $3, $1}' |
  sed 's/:[^:]*$//' | sort -u | awk '{print $1}' | uniq -d | c++filt)
[ -z "$twice" ] || { echo "defined in two files:"; echo "$twice" | head -n 20; exit 1; }
found=0
for file in kerf kerf-bench kerf_*.so python/kerf/*.so; do
  [ -f "$file" ] || continue
  found=$((found + 1))
  paths=$(readelf -d "$file" | sed -nE 's/.*\((RPATH|RUNPATH)\).*\[(.*)\]/\2/p')
  if [ -n "$paths" ] && tr ':' '\n' <<<"$paths" | grep -qvE '^(/|\$ORIGIN)'; then
    echo "$file looks for libraries where the user stands: $paths"
    exit 1
  fi
done
[ $found -gt 0 ]
