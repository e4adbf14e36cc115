#!/usr/bin/env bash
# Interfaces brought up and down, looked at, and their bitrate found. Runs inside with-vcan.sh, with either backend:
# uml has adapters on a serial line whose errors are written to /dev/can0.inject, qemu has controllers with a bit timing.
# usage: field_test.sh SERVOCTL
set -u
servoctl=$1
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
background=()
trap '[ ${#background[@]} -eq 0 ] || kill "${background[@]}" 2>/dev/null; rm -rf "$work"' EXIT
failures=0
checks=0
out=
code=

fail() { failures=$((failures + 1)); printf 'FAILED %s\n%s\n' "$*" "$out"; }
# run WORDS: what it says stands in $out, its exit code in $code.
run() { checks=$((checks + 1)); out=$("$servoctl" "$@" 2>&1); code=$?; }
# expect CODE PATTERN: of the last run.
expect() {
  [ "$code" -eq "$1" ] || fail "exit code $code, not $1, and: $2"
  grep -qE -- "$2" <<<"$out" || fail "it does not say: $2"
}
bitrate() { ip -details link show "$1" | grep -oE 'bitrate [0-9]+' | grep -oE '[0-9]+'; }
is_up() { ip link show "$1" | grep -q '[<,]UP[,>]'; }
is_at() { is_up can0 && [ "$(bitrate can0)" = "$1" ]; }

# simulate DRIVE: on can1, until the next kill of ${background[-1]}.
simulate() {
  "$servoctl" sim "$1" --bus can1 >"$work/sim" 2>&1 & background+=($!)
  for _ in $(seq 100); do grep -q 'drive on' "$work/sim" && return; sleep 0.1; done
  fail "$1 does not start: $(cat "$work/sim")"
}

case ${VCAN_GUEST:-} in uml | qemu) ;; *) echo "skipped: there is no can0 and can1"; exit 0 ;; esac

check_up_and_down() {
  run bus up can0 --bitrate 1M; expect 0 'up with these settings already'
  run bus up can0 --bitrate 250k; expect 8 'Take can0 down and up again\? It is up with 1 Mbit/s instead of 250 kbit/s'
  [ "$(bitrate can0)" = 1000000 ] || fail "a question that was not answered changed can0"
  run bus up can0 --bitrate 250k --yes; expect 0 '^bitrate +250 kbit/s'
  is_at 250000 || fail "can0 is not up at 250000"
  run bus up can0 --bitrate 500k --dry-run; expect 0 'ip link set can0 up type can bitrate 500000'
  [ "$(bitrate can0)" = 250000 ] || fail "a dry run changed can0"
  run bus up can0 --bitrate 500k --yes --read-only; expect 8 "changes an interface, and --read-only forbids it"
  run bus up can0 --txqueuelen 1000; expect 0 '^queue length +1000'
  ip link show can0 | grep -q 'qlen 1000' || fail "the queue of can0 is not 1000"
  run bus down can0; expect 0 '^up +no'
  is_up can0 && fail "can0 is still up"
  run bus down can0; expect 0 'down already'
  run bus up can0; expect 0 '^bitrate +250 kbit/s'
  run bus up vcan0 --bitrate 500k --yes; expect 2 'vcan0 \(vcan\) has no bitrate to set'
  ip link set vcan0 down
  run bus up vcan0; expect 0 '^up +yes'
  run bus up nocan0 --bitrate 500k; expect 3 'there is no interface nocan0'
  run bus up lo; expect 3 'lo is not a CAN interface'
  run bus up can0 --bitrate 777777 --yes; expect 2 'can0 (cannot make|has no bitrate of) 777777 bit/s.*can0 is up again as before'
  is_at 250000 || fail "can0 is not as it was behind a refusal"
  run bus up can0 --bitrate 1M --yes; expect 0 '^bitrate +1 Mbit/s'
}

check_status() {
  run bus status; expect 0 '^can0 +up +error-active +1 Mbit/s'; expect 0 '^vcan0 +up'
  run bus status can0 --json
  [ "$(jq -r '.result | "\(.up) \(.state) \(.bitrate) \(.kind) \(.may_change) \(.queue_length)"' <<<"$out")" = \
    "true error-active 1000000 can true 1000" ] || fail "bus status can0 --json"
}

