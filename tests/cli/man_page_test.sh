#!/usr/bin/env bash
# The manual pages as their readers get them: no program that shows manual pages complains, and every example can be run.
# usage: man_page_test.sh SERVOCTL
set -euo pipefail
servoctl=$(readlink -f "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"$servoctl" man >servoctl.1
"$servoctl" man --lang zh >servoctl.zh.1

complaints=""
checked=""
complain() {
  checked+=" $1"
  [ -z "$2" ] || complaints+="$1: $2"$'\n'
}
# Lines of more than 80 columns, of which Chinese takes two for a character.
too_wide() {
  python3 -c 'import re, sys, unicodedata
for line in open(sys.argv[1], encoding="utf-8"):
    line = re.sub(".\x08", "", line.rstrip("\n"))
    if sum(2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in line) > 80: print(line)' "$1"
}
export LC_ALL=C.UTF-8 MANROFFSEQ='' MANWIDTH=80
for page in servoctl.1 servoctl.zh.1; do
  if command -v groff >/dev/null; then complain groff "$(groff -k -man -ww -Tutf8 "$page" 2>&1 >/dev/null)"; fi
  if command -v man >/dev/null && man --version >/dev/null 2>&1; then
    complain man "$(man --warnings -E UTF-8 -l "$page" 2>&1 >shown)"
    complain "width of $page" "$(too_wide shown)"
    complain "NAME of $page" "$(lexgrog "$page" | grep -vE 'servoctl - .*(commission|调试)' || true)"
  fi
  # Chinese has long words, at the ends of which mandoc breaks lines.
  if command -v mandoc >/dev/null; then complain mandoc "$(mandoc -Tlint -W "$([ "$page" = servoctl.1 ] && echo all || echo warning)" "$page" 2>&1 || true)"; fi
done
if command -v groff >/dev/null; then complain groff-ascii "$(groff -man -ww -Tascii servoctl.1 2>&1 >/dev/null)"; fi
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
echo "checked:${checked:-" nobody: man, groff and mandoc are missing"}; $(wc -l <examples) examples"
