#!/usr/bin/env bash
# The built program on real SocketCAN. Runs inside with-vcan.sh, which provides vcan0, vcan1 and can-utils.
# usage: vcan_test.sh SERVOCTL
set -u
servoctl=$1
work=$(mktemp -d)
trap 'jobs -p | xargs -r kill 2>/dev/null; rm -rf "$work"' EXIT
export SERVOCTL_BUS=vcan0
failures=0
checks=0

check() {  # check NAME EXPECTED ACTUAL
  checks=$((checks + 1))
  if [ "$2" != "$3" ]; then
    failures=$((failures + 1))
    printf 'FAILED %s\n  expected: %s\n  actual:   %s\n' "$1" "$2" "$3"
  fi
}
contains() {  # contains NAME PART TEXT
  checks=$((checks + 1))
  case $3 in
    *"$2"*) ;;
    *) failures=$((failures + 1)); printf 'FAILED %s\n  expected part: %s\n  actual:        %s\n' "$1" "$2" "$3" ;;
  esac
}
wait_for() {  # wait_for FILE TEXT: until a background program has said it
  for _ in $(seq 200); do grep -q "$2" "$1" 2>/dev/null && return 0; sleep 0.05; done
  echo "FAILED: '$2' did not come in $1"; failures=$((failures + 1))
}

# 1. A simulated drive on vcan0, commands from other processes.
"$servoctl" sim gsd600@1,gsd600@5 >"$work/sim.out" 2>&1 &
sim=$!
wait_for "$work/sim.out" vcan0
candump -L vcan0 >"$work/dump" &
check "scan finds both drives" "1 5" "$("$servoctl" scan --json | jq -r '[.result[].node] | join(" ")')"
check "read" 624 "$("$servoctl" read 0x6041 -n 1 --json | jq '.result[0].value')"
check "write and read back" 450 "$("$servoctl" param set Pn0214 45Hz -n 5 -d gsd600 --json | jq '.result[0].raw')"
check "the other drive is untouched" 600 "$("$servoctl" param get Pn0214 -n 1 -d gsd600 --json | jq '.result[0].raw')"
"$servoctl" read 0x6041 -n 9 --timeout 100ms >/dev/null 2>&1
check "exit code without answer" 4 $?
"$servoctl" read 0x5FFF -n 1 >/dev/null 2>&1
check "exit code of an abort" 5 $?
check "reset is confirmed by boot-up" true "$("$servoctl" nmt reset -n 1 --wait --yes --json | jq '.result[0].confirmed')"
sleep 0.1
contains "the read as candump saw it" "601#4041600000000000" "$(cat "$work/dump")"
contains "its answer" "581#4B41600070020000" "$(cat "$work/dump")"
contains "the boot-up" "701#00" "$(cat "$work/dump")"
check "node guarding finds both drives alive" "0 0" "$("$servoctl" nmt watch -n 1,5 --guard 100ms --for 1s --json | jq -r '[.result.nodes[].lost] | join(" ")')"
contains "it asks by remote frames" "701#R" "$(cat "$work/dump")"
contains "the toggle bit alternates" "701#FF" "$(cat "$work/dump")"

# 2. Hand-written frames against the simulated drive.
: >"$work/dump2"
candump -L vcan0,581:7FF >"$work/dump2" &
sleep 0.2
cansend vcan0 601#4061600000000000
cansend vcan0 601#23FF6000E8030000
wait_for "$work/dump2" '581#60FF600000000000'
contains "answer to a hand-written read" "581#4F61600001000000" "$(cat "$work/dump2")"

# 3. Hand-written answers to the client: foreign nodes, foreign objects and a segmented string.
kill $sim; wait $sim 2>/dev/null
"$servoctl" read 0x1008 -n 7 --timeout 3s --json >"$work/string" 2>&1 &
client=$!
sleep 0.5
# It asks first who this is: 1000h, 1018h:01 and :02, which this node does not have.
for number in 001000 181001 181002; do cansend vcan0 587#80${number}00000206; sleep 0.2; done
cansend vcan0 588#4308100000000000
cansend vcan0 587#4309100041414141
cansend vcan0 587#410810000A000000
sleep 0.2
cansend vcan0 587#00536572766F2D35
sleep 0.2
cansend vcan0 587#1930303000000000
wait $client
check "segmented string by hand" "Servo-5000" "$(jq -r '.result[0].value' "$work/string")"