# What holds an interface: a program that receives from it.
check_holders() {
  candump can0 >/dev/null & background+=($!)
  local holder=$!
  sleep 0.5
  run bus down can0; expect 8 '1 program of this machine receives from can0 now'
  is_up can0 || fail "can0 went down without a question"
  run bus up can0 --bitrate 500k; expect 8 '1 program of this machine receives'
  kill "$holder"; wait "$holder" 2>/dev/null
  simulate 'ts@1?panel=Fn_00=20'
  for line in 'bus down can0' 'bus up can0 --bitrate 500k' 'bus detect can0'; do
    printf 'enable -n 1 -d ts --yes\n%s --yes\n' "$line" >"$work/held"
    out=$("$servoctl" --bus can0 <"$work/held" 2>&1); code=$?; checks=$((checks + 1))
    expect 8 'can0 stays as it is: node 1 was left energised over it'
    is_at 1000000 || fail "$line took can0 from under an energised drive"
  done
  kill "${background[-1]}"; wait "${background[-1]}" 2>/dev/null
}

# A user without the right: of another user namespace, which owns no network.
check_right() {
  run bus status can0; expect 0 'may be changed by you +yes'
  unshare -U true 2>/dev/null || { echo "no user namespaces: rights are not tried"; return; }
  out=$(unshare -U "$servoctl" bus up can0 --bitrate 250k --yes 2>&1); code=$?; checks=$((checks + 1))
  expect 3 'this user may not change interfaces'; expect 3 'setcap cap_net_admin\+ep'
  out=$(unshare -U "$servoctl" bus status can0 2>&1); code=$?; checks=$((checks + 1))
  expect 0 'may be changed by you +no'
}

# The frames of one end are heard at the other at any bitrate: neither backend has bits.
check_detect() {
  run bus detect can0 --for 500ms; expect 8 'Take can0 down to listen at other bitrates\? It is up at 1 Mbit/s'
  run bus detect can0 --for 300ms --bitrate 250k --bitrate 125k --yes
  expect 1 'no bitrate was found on can0: nobody talks'; expect 1 '^125 kbit/s +silent'
  is_at 1000000 || fail "can0 is not back at 1 Mbit/s behind a search"
  ip -details link show can0 | grep -q LISTEN-ONLY && fail "can0 still only listens"
  while sleep 0.1; do cansend can1 701#05; done 2>/dev/null & background+=($!)
  run bus detect can0 --for 2s --bitrate 250k --yes; expect 0 '^bitrate +250 kbit/s'
  is_at 1000000 || fail "can0 is not back at 1 Mbit/s behind a find"
  ip link set can0 down
  run bus detect can0 --for 2s; expect 0 '^bitrate +500 kbit/s'; expect 0 'bus up can0 --bitrate 500000'
  is_up can0 && fail "can0 was down and is up"
  [ "$(bitrate can0)" = 1000000 ] || fail "can0 does not have its bitrate any more"
  kill "${background[-1]}"; wait "${background[-1]}" 2>/dev/null
  ip link set can0 up
  "$servoctl" bus detect can0 --for 5s --yes >"$work/out" 2>&1 & local search=$!
  sleep 2
  kill -INT "$search"; wait "$search"; code=$?; out=$(cat "$work/out"); checks=$((checks + 1))
  [ "$code" -eq 130 ] || fail "Ctrl-C ends a search with $code"
  is_at 1000000 || fail "can0 is not back at 1 Mbit/s behind Ctrl-C"
}

check_all_bitrates() {
  run scan --all-bitrates --bus can0; expect 8 'Ask for nodes on can0 at each bitrate\?'
  simulate gsd600@1
  run scan --all-bitrates --bus can0 --yes
  expect 0 'gsd600'; expect 0 'nodes answered at 500 kbit/s: can0 stays at it \(it was at 1 Mbit/s'
  is_at 500000 || fail "can0 is not where the node answered"
  kill "${background[-1]}"; wait "${background[-1]}" 2>/dev/null
  run scan --all-bitrates --bus can0 --yes; expect 4 'can0 is at 500 kbit/s.* again'
  is_at 500000 || fail "can0 was not put back"
  while sleep 0.1; do cansend can1 181#01; done 2>/dev/null & background+=($!)
  run scan --all-bitrates --bus can0 --yes; expect 8 'can0 is in use: .* heard at 500 kbit/s'
  kill "${background[-1]}"; wait "${background[-1]}" 2>/dev/null
  run bus up can0 --bitrate 1M --yes; expect 0 '1 Mbit/s'
}

