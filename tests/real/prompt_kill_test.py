#!/usr/bin/env python3
"""Two drives enabled at the prompt, then signals, single and in pairs a tenth of a millisecond apart, or the terminal
is closed, while it waits for a line or runs one: however the prompt ends, both drives are without power. An interrupt
alone ends no prompt, and takes the power of no drive: what was enabled stays so until the prompt ends.
usage: prompt_kill_test.py SERVOCTL [KILLS [BUS [FAMILY FAMILY [SEED]]]]"""
import json
import os
import pty
import random
import select
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from checks import obeying

servoctl = sys.argv[1]
kills = int(sys.argv[2]) if len(sys.argv) > 2 else 10
bus = sys.argv[3] if len(sys.argv) > 3 else f"local:prompt-kill-{os.getpid()}"
families = sys.argv[4:6] if len(sys.argv) > 5 else ["gsd600", "ts"]
chance = random.Random(int(sys.argv[6]) if len(sys.argv) > 6 else 4711)
env = dict(os.environ, TERM="xterm", LANG="C.UTF-8", SERVOCTL_BUS=bus)
for name in ("SERVOCTL_NODE", "SERVOCTL_DRIVE"):
    env.pop(name, None)
failures = 0


def fail(what):
    global failures
    failures += 1
    print("FAILED", what, flush=True)


def energised(node):
    answer = subprocess.run([servoctl, "status", "-n", str(node), "--json"], env=env, capture_output=True)
    return json.loads(answer.stdout)["result"][0]["energised"] if answer.returncode == 0 else None


class Prompt:
    def __init__(self):
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGTSTP, signal.SIGHUP, signal.SIGTERM):
                signal.signal(number, signal.SIG_DFL)
            os.execve(servoctl, [servoctl, "--yes"], env)
        self.text = ""

    def read(self, seconds):
        """Takes in what is shown; false when the terminal is gone."""
        if not select.select([self.fd], [], [], max(0, seconds))[0]:
            return True
        try:
            data = os.read(self.fd, 4096)
        except OSError:
            return False
        self.text += data.decode(errors="replace")
        return bool(data)

    def say(self, line, wanted, seconds=20):
        self.text = ""
        os.write(self.fd, line.encode() + b"\r")
        end = time.monotonic() + seconds
        # What is typed before the prompt is back behind a drive that was enabled is dropped.
        while "> " not in self.text.partition(wanted)[2]:
            if time.monotonic() > end or not self.read(end - time.monotonic()):
                fail(f"'{line}' does not show {wanted!r}: {self.text[-600:]!r}")
                return

    def ended(self, seconds):
        """Whether it ends in that time; what it shows is read meanwhile."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if os.waitpid(self.pid, os.WNOHANG)[0] == self.pid:
                return True
            if self.fd is None or not self.read(0.02):
                time.sleep(0.02)
        return False

    def signal(self, *numbers):
        for number in numbers:
            os.kill(self.pid, number)
            time.sleep(0.0001)

    def close(self):
        os.close(self.fd)
        self.fd = None


LINES = ["", "run {batch}", "watch 0x6041 -n 1 --for 5s", "status -n 1,2", "monitor --for 5s", "read 0x6041 0x6064 -n 1,2"]
ENDS = {
    "INT INT": lambda p: p.signal(signal.SIGINT, signal.SIGINT),
    "INT": lambda p: p.signal(signal.SIGINT),
    "INT TERM": lambda p: p.signal(signal.SIGINT, signal.SIGTERM),
    "TERM": lambda p: p.signal(signal.SIGTERM),
    "TERM INT": lambda p: p.signal(signal.SIGTERM, signal.SIGINT),
    "QUIT QUIT": lambda p: p.signal(signal.SIGQUIT, signal.SIGQUIT),
    "HUP": lambda p: p.signal(signal.SIGHUP),
    "HUP HUP INT": lambda p: p.signal(signal.SIGHUP, signal.SIGHUP, signal.SIGINT),
    "USR1": lambda p: p.signal(signal.SIGUSR1),
    "TSTP INT": lambda p: p.signal(signal.SIGTSTP, signal.SIGINT),
    "terminal closed": lambda p: p.close(),
    "INT, terminal closed": lambda p: (p.signal(signal.SIGINT), p.close()),
}
# What ends what is running and not the prompt.
STAYS = {"INT INT", "INT", "TSTP INT"}


def kill_once(number):
    how = list(ENDS)[number % len(ENDS)]
    line = chance.choice(LINES)
    what = f"{number}: {how} in '{line}'"
    prompt = Prompt()
    for node, family in ((1, families[0]), (2, families[1])):
        prompt.say(f"enable -n {node} -d {family}" + (" --turn 10000" if family in ("da200", "ts") else ""), "ENERGISED while servoctl runs")
    if not (energised(1) and energised(2)):
        fail(f"{what}: the drives are not enabled")
    line = line.format(batch=batch.name)
    os.write(prompt.fd, line.encode() + b"\r" if line else b"half a li")
    time.sleep(chance.uniform(0, 0.3))
    ENDS[how](prompt)
    if how in STAYS:
        time.sleep(chance.uniform(0, 0.2))
        if prompt.ended(0.3):
            fail(f"{what}: the prompt ended: {prompt.text[-300:]!r}")
        else:
            prompt.signal(signal.SIGTERM)
    if not prompt.ended(20):
        fail(f"{what}: the prompt does not end")
        os.kill(prompt.pid, signal.SIGKILL)
        os.waitpid(prompt.pid, 0)
    left = [energised(1), energised(2)]
    if left != [False, False]:
        fail(f"{what}: energised afterwards: {left}: {prompt.text[-400:]!r}")
        subprocess.run([servoctl, "disable", "-n", "1,2"], env=env, capture_output=True)
    if prompt.fd is not None:
        prompt.close()


said = tempfile.TemporaryFile("w+")
# Its last line goes on until a signal ends it.
batch = tempfile.NamedTemporaryFile("w", suffix=".servoctl")
batch.write("status -n 1,2\nwatch 0x6041 -n 1 --for 5s\n")
batch.flush()


def serve():
    """The simulated drives, which have answered."""
    process = subprocess.Popen([servoctl, "sim", f"{families[0]}@1,{families[1]}@2{obeying(*families)}"], env=env, stdout=subprocess.DEVNULL, stderr=said)
    end = time.monotonic() + 20
    while energised(1) is None and time.monotonic() < end:
        time.sleep(0.05)
    return process


drive = serve()
try:
    number = ended = 0
    while number < kills:
        before = failures
        kill_once(number)
        if drive.poll() is None:
            number += 1
            continue
        # The prompt is what this is about: once they may end. What they said is shown.
        said.seek(0)
        print(f"the simulated drives ended behind kill {number}: {drive.returncode}: {said.read()}", flush=True)
        ended += 1
        if ended > 1:
            fail("the simulated drives do not stay")
            break
        failures = before
        drive = serve()
finally:
    drive.terminate()
    drive.wait()
print(f"{families[0]}, {families[1]}: {kills} kills at the prompt, {failures} failures")
sys.exit(1 if failures else 0)
