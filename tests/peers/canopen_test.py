#!/usr/bin/env python3
"""servoctl against a CANopen stack of others, the package `canopen` of npm: as the node that is commissioned, as the client of a
simulated drive, and as an LSS slave and master. Both ends meet on a bus `local:NAME` (local_bus.py shares no code with it).
Where the two disagree, the check names the clause that decides.

usage: canopen_test.py SERVOCTL FOLDER_OF_THE_PACKAGES
"""
import json
import os
import queue
import subprocess
import sys
import tempfile
import threading

here = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [here, os.path.join(here, "..", "cli")]
from checks import check, finish  # noqa: E402
from local_bus import LocalBus  # noqa: E402

servoctl, packages = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
if not os.path.isdir(os.path.join(packages, "node_modules", "canopen")):
    print("skipped: the package canopen is not in", packages, "(`./dev peers` puts it there)")
    sys.exit(125)
folder = tempfile.TemporaryDirectory(prefix="servoctl-peers-")
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
os.environ["XDG_RUNTIME_DIR"] = folder.name
env.update(LANG="C", XDG_STATE_HOME=folder.name, XDG_RUNTIME_DIR=folder.name, HOME=folder.name)


class Peer:
    """A node of the other stack on the bus."""

    def __init__(self, bus, *arguments):
        self.bus = LocalBus(bus)
        self.node = subprocess.Popen(["node", os.path.join(here, "canopen_node.js"), packages, *map(str, arguments)],
                                     stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.answers, self.events = queue.Queue(), queue.Queue()
        self.ended, self.writing = False, threading.Lock()
        self.threads = [threading.Thread(target=each, daemon=True) for each in (self.take, self.give)]
        for thread in self.threads:
            thread.start()
        assert self.events.get(timeout=30)["event"] == "ready"

    def say(self, line):
        with self.writing:
            self.node.stdin.write(line + "\n")
            self.node.stdin.flush()

    def give(self):
        while not self.ended:
            frame = self.bus.receive(0.1)
            if frame and not frame[2]:
                self.say(f"f {frame[0]:x} {frame[1].hex()}")

    def take(self):
        for line in self.node.stdout:
            kind, _, rest = line.strip().partition(" ")
            if kind == "f":
                identifier, _, data = rest.partition(" ")
                self.bus.send(int(identifier, 16), bytes.fromhex(data))
            else:
                answer = json.loads(rest)
                (self.events if "event" in answer else self.answers).put(answer)

    def order(self, order, **words):
        """What came of it; an error of the other stack is {'error': …}."""
        self.say("o " + json.dumps({"order": order, **words}))
        answer = self.answers.get(timeout=30)
        return answer if "error" in answer else answer.get("result")

    def event(self, kind, timeout=10):
        while True:
            try:
                event = self.events.get(timeout=timeout)
            except queue.Empty:
                return None
            if event["event"] == kind:
                return event

    def close(self):
        self.ended = True
        self.threads[1].join()
        self.node.stdin.close()
        self.node.wait(timeout=10)
        self.threads[0].join()
        self.bus.close()


def run(bus, *words):
    done = subprocess.run([servoctl, "-b", f"local:{bus}", *words, "--json"], env=env, capture_output=True, text=True, cwd=folder.name)
    try:
        answer = json.loads(done.stdout)
        return done.returncode, answer if done.returncode == 0 else answer["error"]
    except ValueError:
        return done.returncode, {"ok": False, "stderr": done.stderr}


def value(answer):
    return answer[1]["result"][0]["value"] if answer[0] == 0 else answer


def check_objects(peer):
    """SDO transfers of every kind and size with the server of the other stack."""
    for index, kind, there, new in (("0x2000", "u8", 0x12, 0x34), ("0x2001", "i16", -2, -300), ("0x2002", "u32", 0xDEADBEEF, 5),
                                    ("0x2003", "i64", -5, -(2 ** 40))):
        check(f"{index} is {there}", value(run("peer", "read", index, "--type", kind, "-n", "5")) == there)
        code, answer = run("peer", "write", index, "--type", kind, "-n", "5", "--yes", "--", str(new))
        check(f"{index} is written: {answer}", code == 0)
        check(f"{index} holds {new} there", int(peer.order("get", index=int(index, 16))) == new)
    text = "a text that takes several segments of seven bytes"
    check("a segmented upload", value(run("peer", "read", "0x2004", "--type", "string", "-n", "5")) == text)
    code, answer = run("peer", "read", "0x2009", "--type", "u8", "-n", "5")
    check(f"what is not there is an abort 06020000h: {answer}", code == 5 and "06020000" in json.dumps(answer).upper().replace("0X", ""))
    code, answer = run("peer", "write", "0x2005", "9", "--type", "u16", "-n", "5", "--yes")
    check(f"a read-only object is an abort of the class 0601h: {answer}", code == 5 and "0601000" in json.dumps(answer))


def check_blocks(peer):
    """Domains of sizes around segments (7 bytes), blocks (127 segments) and more, each way and by each kind of transfer."""
    for size in (1, 4, 5, 7, 8, 888, 889, 890, 5000):
        data = bytes((7 * i + size) & 0xFF for i in range(size))
        for transfer in ("segmented", "block"):
            with open(os.path.join(folder.name, "out"), "wb") as file:
                file.write(data)
            code, answer = run("peer", "write", "0x2006", "--from", "out", "--transfer", transfer, "-n", "5", "--yes")
            check(f"{size} bytes, {transfer} download: {answer}", code == 0)
            code, answer = run("peer", "read", "0x2006", "--to", f"in-{size}-{transfer}", "--transfer", transfer, "-n", "5")
            try:
                back = open(os.path.join(folder.name, f"in-{size}-{transfer}"), "rb").read()
            except OSError:
                back = None
            check(f"{size} bytes, {transfer} upload: {answer if back is None else len(back)}", back == data)


def check_node(peer):
    """NMT, heartbeat, EMCY and PDOs of the other stack."""
    code, answer = run("peer", "nmt", "start", "-n", "5", "--wait")
    check(f"nmt start: {answer}", code == 0 and peer.order("state") == 5)
    watch = subprocess.Popen([servoctl, "-b", "local:peer", "monitor", "--for", "2s", "--json"], env=env, stdout=subprocess.PIPE, text=True)
    peer.event("", timeout=0.7)  # It listens by then.
    peer.order("set", index=0x2000, value=0x77)
    peer.order("emcy", code=0x3210, info="0102030405")
    frames = json.loads(watch.communicate(timeout=30)[0])
    shown = json.dumps(frames)
    check("its heartbeat is heard as operational", "operational" in shown)
    check("its emergency is 3210h", "3210" in shown)
    check("its TPDO is heard", "185" in shown or "0x185" in shown)
    code, answer = run("peer", "nmt", "preop", "-n", "5", "--wait")
    check(f"nmt preop: {answer}", code == 0 and peer.order("state") == 127)


def check_client():
    """The other stack reads and writes a simulated drive, watches its heartbeat and hears its emergency."""
    sim = subprocess.Popen([servoctl, "sim", "gsd600@1?fault=0xFF00@4s", "-b", "local:drive", "-o", "jsonl"], env=env, stdout=subprocess.PIPE, text=True)
    sim.stdout.readline()
    peer = Peer("drive", "client", 9, 1)
    check("its device type", peer.order("upload", index=0x1000, sub=0, type="UNSIGNED32") == 0x00020192)
    check("a write of 16 bits", peer.order("download", index=0x1017, sub=0, type="UNSIGNED16", value=200) is None)
    check("it is read back", peer.order("upload", index=0x1017, sub=0, type="UNSIGNED16") == 200)
    beat = peer.event("heartbeat", 5)
    check(f"its heartbeat: {beat}", beat is not None and beat["node"] == 1)
    error = peer.order("upload", index=0x5FFF, sub=0, type="UNSIGNED16")
    check(f"an object that is not there: {error}", "error" in (error or {}) and error["code"] in (0x06020000, "100794368"))
    emergency = peer.event("emcy", 10)
    check(f"its emergency: {emergency}", emergency is not None and emergency["cobId"] == 0x81 and emergency["code"] == 0xFF00)
    peer.close()
    sim.terminate()
    sim.wait(timeout=10)


def check_lss():
    """An LSS slave of the other stack is found; its master finds a simulated slave by fastscan."""
    peer = Peer("lss", "slave", 0)
    code, answer = run("lss", "lss", "scan", "--patience", "50ms")
    check(f"fastscan finds its identity: {answer}", "0x11223344" in json.dumps(answer))
    # CiA 305, switch state selective: the slave that is meant confirms with 44h. This stack does not, so servoctl selects nobody.
    code, answer = run("lss", "lss", "set-node", "7", "--vendor", "0x11223344", "--product", "2", "--revision", "3", "--serial", "4", "--yes")
    check(f"a selection that is not confirmed changes nothing: {answer}", code == 4 and peer.event("node", 1) is None)
    peer.close()
    sim = subprocess.Popen([servoctl, "sim", "gsd600@255?lss", "-b", "local:slaves", "-o", "jsonl"], env=env, stdout=subprocess.PIPE, text=True)
    sim.stdout.readline()
    master = Peer("slaves", "client", 9, 5)
    found = master.order("fastscan")
    check(f"its master finds a simulated slave: {found}", isinstance(found, dict) and "vendorId" in found)
    master.close()
    sim.terminate()
    sim.wait(timeout=10)


node = Peer("peer", "node", 5)
check_objects(node)
check_blocks(node)
check_node(node)
node.close()
check_client()
check_lss()
finish()
