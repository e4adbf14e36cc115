#!/usr/bin/env bash
# The share of a core that `monitor` takes at the full load of 1 Mbit/s on vcan0 (8700 frames of 8 bytes a second, for ten
# seconds), beside `candump -L` and the logger of python-can on the same frames; one after the other, as none is to wait for
# the core another has. Where the player itself comes too late, the share is that of frames in time. Runs inside
# tests/with-vcan.sh. usage: monitor.sh BUILD_DIR
set -euo pipefail
build=$1
SERVOCTL_DRIVES=$(cd "$(dirname "$0")/.." && pwd)/eds
export SERVOCTL_DRIVES
work=$(mktemp -d)
trap 'jobs -p | xargs -r kill 2>/dev/null; rm -rf "$work"' EXIT
awk 'BEGIN { for (i = 0; i < 87000; i++) printf "(%d.%06d) vcan0 %X#%016X\n", 1700000000 + int(i * 115 / 1000000), i * 115 % 1000000, 385 + i % 4, i }' >"$work/full.log"

busy_ms() {  # busy_ms PID: CPU time of the process so far
  awk -v tick="$(getconf CLK_TCK)" '{ sub(/.*\) /, ""); print ($12 + $13) * 1000 / tick }' "/proc/$1/stat"
}

measure() {  # measure NAME PATTERN FILE COMMAND…: while frames are played; lines of FILE with the PATTERN are frames
  local name=$1 pattern=$2 out=$3
  shift 3
  "$@" >"$work/stdout" 2>"$work/stderr" &
  local pid=$! before begin length
  sleep 2
  before=$(busy_ms "$pid")
  begin=${EPOCHREALTIME/./}
  canplayer -I "$work/full.log" vcan0=vcan0
  length=$(((${EPOCHREALTIME/./} - begin) / 1000))
  sleep 0.5
  awk -v name="$name" -v a="$before" -v b="$(busy_ms "$pid")" -v l="$length" \
    'BEGIN { printf "%-28s %10d %11.1f %12.1f ", name, l, (b - a) / 87, (b - a) / 100.05 }'
  kill -INT "$pid"
  wait "$pid" || true
  grep -c "$pattern" "$out"
}

cat >"$work/logger.py" <<'PYTHON'
import signal, sys
import can

signal.signal(signal.SIGINT, signal.default_int_handler)
with can.Bus(interface="socketcan", channel="vcan0") as bus, can.Logger(sys.argv[1]) as log:
    try:
        for frame in bus:
            log(frame)
    except KeyboardInterrupt:
        pass
PYTHON

printf '87000 frames                 played, ms  us a frame  %% of a core  frames shown\n'
measure "servoctl monitor" PDO "$work/stdout" "$build/servoctl" -b vcan0 monitor -d gsd600
measure "servoctl monitor -o jsonl" '"frame"' "$work/stdout" "$build/servoctl" -b vcan0 monitor -d gsd600 -o jsonl
measure "candump -L" '#' "$work/stdout" candump -L vcan0
python=$("$(dirname "$0")/python_can.sh") || exit 0
measure "python-can's logger" '#' "$work/python.log" "$python" "$work/logger.py" "$work/python.log"
