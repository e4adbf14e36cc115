#!/usr/bin/env bash
# Times servoctl on vcan0 beside a bare C program, a raw loop and, where CANOPENLINUX names a folder in which CANopenLinux was
# built, cocomm through canopend. Runs inside tests/with-vcan.sh. usage: vcan.sh BUILD_DIR [one-shot|reads|batch|settings…]
set -euo pipefail
build=$1
shift
parts=" ${*:-one-shot reads batch settings} "
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
export SERVOCTL_BUS=vcan0 SERVOCTL_DRIVES=${SERVOCTL_DRIVES:-$here/../eds}
sim='' daemon=''
trap 'kill $sim $daemon 2>/dev/null || true; rm -rf "$work"' EXIT

start_drives() {  # start_drives DRIVES LAST_NODE
  if [ -n "$sim" ]; then
    kill "$sim"
    wait "$sim" 2>/dev/null || true
  fi
  "$build/servoctl" sim "$1" >/dev/null &
  sim=$!
  until "$build/servoctl" read 0x6041 -n "$2" >/dev/null 2>&1; do :; done
}

# side_by_side ROUNDS FIRST SECOND: functions, in turns; the least and the median of each, and the ratio to the first.
side_by_side() {
  local name begin
  for _ in $(seq "$1"); do
    for name in "${@:2}"; do
      begin=${EPOCHREALTIME/./}
      "$name" >/dev/null 2>&1 || { echo "$name failed" >&2; return 1; }
      echo $((${EPOCHREALTIME/./} - begin)) >>"$work/$name"
    done
  done
  for name in "${@:2}"; do
    sort -n "$work/$name" >"$work/sorted"
    awk -v name="$name" -v first="$2" '{ at[NR] = $1 } END { printf "%s %s %.2f %.2f\n", name, first, at[1] / 1000, at[int((NR + 1) / 2)] / 1000 }' "$work/sorted"
  done | awk '{ if ($1 == $2) { least = $3; median = $4 }
                printf "  %-16s least %8.2f ms (%.2f)   median %8.2f ms (%.2f)\n", $1, $3, $3 / least, $4, $4 / median }'
  rm -f "${@/#/$work/}"
}

start_drives gsd600@1 1
if [[ $parts == *" one-shot "* ]]; then
  cc -O2 -o "$work/raw_read" "$here/raw_read.c"
  bare_C_program() { "$work/raw_read" vcan0 1; }
  servoctl_read() { "$build/servoctl" read 0x6041 -n 1; }
  echo 'one-shot read of 6041h, 41 runs of each in turns:'
  side_by_side 41 bare_C_program servoctl_read
fi
if [[ $parts == *" reads "* ]]; then
  "$build/bench/servoctl_vcan_bench" vcan0 1 20000
fi
if [[ $parts == *" batch "* ]]; then
  for i in $(seq 1000); do echo "read 0x6041 -n 1"; done >"$work/lines.servo"
  for i in $(seq 1000); do echo "[$i] 1 read 0x6041 0 u16"; done >"$work/lines.cocomm"
  servoctl_run() { "$build/servoctl" run "$work/lines.servo" >"$work/out.servo" 2>&1; }
  cocomm_f() { "$CANOPENLINUX/cocomm/cocomm" -s "$work/socket" -f "$work/lines.cocomm" >"$work/out.cocomm" 2>&1; }
  echo '1,000 lines that read 6041h, 7 runs of each in turns:'
  if [ -n "${CANOPENLINUX:-}" ]; then
    (cd "$work" && exec "$CANOPENLINUX/canopend" vcan0 -i 126 -c "local-$work/socket" >/dev/null 2>&1) &
    daemon=$!
    until [ -S "$work/socket" ]; do :; done
    side_by_side 7 cocomm_f servoctl_run
  else
    side_by_side 7 servoctl_run
  fi
fi
[[ $parts == *" settings "* ]] || exit 0

drives=gsd600@1,gsd600@2,gsd600@3,gsd600@4,gsd600@5,gsd600@6,gsd600@7,gsd600@8
for delay in "" "?delay=20ms"; do
  start_drives "$drives$delay" 8
  echo "331 panel parameters, drives that answer ${delay:-at once}:"
  "$build/bench/servoctl_settings_bench" vcan0 gsd600
done
