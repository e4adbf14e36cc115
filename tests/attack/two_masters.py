#!/usr/bin/env python3
"""Two servoctl started up to 30 ms apart, each with a drive of its own that watches it: they send heartbeats under
different numbers, and when one is killed its drive stops, while the other one goes on.
usage: two_masters.py SERVOCTL COUNT [SEED]"""
import json
import os
import random
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from checks import obeying

servoctl, count = sys.argv[1], int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
rng = random.Random(seed)
# Those that watch servoctl by its heartbeat.
FAMILIES = {"gsd600": ["--turn", "131072"], "ts": ["--turn", "10000"], "dm": []}
failures = []


def ask(env, *words):
    run = subprocess.run([servoctl, *words, "--timeout", "300ms", "--json"], env=env, capture_output=True, timeout=60)
    return json.loads(run.stdout)["result"] if run.returncode == 0 else None


def energised(env, node):
    found = ask(env, "status", "-n", str(node))
    return found[0]["energised"] if found else None


def producer(env, node):
    found = ask(env, "read", "0x1016:1", "-n", str(node))
    return found[0]["value"] >> 16 & 0x7F if found else None


def until(condition, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return False


def attack(number):
    family, gap, victim = rng.choice(list(FAMILIES)), rng.choice([0, 0, rng.uniform(0, 0.03)]), rng.randrange(2)
    what = f"{number}: {family}, {gap * 1000:.1f} ms apart, number {victim + 1} killed"
    env = {**os.environ, "SERVOCTL_BUS": f"local:two-masters-{os.getpid()}-{number}", "SERVOCTL_DRIVE": family}
    sim = subprocess.Popen([servoctl, "sim", f"{family}@1,{family}@2{obeying(family)}"], env=env, stdout=subprocess.DEVNULL)
    runs = []
    try:
        if not until(lambda: energised(env, 2) is False, 20):
            failures.append(f"{what}: the drives do not answer")
            return
        for node in (1, 2):
            runs.append(subprocess.Popen([servoctl, "jog", "60rpm", "--for", "8s", *FAMILIES[family], "-n", str(node), "-y"],
                                         env=env, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE))
            time.sleep(gap)
        if not until(lambda: energised(env, 1) and energised(env, 2), 20):
            failures.append(f"{what}: they do not both move: {[run.poll() for run in runs]}")
            return
        numbers = producer(env, 1), producer(env, 2)
        if numbers[0] == numbers[1]:
            failures.append(f"{what}: both send heartbeats as node {numbers[0]}")
        runs[victim].kill()
        # Half a second, and what a busy machine adds.
        if not until(lambda: energised(env, victim + 1) is False, 2):
            failures.append(f"{what}: the drive of the killed one runs on")
        if runs[1 - victim].wait(30) != 0:
            failures.append(f"{what}: the other one: {runs[1 - victim].stderr.read().decode()}")
    finally:
        for process in [*runs, sim]:
            process.kill()
            process.wait()


done = 0
for number in range(count):
    attack(number)
    done += 1
print(f"two_masters: {done} attacks, {len(failures)} failures (seed {seed})")
for failure in failures:
    print(failure)
sys.exit(1 if failures else 0)
