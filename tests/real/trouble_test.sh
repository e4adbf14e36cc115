#!/usr/bin/env bash
# The bus is lost in the middle of each kind of line: told at once and once, the line ends with an error, the next one works.
# Runs inside with-vcan.sh, with can0 and can1 on one bus, errors by /dev/can0.inject. usage: trouble_test.sh SERVOCTL
set -u
shopt -s nullglob  # On a slow machine no backup is whole yet.
servoctl=$1
work=$(mktemp -d)
sim=
trap 'kill $sim 2>/dev/null; rm -rf "$work"' EXIT
failures=0
checks=0

[ "${VCAN_GUEST:-}" = uml ] || { echo "skipped: there is no can0 and can1 with errors to be injected"; exit 0; }
fail() { failures=$((failures + 1)); printf 'FAILED %s\n' "$*"; cat "$work/out" "$work/err"; }
drive() { "$servoctl" -b can0 -n 1 -d gsd600 "$@"; }

# trouble HOW: what happens to can0; mend HOW: it is back.
trouble() {
  case $1 in
    down) ip link set can0 down ;;
    bus-off) printf 'sb000256\r' >/dev/can0.inject ;;
    passive) printf 'sp140000\r' >/dev/can0.inject ;;
  esac
}
mend() {
  case $1 in
    down) ip link set can0 up ;;
    bus-off) ip link set can0 down; ip link set can0 up ;;
    passive) printf 'sa000000\r' >/dev/can0.inject ;;
  esac
  sleep 0.3
}
works() {  # works WHAT: the next line, as if nothing had been
  checks=$((checks + 1))
  for _ in 1 2 3 4 5; do drive read 0x1000 >"$work/out" 2>"$work/err" && return; sleep 0.3; done
  fail "$1: the next line does not work"
}

# during HOW CODES WORDS...: the line that is under way ends with one of these exit codes, in time, and says why once.
during() {
  local how=$1 codes=$2 begin code
  shift 2
  checks=$((checks + 1))
  drive "$@" >"$work/out" 2>"$work/err" &
  local line=$!
  sleep 1
  begin=$(date +%s%N)
  trouble "$how"
  wait "$line"
  code=$?
  local took=$((($(date +%s%N) - begin) / 1000000))
  mend "$how"
  [[ " $codes " == *" $code "* ]] || fail "$how in $1: exit code $code"
  [ "$took" -lt 14000 ] || fail "$how in $1: told after $took ms"
  [ "$(grep -c '^error' "$work/err")" -le 1 ] || fail "$how in $1: told more than once"
  if [ "$code" -ne 0 ]; then grep -qE 'can0' "$work/err" || fail "$how in $1: it does not name the bus"; fi
  works "$how in $1"
}

"$servoctl" sim gsd600@1 --bus can1 >"$work/sim" 2>&1 &
sim=$!
for _ in $(seq 100); do grep -q 'drive on' "$work/sim" && break; sleep 0.1; done
drive backup "$work/good.json" >"$work/out" 2>"$work/err" || fail "a backup in peace"
for _ in $(seq 300); do printf 'read 0x1000\nwait 10ms\n'; done >"$work/reads"
for i in 1 2; do printf 'backup %s/cut%s.json\n' "$work" "$i"; done >"$work/backups"

# outlasts HOW WORDS...: what listens goes on behind a bus that comes back; that it went and is back is told once each.
outlasts() {
  local how=$1 code line seen
  shift
  checks=$((checks + 1))
  drive "$@" >"$work/out" 2>"$work/err" &
  line=$!
  sleep 1; trouble "$how"; sleep 0.5; mend "$how"
  seen=$(wc -l <"$work/out")
  wait "$line"
  code=$?
  [ "$code" -eq 0 ] || fail "$how in $1, which came back: exit code $code"
  # What mends bus-off takes the interface down: that may be seen as a second loss.
  local most=1 went back
  if [ "$how" = bus-off ]; then most=2; fi
  went=$(cat "$work/out" "$work/err" | grep -c 'waiting until it can be used again')
  back=$(cat "$work/out" "$work/err" | grep -cE 'can0 (can be used again after|was opened anew)')
  { [ "$went" -ge 1 ] && [ "$went" -le "$most" ] && [ "$back" -eq "$went" ]; } || fail "$how in $1: told $went times that it went, $back times that it is back"
  [ "$(grep -c '^error' "$work/err")" -eq 0 ] || fail "$how in $1: an error"
  [ "$(wc -l <"$work/out")" -gt "$seen" ] || fail "$how in $1: nothing came behind it"
}
drive write 0x1017 200 >"$work/out" 2>"$work/err" || fail "no heartbeat"
for how in down bus-off; do
  outlasts "$how" monitor --for 4s
  outlasts "$how" monitor -o jsonl --for 4s
  jq -es 'map(.event // empty) | index("bus-lost") != null and index("bus-back") != null' "$work/out" >"$work/json" || fail "$how in monitor: no records of it"
  outlasts "$how" watch 0x6041 --for 4s
  outlasts "$how" nmt watch --for 4s
