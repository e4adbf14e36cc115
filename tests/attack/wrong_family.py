#!/usr/bin/env python3
"""Random commands with a family that the drive is not: none of them may write to it, except the ways out.
usage: wrong_family.py SERVOCTL COUNT [SEED]

What left is read from the trace, and a second look is taken at the drive: a simulated one whose memory is a file, which
has to hold the same before and after."""
import os
import random
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from checks import obeying

servoctl, count = os.path.abspath(sys.argv[1]), int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else random.randrange(1 << 30)
rng = random.Random(seed)
families = ["gsd600", "dm", "da200", "sv2", "ts"]
# Of the ts no identity is known, and 1000h of the gsd600 is that of many drives.
open_pairs = {("ts", "gsd600")}
lines = {
    "write": ["write 0x6060 {n}", "write 0x6040 {n}", "write 0x2000:{n} 1", "write 0x1017 {n}00"],
    "param set": ["param set Pn0214 {n}", "param set Fn_33 {n}", "param set P0.{n} 1", "param set Pn0214={n} --keep"],
    "store": ["store", "store vendor"], "defaults": ["defaults", "defaults application"],
    "backup": ["backup b.json", "backup b.dcf --format dcf"], "restore": ["restore own.json", "restore own.json --force"],
    "clone": ["clone --from 1 --to 2", "clone --from 2 --to 1 --force"], "diff": ["diff node:1 factory", "diff node:1 node:2"],
    "verify": ["verify factory", "verify own.json"], "report": ["report r.html", "report r.json"], "info": ["info"],
    "enable": ["enable"], "jog": ["jog {n}0rpm --for 100ms --turn 10000", "jog -{n}0rpm --turns 1 --turn 131072"],
    "move": ["move {n}rev --relative --turn 10000", "move 90deg"], "home": ["home {n}", "home 35 --turn 10000"],
    "torque": ["torque {n}% --for 100ms", "torque 0.1Nm --limit 60rpm --for 60ms"], "mode": ["mode {n}"],
    "fault reset": ["fault reset"], "fault clear-history": ["fault clear-history"],
    "pdo map": ["pdo map TPDO{n} 0x6041", "pdo map RPDO1 0x6040 0x60FF"], "pdo enable": ["pdo enable TPDO1"],
    "pdo disable": ["pdo disable TPDO1"], "pdo clear": ["pdo clear RPDO1"], "pdo preset": ["pdo preset pp", "pdo preset csp"],
    "pdo apply": ["pdo apply pdos.toml"], "pdo send": ["pdo send RPDO1 {n}"], "scope": ["scope 0x6041 --map --for 20ms"],
    "test jog": ["test jog 60rpm"], "test home": ["test home"], "test all": ["test all 60rpm"],
    "read": ["read 0x6041 0x1000"], "status": ["status"], "fault show": ["fault show"], "pdo show": ["pdo show"],
    "param get": ["param get Pn0214", "param get P0.03"], "watch": ["watch 0x6041 --for 30ms"],
    "disable": ["disable"], "quick-stop": ["quick-stop"], "nmt preop": ["nmt preop"], "nmt stop": ["nmt stop"],
}
ways_out = {"disable", "quick-stop", "nmt preop", "nmt stop"}
reads = {"read", "status", "fault show", "pdo show", "param get", "watch"}
failures = []


def written(trace):
    """Frames of a trace that change something: downloads, NMT, RPDOs."""
    out = []
    for line in trace.splitlines():
        frame = re.search(r" ([0-9A-F]{3})#([0-9A-F]*)", line)
        if not frame:
            continue
        number, data = int(frame[1], 16), bytes.fromhex(frame[2])
        if 0x600 < number < 0x680 and data[0] >> 5 not in (2, 3, 5) and data[0] != 0x80:
            out.append(line)
        if number == 0 or (0x200 <= number < 0x580 and not number & 0x80):
            out.append(line)
    return out


def attack(work):
    drive, named = rng.choice([(d, f) for d in families for f in families if d != f and (f, d) not in open_pairs])
    command = rng.choice(sorted(lines))
    line = rng.choice(lines[command]).format(n=rng.randint(1, 9))
    trace, memory = os.path.join(work, "trace"), os.path.join(work, "memory-" + drive)
    how = rng.choice(["option", "environment", "prompt", "batch"])
    words = ["-b", f"sim:{drive}@1,{drive}@2?state={memory}" + obeying(drive).replace("?", "&"), "--trace", trace]
    if rng.random() < 0.2:
        line += " --dry-run"
    elif rng.random() < 0.9:
        line += " --yes"
    env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
    said = {"env": env, "cwd": work, "capture_output": True, "text": True, "timeout": 60}
    before = open(memory).read() if os.path.exists(memory) else ""
    where = [] if command in ("clone", "diff") else ["-n", "1"]
    if how == "option":
        run = subprocess.run([servoctl, *words, *where, "-d", named, *line.split()], **said)
    elif how == "environment":
        env.update(SERVOCTL_DRIVE=named, SERVOCTL_NODE="1")
        run = subprocess.run([servoctl, *words, *line.split()], **said)
    elif how == "prompt":
        run = subprocess.run([servoctl, *words, *where], input=f"drive {named}\n{line}\n", **said)
    else:
        with open(os.path.join(work, "batch"), "w") as file:
            file.write(f"drive {named}\n{line}\n")
        run = subprocess.run([servoctl, *words, *where, "run", "batch", "--yes"], **said)
    after = open(memory).read() if os.path.exists(memory) else ""
    frames = written(open(trace).read()) if os.path.exists(trace) else []
    wrong = []
    if command in ways_out and run.returncode == 8:
        wrong.append("a way out was refused")
    if command not in ways_out and (frames or (before and before != after)):
        wrong.append("something was written: " + " ".join(frames[:3]))
    # 2: the line makes no sense for the family that was named, and ends before a drive is asked.
    if command not in ways_out and command not in reads and run.returncode not in (2, 8):
        wrong.append("it was not refused")
    if "Traceback" in run.stderr or run.returncode < 0:
        wrong.append(f"exit {run.returncode}")
    if wrong:
        failures.append(f"-d {named} on {drive} ({how}): {line}: {'; '.join(wrong)}; exit {run.returncode}: {run.stderr.strip()[-300:]}")
    if os.path.exists(trace):
        os.remove(trace)


with tempfile.TemporaryDirectory() as work:
    with open(os.path.join(work, "pdos.toml"), "w") as file:
        file.write('format = 1\n[[pdo]]\npdo = "TPDO1"\nvalid = false\n')
    for family in families:
        subprocess.run([servoctl, "-b", f"sim:{family}@1", "-n", "1", "-d", family, "backup", "own.json"], cwd=work, capture_output=True)
    for _ in range(count):
        attack(work)
for failure in failures:
    print(f"seed {seed}: {failure}")
print(f"wrong_family: {count} attacks, {len(failures)} failures")
sys.exit(1 if failures else 0)
