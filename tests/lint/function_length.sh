#!/usr/bin/env bash
# No function has more than 40 lines: one that has more has parts without a name. Reads what clang-format has laid out: outside of
# functions a line that ends in `{` begins one, unless it begins a type or a table, and a `}` as far to the left as the
# declaration ends it. Lines of a raw string are text, and rows
# of a table in braces are data.
# usage: function_length.sh SOURCE_DIR
set -euo pipefail
cd "$1"
# shellcheck disable=SC2016
git ls-files 'src/*.cpp' 'src/*.hpp' 'commands/*.cpp' | xargs -n 5000 awk '
  function indent() { match($0, /^ */); return RLENGTH }
  FNR == 1 { begin = 0; raw = 0; scope = 0 }
  raw { if (/\)[a-z]*";?/) raw = 0; else next }
  /R"[a-z]*\(/ && !/\)[a-z]*"/ { raw = 1 }
  begin > 0 && /^ *\}/ && indent() == left {
    if (lines + 1 > 40) { printf "%s:%d: a function of %d lines\n", FILENAME, begin, lines + 1; bad = 1 }
    begin = 0
    next
  }
  begin > 0 { if (!/^ +\{.*\},?$/ && !/= \{\{/) lines++; next }
  /^ *$|^ *\/\/|^#|^ *(public|private|protected):|^ *[:}]/ && !/^ *: .*\{$/ { next }
  indent() <= 4 && !/^ +: / { scope = indent(); head = $0 }
  /\{$/ && head ~ /\(/ && head !~ /^ *(namespace|class|struct|enum|union) |= *\{?$| = \{/ {
    begin = FNR; left = scope; lines = 1; functions++
  }
  END {
    if (functions < 3000) { printf "only %d functions found: the test itself is broken\n", functions; bad = 1 }
    exit bad
  }
'