done
drive write 0x1017 0 >"$work/out" 2>"$work/err" || fail "no heartbeat"
outlasts down nmt watch --guard 100ms --for 4s

# A backup of a drive that answers behind 5 ms takes some seconds: the bus goes in the midst of one, and not between two lines.
kill "$sim"
wait "$sim" 2>/dev/null
"$servoctl" sim 'gsd600@1?delay=5ms' --bus can1 >"$work/sim" 2>&1 &
sim=$!
for _ in $(seq 100); do grep -q 'drive on' "$work/sim" && break; sleep 0.1; done

# Where it does not come back they end when their time is over.
for how in down bus-off; do
  during "$how" 3 monitor --for 3s
  during "$how" 3 watch 0x6041 --for 3s
  during "$how" 3 nmt watch --for 3s
  during "$how" 3 run "$work/reads"
  rm -f "$work"/cut*.json
  begun=$(date +%s)
  during "$how" 3 run "$work/backups"
  [ $(($(date +%s) - begun)) -ge 9 ] || fail "$how in backup: it had no patience"
  for file in "$work"/cut*.json; do drive verify "$file" >"$work/out" 2>"$work/err" || fail "$how: half a backup looks whole"; done
done

# A backup goes on once the bus is back, and what it saves is whole.
for how in down bus-off; do
  rm -f "$work"/cut*.json
  checks=$((checks + 1))
  drive run "$work/backups" >"$work/out" 2>"$work/err" &
  line=$!
  sleep 1; trouble "$how"; sleep 0.5; mend "$how"
  wait "$line"; code=$?
  [ "$code" -eq 0 ] || fail "$how in backup, which came back: exit code $code"
  grep -qE 'can0 (can be used again after|was opened anew)' "$work/err" || grep -q 'when what this line does was done' "$work/err" || fail "$how in backup: the loss is not told"
  for file in "$work"/cut*.json; do drive verify "$file" >"$work/out" 2>"$work/err" || fail "$how: a backup that went on is not whole"; done
done

# What is wrong on the wire is shown, and named where nobody answers.
checks=$((checks + 1))
drive monitor --for 3s >"$work/out" 2>"$work/err" &
line=$!
sleep 1
for _ in 1 2 3 4; do printf 'e1f\r' >/dev/can0.inject; sleep 0.1; done
wait "$line"
grep -q 'errors on the wire.*4 × form error' "$work/out" || fail "form errors are not shown by monitor"
checks=$((checks + 1))
"$servoctl" -b can0 read 0x1000 -n 77 -d gsd600 --timeout 3s >"$work/out" 2>"$work/err" &
line=$!
sleep 1
for _ in 1 2 3 4; do printf 'e1f\r' >/dev/can0.inject; sleep 0.1; done
wait "$line"
grep -q 'errors on the wire (4 × form error)' "$work/err" || fail "form errors are not named where nobody answers"

# Error passive is no loss: the line goes on, and it is told once.
checks=$((checks + 1))
drive monitor --for 4s >"$work/out" 2>"$work/err" &
line=$!
sleep 1; trouble passive; sleep 0.3; trouble passive; wait "$line"; code=$?
mend passive
[ "$code" -eq 0 ] || fail "error passive in monitor: exit code $code"
[ "$(cat "$work/out" "$work/err" | grep -ci 'passive')" -ge 1 ] || fail "error passive is not told"
[ "$(grep -ci 'passive' "$work/err")" -le 1 ] || fail "error passive is told more than once"
works "error passive"

# At a prompt, or between lines of a pipe: told while nobody types, and the next line connects anew.
for how in down bus-off; do
  checks=$((checks + 1))
  mkfifo "$work/$how"
  drive <"$work/$how" >"$work/out" 2>"$work/err" &
  line=$!
  exec 9>"$work/$how"
  printf 'read 0x1000\n' >&9; sleep 1.5
  trouble "$how"; sleep 1; mend "$how"
  printf 'read 0x1000\nread 0x1000\n' >&9; sleep 1.5
  exec 9>&-
  wait "$line"
  [ "$(grep -c '0x00020192' "$work/out")" -ge 2 ] || fail "$how between two lines: they do not go on"
  [ "$(grep -c '^error' "$work/err")" -le 1 ] || fail "$how between two lines: told more than once"
done