# codes: those of the last run with --json that are not ok.
codes() { jq -r '[.result[] | select(.level != "ok") | .code] | join(" ")' <<<"$out"; }
# diagnose LINES CODES: the doctor finds CODES (a pattern) while each of LINES is injected again and again.
diagnose() {
  local line
  (while sleep 0.05; do for line in $1; do printf '%s\r' "$line" >/dev/can0.inject; done; done) & background+=($!)
  checks=$((checks + 1))
  out=$("$servoctl" doctor can0 --for 1s --json 2>/dev/null); code=$?
  kill "${background[-1]}"; wait "${background[-1]}" 2>/dev/null
  [[ $(codes) =~ ^($2)$ ]] || fail "$1 is taken for $(codes), not $2"
  sleep 0.2
}

check_doctor() {
  run doctor can0 --for 500ms; expect 0 'nothing was heard'; expect 0 '^can0 +ok +can0 is up, 1 Mbit/s'
  run doctor --for 200ms --json; expect 0 '"bus":"vcan1"'
  run doctor can0 --active --for 200ms; expect 1 'no node answered a read of 1000h'
  simulate gsd600@5
  run doctor can0 --active --for 200ms; expect 0 'answered: node 5'
  simulate gsd600@5
  run doctor can0 --active --for 200ms; expect 1 'two nodes have the number 5'
  kill "${background[-1]}" "${background[-2]}"; wait "${background[-1]}" "${background[-2]}" 2>/dev/null
  ip link set can0 down
  run doctor can0; expect 1 'can0 is down'; expect 1 'mend: .bus up can0.'
  ip link set can0 up
  run doctor nocan0; expect 1 'there is no interface nocan0'
}

# What the adapter says, as slcan takes it: form, stuff and bit errors, no acknowledge, overrun.
check_doctor_errors() {
  local rest='no-restart (short-queue )?(was-bus-off )?'
  diagnose 'e1f e1s e1b' "${rest}wrong-bitrate"
  diagnose 'e1f t701105' "${rest}damaged-frames"
  diagnose 'e1a' "${rest}nobody-acknowledges"
  diagnose 't701105 e1o' "${rest}overrun"
  diagnose 't701105 T18FEF10000' "${rest}foreign-frames"
  diagnose 't705100' "${rest}duplicate-node"
  printf 'sp140000\r' >/dev/can0.inject
  run doctor can0 --for 300ms; expect 1 'error-passive'
  printf 'sb000256\r' >/dev/can0.inject
  sleep 0.3
  run doctor can0 --for 300ms; expect 1 'the controller is bus-off'
  run bus up can0; expect 0 'error-active'
}

check_controller() {
  run bus up can0 --bitrate 500k --sample-point 75% --restart-ms 100 --yes
  expect 0 '^sample point +75.0 %'; expect 0 'restart after bus-off +after 100 ms'
  ip -details link show can0 | grep -q 'sample-point 0.750' || fail "the sample point of can0 is not 0.75"
  run bus up can0 --bitrate 500k --sample-point 75%; expect 0 'nothing was changed'
  run bus up can0 --bitrate 1M --restart-ms 0 --yes; expect 0 'not by itself'
  run bus status can0; expect 0 '^driver +kvaser_pci'
}

check_slcan() {
  run bus up can0 --restart-ms 100 --yes; expect 2 'does not restart by itself after a bus-off'
  is_up can0 || fail "can0 is down behind a refusal"
  printf 'sb000256\r' >/dev/can0.inject
  sleep 0.5
  run bus status can0; expect 0 '^state +bus-off'
  run bus up can0; expect 0 '^state +error-active'
}

