#!/usr/bin/env python3
"""Signals, single and in pairs up to 5 ms apart, at a random moment: in a motion, in a batch and at a prompt with a drive
enabled; while what is shown is read, is not read, or goes to a terminal that is held, and while nobody reads the trace.
Afterwards the process has ended and the drive is without power. usage: signals.py SERVOCTL COUNT [SEED]"""
import fcntl
import json
import os
import pty
import random
import signal
import subprocess
import sys
import tempfile
import termios
import time

servoctl, count = sys.argv[1], int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
rng = random.Random(seed)
FAMILIES = {"gsd600": ["--turn", "131072"], "da200": ["--turn", "10000"], "ts": ["--turn", "10000"], "dm": [], "sv2": []}
SIGNALS = ["INT", "TERM", "HUP", "QUIT", "TSTP", "USR1"]
# These end what is running, and not a prompt.
INTERRUPTS = {"INT", "TSTP"}
PLACES = ["jog", "move", "batch", "last line", "last line of input", "pipe", "last line of a pipe", "prompt"]
# Lines that end as interrupted ones, whatever they were about.
LINES = {"batch", "last line", "last line of input", "pipe", "last line of a pipe"}
LAST_LINE = "watch statusword --every 2ms --for 60s\n"
FORMS = [[], [], ["--json"], ["-o", "jsonl"]]
OUTPUTS = ["read", "stalled pipe", "held terminal", "stalled trace"]
failures = []
number = 0


def status(env):
    run = subprocess.run([servoctl, "status", "--timeout", "2s", "--json"], env=env, capture_output=True, timeout=60)
    return json.loads(run.stdout)["result"][0] if run.returncode == 0 else None


def energised(env):
    found = status(env)
    return found["energised"] if found else None


