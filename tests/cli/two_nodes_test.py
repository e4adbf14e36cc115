#!/usr/bin/env python3
"""Two drives of one number, each a process: they are noticed, named, and nothing is written to them.
usage: two_nodes_test.py SERVOCTL"""
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


def sims(bus, *specs):
    out = [subprocess.Popen([servoctl, "sim", spec, "-b", bus], env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
           for spec in specs]
    for _ in range(200):
        if run(bus, "read", "0x1000", "-n", "1", "--timeout", "50ms").returncode == 0:
            break
        time.sleep(0.05)
    time.sleep(0.3)
    return out


for number, (first, second) in enumerate([("gsd600@1", "gsd600@1"), ("gsd600@1", "dm@1"), ("dm@1", "dm@1?delay=5ms"),
                                          ("da200@1", "da200@1"), ("sv2@1", "ts@1")]):
    bus = f"local:two-nodes-{os.getpid()}-{number}"
    family = first.split("@")[0]
    what = f"{first} and {second}: "
    drives = sims(bus, first, second)
    try:
        for words in (["scan"], ["info", "-n", "1"]):
            answer = run(bus, *words)
            check(what + f"{words[0]} names them\n{answer.stdout}{answer.stderr}", "node 1: two nodes answer under this node-ID" in answer.stderr)
            notices = json.loads(run(bus, *words, "--json").stdout)["notices"]
            check(what + f"{words[0]} --json names them", any("two nodes answer" in notice for notice in notices))
        if first.split("@")[0] != second.split("@")[0]:
            answer = run(bus, "read", "0x1000", "-n", "1")
            check(what + f"read names them\n{answer.stderr}", "two nodes answer" in answer.stderr)
            for option in ([], ["--json"]):
                answer = run(bus, *option, lines="read 0x1000 -n 1\n")
                check(what + f"the last line of a pipe {option} names them\n{answer.stderr}", "two nodes answer" in answer.stderr + answer.stdout)
        for words in (["jog", "60rpm", "--for", "100ms", "--turn", "10000", "--yes"], ["write", "0x6060", "1"], ["store", "--yes"]):
            answer = run(bus, *words, "-n", "1", "-d", family)
            check(what + f"{words[0]} is refused\n{answer.stderr}", answer.returncode == 8)
        for words in (["write", "0x6060", "1", "--type", "i8"], ["write", "0x1017", "0", "--type", "u16"]):
            answer = run(bus, *words, "-n", "1")
            check(what + f"{' '.join(words)} without a family is refused\n{answer.stderr}",
                  answer.returncode == 8 and "two nodes answer" in answer.stderr)
        answer = run(bus, "disable", "-n", "1", "-d", family)
        check(what + f"disable is not\n{answer.stderr}", answer.returncode != 8)
    finally:
        for drive in drives:
            drive.terminate()
            drive.wait()
finish()
