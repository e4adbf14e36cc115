#!/usr/bin/env bash
# Kills servoctl at random points of jog, move and home, with every signal, and looks with a second servoctl whether the
# simulated drive, a process of its own, is without power: at once after a signal that can be caught, after the time of
# its watchdog after SIGKILL and after the cable was cut (on a vcan; the cable is that between can0 and can1 then). A
# drive without a watchdog is not killed by SIGKILL, and goes on when the cable is cut: servoctl says so.
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

# With the first failure, who is there still: a process that is stopped, or waits for what does not come.
fail() {
  failures=$((failures + 1))
  printf 'FAILED %s\n' "$*"
  [ "$failures" -gt 1 ] || ps -o pid,ppid,pgid,stat,wchan:24,etimes,args --deselect -p 2 --ppid 2 | cut -c1-160
}
wait_for() { for _ in $(seq 200); do "$servoctl" status --json >/dev/null 2>&1 && return 0; sleep 0.05; done; return 1; }
state() { "$servoctl" status --json | jq -r '.result[0] | "\(.energised) \(.state)"'; }

# As delivered these two select another source of commands.
obeying=
case $family in da200) obeying='?panel=P0.03=7' ;; ts) obeying='?panel=Fn_00=20' ;; esac
"$servoctl" sim "$family@1$obeying" >"$work/sim" 2>&1 &
sim=$!
wait_for || { cat "$work/sim"; echo "FAILED: the simulated drive does not answer"; exit 1; }

commands=("jog 60rpm --for 2s" "jog -120rpm --turns 3" "move 2rev --relative --speed 120rpm" "home 1 --speed 60rpm --search 6rpm")
signals=(INT TERM HUP QUIT TSTP USR1 KILL INTINT)
objects=(0x6060 0x60FF 0x1016:1)
watched=true
case $family in
  # Its limit switches are masked from the factory; the home switch is not.
  gsd600) commands=("${commands[@]/home 1/home 3}") && commands=("${commands[@]/%/ --turn 131072}") ;;
  ts) commands=("${commands[@]/%/ --turn 10000}") ;;
  da200)
    commands=("${commands[@]/%/ --turn 10000}")
    watched=false
    ;;
  sv2)
    commands=("${commands[@]/home 1/home 35}")
    watched=false
    ;;
  dm) commands=("jog 60rpm --for 2s" "jog -20rpm --turns 1" "move 2rev --relative --speed 60rpm") ;;
esac
if ! $watched; then
  signals=(INT TERM HUP QUIT TSTP USR1 INTINT)
  objects=(0x6060 0x60FF)
fi
for command in "${commands[@]}"; do
  # shellcheck disable=SC2086
  "$servoctl" $command --dry-run >"$work/out" 2>&1 || fail "$command does not begin: $(cat "$work/out")"
done
# Lines that leave the drive enabled when they end: a signal in the last of them takes that back, also while nobody reads what it
# shows. Such a drive has no watchdog: nothing is promised after SIGKILL.
printf 'enable --yes\nwatch statusword --every 2ms --for 20s\n' >"$work/lines"
motions=${#commands[@]}
commands+=("run $work/lines" "run $work/lines --json" "run $work/lines -o jsonl")
mkfifo "$work/unread"
exec 9<>"$work/unread"
# Runs a program as a shell with job control does: in a process group of its own, without which SIGTSTP does not stop it, and
# with the signals that whoever started this test may have made it deaf to. The shell has no job control itself: it leaves the
# loop that it is in when a job is stopped.
in_group() { exec perl -e 'setpgrp; exec @ARGV' env --default-signal=INT,QUIT,TSTP "$@"; }
# Ends, or is stopped with the drive at rest: then it goes on, but not with the motion.
end_or_stop() {
  for _ in $(seq 200); do
    case $(ps -o stat= -p "$1") in '' | Z*) return ;; T*) break ;; esac
    sleep 0.05
  done
  case $(state) in false*) ;; *) fail "$command, stopped after $delay ms: the drive is '$(state)'" ;; esac
  kill -INT "$1"; kill -CONT "$1"
}
held() { "$servoctl" read "${objects[@]}" --json | jq -c '[.result[].value]'; }
before=$(held)
RANDOM=${SEED:-4711}
moving=0
tried=0
# One kill, of this number.
kill_once() {
  tried=$((tried + 1))
  signal=${signals[$1 % ${#signals[@]}]}
  kinds=${#commands[@]}
  [ "$signal" = KILL ] && kinds=$motions
  command=${commands[RANDOM % kinds]}
  delay=$((500 + RANDOM % 2000))  # It listens for a second before it begins.
  out=$work/out
  [ $((RANDOM % 2)) -eq 0 ] && out=$work/unread
  # shellcheck disable=SC2086
  in_group "$servoctl" $command --yes >"$out" 2>"$work/err" &
  pid=$!
  sleep "$((delay / 1000)).$(printf %03d $((delay % 1000)))"
  was_on=false
  case $(state) in true*) moving=$((moving + 1)); was_on=true ;; esac
  case $signal in
    INTINT) kill -INT "$pid" 2>/dev/null; kill -INT "$pid" 2>/dev/null; sleep 0.02; kill -INT "$pid" 2>/dev/null ;;
    *) kill "-$signal" "$pid" 2>/dev/null ;;
  esac
  [ "$signal" = TSTP ] && end_or_stop "$pid"
  wait "$pid" 2>/dev/null
  code=$?
  case $was_on-$signal-$command in
    true-KILL-*) ;;
    true-*-run*) [ "$code" -eq 130 ] || { fail "$command, $signal after $delay ms: the exit code is $code"; cat "$work/err"; } ;;
  esac
  [ "$signal" = KILL ] && sleep 0.6
  after=$(state)
  case $after in
    false*) ;;
    *) fail "$command, $signal after $delay ms: the drive is '$after'"; cat "$work/err"; "$servoctl" disable >/dev/null ;;
  esac
  if [ "$signal" != KILL ]; then
    left=$(held)
    [ "$left" = "$before" ] || { fail "$command, $signal after $delay ms: left $left"; cat "$work/err"; }
  fi
  # A drive whose watchdog has tripped is in fault, and keeps what was set: it starts anew.
  [ "$signal" = KILL ] && { "$servoctl" nmt reset --wait --yes >/dev/null 2>&1 || fail "the drive does not restart"; }
}
for i in $(seq "$kills"); do kill_once "$i"; done
[ "$tried" -eq "$kills" ] || fail "$tried of $kills kills were tried"

