#!/usr/bin/env bash
# Kills restores with `kill -9` at random times, or ends them by SIGTERM, alone and as the last line of a file, while what they show is
# read or not; each is then gone on with or undone, and the drive has to hold all of the one or all of the other. COUNT of them are cut
# off while they write.
# usage: restore_kill_test.sh SERVOCTL BUS COUNT [SEED]
set -u
servoctl=$1 count=$3
RANDOM=${4:-1}
work=$(mktemp -d)
cd "$work" || exit 1
export SERVOCTL_BUS=$2 SERVOCTL_NODE=1 SERVOCTL_DRIVE=gsd600
"$servoctl" sim 'gsd600@1?delay=3ms' >/dev/null 2>&1 &
sim=$!
trap 'kill $sim 2>/dev/null; cd /; rm -rf "$work"' EXIT
for _ in $(seq 100); do "$servoctl" read 0x6041 >/dev/null 2>&1 && break; sleep 0.02; done

fail() { echo "FAILED at kill $i: $*"; exit 1; }
holds() { "$servoctl" verify "$1" >/dev/null 2>&1; }

set_others() { "$servoctl" param set Pn0202=401 Pn0203=201 Pn0204=1 Pn0214=601 Pn0215=1001 Pn0217=401 Pn0218=1201 Pn0220=101 >/dev/null; }
i=0
"$servoctl" backup good.json --only gain >/dev/null || fail "no backup"
set_others || fail "cannot change values"
"$servoctl" backup other.json --only gain >/dev/null || fail "no backup"
# How long one takes decides when to kill: the beginning of a run only reads.
begin=${EPOCHREALTIME/./}
"$servoctl" restore good.json --yes >/dev/null 2>&1 || fail "an undisturbed restore does not work"
lasts=$((${EPOCHREALTIME/./} - begin))

echo 'restore good.json --yes' >lines
mkfifo unread
exec 9<>unread
resumed=0 undone=0 untouched=0
while [ $((resumed + undone)) -lt "$count" ]; do
  i=$((i + 1))
  [ $i -le $((count * 20)) ] || fail "kills do not meet restores that write"
  set_others || fail "cannot change values"
  rm -f good.json.before-*
  line=(restore good.json --yes)
  [ $((RANDOM % 2)) -eq 0 ] && line=(run lines)
  out=/dev/null
  [ $((RANDOM % 2)) -eq 0 ] && out=unread
  signal=KILL
  [ $((RANDOM % 2)) -eq 0 ] && signal=TERM
  "$servoctl" "${line[@]}" >"$out" 2>/dev/null &
  restore=$!
  if [ $((RANDOM % 2)) -eq 0 ]; then
    sleep "$(printf '%d.%06d' $((at = lasts / 3 + RANDOM * 33 % (lasts * 2 / 3 + 1), at / 1000000)) $((at % 1000000)))"
  else # A busy machine makes the time of one no measure of another: while it writes.
    until [ -e good.json.before-node-1.json.journal ] || ! kill -0 $restore 2>/dev/null; do sleep 0.002; done
    sleep "$(printf '0.%06d' $((RANDOM * 3 % 80000)))"
  fi
  ended=true
  kill -$signal $restore 2>/dev/null && ended=false
  wait $restore 2>/dev/null
  code=$?
  case $ended-$signal-${line[0]}-$code in false-TERM-run-130 | false-TERM-restore-* | false-KILL-* | true-*) ;; *) fail "${line[*]}, $signal: the exit code is $code" ;; esac
  if [ ! -e good.json.before-node-1.json.journal ]; then
    holds good.json || holds other.json || fail "values of both, and no journal"
    untouched=$((untouched + 1))
  elif [ $resumed -le $undone ]; then
    "$servoctl" restore good.json --yes >/dev/null 2>&1 && fail "it began anew over a journal"
    "$servoctl" restore good.json --yes --resume >/dev/null 2>&1 || fail "it does not go on"
    holds good.json || fail "gone on with, but the values differ"
    resumed=$((resumed + 1))
  else
    "$servoctl" restore good.json.before-node-1.json --yes >/dev/null 2>&1 || fail "it is not undone"
    holds other.json || fail "undone, but the values differ"
    undone=$((undone + 1))
  fi
  [ ! -e good.json.before-node-1.json.journal ] || fail "the journal stays"
done
echo "$i restores killed: $resumed gone on with, $undone undone, $untouched before or after their writes"
