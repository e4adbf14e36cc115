#!/usr/bin/env python3
"""What is longer than the window opens in a pager: on a terminal, of a command of its own, as text, whole, and behind a bus that is
closed. Elsewhere nothing is paged; a pager that is left, or cannot be started, costs neither text nor exit code.
usage: pager_test.py SERVOCTL"""
import fcntl
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time

import pty_terminal
from checks import check, finish
from pty_terminal import Terminal

servoctl = sys.argv[1]
LONG = ("objects", "-d", "gsd600")
TIOCGPTN = 0x80045430  # Of Linux; the module does not name it.
SHORT = ("explain", "exit", "5")
folder = tempfile.mkdtemp()
for name in list(os.environ):
    if name.startswith("SERVOCTL_") or name in ("PAGER", "LESS", "LESSCHARSET", "MANPAGER", "NO_COLOR"):
        del os.environ[name]


def script(name, text):
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write("#!/bin/sh\n" + text)
    os.chmod(path, 0o755)
    return path


# Waits for a line of the keyboard, as a pager does.
pager = script("pager", 'echo "PAGER[$LESS $LESSCHARSET]"; cat; echo PAGED; read line </dev/tty\n')
other = script("other", "echo OTHER; cat\n")


class Window:
    """A command in a window of its own, under these variables."""

    def __init__(self, *words, size=(24, 80), term="xterm", program=servoctl, **variables):
        before = dict(os.environ)
        os.environ.update(variables)
        self.terminal = Terminal(program, *words, state=folder, size=size, term=term)
        os.environ.clear()
        os.environ.update(before)
        number = struct.unpack("i", fcntl.ioctl(self.terminal.fd, TIOCGPTN, b"\0" * 4))[0]
        self.tty = os.open(f"/dev/pts/{number}", os.O_RDWR | os.O_NOCTTY)

    def mode(self):
        return termios.tcgetattr(self.tty)

    def see(self, pattern):
        self.terminal.see(pattern)

    def end(self):
        """What is shown from here on, and the exit code."""
        code = self.terminal.exit_code()
        os.close(self.tty)
        while self.terminal.read(1):
            pass
        return self.terminal.text.replace("\r", ""), code


def shown(*words, **more):
    return Window(*words, **more).end()


def plain(*words):
    return subprocess.run([servoctl, *words], capture_output=True, text=True, env=dict(os.environ, LANG="C.UTF-8")).stdout


def it_is_paged():
    window = Window(*LONG, SERVOCTL_PAGER=pager, PAGER=other)
    window.see(r"PAGER\[FRX utf-8\]")
    window.see("PAGED")
    time.sleep(0.2)
    check("the program waits for the pager", os.waitpid(window.terminal.pid, os.WNOHANG)[0] == 0)
    window.terminal.type("\n")
    check("a pager that ends well is a command that ends well", window.end()[1] == 0)
    text, _ = shown(*LONG, PAGER=other)
    lines = [line for line in text.split("OTHER\n")[-1].splitlines() if line]
    check("$PAGER is taken where $SERVOCTL_PAGER is not set", "OTHER\n" in text)
    # A pipe and a terminal of 80 columns have other widths: the rows are the same.
    check("the pager gets all of it", len(lines) >= len(plain(*LONG).splitlines()) and len(lines) > 100)
    text, _ = shown(*LONG, PAGER=other, LESS="S", SERVOCTL_PAGER=f'echo "[$LESS]"; {other}')
    check("what the user says of less stays, and a shell reads the pager", "[S]\n" in text and "OTHER" in text)
    check("help is paged", "OTHER" in shown("help", "read", PAGER=other)[0])
    check("--help is paged", "OTHER" in shown("read", "--help", PAGER=other)[0])


