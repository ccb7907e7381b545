#!/usr/bin/env bash
# man.sh PROGRAM PAGE.gz: the manual page of a program from its --help, with a section per command.
set -euo pipefail
program=$1 page=$2
more=$(mktemp)
trap 'rm -f "$more"' EXIT
name="topological derivatives for plane elastic bodies with cracks in contact"
version=$("$program" --version 2>/dev/null || "$(dirname "$program")/kerf" --version)
if [ "$(basename "$program")" = kerf-bench ]; then
  name="speed against error of kerf"
  printf '[SEE ALSO]\n.BR kerf (1)\n' >"$more"
else
  {
    for command in $("$program" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]\+\) .*/\1/p'); do
      [ "$command" = bench ] && continue
      printf '/OPTIONS OF KERF %s/\n' "${command^^}" | sed 's|^/|[|; s|/$|]|'
      printf '.nf\n'
      "$program" "$command" --help | sed 's/\\/\\e/g; s/^\./\\\&./; s/-/\\-/g'
      printf '.fi\n\n'
    done
    printf '[FILES]\nThe keys of case files are told by\n.B kerf keys\nand in /usr/share/doc/kerf/case-files;\ncases to begin from are in /usr/share/kerf/cases.\n'
  } >"$more"
fi
help2man --no-info --name="$name" --version-string="$(sed -n '1s/.* //p' <<<"$version")" --include="$more" "$program" | gzip -9n >"$page"
