#!/usr/bin/env python3
"""Tab in the real bash, zsh and fish: what stands in the line then is run, and what is listed is read.
usage: completion_test.py SERVOCTL SOURCE_DIR"""
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

from pty_terminal import Terminal, failures

servoctl, source = os.path.realpath(sys.argv[1]), os.path.realpath(sys.argv[2])
work = tempfile.mkdtemp()
completions = f"{source}/completions"
bash_helpers = "/usr/share/bash-completion/bash_completion"
here = f"{work}/here"

CABINET = """[bus.main]
url = "sim:gsd600@1,gsd600@2"
[axis.feeder]
bus = "main"
node = 1
family = "gsd600"
[axis.lift]
bus = "main"
node = 2
family = "gsd600"
"""

# What is typed behind `servoctl`, Tab as `~`, and the words that the program is started with then.
LINES = [
    ("para~li~", "param|list"),
    ("help par~ge~", "help|param|get"),
    ("bus st~", "bus|status"),
    ("-d gs~param get pn0214~", "-d|gsd600|param|get|Pn0214"),
    ("read --ty~u1~ 0x6041", "read|--type|u16|0x6041"),
    ("--lang=z~ scan", "--lang=zh|scan"),
    ("-dgs~ objects", "-dgsd600|objects"),
    # `=`, `:`, `@` and `?` in words
    ("-d gsd600 param set Pn0214=40H~", "-d|gsd600|param|set|Pn0214=40Hz"),
    ("-d gsd600 param set Pn0000=5 Pn0214=40H~", "-d|gsd600|param|set|Pn0000=5|Pn0214=40Hz"),
    ("-b sim:gs~1 -n 1 param get pn0214~", "-b|sim:gsd600@1|-n|1|param|get|Pn0214"),
    ("scan --bus=coe:si~sv~1", "scan|--bus=coe:sim:sv2@1"),
    ("scan -b 'sim:gsd600@1?st~mem~", "scan|-b|sim:gsd600@1?state=memory.bin"),
    ("scan -b sim:gsd600@1~st~mem~", "scan|-b|sim:gsd600@1?state=memory.bin"),
    ("scan -b replay:mem~", "scan|-b|replay:memory.bin"),
    # quotes and blanks
    ("-d gsd600 param set 'Pn0000=Position m~", "-d|gsd600|param|set|Pn0000=Position mode"),
    ('-d gsd600 param set "Pn0000=Position m~', "-d|gsd600|param|set|Pn0000=Position mode"),
    ("-d gsd600 param set Pn0000=Position\\ m~", "-d|gsd600|param|set|Pn0000=Position mode"),
    ("-d gsd600 param set Pn0000='Position m~", "-d|gsd600|param|set|Pn0000=Position mode"),
    ("-d gsd600 param set Pn0000 Position\\ m~", "-d|gsd600|param|set|Pn0000|Position mode"),
    ("-d 'gsd600' param get 'pn0214~", "-d|gsd600|param|get|Pn0214"),
    ("-d my\\ sh~ objects", "-d|my sheet.eds|objects"),
    ("-d 'my sh~ objects", "-d|my sheet.eds|objects"),
    ("-d evil/~ objects", "-d|evil/$(touch owned)'\".eds|objects"),
    # variables of the shell: the word is looked at with its value, and stays as it was typed
    ("-b $CELL -n 1 param get pn0214~", "-b|sim:gsd600@1|-n|1|param|get|Pn0214"),
    ('-b "$CELL" -n 1 -d $FAMILY param get pn0214~', "-b|sim:gsd600@1|-n|1|-d|gsd600|param|get|Pn0214"),
    # files, where any may stand
    ("backup my\\ f~", "backup|my file.json"),
    ("backup 'my f~", "backup|my file.json"),
    ("--cabinet cab~ cabinet show", "--cabinet|cabinet.toml|cabinet|show"),
    ("--cabinet=cab~ cabinet show", "--cabinet=cabinet.toml|cabinet|show"),
    # axes of the cabinet file, and the family that they have
    ("status -n lif~", "status|-n|lift"),
    ("status -n lift,fee~", "status|-n|lift,feeder"),
    ("jog fee~60rp~", "jog|feeder|60rpm"),
    ("param get lift pn0214~", "param|get|lift|Pn0214"),
    # a sign of the history of bash
    ("-d bang/~ objects", "-d|bang/a!echo x.eds|objects"),
    ("-d 'bang/~ objects", "-d|bang/a!echo x.eds|objects"),
    ('-d "bang/~ objects', "-d|bang/a!echo x.eds|objects"),
    # a pipe into which nobody writes
    ("-d pipe param get x~", "-d|pipe|param|get|x"),
    ("--cabinet other/c.toml status -n cra~", "--cabinet|other/c.toml|status|-n|crane"),
]

