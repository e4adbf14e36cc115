#!/usr/bin/env python3
"""One run over several adapters at once: drives behind a serial adapter, behind a server of socketcand, and on a local bus; one
adapter is unplugged in the middle while the others go on.
usage: several_buses_test.py SERVOCTL"""
import json
import os
import subprocess
import sys
import tempfile
import time

from checks import check, finish, needs_serial_lines
from serial_adapters import Adapter, Wire
from socketcand_server import Server

servoctl = sys.argv[1]
needs_serial_lines(servoctl)
folder = tempfile.mkdtemp(prefix="servoctl-several-")
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env |= {"LANG": "C", "XDG_RUNTIME_DIR": os.path.join(folder, "run"), "XDG_STATE_HOME": os.path.join(folder, "state")}
for place in ("run", "state"):
    os.mkdir(os.path.join(folder, place), 0o700)
AXES = ("serial", "server", "near")


class World:
    """Three buses with a drive on each, and a cabinet file that names them."""

    def __init__(self):
        self.wire = Wire()
        self.far = Adapter(self.wire)
        self.port = os.path.join(folder, "adapter")
        self.plug()
        self.server = Server()
        self.buses = {"serial": f"slcan:{self.port}@500k", "server": f"socketcand://127.0.0.1:{self.server.port}/vcan0",
                      "near": f"local:several{os.getpid()}"}
        places = {**self.buses, "serial": f"slcan:{self.far.path}@500k"}
        self.drives = [subprocess.Popen([servoctl, "sim", "gsd600@1", "-b", places[axis]], env=env, stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True) for axis in AXES]
        for drive in self.drives:
            drive.stdout.readline()
        self.cabinet = os.path.join(folder, "cabinet.toml")
        with open(self.cabinet, "w") as file:
            for axis in AXES:
                file.write(f'[bus.{axis}]\nurl = "{self.buses[axis]}"\n[axis.{axis}]\nbus = "{axis}"\nnode = 1\nfamily = "gsd600"\n'
                           f'[axis.{axis}.parameters]\n"0x6083" = 4321\n')

    def plug(self):
        self.adapter = Adapter(self.wire)
        os.symlink(self.adapter.path, self.port)

    def unplug(self):
        os.remove(self.port)
        self.adapter.unplug()
        self.wire.adapters.remove(self.adapter)

    def start(self, *words, **more):
        return subprocess.Popen([servoctl, "--cabinet", self.cabinet, *words], env=env, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)

    def run(self, *words):
        process = self.start(*words)
        out, err = process.communicate(timeout=90)
        return process.returncode, out, err

    def value(self, axis):
        code, out, _ = self.run("read", "0x6083", "-n", axis, "--json")
        return json.loads(out)["result"][0]["value"] if code == 0 else None

    def end(self):
        for drive in self.drives:
            drive.terminate()
            drive.communicate()
        self.wire.close()


