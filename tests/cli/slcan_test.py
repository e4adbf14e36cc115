#!/usr/bin/env python3
"""The program on buses behind adapters of the LAWICEL protocol: a simulated drive behind one, commands behind another, and
adapters as bad as real ones.
usage: slcan_test.py SERVOCTL"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

from checks import check, finish
from serial_adapters import Adapter, Wire

servoctl = sys.argv[1]
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env["LANG"] = "C"


def run(bus, *words):
    return subprocess.run([servoctl, "-b", bus, *words], env=env, capture_output=True, text=True, timeout=60)


class World:
    """A drive behind one adapter, and another adapter that is as told."""

    def __init__(self, **options):
        self.wire = Wire()
        self.adapter = Adapter(self.wire, **options)
        self.far = Adapter(self.wire)
        self.bus = f"slcan:{self.adapter.path}@500k"
        self.drive = subprocess.Popen([servoctl, "sim", "gsd600@1", "-b", f"slcan:{self.far.path}@500k"], env=env,
                                      stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.drive.stdout.readline()  # `1 drive on …`

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.drive.terminate()
        self.drive.communicate()
        self.wire.close()


def answers(world, what):
    answer = run(world.bus, "read", "0x1000", "-n", "1", "--json")
    check(f"{what}: a drive answers\n{answer.stdout}{answer.stderr}", answer.returncode == 0 and "131474" in answer.stdout)
    return answer


def closes(adapter, what):
    for _ in range(100):
        if not adapter.is_open and adapter.heard[-1] == "C":
            return
        time.sleep(0.01)
    check(f"{what}: the adapter is closed at the end, {adapter.heard[-3:]}", False)


for name, options in {
        "a good adapter": {},
        "both line ends": {"end": "\r\n"},
        "lines in pieces": {"piece": 3},
        "time stamps": {"stamps": True},
        "firmware without acknowledges": {"silent": True, "version": "b158aa7 github.com/example"},
        "a late adapter": {"delay": 0.02},
        "an adapter without a version": {"refuses": "V"},
        "an adapter without flags": {"refuses": "F"}}.items():
    with World(**options) as world:
        answers(world, name)
        closes(world.adapter, name)

with World() as world:
    answer = run(world.bus, "scan", "--json")
    check(f"scan finds the drive\n{answer.stderr}", [n["node"] for n in json.loads(answer.stdout)["result"]] == [1])
    answer = run(world.bus, "jog", "60rpm", "--for", "200ms", "-n", "1", "-d", "gsd600", "--turn", "10000", "--yes")
    check(f"a jog goes through\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
    closes(world.adapter, "a jog")

    # The adapter is left open by a program that was killed.
    world.adapter.is_open, world.adapter.bitrate = True, 500
    for _ in range(200):
        world.adapter.say("t58184300100092010200")
    answers(world, "an adapter that was left open")

    # Ctrl-C and SIGTERM close it.
    for number in (signal.SIGINT, signal.SIGTERM):
        monitor = subprocess.Popen([servoctl, "-b", world.bus, "monitor"], env=env, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        for _ in range(200):
            if world.adapter.is_open:
                break
            time.sleep(0.02)
        answer = run(world.bus, "read", "0x1000", "-n", "1")
        check(f"a second program is told that the port is in use\n{answer.stderr}",
              answer.returncode == 3 and "is in use by another program" in answer.stderr)
        monitor.send_signal(number)
        monitor.wait(timeout=10)
        closes(world.adapter, f"signal {number}")

with World(loss=0.002, seed=7) as world:
    good = sum(run(world.bus, "read", "0x1000", "-n", "1").returncode == 0 for _ in range(20))
    check(f"bytes that are lost now and then cost little: {good} of 20", good >= 15)
    for _ in range(5):
        answer = run(world.bus, "write", "0x6083", "1234", "-n", "1", "-d", "gsd600")
        if answer.returncode == 0:
            check("what counts as written is written", "1234" in run(f"{world.bus}", "read", "0x6083", "-n", "1", "-d", "gsd600").stdout
                  or "1234" in run(world.bus, "read", "0x6083", "-n", "1", "-d", "gsd600").stdout)

# Unplugged in the middle of a motion, and plugged in again under the same name: the drive is stopped.
with World() as world, tempfile.TemporaryDirectory() as folder:
    name = os.path.join(folder, "adapter")
    os.symlink(world.adapter.path, name)
    jog = subprocess.Popen([servoctl, "-b", f"slcan:{name}@500k", "jog", "60rpm", "--for", "20s", "-n", "1", "-d", "gsd600",
                            "--turn", "10000", "--yes"], env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(300):
        if any(line.startswith("t6018") and "4060000F" in line for line in world.adapter.heard):
            break
        time.sleep(0.02)
    time.sleep(0.3)
    os.remove(name)
    world.adapter.unplug()
    world.wire.adapters.remove(world.adapter)
    time.sleep(1.0)
    world.adapter = Adapter(world.wire)
    os.symlink(world.adapter.path, name)
    out, err = jog.communicate(timeout=30)
    check(f"the loss is told and the drive stopped over the new port\n{out}{err}", "is gone" in err and "is back after" in err)
    check(f"the motion has failed\n{out}{err}", jog.returncode not in (0, 70))
    state = run(f"slcan:{world.adapter.path}@500k", "status", "-n", "1", "-d", "gsd600", "--json").stdout
    check(f"the drive is not energised\n{state}", json.loads(state)["result"][0]["energised"] is False)

# The adapter is gone when a batch file ends that has left the drive energised, and somebody presses Ctrl-C: it is waited for.
with World() as world, tempfile.TemporaryDirectory() as folder:
    name = os.path.join(folder, "adapter")
    os.symlink(world.adapter.path, name)
    with open(os.path.join(folder, "lines"), "w") as lines:
        lines.write("enable -n 1 --yes\nwait 20s\n")
    batch = subprocess.Popen([servoctl, "-b", f"slcan:{name}@500k", "-d", "gsd600", "run", lines.name], env=env,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(500):
        if any(line.startswith("t6018") and "4060000F" in line for line in world.adapter.heard):
            break
        time.sleep(0.02)
    time.sleep(0.5)
    os.remove(name)
    world.adapter.unplug()
    world.wire.adapters.remove(world.adapter)
    time.sleep(0.5)
    silent = Adapter(world.wire, silent=True, version="")  # Opening it takes its time, in which the signals come.
    os.symlink(silent.path, name)
    for _ in range(3):
        time.sleep(0.3)
        batch.send_signal(signal.SIGINT)
    time.sleep(0.3)
    os.remove(name)
    silent.unplug()
    world.wire.adapters.remove(silent)
    world.adapter = Adapter(world.wire)
    os.symlink(world.adapter.path, name)
    out, err = batch.communicate(timeout=40)
    state = run(f"slcan:{world.adapter.path}@500k", "status", "-n", "1", "-d", "gsd600", "--json").stdout
    check(f"a drive left energised is stopped though signals came\n{out}{err}{state}",
          json.loads(state)["result"][0]["energised"] is False and "disabled" in err)

for bus, code, words in (
        ("slcan:/dev/null@500k", 3, "/dev/null is no serial port"),
        (f"slcan:{__file__}@500k", 3, "is no serial port"),
        ("slcan:/dev/ttyACM0@83k", 2, "'83k' is no bitrate that such an adapter has"),
        ("slcan:/dev/ttyACM0", 2, "the bitrate of the bus is missing"),
        ("slcan:/dev/no-such-port@500k", 3, "is the adapter plugged in?"),
        ("slcan:", 2, "the bitrate of the bus is missing")):
    answer = run(bus, "scan")
    check(f"{bus}: {answer.returncode} {answer.stderr}", answer.returncode == code and words in answer.stderr)
finish()