# fish reads a `?` that is in no quotes as a wildcard, whoever typed it; what Tab puts there is quoted.
NOT_IN_FISH = [("scan -b sim:gsd600@1?st~mem~", "scan|-b|sim:gsd600@1?state=memory.bin")]

# What is typed, and what the list then says: words with what they are.
LISTS = [
    ("help param ", r"explain\W+Show all that is known"),
    ("mode -d gsd600 ", r"pv\W+3 Profile velocity"),
    ("home -d gsd600 3", r"35\W+Present position is home"),
    ("param set -d gsd600 Pn0214 ", r"1\.\.65535 Hz, default 600"),
    ("read --t", r"type\W+data type"),
    ("jog ", r"feeder\W+axis: main node 1, gsd600"),
    ("scan -b 'sim:gsd600@1?", r"delay=\W+time until an answer"),
    ("-d gsd600 --lang zh param get Pn021", r"Pn0214\W+速度环增益 1"),
    ("read -n 9 ", r"-d FAMILY before it tells"),
    ("jog --for=", r"--for: how long"),
]

# What stands above the lists of zsh, in the order of the headings.
HEADINGS_OF_ZSH = [
    ("test ", r"commands and groups:"),
    ("jog ", r"nodes and axes:[\s\S]*feeder"),
    ("-d gsd600 param get Pn02", r"panel parameters:"),
    ("-d gsd600 read 0x604", r"objects:"),
    ("read --t", r"options:"),
    ("read -n 1 --lang ", r"values:"),
]


def prepare():
    for folder in ("bin", "home", "state", "here/evil", "here/other", "here/bang"):
        os.makedirs(f"{work}/{folder}")
    with open(f"{work}/bin/servoctl", "w") as out:
        out.write(f'#!/bin/sh\n[ "$1" = __complete ] && exec {servoctl} "$@"\n'
                  "printf RAN; for word; do printf '<%s>' \"$word\"; done; echo '<end>'\n")
    os.chmod(f"{work}/bin/servoctl", 0o755)
    for name, text in (("memory.bin", ""), ("my file.json", "{}"), ("my sheet.eds", ""), ("cabinet.toml", CABINET),
                       ("other/c.toml", CABINET.replace("feeder", "crane")), ("evil/$(touch owned)'\".eds", ""),
                       ("bang/a!echo x.eds", ""), ("output.txt", "")):
        with open(f"{here}/{name}", "w") as out:
            out.write(text)
    os.mkfifo(f"{here}/pipe")
    os.environ.update(HOME=f"{work}/home", PATH=f"{work}/bin:{os.environ['PATH']}", SERVOCTL_DRIVES=f"{source}/eds",
                      ZDOTDIR=f"{work}/home")
    for name in ("SERVOCTL_LANG", "SERVOCTL_CABINET", "INPUTRC", "XDG_CONFIG_HOME", "XDG_DATA_HOME"):
        os.environ.pop(name, None)
    os.chdir(here)


class Shell:
    def __init__(self, name, program, *arguments, set_up, tabs):
        self.name, self.tabs, self.lines = name, tabs, 0
        self.terminal = Terminal(shutil.which(program), *arguments, state=f"{work}/state", size=(50, 110))
        self.terminal.type(set_up + "\r")
        self.look("READY> ")

    def look(self, pattern):
        before = len(failures)
        self.terminal.see(pattern, 4)
        failures[before:] = [f"{self.name}: {failure}" for failure in failures[before:]]
        return len(failures) == before

    def run(self, typed, words):
        before = len(failures)
        self.terminal.type("servoctl " + typed.replace("~", "\t") + "\r")
        self.look("RAN" + re.escape("<" + words.replace("|", "><") + "><end>"))
        self.begin_anew(before, typed)

    def lists(self, typed, pattern):
        before = len(failures)
        self.terminal.type("servoctl " + typed + "\t" * self.tabs)
        self.look(pattern)
        # What is listed stays out of the line: with Enter it is run as it was typed.
        self.terminal.type(("'" if typed.count("'") % 2 else "") + "\r")
        words = shlex.split(typed + "'" * (typed.count("'") % 2))
        self.look("RAN" + re.escape("".join(f"<{word}>" for word in words) + "<end>"))
        self.begin_anew(before, typed)

    def begin_anew(self, before, typed):
        failures[before:] = [f"{failure} (typed: servoctl {typed})" for failure in failures[before:]]
        if len(failures) > before:
            print(failures[-1], flush=True)
            # What the line became is not known. A Ctrl-C throws away what is typed too soon behind it.
            self.terminal.type("\x03")
            time.sleep(0.5)
        self.terminal.type("\x15")
        self.lines += 1
        self.terminal.type(f"echo al''one {self.lines}\r")
        self.look(f"alone {self.lines}\r?\n")
        self.look("READY> ")

    def set(self, name, value):
        self.terminal.type((f"set -gx {name} '{value}'" if self.name == "fish" else f"export {name}='{value}'") + "\r")
        self.look("READY> ")

    def end(self):
        self.terminal.type("exit\r")
        self.terminal.exit_code()


