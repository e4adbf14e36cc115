#!/usr/bin/env python3
"""EtherCAT drives that lie from some moment of a motion or of a held `enable` on (working counter, mailbox, AL state,
statusword, 6061h, frozen inputs and outputs), with and without signals: in virtual time (the program of the motion
tests with another seed), and two processes on a virtual cable. Every run ends, and then the drive is de-energised by
servoctl, or the exit code is not 0. usage: lying_slaves.py SERVOCTL COUNT [SEED]"""
import json
import os
import pathlib
import random
import re
import signal
import subprocess
import sys
import time

servoctl, count = sys.argv[1], int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
rng = random.Random(seed)
LIES = ["wkc", "wkc-max", "silent-mailbox", "frozen-inputs", "frozen-outputs", "al-state", "statusword", "mode"]
COMMANDS = [["jog", "60rpm", "--for", "2s", "-y"], ["jog", "60rpm", "--for", "20s", "-y"],
            ["move", "3rev", "--relative", "--speed", "60rpm", "-y"], ["torque", "5%", "--for", "3s", "-y"],
            ["enable", "-y"]]
SIGNALS = ["INT", "TERM", "HUP"]
LONGEST_END = 40  # Seconds from the first signal, or from the end of the motion.
LIE_FOR = 3  # Seconds; then the drive tells the truth about how it was left.
failures = []


def in_virtual_time(runs):
    tests = [folder / "tests" / "motion_tests" for folder in pathlib.Path(servoctl).resolve().parents]
    program = next((path for path in tests if path.exists()), None)
    if program is None:
        return 0
    run = subprocess.run([program, "--gtest_filter=LyingRing.Never*"], capture_output=True, text=True,
                         env={**os.environ, "LYING_SLAVES": str(runs), "LYING_SEED": str(seed % 40000)})
    found = re.findall(r"^LYING_SLAVES=.*", run.stdout, re.M)
    failures.extend(found)
    if not found and (run.returncode != 0 or "1 test from" not in run.stdout):
        failures.append(run.stdout[-2000:] + run.stderr[-2000:])
    return runs


def status(env):
    run = subprocess.run([servoctl, "status", "--json"], env=env, capture_output=True, timeout=60)
    return json.loads(run.stdout)["result"][0] if run.returncode == 0 else None


def until(condition, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.05)
    return False


def judge(what, code, env, after):
    """When the lies are over."""
    time.sleep(after / 1000 + LIE_FOR + 0.2)
    found = status(env)
    if found is None:
        failures.append(f"{what}: exit {code}, and its state cannot be read afterwards")
        return
    if found["energised"]:
        failures.append(f"{what}: exit {code}, energised: {found}")
    if code == 0 and (found["al_error"] or found["al_state"] != "PRE-OP" or "fault" in found["state"]):
        failures.append(f"{what}: exit 0, and not de-energised by servoctl: {found}")


def attack(number):
    lies = ",".join(rng.sample(LIES, rng.choice([1, 1, 2])))
    command = rng.choice(COMMANDS)
    names = rng.choices(SIGNALS, k=rng.choice([0, 1, 2]))
    if command[0] == "enable" and not names:
        names = ["INT"]
    after, delay = rng.randrange(0, 2500), rng.uniform(0.5, 4)
    gap = rng.choice([0, 0.001, 0.05, 0.5])
    what = f"{number} of seed {seed}: lie={lies}&lie-after={after}ms, {' '.join(command)}, {' '.join(names)} after {delay:.2f} s"
    env = {**os.environ, "SERVOCTL_BUS": f"coe:local:lying-{os.getpid()}-{number}", "SERVOCTL_NODE": "1", "SERVOCTL_DRIVE": "sv2"}
    drive = subprocess.Popen([servoctl, "sim", f"sv2@1?lie={lies}&lie-after={after}ms&lie-for={LIE_FOR}s"], env=env,
                             stdout=subprocess.DEVNULL)
    run = None
    try:
        if not until(lambda: status(env) is not None, 20):
            failures.append(f"{what}: there is no drive, nothing was tried")
            return
        run = subprocess.Popen([servoctl, *command], env=env, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
        if names:
            until(lambda: run.poll() is not None, delay)
        for name in names:
            if run.poll() is None:
                run.send_signal(getattr(signal, "SIG" + name))
            time.sleep(gap)
        try:
            code = run.wait(LONGEST_END + (0 if names else 25))
        except subprocess.TimeoutExpired:
            failures.append(f"{what}: it does not end")
            return
        judge(what, code, env, after)
    finally:
        for process in (run, drive):
            if process is not None and process.poll() is None:
                process.kill()
            if process is not None:
                process.wait()


done = in_virtual_time(10 * count)
for number in range(count):
    attack(number)
    done += 1
print(f"lying_slaves: {done} attacks, {len(failures)} failures (seed {seed})")
for failure in failures:
    print(failure)
sys.exit(1 if failures else 0)