# 4. The trace is what candump writes.
"$servoctl" sim gsd600@1 >"$work/sim2.out" 2>&1 &
sim=$!
wait_for "$work/sim2.out" vcan0
"$servoctl" read 0x6041 -n 1 --trace "$work/trace" >/dev/null
check "trace" "601#4041600000000000 581#4B41600070020000" "$(awk '{print $3}' "$work/trace" | tail -n 2 | tr '\n' ' ' | sed 's/ $//')"
contains "trace names the interface" " vcan0 " "$(cat "$work/trace")"

# 5. Interface missing, down, and down in mid-transfer.
message=$("$servoctl" read 0x6041 -n 1 --bus vcan7 2>&1)
check "exit code of a missing interface" 3 $?
contains "missing interface names the mending command" "ip link add dev vcan" "$message"
ip link set vcan1 down
message=$("$servoctl" read 0x6041 -n 1 --bus vcan1 2>&1)
check "exit code of an interface that is down" 3 $?
contains "down interface names the mending command" "bus up vcan1" "$message"
ip link set vcan1 up
"$servoctl" read 0x6041 -n 9 --bus vcan1 --timeout 20s >"$work/down" 2>&1 &
client=$!
sleep 0.5
ip link set vcan1 down
wait $client
check "exit code when the interface goes down in mid-transfer" 3 $?
contains "it says so" "vcan1" "$(cat "$work/down")"

# 6. Two controllers on one bus; one of them goes bus-off in mid-transfer and comes back.
if [ "${VCAN_GUEST:-}" = uml ]; then
  "$servoctl" sim gsd600@1 --bus can1 >"$work/sim3.out" 2>&1 &
  wait_for "$work/sim3.out" can1
  check "a drive behind another controller" 624 "$("$servoctl" read 0x6041 -n 1 --bus can0 --json | jq '.result[0].value')"
  "$servoctl" read 0x6041 -n 9 --bus can0 --timeout 20s >"$work/busoff" 2>&1 &
  client=$!
  sleep 0.5
  printf 'sb000256\r' >/dev/can0.inject
  wait $client
  check "exit code of a bus-off" 3 $?
  contains "it says so" "bus-off" "$(cat "$work/busoff")"
  ip link set can0 down
  ip link set can0 up
  check "the interface is back, and so is the drive" 624 "$("$servoctl" read 0x6041 -n 1 --bus can0 --json | jq '.result[0].value')"
  controller() { "$servoctl" test comm -n 1 --bus can0 --count 20 --json | jq -r '.result[0].criteria[] | select(.id == "controller") | .verdict + " " + .figure'; }
  check "test comm finds a healthy controller" "passed error-active" "$(controller)"
  # A batch file that loses the bus says what it left energised, and disables it when the bus is back.
  printf '%s\n' 'on-error continue' 'use 1' 'enable -y' 'wait 3s' 'bus local:idle' 'nmt watch --for 2s' >"$work/lost.batch"
  SERVOCTL_DRIVES=$(dirname "$0")/../../eds "$servoctl" run "$work/lost.batch" --bus can0 -d gsd600 >"$work/lost" 2>&1 &
  client=$!
  sleep 1.5
  ip link set can0 down
  sleep 0.5
  ip link set can0 up
  wait $client
  check "exit code of a batch file that lost the bus" 3 $?
  contains "it warns at once" "error: NODE 1 MAY STILL BE ENERGISED: SWITCH OFF THE SUPPLY: can0 was lost" "$(cat "$work/lost")"
  contains "it disables the drive when the bus is back" "notice: node 1 was still energised; it has been stopped and disabled" "$(cat "$work/lost")"
  check "the drive has no power" false "$("$servoctl" status -n 1 --bus can0 --json | jq '.result[0].energised')"
  printf 'sp140000\r' >/dev/can0.inject
  sleep 0.3
  check "and one that is error-passive" "failed error-passive" "$(controller)"
  SERVOCTL_DRIVES=$(dirname "$0")/../../eds "$servoctl" report "$work/report.json" -n 1 --bus can0 -d gsd600 >/dev/null 2>&1
  check "a report tells bitrate and controller" '[1000000,"error-passive"]' "$(jq -c '[.buses[0].link.bitrate, .buses[0].link.controller]' "$work/report.json")"
fi

