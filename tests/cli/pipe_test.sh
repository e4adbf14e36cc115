#!/usr/bin/env bash
# Command lines from a pipe, and the streams: data on stdout, the rest on stderr.
# usage: pipe_test.sh SERVOCTL
set -u
servoctl=$1
export SERVOCTL_BUS=sim:gsd600@1 LANG=C
unset SERVOCTL_NODE SERVOCTL_DRIVE
failures=0
check() {
  if [ "$2" != "$3" ]; then
    failures=$((failures + 1))
    printf 'FAILED %s\n  expected: %s\n  actual:   %s\n' "$1" "$2" "$3"
  fi
}

out=$(printf 'use 1\ndrive gsd600\n# a comment\n\nparam set Pn0214 450\nparam get Pn0214\nexit\nnever run\n' | "$servoctl" --json | jq -c '[.command, .result[0].raw]')
check "lines share one bus and what use and drive set" $'["param set",450]\n["param get",450]' "$out"

out=$(printf 'read 0x6041 -n 1\nraed 0x6041\nread 0x6061 -n 1\n' | "$servoctl" 2>/dev/null | wc -l)
check "the first line that fails ends the run" 2 "$out"
printf 'read 0x6041 -n 1\nraed 0x6041\n' | "$servoctl" >/dev/null 2>&1
check "its exit code is that of the run" 2 $?

check "errors are on stderr" "" "$("$servoctl" read 0x6041 -n 9 --timeout 10ms 2>/dev/null)"
check "with --json they are on stdout" 4 "$("$servoctl" read 0x6041 -n 9 --timeout 10ms --json 2>/dev/null | jq .error.exit)"
check "nothing is on stderr then" "" "$("$servoctl" read 0x6041 -n 9 --timeout 10ms --json 2>&1 >/dev/null)"
check "a usage error is JSON too" 2 "$("$servoctl" raed --json | jq .error.exit)"
# SIGPIPE ends it, or where that is ignored the exit code is that of the command.
out=$({ { sleep 0.2; "$servoctl" objects -d gsd600; echo "$?" >&3; } | true; } 3>&1 2>&1 | sed 's/^141$/0/')
check "a closed pipe is met in silence" 0 "$out"
"$servoctl" objects -d gsd600 >/dev/full 2>/dev/null
check "output that could not be written is an error" 7 $?
check "the environment names bus, node and drive" 600 "$(SERVOCTL_NODE=1 SERVOCTL_DRIVE=gsd600 "$servoctl" param get Pn214 --json | jq '.result[0].raw')"
check "--version" "servoctl" "$("$servoctl" --version | cut -d' ' -f1)"
check "one document a command" 1 "$("$servoctl" scan --json | wc -l)"

# Batch files, from standard input and from a file.
batch=$(mktemp)
# shellcheck disable=SC2016  # The program fills the variable in, not the shell.
printf 'for N in 1\n  read 0x6041 -n ${N}\nend\nexpect .value == 624\n' >"$batch"
check "- is a batch file on standard input" 2 "$("$servoctl" - --json <"$batch" | jq .result.summary.done)"
check "with options before it" 2 "$("$servoctl" -o json - --var X=1 <"$batch" | jq .result.summary.done)"
check "a file may be run from a pipe" 2 "$(echo "run $batch" | "$servoctl" --json | jq .result.summary.done)"
printf 'on-error continue\nread 0x6041 -n 1\nwait 1min\nread 0x6061 -n 1\n' >"$batch"
"$servoctl" run "$batch" >"$batch.out" 2>&1 &
run=$!
for _ in $(seq 100); do grep -q 0x6041 "$batch.out" && break; sleep 0.05; done
kill -INT $run
wait $run
check "Ctrl-C ends a batch file with 130" 130 $?
check "no line is run after it" 0 "$(grep -c 0x6061 "$batch.out")"
rm -f "$batch" "$batch.out"

# A replay that is ended in the middle leaves no drive energised.
log=$(mktemp)
printf '%s\n' '(0.0) can0 601#2B40600006000000' '(0.1) can0 601#2B40600007000000' '(0.2) can0 601#2B4060000F000000' \
  '(60.0) can0 080#' >"$log"
for signal in INT TERM; do
  rm -f "$log.trace"
  "$servoctl" replay "$log" --yes --trace "$log.trace" >/dev/null 2>"$log.errors" &
  replay=$!
  for _ in $(seq 100); do grep -q '601#2B4060000F' "$log.trace" 2>/dev/null && break; sleep 0.05; done
  kill -$signal $replay
  wait $replay
  check "SIG$signal ends a replay with 130" 130 $?
  check "the drive is stopped and disabled after SIG$signal" 1 "$(grep -c 'stopped and disabled' "$log.errors")"
done
rm -f "$log" "$log.trace" "$log.errors"

# Objects of any size go through files.
lab=$(cd "$(dirname "$0")" && pwd)/data/drives
work=$(mktemp -d)
head -c 100000 /dev/urandom >"$work/blob"
for transfer in auto segmented block; do
  rm -f "$work/back"
  printf '%s\n' "write 1F50:1 --from $work/blob --transfer $transfer" "read 1F50:1 --to $work/back --transfer $transfer" |
    SERVOCTL_DRIVES=$lab "$servoctl" -b sim:lab@3 -n 3 -d lab >/dev/null 2>"$work/errors"
  check "write and read 100 kB, $transfer" 0 $?
  check "no byte of it differs" "" "$(cmp "$work/blob" "$work/back" 2>&1)"
done
check "no progress where nobody looks" "" "$(cat "$work/errors")"
rm -rf "$work"

# Two processes on a virtual bus of this machine.
name="pipetest$$"
served=$(mktemp)
"$servoctl" sim gsd600@4 --bus "local:$name" >"$served" 2>&1 &
sim=$!
for _ in $(seq 100); do grep -q local "$served" && break; sleep 0.05; done
check "a drive of another process on local:" 4 "$("$servoctl" scan --bus "local:$name" --json | jq '.result[0].node')"
check "read over local:" 624 "$("$servoctl" read 0x6041 -n 4 --bus "local:$name" --json | jq '.result[0].value')"
kill -INT $sim
wait $sim
check "Ctrl-C ends the simulated drive in order" 0 $?
rm -f "$served"
printf '%d failed\n' "$failures"
[ "$failures" -eq 0 ]
