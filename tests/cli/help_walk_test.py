#!/usr/bin/env python3
"""Each word that a help text mentions has a help text: commands, groups, words of the prompt and options, in both languages, on a
terminal of 80 columns and of 50, in which no line is wider than the window.
usage: help_walk_test.py SERVOCTL"""
import concurrent.futures
import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios
import unicodedata

import checks
from checks import check

servoctl = os.path.abspath(sys.argv[1])
env = {k: v for k, v in os.environ.items() if not k.startswith(("SERVOCTL_", "LC_"))}
env.update(TERM="xterm", NO_COLOR="1")


def shown(words, columns, lang):
    """Exit code and text of `help` on a terminal so wide."""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    process = subprocess.Popen([servoctl, "--no-pager", "help", *words], stdin=slave, stdout=slave, stderr=slave,
                               env={**env, "LANG": lang})
    os.close(slave)
    out = b""
    while True:
        try:
            data = os.read(master, 65536)
        except OSError:
            break
        if not data:
            break
        out += data
    os.close(master)
    return process.wait(), out.decode().replace("\r\n", "\n")


def width(line):
    return sum(2 if unicodedata.east_asian_width(c) in "WF" else 0 if unicodedata.combining(c) else 1 for c in line)


def names(listing, title):
    block = listing.split(title + ":\n")[1].split("\n\n")[0]
    return [re.match(r"  (\S+(?: \S+)*?) {2,}", each).group(1) for each in block.splitlines() if re.match(r"  \S", each)]


def options_in(text):
    return set(re.findall(r"(?<![\w\x22-])--[a-z][a-z-]*", text)) | set(re.findall(r"^  (-[a-z]), ", text, flags=re.M))


def main():
    listing = subprocess.run([servoctl, "help"], env={**env, "LANG": "C.UTF-8"}, capture_output=True, text=True, check=True).stdout
    commands = names(listing, "Commands")
    prompt = [each.split()[0] for each in names(listing, "At the prompt also")]
    groups = {each.split()[0] for each in commands if " " in each}
    topics = {(*each.split(),) for each in [*commands, *prompt, *groups]}
    asked, waiting, mentioned = set(), sorted(topics), set()
    places = [(80, "C.UTF-8"), (50, "C.UTF-8"), (80, "zh_CN.UTF-8"), (50, "zh_CN.UTF-8")]
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        while waiting:
            runs = [(words, *place) for words in waiting for place in places]
            asked |= set(waiting)
            found = set()
            for (words, columns, lang), (code, text) in zip(runs, pool.map(lambda run: shown(*run), runs)):
                name = f"`help {' '.join(words)}` ({columns} columns, {lang})"
                check(f"{name} has a text: {code} {text[:200]!r}", code == 0 and text.strip())
                # Lines to be copied stay whole, and so does a document.
                laid_out = re.sub(r"\n(Examples:|示例：)\n(.+\n)*", "\n", text) if not text.startswith("{") else ""
                wide = [line for line in laid_out.splitlines() if width(line) > columns and max(map(width, line.split())) <= columns - 25]
                check(f"{name} fits the window: {wide}", not wide)
                found |= {(option,) for option in options_in(text)}
                mentioned |= {tuple(each.split()) for each in re.findall(r"`help ([a-z][a-z -]*)`", text)}
            waiting = sorted((found | mentioned) - asked)
    check(f"{len(asked)} words were walked", len(asked) > 220)
    check("the options of all commands are among them", {("--for",), ("--bus",), ("-b",), ("--expect",)} <= asked)


main()
checks.finish()
