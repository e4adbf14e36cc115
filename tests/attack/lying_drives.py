#!/usr/bin/env python3
"""Drives that lie, refuse, fall silent or lose their link at any moment of a motion, in virtual time: the program of
the motion tests with another seed. usage: lying_drives.py SERVOCTL COUNT [SEED]"""
import os
import pathlib
import re
import subprocess
import sys

servoctl, count = pathlib.Path(sys.argv[1]), int(sys.argv[2]) * 10  # One takes some milliseconds.
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
tests = [folder / "tests" / "motion_tests" for folder in servoctl.resolve().parents]
program = next((path for path in tests if path.exists()), None)
if program is None:
    print("lying_drives: 0 attacks, 0 failures (motion_tests is not built)")
    sys.exit(0)
run = subprocess.run([program, "--gtest_filter=LyingDrives.*"], capture_output=True, text=True,
                     env={**os.environ, "LYING_DRIVES": str(count), "LYING_SEED": str(seed % 40000)})
failures = re.findall(r"^LYING_DRIVES=.*", run.stdout, re.M)
broken = not failures and (run.returncode != 0 or "1 test from" not in run.stdout)
for failure in failures:
    print(failure)
if broken:
    print(run.stdout[-2000:], run.stderr[-2000:])
print(f"lying_drives: {count} attacks, {len(failures) + broken} failures")
sys.exit(1 if failures or broken else 0)
