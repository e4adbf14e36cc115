#!/usr/bin/env bash
# Each mutation that tests/mutation/explained.txt explains is of a line that still stands in its file.
# usage: explained_mutations.sh SOURCE_DIR
set -euo pipefail
cd "$1"
checked=0
bad=0
while IFS= read -r line; do
  file=${line%%: *}
  before=${line#*: }
  before=${before%% => *}
  checked=$((checked + 1))
  grep -qF -- "$before" "$file" 2>/dev/null || { echo "$file has no line: $before"; bad=1; }
done < <(grep -v '^#' tests/mutation/explained.txt)
[ "$checked" -gt 10 ] || { echo "only $checked lines were found: the check itself is broken"; bad=1; }
exit "$bad"
