#!/usr/bin/env bash
# install.sh SOURCE BUILD package|sources: the example, built against an installed kerf or within its own build, runs.
set -euo pipefail
source=$1 build=$2 how=$3
folder=$build/install_test/$how
rm -rf "$folder"
mkdir -p "$folder"
options=(-G Ninja -DCMAKE_BUILD_TYPE=Release)
command -v ccache >/dev/null && options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
if [ "$how" = package ]; then
  cmake --install "$build" --prefix "$folder/prefix" >"$folder/install.log"
  if grep -rlE '#include "(base|geometry|solver|topo|optimize|io)/' "$folder/prefix/include"; then
    echo "installed headers include private ones"
    exit 1
  fi
  # Whoever links kerf chooses the instruction set: alignment must not depend on it.
  cmake -S "$source/examples" -B "$folder/build" "${options[@]}" -DCMAKE_PREFIX_PATH="$folder/prefix" -DCMAKE_CXX_FLAGS=-march=x86-64
else
  cmake -S "$source/examples" -B "$folder/build" "${options[@]}" -DKERF_SOURCE="$source"
fi
cmake --build "$folder/build" --target map
said=$("$(find "$folder/build" -type f -name map -perm -u+x)")
echo "$said"
grep -q 'it holds$' <<<"$said"
if [ "$how" = package ]; then
  "$folder/prefix/bin/kerf" --version
  "$folder/prefix/bin/kerf" solve "$source/cases/edge_crack.toml" -o "$folder/out" >/dev/null
  test -s "$folder/out/state.vtu"
fi
