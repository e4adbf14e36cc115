#!/usr/bin/env bash
# Writes src/one_shot.ld: the order in which the linker lays down what one-shot commands execute. Needs valgrind, and a release
# tree made by `./dev build`; vcan0 is that of tests/with-vcan.sh. usage: one_shot_order.sh
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The same program at fixed addresses, with a map of them.
build=build/release
link=$(sed "s| -o servoctl | -no-pie -Wl,-Map=$work/map -o $work/servoctl |; s| -Wl,-T,[^ ]*one_shot.ld||" $build/CMakeFiles/servoctl.dir/link.txt)
(cd $build && sh -c "$link")

cat >"$work/runs.sh" <<'RUNS'
set -eu
work=$1
export SERVOCTL_BUS=vcan0 SERVOCTL_DRIVES=$2/eds
"$work/servoctl" sim gsd600@1 >/dev/null &
sim=$!
trap 'kill $sim' EXIT
until "$work/servoctl" read 0x6041 -n 1 >/dev/null 2>&1; do :; done
count=0
for words in 'read 0x6041 -n 1' 'read 0x6041 -n 1 --json' 'write 0x6081 100 -n 1' 'param get Pn0202 -n 1 -d gsd600'; do
  count=$((count + 1))
  # shellcheck disable=SC2086
  valgrind --tool=lackey --trace-mem=yes --log-file="$work/trace.$count" "$work/servoctl" $words >/dev/null 2>&1
done
RUNS
VCAN_TIMEOUT=600 tests/with-vcan.sh bash "$work/runs.sh" "$work" "$PWD"
python3 bench/one_shot_order.py "$work/map" "$work"/trace.? >src/one_shot.ld
