#!/usr/bin/env python3
"""Live views on a terminal of 80x24 and of 200x50, which then changes its size: they stand where they stand, redraw ten times a
second at most, pause, sort and end by their keys, leave the terminal as it was; in a pipe there are lines as ever.
usage: live_view_test.py SERVOCTL"""
import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time

import checks
from checks import check

servoctl = sys.argv[1]
env = dict(os.environ, SERVOCTL_BUS=f"local:live-{os.getpid()}", SERVOCTL_NODE="1", SERVOCTL_DRIVE="gsd600",
           NO_COLOR="1")
PROMPT = "what stood here before"


class Screen:
    """What a terminal shows that is sent this: text, line breaks, and the escape sequences a view may use."""

    def __init__(self, columns, rows):
        self.resize(columns, rows)
        self.lines = [""] * rows
        self.row = self.column = self.pictures = 0
        self.unknown = []
        self.kept = []  # What stood there before the alternate screen.

    def resize(self, columns, rows):
        self.columns, self.rows = columns, rows
        if hasattr(self, "lines"):
            self.lines = (self.lines + [""] * rows)[:rows]
            self.row = min(self.row, rows - 1)

    def down(self):
        if self.row < self.rows - 1:
            self.row += 1
        else:
            self.lines = self.lines[1:] + [""]

    def put(self, character):
        if self.column >= self.columns:
            self.column = 0
            self.down()
        line = self.lines[self.row].ljust(self.column)
        self.lines[self.row] = line[:self.column] + character + line[self.column + 1:]
        self.column += 1

    def feed(self, text):
        for part in re.finditer(r"\x1b\[(\??[0-9;]*)([A-Za-z])|[\s\S]", text):
            if part[0] == "\r":
                self.column = 0
            elif part[0] == "\n":
                self.down()
            elif part[2] is None:
                self.put(part[0])
            elif part[2] == "A":
                self.row = max(0, self.row - int(part[1] or 1))
            elif part[2] == "H":
                self.row = self.column = 0
            elif part[2] == "K":
                self.lines[self.row] = self.lines[self.row][:self.column]
            elif part[2] == "J":
                self.pictures += 1
                self.lines[self.row] = self.lines[self.row][:self.column]
                self.lines[self.row + 1:] = [""] * (self.rows - self.row - 1)
            elif part[1] == "?1049" and part[2] in "hl":
                self.lines, self.kept = ([""] * self.rows, self.lines) if part[2] == "h" else (self.kept, [])
                self.lines = (self.lines + [""] * self.rows)[:self.rows]
            else:
                self.unknown.append(part[0])


