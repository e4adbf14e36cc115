#!/usr/bin/env python3
"""Several drives are enabled, at a prompt that reads lines or in a batch file; then one drive is killed, falls into a
fault, or is stopped by NMT, and servoctl ends: by `quick-stop`, `disable`, an error, the end of its input, a signal, or a kill after which another stops all there is.
Afterwards no drive that answers is energised, and a dead one was told. usage: stop_all.py SERVOCTL COUNT [SEED]"""
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from checks import obeying

servoctl, count = sys.argv[1], int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
rng = random.Random(seed)
NODES = (1, 2, 3)
FAMILIES = ("gsd600", "dm", "da200", "ts", "sv2")
WAYS = ("disable", "quick-stop", "disable all", "quick-stop all", "SIGKILL", "error", "end of input", "SIGTERM", "SIGHUP", "SIGINT")
TROUBLES = ("none", "killed", "stopped by NMT", "reset", "disabled by another")


def status(env, node):
    run = subprocess.run([servoctl, "status", "-n", str(node), "--timeout", "300ms", "--json"], env=env, capture_output=True,
                         timeout=60)
    return json.loads(run.stdout)["result"][0] if run.returncode == 0 else None


def until(condition, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.05)
    return False


def nmt(env, command, node):
    subprocess.run([servoctl, "nmt", command, "-n", str(node), "--yes"], env=env, capture_output=True, timeout=60)


def give_trouble(env, trouble, sims, node):
    if trouble == "killed":
        sims[node].kill()
        sims[node].wait()
    elif trouble == "stopped by NMT":
        nmt(env, "stop", node)
    elif trouble == "reset":
        nmt(env, "reset", node)
        time.sleep(0.2)
    elif trouble == "disabled by another":
        subprocess.run([servoctl, "disable", "-n", str(node)], env=env, capture_output=True, timeout=60)


def attack(number):
    family, way, trouble = rng.choice(FAMILIES), rng.choice(WAYS), rng.choice(TROUBLES)
    batch, victim = rng.random() < 0.5, rng.choice(NODES)
    what = f"{family}, {'batch' if batch else 'pipe'}, {way}, node {victim} {trouble}"
    env = {**os.environ, "SERVOCTL_BUS": f"local:stop-all-{os.getpid()}-{number}", "SERVOCTL_DRIVE": family}
    sims = {n: subprocess.Popen([servoctl, "sim", f"{family}@{n}{obeying(family)}"], env=env, stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL) for n in NODES}
    words = [servoctl, "run", "-"] if batch else [servoctl]
    log = tempfile.TemporaryFile("w+")
    program = None
    try:
        for n in NODES:
            if not until(lambda n=n: status(env, n) is not None, 20):
                return f"{what}: the simulated drive {n} does not answer"
        lines = [f"nmt start -n {n} --yes" for n in NODES] + [f"enable -n {n} --yes" for n in NODES]
        ending = {"disable": ["disable -n 1-3"], "quick-stop": ["quick-stop -n 1-3", "disable -n 1-3"],
                  "disable all": ["disable -n all"], "quick-stop all": ["quick-stop -n all", "disable -n all"], "error": ["read 0x5FFF -n 1"]}
        program = subprocess.Popen(words, env=env, stdin=subprocess.PIPE, stdout=log, stderr=log, text=True)
        last = ["wait 2s", *ending.get(way, ["wait 20s"] if way.startswith("SIG") else [])]
        program.stdin.write("\n".join(lines + (last if batch else [])) + "\n")
        program.stdin.flush()
        if batch:
            program.stdin.close()  # It is read as a whole.
        if not until(lambda: all((status(env, n) or {}).get("energised") for n in NODES), 40):
            log.seek(0)
            return f"{what}: the drives are not enabled: {log.read()[-600:]}"
        give_trouble(env, trouble, sims, victim)
        if way.startswith("SIG"):
            program.send_signal(getattr(signal, way))
        elif not batch:
            program.stdin.write("\n".join(ending.get(way, [])) + "\n")
        if not batch:
            program.stdin.close()
        try:
            code = program.wait(60)
        except subprocess.TimeoutExpired:
            return f"{what}: servoctl does not end"
        log.seek(0)
        said = log.read()
        if way == "SIGKILL":  # Somebody else, who has heard of no drive, stops what was left.
            if not all((status(env, n) or {}).get("energised") for n in NODES if n != victim):
                return None if family == "gsd600" else f"{what}: the drives have lost their power by themselves"
            other = subprocess.run([servoctl, "disable", "-n", "all"], env=env, capture_output=True, text=True, timeout=60)
            code, said = other.returncode, other.stdout + other.stderr
        # The end of a batch file without an error leaves what it enabled, as it was asked to.
        left_on_purpose = code == 0 and way == "end of input"
        for n in NODES:
            dead = trouble == "killed" and n == victim
            seen = status(env, n)
            if dead or left_on_purpose:
                continue
            if seen is None and trouble == "stopped by NMT" and n == victim and code == 0:
                return f"{what}: node {n} does not answer, and the exit code is 0"
            if seen is not None and seen["energised"]:
                return f"{what}: node {n} is {seen['state']}, exit {code}: {said[-600:]}"
        if trouble == "killed" and not left_on_purpose and way != "SIGKILL" and (code == 0 or f"node {victim}" not in said.lower()):
            return f"{what}: the dead node was not told, exit {code}: {said[-600:]}"
        return None
    finally:
        for process in [program, *sims.values()]:
            if process is not None and process.poll() is None:
                process.kill()
                process.wait()
        log.close()


failures = 0
for i in range(count):
    wrong = attack(i)
    if wrong:
        failures += 1
        print(f"stop_all {seed}, attack {i}: {wrong}")
print(f"stop_all: {count} attacks, {failures} failures")
sys.exit(1 if failures else 0)