def it_is_not_paged():
    for why, words, more in (
            ("what fits the window", SHORT, {}),
            ("what fits a window of 2000 lines", LONG, {"size": (2000, 80)}),
            ("a window without a size", LONG, {"size": (0, 0)}),
            ("JSON", LONG + ("--json",), {}),
            ("documents of samples", LONG + ("-o", "jsonl"), {}),
            ("--no-pager", LONG + ("--no-pager",), {}),
            ("a terminal without a cursor", LONG, {"term": "dumb"}),
            ("an empty $SERVOCTL_PAGER", LONG, {"SERVOCTL_PAGER": ""}),
            ("$SERVOCTL_PAGER=cat", LONG, {"SERVOCTL_PAGER": " cat "}),
            ("output in a pipe", ("-c", f"{servoctl} objects -d gsd600 | cat"), {"program": "/bin/sh"}),
            ("input from a pipe", ("-c", f"echo | {servoctl} objects -d gsd600"), {"program": "/bin/sh"}),
            ("lines from a pipe", ("-c", f"echo objects -d gsd600 | {servoctl}"), {"program": "/bin/sh"}),
            ("a batch file", ("run", batch), {}),
            ("samples and their summary", ("watch", "0x6041", "--every", "10ms", "--for", "400ms", "-b",
                                           "sim:gsd600@1", "-n", "1"), {"size": (4, 80)}),
    ):
        text, code = shown(*words, **{"PAGER": other, **more})
        check(f"{why} is not paged ({code})", "OTHER" not in text and code == 0 and len(text) > 50)
    text, code = shown(*LONG, PATH=folder)
    check("without less nothing is paged", "statusword" in text.lower() and code == 0)


def no_program_at_the_prompt():
    """The prompt reads long answers itself (prompt_windows_test.py): the bus goes on meanwhile."""
    window = Window("-d", "gsd600", PAGER=other)
    window.see("servoctl.*> ")
    window.terminal.type("objects\r")
    window.see("-- line 23 of")
    window.terminal.type("q")
    window.see("servoctl.*> ")
    window.terminal.type("exit\r")
    text, code = window.end()
    check("the prompt ends well", code == 0)
    check("no program shows what the prompt answers", "OTHER" not in text)


def a_pager_that_is_left():
    many = ("objects", "-d", "gsd600", "--lang", "zh")
    check("there is more than a pipe holds", len(plain("man")) > 65536)
    text, code = shown("man", PATH=folder + ":/nowhere", PAGER="read line; echo \"LEFT $line\"")
    check(f"a pager that is left early is no error ({code}): {text[-200:]!r}", code == 0 and "LEFT" in text and
          "error" not in text[-200:])
    text, code = shown(*many, PAGER="kill -9 $$")
    check("a pager that is killed is no error", code == 0 and "statusword" not in text.lower())


def a_pager_that_fails():
    for name in ("/nonexistent/pager", folder, "exit 1"):
        text, code = shown(*LONG, PAGER=name)
        check(f"{name}: the text is written as it is ({code})", code == 0 and "statusword" in text.lower())
        check(f"{name}: it is said", "notice: the pager failed" in text)
    # As some launchers leave it: how the pager ended would not be told.
    launcher = "import os, signal, sys; signal.signal(signal.SIGCHLD, signal.SIG_IGN); os.execv(sys.argv[1], sys.argv[1:])"
    text, code = shown("-c", launcher, os.path.abspath(servoctl), *LONG, program=sys.executable, PAGER="exit 1")
    check(f"with SIGCHLD ignored the text is written as well ({code})", code == 0 and "statusword" in text.lower() and
          "notice: the pager failed" in text)
    text, _ = shown(*LONG, "--lang", "zh", PAGER="exit 1")
    check("it is said in Chinese", "提示：分页程序未能显示" in text)


def the_exit_code():
    words = ("read", "0x60*", "-n", "1,9", "-d", "gsd600", "-b", "sim:gsd600@1", "--timeout", "50ms", "--retries", "0")
    text, code = shown(*words, PAGER=other + "; echo BEHIND")
    check(f"the exit code is that of the command ({code})", code == 4)
    check("the error stands behind the pager", re.search(r"OTHER[\s\S]*BEHIND[\s\S]*error: ", text))


def the_bus_is_closed():
    bus = f"local:pager-{os.getpid()}"
    drive = subprocess.Popen([servoctl, "sim", "gsd600@1", "-b", bus], stdout=subprocess.DEVNULL)
    try:
        window = Window("read", "0x60*", "-n", "1", "-d", "gsd600", "-b", bus, "--timeout", "5s", PAGER=pager)
        window.see("PAGED")
        files = f"/proc/{window.terminal.pid}/fd"
        open_now = [os.readlink(f"{files}/{one}") for one in os.listdir(files)]
        check(f"no bus is open while it is read: {open_now}", not any("socket:" in one for one in open_now))
        window.terminal.type("\n")
        check("a drive that was read is read", window.end()[1] == 0)
    finally:
        drive.kill()
        drive.wait()


