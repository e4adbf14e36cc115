#!/usr/bin/env python3
"""Hostile text in drives, EDS files and file names, through every command that shows it, in a pipe and on a terminal:
nothing that moves the cursor, turns the text around or hides may come out, JSON stays JSON with the true text in it.
usage: text.py SERVOCTL COUNT [SEED]"""
import json
import os
import pathlib
import pty
import random
import select
import shutil
import subprocess
import sys
import tempfile
import time

servoctl, count = str(pathlib.Path(sys.argv[1]).resolve()), int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else random.randrange(1 << 32)
rng = random.Random(seed)
folder = pathlib.Path(tempfile.mkdtemp(prefix="servoctl-text-"))
families = ("dm", "sv2", "cia402", "dm", "sv2", "cia402", "gsd600", "da200", "ts")
env = dict(os.environ, HOME=str(folder), XDG_STATE_HOME=str(folder / "state"), TERM="xterm", NO_COLOR="1")
env.pop("SERVOCTL_BUS", None)

PIECES = [b"\x1b[2J", b"\x1b]0;owned\x07", b"\x9b31m", b"\xc2\x9b31m", b"\r", b"\x08", b"\x7f", b"\x00", b"\nerror: it is done\n",
          "\u202e".encode(), "\u2066".encode(), "\u200f".encode(), "\u061c".encode(), "\u2028".encode(), "\u200b".encode(),
          "\ufeff".encode(), "\U000e0041".encode(), b"\xff\xfe", b"\xed\xa0\x80", b"\xc0\xaf", b"\xf8\x90\x80\x80", b"\xef\xbf\xbe",
          b"=1+1", b"-cmd", b"\t", b"'", b'"', b"`id`", b"$(id)", "位置".encode(), b"plain", b" ", b"%s", b"{}"]


def hostile(most=6):
    pieces = [rng.choice(PIECES) for _ in range(rng.randint(1, most))]
    if rng.random() < 0.3:
        pieces.append(bytes(rng.randrange(256) for _ in range(rng.randint(1, 8))))
    return b"".join(pieces)[:64]


def is_forbidden(c):
    n = ord(c)
    return (n < 0x20 and c != "\n") or 0x7F <= n <= 0x9F or n == 0x61C or 0x200B <= n <= 0x200F or 0x2028 <= n <= 0x202E or \
        0x2060 <= n <= 0x206F or n == 0xFEFF or 0xFDD0 <= n <= 0xFDEF or n & 0xFFFE == 0xFFFE or 0xE0000 <= n <= 0xE0FFF


def wrong_in(output, tabs=False):
    """What is wrong with what came out; empty when nothing is."""
    # The line of progress, and line breaks as a terminal ends them.
    output = output.replace(b"\r\x1b[K", b"").replace(b"\r\n", b"\n")
    try:
        text = output.decode()
    except UnicodeDecodeError as error:
        return f"no UTF-8: {output[max(0, error.start - 20):error.end + 20]!r}"
    for at, c in enumerate(text):
        if is_forbidden(c) and not (tabs and c == "\t"):
            return f"U+{ord(c):04X} in {text[max(0, at - 20):at + 20]!r}"
    return ""


def run_piped(words):
    done = subprocess.run([servoctl, *words], env=env, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, timeout=60)
    return done.returncode, done.stdout, done.stderr


def run_on_terminal(words):
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(folder)
        os.execve(servoctl, [servoctl, *words], env)
    out, end = b"", time.monotonic() + 60
    while time.monotonic() < end:
        if not select.select([terminal], [], [], 1)[0]:
            continue
        try:
            piece = os.read(terminal, 65536)
        except OSError:
            break
        if not piece:
            break
        out += piece
    os.close(terminal)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), out


def state_file(family, name):
    path = folder / "drive.state"
    path.write_bytes(b"# servoctl: memory of simulated drives, version 1\n" +
                     b"".join(f"1.{family} 0x{index:04X}:0 {name.hex()}\n".encode() for index in (0x1008, 0x1009, 0x100A)))
    return f"sim:{family}@1?state={path}"


def eds_file(name):
    line = name.replace(b"\n", b" ").replace(b"\r", b" ").replace(b"\0", b" ")
    path = folder / "hostile.eds"
    path.write_bytes(b"[FileInfo]\nDescription=" + line + b"\n[DeviceInfo]\nVendorName=" + line + b"\nProductName=" + line +
                     b"\n[MandatoryObjects]\nSupportedObjects=2\n1=0x1000\n2=0x1008\n"
                     b"[1000]\nParameterName=" + line + b"\nObjectType=7\nDataType=7\nAccessType=ro\n"
                     b"[1008]\nParameterName=Name " + line + b"\nObjectType=7\nDataType=9\nAccessType=const\n"
                     b"[OptionalObjects]\nSupportedObjects=1\n1=0x6041\n"
                     b"[6041]\nParameterName=" + line + b"\nObjectType=7\nDataType=6\nAccessType=ro\nPDOMapping=1\n")
    return str(path)


