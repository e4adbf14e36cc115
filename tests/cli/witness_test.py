#!/usr/bin/env python3
"""What the data were checked against is said, and what a drive showed is written down: nothing of the customer's, and a drive that takes a
wrong access for a fault is asked for nothing that its data do not list.
usage: witness_test.py SERVOCTL"""
import json
import os
import re
import subprocess
import sys
import tempfile

from checks import check, finish

servoctl = os.path.abspath(sys.argv[1])
eds = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../eds")
folder = tempfile.mkdtemp(prefix="witness")
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")} | {"SERVOCTL_DRIVES": eds, "XDG_STATE_HOME": folder}
FAMILIES = {"gsd600": "vmmore", "da200": "invt", "dm": "dm", "ts": "syntron", "sv2": "sinsegye"}


def run(*words, env=env):
    return subprocess.run([servoctl, *words], cwd=folder, env=env, capture_output=True, text=True, timeout=60)


def listed(family):
    """Objects of the family's data sheet, as `index sub`."""
    out = set()
    with open(os.path.join(eds, FAMILIES[family], family + ".eds"), encoding="utf-8", errors="replace") as file:
        for index, sub in re.findall(r"^\[([0-9A-Fa-f]{4})(?:sub([0-9A-Fa-f]+))?\]", file.read(), re.M):
            out.add((int(index, 16), int(sub or "0", 16)))
    return out


for family in FAMILIES:
    answer = run("drives", family, "--json")
    provenance = json.loads(answer.stdout)["result"]["provenance"]
    check(f"{family} says its manual", bool(provenance["manual"]) and provenance["simulator"])
    check(f"{family}: nobody has tried it yet", provenance["drives"] == [])
    check(f"{family} says so", "no real drive yet" in run("drives", family).stdout)
    words = ("witness", family + ".json", "-n", "1", "-d", family, "-b", f"sim:{family}@1")
    # With a folder for state the line asks who the drive is after its end, to remember -d: that is not what is tried here.
    answer = run(*words, "--trace", family + ".log", env={k: v for k, v in env.items() if k not in ("XDG_STATE_HOME", "HOME")})
    check(f"{family}: exit code {answer.returncode}\n{answer.stderr}", answer.returncode == 0)
    with open(os.path.join(folder, family + ".json"), encoding="utf-8") as file:
        seen = json.load(file)
    check(f"{family}: answers", len(seen["answers"]) > 50 and seen["family"] == family and seen["ended"] is None)
    keys = {key for each in seen["answers"] for key in each}
    check(f"{family}: no value of an object", keys == {"object", "size", "abort"} and "serial" not in seen["identity"])
    check(f"{family}: no node-ID and no bus", not {"node", "bus", "axis"} & set(seen))
    with open(os.path.join(folder, family + ".log"), encoding="utf-8") as file:
        frames = re.findall(r" 601#([0-9A-F]{2})([0-9A-F]{2})([0-9A-F]{2})([0-9A-F]{2})", file.read())
    check(f"{family}: asked", len(frames) > 50)
    check(f"{family}: nothing is written", all(int(command, 16) >> 5 in (2, 3, 4) for command, *_ in frames))
    if family == "da200":
        asked = {(int(high + low, 16), int(sub, 16)) for command, low, high, sub in frames if int(command, 16) >> 5 == 2}
        check(f"nothing is asked that would be an alarm: {asked - listed(family)}", asked <= listed(family))
    check(f"{family}: a second one asks first", run(*words).returncode == 8)

# A user's own family says nothing, and does not take what its parent says.
os.makedirs(os.path.join(folder, "own"))
with open(os.path.join(folder, "own/mine.toml"), "w", encoding="utf-8") as file:
    file.write('format = 1\nfamily = "mine"\nparent = "gsd600"\n')
env["SERVOCTL_DRIVES"] = os.path.join(folder, "own") + ":" + eds
check("a child does not take it", re.search(r"checked against +not stated", run("drives", "mine").stdout) is not None)

# Before a motion it is said, but not of a drive that was made from the same data in this process.
bus = f"local:witness-{os.getpid()}"
sim = subprocess.Popen([servoctl, "sim", "gsd600@1", "--bus", bus], env=env, stdout=subprocess.DEVNULL)
try:
    for _ in range(100):
        if run("read", "0x1000", "-n", "1", "-b", bus).returncode == 0:
            break
    jog = ("jog", "60rpm", "--for", "100ms", "-n", "1", "-d", "gsd600", "--turn", "131072", "--dry-run", "-b")
    said = "the drive data were checked against: GSD600 CANopen manual V1.0"
    answer = run(*jog, bus)
    check(f"before a motion\n{answer.stdout}{answer.stderr}", said in answer.stdout + answer.stderr)
    answer = run(*jog, "sim:gsd600@1")
    check("not of a simulated drive", said not in answer.stdout + answer.stderr)
finally:
    sim.terminate()
    sim.wait()
finish()