def keys_and_signals():
    # It is not ended by Ctrl-C, and changes the mode of the terminal.
    rude = script("rude", "trap 'echo CAUGHT' INT\nstty -echo -icanon </dev/tty\ncat\necho READY\n"
                          "until read line </dev/tty; do :; done\necho WENT ON\n")
    window = Window(*LONG, PAGER=rude)
    before = window.mode()
    window.see("READY")
    check("the pager changes the mode", window.mode() != before)
    window.terminal.type("\x03")
    window.see("CAUGHT")
    window.terminal.type("\x03\x03")
    time.sleep(0.3)
    window.terminal.type("\n")
    window.see("WENT ON")
    end = time.monotonic() + 10
    while os.path.exists(f"/proc/{window.terminal.pid}/exe") and window.mode() != before and time.monotonic() < end:
        window.terminal.read(0.05)
    check("the terminal is as it was", window.mode() == before)
    check("Ctrl-C is for the pager", window.end()[1] == 0)
    window = Window(*LONG, PAGER=pager)
    window.see("PAGED")
    os.kill(window.terminal.pid, signal.SIGTERM)
    check("a signal that ends the program ends the pager", window.end()[1] == 0)


def resize(window, rows, columns):
    fcntl.ioctl(window.terminal.fd, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))


def less_itself():
    if not shutil.which("less"):
        print("less is not here: not tested")
        return
    window = Window(*LONG)
    before = window.mode()
    window.see(r"\n:")
    resize(window, 40, 120)
    window.terminal.type("r")
    window.see(r"\n:")
    window.terminal.type(" ")
    window.see(r"\n:")
    window.terminal.type("\x03")
    for _ in range(5):  # Ctrl-C throws away what is typed too soon behind it.
        time.sleep(0.5)
        try:
            window.terminal.type("q")
        except OSError:
            break
    _, code = window.end()
    check(f"less, another size, Ctrl-C and q ({code})", code == 0)
    window = Window(*LONG)
    window.see(r"\n:")
    window.terminal.type("q")
    end = time.monotonic() + 10
    while window.mode() != before and time.monotonic() < end:
        window.terminal.read(0.05)
    check("less leaves the terminal as it was", window.mode() == before)
    check("q is no error", window.end()[1] == 0)
    window = Window(*LONG, "--color", "always", "--lang", "zh", LANG="C")
    window.see("[一-龥]")
    window.terminal.type("q")
    check("less shows Chinese", window.end()[1] == 0)


def the_manual():
    source = ".TH SERVOCTL 1"
    check("in a pipe it is the source", source in plain("man"))
    check("with --no-pager it is the source", source in shown("man", "--no-pager")[0])
    if not shutil.which("man"):
        print("man is not here: not tested")
        return
    text, code = shown("man", MANPAGER="cat")
    text = re.sub(r"\x1b\[[0-9;]*m|.\x08", "", text)  # groff 1.23 underlines its name.
    check(f"on a terminal it is a page ({code})", code == 0 and "SERVOCTL(1)" in text and source not in text)
    fake = os.path.join(folder, "man")
    script("man", "exit 5\n")
    text, code = shown("man", PATH=folder + ":" + os.environ["PATH"], PAGER=other)
    os.remove(fake)
    check(f"where man fails it is the source ({code})", code == 0 and source in text)


batch = os.path.join(folder, "lines")
with open(batch, "w", encoding="utf-8") as lines:
    lines.write("objects -d gsd600\n")
try:
    for test in (it_is_paged, it_is_not_paged, no_program_at_the_prompt, a_pager_that_is_left, a_pager_that_fails, the_exit_code,
                 the_bus_is_closed, keys_and_signals, less_itself, the_manual):
        test()
    for failure in pty_terminal.failures:
        check(failure, False)
finally:
    shutil.rmtree(folder)
finish()
