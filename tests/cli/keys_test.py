#!/usr/bin/env python3
"""jog by arrow keys on a terminal: it turns while a key is repeated, stops when it is let go, ends at any other key,
without a key for 5 s, at Ctrl-C and when the terminal goes away; nothing is left energised, and the terminal is as it was.
usage: keys_test.py SERVOCTL"""
import os
import pty
import select
import subprocess
import sys
import termios
import time

import checks
from checks import check

servoctl = sys.argv[1]
bus = f"local:keys-{os.getpid()}"
env = dict(os.environ, SERVOCTL_BUS=bus, SERVOCTL_NODE="1", SERVOCTL_DRIVE="gsd600")
right, left = b"\x1b[C", b"\x1b[D"


def status():
    return checks.status(servoctl, env)


class Jog:
    """servoctl on a terminal of its own."""

    def __init__(self):
        self.terminal, tty = pty.openpty()
        self.before = termios.tcgetattr(tty)
        self.tty = tty
        self.process = subprocess.Popen([servoctl, "jog", "60rpm", "--turn", "131072", "--yes"], env=env, stdin=tty,
                                        stdout=tty, stderr=tty, start_new_session=True)
        self.text = b""
        self.read_until(b"any other key, or 5 s")

    def read_until(self, part, seconds=10):
        end = time.monotonic() + seconds
        while part not in self.text and time.monotonic() < end:
            self.read(0.05)
        check(f"'{part.decode()}' is shown", part in self.text)

    def read(self, seconds):
        end = time.monotonic() + seconds
        while (left_over := end - time.monotonic()) > 0:
            if select.select([self.terminal], [], [], left_over)[0]:
                try:
                    self.text += os.read(self.terminal, 65536)
                except OSError:
                    return

    def hold(self, key, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            os.write(self.terminal, key)
            self.read(0.04)

    def ended(self):
        end = time.monotonic() + 10
        while self.process.poll() is None and time.monotonic() < end:
            self.read(0.05)
        check("it ends", self.process.poll() is not None)
        return self.process.returncode


def velocities(text):
    """The speeds in the lines that were shown."""
    out = []
    for line in text.decode(errors="replace").splitlines():
        words = line.split()
        if "rpm" in words and "deg" in words:
            out.append(float(words[words.index("rpm") - 1]))
    return out


drive = subprocess.Popen([servoctl, "sim", "gsd600@1"], env=env, stdout=subprocess.DEVNULL)
try:
    deadline = time.monotonic() + 10
    while status() is None and time.monotonic() < deadline:
        time.sleep(0.05)

    jog = Jog()
    jog.hold(right, 1.5)
    jog.read(1.2)
    turned = velocities(jog.text)
    check("it turns while the key is held", turned and max(turned) > 50)
    check("it stops when the key is let go", turned and abs(turned[-1]) < 1)
    jog.text = b""
    jog.hold(left, 1.5)
    check("the other key turns the other way", min(velocities(jog.text), default=0) < -50)
    os.write(jog.terminal, b"q")
    check("any other key ends it well", jog.ended() == 0)
    check("nothing is energised after it", status()["energised"] is False)
    check("the terminal is as it was", termios.tcgetattr(jog.tty) == jog.before)

    jog = Jog()
    jog.hold(right, 0.5)
    os.write(jog.terminal, b"\x13")
    check("Ctrl-S is a key as any other", jog.ended() == 0)
    check("nothing is energised after Ctrl-S", status()["energised"] is False)

    jog = Jog()
    jog.hold(right, 0.5)
    jog.process.send_signal(2)
    check("Ctrl-C ends it as interrupted", jog.ended() == 130)
    check("nothing is energised after Ctrl-C", status()["energised"] is False)
    check("the terminal is as it was after Ctrl-C", termios.tcgetattr(jog.tty) == jog.before)

    jog = Jog()
    begin = time.monotonic()
    check("it ends well without a key for 5 s", jog.ended() == 0)
    check("and not before", time.monotonic() - begin > 4)
    check("it says so", b"no key was held for 5 s" in jog.text)
    check("nothing is energised after that", status()["energised"] is False)

    jog = Jog()
    jog.hold(right, 0.5)
    os.close(jog.tty)
    os.close(jog.terminal)
    jog.process.wait(timeout=10)
    check("nothing is energised when the terminal has gone", status()["energised"] is False)
finally:
    drive.terminate()
    drive.wait()
checks.finish()
