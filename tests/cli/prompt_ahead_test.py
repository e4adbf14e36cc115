#!/usr/bin/env python3
"""What is typed while a motor turns, or pasted behind a line that moves it, starts nothing by itself.
usage: prompt_ahead_test.py SERVOCTL"""
import sys
import tempfile
import time

from pty_terminal import Terminal, expect, failures

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
    t.see(r"drive +switch on disabled[\s\S]*?\n\* what was typed meanwhile was dropped: nothing starts by itself behind a line that may move a motor[^>]*> ")
    starts_again("Up and Enter during a motion", t)
    t.type("\x03")
    t.see(r"\^C[^>]*> ")
    t.type("exit\n")
    t.exit_code()


def enter_of_a_paste(state):
    t = Terminal(servoctl, *bus, state=state)
    t.see(r"> ")
    t.type(f"\x1b[200~{jog}\r{jog}\x1b[201~")
    t.see(r"1 more line waits")
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


def busy(terminal):
    """A line that moves nothing runs for a second."""
    terminal.see(r"> ")
    terminal.type("monitor statusword --for 1s\n")
    terminal.see(r"statusword")
    time.sleep(0.3)


def nothing_ran(name, terminal, waiting):
    terminal.see(rf"{waiting}: Enter runs this one, Ctrl-C drops all")
    starts_again(name, terminal)
    terminal.type("\x03")
    terminal.see(r"\^C[^>]*> ")
    terminal.type("read 0x6061\n")
    terminal.see(r"0x6061[^>]*> ")
    terminal.type("exit\n")
    expect(f"{name}: exit code", 0, terminal.exit_code())


def lines_behind_another(state):
    """Of several lines that come while another runs none is started; with marks of the terminal, and without."""
    for name, text, waiting in (
            ("two lines", f"{jog}\n{jog}\n", "1 more line waits"),
            ("a line and the beginning of another", f"{jog}\n{jog}", "1 more line waits"),
            ("three lines", f"read 0x6061\n{jog}\n{jog}\n", "2 more lines wait"),
            ("a marked paste", f"\x1b[200~{jog}\r{jog}\r\x1b[201~", "1 more line waits")):
        t = Terminal(servoctl, *bus, state=state)
        busy(t)
        t.type(text)
        nothing_ran(f"{name} behind a line that runs", t, waiting)


def one_line_typed_ahead(state):
    t = Terminal(servoctl, *bus, state=state)
    busy(t)
    t.type("read 0x6061\n")
    t.see(r"0x6061[^>]*> ")
    t.type("exit\n")
    expect("exit code of a line typed ahead", 0, t.exit_code())


def paste_without_marks(state):
    """Of a terminal that does not mark them several lines at once are a paste; Enter runs one after the other."""
    for term in ("xterm", "dumb"):
        t = Terminal(servoctl, *bus, state=state, term=term)
        t.see(r"> ")
        t.type(f"read 0x6061\n{jog}\n{jog}\n")
        nothing_ran(f"lines at once at a {term}", t, "2 more lines wait")
    t = Terminal(servoctl, *bus, state=state, term="dumb")
    t.see(r"> ")
    t.type("read 0x6061\nread 0x1000\n")
    t.see(r"1 more line waits[^>]*> read 0x6061")
    t.type("\n")
    t.see(r"0x6061:0 +Modes[^>]*> read 0x1000")
    t.type("\n")
    t.see(r"0x1000:0 +Device[^>]*> ")
    t.type("exit\n")
    expect("exit code at a dumb terminal", 0, t.exit_code())


for part in (the_line_before_and_enter, enter_of_a_paste, lines_behind_another, one_line_typed_ahead, paste_without_marks):
    with tempfile.TemporaryDirectory() as folder:
        part(folder)
for failure in failures:
    print("FAILED", failure)
print(f"{len(failures)} failed")
sys.exit(1 if failures else 0)