# Simulated drives keep their place on the wire at any bitrate: what is shown here is the interface of the kernel.
check_drives_and_interface() {
  simulate gsd600@3
  run address --bitrate 500k -n all -d gsd600 -b can0 --dry-run
  # shellcheck disable=SC2016  # A command that is shown, not run.
  expect 0 '000#8100 \(NMT reset node to all\), `ip link set can0 down`, `ip link set can0 up type can bitrate 500000`'
  [ "$(bitrate can0)" = 1000000 ] || fail "a dry run changed can0"
  run address --bitrate 500k -n all -d gsd600 -b can0; expect 8 'and can0 goes to 500 kbit/s \(from 1 Mbit/s'
  [ "$(bitrate can0)" = 1000000 ] || fail "a question that was not answered changed can0"
  run address --bitrate 500k -n all -d gsd600 -b can0 --yes; expect 0 'found at its new bitrate'
  is_at 500000 || fail "can0 did not go to 500000 with the drive"
  kill "${background[-1]}"; wait "${background[-1]}" 2>/dev/null
  run bus up can0 --bitrate 1M --yes; expect 0 '^bitrate +1 Mbit/s'
}

check_slaves_and_interface() {
  simulate 'gsd600@3?lss'
  local line=(lss set-bitrate 500k --all --activate 1s -b can0)
  run "${line[@]}" --dry-run
  # shellcheck disable=SC2016  # A command that is shown, not run.
  expect 0 '`ip link set can0 down`, `ip link set can0 up type can bitrate 500000`'
  run "${line[@]}"; expect 8 'can0 goes with them to 500 kbit/s \(from 1 Mbit/s'
  [ "$(bitrate can0)" = 1000000 ] || fail "a question that was not answered changed can0"
  run "${line[@]}" --yes; expect 0 'can0 went with them: 500 kbit/s'
  is_at 500000 || fail "can0 did not go to 500000 with the slave"
  run bus up can0 --bitrate 1M --yes; expect 0 '^bitrate +1 Mbit/s'
  "$servoctl" sim gsd600@9 --bus can1 >"$work/other" 2>&1 & background+=($!)
  sleep 1
  run "${line[@]}" --yes; expect 0 'can0 is left alone: node 9 would be left at 1 Mbit/s'; expect 0 'bus up can0 --bitrate 500000'
  is_at 1000000 || fail "can0 left a node behind"
  kill "${background[-1]}" "${background[-2]}"; wait "${background[-1]}" "${background[-2]}" 2>/dev/null
  run lss set-bitrate 500k --all --activate 1s -b vcan0 --yes; expect 4 'no LSS slave answers'
}

# The documents of what only an interface of the kernel has, against docs/schema/.
hold() {
  checks=$((checks + 1))
  out=$("$servoctl" "$@" --json 2>/dev/null | python3 "$here/../cli/hold_documents.py" 2>&1) || fail "$* --json is not as docs/schema/ says"
}
check_documents() {
  python3 -c 'import jsonschema' 2>/dev/null || { echo "python3-jsonschema is missing: no document is held against its schema"; return; }
  hold bus status
  hold bus status can0
  hold bus up can0 --bitrate 250k --yes --dry-run
  hold bus up can0 --bitrate 250k
  hold bus up can0 --bitrate 250k --yes
  hold bus detect can0 --dry-run
  hold bus detect can0 --for 100ms --bitrate 125k --yes
  hold scan --all-bitrates --bus can0 --dry-run
  hold doctor can0 --for 200ms
  hold doctor --for 200ms
  hold bus down can0 --dry-run
  hold bus down can0
  hold bus status can0
  hold bus down can0 --dry-run
  run bus up can0 --bitrate 1M --yes; expect 0 '1 Mbit/s'
}

check_up_and_down
check_documents
check_drives_and_interface
check_slaves_and_interface
check_status
check_holders
check_right
check_detect
check_all_bitrates
check_doctor
if [ "$VCAN_GUEST" = qemu ]; then check_controller; else check_slcan; check_doctor_errors; fi

printf '%d checks, %d failed\n' "$checks" "$failures"
[ "$failures" -eq 0 ]
