#!/usr/bin/env bash
# Times servoctl on vcan0 beside cansend and a raw loop. Runs inside tests/with-vcan.sh. usage: vcan.sh BUILD_DIR
set -euo pipefail
build=$1
export SERVOCTL_BUS=vcan0
"$build/servoctl" sim gsd600@1 >/dev/null &
sim=$!
trap 'kill $sim' EXIT
until "$build/servoctl" read 0x6041 -n 1 >/dev/null 2>&1; do :; done

median_ms() {  # median_ms COMMAND…: of 41 runs
  for _ in $(seq 41); do
    local begin=${EPOCHREALTIME/./}
    "$@" >/dev/null
    echo $((${EPOCHREALTIME/./} - begin))
  done | sort -n | sed -n 21p | awk '{ printf "%.2f", $1 / 1000 }'
}

printf 'one-shot on vcan0, median of 41 runs: cansend %s ms, servoctl read %s ms\n' \
  "$(median_ms cansend vcan0 601#4041600000000000)" "$(median_ms "$build/servoctl" read 0x6041 -n 1)"
"$build/bench/servoctl_vcan_bench" vcan0 1 20000

drives=gsd600@1,gsd600@2,gsd600@3,gsd600@4,gsd600@5,gsd600@6,gsd600@7,gsd600@8
for delay in "" "?delay=20ms"; do
  kill $sim
  wait $sim 2>/dev/null || true
  "$build/servoctl" sim "$drives$delay" >/dev/null &
  sim=$!
  until "$build/servoctl" read 0x6041 -n 8 >/dev/null 2>&1; do :; done
  echo "331 panel parameters, drives that answer ${delay:-at once}:"
  "$build/bench/servoctl_settings_bench" vcan0 gsd600
done
