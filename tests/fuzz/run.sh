#!/usr/bin/env bash
# Fuzzes every target for a time, then keeps the smallest corpus that reaches the same code.
# usage: run.sh BUILD_DIR SECONDS JOBS [TARGET…]
set -euo pipefail
build=$(cd "$1" && pwd) seconds=$2 jobs=$3
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# shellcheck disable=SC2317  # xargs calls it.
fuzz_one() {  # fuzz_one TARGET: leaves its log in $work, and what it found in crash-files of the present folder
  local name=$1
  mkdir -p "$work/$name"
  "$here/corpus.sh" unpack "$here/corpus/$name.tar.gz" "$work/kept-$name"
  "$build/fuzz_$name" "$work/$name" "$work/kept-$name" -max_total_time="$seconds" -max_len=4096 -timeout=10 \
    -rss_limit_mb=2000 -artifact_prefix="$name-" -print_final_stats=1 >"$work/$name.log" 2>&1 || echo FOUND >>"$work/$name.log"
}

export -f fuzz_one
export build seconds here work
targets=("${@:4}")
[ $# -gt 3 ] || mapfile -t targets < <(find "$build" -maxdepth 1 -type f -executable -name 'fuzz_*' -printf '%f\n' | sed 's/^fuzz_//' | sort)
printf '%s\n' "${targets[@]}" | xargs -P "$jobs" -I{} bash -c 'fuzz_one {}'

failed=0
for name in "${targets[@]}"; do
  runs=$(sed -n 's/^stat::number_of_executed_units: //p' "$work/$name.log")
  if grep -q '^FOUND' "$work/$name.log"; then
    failed=1
    printf '%-14s FAILED\n' "$name"
    tail -40 "$work/$name.log"
  else
    printf '%-14s %12s executions, nothing found\n' "$name" "$runs"
    mkdir "$work/min-$name"
    "$build/fuzz_$name" -merge=1 -use_counters=0 "$work/min-$name" "$work/kept-$name" "$work/$name" >/dev/null 2>&1
    "$here/corpus.sh" pack "$work/min-$name" "$here/corpus/$name.tar.gz"
  fi
done
exit $failed
