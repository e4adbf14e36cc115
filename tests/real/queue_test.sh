#!/usr/bin/env bash
# The transmit queue of can0 is full (ENOBUFS), as where nobody acknowledges: a short time is ridden out in silence, a long
# one is an error that says so; the next line works. Runs inside with-vcan.sh: can0 and can1 are one bus as long as the
# program between them is not stopped. usage: queue_test.sh SERVOCTL
set -u
servoctl=$1
work=$(mktemp -d)
sim=
pair=$(pidof slcan-pair)
trap 'kill -CONT $pair 2>/dev/null; kill $sim 2>/dev/null; rm -rf "$work"' EXIT
failures=0
checks=0

if [ "${VCAN_GUEST:-}" != uml ] || [ -z "$pair" ]; then
  echo "skipped: there is no line between can0 and can1 that can be held"
  exit 0
fi
fail() { failures=$((failures + 1)); printf 'FAILED %s\n' "$*"; tail -n 5 "$work/out" "$work/err"; }
drive() { "$servoctl" -b can0 -n 1 -d gsd600 "$@"; }
until_turning() { for _ in $(seq 100); do grep -q 'rpm .*torque' "$work/out" && return 0; sleep 0.05; done; return 1; }

# hold: nothing leaves can0 any more, and the kernel has no room for another frame. let_go: it does again.
hold() {
  kill -STOP "$pair"
  for _ in $(seq 100); do cansend can0 7F0#11 2>/dev/null || return 0; done
  fail "the queue does not become full"
}
let_go() { kill -CONT "$pair"; sleep 0.3; }

# told WHAT: the error on stderr says what it is, where, why and what to do, once.
told() {
  grep -q '^error: .*the transmit queue of can0 remains full' "$work/err" || fail "$1: it does not say what happened"
  grep -q 'nobody acknowledges.*bus up can0 --txqueuelen' "$work/err" || fail "$1: it does not say what to do"
  [ "$(grep -c '^error' "$work/err")" -eq 1 ] || fail "$1: told more than once"
}
works() { drive read 0x1000 >"$work/out" 2>"$work/err" || fail "$1: the next line does not work"; }

# short WHAT WORDS...: the queue is full for a moment in the midst of it, which nobody sees.
short() {
  local what=$1 line
  shift
  checks=$((checks + 1))
  "$@" >"$work/out" 2>"$work/err" &
  line=$!
  sleep 1; hold; sleep 0.3; let_go
  wait "$line" || fail "$what, full for a moment: exit code $?"
  if grep -qE '^(error|notice)' "$work/err"; then fail "$what, full for a moment: something is told"; fi
}

# long WHAT WORDS...: the queue remains full, and the line ends in time.
long() {
  local what=$1 line begin code
  shift
  checks=$((checks + 1))
  "$@" >"$work/out" 2>"$work/err" &
  line=$!
  sleep 1; hold
  begin=$(date +%s%N)
  wait "$line"
  code=$?
  [ $((($(date +%s%N) - begin) / 1000000)) -lt 4000 ] || fail "$what: told late"
  [ "$code" -eq 3 ] || fail "$what: exit code $code"
  told "$what"
  let_go
  works "$what"
}

"$servoctl" sim gsd600@1 --bus can1 >"$work/sim" 2>&1 &
sim=$!
for _ in $(seq 100); do grep -q 'drive on' "$work/sim" && break; sleep 0.1; done
for _ in $(seq 400); do printf 'read 0x1000\nwait 10ms\n'; done >"$work/reads"
# Backups of one drive, as many as are needed to be in the midst of one.
for i in $(seq 20); do printf 'backup %s/%s.json\n' "$work" "$i"; done >"$work/backups"

# One line, which finds the queue full.
checks=$((checks + 1))
hold
drive read 0x1000 >"$work/out" 2>"$work/err"
[ $? -eq 3 ] || fail "a read: another exit code than 3"
told "a read"
drive read 0x1000 --json >"$work/json" 2>"$work/err"
jq -e '.ok == false and .error.exit == 3 and (.error.message | contains("transmit queue of can0"))' "$work/json" >/dev/null || fail "a read --json: $(cat "$work/json")"
(sleep 0.4; kill -CONT "$pair") &
drive read 0x1000 >"$work/out" 2>"$work/err" || fail "a read is not ridden out"
[ ! -s "$work/err" ] || fail "a read, full for a moment: something is told"
wait $!

short "a batch file" drive run "$work/reads"
short "backups" drive run "$work/backups" --yes
short "watch" drive watch 0x6041 --for 3s
short "a motion" drive jog 60rpm --for 4s --turn 131072 --yes
long "a batch file" drive run "$work/reads"
rm -f "$work"/*.json
long "backups" drive run "$work/backups" --yes
for file in "$work"/*.json; do drive verify "$file" >"$work/out" 2>"$work/err" || fail "half a backup looks whole"; done
long "watch" drive watch 0x6041 --for 20s
long "scope" drive scope 0x6064 --for 20s

# motion WHAT SECONDS WORDS: the queue is full while the motor turns; let go after so long, or when the line has ended. Its end is
# told in the words of every motion, and the drive is without power.
motion() {
  local what=$1 seconds=$2 words=$3 line code
  checks=$((checks + 1))
  drive jog 60rpm --for 30s --turn 131072 --yes >"$work/out" 2>"$work/err" &
  line=$!
  until_turning || fail "$what: it does not turn"
  hold
  if [ "$seconds" -gt 0 ]; then sleep "$seconds"; let_go; fi
  wait "$line"
  code=$?
  let_go
  [ "$code" -eq 3 ] || fail "$what: exit code $code"
  if [ "$seconds" -gt 0 ]; then told "$what"; fi
  grep -q 'the transmit queue of can0 remains full: stopping node 1 waits for the bus' "$work/err" || fail "$what: it does not say that it goes on"
  if grep -q 'can0 is back' "$work/err"; then fail "$what: the bus was never away"; fi
  grep -qE "$words" "$work/err" || fail "$what: its end is not told"
  drive status --json >"$work/json" 2>"$work/err"
  jq -e '.result[0].energised == false' "$work/json" >/dev/null || fail "$what: $(cat "$work/json")"
  "$servoctl" nmt reset -n 1 --bus can1 --wait --yes >"$work/out" 2>"$work/err" || fail "$what: the drive does not start anew"
}
motion "a motion" 3 'the drive is in .*, verified'
motion "a motion to its end" 0 'THE FINAL STATE COULD NOT BE VERIFIED: SWITCH OFF THE SUPPLY'

printf '%d checks, %d failed\n' "$checks" "$failures"
[ "$failures" -eq 0 ]
