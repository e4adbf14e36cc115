#!/usr/bin/env bash
# The link of a motion goes down and comes back: the drive, behind another controller, is stopped as soon as it does.
# Runs inside with-vcan.sh, with can0 and can1 on one bus. usage: link_test.sh SERVOCTL
set -u
servoctl=$1
work=$(mktemp -d)
sim=
trap 'kill $sim 2>/dev/null; rm -rf "$work"' EXIT
failures=0
checks=0

[ "${VCAN_GUEST:-}" = uml ] || { echo "skipped: there is no can0 and can1"; exit 0; }
fail() { failures=$((failures + 1)); printf 'FAILED %s\n' "$*"; }
state() { "$servoctl" status -n 1 --bus can1 -d "$1" --json | jq -r '.result[0] | "\(.energised) \(.state)"'; }
until_state() {  # until_state FAMILY PATTERN
  # shellcheck disable=SC2254  # A pattern is meant.
  for _ in $(seq 200); do case $(state "$1" 2>/dev/null) in $2) return 0 ;; esac; sleep 0.05; done
  return 1
}

# break_link HOW: what happens to can0 while the motor turns; it is back afterwards.
break_link() {
  case $1 in
    moment) ip link set can0 down; sleep 0.02; ip link set can0 up ;;
    seconds) ip link set can0 down; sleep 3; ip link set can0 up ;;
    bus-off) printf 'sb000256\r' >/dev/can0.inject; sleep 1; ip link set can0 down; ip link set can0 up ;;
  esac
}

# check_link FAMILY HOW TURN. Where this machine stood still for longer than the drive's watchdog waits, nothing is said of
# the link: it is tried again.
check_link() {
  local family=$1 how=$2 turn=$3 try
  for try in 1 2 3; do
    "$servoctl" jog 60rpm --for 30s ${turn:+--turn $turn} -n 1 -d "$family" --bus can0 --yes >"$work/out" 2>"$work/err" &
    client=$!
    if until_state "$family" 'true*'; then break_link "$how"; fi
    wait "$client"
    code=$?
    after=$(state "$family")
    # A drive whose watchdog has tripped meanwhile starts anew.
    case $after in *fault*) "$servoctl" nmt reset -n 1 --bus can1 --wait --yes >/dev/null ;; esac
    grep -q 'sent emergency 0x8130 while moving' "$work/err" || break
    echo "$family, $how: this machine stood still in try $try"
  done
  case $after in false*) ;; *) fail "$family, $how: the drive is '$after'"; cat "$work/err" ;; esac
  [ "$code" -ne 0 ] || fail "$family, $how: the exit code is 0"
  grep -q 'stopping node 1 waits for the bus' "$work/err" || fail "$family, $how: it does not say that it goes on: $(cat "$work/err")"
  grep -qE 'can0 (is back after|can be opened)' "$work/err" || fail "$family, $how: it does not say that the link is back"
}

for family in da200 sv2 gsd600 dm ts; do
  turn=
  case $family in gsd600 | sv2) turn=131072 ;; da200 | ts) turn=10000 ;; esac
  # As delivered these two select another source of commands.
  obeying=
  case $family in da200) obeying='?panel=P0.03=7' ;; ts) obeying='?panel=Fn_00=20' ;; esac
  "$servoctl" sim "$family@1$obeying" --bus can1 >"$work/sim" 2>&1 &
  sim=$!
  until_state "$family" '*' || fail "$family: the drive does not answer: $(cat "$work/sim")"
  for how in moment seconds bus-off; do
    checks=$((checks + 1))
    check_link "$family" "$how" "$turn"
  done
  kill "$sim"; wait "$sim" 2>/dev/null
done

printf '%d checks, %d failed\n' "$checks" "$failures"
[ "$failures" -eq 0 ]