# 7. Objects of any size over the kernel's queue of ten frames, with frames of others in between.
jobs -p | xargs -r kill 2>/dev/null
wait 2>/dev/null
ip link set vcan0 txqueuelen 10
head -c 20000 /dev/urandom >"$work/blob"
SERVOCTL_DRIVES=$(dirname "$0")/../cli/data/drives "$servoctl" sim lab@3 >"$work/sim4.out" 2>&1 &
wait_for "$work/sim4.out" vcan0
cangen vcan0 -g 1 -I 083 -L 8 -n 3000 &
"$servoctl" write 1F50:1 --from "$work/blob" -n 3 >/dev/null 2>&1
check "a block write" 0 $?
"$servoctl" read 1F50:1 --to "$work/back" -n 3 >/dev/null 2>&1
check "a block read" 0 $?
check "no byte of it differs" "" "$(cmp "$work/blob" "$work/back" 2>&1)"

# 8. Ctrl-C ends a wait at once.
ip link set vcan1 up
"$servoctl" read 0x6041 -n 9 --bus vcan1 --timeout 20s >/dev/null 2>&1 &
client=$!
sleep 0.5
kill -INT $client
wait $client
check "exit code of Ctrl-C" 130 $?

# 9. Restores killed while they write are gone on with or undone.
"$(dirname "$0")/restore_kill_test.sh" "$servoctl" vcan1 4 7 >"$work/killed" 2>&1
check "killed restores" 0 $?
cat "$work/killed"

# 10. A monitor at the full load of 1 Mbit/s loses nothing: 20000 frames of 8 bytes, one every 115 µs.
awk 'BEGIN { for (i = 0; i < 20000; i++) printf "(%d.%06d) vcan0 %X#%016X\n", 1700000000 + int(i * 115 / 1000000), i * 115 % 1000000, 385 + i % 4, i }' >"$work/full.log"
"$servoctl" monitor -d gsd600 -o jsonl >"$work/full.jsonl" 2>&1 &
monitor=$!
sleep 1
canplayer -I "$work/full.log" vcan0=vcan0
for _ in $(seq 120); do  # A slow build of it may lag behind, but must not lose anything.
  [ "$(grep -c '"frame"' "$work/full.jsonl")" -ge 20000 ] && break
  sleep 0.5
done
kill -INT $monitor
wait $monitor
check "frames the monitor has counted" 20000 "$(tail -1 "$work/full.jsonl" | jq '.result.frames')"
check "frames it has shown, in their order" "$(awk '{ print $3 }' "$work/full.log" | md5sum)" "$(jq -r 'select(.frame) | .frame' "$work/full.jsonl" | md5sum)"

# 11. A recording is sent again as it was.
candump -L vcan0,180:7F0 >"$work/again" &  # Not what replay asks the drives before.
sleep 0.3
head -200 "$work/full.log" >"$work/part.log"
"$servoctl" replay "$work/part.log" -y >/dev/null
sleep 0.2
check "what replay has sent" "$(awk '{ print $3 }' "$work/part.log" | md5sum)" "$(awk '{ print $3 }' "$work/again" | md5sum)"

# 12. PDOs as over every other kind of CAN bus, also with CAN-IDs of 29 bits.
python3 "$(dirname "$0")/../cli/pdo_buses_test.py" "$servoctl" vcan1 >"$work/pdos" 2>&1
check "PDOs over SocketCAN" 0 $?
grep FAILED -A 12 "$work/pdos"

# 13. CAN FD frames are no silence.
(while sleep 0.05; do cansend vcan1 181##011223344; done) &
flood=$!
contains "a monitor counts CAN FD frames" "CAN FD frames came" "$("$servoctl" monitor --bus vcan1 --for 500ms --json)"
contains "the doctor finds them" '"fd-frames"' "$("$servoctl" doctor vcan1 --for 500ms --json)"
kill $flood
"$servoctl" sim gsd600@1 --bus vcan1 >"$work/sim13.out" 2>&1 &
wait_for "$work/sim13.out" vcan1
(while sleep 0.05; do cansend vcan1 181##011223344; done) &
contains "pdo watch says that they came" "CAN FD frames came" "$("$servoctl" pdo watch -n 1 -d gsd600 --bus vcan1 --for 1s 2>&1)"
kill $!

printf '%d checks, %d failed\n' "$checks" "$failures"
[ "$failures" -eq 0 ]
