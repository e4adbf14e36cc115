#!/usr/bin/env bash
# Kills servoctl at random points of motions over EtherCAT, with every signal, and looks with a second servoctl whether
# the simulated drive, a process of its own, is without power: at once after a signal that can be caught, after the time
# of its sync manager's watchdog after SIGKILL. What was set is as it was, and the drive in PRE-OP, but for SIGKILL.
# usage: ring_kill_test.sh SERVOCTL [KILLS [MASTER_URL [RING_URL]]]
set -u
servoctl=$1
kills=${2:-20}
bus=${3:-coe:local:ring-kill-$$}
ring=${4:-$bus}
work=$(mktemp -d)
export SERVOCTL_BUS=$bus SERVOCTL_NODE=1 SERVOCTL_DRIVE=sv2
failures=0
trap 'kill "$sim" 2>/dev/null; wait "$sim" 2>/dev/null; rm -rf "$work"' EXIT

# With the first failure, who is there still: a process that is stopped, or waits for what does not come.
fail() {
  failures=$((failures + 1))
  printf 'FAILED %s\n' "$*"
  [ "$failures" -gt 1 ] || ps -o pid,ppid,pgid,stat,wchan:24,etimes,args --deselect -p 2 --ppid 2 | cut -c1-160
}
wait_for() { for _ in $(seq 200); do "$servoctl" status --json >/dev/null 2>&1 && return 0; sleep 0.05; done; return 1; }
state() { "$servoctl" status --json | jq -r '.result[0] | "\(.energised) \(.state) \(.al_state)"'; }
held() { "$servoctl" read 0x6060 0x60FF 0x1C12:0 0x1C12:1 0x1C13:0 --json | jq -c '[.result[].value]'; }

"$servoctl" sim sv2@1 --bus "$ring" >"$work/sim" 2>&1 &
sim=$!
wait_for || { cat "$work/sim"; echo "FAILED: the simulated drive does not answer"; exit 1; }

commands=("jog 60rpm --for 2s" "jog -120rpm --turns 3" "move 2rev --relative --speed 120rpm" "home 17 --speed 60rpm --search 6rpm"
  "torque 2% --limit 60rpm --for 2s" "enable")
# Lines that end: a signal in the last of them is remembered, also while nobody reads what it shows.
printf 'enable --yes\nwatch statusword --every 2ms --for 20s\n' >"$work/lines"
commands+=("run $work/lines" "run $work/lines --json")
mkfifo "$work/unread"
exec 9<>"$work/unread"
signals=(INT TERM HUP QUIT TSTP USR1 KILL INTINT)
before=$(held)
RANDOM=${SEED:-4711}
moving=0
tried=0
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
  kill -INT "$1"; kill -CONT "$1"
}
# One kill, of this number.
kill_once() {
  tried=$((tried + 1))
  command=${commands[RANDOM % ${#commands[@]}]}
  signal=${signals[$1 % ${#signals[@]}]}
  delay=$((20 + RANDOM % 2500))
  out=$work/out
  : >"$work/out"
  case $command-$((RANDOM % 2)) in run*-0) out=$work/unread ;; esac
  # shellcheck disable=SC2086
  in_group "$servoctl" $command --yes >"$out" 2>"$work/err" &
  pid=$!
  sleep "$((delay / 1000)).$(printf %03d $((delay % 1000)))"
  grep -q ' rpm\|ENERGISED' "$work/out" "$work/err" && kill -0 "$pid" 2>/dev/null && moving=$((moving + 1))
  case $signal in
    INTINT) kill -INT "$pid" 2>/dev/null; kill -INT "$pid" 2>/dev/null; sleep 0.02; kill -INT "$pid" 2>/dev/null ;;
    *) kill "-$signal" "$pid" 2>/dev/null ;;
  esac
  [ "$signal" = TSTP ] && end_or_stop "$pid"
  # What ends by itself is waited for; USR1 is none of its business.
  [ "$signal" = USR1 ] && { sleep 0.2; kill -INT "$pid" 2>/dev/null; }
  wait "$pid" 2>/dev/null
  code=$?
  # The one place where Ctrl-C is how the user ends it is a single `enable`.
  case $signal-$command in
    KILL-*) ;;
    *-run*) [ "$code" -ge 128 ] || { fail "$command, $signal after $delay ms: the exit code is $code"; cat "$work/err"; } ;;
  esac
  [ "$signal" = KILL ] && sleep 0.2
  after=$(state)
  case $signal-$after in
    KILL-false*) ;;
    *-'false '*' PRE-OP') ;;
    *) fail "$command, $signal after $delay ms: the drive is '$after'"; cat "$work/err" ;;
  esac
  if [ "$signal" = KILL ]; then
    # What its watchdog has stopped is in fault, and keeps what was set.
    "$servoctl" state preop >/dev/null 2>"$work/err" || fail "the slave does not go back to PRE-OP: $(cat "$work/err")"
    "$servoctl" fault reset --yes >/dev/null 2>&1
    kill "$sim"; wait "$sim" 2>/dev/null
    "$servoctl" sim sv2@1 --bus "$ring" >"$work/sim" 2>&1 &
    sim=$!
    wait_for || fail "the drive does not start again"
  else
    # A machine that stalls for longer than the watchdog has the drive stopped by it.
    case $after in *fault*) "$servoctl" fault reset --yes >/dev/null 2>&1 ;; esac
    left=$(held)
    [ "$left" = "$before" ] || { fail "$command, $signal after $delay ms: left $left"; cat "$work/err"; }
  fi
}
for i in $(seq "$kills"); do kill_once "$i"; done
[ "$tried" -eq "$kills" ] || fail "$tried of $kills kills were tried"

# What is held and falls by itself is an error; what its user ends is none.
timeout 20 "$servoctl" -b 'coe:sim:sv2@1?fall=1s' state op >"$work/out" 2>"$work/err"
code=$?
[ "$code" -eq 1 ] || fail "a held slave that falls: the exit code is $code: $(cat "$work/err")"
grep -q 'synchronisation error' "$work/err" || fail "a held slave that falls: its reason is not told: $(cat "$work/err")"
timeout --preserve-status -s INT 2 "$servoctl" -b coe:sim:sv2@1 enable --yes >"$work/out" 2>"$work/err"
code=$?
[ "$code" -eq 0 ] || fail "a held drive that is ended: the exit code is $code: $(cat "$work/err")"
grep -q 'stopped and disabled' "$work/err" || fail "a held drive that is ended: $(cat "$work/err")"

echo "$kills kills, $moving of them while the drive was energised, $failures failures"
[ "$moving" -gt $((kills / 10)) ] || { echo "FAILED: too few kills met an energised drive: the test itself is broken"; exit 1; }
[ "$failures" -eq 0 ]
