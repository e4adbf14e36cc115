#!/usr/bin/env python3
"""The program on a bus behind a server of the socketcand protocol, written here from its doc/protocol.md: a simulated drive is
one client, commands are others.
usage: socketcand_test.py SERVOCTL"""
import json
import os
import socket
import subprocess
import sys
import threading
import time

from checks import check, finish

servoctl = sys.argv[1]
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env["LANG"] = "C"


class Server:
    """Raw mode of one interface, vcan0. Like socketcand it ends the connection when it reads half an element."""

    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.clients = []
        self.halves = 0
        self.bus = threading.Lock()  # A bus has one order for all: without it an answer could come before its question.
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        client.sendall(b"< hi >")
        try:
            while data := client.recv(8290):
                if not data.endswith(b">"):
                    self.halves += 1
                    break
                for element in data.decode().split(">")[:-1]:
                    if not self.answer(client, element.lstrip("< ").split()):
                        return
        except OSError:
            pass
        finally:
            if client in self.clients:
                self.clients.remove(client)
            client.close()

    def answer(self, client, words):
        if words[0] == "open":
            client.sendall(b"< ok >" if words[1] == "vcan0" else b"< error could not open bus >")
            return words[1] == "vcan0"
        if words[0] == "rawmode":
            self.clients.append(client)
            client.sendall(b"< ok >")
        elif words[0] == "echo":
            client.sendall(b"< echo >")
        elif words[0] == "send":
            data = "".join(f"{int(word, 16):02X}" for word in words[3:])
            frame = f"< frame {words[1]} {time.time():.6f} {data} >".encode()
            with self.bus:
                self.forward(client, frame)
        return True

    def forward(self, sender, frame):
        for other in list(self.clients):
            if other is sender:
                continue
            try:
                other.sendall(frame)
            except OSError:
                pass  # It is gone; its own thread finds out.


def run(bus, *words):
    return subprocess.run([servoctl, "-b", bus, *words], env=env, capture_output=True, text=True, timeout=60)


server = Server()
bus = f"socketcand://127.0.0.1:{server.port}/vcan0"
drive = subprocess.Popen([servoctl, "sim", "gsd600@1", "-b", bus], env=env, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
drive.stdout.readline()
try:
    answer = run(bus, "scan", "--json")
    check(f"scan finds the drive\n{answer.stdout}{answer.stderr}",
          answer.returncode == 0 and [n["node"] for n in json.loads(answer.stdout)["result"]] == [1])
    answer = run(bus, "nmt", "watch", "-n", "1", "--guard", "100ms", "--for", "1s")
    check(f"node guarding is refused\n{answer.stderr}", answer.returncode == 2 and "its protocol has none" in answer.stderr)
    answer = run(bus.replace("vcan0", "can7"), "scan")
    check(f"an interface that is refused\n{answer.stderr}", answer.returncode == 3 and "refuses can7: could not open bus" in answer.stderr)

    jog = subprocess.Popen([servoctl, "-b", bus, "jog", "60rpm", "--for", "20s", "-n", "1", "-d", "gsd600", "--turn", "10000", "--yes"],
                           env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(500):
        state = json.loads(run(bus, "status", "-n", "1", "-d", "gsd600", "--json").stdout or "{}")
        if state.get("result") and state["result"][0]["energised"]:
            break
        time.sleep(0.02)
    for client in list(server.clients)[1:]:
        try:
            client.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass  # It is gone already.
    out, err = jog.communicate(timeout=30)
    check(f"a connection that breaks in a motion is made anew and the drive stopped\n{out}{err}",
          "closed the connection" in err and "is back after" in err and jog.returncode not in (0, 70))
    state = json.loads(run(bus, "status", "-n", "1", "-d", "gsd600", "--json").stdout)
    check(f"the drive is not energised: {state}", state["result"][0]["energised"] is False)
    check("no command was sent in halves", server.halves == 0)
finally:
    drive.terminate()
    drive.communicate()
    server.listener.shutdown(socket.SHUT_RDWR)  # Its thread waits in accept().
    server.listener.close()

answer = run(bus, "scan")
check(f"a server that is gone\n{answer.stderr}", answer.returncode == 3 and "nothing listens at" in answer.stderr)
for wrong in ("socketcand:vcan0", "socketcand://127.0.0.1", "socketcand://127.0.0.1:x/vcan0"):
    answer = run(wrong, "scan")
    check(f"{wrong}\n{answer.stderr}", answer.returncode == 2 and "write socketcand://HOST/can0" in answer.stderr)
finish()