def until(condition, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return False


class Run:
    """One servoctl, and the ends of its pipes and terminals."""

    def __init__(self, env, place, output, turn, folder):
        self.held = []
        self.terminal = None
        command = {"jog": ["jog", "60rpm", "--for", "20s", *turn, "-y"],
                   "move": ["move", "20rev", "--relative", "--speed", "60rpm", *turn, "-y"]}.get(place, [])
        if place in ("batch", "last line"):
            script = os.path.join(folder, "batch")
            with open(script, "w") as file:
                file.write("enable -y\n")
                file.write("status\nobjects\n" * 40 + "wait 60s\n" if place == "batch" else LAST_LINE)
            command = ["run", script, *rng.choice(FORMS)]
        if place == "last line of input":
            command = ["run", "-", *rng.choice(FORMS)]
        if output == "stalled trace":
            command = ["--trace", self.fifo(folder), *command]
        stdin = stdout = subprocess.DEVNULL
        if place == "prompt" or output == "held terminal":
            self.terminal, tty = pty.openpty()
            os.set_blocking(self.terminal, False)
            stdin = stdout = tty
            if place != "prompt":
                stdin = subprocess.DEVNULL
            self.held.append(tty)
        if output == "stalled pipe" and place != "prompt":
            reader, stdout = os.pipe()
            fcntl.fcntl(stdout, fcntl.F_SETPIPE_SZ, 4096)
            self.held += [reader, stdout]
        if place in ("pipe", "last line of a pipe", "last line of input"):
            stdin = subprocess.PIPE
        self.process = subprocess.Popen([servoctl, *command], env=env, stdin=stdin, stdout=stdout, stderr=stdout,
                                        start_new_session=True)
        if place in ("pipe", "last line of a pipe", "last line of input"):
            self.process.stdin.write(b"enable -y\n" + (LAST_LINE.encode() if place != "pipe" else b""))
            self.process.stdin.flush()
        if place in ("last line of a pipe", "last line of input"):
            self.process.stdin.close()
        if place == "prompt":
            time.sleep(0.3)
            self.read()
            os.write(self.terminal, b"enable -y\r")

    def fifo(self, folder):
        path = os.path.join(folder, f"fifo{number}")
        os.mkfifo(path)
        reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        fcntl.fcntl(reader, fcntl.F_SETPIPE_SZ, 4096)
        self.held.append(reader)
        return path

    def read(self):
        if self.terminal is None:
            return
        try:
            while os.read(self.terminal, 65536):
                pass
        except OSError:
            pass

    def ended(self, reads):
        if reads:
            self.read()
        return self.process.poll() is not None

    def close(self):
        for descriptor in self.held + ([self.terminal] if self.terminal is not None else []):
            os.close(descriptor)
        if self.process.stdin and not self.process.stdin.closed:
            self.process.stdin.close()


def attack(env, family, folder):
    place, output = rng.choice(PLACES), rng.choice(OUTPUTS)
    names = rng.choices(SIGNALS, k=rng.choice([1, 2, 2]))
    gap, delay = rng.choice([0, 0.0001, 0.001, 0.005]), rng.uniform(0, 1)
    what = f"{number}: {family}, {place}, {output}, {' '.join(names)} {gap * 1000:g} ms apart after {delay * 1000:.0f} ms"
    run = Run(env, place, output, FAMILIES[family], folder)
    reads = output != "held terminal"
    if place in LINES | {"prompt"} and not until(lambda: energised(env), 60):
        failures.append(f"{what}: the drive is not enabled, nothing was tried")
    elif place in ("jog", "move"):
        time.sleep(rng.uniform(0, 2.5))
    if place == "prompt" and output == "held terminal":
        termios.tcflow(run.held[0], termios.TCOOFF)
        os.write(run.terminal, b"half a line")
    time.sleep(delay)
    for name in names:
        if run.process.poll() is None:
            run.process.send_signal(getattr(signal, "SIG" + name))
        time.sleep(gap)
    if place == "prompt" and set(names) <= INTERRUPTS:
        if until(lambda: run.ended(reads), 0.3):
            failures.append(f"{what}: an interrupt ended the prompt")
        run.process.send_signal(signal.SIGTERM)
    # Held back before a drive was energised, it stopped the process; it does not do so afterwards.
    time.sleep(0.1)
    if run.process.poll() is None:
        run.process.send_signal(signal.SIGCONT)
        if place in ("jog", "move") and names == ["TSTP"]:
            run.process.send_signal(signal.SIGINT)
    # Who never reads holds the end back, but not the drive's.
    if not until(lambda: energised(env) is False, 15):
        failures.append(f"{what}: the drive is energised: {status(env)}")
    if place == "prompt" and output == "held terminal":
        termios.tcflow(run.held[0], termios.TCOON)
    for descriptor in run.held:
        if output == "stalled pipe":
            os.set_blocking(descriptor, False)
    end = time.monotonic() + 15
    while run.process.poll() is None and time.monotonic() < end:
        run.read()
        if output == "stalled pipe" and run.held and place != "prompt":
            try:
                os.read(run.held[0], 65536)
            except OSError:
                pass
        time.sleep(0.01)
    if run.process.poll() is None:
        failures.append(f"{what}: it does not end")
        run.process.kill()
    code = run.process.wait()
    # Two of the keyboard end a process that holds no drive at once; its code is that of an interruption as well.
    if place in LINES and code != 130:
        failures.append(f"{what}: the exit code is {code}")
    run.close()
    if energised(env):
        failures.append(f"{what}: the drive is energised afterwards")
        subprocess.run([servoctl, "disable"], env=env, capture_output=True)


with tempfile.TemporaryDirectory() as folder:
    done = 0
    drives = {}
    try:
        for number in range(count):
            family = rng.choice(list(FAMILIES))
            env = {**os.environ, "SERVOCTL_BUS": f"local:signals-{os.getpid()}-{family}", "SERVOCTL_NODE": "1",
                   "SERVOCTL_DRIVE": family, "XDG_STATE_HOME": folder, "TERM": "xterm"}
            if family not in drives:
                drives[family] = subprocess.Popen([servoctl, "sim", f"{family}@1"], env=env, stdout=subprocess.DEVNULL)
                until(lambda: energised(env) is False, 20)
            attack(env, family, folder)
            done += 1
    finally:
        for drive in drives.values():
            drive.terminate()
            drive.wait()
print(f"signals: {done} attacks, {len(failures)} failures (seed {seed})")
for failure in failures:
    print(failure)
sys.exit(1 if failures else 0)
