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

    def __init__(self, *options):
        self.process = subprocess.Popen([servoctl, "gateway", "-b", "sim:gsd600@1,gsd600@2", "--listen", path, *options], env=env,
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


class Scripted:
    """Answers each line by what `answer` makes of its number and its words."""

    def __init__(self, answer):
        self.answer = answer
        self.lines = []
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

    def serve(self, client):
        try:
            for line in client.makefile("r", newline="\r\n"):
                self.lines.append(line.strip())
                number, *words = line.split()
                text = "OK\r\n" if words[0] == "set" else self.answer(words)
                if text is None:
                    client.shutdown(socket.SHUT_RDWR)
                    return
                client.sendall(f"{number} {text}".encode() if not text.startswith("!") else text[1:].replace("#", number).encode())
        except OSError:
            pass


READ = ["read", "0x1017", "-n", "4", "--type", "u16"]
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
finish()
