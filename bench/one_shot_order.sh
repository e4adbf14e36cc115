#!/usr/bin/env bash
# Writes src/one_shot.ld: the order in which the linker lays down what one-shot commands execute. Needs valgrind, and a release
# tree made by `./dev build`. The bus is local: on one in a virtual machine it takes a quarter of an hour; what is SocketCAN's own is
# kept from the list before. usage: one_shot_order.sh
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The same program at fixed addresses, with a map of them.
build=build/release
link=$(if [ -f $build/build.ninja ]; then ninja -C $build -t commands servoctl | tail -1; else cat $build/CMakeFiles/servoctl.dir/link.txt; fi |
  sed "s|^: && ||; s| && :\$||; s| -o servoctl | -no-pie -Wl,-Map=$work/map -o $work/servoctl |; s| -Wl,-T,[^ ]*one_shot.ld||")
(cd $build && sh -c "$link")

export SERVOCTL_BUS=local:one-shot-order-$$ SERVOCTL_DRIVES=$PWD/eds XDG_STATE_HOME=$work
"$work/servoctl" sim gsd600@1 >/dev/null &
sim=$!
trap 'kill $sim; rm -rf "$work"' EXIT
until "$work/servoctl" read 0x6041 -n 1 >/dev/null 2>&1; do sleep 0.1; done
count=0
for words in 'read 0x6041 -n 1' 'read 0x6041 -n 1 --json' 'write 0x6081 100 -n 1' 'param get Pn0202 -n 1 -d gsd600'; do
  count=$((count + 1))
  # shellcheck disable=SC2086
  valgrind --tool=lackey --trace-mem=yes --log-file="$work/trace.$count" "$work/servoctl" --timeout 20s $words >/dev/null 2>&1
done
python3 bench/one_shot_order.py src/one_shot.ld "$work/map" "$work"/trace.? >"$work/list"
cp "$work/list" src/one_shot.ld
