#!/usr/bin/env bash
# wheel.sh SOURCE BUILD: the wheel of a build has metadata and takes no libraries from elsewhere but those that wheels share;
# in a bare system of this Debian (debootstrap, as root), with Debian's numpy in place of a Python index, pip installs it, and
# its command and its module give the showcase to the bit. Without root or debootstrap the second part is skipped (exit 77).
set -euo pipefail
source=$(realpath "$1") build=$(realpath "$2")
. "$source/tests/install/bare.sh"
start_folder

/usr/bin/python3 "$source/cmake/portable.py" "$build" "$folder/made" wheel
wheel=$(basename "$folder"/made/kerf_mechanics-*-manylinux_2_*.whl)
mkdir "$folder/unpacked"
/usr/bin/python3 -m zipfile -e "$folder/made/$wheel" "$folder/unpacked"
refuse_foreign "$folder/unpacked" 'libstdc\+\+|libgcc_s'
metadata=$(cat "$folder"/unpacked/kerf_mechanics-*.dist-info/METADATA)
for line in 'Name: kerf-mechanics' "Version: $(cat "$source/VERSION")" 'Summary: Topological' 'Author: The kerf developers' 'License: GPL-3.0-or-later'; do
  grep -q "^$line" <<<"$metadata" || { echo "the metadata have no line $line"; exit 1; }
done
"$build/kerf" run "$source/cases/cracked_plate.toml" -o "$folder/expected" --quiet
can_make_bare || { echo "skipped in a bare Debian: it needs root and debootstrap"; exit 77; }

make_bare "$(. /etc/os-release && echo "$VERSION_CODENAME")"
quietly in_root apt-get update -q
quietly in_root apt-get install -y -q --no-install-recommends python3-venv python3-numpy
cp "$folder/made/$wheel" "$source/cases/cracked_plate.toml" "$root/"
in_root python3 -m venv --system-site-packages /venv
in_root /venv/bin/pip install --no-index "/$wheel"
in_root /venv/bin/kerf --version
in_root /venv/bin/kerf run /cracked_plate.toml -o /out --quiet
python3 "$source/tests/install/same_results.py" "$folder/expected" "$root/out"
in_root /venv/bin/python3 -c '
import kerf
kerf.Case("/cracked_plate.toml").run("/module")'
python3 "$source/tests/install/same_results.py" "$folder/expected" "$root/module"
in_root /venv/bin/pip uninstall -y -q kerf-mechanics
left=$(find "$root/venv" -name '*kerf*')
[ -z "$left" ] || { echo "left after pip uninstall: $left"; exit 1; }
