#!/usr/bin/env bash
# Times `decode` on recordings of a million frames: a bus at work (PDOs and SYNC, some SDO and heartbeats), and SDO alone;
# beside the readers of python-can, which take the frames out of the same files and do nothing with them.
# usage: decode.sh BUILD_DIR
set -euo pipefail
build=$1
data=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 - "$work" <<'PYTHON'
import os, struct, sys

FRAMES = 1_000_000


def at_work(i):
    """Four drives: a SYNC, their TPDOs and RPDOs; every hundredth frame a heartbeat, an SDO request or its answer."""
    if i % 100 == 99:
        return ("701#05", "601#4041600000000000", "581#4B41600037020000")[i // 100 % 3]
    k, node = i % 9, i % 4 + 1
    if k == 0:
        return "080#"
    if k < 5:
        return "%03X#3702" % (0x180 + node)
    return "%03X#0F00%s" % (0x500 + node, struct.pack("<i", i * 7).hex().upper())


def sdo(i):
    return ("601#4041600000000000", "581#4B41600037020000")[i % 2]


for name, frame in (("work", at_work), ("sdo", sdo)):
    with open(os.path.join(sys.argv[1], name + ".log"), "w") as log:
        for i in range(FRAMES):
            log.write("(%d.%06d) can0 %s\n" % (1700000000 + i // 10000, i % 10000 * 100, frame(i)))
PYTHON
command -v log2asc >/dev/null && log2asc -I "$work/work.log" -O "$work/work.asc" can0

# CPU time, for a machine may have other work; decode has one thread.
export SERVOCTL_DRIVES=$data/eds TIMEFORMAT='%U %S'
printf 'a million frames, best of 5 runs              CPU s   million frames/s\n'
show() { awk -v name="$1" -v t="$2" 'BEGIN { printf "%-42s %8.2f %10.2f\n", name, t, 1 / t }'; }
for run in "work.log text" "work.log jsonl" "work.log json" "sdo.log text" "sdo.log jsonl" "work.asc text"; do
  read -r file form <<<"$run"
  [ -f "$work/$file" ] || continue
  best=$(for _ in 1 2 3 4 5; do
    { time "$build/servoctl" decode "$work/$file" -d gsd600 -o "$form" >"$work/out"; } 2>&1
  done | awk '{ t = $1 + $2; if (NR == 1 || t < best) best = t } END { print best }')
  show "decode $file, -o $form" "$best"
done

python=$("$(dirname "$0")/python_can.sh") || exit 0
for run in "work.log CanutilsLogReader" "work.asc ASCReader"; do
  read -r file reader <<<"$run"
  [ -f "$work/$file" ] || continue
  show "python-can $reader, one run" "$("$python" - "$work/$file" "$reader" <<'PYTHON'
import sys, time
import can

begin = time.process_time()
frames = sum(1 for _ in getattr(can, sys.argv[2])(sys.argv[1]))
assert frames == 1_000_000, frames
print(time.process_time() - begin)
PYTHON
)"
done