# The motion begins, and its drive is energised.
start_jog() {
  "$servoctl" jog 60rpm --for 10s --turn 131072 --yes >"$work/out" 2>"$work/err" &
  pid=$!
  for _ in $(seq 200); do case $(SERVOCTL_BUS=${1:-$bus} state) in true*) return ;; esac; sleep 0.05; done
  fail "the drive is not energised: $(cat "$work/err")"
}

if [ "$family" = gsd600 ]; then
  for entry in 1 2 3 4; do "$servoctl" write "0x1016:$entry" "$((0x000203E8 + entry * 65536))" >/dev/null; done
  "$servoctl" jog 60rpm --for 1s --turn 131072 --dry-run | grep -q 'none: .*Pn0199 is 0' || fail "guarding without an alarm is promised"
  "$servoctl" param set Pn0199 1 --keep --yes >/dev/null || fail "Pn0199 cannot be kept"
  "$servoctl" nmt reset --wait --yes >/dev/null || fail "the drive does not restart"
  for entry in 1 2 3 4; do "$servoctl" write "0x1016:$entry" "$((0x000203E8 + entry * 65536))" >/dev/null; done
  start_jog
  grep -q 'life guarding by servoctl' "$work/err" || fail "no life guarding: $(cat "$work/err")"
  kill -KILL "$pid"; wait "$pid" 2>/dev/null
  sleep 1.1
  case $(state) in false*) ;; *) fail "killed under life guarding: the drive is '$(state)'" ;; esac
fi

case $bus in
  vcan*)
    if ip link show can1 >/dev/null 2>&1; then
      "$servoctl" sim "$family@1$obeying" --bus can1 >"$work/sim2" 2>&1 &
      sim2=$!
      SERVOCTL_BUS=can1 wait_for || fail "the drive on can1 does not answer: $(cat "$work/sim2")"
      SERVOCTL_BUS=can0 start_jog can1
      ip link set can0 down
      wait "$pid"
      [ $? -eq 3 ] || fail "cable cut: the exit code is not 3: $(cat "$work/err")"
      grep -q 'SWITCH OFF THE SUPPLY' "$work/err" || fail "cable cut: it does not say that nothing could be verified"
      sleep 0.6
      after=$(SERVOCTL_BUS=can1 state)
      case $watched-$after in
        true-false* | false-true*) echo "cable cut: the drive is '$after'" ;;
        *) fail "cable cut: the drive is '$after'" ;;
      esac
      kill "$sim2"; wait "$sim2"
      ip link set can0 up
    fi
    ;;
esac

echo "$family: $kills kills, $moving of them while the drive was energised, $failures failures"
# How many depends on how fast the program starts: that is long before it moves in a slow build.
if [ "$moving" -le $((kills / 10)) ]; then
  echo "FAILED: too few kills met an energised drive: the test itself is broken, or its motions end early. The last of them said:"
  cat "$work/out" "$work/err"
  exit 1
fi
[ "$failures" -eq 0 ]
