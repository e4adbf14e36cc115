#!/usr/bin/env python3
"""At the prompt an answer that is longer than the window is read a window at a time, by a key each, while SYNC goes on and what
drives tell is shown at once. Nothing is read so that nobody would read so: with a line typed ahead, --no-pager, no pager wanted, JSON, a
drive that is energised.
usage: prompt_windows_test.py SERVOCTL"""
import fcntl
import os
import re
import struct
import sys
import tempfile
import termios
import time

from checks import check, finish
from pty_terminal import Terminal, failures

servoctl = os.path.abspath(sys.argv[1])
for name in list(os.environ):
    if name.startswith("SERVOCTL_") or name in ("PAGER", "LESS", "NO_COLOR"):
        del os.environ[name]
PLACE = r"-- line (\d+) of (\d+); Space goes on, Enter by a line, q ends --"
folder = tempfile.mkdtemp()


def prompt(*words, bus="sim:gsd600@1", size=(24, 80), **variables):
    before = dict(os.environ)
    os.environ.update(variables)
    terminal = Terminal(servoctl, "-b", bus, "-n", "1", "-d", "gsd600", *words, state=folder, size=size)
    os.environ.clear()
    os.environ.update(before)
    terminal.see(r"\]> ")
    return terminal


def shown_until(terminal, pattern, seconds=20):
    """What comes up to the pattern, and its groups; without what moves the cursor."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        plain = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]|\x1b[=>]", "", terminal.text)
        if found := re.search(pattern, plain):
            terminal.text = plain[found.end():]
            return plain[:found.start()].replace("\r", ""), found.groups()
        if not terminal.read(0.1):
            break
    check(f"{pattern} comes; there is {terminal.text[-300:]!r}", False)
    return "", ("0", "0")


def back(terminal, state=""):
    """What comes up to the next prompt, behind which nothing comes for a while: each key draws its line anew."""
    text = ""
    for _ in range(100):
        more, found = shown_until(terminal, f"{state}\\??(\\]> )", 10)
        text += more
        before = terminal.text
        terminal.read(0.3)
        if found[0] == "0" or terminal.text == before.strip("\r\n") == "":
            break
    return text


def leave(terminal):
    terminal.type("exit\n")
    check("the prompt ends well", terminal.exit_code() == 0)


def keys():
    terminal = prompt()
    terminal.type("objects\n")
    text, (line, lines) = shown_until(terminal, PLACE)
    # The line typed stands above, as the terminal echoed it; 23 rows fill what the place leaves.
    check(f"a window is shown first: {line} of {lines}", line == "23" and int(lines) > 1000)
    check("the table begins with its head", "object" in text and "Device type" in text and "0x6041" not in text)
    terminal.type("x")
    time.sleep(0.3)
    terminal.read(0.1)
    check("another key does nothing", "line" not in terminal.text)
    terminal.type("\n")
    text, (line, _) = shown_until(terminal, PLACE)
    check(f"Enter goes on by a line, not {line}", line == "24" and text.strip().count("\n") == 0)
    terminal.type("\x1b[B")
    check("the arrow down as well", shown_until(terminal, PLACE)[1][0] == "25")
    terminal.type(" ")
    check("Space goes on by a window", shown_until(terminal, PLACE)[1][0] == "48")
    terminal.type("\x1b[6~")
    check("and Page Down", shown_until(terminal, PLACE)[1][0] == "71")
    terminal.type("\x1b[3~\x1b[1;5B")
    fcntl.ioctl(terminal.fd, termios.TIOCSWINSZ, struct.pack("HHHH", 11, 80, 0, 0))
    terminal.type(" ")
    check("by the window as it is now", shown_until(terminal, PLACE)[1][0] == "81")
    terminal.type("q")
    text = back(terminal)
    check(f"q ends it: {text!r}", "line" not in text and len(text) < 100)
    terminal.type("objects 0x6041\n")
    text = back(terminal)
    check("what fits is shown at once, and the next line is taken", "0x6041:0" in text and "-- line" not in text)
    terminal.type("objects\n")
    shown_until(terminal, PLACE)
    terminal.type("\x03")
    text = back(terminal)
    check("Ctrl-C ends it", len(text) < 100)
    terminal.type("explain exit codes --lang zh\n")
    shown_until(terminal, r"-- 第 10 行，共 \d+ 行；空格键翻页，回车键前进一行，q 键结束 --")
    while True:
        terminal.type(" ")
        text, _ = shown_until(terminal, r"键结束 --|\]> ")
        if "第" not in text:
            break
    check(f"the last window ends it: {text!r}", "explain NAME" in text and "空格键" not in text)
    leave(terminal)


def buses_go_on():
    trace = os.path.join(folder, "trace.log")
    terminal = prompt("--trace", trace, bus="sim:gsd600@1?fault=0xFF00@3s")
    terminal.type("sync start --period 50ms --yes\n")
    back(terminal)
    terminal.type("objects\n")
    shown_until(terminal, PLACE)
    text, _ = shown_until(terminal, r"\* node 1: EMCY 0xFF00[\s\S]*?" + PLACE)
    check(f"what a drive tells is shown at once, above the place: {text!r}", True)
    time.sleep(1)
    terminal.type("q")
    back(terminal)
    leave(terminal)
    with open(trace, encoding="utf-8") as file:
        times = [float(line[1:line.index(")")]) for line in file if " 080#" in line]
    gaps = [later - earlier for earlier, later in zip(times, times[1:])]
    check(f"SYNC goes on: {len(times)}, {max(gaps, default=99):.3f} s apart at most", len(times) > 40 and max(gaps) < 1)


def the_log_is_whole():
    log = os.path.join(folder, "session.log")
    terminal = prompt()
    terminal.type(f"log on {log}\n")
    back(terminal)
    terminal.type("objects\n")
    shown_until(terminal, PLACE)
    terminal.type("q")
    back(terminal)
    leave(terminal)
    text = open(log, encoding="utf-8").read()
    check("the log has what was not read, and no place", "0x6502" in text and "-- line" not in text)


def all_at_once():
    for why, line, words, variables in (
            ("--no-pager in the line", "objects --no-pager", (), {}),
            ("--no-pager at the start", "objects", ("--no-pager",), {}),
            ("SERVOCTL_PAGER=cat", "objects", (), {"SERVOCTL_PAGER": "cat"}),
            ("an empty PAGER", "objects", (), {"PAGER": ""}),
            ("JSON", "objects --json", (), {}),
            ("-q", "objects -q", (), {})):
        terminal = prompt(*words, **variables)
        terminal.type(line + "\n")
        text = back(terminal)
        check(f"{why}: all at once", ("0x6502" in text or '"ok":true' in text) and "-- line" not in text)
        leave(terminal)
    terminal = prompt()
    terminal.type("enable --yes\n")
    back(terminal, "operation enabled")
    terminal.type("objects\n")
    text = back(terminal, "operation enabled")
    check("a drive that is energised: all at once", "0x6502" in text and "-- line" not in text)
    terminal.type("disable\n")
    back(terminal, "disabled")
    terminal.type("monitor statusword --for 1s\n")
    shown_until(terminal, r"statusword")
    terminal.type("objects\n")
    shown_until(terminal, r"more line|waits|objects")
    terminal.type("\x03")
    back(terminal)
    leave(terminal)


def signals():
    terminal = prompt()
    terminal.type("objects\n")
    shown_until(terminal, PLACE)
    os.kill(terminal.pid, 15)
    check("SIGTERM ends it and the prompt", terminal.exit_code() == 130)


for each in (keys, buses_go_on, the_log_is_whole, all_at_once, signals):
    each()
for failure in failures:
    check(failure, False)
finish()
