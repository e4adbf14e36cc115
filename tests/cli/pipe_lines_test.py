#!/usr/bin/env python3
"""Lines from a pipe are as those at the prompt: SYNC goes on between them, what nodes tell is told while none comes, and all that a
line began ends with the input. usage: pipe_lines_test.py SERVOCTL"""
import os
import select
import subprocess
import sys
import tempfile
import time

from checks import check, finish

servoctl = sys.argv[1]
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env.update(LANG="C")

with tempfile.TemporaryDirectory() as folder:
    trace = os.path.join(folder, "trace")
    pipe = subprocess.Popen([servoctl, "-b", "sim:gsd600@1?fault=0xFF00@2s", "-n", "1", "-d", "gsd600", "--trace", trace], env=env,
                            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    pipe.stdin.write(b"sync start --period 20ms --yes\n")
    pipe.stdin.flush()
    told, end = b"", time.monotonic() + 20
    while b"EMCY 0xFF00" not in told and time.monotonic() < end:
        if select.select([pipe.stderr], [], [], 0.1)[0]:
            told += os.read(pipe.stderr.fileno(), 4096)
    check(f"an emergency is told while no line comes: {told}", b"notice: node 1: EMCY 0xFF00" in told)
    pipe.stdin.write(b"read statusword\n")
    pipe.stdin.flush()
    time.sleep(1)
    out, errors = pipe.communicate(timeout=20)
    check(f"the lines are carried out (exit {pipe.returncode}): {out} {errors}", pipe.returncode == 0 and b"0x6041" in out)
    check(f"SYNC ends with the input, and that is told: {errors}", b"SYNC is no longer produced" in errors)
    with open(trace, encoding="utf-8") as file:
        frames = file.read().splitlines()
    read = next((i for i, line in enumerate(frames) if "601#404160" in line), len(frames))
    before, after = (len([line for line in part if " 080#" in line]) for part in (frames[:read], frames[read:]))
    check(f"SYNC goes on before and behind a line: {before}, {after}", before > 50 and after > 20)

    # A mistyped option is no option that is not there: the lines were to write nothing.
    drive = ["-b", f"sim:gsd600@1?state={folder}/state", "-n", "1", "-d", "gsd600"]
    for option in ("--readonly", "--dry-rum", "-X"):
        done = subprocess.run([servoctl, *drive, option], env=env, input=b"param set Pn0214 46Hz --keep\n", capture_output=True)
        check(f"{option} is refused: {done.returncode} {done.stderr}", done.returncode == 2 and b"there is no option" in done.stderr)
    done = subprocess.run([servoctl, "param", "get", "Pn0214", *drive], env=env, capture_output=True)
    check(f"and nothing was written: {done.stdout}", b"60 Hz" in done.stdout)
    done = subprocess.run([servoctl], env={**env, "XDG_STATE_HOME": folder}, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True)
    check(f"without lines and bus three lines say what to do first: {done.stderr}",
          done.returncode == 0 and done.stderr.count(b"\n") == 3 and b"bus detect" in done.stderr and b"scan" in done.stderr)
    done = subprocess.run([servoctl, "-b", "sim:gsd600@1"], env={**env, "XDG_STATE_HOME": folder}, cwd=folder, stdin=subprocess.DEVNULL,
                          capture_output=True)
    check(f"who names a bus knows that: {done.stderr}", done.returncode == 0 and b"bus detect" not in done.stderr)
finish()