world = World()
everybody = ",".join(AXES)
try:
    # A line with all three: reads and a write.
    code, out, err = world.run("read", "0x1000", "-n", everybody, "--json")
    rows = json.loads(out)["result"]
    check(f"one line reads on three buses\n{out}{err}", code == 0 and [row["axis"] for row in rows] == list(AXES)
          and all(row["value"] == 131474 for row in rows))
    code, out, err = world.run("write", "0x6083", "1234", "-n", everybody, "--yes")
    check(f"one line writes on three buses\n{out}{err}", code == 0)
    check("each drive has it", [world.value(axis) for axis in AXES] == [1234] * 3)
    code, out, err = world.run("status", "-n", everybody)
    check(f"one line shows the state of all\n{out}{err}", code == 0 and all(axis in out for axis in AXES))

    # A batch file, with one adapter unplugged in its middle: the others go on, what is not done is told.
    lines = os.path.join(folder, "lines")
    with open(lines, "w") as file:
        file.write(f"on-error continue\nread 0x1000 -n {everybody}\nwait 2s\nread 0x1000 -n server,near\nread 0x1000 -n serial\n"
                   f"write 0x6083 2345 -n {everybody} --yes\nwrite 0x6083 3456 -n near --yes\n")
    batch = world.start("run", lines)
    time.sleep(1.5)
    world.unplug()
    out, err = batch.communicate(timeout=90)
    check(f"a batch goes on over the buses that are there\n{out}{err}",
          batch.returncode not in (0, 70) and out.count("0x00020192") == 5 and err.count("adapter") >= 1)
    check(f"the one that is gone is named\n{err}", "adapter is gone" in err or "there is no " in err)
    check(f"the last line was carried out, and no more than was said: {[world.value(axis) for axis in AXES[1:]]}",
          world.value("near") == 3456 and world.value("server") in (1234, 2345))

    # A wait ends with the bus that is lost, whatever else is there: a drive on another one may be turning.
    world.plug()
    with open(lines, "w") as file:
        file.write(f"read 0x1000 -n {everybody}\nwait 40s\nread 0x1000 -n near\n")
    begun = time.monotonic()
    batch = world.start("run", lines)
    time.sleep(2)
    world.unplug()
    out, err = batch.communicate(timeout=90)
    check(f"a wait ends when a bus is lost\n{out}{err}", batch.returncode == 3 and time.monotonic() - begun < 25)
    check(f"its line is named\n{err}", "lines:2" in err)

    # A report over several buses that loses one: the other ones are not said to be lost, and stay open.
    world.plug()
    prompt = subprocess.Popen([servoctl, "--cabinet", world.cabinet], env=env, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
    page = os.path.join(folder, "report.html")
    prompt.stdin.write(f"enable -n near --yes\nreport {page} -n near,serial --yes\n")
    prompt.stdin.flush()
    for _ in range(100):
        time.sleep(0.05)
        if len(world.adapter.heard) > 40:
            break
    world.unplug()
    out = prompt.communicate(timeout=90)[0]
    check(f"the report is not made\n{out}", not os.path.exists(page) and "adapter is gone" in out)
    check(f"nothing is said of the other bus\n{out}", f"{world.buses['near']} was lost" not in out)
    check(f"its drive is let go as lines end that end with an error\n{out}", "near was still energised; it has been stopped" in out)

    # While an adapter is waited for nobody serves another bus: its SYNC ends before, and not behind it.
    late = Adapter(world.wire, delay=1.0)
    lines = subprocess.Popen([servoctl], env=env, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    lines.stdin.write(f"sync start --period 50ms --yes -b {world.buses['near']}\n")
    lines.stdin.flush()
    time.sleep(1)
    begun = time.monotonic()
    lines.stdin.write(f"scan -n 1 -b slcan:{late.path}@500k\n")
    lines.stdin.flush()
    told = ""
    while "no longer produced" not in told and (line := lines.stderr.readline()):
        told += line
    after = time.monotonic() - begun
    check(f"SYNC ended after {after:.1f} s\n{told}", "no longer produced" in told and after < 0.9)
    lines.communicate(timeout=90)
    check("the adapter was waited for", time.monotonic() - begun > 1.5)
    late.unplug()
    world.wire.adapters.remove(late)

    # A line with one axis out of three on a bus that is not there: the others are served, and it is said.
    code, out, err = world.run("read", "0x1000", "-n", everybody)
    check(f"a read where one bus is missing\n{out}{err}", code == 3 and out.count("0x00020192") == 2 and "there is no" in err)

    # Backup and apply with the cable back; apply while it is pulled says which axis is not done, and a second one does it.
    world.plug()
    check("the axis is back", world.value("serial") == 1234)
    code, out, err = world.run("cabinet", "plan", "--json")
    check(f"the plan of three buses\n{out}{err}", code in (0, 1) and all(axis in out for axis in AXES))
    world.unplug()
    code, out, err = world.run("cabinet", "apply", "--yes")
    check(f"an apply with one bus missing fails\n{out}{err}", code not in (0, 70) and "serial" in out + err)
    world.plug()
    code, out, err = world.run("cabinet", "apply", "--yes")
    check(f"and is done when it is back\n{out}{err}", code == 0)
    check("each drive holds what the file says", [world.value(axis) for axis in AXES] == [4321] * 3)

    code, out, err = world.run("watch", "0x6041", "--for", "1s", "-n", everybody)
    check(f"watch says that it is for one bus\n{err}", code == 2 and "one bus" in err)
    world.unplug()
    code, out, err = world.run("cabinet", "backup")
    check(f"a backup with one bus missing says so\n{out}{err}", code not in (0, 70) and "serial" in out + err)
    world.plug()
    code, out, err = world.run("cabinet", "backup")
    check(f"a backup of all\n{out}{err}", code == 0)
finally:
    world.end()
finish()
