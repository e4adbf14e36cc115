#!/usr/bin/env python3
"""Drives the prompt on a pseudo-terminal as a person would.

usage: prompt_test.py SERVOCTL
"""
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

from pty_terminal import Terminal, expect, failures

servoctl = sys.argv[1]
with tempfile.TemporaryDirectory() as state:
    t = Terminal(servoctl, "--bus", "sim:gsd600@1", state=state)
    t.see(r"servoctl sim:gsd600@1> ")
    t.type("use 1\n")
    t.see(r"node 1 \[pre-operational\]> ")
    t.type("drive gs\t\n")
    t.see(r"gsd600 \[pre-operational\]> ")
    t.type("read statusw\t\n")
    t.see(r"0x0270")
    t.type("par\t")
    t.see(r"am $")
    t.type("ge\tPn021")
    t.see(r"t Pn021")
    t.type("4\n")
    t.see(r"60 Hz")
    t.type("param set Pn0214 4500000\n")
    t.see(r"(does not fit|out of range)[^>]*> ")
    t.type("nmt reset\n")
    t.see(r"\[y/N\] ")
    t.type("n\n")
    t.see(r"not confirmed; nothing was changed[^>]*> ")
    t.type("nmt reset --wait\n")
    t.see(r"\[y/N\] ")
    t.type("y\n")
    t.see(r"reset +yes[^>]*> ")
    t.type("half a line\x03")
    t.see(r"\^C")
    t.type("read 0x6041 -n 9 --timeout 60s\n")
    time.sleep(0.5)
    t.type("\x03")
    t.see(r"interrupted", 5)
    t.see(r"> ")
    batch = os.path.join(state, "batch")
    with open(batch, "w", encoding="utf-8") as file:
        file.write('pause "take the load off"\nread 0x6061\n')
    t.type(f"run {batch}\n")
    t.see(r"take the load off \[Enter\] ")
    t.type("\n")
    t.see(r"0x6061:0")
    t.see(r"2 of 2 lines done[^>]*> ")
    t.type(f"run {batch}\n")
    t.see(r"\[Enter\] ")
    t.type("\x03")
    t.see(r"batch:1: interrupted")
    t.see(r"0 of 2 lines done, 1 failed, 1 not run")
    t.see(r"> ")
    t.type("exit\n")
    expect("exit code of exit", 0, t.exit_code())

    # Chinese is typed, mended by a backspace over a whole character, and found, whatever the locale is.
    for lang in ("C.UTF-8", "C", "zh_CN.GB2312"):
        t = Terminal(servoctl, "--drive", "gsd600", "--lang", "zh", state=state, lang=lang)
        t.see(r"> ")
        t.type("param search 速度环增益坏\x7f 1\n")
        t.see(r"Pn0214 +速度环增益 1")
        t.type("exit\n")
        expect(f"exit code of exit in {lang}", 0, t.exit_code())

    # Chinese is found in the history, of this run and of the one before; a line is mended in its middle; Tab behind Chinese.
    t = Terminal(servoctl, "--drive", "gsd600", "--lang", "zh", state=state)
    t.see(r"> ")
    t.type("\x12速度环\r")
    t.see(r"Pn0214 +速度环增益 1")
    t.see(r"> ")
    t.type("param search 度环\x1b[D\x1b[D速\r")
    t.see(r"Pn0214 +速度环增益 1")
    t.see(r"> ")
    t.type("param get 速度环 Pn021\t")
    t.see(r"Pn0214 +速度环增益 1")
    t.type("\x03")
    t.see(r"\^C")
    # What is pasted does not run: it waits for Enter, line by line, and Ctrl-C drops it.
    t.see(r"> ")
    t.type("\x1b[200~param explain Pn0214\nnonsense\n\x1b[201~")
    t.see(r"还有 1 行等待：Enter 运行这一行，Ctrl-C 全部丢弃")
    t.type("\r")
    t.see(r"对象")
    t.see(r"> nonsense")
    t.type("\x03")
    t.see(r"\^C\s+servoctl gsd600> ")
    t.type("exit\n")
    expect("exit code of exit after Chinese", 0, t.exit_code())

    # State and fault stand in the prompt, as they were heard, and nothing is sent for it.
    trace = os.path.join(state, "trace")
    t = Terminal(servoctl, "--bus", "sim:gsd600@1?fault=0xFF00@2s", "-n", "1", "-d", "gsd600", "--trace", trace, state=state)
    t.see(r"\[pre-operational\]> ")
    t.type("read statusword\n")
    t.see(r"\[switch on disabled\]> ")
    t.see(r"\x1b\[1;31mservoctl [^>]*\[EMCY 0xFF00\]> \x1b\[0m", colours=True)
    t.type("read statusword\n")
    t.see(r"\[fault[a-z ]*, EMCY 0xFF00\]> ")
    t.see(r"\[fault[a-z ]*, EMCY 0xFF00\?\]> ")
    t.type("exit\n")
    expect("exit code of exit in a fault", 0, t.exit_code())
    with open(trace, encoding="utf-8") as file:
        sent = [line for line in file if re.search(r" 601#", line)]
    expect("requests of two reads", 2, len([line for line in sent if "#404160" in line]))

    # History is kept, an emergency is told above the line that is being typed, and the line is kept.
    t = Terminal(servoctl, "--bus", "sim:gsd600@1?fault=0xFF00@1s", state=state)
    t.see(r"> ")
    t.type("read 0x60")
    t.see(r"\* node 1: EMCY 0xFF00")
    t.see(r"read 0x60")
    t.type("41 -n 1\n")
    t.see(r"0x023")
    t.type("\x1b[A\x1b[A")
    t.see(r"exit")
    t.type("\x03")
    t.see(r"\^C[^>]*> ")  # Behind a line that is still there Ctrl-D does nothing.
    t.type("\x04")
    expect("exit code of Ctrl-D", 0, t.exit_code())

    # In the window it is broken at a blank, and what goes on stands below where its text began.
    t = Terminal(servoctl, "--bus", "sim:gsd600@1?fault=0xFF00@1s", "-n", "1", "-d", "gsd600", state=state, size=(24, 80))
    t.see(r"\* node 1: EMCY 0xFF00 [^\r\n]{1,59}[^\s]\r?\n  [^\s][^\r\n]*\r?\n")
    t.type("\x04")
    t.exit_code()

    t = Terminal(servoctl, "--bus", "can77", state=state)
    t.see(r"error: .*can77")
    expect("exit code without a bus", 3, t.exit_code())

    t = Terminal(servoctl, "--bus", "sim:gsd600@1", state=state)
    t.see(r"> ")
    os.kill(t.pid, signal.SIGTERM)
    expect("exit code of SIGTERM", 130, t.exit_code())

    # What was enabled at a prompt has no power when it ends, also when its terminal is lost.
    cell = f"local:prompt-{os.getpid()}"
    sim = subprocess.Popen([servoctl, "sim", "gsd600@1", "--bus", cell], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for ending in ("exit", "hang up"):
        t = Terminal(servoctl, "--bus", cell, "-n", "1", "-d", "gsd600", state=state)
        t.see(r"> ")
        t.type("enable\n")
        t.see(r"\[y/N\] ")
        t.type("y\n")
        t.see(r"ENERGISED while servoctl runs[^>]*> ")
        if ending == "exit":
            t.type("exit\n")
            t.see(r"node 1 was still energised; it has been stopped and disabled")
        else:
            os.close(t.fd)
        end = time.monotonic() + 10
        energised = None
        while energised is not False and time.monotonic() < end:
            status = subprocess.run([servoctl, "status", "-n", "1", "--bus", cell, "--json"], capture_output=True, text=True)
            energised = json.loads(status.stdout)["result"][0]["energised"] if status.returncode == 0 else None
        expect(f"energised after {ending}", False, energised)
    sim.terminate()
    sim.wait()

for failure in failures:
    print("FAILED", failure)
print(f"{len(failures)} failed")
sys.exit(1 if failures else 0)