def shells():
    bash = ("bash", "--norc", "--noprofile", "-i")
    ready = "CELL=sim:gsd600@1; FAMILY=gsd600; PS1='READ''Y> '"
    yield lambda: Shell("bash", *bash, set_up=f". {completions}/servoctl.bash; {ready}", tabs=2)
    if os.path.exists(bash_helpers):
        yield lambda: Shell("bash with bash-completion", *bash,
                            set_up=f". {bash_helpers}; . {completions}/servoctl.bash; {ready}", tabs=2)
    else:
        print("SKIP bash-completion is not installed")
    if shutil.which("zsh"):
        yield lambda: Shell("zsh", "zsh", "-f", "-i", tabs=1, set_up=f"fpath=({completions} $fpath); autoload -Uz compinit; "
                            f"compinit -u -D; unsetopt prompt_sp; {ready}")
    else:
        print("SKIP zsh is not installed")
    if shutil.which("fish"):
        yield lambda: Shell("fish", "fish", "--no-config", "-i", tabs=1, set_up=f"source {completions}/servoctl.fish; "
                            "set -g CELL sim:gsd600@1; set -g FAMILY gsd600; set -g fish_autosuggestion_enabled 0; function fish_prompt; echo 'READ''Y> '; end")
    else:
        print("SKIP fish is not installed")


def try_shell(shell):
    for typed, words in LINES + ([] if shell.name == "fish" else NOT_IN_FISH):
        shell.run(typed, words)
    for typed, pattern in LISTS:
        shell.lists(typed, pattern)
    if shell.name == "zsh":
        shell.terminal.type("zstyle ':completion:*:descriptions' format '%d:'; zstyle ':completion:*' group-name ''\r")
        shell.look("READY> ")
        for typed, pattern in HEADINGS_OF_ZSH:
            shell.lists(typed, pattern)
    shell.run("scan > out~; cat output.txt", "scan")
    shell.set("SERVOCTL_DRIVE", "gsd600")
    shell.run("param get pn0214~", "param|get|Pn0214")
    shell.set("SERVOCTL_DRIVE", "")
    shell.set("SERVOCTL_BUS", "sim:gsd600@1,ts@4")
    shell.set("SERVOCTL_NODE", "1")
    shell.run("param get pn0214~", "param|get|Pn0214")
    shell.lists("status -n ", r"4\W+simulated ts")
    shell.end()


def open_nothing():
    """A pipe that is named is not opened: nothing is waited for, and what is in it stays there."""
    end = os.open(f"{here}/pipe", os.O_RDWR | os.O_NONBLOCK)
    os.write(end, b"mine")
    for line in ("--cabinet pipe status -n l", "-d pipe param get x", "--cabinet /dev/tty status -n l"):
        times = []
        for _ in range(3):  # The machine may have other work; a pipe that is waited for takes the alarm's two seconds.
            begin = time.monotonic()
            subprocess.run([servoctl, "__complete", "bash", "9", "80", " :=", "servoctl " + line], stdout=subprocess.DEVNULL)
            times.append(time.monotonic() - begin)
        if min(times) > 0.5:
            failures.append(f"{line}: Tab took {min(times):.1f} s")
    try:
        if os.read(end, 9) != b"mine":
            failures.append("a Tab took something out of a pipe")
    except BlockingIOError:
        failures.append("a Tab emptied a pipe")
    os.close(end)


prepare()
open_nothing()
for start in shells():
    try_shell(start())
if os.path.exists(f"{here}/owned") or os.listdir(f"{work}/state"):
    failures.append("a Tab ran what stands in a name, or wrote into the folder for state")
shutil.rmtree(work)
for failure in failures:
    print("FAILED " + failure)
print(f"{len(failures)} failed")
sys.exit(1 if failures else 0)
