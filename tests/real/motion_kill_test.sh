#!/usr/bin/env bash
# Kills servoctl at random points of jog, move and home, with every signal, and looks with a second servoctl whether the
# simulated drive, a process of its own, is without power: at once after a signal that can be caught, after the time of
# its watchdog after SIGKILL and after the interface went down.
# usage: motion_kill_test.sh SERVOCTL [KILLS [BUS [FAMILY]]]
set -u
servoctl=$1
kills=${2:-20}
bus=${3:-local:motion-kill-$$}
family=${4:-gsd600}
work=$(mktemp -d)
export SERVOCTL_BUS=$bus SERVOCTL_NODE=1 SERVOCTL_DRIVE=$family
failures=0
trap 'kill "$sim" 2>/dev/null; wait "$sim" 2>/dev/null; rm -rf "$work"' EXIT

fail() { failures=$((failures + 1)); printf 'FAILED %s\n' "$*"; }
wait_for() { for _ in $(seq 200); do "$servoctl" status --json >/dev/null 2>&1 && return 0; sleep 0.05; done; return 1; }
state() { "$servoctl" status --json | jq -r '.result[0] | "\(.energised) \(.state)"'; }

"$servoctl" sim "$family@1" >"$work/sim" 2>&1 &
sim=$!
wait_for || { cat "$work/sim"; echo "FAILED: the simulated drive does not answer"; exit 1; }

commands=("jog 60rpm --for 2s" "jog -120rpm --turns 3" "move 2rev --relative --speed 120rpm" "home 1 --speed 60rpm")
signals=(INT TERM HUP KILL INTINT)
objects=(0x6060 0x60FF 0x1016:1)
case $family in
  gsd600) commands=("${commands[@]/%/ --turn 131072}") ;;
  da200 | sv2)  # Without a watchdog: nothing but SIGKILL can be survived.
    signals=(INT TERM HUP INTINT)
    objects=(0x6060 0x60FF)
    ;;
  dm) commands=("jog 60rpm --for 2s" "jog -20rpm --turns 1" "move 2rev --relative --speed 60rpm") ;;
esac
held() { "$servoctl" read "${objects[@]}" --json | jq -c '[.result[].value]'; }
before=$(held)
RANDOM=${SEED:-4711}
moving=0
for i in $(seq "$kills"); do
  command=${commands[RANDOM % ${#commands[@]}]}
  signal=${signals[i % ${#signals[@]}]}
  delay=$((RANDOM % 1200))
  # A shell without a terminal starts background programs deaf to SIGINT.
  # shellcheck disable=SC2086
  env --default-signal=INT "$servoctl" $command --yes >"$work/out" 2>"$work/err" &
  pid=$!
  sleep "$((delay / 1000)).$(printf %03d $((delay % 1000)))"
  case $(state) in true*) moving=$((moving + 1)) ;; esac
  case $signal in
    INTINT) kill -INT "$pid" 2>/dev/null; kill -INT "$pid" 2>/dev/null; sleep 0.02; kill -INT "$pid" 2>/dev/null ;;
    *) kill "-$signal" "$pid" 2>/dev/null ;;
  esac
  wait "$pid" 2>/dev/null
  [ "$signal" = KILL ] && sleep 0.6
  after=$(state)
  case $after in
    false*) ;;
    *) fail "$command, $signal after $delay ms: the drive is '$after'"; cat "$work/err" ;;
  esac
  if [ "$signal" != KILL ]; then
    left=$(held)
    [ "$left" = "$before" ] || { fail "$command, $signal after $delay ms: left $left"; cat "$work/err"; }
  fi
  # A drive whose watchdog has tripped is in fault, and keeps what was set: it starts anew.
  [ "$signal" = KILL ] && { "$servoctl" nmt reset --wait --yes >/dev/null 2>&1 || fail "the drive does not restart"; }
done

case $bus in
  vcan*)  # The same when the interface goes down under a motion.
    "$servoctl" jog 60rpm --for 10s --turn 131072 --yes >"$work/out" 2>"$work/err" &
    pid=$!
    sleep 1
    ip link set "$bus" down
    wait "$pid"
    [ $? -eq 3 ] || fail "interface down: the exit code is not 3: $(cat "$work/err")"
    grep -q 'TAKE THE POWER AWAY' "$work/err" || fail "interface down: it does not say that nothing could be verified"
    ip link set "$bus" up
    ;;
esac

echo "$family: $kills kills, $moving of them while the drive was energised, $failures failures"
# How many depends on how fast the program starts: that is long before it moves in a slow build.
[ "$moving" -gt $((kills / 10)) ] || { echo "FAILED: too few kills met an energised drive: the test itself is broken"; exit 1; }
[ "$failures" -eq 0 ]
