#!/usr/bin/env bash
# Every key a rules file may have, and every column of a table, stands in docs/drive-data.md.
# usage: documented_keys.sh SOURCE_DIR
set -euo pipefail
cd "$1"
keys=$(grep -hoE '\{"[a-z_]+", ' src/drive/rules.cpp src/drive/rules_reader.cpp src/drive/rules_caution_reader.cpp src/drive/rules_units_reader.cpp src/drive/rules_modbus_reader.cpp src/drive/topics_reader.cpp | grep -oE '[a-z_]+' | sort -u)
columns=$(sed -nE '/kColumns(\{| =)/,/(\};|\);)/p' src/od/parameter.cpp src/od/annotate.cpp src/drive/fault.cpp |
  grep -oE '"[a-z_]+"' | tr -d '"' | sort -u)
if [ "$(wc -w <<<"$keys")" -lt 70 ] || [ "$(wc -w <<<"$columns")" -lt 20 ]; then
  echo "too few keys or columns were found: the test itself is broken"
  exit 1
fi
bad=0
for word in $keys $columns; do
  if ! grep -qw -- "$word" docs/drive-data.md; then
    echo "docs/drive-data.md does not tell of '$word'"
    bad=1
  fi
done
exit "$bad"