class View:
    """A command on a terminal of its own."""

    def __init__(self, size, *words):
        self.terminal, self.tty = pty.openpty()
        self.screen = Screen(*size)
        self.resize(*size)
        self.before = termios.tcgetattr(self.tty)
        self.screen.feed(PROMPT + "\r\n")
        self.process = subprocess.Popen([servoctl, *words], env=env, stdin=self.tty, stdout=self.tty, stderr=self.tty,
                                        start_new_session=True)

    def resize(self, columns, rows):
        fcntl.ioctl(self.tty, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        self.screen.resize(columns, rows)

    def read(self, seconds):
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if select.select([self.terminal], [], [], left)[0]:
                try:
                    self.screen.feed(os.read(self.terminal, 65536).decode())
                except OSError:
                    return

    def shows(self, text):
        return any(text in line for line in self.screen.lines)

    def wait_for(self, text, seconds=10):
        end = time.monotonic() + seconds
        while not self.shows(text) and time.monotonic() < end:
            self.read(0.05)
        check(f"'{text}' is shown", self.shows(text))

    def press(self, key):
        os.write(self.terminal, key)

    def ended(self):
        end = time.monotonic() + 10
        while self.process.poll() is None and time.monotonic() < end:
            self.read(0.05)
        self.read(0.1)
        check("it ends", self.process.poll() is not None)
        check("the terminal is as it was", termios.tcgetattr(self.tty) == self.before)
        check(f"no other escape sequences: {self.screen.unknown}", not self.screen.unknown)
        return self.process.returncode

    def headings(self):
        return sum("object" in line and "value" in line for line in self.screen.lines)


def run(*words):
    return subprocess.run([servoctl, *words], env=env, capture_output=True, text=True, check=False)


def watch(size, other):
    view = View(size, "watch", "statusword", "position_actual_value", "--every", "20ms", "--plot")
    view.wait_for("Position actual value")
    view.wait_for("q: quit")
    begin, before = time.monotonic(), view.screen.pictures
    view.read(2)
    rate = (view.screen.pictures - before) / (time.monotonic() - begin)
    check(f"2 to 10 pictures a second: {rate:.1f}", 2 <= rate <= 10.5)
    check("there is one table", view.headings() == 1)
    check("what stood above it stays", view.screen.lines[0] == PROMPT)
    check("values have their course", view.shows("▅▅▅"))
    check("no line is too long", all(len(line) < size[0] for line in view.screen.lines))
    view.press(b" ")
    view.wait_for("PAUSED")
    view.press(b" s")
    view.wait_for("node*")
    check("it goes on", not view.shows("PAUSED"))
    view.resize(*other)
    view.read(0.5)
    check("there is one table on a screen of another size", view.headings() == 1)
    check("it begins at the top", "object" in view.screen.lines[0])
    view.press(b"q")
    check("q is no error", view.ended() == 0)
    check("the summary follows", view.shows("samples"))


def monitor_table():
    """One row for each CAN-ID, which Ctrl-C ends as well."""
    view = View((80, 24), "monitor", "--table")
    view.wait_for("CAN-ID")
    run("read", "0x6041")
    view.wait_for("601")
    view.wait_for("581")
    run("read", "0x6041")
    view.read(0.3)
    check("a row for each CAN-ID", sum(line.lstrip().startswith("601 ") for line in view.screen.lines) == 1)
    os.kill(view.process.pid, signal.SIGINT)
    check("Ctrl-C ends it", view.ended() == 0)
    check("the summary follows", view.shows("bus load") or view.shows("services"))


def watched_pdos():
    run("nmt", "start")
    view = View((80, 24), "pdo", "watch")
    view.wait_for("TPDO1")
    view.wait_for("Statusword")
    view.press(b"q")
    check("q is no error", view.ended() == 0)
    check("the summary follows", view.shows("count"))
    run("nmt", "preop")


def cabinet_show(size, other):
    """One row an axis, which says where it is; a change is seen, and keys sort, pause and end it."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "cabinet.toml")
        with open(file, "w", encoding="utf-8") as out:
            out.write(f'[bus.main]\nurl = "{env["SERVOCTL_BUS"]}"\n[axis.feeder]\nnode = 1\nfamily = "gsd600"\n'
                      '[axis.away]\nnode = 9\nfamily = "gsd600"\n')
        view = View(size, "cabinet", "show", "--watch", "--cabinet", file, "--timeout", "100ms", "--retries", "0")
        view.wait_for("feeder")
        view.wait_for("switch on disabled")
        view.wait_for("no answer")
        begin, before = time.monotonic(), view.screen.pictures
        view.read(2)
        rate = (view.screen.pictures - before) / (time.monotonic() - begin)
        check(f"at most 10 pictures of a cabinet a second: {rate:.1f}", rate <= 10.5)
        check("one row an axis", sum("feeder" in line for line in view.screen.lines) == 1)
        check("no line of a cabinet is too long", all(len(line) < size[0] for line in view.screen.lines))
        check("it has a screen of its own", not view.shows(PROMPT))
        run("enable", "--yes")
        view.wait_for("operation enabled")
        run("disable")
        view.wait_for("switch on disabled")
        view.press(b" ")
        view.wait_for("PAUSED")
        view.resize(*other)
        view.press(b" ")
        view.read(0.5)
        check("a cabinet fits a screen of another size", all(len(line) < other[0] for line in view.screen.lines))
        view.press(b"q")
        check("an axis that does not answer is an error in the end", view.ended() == 4)
        check("what stood there before is there again", view.shows(PROMPT))


drive = subprocess.Popen([servoctl, "sim", "gsd600@1"], env=env, stdout=subprocess.DEVNULL)
try:
    deadline = time.monotonic() + 10
    while checks.status(servoctl, env) is None and time.monotonic() < deadline:
        time.sleep(0.05)
    watch((80, 24), (200, 50))
    watch((200, 50), (80, 24))
    monitor_table()
    watched_pdos()
    cabinet_show((80, 24), (200, 50))
    cabinet_show((200, 50), (80, 24))
    piped = run("watch", "statusword", "--every", "20ms", "--for", "200ms")
    check("in a pipe there are lines", len(re.findall(r"^ +\d\.\d{3}  Statusword ", piped.stdout, re.M)) >= 5)
    check("and nothing but text", "\x1b" not in piped.stdout + piped.stderr)
    lines = View((80, 24), "watch", "statusword", "--every", "50ms", "--for", "200ms", "-o", "jsonl")
    check("records are lines on a terminal too", lines.ended() == 0 and lines.screen.pictures == 0)
finally:
    drive.kill()
    drive.wait()
checks.finish()
