#!/usr/bin/env python3
"""A servoctl whose standard streams are closed does not put the bus in their place: text for people would be written
into it. usage: closed_descriptors_test.py SERVOCTL"""
import os
import subprocess
import sys
import time

from checks import check, finish

servoctl = sys.argv[1]
env = dict(os.environ, SERVOCTL_BUS=f"local:closed-{os.getpid()}")
sim = subprocess.Popen([servoctl, "sim", "gsd600@1"], env=env, stdout=subprocess.DEVNULL)
try:
    for closed in ([0], [1], [2], [0, 1], [1, 2], [0, 2], [0, 1, 2]):
        def close():
            for number in closed:
                os.close(number)
        process = subprocess.Popen([servoctl, "monitor", "--for", "1s"], env=env, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=close)
        streams = []
        end = time.monotonic() + 0.8
        while time.monotonic() < end:
            try:
                streams = [os.readlink(f"/proc/{process.pid}/fd/{number}") for number in range(3)]
                if any("socket" in os.readlink(f"/proc/{process.pid}/fd/{number}") for number in os.listdir(f"/proc/{process.pid}/fd")):
                    break
            except OSError:
                pass
            time.sleep(0.01)
        check(f"without {closed}: {streams}", streams == ["/dev/null"] * 3)
        check(f"without {closed}: it ends well", process.wait(20) == 0)
finally:
    sim.terminate()
    sim.wait()
finish()
