#!/usr/bin/env bash
# archive.sh SOURCE BUILD [SUITE]: the archive of a build, unpacked, takes no library from elsewhere but glibc; in a bare Debian 13,
# where nothing was installed (debootstrap, as root), it gives the showcase to the bit, with letters in its pictures.
# Without root or debootstrap the second part is skipped (exit 77).
set -euo pipefail
source=$(realpath "$1") build=$(realpath "$2")
. "$source/tests/install/bare.sh"
start_folder

/usr/bin/python3 "$source/cmake/portable.py" "$build" "$folder/made" archive
tar -C "$folder" -xf "$folder"/made/kerf-*.tar.xz
archive=$(echo "$folder"/kerf-*/)
refuse_foreign "$archive"
for file in LICENSE README lib/kerf/fonts.conf share/doc/kerf/licences/{sources.tsv,libcholmod*.txt,libeigen3-dev.txt,fonts-dejavu-core.txt,GPL-2}; do
  ls "$archive"/$file >/dev/null
done
"$build/kerf" run "$source/cases/cracked_plate.toml" -o "$folder/expected" --quiet
can_make_bare || { echo "skipped in a bare Debian: it needs root and debootstrap"; exit 77; }

make_bare "${3:-trixie}"
mkdir "$root/opt/kerf"
tar -C "$root/opt/kerf" --strip-components=1 -xf "$folder"/made/kerf-*.tar.xz
kerf=/opt/kerf/bin/kerf
in_root $kerf --version
before=$(date +%s%N)
in_root $kerf --version >/dev/null
echo "starts in $((($(date +%s%N) - before) / 1000000)) ms"
in_root $kerf run /opt/kerf/share/kerf/cases/cracked_plate.toml -o /out --quiet
in_root /opt/kerf/bin/kerf-bench --list >/dev/null
python3 "$source/tests/install/same_results.py" "$folder/expected" "$root/out"
