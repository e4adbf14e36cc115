#!/usr/bin/env python3
"""The same PDOs over each kind of CAN bus: mapped, watched, sampled, sent, with CAN-IDs of 11 and 29 bits, and with another
master that resets the drive meanwhile.
usage: pdo_buses_test.py SERVOCTL [INTERFACE]   (an interface of SocketCAN: that alone)"""
import json
import os
import subprocess
import sys
import tempfile

from checks import check, finish, needs_serial_lines
from serial_adapters import Adapter, Wire
from socketcand_server import Server

servoctl = sys.argv[1]
needs_serial_lines(servoctl)
folder = tempfile.TemporaryDirectory()
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env.update(LANG="C", XDG_STATE_HOME=folder.name)


class Bus:
    """A simulated drive, and the names under which two masters reach its bus."""

    def __init__(self, name, drive, masters):
        self.name, self.masters = name, masters
        self.drive = subprocess.Popen([servoctl, "sim", "gsd600@1,cia402@2", "-b", drive], env=env, stdout=subprocess.PIPE,
                                      stderr=subprocess.DEVNULL, text=True)
        self.drive.stdout.readline()

    def start(self, *words, master=0):
        return subprocess.Popen([servoctl, "-b", self.masters[master], *words], env=env, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True)

    def run(self, *words, master=0):
        done = self.start(*words, master=master)
        out, err = done.communicate(timeout=60)
        return done.returncode, out, err

    def check(self, what, *words, says, code=0):
        done, out, err = self.run(*words)
        check(f"{self.name}: {what}: {' '.join(words)}\nexit {done}\n{out[-1500:]}{err}", done == code and says in out + err)
        return out

    def end(self):
        self.drive.terminate()
        self.drive.communicate()


def long_ids(bus):
    node = ("-n", "2", "-d", "cia402")
    bus.check("a TPDO is given 29 bits", "pdo", "map", "TPDO1", "statusword", "--cob-id", "0x18ABCDEF", "--type", "255", "--event",
              "20ms", "--yes", *node, says="18ABCDEF")
    bus.check("an RPDO too", "pdo", "map", "RPDO1", "target_velocity", "--cob-id", "0x1ABCDE01", "--type", "255", "--yes", *node,
              says="1ABCDE01")
    bus.run("nmt", "start", "-n", "2")
    bus.check("it is watched", "pdo", "watch", "TPDO1", "--for", "400ms", *node, says="Statusword 0x")
    bus.check("it is decoded", "monitor", "--for", "300ms", "--ask", *node, says="TPDO1 Statusword 0x")
    bus.check("it is sampled", "watch", "statusword", "--for", "400ms", "--json", *node, says='"by":"pdo"')
    bus.check("it is sent", "pdo", "send", "RPDO1", "1234", "--yes", *node, says="1ABCDE01")
    bus.check("it has arrived", "read", "target_velocity", "--json", *node, says='"raw":1234')
    bus.check("the doctor knows", "doctor", *([] if ":" in bus.masters[0] else [bus.masters[0]]), "--for", "300ms", "--json",
              says="foreign-frames", code=0)
    bus.run("nmt", "preop", "-n", "2")


def a_reset_of_another_master(bus):
    node = ("-n", "1", "-d", "gsd600")
    bus.check("the torque is mapped where the statusword was", "pdo", "map", "TPDO1", "0x6077", "--type", "255", "--event", "20ms",
              "--yes", *node, says="TPDO1")
    bus.run("nmt", "start", "-n", "1")
    watch = bus.start("watch", "0x6077", "--for", "4s", "--every", "50ms", "--json", *node)
    try:
        watch.wait(timeout=1)
    except subprocess.TimeoutExpired:
        pass
    bus.run("nmt", "reset", "--wait", "-n", "1", "--yes", master=1)
    bus.run("nmt", "start", "-n", "1", master=1)
    out, err = watch.communicate(timeout=60)
    document = json.loads(out)
    samples = [value for sample in document["result"]["samples"] for value in sample["values"]]
    check(f"{bus.name}: no value of the other mapping is shown\n{out[-1500:]}{err}", {value["raw"] for value in samples} == {0})
    check(f"{bus.name}: first by PDO, then by SDO", [samples[0]["by"], samples[-1]["by"]] == ["pdo", "sdo"]
          or "pdo" in {value["by"] for value in samples})
    check(f"{bus.name}: it is said\n{document['notices']}", any("its values are read by SDO until its PDO mapping" in notice
                                                               for notice in document["notices"]))


def try_all(bus):
    try:
        long_ids(bus)
        a_reset_of_another_master(bus)
    finally:
        bus.end()


if len(sys.argv) > 2:
    try_all(Bus("SocketCAN", sys.argv[2], [sys.argv[2]] * 2))
    finish()

try_all(Bus("local", "local:pdo-buses", ["local:pdo-buses"] * 2))

wire = Wire()
adapters = [Adapter(wire) for _ in range(3)]
ports = [f"slcan:{adapter.path}@500k" for adapter in adapters]
try_all(Bus("slcan", ports[0], ports[1:]))
wire.close()

server = f"socketcand://127.0.0.1:{Server().port}/vcan0"
try_all(Bus("socketcand", server, [server] * 2))
finish()
