# A bare Debian for the tests of artefacts, to be sourced: $root, in_root COMMAND..., quietly COMMAND...
# KERF_BARE keeps the bare systems for the next time.

can_make_bare() {
  [ "$(id -u)" -eq 0 ] && command -v debootstrap >/dev/null
}

quietly() {
  "$@" >"$folder/log" 2>&1 || { tail -30 "$folder/log"; exit 1; }
}

make_bare() {  # make_bare SUITE: sets root
  local bare=${KERF_BARE:-$folder}/$1
  root=$folder/root
  mkdir -p "$bare"
  [ -e "$bare/whole" ] || quietly debootstrap --variant=minbase "$1" "$bare"
  touch "$bare/whole"
  cp -a "$bare" "$root"
  mount -t proc proc "$root/proc"
  cp /etc/resolv.conf "$root/etc/resolv.conf"
}

in_root() {
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 HOME=/root "$@"
}

# start_folder: a folder that goes with the script; the bare system's /proc before it.
start_folder() {
  folder=$(mktemp -d)
  trap 'mountpoint -q "$folder/root/proc" && umount "$folder/root/proc"; rm -rf --one-file-system "$folder"' EXIT
}

# refuse_foreign FOLDER [ALLOWED]: fails where programs and libraries there load others from elsewhere, glibc's apart.
refuse_foreign() {
  local loaded foreign
  loaded=$(find "$1" -type f \( -name '*.so*' -o -perm -u+x \) -exec ldd {} \; 2>/dev/null | grep -oE '=> (/\S+|not found)' | sort -u)
  grep -qF "=> $(realpath "$1")/" <<<"$loaded" || { echo "nothing in $1 loads a library from there"; exit 1; }
  foreign=$(grep -vF "=> $(realpath "$1")/" <<<"$loaded" |
    grep -vE "/(libc|libm|libpthread|libdl|librt|libmvec|libresolv|libutil${2:+|$2})\.so\.[0-9]+$" || true)
  [ -z "$foreign" ] || { echo "libraries from elsewhere: $foreign"; exit 1; }
}
