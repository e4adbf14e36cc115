#!/usr/bin/env python3
"""Two drives of one number, each a process: they are noticed, named, and nothing is written to them.
And what a monitor in another process says of the heartbeat of a motion that is over.
usage: two_nodes_test.py SERVOCTL"""
import contextlib
import json
import os
import subprocess
import sys
import time

from checks import check, finish

servoctl = sys.argv[1]
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env["LANG"] = "C"


def run(bus, *words, lines=None):
    source = {"input": lines} if lines else {"stdin": subprocess.DEVNULL}
    return subprocess.run([servoctl, "-b", bus, *words], env=env, capture_output=True, text=True, **source)


@contextlib.contextmanager
def sims(bus, *specs):
    drives = [subprocess.Popen([servoctl, "sim", spec, "-b", bus], env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
              for spec in specs]
    try:
        for _ in range(200):
            if run(bus, "read", "0x1000", "-n", "1", "--timeout", "50ms").returncode == 0:
                break
            time.sleep(0.05)
        time.sleep(0.3)
        yield
    finally:
        for drive in drives:
            drive.terminate()
            drive.wait()


def named(bus, *words, **more):
    """What a read says of two nodes. It waits for some milliseconds only; on a busy machine the second answer may come later."""
    for _ in range(5):
        answer = run(bus, *words, **more)
        told = answer.stderr + answer.stdout
        if "two nodes answer" in told:
            break
    return told


for number, (first, second) in enumerate([("gsd600@1", "gsd600@1"), ("gsd600@1", "dm@1"), ("dm@1", "dm@1?delay=5ms"),
                                          ("da200@1?panel=P0.03=7", "da200@1?panel=P0.03=7"), ("sv2@1", "ts@1?panel=Fn_00=20")]):
    bus = f"local:two-nodes-{os.getpid()}-{number}"
    family = first.split("@")[0]
    what = f"{first} and {second}: "
    with sims(bus, first, second):
        for words in (["scan"], ["info", "-n", "1"]):
            answer = run(bus, *words)
            check(what + f"{words[0]} names them\n{answer.stdout}{answer.stderr}", "node 1: two nodes answer under this node-ID" in answer.stderr)
            notices = json.loads(run(bus, *words, "--json").stdout)["notices"]
            check(what + f"{words[0]} --json names them", any("two nodes answer" in notice for notice in notices))
        if first.split("@")[0] != second.split("@")[0]:
            told = named(bus, "read", "0x1000", "-n", "1")
            check(what + f"read names them\n{told}", "two nodes answer" in told)
            for option in ([], ["--json"]):
                told = named(bus, *option, lines="read 0x1000 -n 1\n")
                check(what + f"the last line of a pipe {option} names them\n{told}", "two nodes answer" in told)
        for words in (["jog", "60rpm", "--for", "100ms", "--turn", "10000", "--yes"], ["write", "0x6060", "1"], ["store", "--yes"]):
            answer = run(bus, *words, "-n", "1", "-d", family)
            check(what + f"{words[0]} is refused\n{answer.stderr}", answer.returncode == 8)
        for words in (["write", "0x6060", "1", "--type", "i8"], ["write", "0x1017", "0", "--type", "u16"]):
            answer = run(bus, *words, "-n", "1")
            check(what + f"{' '.join(words)} without a family is refused\n{answer.stderr}",
                  answer.returncode == 8 and "two nodes answer" in answer.stderr)
        for words in (["nmt", "start"], ["nmt", "reset", "--yes"], ["nmt", "reset-comm", "--yes"]):
            answer = run(bus, *words, "-n", "1")
            check(what + f"{' '.join(words)} is refused\n{answer.stderr}", answer.returncode == 8 and "two nodes answer" in answer.stderr)
        answer = run(bus, "nmt", "preop", "-n", "1")
        check(what + f"nmt preop is not\n{answer.stderr}", answer.returncode != 8)
        run(bus, "nmt", "stop", "-n", "1")
        for words in (["nmt", "reset", "--yes"], ["nmt", "reset-comm", "--yes"]):
            answer = run(bus, *words, "-n", "1")
            check(what + f"{' '.join(words)} is refused while they are stopped\n{answer.stdout}{answer.stderr}", answer.returncode == 8)
        for option in ([], ["--wait"]):
            run(bus, "nmt", "stop", "-n", "1")
            answer = run(bus, "nmt", "start", *option, "-n", "1")
            check(what + f"nmt start {option} of two stopped ones is an error\n{answer.stdout}{answer.stderr}",
                  answer.returncode == 8 and "two nodes answer" in answer.stderr)
        run(bus, "nmt", "preop", "-n", "1")
        answer = run(bus, "backup", "two-nodes.json", "-n", "1", "-d", family)
        check(what + f"no file is made of both\n{answer.stderr}",
              answer.returncode == 8 and "two nodes answer" in answer.stderr and not os.path.exists("two-nodes.json"))
        answer = run(bus, "disable", "-n", "1", "-d", family)
        check(what + f"disable is not\n{answer.stderr}", answer.returncode != 8)

# One that answers long behind the other: a motor gets no power, and nothing is stored.
bus = f"local:late-node-{os.getpid()}"
with sims(bus, "gsd600@1", "gsd600@1?delay=200ms"):
    for words in (["enable", "--yes"], ["jog", "60rpm", "--for", "100ms", "--turn", "131072", "--yes"], ["store", "--yes"],
                  ["address", "5", "--yes"]):
        answer = run(bus, *words, "-n", "1", "-d", "gsd600")
        check(f"a late second node: {words[0]} is refused\n{answer.stdout}{answer.stderr}",
              answer.returncode == 8 and "two nodes answer" in answer.stderr)
    with open("two-nodes.toml", "w") as file:
        file.write(f'[bus.main]\nurl = "{bus}"\n[axis.one]\nbus = "main"\nnode = 1\nfamily = "gsd600"\n[axis.one.parameters]\nPn0214 = "47Hz"\n')
    answer = subprocess.run([servoctl, "--cabinet", "two-nodes.toml", "cabinet", "apply", "--yes"], env=env, capture_output=True, text=True,
                            stdin=subprocess.DEVNULL)
    check(f"a late second node: cabinet apply is refused\n{answer.stdout}{answer.stderr}",
          answer.returncode == 8 and "one: two nodes answer" in answer.stderr and "not changed" in answer.stdout)
    os.remove("two-nodes.toml")
    # What is noticed behind a plain write is told as what it is.
    answer = run(bus, "-n", "1", "-d", "gsd600", "-", lines="write 0x6083 1000\n" + "read 0x1000\nwait 250ms\n" * 5)
    check(f"a late second node: what was written is told behind a write\n{answer.stderr}",
          answer.stderr.count("what was written may have gone to both drives") == 1)

# Two that say the same of themselves, serial number and all: that answers come twice is what shows them.
bus = f"local:same-node-{os.getpid()}"
with sims(bus, "gsd600@1?lss", "gsd600@1?lss"):
    check("both have one serial number", "0x00000001" in run(bus, "info", "-n", "1").stdout)
    for words in (["scan"], ["info", "-n", "1"], ["read", "0x1018:1", "0x1018:2", "0x1018:3", "0x1018:4", "-n", "1"]):
        answer = run(bus, *words)
        check(f"two of one identity: {words[0]} names them\n{answer.stderr}", "two nodes answer under this node-ID" in answer.stderr)
    for words in (["write", "0x6083", "1000"], ["param", "set", "Pn0214=45Hz"], ["enable", "--yes"], ["backup", "two-nodes.json"]):
        answer = run(bus, *words, "-n", "1", "-d", "gsd600")
        check(f"two of one identity: {words[0]} is refused\n{answer.stderr}", answer.returncode == 8 and not os.path.exists("two-nodes.json"))

# One of two is stopped, and answers no SDO: both are heard once they have started.
bus = f"local:half-stopped-{os.getpid()}"
with sims(bus, "gsd600@1"):
    run(bus, "nmt", "stop", "-n", "1")
    with sims(bus, "dm@1"):
        answer = run(bus, "nmt", "start", "-n", "1")
        check(f"one of two is stopped: nmt start is an error\n{answer.stdout}{answer.stderr}",
              answer.returncode == 8 and "two nodes answer" in answer.stderr)

# A transfer that two drives break: they are named as the cause.
bus = f"local:broken-node-{os.getpid()}"
with sims(bus, "gsd600@1", "dm@1"):
    answer = run(bus, "param", "get", "*", "-n", "1", "-d", "gsd600")
    check(f"what breaks transfers is named once\n{answer.stderr[:2000]}",
          answer.returncode != 0 and answer.stderr.count("which is the likely cause: disconnect one") == 1)

# One that comes while a motor turns: the motion ends, and whose state was read is not taken for granted.
bus = f"local:coming-node-{os.getpid()}"
with sims(bus, "gsd600@1"):
    jog = subprocess.Popen([servoctl, "-b", bus, "jog", "60rpm", "--for", "8s", "--turn", "131072", "--yes", "-n", "1", "-d", "gsd600"],
                           env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(2)
    begun = time.monotonic()
    with sims(bus, "gsd600@1"):
        told = jog.communicate(timeout=60)[1]
    check(f"a second node ends the motion\n{told}", jog.returncode != 0 and time.monotonic() - begun < 6)
    check(f"it is named\n{told}", "two nodes answer under this node-ID" in told)
    check(f"which of two is without power is not known\n{told}", "THE FINAL STATE COULD NOT BE VERIFIED" in told)

# LSS takes one of two by its identity, never by their number; a reset by number reaches both, whoever has power.
bus = f"local:lss-node-{os.getpid()}"
identity = ["--vendor", "0x445653", "--product", "1", "--revision", "1", "--serial", "1"]
with sims(bus, "gsd600@1?delay=2ms"):
    answer = run(bus, "enable", "-n", "1", "-d", "gsd600", "--yes")
    check(f"one of two: it is energised\n{answer.stderr}", answer.returncode == 0)
    with sims(bus, "sv2@1?lss"):
        for words in (["inquire"], ["set-node", "5", "--yes"], ["set-bitrate", "500k", "--yes"], ["store", "--yes"]):
            answer = run(bus, "lss", *words, "-n", "1")
            # Their answers may break the question who is there: that they are two is told then as well.
            check(f"one of two: lss {words[0]} by their number is refused\n{answer.stderr}", "two nodes answer" in answer.stderr and
                  (answer.returncode == 8 and "--serial" in answer.stderr or answer.returncode not in (0, 8)))
        def told(*words):
            """Two that answer at once may break the question who is there, which is told: whoever reads it asks once more."""
            for _ in range(6):
                answer = run(bus, "lss", *words, *identity)
                if "which is the likely cause" not in answer.stderr:
                    break
            return answer
        for words in (["set-node", "5"], ["set-bitrate", "500k", "--activate", "1s"]):
            answer = told(*words, "--yes")
            check(f"one of two: lss {words[0]} is refused while the other one is energised\n{answer.stderr}",
                  answer.returncode == 8 and "two drives have this node-ID, and one is energised" in answer.stderr)
        run(bus, "disable", "-n", "1", "-d", "gsd600")
        answer = told("set-node", "5")
        check(f"one of two: the question names the other one\n{answer.stderr}", "Another drive has this node-ID too" in answer.stderr)
        answer = told("set-node", "5", "--yes")
        check(f"one of two: without power it is the way out\n{answer.stdout}{answer.stderr}", answer.returncode == 0 and "moved" in answer.stdout)
        answer = run(bus, "scan")
        check(f"one of two: each has its own number now\n{answer.stdout}{answer.stderr}", answer.returncode == 0 and "two nodes" not in answer.stderr)
bus = f"local:monitored-{os.getpid()}"
with sims(bus, "gsd600@1"):
    monitor = subprocess.Popen([servoctl, "-b", bus, "monitor", "--for", "8s"], env=env, stdout=subprocess.PIPE, text=True)
    time.sleep(0.5)
    jog = run(bus, "jog", "60rpm", "--for", "500ms", "-n", "1", "-d", "gsd600", "--turn", "131072", "--yes")
    seen = monitor.communicate(timeout=30)[0]
    check(f"servoctl was a master with a heartbeat: {jog.stderr}", jog.returncode in (0, 1) and " 127 " in seen)
    check(f"its regular end is no alarm\n{seen[-2000:]}", "ALARM" not in seen and "heartbeats lost     0" in seen)

finish()
