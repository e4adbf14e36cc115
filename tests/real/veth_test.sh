#!/usr/bin/env bash
# The built program on Ethernet interfaces of the kernel: both ends of a veth pair, in a network namespace of their own.
# Exits with 125 where there can be none.
# usage: veth_test.sh SERVOCTL
set -u
if [ "${VETH_TEST-}" != inside ]; then
  enter=(unshare --net)
  [ "$(id -u)" -eq 0 ] || enter=(unshare --map-root-user --net)
  PATH=$PATH:/usr/sbin:/sbin
  "${enter[@]}" sh -c 'ip link add veth0 type veth peer name veth1' 2>/dev/null || { echo "no network namespace with veth here"; exit 125; }
  VETH_TEST=inside VETH_USER=$(id -u) exec "${enter[@]}" "$0" "$@"
fi
servoctl=$1
work=$(mktemp -d)
trap 'jobs -p | xargs -r kill -9 2>/dev/null; rm -rf "$work"' EXIT
failures=0
checks=0

check() {  # check NAME EXPECTED ACTUAL
  checks=$((checks + 1))
  [ "$2" = "$3" ] && return
  failures=$((failures + 1))
  printf 'FAILED %s\n  expected: %s\n  actual:   %s\n' "$1" "$2" "$3"
}
contains() {  # contains NAME PART TEXT
  checks=$((checks + 1))
  case $3 in *"$2"*) return ;; esac
  failures=$((failures + 1))
  printf 'FAILED %s\n  expected part: %s\n  actual:        %s\n' "$1" "$2" "$3"
}
wait_for() {  # wait_for FILE TEXT: until a background program has said it
  for _ in $(seq 200); do grep -q "$2" "$1" 2>/dev/null && return 0; sleep 0.05; done
  echo "FAILED: '$2' did not come in $1"
  failures=$((failures + 1))
}
on_veth0() { "$servoctl" "$@" -b coe:veth0 2>&1; }
nodes() { on_veth0 scan --json | jq -r '[.result[].node] | join(" ")'; }
serve() {  # serve DRIVES: in the background, as $sim
  : >"$work/sim"
  "$servoctl" sim "$1" --bus coe:veth1 >"$work/sim" 2>&1 &
  sim=$!
  wait_for "$work/sim" "Ctrl-C ends it"
}

# 1. What keeps an interface from being opened, each with its own words.
contains "no such interface" "there is no interface veth0" "$(on_veth0 scan)"
on_veth0 scan >/dev/null
check "its exit code" 3 $?
contains "loopback" "lo leads back to this machine" "$("$servoctl" scan -b coe:lo 2>&1)"
ip link add veth0 type veth peer name veth1
contains "the interfaces there are" "did you mean veth0 or veth1?" "$("$servoctl" scan -b coe:vet 2>&1)"
contains "an interface that is down" "bring it up: \`sudo ip link set veth0 up\`" "$(on_veth0 scan)"
ip link set veth0 up
contains "no link" "veth0 has no link" "$(on_veth0 scan)"
ip link set veth1 up
contains "a link and no drives" "frames do not come back" "$(on_veth0 scan)"

# 2. Simulated drives at the other end.
serve sv2@1,sv2@2
check "scan finds both" "1 2" "$(nodes)"
contains "an object" '"value":"DSX00E"' "$(on_veth0 read 0x1008 -n 2 --json)"
check "a write" "ok 777" "$(on_veth0 write 0x6081 777 -n 1 --json >/dev/null && echo ok) $(on_veth0 read 0x6081 -n 1 --json | jq '.result[0].value')"

# 3. One process a wire.
contains "a second ring" "veth1 is in use by process $sim (servoctl sim" "$("$servoctl" sim sv2@1 --bus coe:veth1 2>&1)"
"$servoctl" watch 0x6041 -n 1 --for 60s -b coe:veth0 >"$work/watch" 2>&1 &
first=$!
wait_for "$work/watch" 0x
contains "a second master" "veth0 is in use by process $first (servoctl watch" "$(on_veth0 scan)"
on_veth0 scan >/dev/null
check "its exit code" 3 $?
kill -9 "$first"; wait "$first" 2>/dev/null
check "a master that was killed hinders nobody" "1 2" "$(nodes)"

