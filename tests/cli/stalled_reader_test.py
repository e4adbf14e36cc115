#!/usr/bin/env python3
"""A motion goes to its end, and the drive is left de-energised, when whoever reads the output does not read it, is a
terminal held by Ctrl-S, or a socket; what was not read then comes afterwards.
usage: stalled_reader_test.py SERVOCTL"""
import fcntl
import json
import os
import pty
import socket
import subprocess
import sys
import tempfile
import termios
import time

import checks
from checks import check

servoctl = sys.argv[1]
bus = f"local:stalled-{os.getpid()}"
env = dict(os.environ, SERVOCTL_BUS=bus, SERVOCTL_NODE="1", SERVOCTL_DRIVE="da200")
# Without a watchdog in the drive, only servoctl itself ends the motion.
jog = [servoctl, "jog", "60rpm", "--for", "1s", "--turn", "10000", "--yes"]


def energised():
    found = checks.status(servoctl, env)
    return found["energised"] if found else None


def wait_until(state, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if energised() is state:
            return True
        time.sleep(0.05)
    return False


def moves_and_ends(what):
    check(f"{what}: it moves", wait_until(True, 10))
    check(f"{what}: it is at rest after its time", wait_until(False, 3))


def rest_of(descriptor):
    out = b""
    while piece := os.read(descriptor, 65536):
        out += piece
    return out


def check_documents(what, text):
    documents = [json.loads(line) for line in text.decode().splitlines()]
    check(f"{what}: every sample is there ({len(documents)} documents)", len(documents) > 20 and all("time" in d for d in documents[:-1]))
    check(f"{what}: the result is there", documents[-1]["ok"] and documents[-1]["result"]["end"]["verified"])


drive = subprocess.Popen([servoctl, "sim", "da200@1?panel=P0.03=7"], env=env, stdout=subprocess.DEVNULL)
try:
    check("the drive answers", wait_until(False, 10))

    reader, writer = os.pipe()
    fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)
    process = subprocess.Popen(jog + ["-o", "jsonl"], env=env, stdout=writer, stderr=subprocess.DEVNULL)
    os.close(writer)
    moves_and_ends("pipe")
    check("pipe: the result waits for its reader", process.poll() is None)
    check_documents("pipe", rest_of(reader))
    check("pipe: it ends well", process.wait(10) == 0)

    ours, theirs = socket.socketpair()
    theirs.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    process = subprocess.Popen(jog + ["-o", "jsonl"], env=env, stdout=theirs, stderr=subprocess.DEVNULL)
    theirs.close()
    moves_and_ends("socket")
    check_documents("socket", rest_of(ours.fileno()))
    check("socket: it ends well", process.wait(10) == 0)

    terminal, tty = pty.openpty()
    process = subprocess.Popen(jog, env=env, stdin=subprocess.DEVNULL, stdout=tty, stderr=subprocess.DEVNULL)
    termios.tcflow(tty, termios.TCOOFF)
    moves_and_ends("terminal")
    check("terminal: it waits at the end", process.poll() is None)
    termios.tcflow(tty, termios.TCOON)
    check("terminal: it ends well", process.wait(10) == 0)
    check("terminal: the end is shown", b"verified" in os.read(terminal, 65536))

    # Who reads what lines print holds up no SYNC, though he is waited for.
    listener = subprocess.Popen([servoctl, "monitor", "--service", "sync", "--for", "8s", "-o", "jsonl"], env=env, stdout=subprocess.PIPE)
    process = subprocess.Popen([servoctl], env=env, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    process.stdin.write(b"sync start --period 20ms --yes\nobjects --json\nstatus --json\n")
    process.stdin.flush()
    times = [json.loads(line).get("time") for line in listener.stdout]
    times = [time for time in times if time is not None]
    longest = max(b - a for a, b in zip(times, times[1:])) if len(times) > 1 else None
    check(f"SYNC goes on while nobody reads: {len(times)}, at most {longest} s apart", longest is not None and longest < 1 and times[-1] - times[0] > 6)
    text = process.communicate(timeout=20)[0].decode()
    check("SYNC: what was printed meanwhile is whole", text.count("{\"servoctl\":1,") == 2 and json.loads(text.splitlines()[-1])["ok"])
    listener.wait()

    # What reads the trace stands still: the line is carried out, what the trace has not got is told and is no success.
    with tempfile.TemporaryDirectory() as folder:
        fifo = os.path.join(folder, "trace")
        os.mkfifo(fifo)
        reader = os.open(fifo, os.O_RDONLY | os.O_NONBLOCK)
        fcntl.fcntl(reader, fcntl.F_SETPIPE_SZ, 4096)
        backup = os.path.join(folder, "backup.json")
        done = subprocess.run([servoctl, "backup", backup, "--trace", fifo, "--yes"], env=env, capture_output=True, text=True)
        check(f"trace: exit 7, not {done.returncode}", done.returncode == 7)
        check(f"trace: it is told\n{done.stderr}", "frames are missing in the trace" in done.stderr)
        check("trace: the backup is whole", len(json.load(open(backup))) > 3)
finally:
    drive.terminate()
    drive.wait()
checks.finish()
