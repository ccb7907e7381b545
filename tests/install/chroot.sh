#!/usr/bin/env bash
# chroot.sh PACKAGES [SUITE]: the Debian packages in a bare system of the Debian that they were made on (debootstrap, as
# root; bookworm or trixie, this machine's if not said): installed, a case run, the example of a user of the library built
# and run, all purged. Says how long each took and what it brought. KERF_BARE keeps the bare systems for the next time.
set -euo pipefail
packages=$(realpath "$1") here=$(dirname "$(realpath "$0")")
suite=${2:-$(. /etc/os-release && echo "$VERSION_CODENAME")}
. "$here/bare.sh"
start_folder
step=$(date +%s)
lap() {
  local now
  now=$(date +%s)
  printf '%-44s %4d s, %4d packages, %5d MB\n' "$1" $((now - step)) "$(chroot "$root" dpkg-query -W | wc -l)" \
    "$(du -sm --exclude="$root/proc" --exclude="$root/var/cache" --exclude="$root/var/lib/apt" "$root" | cut -f1)"
  step=$now
}
make_bare "$suite"
mkdir "$root/packages" && cp "$packages"/*.deb "$root/packages"
cp -r "$here/consumer" "$root/consumer"
quietly in_root apt-get update -q
lap "bare system"
before=$(in_root dpkg-query -W -f='${Package}\n')

quietly in_root sh -c 'apt-get install -y -q --no-install-recommends libopenblas0-pthread /packages/kerf_*.deb'
lap "kerf installed"
in_root kerf --version
in_root kerf run /usr/share/kerf/cases/edge_crack.toml -o /out --quiet
test -s "$root/out/report.html" && test -s "$root/out/von_mises.png" && test ! -e "$root/out/state.vtu"
test -s "$root/usr/share/man/man1/kerf.1.gz" && test -s "$root/usr/share/bash-completion/completions/kerf"
in_root kerf run /out/case.toml -o /again --quiet
cmp "$root/out/map.csv" "$root/again/map.csv" 2>/dev/null || test ! -e "$root/out/map.csv"
lap "kerf run, twice"

quietly in_root sh -c 'apt-get install -y -q --no-install-recommends /packages/kerf-vtk_*.deb'
in_root kerf solve /usr/share/kerf/cases/edge_crack.toml -o /vtk --quiet
test -s "$root/vtk/state.vtu"
lap "kerf-vtk installed, a state written"

if ls "$root"/packages/kerf-gmsh_*.deb >/dev/null 2>&1; then
  quietly in_root sh -c 'apt-get install -y -q --no-install-recommends /packages/kerf-gmsh_*.deb'
  in_root kerf mesh /usr/share/kerf/cases/gmsh_plate.toml --set domain.file=gmsh_plate.geo -o /plate.msh --quiet
  test -s "$root/plate.msh"
  lap "kerf-gmsh installed, a drawing meshed"
fi

quietly in_root sh -c 'apt-get install -y -q --no-install-recommends cmake make /packages/libkerf-dev_*.deb'
lap "libkerf-dev installed"
quietly in_root sh -c 'cmake -S /consumer -B /consumer/build && cmake --build /consumer/build'
in_root /consumer/build/consumer
lap "a user of the library built and run"

quietly in_root sh -c 'apt-get purge -y -q kerf kerf-vtk "kerf-gmsh*" libkerf-dev && apt-get autoremove --purge -y -q'
left=$(find "$root/usr" "$root/etc" "$root/var/lib" -name '*kerf*' -not -path '*/apt/*' | head)
[ -z "$left" ] || { echo "left after purge: $left"; exit 1; }
lap "purged"
gone=$(comm -13 <(sort <<<"$before") <(in_root dpkg-query -W -f='${Package}\n' | sort) | tr '\n' ' ')
echo "packages that stay, asked for by name above: $gone"