# 4. Locks are of a network namespace, as interfaces are: another has a veth0 of the same index.
"$servoctl" watch 0x6041 -n 1 --for 60s -b coe:veth0 >"$work/watch" 2>&1 &
first=$!
wait_for "$work/watch" 0x
# shellcheck disable=SC2016  # Expanded inside.
other=$(unshare --net sh -c 'ip link add veth0 type veth peer name veth1 && ip link set veth0 up && ip link set veth1 up && "$0" scan -b coe:veth0 2>&1' "$servoctl")
contains "another namespace is not locked" "frames do not come back" "$other"
kill -9 "$first"; wait "$first" 2>/dev/null

# 5. The right to send.
if [ "$VETH_USER" -eq 0 ] && command -v setpriv >/dev/null; then
  as_nobody=(setpriv --reuid 65534 --regid 65534 --clear-groups --inh-caps=-all)
  chmod 755 "$work"
  cp "$servoctl" "$work/servoctl"
  denied=$("${as_nobody[@]}" "$work/servoctl" scan -b coe:veth0 2>&1)
  contains "no right" "no right to send Ethernet frames on veth0" "$denied"
  # shellcheck disable=SC2016  # Backquotes of the text.
  command=$(sed -n 's/.*`sudo \(setcap [^`]*\)`.*/\1/p' <<<"$denied")
  check "the command for this very program" "setcap cap_net_raw+ep $work/servoctl" "$command"
  if $command 2>/dev/null; then
    contains "that command helps" DSX00E "$("${as_nobody[@]}" "$work/servoctl" scan -b coe:veth0 2>&1)"
  fi
fi

# 6. A trace.
for form in pcap pcapng; do
  on_veth0 read 0x1008 -n 1 --trace "$work/trace.$form" >/dev/null
  [ "$form" = pcap ] && magic=d4c3b2a1 || magic=0a0d0d0a
  check "what a $form begins with" "$magic" "$(head -c 4 "$work/trace.$form" | od -An -tx1 | tr -d ' ')"
  if command -v tshark >/dev/null; then
    check "all frames of the $form are EtherCAT" 0x88a4 "$(tshark -r "$work/trace.$form" -T fields -e eth.type 2>/dev/null | sort -u)"
  fi
done
contains "another name" "the trace of an EtherCAT bus is a .pcap or .pcapng" "$(on_veth0 scan --trace "$work/trace.log")"

# 7. Cables and interfaces that go and come back.
"$servoctl" watch 0x6041 -n 1 --for 60s -b coe:veth0 >"$work/watch" 2>&1 &
first=$!
wait_for "$work/watch" 0x
ip link set veth0 down
wait "$first"
check "an interface that goes down ends what runs" 3 $?
contains "with its name" "veth0 went down" "$(cat "$work/watch")"
contains "an end that is down" "veth0 is down" "$(on_veth0 scan)"
ip link set veth0 up
check "the ring is still there" "1 2" "$(nodes)"
ip link set veth1 down
wait "$sim"
check "a ring whose interface goes down ends" 3 $?
contains "with words" "veth1 went down" "$(cat "$work/sim")"
ip link set veth1 up

# 8. What goes wrong in a ring.
serve 'sv2@1,sv2@2?lose=7&short=11'
check "losses and short counters are made up for" "1 2" "$(nodes)"
kill -INT "$sim"
wait "$sim"
check "Ctrl-C ends a ring" 0 $?
serve 'sv2@1,sv2@2?cut=2@10ms'
sleep 0.1
check "behind a cut cable there is nobody" 1 "$(nodes)"
kill -9 "$sim"
wait "$sim" 2>/dev/null
serve sv2@1
check "a ring that was killed hinders nobody" 1 "$(nodes)"

echo "$checks checks, $failures failed"
[ "$failures" -eq 0 ]
