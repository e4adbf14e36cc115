#!/usr/bin/env python3
"""A terminal that takes nothing (Ctrl-S, a connection that stalls) holds the prompt, and nothing else: SYNC goes on, what
drives send is heard, a drive that is energised is stopped at the end. What was to be shown comes afterwards.
usage: prompt_held_test.py SERVOCTL"""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import termios
import time

from pty_terminal import Terminal, expect, failures

servoctl = os.path.abspath(sys.argv[1])
bus = f"local:held-{os.getpid()}"
os.environ["SERVOCTL_PAGER"] = "cat"  # Long answers are held by the terminal alone.
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}


def run(*words):
    return subprocess.run([servoctl, *words, "-b", bus, "-d", "gsd600"], env=env, capture_output=True, text=True)


def state():
    answer = run("status", "-n", "1", "--json")
    return json.loads(answer.stdout)["result"][0]["state"] if answer.returncode == 0 else None


def syncs(folder, seconds=1):
    """So many are on the bus in this time, and another node restarts meanwhile."""
    trace = pathlib.Path(folder, "trace.log")
    watching = subprocess.Popen([servoctl, "nmt", "watch", "-n", "1", "--for", f"{seconds}s", "--trace", trace, "-b", bus], env=env,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    run("nmt", "reset", "-n", "2", "--yes")
    watching.wait()
    return sum(1 for line in trace.read_text().splitlines() if " 080#" in line)


class Held:
    """A prompt whose terminal can be held."""

    def __init__(self, folder, *words):
        self.terminal = Terminal(servoctl, "-b", bus, "-n", "1", "-d", "gsd600", *words, state=folder, size=(24, 80))
        self.terminal.see(r"> ")
        self.tty = os.open(os.readlink(f"/proc/{self.terminal.pid}/fd/0"), os.O_RDWR | os.O_NOCTTY)

    def hold(self, holds):
        termios.tcflow(self.tty, termios.TCOOFF if holds else termios.TCOON)


def sync_goes_on(folder):
    held = Held(folder)
    t = held.terminal
    t.type("sync start --period 10ms --yes\n")
    t.see(r"period \(ms\)[\s\S]*> ")
    held.hold(True)
    t.type("half a line")
    run("nmt", "reset", "-n", "2", "--yes")
    count = syncs(folder)
    if count < 60:
        failures.append(f"{count} SYNCs in a second while the prompt is held")
    held.hold(False)
    # What was typed meanwhile, and what was heard, are shown then.
    t.see(r"\* node 2: boot-up[\s\S]*> half a line")
    t.type("\x03")
    t.see(r"\^C[^>]*> ")
    # A line that shows more than the terminal takes.
    held.hold(True)
    t.type("param list\n")
    held.hold(False)
    t.see(r"Pn0\d+")
    held.hold(True)
    count = syncs(folder)
    if count < 60:
        failures.append(f"{count} SYNCs in a second while a line is held")
    held.hold(False)
    t.see(r"\* node 2: boot-up[\s\S]*> ")
    t.type("sync stop\n")
    t.see(r"mean[\s\S]*> ")
    t.type("exit\n")
    expect("exit code behind SYNC", 0, t.exit_code())
    os.close(held.tty)


def an_energised_drive(folder):
    held = Held(folder)
    t = held.terminal
    t.type("enable --yes\n")
    t.see(r"ENERGISED while servoctl runs[^>]*> ")
    held.hold(True)
    for _ in range(5):
        run("nmt", "reset", "-n", "2", "--yes")
    t.type("half a line")
    time.sleep(1)
    expect("the state of the drive while the terminal is held", "operation enabled", state())
    t.type("\x03")
    time.sleep(0.5)
    expect("the state of the drive behind Ctrl-C at a held terminal", "operation enabled", state())
    held.hold(False)
    t.see(r"\^C[\s\S]*> ")
    t.type("disable\n")
    t.see(r"disabled[^>]*> ")
    t.type("enable --yes\n")
    t.see(r"ENERGISED while servoctl runs[^>]*> ")
    held.hold(True)
    run("nmt", "reset", "-n", "2", "--yes")
    os.kill(t.pid, signal.SIGTERM)
    end = time.monotonic() + 3
    while state() != "switch on disabled" and time.monotonic() < end:
        time.sleep(0.05)
    expect("the state of the drive behind SIGTERM at a held terminal", "switch on disabled", state())
    held.hold(False)
    expect("exit code of SIGTERM", 130, t.exit_code())
    os.close(held.tty)


drives = subprocess.Popen([servoctl, "sim", "gsd600@1,gsd600@2", "--bus", bus], env=env, stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL)
try:
    for _ in range(200):
        if state() is not None:
            break
        time.sleep(0.05)
    for part in (sync_goes_on, an_energised_drive):
        with tempfile.TemporaryDirectory() as folder:
            part(folder)
finally:
    drives.terminate()
    drives.wait()
for failure in failures:
    print("FAILED", failure)
print(f"{len(failures)} failed")
sys.exit(1 if failures else 0)
