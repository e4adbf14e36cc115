#!/usr/bin/env python3
"""A prompt on a terminal loses its bus: it says so once, at once and while nobody types, and its next line works.
Runs inside with-vcan.sh, with can0 and can1 on one bus. usage: prompt_trouble_test.py SERVOCTL"""
import os
import re
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from pty_terminal import Terminal, expect, failures  # noqa: E402

servoctl = os.path.abspath(sys.argv[1])
if os.environ.get("VCAN_GUEST") != "uml":
    print("skipped: there is no can0 and can1 with errors to be injected")
    sys.exit(0)
LINE = subprocess.run(["pidof", "slcan-pair"], capture_output=True, text=True).stdout.strip()


def run(*words):
    return subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode


def inject(text):
    with open("/dev/can0.inject", "w") as file:
        file.write(text + "\r")


def fill():
    """The line is held, and the queue of can0 takes no more."""
    run("kill", "-STOP", LINE)
    while run("cansend", "can0", "7F0#11") == 0:
        pass


def bounce():
    run("ip", "link", "set", "can0", "down")
    run("ip", "link", "set", "can0", "up")


# What happens to can0, how it is mended, and what is told of it while nobody types (None: nothing; the next line tells it).
TROUBLES = {
    "down": (lambda: run("ip", "link", "set", "can0", "down"), lambda: run("ip", "link", "set", "can0", "up"), r"can0 went down"),
    "bus-off": (lambda: inject("sb000256"), bounce, r"can0: bus-off|can0 is off the bus"),
    "queue": (fill, lambda: run("kill", "-CONT", LINE), None),
}


def told_in(text):
    return len(re.findall(r"can0 (?:went down|is off the bus|is down)|can0: bus-off|transmit queue of can0", text))


def lose_the_bus(how, lang, works):
    lose, mend, told = TROUBLES[how]
    with tempfile.TemporaryDirectory() as state:
        t = Terminal(servoctl, "-b", "can0", "-n", "1", "-d", "gsd600", *(["--lang", lang] if lang else []), state=state, size=(40, 200))
        t.see(r"> ")
        t.type("read 0x1000\n")
        t.see(works)
        t.see(r"> ")
        # Half a line stands there when it happens, and still stands there behind what is told.
        if told:
            t.type("read 0x")
            t.see(r"read 0x")
            begun = time.monotonic()
            lose()
            t.see(told if not lang else "can0", seconds=5)
            expect(f"{how}: told within a second", True, time.monotonic() - begun < 1.5)
            end = time.monotonic() + 1.5
            while time.monotonic() < end:
                t.read(0.1)
            expect(f"{how}: told once: {t.text!r}", 0, told_in(t.text))
            mend()
            time.sleep(0.3)
            t.type("1000\n")
        else:
            lose()
            t.type("read 0x1000\n")
            t.see(r"transmit queue of can0 remains full[\s\S]*txqueuelen[\s\S]*> ", seconds=5)
            expect(f"{how}: told once: {t.text!r}", 0, told_in(t.text))
            mend()
            time.sleep(0.3)
            t.type("read 0x1000\n")
        t.see(works)
        t.see(r"> ")
        # A line that is under way ends, and the prompt goes on.
        t.type("watch 0x6041 --for 20s --changes\n" if how == "queue" else "nmt watch --for 20s\n")
        time.sleep(0.7)
        t.text = ""
        lose()
        t.see((told or r"transmit queue of can0 remains full") if not lang else "can0", seconds=5)
        t.see(r"> ")
        mend()
        time.sleep(0.3)
        t.type("read 0x1000\n")
        t.see(works)
        t.see(r"> ")
        t.type("exit\n")
        t.exit_code()


sim = subprocess.Popen([servoctl, "sim", "gsd600@1", "--bus", "can1"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
try:
    for _ in range(50):
        if run(servoctl, "read", "0x1000", "-n", "1", "--bus", "can0", "--timeout", "100ms") == 0:
            break
        time.sleep(0.1)
    for how in TROUBLES:
        lose_the_bus(how, None, r"0x00020192")
    lose_the_bus("down", "zh", r"0x00020192")
finally:
    run("kill", "-CONT", LINE)
    sim.terminate()
for failure in failures:
    print("FAILED", failure)
print("failures:", len(failures))
sys.exit(1 if failures else 0)
