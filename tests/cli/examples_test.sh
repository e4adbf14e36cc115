#!/usr/bin/env bash
# The batch files of examples/, on simulated drives.
# usage: examples_test.sh SERVOCTL SOURCE_DIR
set -u
servoctl=$(readlink -f "$1")
examples=$2/examples
failures=0
check() {
  if [ "$2" != "$3" ]; then
    failures=$((failures + 1))
    printf 'FAILED %s\n  expected: %s\n  actual:   %s\n' "$1" "$2" "$3"
  fi
}
unset SERVOCTL_BUS SERVOCTL_NODE SERVOCTL_DRIVE
export SERVOCTL_DRIVES=$2/eds LANG=C
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
run() { "$servoctl" run "$examples/$1" "${@:2}" </dev/null; }

drives=sim:$(seq -s, -f 'gsd600@%g' 40)
forty="$drives?state=$work/drives"
check "forty axes: nothing is wrong, without a bus" 201 "$(run forty-axes.servoctl --check --json | jq .result.lines)"
check "forty axes: the plan has a line for every step" 202 "$(run forty-axes.servoctl --dry-run | grep -c .)"
check "forty axes: all lines are done" '{"lines":201,"done":201,"failed":0}' "$(run forty-axes.servoctl -b "$forty" --json | jq -c .result.summary)"
check "forty axes: the last one has its values" '[300,450,1500,600,1000]' \
  "$(echo 'param get Pn0202 Pn0214 Pn0215 Pn0226 Pn0116' | "$servoctl" - -b "$forty" -d gsd600 -n 40 --json | jq -c '[.result.lines[0].result[].raw]')"
check "forty axes: a missing drive is noticed before anything is written" '[4,40]' \
  "$(run forty-axes.servoctl -b "${drives/gsd600@21,/}" --timeout 20ms --json | jq -c '[.error.exit, .result.summary.done - 1]')"
sed 's/^7,\(.*\),60Hz/7,\1,60V/' "$examples/forty-axes.csv" >"$work/axes.csv"
cp "$examples/forty-axes.servoctl" "$work/"
check "forty axes: a wrong cell is told before anything is sent" 1 \
  "$("$servoctl" run "$work/forty-axes.servoctl" --var AXES=axes.csv 2>&1 >/dev/null | grep -c "forty-axes.servoctl:.*V")"

two=sim:gsd600@1,gsd600@2
check "first contact: two healthy drives" true "$(run first-contact.servoctl -b $two -d gsd600 --read-only --var NODES=1,2 --var COUNT=2 --json | jq .ok)"
run first-contact.servoctl -b $two -d gsd600 >/dev/null 2>"$work/errors"
check "first contact: one drive too many" 1 $?
check "first contact: what was expected" 1 "$(grep -c 'first-contact.servoctl:9: count is 2, expected == 1' "$work/errors")"
run first-contact.servoctl -b 'sim:gsd600@1?fault=0xFF00@0s' -d gsd600 >/dev/null 2>"$work/errors"
check "first contact: a fault" 1 $?
one="sim:gsd600@1?state=$work/one"
echo 'param set Pn0214 20Hz -n 1' | "$servoctl" - -b "$one" -d gsd600 >/dev/null
check "commission: all lines are done" true "$(run commission-gsd600.servoctl -b "$one" --yes --json | jq .ok)"
check "commission: it asks" 8 "$(run commission-gsd600.servoctl -b "$one" --json | jq .error.exit)"
check "commission: the values stay" '[450,0]' \
  "$(echo 'param get Pn0214 Pn0603 -n 1' | "$servoctl" - -b "$one" -d gsd600 --json | jq -c '[.result.lines[0].result[].raw]')"
check "commission: a drive in fault is left alone" 1 \
  "$(run commission-gsd600.servoctl -b 'sim:gsd600@1?fault=0xFF00@0s' --yes --json | jq .error.exit)"

cabinet="sim:gsd600@1,gsd600@2?state=$work/cabinet-drives"
echo 'param set Pn0214=31Hz Pn0202=12Hz -n 2' | "$servoctl" - -b "$cabinet" -d gsd600 >/dev/null
check "nightly backup: done" true \
  "$(run nightly-backup.servoctl -b "$cabinet" -d gsd600 --read-only --var FOLDER="$work/cabinet" --json | jq .ok)"
check "nightly backup: a file for each drive" 2 "$(find "$work/cabinet" -name 'node-*.json' | wc -l)"
new="sim:gsd600@2?state=$work/new-drive"
replace() { run replace-drive.servoctl -b "$new" -d gsd600 --var NODE=2 --var FILE="$work/cabinet/node-2.json" "$@"; }
check "replacement: the plan writes nothing" 0 "$(replace --dry-run >/dev/null; echo $?)"
check "replacement: is the old drive now" true "$(replace --yes --json | jq .ok)"
check "replacement: with its values" '[310,120]' \
  "$(echo 'param get Pn0214 Pn0202 -n 2' | "$servoctl" - -b "$new" -d gsd600 --json | jq -c '[.result.lines[0].result[].raw]')"
for file in "$examples"/*.servoctl; do
  check "$file begins with the program" '#!/usr/bin/env -S servoctl run' "$(head -1 "$file")"
  [ -x "$file" ] || check "$file is executable" yes no
done
ln -s "$servoctl" "$work/servoctl"
check "a file is a program" true "$(PATH="$work:$PATH" "$examples/first-contact.servoctl" -b sim:gsd600@1 -d gsd600 --json </dev/null | jq .ok)"
printf '%d failed\n' "$failures"
[ "$failures" -eq 0 ]
