#!/usr/bin/env python3
"""A servoctl whose standard streams are closed does not put the bus in their place: text for people would be written
into it. usage: closed_descriptors_test.py SERVOCTL"""
import os
import pty
import signal
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

    # Neither stream can be written: the program ends by what it has to say, and not by saying it.
    for words, code in ((["help"], 7), (["read", "0x6041", "-n", "1"], 7), (["read", "0x5999", "-n", "1"], 5), (["fly"], 2), (["run", "nosuchfile"], 7)):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([servoctl, *words], env=env, stdin=subprocess.DEVNULL, stdout=full, stderr=full)
        check(f"{words} into a full disk: {done.returncode}", done.returncode == code)
    for words in (["monitor"], ["enable", "-n", "1", "-d", "gsd600", "-y"], ["run", "-"]):
        terminal, tty = pty.openpty()
        process = subprocess.Popen([servoctl, *words], env=env, stdin=subprocess.PIPE, stdout=tty, stderr=tty)
        os.close(tty)
        os.close(terminal)
        process.stdin.write(b"enable -n 1 -d gsd600 -y\nwatch 0x6041 -n 1 --for 20s\n" if words[0] == "run" else b"")
        process.stdin.close()
        try:
            if words[0] == "monitor":
                time.sleep(1)
                process.send_signal(signal.SIGHUP)
            left = process.wait(60)
            check(f"{words} on a closed terminal: {left}", left in (0, 7, 130))
        except subprocess.TimeoutExpired:
            process.kill()
            check(f"{words} on a closed terminal does not end", False)
        subprocess.run([servoctl, "stop"], env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
finally:
    sim.terminate()
    sim.wait()
finish()
