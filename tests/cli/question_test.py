#!/usr/bin/env python3
"""While somebody thinks about a question the bus is heard: nobody's heartbeat counts as lost, no other process waits for us; and
what was typed before the question is no answer to it. usage: question_test.py SERVOCTL"""
import os
import subprocess
import sys
import time

from checks import asked, check, finish

servoctl = sys.argv[1]
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env.update(LANG="C", SERVOCTL_BUS=f"local:question-{os.getpid()}", SERVOCTL_DRIVE="gsd600", XDG_STATE_HOME="/nonexistent")
sim = subprocess.Popen([servoctl, "sim", "gsd600@1,gsd600@2"], env=env, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def run(*words):
    return subprocess.run([servoctl, *words], env=env, capture_output=True, text=True)


def ask(words, typed_before, answer, wait):
    """The output of a line that asks, and its exit code."""
    return asked([servoctl, *words], env, answer, lambda: time.sleep(wait), typed_before)


try:
    for _ in range(200):
        if run("read", "0x1000", "-n", "1,2", "--timeout", "50ms").returncode == 0:
            break
        time.sleep(0.05)
    run("write", "0x1017", "20", "-n", "1,2")
    out, code = ask(["store", "-n", "1,2"], b"", b"y\n", 4)
    check(f"a line whose question took four seconds is carried out (exit {code}): {out}", code == 0)
    check(f"no heartbeat counts as lost that was sent meanwhile: {out}", "lost" not in out)
    check("the process of the drives, which sends all the time, goes on", sim.poll() is None)
    out, code = ask(["store", "-n", "1"], b"y\n", b"n\n", 0.5)
    check(f"what was typed before the question is no answer to it (exit {code}): {out}", code == 8)
finally:
    sim.terminate()
    sim.wait()
finish()
