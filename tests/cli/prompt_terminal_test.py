#!/usr/bin/env python3
"""What the prompt and a live table leave of their terminal, and what goes where when the output is a file.
usage: prompt_terminal_test.py SERVOCTL"""
import json
import os
import shlex
import signal
import sys
import tempfile
import termios

from pty_terminal import Terminal, expect, failures

servoctl = sys.argv[1]
edited = termios.ICANON | termios.ECHO


def lines_are_edited(terminal):
    return termios.tcgetattr(terminal.fd)[3] & edited == edited


def two_signals_at_once(terminal):
    """Both are there before the program has looked at the first; answers what it writes then."""
    os.kill(terminal.pid, signal.SIGSTOP)
    os.waitid(os.P_PID, terminal.pid, os.WSTOPPED)
    while terminal.read(0.2) and terminal.text:
        terminal.text = ""
    for which in (signal.SIGINT, signal.SIGQUIT):
        os.kill(terminal.pid, which)
    os.kill(terminal.pid, signal.SIGCONT)
    terminal.read(5)
    return terminal.text


def ends_at_once(name, last_words, terminal):
    expect(f"{name}: lines are edited by the terminal before", False, lines_are_edited(terminal))
    keeper = os.open(os.readlink(f"/proc/{terminal.pid}/fd/0"), os.O_RDWR | os.O_NOCTTY)
    text = two_signals_at_once(terminal)
    expect(f"{name}: exit code", 130, terminal.exit_code())
    expect(f"{name}: lines are edited by the terminal after", True, lines_are_edited(terminal))
    if not text.endswith(last_words):
        failures.append(f"{name}: the terminal was left with {text[-60:]!r}")
    os.close(keeper)


def at_the_prompt(state):
    t = Terminal(servoctl, "-b", "sim:gsd600@1", state=state)
    t.see(r"> ")
    ends_at_once("at the prompt", "\x1b[?2004l", t)


def in_a_table(state):
    cabinet = os.path.join(state, "cabinet.toml")
    with open(cabinet, "w", encoding="utf-8") as file:
        file.write('[bus.main]\nurl = "sim:gsd600@1"\n[axis.lift]\nbus = "main"\nnode = 1\nfamily = "gsd600"\n')
    t = Terminal(servoctl, "cabinet", "show", "--cabinet", cabinet, "--watch", state=state, size=(24, 80))
    t.see(r"lift")
    ends_at_once("in a table", "\x1b[?1049l", t)


def into_a_file(state):
    file = os.path.join(state, "out.json")
    t = Terminal("/bin/sh", "-c", f"exec {shlex.quote(servoctl)} --json -b sim:gsd600@1 -d gsd600 -n 1 >{file}", state=state)
    t.see(r"> ")
    t.type("read 0x6061\n")
    t.see(r"> ")
    t.type("half a line\x03")
    t.see(r"\^C\s+servoctl")
    t.type("exit\n")
    expect("exit code with the output in a file", 0, t.exit_code())
    with open(file, encoding="utf-8") as written:
        documents = [json.loads(line) if line.startswith("{") else {"command": line} for line in written]
    expect("documents in the file", ["read"], [document.get("command") for document in documents])


for part in (at_the_prompt, in_a_table, into_a_file):
    with tempfile.TemporaryDirectory() as folder:
        part(folder)
for failure in failures:
    print("FAILED", failure)
print(f"{len(failures)} failed")
sys.exit(1 if failures else 0)
