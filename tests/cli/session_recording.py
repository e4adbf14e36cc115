"""A session at the prompt on a pseudo-terminal: what is typed, and every picture of the screen with its time."""
import collections
import fcntl
import os
import pty
import re
import select
import signal
import struct
import tempfile
import termios
import time

from terminal_screen import COLUMNS, ROWS, Screen

# What is typed; what the screen shows then, up to the cursor or (after a Tab) below it; how long it is looked at before the
# next is typed, in seconds.
FAULT = r"\[fault\??\]> "
READY = r"\[(switch on disabled|pre-operational)\??\]> "
STEPS = [
    ("servoctl -b 'sim:gsd600@1?fault=0x8130@0s'\r", r"servoctl sim:gsd600@1> ", 0.6),
    ("scan\r", r"0x8130\n.*> ", 1.2),
    ("drive gsd600\r", r"gsd600> ", 0.3),
    ("use 1\r", FAULT, 0.7),
    ("fault show\r", r"check .*\n.*\n.*" + FAULT, 2.2),
    ("fault reset\r", r"\[y/N\] ", 0.5),
    ("y\r", r"is 1\n.*" + FAULT, 1.8),
    ("nmt reset --wait\r", r"\[y/N\] ", 0.6),
    ("y\r", r"boot-up\n.*" + READY, 0.9),
    ("param search 刚性 --lang zh\r", r"Pn0271.*\n.*" + READY, 1.1),
    ("param se\t", r"search +Find", 0.8),
    ("t Pn0214 45\t", r"45Hz +45kHz", 0.8),
    ("Hz --keep\r", r"450 = 45 Hz(.*\n)+.*" + READY, 1.1),
    ("jog 60rpm --for 1s --turn 131072\r", r"clear\?\s+\[y/N\] ", 2.4),
    ("y\r", r"torque    %.*\n.*" + READY, 1.7),
    ("undo\r", r"\[y/N\] ", 0.8),
    ("y\r", r"600 = 60 Hz(.*\n)+.*" + READY, 1.1),
    ("status\r", r"pp +none\n.*" + READY, 1.1),
    ("exit\r", r"exit\n\$ ", 0.5),
]
KEY = 0.04  # Seconds from one key to the next.

# A screen that is `settled` is the same whenever the session is run; the others are what was seen on the way to it.
Frame = collections.namedtuple("Frame", "time rows cursor settled")


class Recorder:
    def __init__(self, servoctl, home, slow):
        self.slow = slow
        self.screen = Screen()
        self.frames = []
        self.begin = time.monotonic()
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            folder = os.path.join(home, "bin")
            os.makedirs(folder)
            os.symlink(servoctl, os.path.join(folder, "servoctl"))
            os.makedirs(os.path.join(home, "work"))
            os.chdir(os.path.join(home, "work"))
            fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
            env = {"PATH": folder + ":/usr/bin:/bin", "HOME": home, "TERM": "xterm-256color", "LANG": "C.UTF-8", "PS1": "$ "}
            os.execve("/bin/sh", ["sh", "-i"], env)

    def keep(self, settled):
        rows, cursor = self.screen.picture()
        frame = Frame(time.monotonic() - self.begin, rows, cursor, settled)
        if self.frames and self.frames[-1][1:3] == frame[1:3]:
            last = self.frames.pop()
            frame = last._replace(settled=last.settled or settled)
        self.frames.append(frame)

    def read(self, seconds):
        """Takes what comes within this time; whether anything did."""
        if not select.select([self.fd], [], [], max(0, seconds))[0]:
            return False
        self.screen.take(os.read(self.fd, 65536))
        return True

    def see(self, shown, what):
        end = time.monotonic() + 30
        while not shown():
            if not self.read(end - time.monotonic()):
                raise TimeoutError(f"{what} was not seen; the screen shows:\n{self.screen.text()}")
            self.keep(False)
        self.keep(True)

    def shows(self, typed, pattern):
        if typed.endswith("\t"):
            return re.search(pattern, self.screen.below())
        return re.search(pattern + r"\Z", self.screen.text())

    def wait(self, seconds):
        end = time.monotonic() + (seconds if self.slow else 0)
        while time.monotonic() < end:
            if self.read(end - time.monotonic()):
                self.keep(False)

    def type(self, text):
        line = ""
        for character in text:
            os.write(self.fd, character.encode())
            if character in "\r\t":
                return
            line += character
            self.see(lambda: self.screen.typed().endswith(line), repr(line))
            self.wait(KEY)

    def run(self):
        self.see(lambda: self.screen.text() == "$ ", "the shell")
        self.wait(0.6)
        for text, pattern, seconds in STEPS:
            self.type(text)
            self.see(lambda: self.shows(text, pattern), repr(pattern))
            self.wait(seconds)
        return self.frames


def record(servoctl, slow):
    """The frames of the session; slow: typed as by a person."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as home:
        recorder = Recorder(os.path.abspath(servoctl), home, slow)
        try:
            return recorder.run()
        finally:
            os.kill(recorder.pid, signal.SIGHUP)
            os.close(recorder.fd)
            os.waitpid(recorder.pid, 0)
