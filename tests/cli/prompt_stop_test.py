#!/usr/bin/env python3
"""Ctrl-Z at a prompt, in a line and in a live table: the terminal is as it was before, and as it was there once the
program goes on. With a drive that has power it does not stop the program.
usage: prompt_stop_test.py SERVOCTL"""
import os
import select
import signal
import sys
import tempfile
import termios
import time

from pty_terminal import Terminal, expect, failures

servoctl = os.path.abspath(sys.argv[1])
# Stands for a shell that restores no terminal: it waits for its job, and goes on with it when told.
SHELL = r'''
import os, signal, sys
job = os.fork()
if job == 0:
    os.setpgid(0, 0)
    signal.signal(signal.SIGTTOU, signal.SIG_IGN)
    os.tcsetpgrp(0, os.getpgrp())
    signal.signal(signal.SIGTTOU, signal.SIG_DFL)
    os.execv(sys.argv[1], sys.argv[1:])
signal.signal(signal.SIGTTOU, signal.SIG_IGN)
signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGUSR1})  # One that comes before it is waited for is not lost.
while True:
    status = os.waitpid(job, os.WUNTRACED)[1]
    if not os.WIFSTOPPED(status):
        sys.exit(os.waitstatus_to_exitcode(status))
    os.tcsetpgrp(0, os.getpgrp())
    print("STOPPED", flush=True)
    signal.sigwait({signal.SIGUSR1})
    print("fg", flush=True)
    os.tcsetpgrp(0, job)
    os.killpg(job, signal.SIGCONT)
'''


class Job:
    def __init__(self, state, *words, size=(24, 80)):
        self.terminal = Terminal(sys.executable, "-c", SHELL, servoctl, *words, state=state, size=size)

    def is_cooked(self):
        return bool(termios.tcgetattr(self.terminal.fd)[3] & termios.ICANON)

    def stop(self, name):
        self.terminal.type("\x1a")
        self.terminal.see("STOPPED")
        expect(f"{name}: lines are edited by the terminal once it is stopped", True, self.is_cooked())

    def go_on(self):
        self.terminal.text = ""
        os.kill(self.terminal.pid, signal.SIGUSR1)


def raw_text(terminal):
    while terminal.read(0.3) and select.select([terminal.fd], [], [], 0.3)[0]:
        pass
    return terminal.text


def at_the_prompt(state):
    job = Job(state, "-b", "sim:gsd600@1", "-d", "gsd600", "-n", "1")
    t = job.terminal
    t.see(r"> ")
    t.type("param get Pn02")
    t.see(r"> param get Pn02")
    t.type("\x1a")
    text = raw_text(t)
    if "\x1b[?2004l" not in text or "STOPPED" not in text:
        failures.append(f"Ctrl-Z left pastes marked: {text!r}")
    expect("at the prompt: lines are edited by the terminal once it is stopped", True, job.is_cooked())
    job.go_on()
    t.see(r"fg\s[\s\S]*> param get Pn02")
    expect("lines are edited by the terminal once it goes on", False, job.is_cooked())
    t.type("14\n")
    t.see(r"Speed loop gain 1[\s\S]*> ")
    # In a line that moves nothing.
    t.type("monitor statusword --for 2s\n")
    t.see(r"statusword")
    job.stop("in a line")
    job.go_on()
    t.see(r"fg\s[\s\S]*\n(?:servoctl )?[^>\n]*> ")
    # With a drive that has power it is Ctrl-C.
    t.type("enable --yes\n")
    t.see(r"ENERGISED[\s\S]*> ")
    t.type("half\x1a")
    t.see(r"\^C[\s\S]*operation enabled[^>]*> ")
    t.type("disable\n")
    t.see(r"disabled[\s\S]*> ")
    t.type("jog 60rpm --turn 131072 --for 20s --yes\n")
    t.see(r"watchdog")
    time.sleep(1)
    t.type("\x1a")
    t.see(r"switch on disabled[\s\S]*> ")
    t.type("exit\n")
    expect("exit code", 0, t.exit_code())


def in_a_table(state):
    cabinet = os.path.join(state, "cabinet.toml")
    with open(cabinet, "w", encoding="utf-8") as file:
        file.write('[bus.main]\nurl = "sim:gsd600@1"\n[axis.lift]\nbus = "main"\nnode = 1\nfamily = "gsd600"\n')
    job = Job(state, "cabinet", "show", "--cabinet", cabinet, "--watch")
    t = job.terminal
    t.see(r"lift")
    t.type("\x1a")
    text = raw_text(t)
    if "\x1b[?1049l" not in text or "STOPPED" not in text:
        failures.append(f"Ctrl-Z left the other screen: {text[-200:]!r}")
    expect("in a table: lines are edited by the terminal once it is stopped", True, job.is_cooked())
    job.go_on()
    end = time.monotonic() + 5
    while "\x1b[?1049h" not in t.text and time.monotonic() < end:
        t.read(0.2)
    if "\x1b[?1049h" not in t.text:
        failures.append(f"the table went on at {t.text[-200:]!r}")
    t.type("q")
    expect("exit code of a table", 0, t.exit_code())


for part in (at_the_prompt, in_a_table):
    with tempfile.TemporaryDirectory() as folder:
        part(folder)
for failure in failures:
    print("FAILED", failure)
print(f"{len(failures)} failed")
sys.exit(1 if failures else 0)
