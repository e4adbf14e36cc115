#!/usr/bin/env python3
"""The window changes its width while a line is typed: the line is drawn anew, once, and what stood above it stays.
usage: prompt_size_test.py SERVOCTL"""
import fcntl
import os
import select
import struct
import sys
import tempfile
import termios
import time

from pty_terminal import Terminal, failures
from terminal_screen import ROWS, Screen, width

servoctl = sys.argv[1]
WIDTHS = (40, 120, 61, 33, 80, 79, 24, 80)
PROMPT = "servoctl> "


def rows_of(text, columns):
    """As the prompt breaks it."""
    rows, used = [""], 0
    for character in text:
        size = width(character)
        if used + size > columns:
            rows.append("")
            used = 0
        rows[-1] += character
        used += size
    return rows


class Window:
    """A prompt behind the end of `help exit`, in a terminal that changes its width."""

    def __init__(self, state):
        self.terminal = Terminal(servoctl, state=state, size=(ROWS, 80))
        self.screen = Screen()
        self.shows("the prompt", lambda: PROMPT.rstrip() in self.lines())
        self.terminal.type("help exit\r")
        self.shows("the help", lambda: PROMPT.rstrip() in self.lines()[5:])

    def read(self):
        """Whether something came."""
        ready, _, _ = select.select([self.terminal.fd], [], [], 0.1)
        if ready:
            self.screen.take(os.read(self.terminal.fd, 65536))
        return bool(ready)

    def lines(self):
        return ["".join(cell[0] for cell in row).rstrip() for row in self.screen.rows]

    def shows(self, what, condition):
        end = time.monotonic() + 10
        while not condition():
            if not self.read() and time.monotonic() > end:
                shown = "\n".join(line for line in self.lines() if line)
                failures.append(f"{what}: {self.screen.columns} columns show\n{shown}\ncursor {self.screen.picture()[1]}")
                return

    def resize(self, columns):
        while self.read():
            pass
        self.screen.resize(columns)
        fcntl.ioctl(self.terminal.fd, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, columns, 0, 0))

    def below(self, text, behind=""):
        """What stands under this line; None unless the line is there once, right behind the help, with the cursor in it."""
        columns = self.screen.columns
        wanted = [row.rstrip() for row in rows_of(text, columns)]
        lines = self.lines()
        help_ends = max((number for number, line in enumerate(lines) if line.endswith("prompt")), default=-1)
        if lines[help_ends + 1:help_ends + 1 + len(wanted)] != wanted:
            return None
        before = text[:len(text) - len(behind)]
        rows = rows_of(before + (behind or "x")[0], columns)
        cursor = help_ends + len(rows), sum(map(width, rows[-1][:-1]))
        return lines[help_ends + 1 + len(wanted):] if self.screen.picture()[1] == cursor else None

    def goes_through(self, what, widths, condition):
        self.shows(what, condition)
        for columns in widths:
            self.resize(columns)
            self.shows(what, condition)
        self.terminal.type("\x03")
        self.shows(f"{what}: the next line", lambda: PROMPT.rstrip() == next((line for line in reversed(self.lines()) if line), ""))
        self.terminal.type("exit\r")
        self.terminal.exit_code()


def nothing(rows):
    return rows is not None and not any(rows)


def a_line(what, text, behind=""):
    def test(state):
        window = Window(state)
        window.terminal.type(text + "\x1b[D" * len(behind))
        window.goes_through(what, WIDTHS, lambda: nothing(window.below(PROMPT + text, behind)))
    return test


def a_search(state):
    window = Window(state)
    window.terminal.type("\x12help")
    window.goes_through("a search", (30, 24, 60, 80), lambda: nothing(window.below("(search 'help') help exit")))


def a_list(state):
    window = Window(state)
    window.terminal.type("par\t\t")

    def is_listed():
        rows = window.below(PROMPT + "param ") or []
        return all(sum(1 for row in rows if word in row.split()[:1]) == 1 for word in ("get", "search", "set"))
    window.goes_through("a list of candidates", (40, 100, 30, 80), is_listed)


for part in (a_line("a long line", "read 0x6041 " * 9 + "# " + "abcdefghij" * 5),
             a_line("a line with the cursor in it", "read 0x6041 " * 11, "0x6041 " * 3),
             a_line("wide characters", "param search " + "速度环增益位置环" * 7),
             a_line("wide characters with the cursor between them", "# 速度环增益 " * 8, "增益 # 速度环增益 "),
             a_line("a short line", "status"), a_search, a_list):
    with tempfile.TemporaryDirectory() as folder:
        part(folder)
for failure in failures:
    print("FAILED", failure)
print(f"{len(failures)} failed")
sys.exit(1 if failures else 0)
