#!/usr/bin/env python3
"""What happens at the drives while a question waits for its answer is not passed over: another drive at the number, one that was enabled, a
number that was taken. And two Ctrl-C leave nothing half done.
usage: question_waits_test.py SERVOCTL"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

from checks import asked, check, finish

servoctl = os.path.abspath(sys.argv[1])
work = tempfile.TemporaryDirectory()
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env.update(LANG="C", XDG_STATE_HOME=work.name, SERVOCTL_NODE="1", SERVOCTL_DRIVE="gsd600")


def run(*words, **more):
    return subprocess.run([servoctl, *words], env=env, cwd=work.name, capture_output=True, text=True, timeout=60, **more)


class Drives:
    """Simulated ones on a bus of their own, until they are taken off it."""

    def __init__(self, spec):
        self.process = subprocess.Popen([servoctl, "sim", spec], env=env, stdout=subprocess.PIPE, text=True)
        self.process.stdout.readline()

    def leave(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.communicate()


def confirmed(words, meanwhile):
    """`y` comes behind what happens meanwhile."""
    return asked([servoctl, *words], env, b"y\n", meanwhile, folder=work.name)


def scene(number, spec="gsd600@1"):
    env["SERVOCTL_BUS"] = f"local:waits-{os.getpid()}-{number}"
    return Drives(spec)


def value(name):
    return json.loads(run("param", "get", name, "--json").stdout)["result"][0]["raw"]


def is_still(what):
    told = json.loads(run("status", "--json").stdout)["result"][0]
    check(f"{what}: the drive is without power", not told["energised"])


here = []
try:
    # Another drive stands there when the answer comes.
    for number, words in enumerate((["restore", "waits.json"], ["address", "9"], ["jog", "60rpm", "--for", "300ms", "--turn", "131072"])):
        here = [scene(number)]
        check("backup", run("backup", "waits.json", "--yes").returncode == 0)
        run("param", "set", "Pn0207=77")

        def exchange():
            here[0].leave()
            here[0] = Drives("gsd600@1")
            run("param", "set", "Pn0207=99")

        told, code = confirmed(words, exchange)
        check(f"{words[0]}, another drive: refused, not {code}\n{told}", code == 8 and "started while the question waited" in " ".join(told.split()))
        check(f"{words[0]}, another drive: it holds what it held", value("Pn0207") == 99)
        is_still(words[0])
        here[0].leave()

    # Somebody enabled it.
    for number, words in enumerate((["restore", "waits.json"], ["address", "9"], ["lss", "set-node", "9", "--only"]), 10):
        here = [scene(number, "gsd600@1?lss")]
        run("param", "set", "Pn0207=77")
        told, code = confirmed(words, lambda: run("enable", "--yes"))
        check(f"{words[0]}, enabled meanwhile: refused, not {code}\n{told}", code == 8 and "energised" in told)
        check(f"{words[0]}, enabled meanwhile: it holds what it held", value("Pn0207") == 77)
        run("disable")
        here[0].leave()

    # Somebody came to the number that it was to have.
    for number, words in enumerate((["address", "9"], ["lss", "set-node", "9", "-n", "1"]), 20):
        here = [scene(number, "gsd600@1?lss")]

        def come():
            here.append(Drives("gsd600@9?lss"))
            time.sleep(0.3)  # Until it has started.

        told, code = confirmed(words, come)
        check(f"{words[0]}, taken meanwhile: refused, not {code}\n{told}", code == 8 and "node 9" in told)
        found = json.loads(run("scan", "--json").stdout)["result"]
        check(f"{words[0]}, taken meanwhile: nobody moved", sorted(node["node"] for node in found) == [1, 9])
        for drives in here:
            drives.leave()

    # A second Ctrl-C while a restore puts back what it wrote: it goes on, and says what became of it.
    here = [scene(30, "gsd600@1?delay=3ms")]
    check("backup", run("backup", "two.json").returncode == 0)
    wanted = {"Pn0202": "321", "Pn0203": "20", "Pn0204": "10", "Pn0207": "77", "Pn0214": "45Hz", "Pn0215": "11ms", "0x605A": "1",
              "0x6065": "65536", "0x6083": "3000", "0x6084": "3000"}
    for name, number in wanted.items():
        done = run("write", name, number)
        check(f"{name} is changed: {done.stderr}", done.returncode == 0)
    run("backup", "before.json")
    process = subprocess.Popen([servoctl, "restore", "two.json", "--yes"], env=env, cwd=work.name, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True)
    journal = os.path.join(work.name, "two.json.before-node-1.json.journal")
    end = time.monotonic() + 20
    while not os.path.exists(journal) and time.monotonic() < end:
        time.sleep(0.002)
    time.sleep(0.03)
    for pause in (0.02, 0.0):
        process.send_signal(signal.SIGINT)
        time.sleep(pause)
    told = process.communicate(timeout=60)[0]
    check(f"two Ctrl-C: it says what became of it, exit {process.returncode}\n{told}", process.returncode == 130 and "as it was before" in told)
    check("two Ctrl-C: every value is as it was", run("verify", "before.json").returncode == 0)
    here[0].leave()
finally:
    for drives in here:
        if drives.process.poll() is None:
            drives.leave()
finish()
