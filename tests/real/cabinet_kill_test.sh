#!/usr/bin/env bash
# Kills applies of a cabinet with `kill -9` at random times; what was cut off is gone on with or undone, and every drive has to hold all
# of the one or all of the other. COUNT of them are cut off while they write.
# usage: cabinet_kill_test.sh SERVOCTL BUS COUNT [SEED]
set -u
servoctl=$1 count=$3
RANDOM=${4:-1}
work=$(mktemp -d)
cd "$work" || exit 1
export SERVOCTL_BUS=$2 SERVOCTL_DRIVE=gsd600
cat >cabinet.toml <<TOML
[bus.main]
url = "$2"
[family.gsd600.parameters]
Pn0202 = 320
Pn0203 = 160
Pn0204 = 2
Pn0214 = 480
Pn0215 = 900
Pn0217 = 320
Pn0218 = 1000
Pn0220 = 80
[axis."a{1-3}"]
node = "1-3"
family = "gsd600"
TOML
"$servoctl" sim 'gsd600@1,gsd600@2,gsd600@3?delay=3ms' >/dev/null 2>&1 &
sim=$!
trap 'kill $sim 2>/dev/null; cd /; rm -rf "$work"' EXIT
for _ in $(seq 100); do "$servoctl" read 0x6041 -n 1 >/dev/null 2>&1 && break; sleep 0.02; done

fail() { echo "FAILED at kill $i: $*"; exit 1; }
holds() { "$servoctl" verify "$1" -n "$2" >/dev/null 2>&1; }
set_others() {
  "$servoctl" param set Pn0202=401 Pn0203=201 Pn0204=1 Pn0214=601 Pn0215=1001 Pn0217=401 Pn0218=1201 Pn0220=101 -n 1,2,3 >/dev/null
}
i=0
set_others || fail "cannot change values"
for n in 1 2 3; do "$servoctl" backup "other-$n.json" --only gain -n $n >/dev/null || fail "no backup"; done
# How long one takes decides when to kill: the beginning of a run only reads.
begin=${EPOCHREALTIME/./}
"$servoctl" cabinet apply --yes >/dev/null 2>&1 || fail "an undisturbed apply does not work"
lasts=$((${EPOCHREALTIME/./} - begin))
"$servoctl" cabinet plan --no-unlisted >/dev/null 2>&1 || fail "the plan is not empty after it"
for n in 1 2 3; do "$servoctl" backup "good-$n.json" --only gain -n $n >/dev/null || fail "no backup"; done

resumed=0 undone=0 untouched=0
while [ $((resumed + undone)) -lt "$count" ]; do
  i=$((i + 1))
  [ $i -le $((count * 20)) ] || fail "kills do not meet applies that write"
  set_others || fail "cannot change values"
  "$servoctl" cabinet apply --yes >/dev/null 2>&1 &
  apply=$!
  if [ $((RANDOM % 2)) -eq 0 ]; then
    sleep "$(printf '%d.%06d' $((at = lasts / 3 + RANDOM * 33 % (lasts * 2 / 3 + 1), at / 1000000)) $((at % 1000000)))"
  else # A busy machine makes the time of one no measure of another: while it writes.
    until [ -e "cabinet.toml.before-a$((RANDOM % 3 + 1)).json.journal" ] || ! kill -0 $apply 2>/dev/null; do sleep 0.002; done
    sleep "$(printf '0.%06d' $((RANDOM * 3 % 80000)))"
  fi
  kill -9 $apply 2>/dev/null
  wait $apply 2>/dev/null
  cut=0
  for n in 1 2 3; do
    if [ -e "cabinet.toml.before-a$n.json.journal" ]; then
      cut=$((cut + 1))
      "$servoctl" cabinet plan --axis a$n --no-unlisted >/dev/null 2>&1
      [ $? -eq 8 ] || fail "a$n: it is planned anew over a journal"
    else
      holds "good-$n.json" $n || holds "other-$n.json" $n || fail "a$n: values of both, and no journal"
    fi
  done
  if [ $cut -eq 0 ]; then
    untouched=$((untouched + 1))
  elif [ $resumed -le $undone ]; then
    "$servoctl" cabinet apply --yes --resume >/dev/null 2>&1 || fail "it does not go on"
    "$servoctl" cabinet apply --yes >/dev/null 2>&1 || fail "the rest is not applied"
    "$servoctl" cabinet plan --no-unlisted >/dev/null 2>&1 || fail "gone on with, but the plan is not empty"
    resumed=$((resumed + 1))
  else
    for n in 1 2 3; do
      [ -e "cabinet.toml.before-a$n.json.journal" ] || continue
      "$servoctl" restore "cabinet.toml.before-a$n.json" -n $n --yes >/dev/null 2>&1 || fail "a$n: it is not undone"
      holds "other-$n.json" $n || fail "a$n: undone, but the values differ"
    done
    undone=$((undone + 1))
  fi
  ls ./*.journal >/dev/null 2>&1 && fail "a journal stays"
done
echo "$i applies killed: $resumed gone on with, $undone undone, $untouched before or after their writes"
