#!/usr/bin/env bash
# No C++ code names a vendor or a family: what is special about a drive stands in eds/. Examples in help texts may name a
# family, so string literals of commands/ and src/cli are exempt.
# usage: no_vendor_names.sh SOURCE_DIR
set -euo pipefail
cd "$1"
names='vmmore|gsd600|gsd-600|invt|da200|syntron|sinsegye|\bsv2\b|\bdm\b|\bts\b|Pn0[0-9]{3}|Fn_[0-9A-F]'
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