# cut WHAT WORDS...: the interface goes down behind the write so many frames after the first one, in the midst of the line. It ends
# with exit code 3, names the bus, and says how it goes on; what it had not written yet is not written.
cut() {
  local what=$1 after=$2 line dump code
  shift 2
  checks=$((checks + 1))
  # Requests that write (0x2n), as they pass.
  stdbuf -oL candump -L can0,601:7FF 2>/dev/null | grep --line-buffered -E '601#2' >"$work/writes" &
  dump=$!
  "$@" >"$work/out" 2>"$work/err" &
  line=$!
  for _ in $(seq 500); do [ "$(wc -l <"$work/writes")" -ge "$after" ] && break; kill -0 "$line" 2>/dev/null || break; sleep 0.01; done
  kill -0 "$line" 2>/dev/null || fail "$what: it was over before the bus went"
  trouble down
  wait "$line"
  code=$?
  mend down
  kill "$dump" 2>/dev/null
  [ "$code" -eq 3 ] || fail "$what: exit code $code"
  [ "$(grep -c '^error.*can0' "$work/err")" -eq 1 ] || fail "$what: the bus is not named once"
  grep -q -- '--resume' "$work/err" || fail "$what: it does not say how it goes on"
  cp "$work/err" "$work/cut.err"
  works "$what"
}

# A restore in the midst of its writes, many values: it says how it goes on, and goes on from where it was.
kill "$sim"; wait "$sim" 2>/dev/null
"$servoctl" sim 'gsd600@1?delay=10ms' --bus can1 >"$work/sim" 2>&1 &
sim=$!
for _ in $(seq 100); do drive read 0x1000 >"$work/out" 2>&1 && break; sleep 0.1; done
{
  echo on-error continue  # Some of them take no number between.
  "$servoctl" param list 'Pn02*' -d gsd600 --json |
    jq -r '.result[] | select(.access == "rw" and .type == "u16" and .max > .default and .effect == "immediate") | "\(.object.index) \(.object.sub) \(.default + 1)"' |
    while read -r index sub value; do printf 'write 0x%X:%d %d\n' "$index" "$sub" "$value"; done
} >"$work/changes"
drive run "$work/changes" >"$work/out" 2>"$work/err"
drive verify "$work/good.json" --json >"$work/json" 2>"$work/err"
different=$(jq '.result[0].different' "$work/json")
[ "${different:-0}" -ge 12 ] || fail "only ${different:-0} values differ"
cut "down in restore" 4 drive restore "$work/good.json" --yes
left=$(drive verify "$work/good.json" --json 2>/dev/null | jq '.result[0].different')
if [ "$left" -eq 0 ] || [ "$left" -ge "$different" ]; then fail "down in restore: $left of $different values differ still: it was not cut in the midst"; fi
drive restore "$work/good.json" --resume --yes >"$work/out" 2>"$work/err" || fail "a restore that was cut does not go on"
drive verify "$work/good.json" >"$work/out" 2>"$work/err" || fail "the drive is not as the backup says"

# An apply of a cabinet, the same.
{
  printf '[bus.main]\nurl = "can0"\n[axis.one]\nbus = "main"\nnode = 1\nfamily = "gsd600"\n[axis.one.parameters]\n'
  printf '"0x6083" = 1111\n"0x6084" = 2222\n"0x6081" = 3333\nPn0214 = "47Hz"\n'
  grep write "$work/changes" | head -6 | while read -r _ object value; do printf '"%s" = %s\n' "$object" "$value"; done
} >"$work/cabinet.toml"
cabinet() { "$servoctl" --cabinet "$work/cabinet.toml" cabinet "$@"; }
cut "down in cabinet apply" 2 cabinet apply --yes
if cabinet plan >"$work/out" 2>"$work/err"; then fail "down in cabinet apply: nothing was left to do"; fi
cabinet apply --resume --yes >"$work/out" 2>"$work/err" || fail "an apply that was cut does not go on"
cabinet plan >"$work/out" 2>"$work/err" || fail "the plan is not empty behind it"

# What a line can do without it asks last: identities, and what tells the family. A bus that is lost then is told as well.
kill "$sim"; wait "$sim" 2>/dev/null
"$servoctl" sim 'gsd600@1?delay=300ms' --bus can1 >"$work/sim" 2>&1 &
sim=$!
for _ in $(seq 100); do grep -q 'drive on' "$work/sim" && break; sleep 0.1; done
for after in 0.5 3; do
  checks=$((checks + 1))
  "$servoctl" -b can0 scan -n 1 >"$work/out" 2>"$work/err" &
  line=$!
  sleep "$after"; trouble down; wait "$line"; code=$?
  mend down
  { [ "$code" -eq 3 ] && [ "$(grep -c '^error: can0 went down' "$work/err")" -eq 1 ]; } || fail "down $after s into a scan: exit code $code"
done

printf '%d checks, %d failed\n' "$checks" "$failures"
[ "$failures" -eq 0 ]
