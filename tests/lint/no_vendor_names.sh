#!/usr/bin/env bash
# No C++ code names a vendor or a family: what is special about a drive stands in eds/. Examples in help texts may name a
# family, so string literals of commands/ and src/cli are exempt.
# usage: no_vendor_names.sh SOURCE_DIR
set -euo pipefail
cd "$1"
# Vendors are the folders of eds/, families the files in them; cia/ holds the standard and no vendor.
names=$(find eds -mindepth 1 -maxdepth 2 \( -type d -o -name '*.eds' \) -not -path 'eds/cia*' -printf '%f\n' |
  sed 's/\.eds$//' | sort -u | sed 's/.*/\\b&\\b/' | paste -sd '|')
[ "$(tr '|' '\n' <<<"$names" | wc -l)" -ge 9 ] || { echo "only these names were found in eds/: $names"; exit 1; }
names="$names|Pn0[0-9]{3}|Fn_[0-9A-F]|Dn_[0-9A-F]|PA-[0-9]"
bad=0
while IFS= read -r hit; do
  text=${hit#*:*:}
  # What remains when comments and string literals are gone is code.
  code=$(sed -E 's@//.*$@@; s/"([^"\\]|\\.)*"//g' <<<"$text")
  if grep -qiE "$names" <<<"$code"; then echo "$hit"; bad=1; fi
done < <(grep -rniE "$names" src commands --include='*.cpp' --include='*.hpp')
# Below the front ends not even a string or comment decides by a family.
if grep -rnE "== *\"($names)|\"($names)\" *==" src commands --include='*.cpp' --include='*.hpp' -i; then bad=1; fi
exit "$bad"
