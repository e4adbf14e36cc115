#!/usr/bin/env bash
# The share of a core that `monitor` takes at the full load of 1 Mbit/s on vcan0 (8700 frames of 8 bytes a second, for ten
# seconds), beside `candump -L` on the same frames. Runs inside tests/with-vcan.sh. usage: monitor.sh BUILD_DIR
set -euo pipefail
build=$1
export SERVOCTL_DRIVES=$(cd "$(dirname "$0")/.." && pwd)/eds
work=$(mktemp -d)
trap 'jobs -p | xargs -r kill 2>/dev/null; rm -rf "$work"' EXIT
awk 'BEGIN { for (i = 0; i < 87000; i++) printf "(%d.%06d) vcan0 %X#%016X\n", 1700000000 + int(i * 115 / 1000000), i * 115 % 1000000, 385 + i % 4, i }' >"$work/full.log"

busy_ms() {  # busy_ms PID: CPU time of the process so far
  awk -v tick="$(getconf CLK_TCK)" '{ sub(/.*\) /, ""); print ($12 + $13) * 1000 / tick }' "/proc/$1/stat"
}

"$build/servoctl" -b vcan0 monitor --for 60s -d gsd600 >"$work/monitor" &
monitor=$!
"$build/servoctl" -b vcan0 monitor --for 60s -d gsd600 -o jsonl >"$work/jsonl" &
jsonl=$!
candump -L vcan0 >"$work/candump" &
candump=$!
sleep 1
names=("servoctl monitor" "servoctl monitor -o jsonl" "candump -L")
pids=("$monitor" "$jsonl" "$candump")
before=()
for pid in "${pids[@]}"; do before+=("$(busy_ms "$pid")"); done
begin=${EPOCHREALTIME/./}
canplayer -I "$work/full.log" vcan0=vcan0
sleep 0.2
length=$(((${EPOCHREALTIME/./} - begin) / 1000))
printf 'full load of 1 Mbit/s for %d ms                %% of a core   frames\n' "$length" 
for i in 0 1 2; do
  frames=$(grep -c '' "$work/$(case $i in 0) echo monitor ;; 1) echo jsonl ;; 2) echo candump ;; esac)")
  awk -v name="${names[$i]}" -v a="${before[$i]}" -v b="$(busy_ms "${pids[$i]}")" -v l="$length" -v f="$frames" \
    'BEGIN { printf "%-46s %9.1f %9d\n", name, 100 * (b - a) / l, f }'
done
