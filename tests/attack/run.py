#!/usr/bin/env python3
"""Every attack of this folder in turn, with a new seed each time, until the time is over; then the counts of all.
usage: run.py SERVOCTL SECONDS [ATTACK…]"""
import pathlib
import re
import subprocess
import sys
import time

servoctl, seconds, *names = sys.argv[1:]
folder = pathlib.Path(__file__).parent
scripts = sorted(p for p in folder.glob("*.py") if p.name not in ("attack.py", "run.py") and (not names or p.stem in names))
if not scripts:
    sys.exit("run.py: there is no such attack")
COUNT = 20  # Attacks of one kind before the next one has its turn.
end = time.monotonic() + float(seconds)
attacks, failures, broken = {}, {}, []
seed = int(time.time())
while time.monotonic() < end and not broken:
    for script in scripts:
        if time.monotonic() >= end:
            break
        seed += 1
        run = subprocess.run([sys.executable, script, servoctl, str(COUNT), str(seed)], capture_output=True, text=True)
        told = re.search(r": (\d+) attacks, (\d+) failures", run.stdout)
        if told is None or (run.returncode != 0) != (int(told[2]) > 0):
            broken.append(script.stem)
            print(f"{script.name} {COUNT} {seed}: exit {run.returncode}, no count\n{run.stdout}{run.stderr}")
            continue
        attacks[script.stem] = attacks.get(script.stem, 0) + int(told[1])
        failures[script.stem] = failures.get(script.stem, 0) + int(told[2])
        if int(told[2]):
            print(f"{script.name} {COUNT} {seed}:\n{run.stdout}", flush=True)
for name, count in attacks.items():
    print(f"{name:20} {count:6} attacks, {failures[name]} failures")
print(f"{sum(attacks.values())} attacks, {sum(failures.values())} failures")
sys.exit(1 if broken or any(failures.values()) or not attacks else 0)
