#!/usr/bin/env python3
"""A gateway of CiA 309-3 as a bus: that of the program itself, and scripted ones that answer as CANopenNode and lely-core do, late,
wrong, or not at all.
usage: gateway_client_test.py SERVOCTL"""
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

from checks import check, finish
from pty_terminal import Terminal, failures

servoctl = sys.argv[1]
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env["LANG"] = "C"
folder = tempfile.mkdtemp(prefix="servoctl-gateway-client-")
path = os.path.join(folder, "socket")


def run(bus, *words):
    return subprocess.run([servoctl, "-b", bus, *words], env=env, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120)


def expect(bus, words, code, *texts):
    answer = run(bus, *words)
    said = answer.stdout + answer.stderr
    check(f"{words} is {answer.returncode}\n{said}", answer.returncode == code and all(text in said for text in texts))
    return answer


class Gateway:
    """The program as the server."""

    def __init__(self, *options, bus="sim:gsd600@1,gsd600@2"):
        self.process = subprocess.Popen([servoctl, "gateway", "-b", bus, "--listen", path, *options], env=env,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.process.stdout.readline()

    def end(self):
        self.process.send_signal(signal.SIGINT)
        self.process.communicate(timeout=20)


local = f"gateway:{path}"
gateway = Gateway("--allow", "write", "--yes")
try:
    answer = run(local, "scan", "--json")
    check(f"scan finds both\n{answer.stdout}{answer.stderr}",
          answer.returncode == 0 and [n["node"] for n in json.loads(answer.stdout)["result"]] == [1, 2])
    node = ("-n", "1", "-d", "gsd600")
    expect(local, ["read", "0x1000", "0x6041", *node], 0, "0x00020192")
    expect(local, ["write", "0x1017", "1234", *node], 0)
    expect(local, ["read", "0x1017", *node], 0, "1234")
    expect(local, ["param", "set", "Pn0214=45Hz", *node], 0)
    expect(local, ["param", "get", "Pn0214", *node], 0, "45")
    expect(local, ["read", "0x5FFF", "-n", "1", "--type", "u8"], 5, "object does not exist")
    expect(local, ["read", "0x1000", "-n", "9"], 4, "no answer within 500 ms")
    expect(local, ["status", "-n", "1,2", "-d", "gsd600"], 0)
    expect(local, ["watch", "0x6041", "--for", "300ms", *node], 0)
    saved = os.path.join(folder, "saved.json")
    expect(local, ["backup", saved, *node], 0)
    expect(local, ["param", "set", "Pn0214=60Hz", *node], 0)
    expect(local, ["restore", saved, "--yes", *node], 0)
    expect(local, ["param", "get", "Pn0214", *node], 0, "45")
    expect(local, ["verify", saved, *node], 0)
    # The prompt shows what was heard through it.
    prompt = Terminal(servoctl, "-b", local, "-n", "1", "-d", "gsd600", state=folder, size=(24, 200))
    prompt.see(r"node 1 gsd600> ")
    prompt.type("read 0x6041\r")
    prompt.see(r"node 1 gsd600 \[switch on disabled\]> ")
    prompt.type("\x04")
    check(f"the prompt ends: {failures}", prompt.exit_code() == 0 and not failures)
    # NMT goes, and says what it knows.
    expect(local, ["nmt", "start", "-n", "1"], 0)
    expect(local, ["nmt", "stop", "-n", "all"], 0)
    expect(local, ["read", "0x1000", "-n", "1"], 4)
    expect(local, ["nmt", "preop", "-n", "all"], 0)
    expect(local, ["nmt", "reset-comm", "-n", "1"], 8, "--yes")
    expect(local, ["nmt", "reset-comm", "-n", "1", "--yes"], 0)
    expect(local, ["nmt", "start", "-n", "1", "--wait"], 2, "a gateway passes on none")
    expect(local, ["nmt", "start", "-n", "1", "--dry-run"], 0, "1 1 start")
    # No motor gets power over it; the ways out work.
    for words in (["jog", "60rpm", "--turn", "10000", "--for", "1s"], ["enable"], ["write", "0x6040", "15"],
                  ["move", "1rev", "--relative", "--turn", "10000"], ["torque", "5%", "--for", "1s"]):
        expect(local, [*words, "--yes", *node], 8, "nobody stops the motor")
    expect(local, ["disable", *node], 0)
    expect(local, ["quick-stop", *node], 0)
    expect(local, ["gateway", "--allow", "write", "--yes", "--listen", path + "2"], 8, "nobody stops the motor")
    for words in (["monitor", "--for", "1s"], ["pdo", "watch", "TPDO1", "--for", "1s", *node], ["sync", "once"], ["lss", "scan"]):
        expect(local, words, 2, "needs CAN")
    expect(local, ["state", "op", *node], 2, "needs EtherCAT")
    expect(local, ["read", "0x1000", "-n", "1", "--trace", os.path.join(folder, "t.log")], 2, "no trace of a gateway")
    expect(local + "x", ["scan"], 3, "nothing listens at")
finally:
    gateway.end()
expect(local, ["scan"], 3, "nothing listens at", "is a gateway started there")
gateway = Gateway()
try:
    expect(local, ["read", "0x1000", "-n", "1"], 0)
    expect(local, ["write", "0x1017", "1", "-n", "1", "--type", "u16"], 8, "only reads", "--allow write")
    expect(local, ["nmt", "start", "-n", "1"], 8, "only reads")
finally:
    gateway.end()


# Nor by a parameter that energises a motor without 6040h, whichever command writes it.
with open(os.path.join(folder, "forced"), "w") as lines:
    lines.write(f"param set Pn0600=1 --yes -n 1\nbackup {folder}/forced.json -n 1\n")
made = subprocess.run([servoctl, "-b", "sim:gsd600@1", "-d", "gsd600", "run", lines.name], env=env, stdin=subprocess.DEVNULL,
                      capture_output=True, text=True)
check(f"a backup with an input that is forced on\n{made.stderr}", made.returncode == 0)
gateway = Gateway("--allow", "write", "--yes", bus="sim:ts@1,gsd600@2")
try:
    ts = ("-n", "1", "-d", "ts", "--yes")
    expect(local, ["param", "set", "Fn_00=1", "Fn_33=500", "Fn_38=1", "--unlock", *ts], 8, "without the controlword", "nobody stops the motor")
    for words in (["param", "set", "Fn_20C=1"], ["param", "set", "Fn_20D=1"], ["write", "0x2038", "1"]):
        expect(local, [*words, *ts], 8, "without the controlword", "nobody stops the motor")
    expect(local, ["write", "0x2038", "1", "--type", "u16", "-n", "1", "--yes"], 8, "without its family", "-d FAMILY")
    expect(local, ["write", "0x2038", "0", "--type", "u16", "-n", "1", "--yes"], 0)
    held = json.loads(run(local, "param", "get", "Fn_33", "Fn_38", "Fn_20C", "Fn_20D", "--json", *ts[:4]).stdout)["result"]
    check(f"nothing of it was written: {held}", [value["raw"] for value in held] == [0, 0, 0, 0])
    expect(local, ["param", "set", "Fn_38=0", "Fn_33=500", *ts], 0)
    expect(local, ["restore", f"{folder}/forced.json", "-n", "2", "-d", "gsd600", "--yes", "--force"], 8, "without the controlword")
    expect(local, ["param", "get", "Pn0600", "-n", "2", "-d", "gsd600", "--json"], 0, '"raw":0')
finally:
    gateway.end()

# The other way round: what a client of the gateway energised so does not stay when it goes.
gateway = Gateway("--allow", "write", "--yes", "-d", "ts", bus="sim:ts@1")
try:
    with socket.socket(socket.AF_UNIX) as client:
        client.connect(path)
        client.settimeout(10)
        for number, line in enumerate(("1 w 0x220C 0 u16 1", "1 w 0x2038 0 u16 1"), 1):
            client.sendall(f"[{number}] {line}\r\n".encode())
            check(f"a client writes {line}", client.recv(100) == f"[{number}] OK\r\n".encode())
        expect(local, ["read", "0x2038", "-n", "1", "-d", "ts", "--json"], 0, '"raw":1')
    for _ in range(200):
        answer = run(local, "read", "0x2038", "0x220E", "-n", "1", "-d", "ts", "--json")
        if '"raw":0' in answer.stdout:
            break
        time.sleep(0.05)
    check(f"it is disabled, and its path stopped\n{answer.stdout}",
          [value["raw"] for value in json.loads(answer.stdout)["result"]] == [0, 1])
finally:
    gateway.end()


class Listening:
    """A place at which gateways are looked for; who derives from it serves each client."""

    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.bus = f"gateway://127.0.0.1:{self.listener.getsockname()[1]}"
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()


class Scripted(Listening):
    """Answers each line by what `answer` makes of its number and its words."""

    def __init__(self, answer, sets=lambda words: "OK\r\n"):
        self.answer, self.sets = answer, sets
        self.lines = []
        super().__init__()

    def serve(self, client):
        try:
            for line in client.makefile("r", newline="\r\n"):
                self.lines.append(line.strip())
                number, *words = line.split()
                text = self.sets(words) if "set" in words else self.answer(words)
                if text is None:
                    client.shutdown(socket.SHUT_RDWR)
                    return
                client.sendall(f"{number} {text}".encode() if not text.startswith("!") else text[1:].replace("#", number).encode())
        except OSError:
            pass


# The family is named: 1000h and 1018h are not asked first.
READ = ["read", "0x1017", "-n", "4", "--type", "u16", "-d", "gsd600"]
CASES = [
    ("CANopenNode", "6AM=\r\n", 0, "1000"),
    ("CANopenNode refuses", "ERROR:0x06020000 #Object does not exist.\r\n", 5, "object does not exist"),
    ("lely-core refuses", "ERROR: 06020000 (Object does not exist)\r\n", 5, "object does not exist"),
    ("lely-core does not know the node", "ERROR: 107 (Unsupported node)\r\n", 2, "Unsupported node"),
    ("it times out", "ERROR:0x05040000 #SDO protocol timed out.\r\n", 4, "no answer within"),
    ("it does not understand", "ERROR:101 #Syntax error.\r\n", 6, "domains"),
    ("events stand before the answer", "!1 4 BOOT_UP\r\n1 4 EMCY 8130 11 0 0 0 0 0\r\n# 6AM=\r\n", 0, "1000"),
    ("an answer to another one", "![77] AAA=\r\n# 6AM=\r\n", 0, "1000"),
    ("lines end with LF", "6AM=\n", 0, "1000"),
    ("it is no base64", "1000!\r\n", 6, "the gateway answers '1000!'"),
    ("half of it", "6AM=\n...ERROR:0x05040000 #SDO protocol timed out.\r\n", 4, "no answer within"),
    ("another length", "6AMB\r\n", 0, "E8 03 01"),
    ("no value", "OK\r\n", 6, "the gateway answers"),
    ("it goes", None, 3, "closed the connection"),
]
for name, text, code, words in CASES:
    scripted = Scripted(lambda _, text=text: text)
    answer = run(scripted.bus, *READ)
    said = answer.stdout + answer.stderr
    check(f"{name}: {answer.returncode}\n{said}", answer.returncode == code and words in said)
    check(f"what was asked: {scripted.lines}", scripted.lines[1].endswith("] 1 4 r 0x1017 0 d"))
    scripted.listener.close()

# lely-core has a timeout for each network, and no network is set: it is told in front of it.
scripted = Scripted(lambda _: "6AM=\r\n",
                    lambda words: "OK\r\n" if words[0] == "1" else "ERROR: 104 (No default net set)\r\n")
expect(scripted.bus, [*READ, "--timeout", "250ms"], 0, "1000")
check(f"the timeout is told: {scripted.lines}",
      [line.split(" ", 1)[1] for line in scripted.lines[:3]] == ["set sdo_timeout 500", "1 set sdo_timeout 500", "1 set sdo_timeout 250"])
scripted.listener.close()

# A gateway that is killed, or whose cable is pulled, in the middle: an error at once, no file that looks whole, and at the prompt the
# next line connects anew.
class Relay(Listening):
    """Between a client and a gateway: slow, and cut after so many lines."""

    def __init__(self, lines):
        self.left, self.asked = lines, 0
        super().__init__()

    def serve(self, client):
        server = socket.socket(socket.AF_UNIX)
        try:
            server.connect(path)
            answers = server.makefile("r", newline="\r\n")
            for line in client.makefile("r", newline="\r\n"):
                self.asked += 1
                if self.left == 0:
                    break
                self.left -= 1
                server.sendall(line.encode())
                client.sendall(answers.readline().encode())
        except OSError:
            pass
        server.close()
        try:
            client.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        client.close()


gateway = Gateway("--allow", "write", "--yes")
try:
    for words in (["backup", os.path.join(folder, "cut.json")], ["read", *["0x6041"] * 200], ["watch", "0x6041", "--for", "4s"]):
        relay = Relay(60 if words[0] != "watch" else 20)
        begin = time.monotonic()
        answer = expect(relay.bus, [*words, "-n", "1", "-d", "gsd600"], 3, relay.bus.split("//")[1])
        check(f"why: {answer.stderr}", "closed the connection" in answer.stderr or "is lost" in answer.stderr)
        check(f"{words[0]} ends at once: {time.monotonic() - begin:.1f} s, {relay.asked} lines", time.monotonic() - begin < 15 and relay.asked <= 63)
        relay.listener.close()
    check("a backup that was cut is no file", not os.path.exists(os.path.join(folder, "cut.json")))
    relay = Relay(30)
    with open(os.path.join(folder, "lines"), "w") as lines:
        lines.write("on-error continue\n" + "read 0x6041 -n 1\n" * 40)
    answer = run(relay.bus, "run", lines.name)
    check(f"the next line connects anew\n{answer.stdout[-400:]}{answer.stderr}",
          answer.stderr.count("closed the connection") >= 1 and answer.returncode == 3)
    relay.left = 1000
    expect(relay.bus, ["read", "0x6041", "-n", "1"], 0)
    relay.listener.close()
finally:
    gateway.end()

# A write has its bytes as they go to the drive, and is never repeated.
scripted = Scripted(lambda words: "OK\r\n" if words[2] == "w" else "ZAA=\r\n")
expect(scripted.bus + "/2", ["write", "0x1017", "100", "-n", "4", "--type", "u16"], 0)
check(f"the write: {scripted.lines}", [line.split(" ", 1)[1] for line in scripted.lines if " w " in line] == ["2 4 w 0x1017 0 d ZAA="])
scripted = Scripted(lambda words: None if words[2] == "w" else "ZAA=\r\n")
answer = run(scripted.bus, "write", "0x1017", "100", "-n", "4", "--type", "u16")
check(f"a write whose connection breaks\n{answer.stderr}", answer.returncode == 3 and len([x for x in scripted.lines if " w " in x]) == 1)

# What is no gateway.
silent = socket.create_server(("127.0.0.1", 0))
started = time.monotonic()
expect(f"gateway://127.0.0.1:{silent.getsockname()[1]}", ["scan"], 3, "does not answer as a gateway of CiA 309-3")
check("is given up", time.monotonic() - started < 6)
for wrong in ("gateway:", "gateway:x", "gateway://", "gateway://h:0", "gateway://h/x"):
    expect(wrong, ["scan"], 2)
# One that hangs in the midst of a backup, its connection not closed: told once, and the next line connects anew.
gateway = subprocess.Popen([servoctl, "gateway", "-b", "sim:gsd600@1?delay=5ms", "--listen", path], env=env, stdin=subprocess.DEVNULL,
                           stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
gateway.stdout.readline()
try:
    backup = subprocess.Popen([servoctl, "-b", local, "-n", "1", "-d", "gsd600", "backup", os.path.join(folder, "cut.json")], env=env,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(0.7)
    check("the backup is under way", backup.poll() is None)
    gateway.send_signal(signal.SIGSTOP)
    begun = time.monotonic()
    said = backup.communicate(timeout=60)[1]
    check(f"a gateway that hangs is told once, after {time.monotonic() - begun:.1f} s\n{said}",
          backup.returncode == 3 and said.count("error:") == 1 and said.count("does not answer any more: waiting until it can") == 1
          and said.count("does not answer any more") == 2 and time.monotonic() - begun < 26)
    check("no file is made of half a backup", not os.path.exists(os.path.join(folder, "cut.json")))
    gateway.send_signal(signal.SIGCONT)
    expect(local, ["read", "0x1000", "-n", "1"], 0, "0x00020192")
finally:
    gateway.kill()
    gateway.communicate()
finish()