def from_drive():
    family, name = rng.choice(families), hostile()
    bus = state_file(family, name)
    at = ["-b", bus, "-n", "1"]
    words = rng.choice([["scan", "-b", bus], ["info", *at], ["info", *at, "-d", family], ["read", "0x1008", "0x1009", "0x100A", *at],
                        ["read", "0x1008", "--type", "string", *at, "-d", family],
                        ["watch", "0x1008", "--for", "200ms", *at, "-d", family], ["monitor", "--for", "100ms", "--ask", *at],
                        ["status", *at, "-d", family], ["nmt", "watch", "--for", "100ms", *at],
                        ["report", str(folder / "page.html"), *at, "-d", family],
                        ["backup", str(folder / "new.json"), *at, "-d", family], ["verify", str(folder / "new.json"), *at, "-d", family],
                        ["read", "0x1008", "--trace", str(folder / "t.log"), *at]])
    return words, name


def from_eds():
    name = hostile()
    eds = eds_file(name)
    bus = ["-b", "sim:" + rng.choice(families) + "@1", "-n", "1"]
    words = rng.choice([["objects", "-d", eds], ["eds", "check", eds], ["read", "0x6041", "0x1008", "-d", eds, *bus],
                        ["watch", "0x6041", "--for", "200ms", "-d", eds, *bus], ["info", "-d", eds, *bus],
                        ["monitor", "--for", "100ms", "-d", eds, *bus], ["completion", "objects", "-d", eds],
                        ["pdo", "show", "-d", eds, *bus], ["read", "statuswor", "-d", eds, *bus], ["drives", "-d", eds],
                        ["decode", str(folder / "t.log"), "-d", eds], ["write", "0x6041", "1", "-d", eds, *bus],
                        ["backup", str(folder / "new.csv"), "--format", "csv", "-d", eds, *bus],
                        ["scope", "0x6041", "--for", "100ms", "-d", eds, *bus]])
    return words, None


def from_file_name():
    name = os.fsdecode(hostile().replace(b"/", b"_").replace(b"\0", b"_"))
    path = str(folder / name)
    if rng.random() < 0.5:
        try:
            pathlib.Path(path).write_bytes(hostile())
        except OSError:
            pass
    words = rng.choice([["decode", path], ["eds", "check", path], ["diff", path, path], ["run", path, "--check"], ["run", path],
                        ["restore", path, "-b", "sim:dm@1", "-n", "1", "-d", "dm", "--yes"], ["objects", "-d", path],
                        ["read", "0x1000", "-n", "1", "-b", "sim:dm@1", "--trace", path + "/none/x"], ["read", name, "-b", "sim:dm@1", "-n", "1", "-d", "dm"],
                        ["scan", "-b", name], [name], ["help", name], ["scan", "-b", "sim:" + name], ["scan", "-b", "replay:" + path],
                        ["pdo", "apply", path, "-b", "sim:dm@1", "-n", "1", "-d", "dm", "--yes"],
                        ["write", "0x6060", name, "-b", "sim:dm@1", "-n", "1", "-d", "dm"]])
    return words, None


def true_text_is_there(words, out, name):
    """JSON carries what the drive said, where that is text."""
    if name is None or "scan" not in words or words[0] != "scan":
        return ""
    told = name.rstrip(b"\0")
    try:
        told = told.decode()
    except UnicodeDecodeError:
        return ""
    try:
        got = json.loads(out)["result"][0]["device_name"]
    except (ValueError, IndexError, KeyError, TypeError) as error:
        return f"no name in the JSON: {error}"
    return "" if (got or "") == told else f"the name became {got!r}, it is {told!r}"


def attack():
    words, name = rng.choice([from_drive, from_eds, from_file_name])()
    words = [w.replace("\0", "_") for w in words]
    form = rng.choice(["pipe", "terminal", "json", "zh"])
    if form == "terminal":
        code, out = run_on_terminal(words)
        return words, code, wrong_in(out)
    words += {"json": ["--json"], "zh": ["--lang", "zh"]}.get(form, [])
    code, out, err = run_piped(words)
    wrong = wrong_in(out, tabs=form != "json") or wrong_in(err)
    if form == "json" and not wrong:
        for line in out.splitlines():
            try:
                json.loads(line)
            except ValueError:
                wrong = f"no JSON: {line[:80]!r}"
        wrong = wrong or true_text_is_there(words, out, name)
    for page in folder.glob("*.html"):
        wrong = wrong or wrong_in(page.read_bytes(), tabs=True)
        page.unlink()
    return words, code, wrong


failures = 0
deadline = time.monotonic() + max(20, 3 * count)
done = 0
try:
    for at in range(count):
        if time.monotonic() > deadline:
            break
        done += 1
        words, code, wrong = attack()
        if code < 0 or code == 70:
            wrong = wrong or f"exit {code}"
        if wrong:
            failures += 1
            print(f"attack {at} of seed {seed}: {words!r}: {wrong}")
finally:
    shutil.rmtree(folder, ignore_errors=True)
print(f"text: {done} attacks, {failures} failures")
sys.exit(1 if failures else 0)
