#!/usr/bin/env python3
"""A terminal whose locale has no UTF-8 gets ASCII from what moves as well: live tables, with their plots and what is cut in them,
and the prompt, with names, candidates and what was typed. In Chinese it gets UTF-8: who asks for Chinese can read it.
usage: ascii_live_test.py SERVOCTL"""
import os
import pty
import re
import select
import signal
import struct
import sys
import tempfile
import termios
import time
import fcntl

import checks
from checks import check

servoctl = os.path.abspath(sys.argv[1])
CABINET = ('[bus.main]\nurl = "sim:gsd600@1,gsd600@2?fault=0x2310@0s"\n[axis."送料轴"]\nbus = "main"\nnode = 1\nfamily = "gsd600"\n'
           '[axis.lift]\nbus = "main"\nnode = 2\nfamily = "gsd600"\n')


def on_terminal(words, keys, columns=80, lang="C"):
    """All that came in the time of the keys: (text, seconds before it is typed)."""
    pid, master = pty.fork()
    if pid == 0:
        fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        env = {k: v for k, v in os.environ.items() if not k.startswith(("SERVOCTL_", "XDG_", "LC_"))}
        env.update(LANG=lang, TERM="xterm", NO_COLOR="1", HOME=folder, XDG_STATE_HOME=folder)
        os.chdir(folder)
        os.execve(servoctl, [servoctl, *words], env)
    data = b""
    for key, pause in [*keys, (None, 5)]:
        end = time.monotonic() + pause
        while (left := end - time.monotonic()) > 0:
            if not select.select([master], [], [], left)[0]:
                continue
            try:
                part = os.read(master, 65536)
            except OSError:
                part = b""
            if not part:
                break
            data += part
        if key is not None:
            os.write(master, key)
    os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    os.close(master)
    return data


def is_ascii(name, words, keys, shows, columns=80):
    data = on_terminal(words, keys, columns)
    text = data.decode("utf-8", errors="replace")
    others = sorted({c for c in text if ord(c) > 0x7F})
    check(f"{name} is ASCII alone, not {others}", not others)
    for pattern in shows:
        check(f"{name} shows {pattern!r}: {text[-500:]!r}", re.search(pattern, text))
    wide = [line for line in re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", text).splitlines() if len(line.rstrip()) > columns]
    check(f"{name} fits the window: {wide}", not wide)


def live_tables():
    there = ["-b", "sim:gsd600@1", "-n", "1", "-d", "gsd600"]
    quit_soon = [(b"q", 2)]
    is_ascii("watch", ["watch", "statusword", "position_actual_value", "--every", "20ms", "--plot", *there], quit_soon,
             [r"\+\+\+", "q: quit"])
    is_ascii("a watch that is cut", ["watch", "position_actual_value", *there], quit_soon, [r"\.\.\."], columns=30)
    is_ascii("nmt watch", ["nmt", "watch", *there], [(b"\x03", 2)], ["node"])
    is_ascii("monitor", ["monitor", "--table", "-b", "sim:gsd600@1"], [(b"q", 2)], ["q: quit"])
    is_ascii("pdo watch", ["pdo", "watch", *there], quit_soon, ["q: quit"])
    is_ascii("cabinet show", ["cabinet", "show", "--watch"], [(b"q", 3)], [r"\\u9001", "lift", "0x2310", "q: quit"])


def prompt():
    is_ascii("the prompt", [], [(b"bus main\r", 2), (b"use lift\r", 1), ("use 送料轴\r".encode(), 1), (b"read pos\t\t", 1.5), (b"\x15", 0.5),
                                (b"exit\r", 1)], [r"\\u9001\\u6599\\u8F74", "position"])


def faults_of_axes():
    """The fault of an axis stands whole where there is room for it."""
    whole = on_terminal(["cabinet", "show"], [], 200).decode()
    fault = re.search(r"0x2310 [^\r\n]*?(?=  )", whole)
    check(f"the fault stands whole: {whole!r}", fault and len(fault[0]) > 7 and "..." not in fault[0])
    is_ascii("cabinet show", ["cabinet", "show"], [], ["0x2310"])


def chinese():
    data = on_terminal(["cabinet", "show", "--watch", "--lang", "zh"], [(b"q", 3)]).decode()
    check(f"Chinese stays Chinese: {data[-300:]!r}", "送料轴" in data and "故障" in data)


with tempfile.TemporaryDirectory() as folder:
    with open(os.path.join(folder, "cabinet.toml"), "w", encoding="utf-8") as out:
        out.write(CABINET)
    live_tables()
    prompt()
    faults_of_axes()
    chinese()
checks.finish()
