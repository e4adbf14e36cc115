#!/usr/bin/env bash
# The manual page as its readers get it: no program that shows manual pages complains, and every example can be run.
# usage: man_page_test.sh SERVOCTL
set -euo pipefail
servoctl=$(readlink -f "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"$servoctl" man >servoctl.1

complaints=""
checked=""
complain() {
  checked+=" $1"
  [ -z "$2" ] || complaints+="$1: $2"$'\n'
}
export LC_ALL=C.UTF-8 MANROFFSEQ='' MANWIDTH=80
if command -v groff >/dev/null; then
  complain groff "$(groff -man -ww -Tutf8 servoctl.1 2>&1 >/dev/null)"
  complain groff-ascii "$(groff -man -ww -Tascii servoctl.1 2>&1 >/dev/null)"
fi
if command -v man >/dev/null && man --version >/dev/null 2>&1; then complain man "$(man --warnings -E UTF-8 -l servoctl.1 2>&1 >/dev/null)"; fi
if command -v mandoc >/dev/null; then complain mandoc "$(mandoc -Tlint servoctl.1 2>&1 || true)"; fi
if [ -n "$complaints" ]; then
  printf '%s' "$complaints" >&2
  exit 1
fi

# Each example is a line that the program takes; those on a bus are checked without it.
sed -n '/^\.SH EXAMPLES/,/^\.SH SEE/s/^\\fBservoctl \(.*\)\\fR$/\1/p' servoctl.1 | sed 's/\\-/-/g; s/\\(aq/'"'"'/g' >examples
[ "$(wc -l <examples)" -ge 8 ] || { echo "the examples are not found" >&2; exit 1; }
"$servoctl" backup good.json -b sim:gsd600@1 -n 1 -d gsd600 >/dev/null 2>&1
while IFS= read -r line; do
  printf '%s\n' "$line" >line
  "$servoctl" run --check line >answer 2>&1 || { echo "an example does not work: $line" >&2; cat answer >&2; exit 1; }
done <examples
echo "shown by${checked:-" nobody: man, groff and mandoc are missing"}; $(wc -l <examples) examples"
