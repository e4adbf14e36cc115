#!/usr/bin/env python3
"""What is typed while a motor turns, or pasted behind a line that moves it, starts nothing by itself.
usage: prompt_ahead_test.py SERVOCTL"""
import sys
import tempfile
import time

from pty_terminal import Terminal, failures

servoctl = sys.argv[1]
bus = ["-b", "sim:gsd600@1", "-d", "gsd600", "-n", "1"]
jog = "jog 60rpm --turn 131072 --for 1s -y"


def starts_again(name, terminal):
    """Whether another motion runs within the time of one."""
    end = time.monotonic() + 3
    before = len(failures)
    terminal.text = ""
    while time.monotonic() < end:
        terminal.read(0.1)
    if "motion" in terminal.text or "result" in terminal.text:
        failures.append(f"{name}: a motion was started: {terminal.text[-400:]!r}")
    return len(failures) > before


def the_line_before_and_enter(state):
    t = Terminal(servoctl, *bus, state=state)
    t.see(r"> ")
    t.type(jog + "\n")
    t.see(r"preflight|watchdog")
    time.sleep(0.4)
    t.type("\x1b[A\r")
    t.see(r"drive +switch on disabled.*?\n[^>]*> ")
    starts_again("Up and Enter during a motion", t)
    t.type("\x03")
    t.see(r"\^C[^>]*> ")
    t.type("exit\n")
    t.exit_code()


def enter_of_a_paste(state):
    t = Terminal(servoctl, *bus, state=state)
    t.see(r"> ")
    t.type(f"\x1b[200~{jog}\r{jog}\x1b[201~")
    t.see(r"1 more pasted line waits")
    t.type("\r")
    t.see(r"watchdog")
    time.sleep(0.4)
    t.type("\r")
    t.see(r"drive +switch on disabled.*?\n[^>]*> ")
    starts_again("Enter during a motion with a pasted line behind it", t)
    t.type("\x03")
    t.see(r"\^C[^>]*> ")
    t.type("exit\n")
    t.exit_code()


for part in (the_line_before_and_enter, enter_of_a_paste):
    with tempfile.TemporaryDirectory() as folder:
        part(folder)
for failure in failures:
    print("FAILED", failure)
print(f"{len(failures)} failed")
sys.exit(1 if failures else 0)
