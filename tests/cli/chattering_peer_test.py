#!/usr/bin/env python3
"""Peers that never fall silent, and never answer: gateways, socketcand servers, Modbus devices and slcan adapters that send lines,
frames or bytes without an end, as fast as they can. A read ends by its time-out, one signal ends it, and memory stays bounded.
usage: chattering_peer_test.py SERVOCTL"""
import os
import pty
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import tty

from checks import check, finish

servoctl = os.path.abspath(sys.argv[1])
folder = tempfile.mkdtemp(prefix="servoctl-chatter-")
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env.update(LANG="C", XDG_STATE_HOME=folder)
MOST_MEMORY_KB = 100_000
TIMEOUT = 3
# A loaded machine is slow; a read that a chatter keeps alive lasts for ever.
PATIENCE = 60


class Peer:
    """Answers what opens a bus; from the first request of a node on it says `chatter` again and again, and nothing else."""

    def __init__(self, chatter):
        self.chatter = chatter * max(1, 65536 // len(chatter))
        self.asked = threading.Event()
        self.over = threading.Event()
        self.said = 0

    def start(self, work):
        self.thread = threading.Thread(target=work, daemon=True)
        self.thread.start()
        return self

    def talk(self, write):
        """`write` gives how many bytes were taken, or raises OSError once the program is gone."""
        self.asked.set()
        try:
            while not self.over.is_set():
                self.said += write(self.chatter)
        except OSError:
            pass


class TcpPeer(Peer):
    def __init__(self, chatter):
        super().__init__(chatter)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.start(self.serve)

    def serve(self):
        try:
            client, _ = self.listener.accept()
            with client:
                self.open(client)
                self.talk(client.send)
        except OSError:
            pass

    def close(self):
        self.over.set()
        self.listener.close()


class GatewayPeer(TcpPeer):
    bus = property(lambda self: f"gateway://127.0.0.1:{self.port}")
    family = ()

    def open(self, client):
        pending = b""
        while data := client.recv(4096):
            pending += data
            while b"\n" in pending:
                line, pending = pending.split(b"\n", 1)
                if re.search(rb"\] +(\d+ +)?\d+ +r", line):
                    return
                client.sendall(line.split(b"]")[0] + b"] OK\r\n")


class SocketcandPeer(TcpPeer):
    bus = property(lambda self: f"socketcand://127.0.0.1:{self.port}/vcan0")
    family = ()

    def open(self, client):
        client.sendall(b"< hi >")
        pending = b""
        while data := client.recv(4096):
            pending += data
            while b">" in pending:
                element, pending = pending.split(b">", 1)
                words = element.lstrip(b"< ").split()
                if words[0] == b"send":
                    return
                client.sendall(b"< echo >" if words[0] == b"echo" else b"< ok >")


class ModbusTcpPeer(TcpPeer):
    bus = property(lambda self: f"modbus://127.0.0.1:{self.port}")
    family = ("-d", "ts")

    def open(self, client):
        client.recv(4096)


class PtyPeer(Peer):
    """The other end of a serial line."""

    def __init__(self, chatter):
        super().__init__(chatter)
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        self.path = os.ttyname(self.slave)
        self.start(self.serve)

    def serve(self):
        try:
            self.open()
            os.set_blocking(self.master, False)
            self.talk(self.write)
        except OSError:
            pass

    def write(self, data):
        try:
            return os.write(self.master, data)
        except BlockingIOError:
            time.sleep(0.0005)  # Until the program has read some of it.
            return 0

    def close(self):
        self.over.set()
        self.thread.join(1)
        os.close(self.slave)
        os.close(self.master)


class ModbusPeer(PtyPeer):
    bus = property(lambda self: f"modbus:{self.path}@115200,8N1")
    family = ("-d", "ts")

    def open(self):
        os.read(self.master, 4096)


class SlcanPeer(PtyPeer):
    bus = property(lambda self: f"slcan:{self.path}@500k")
    family = ()

    def open(self):
        pending = b""
        while data := os.read(self.master, 4096):
            pending += data
            while b"\r" in pending:
                line, pending = pending.split(b"\r", 1)
                if line[:1] == b"t":
                    os.write(self.master, b"z\r")
                    return
                os.write(self.master, {b"V": b"V1013\r", b"F": b"F00\r"}.get(line[:1], b"\r"))


PEERS = [
    ("gateway, lines that are no answer", GatewayPeer, b"[4000000000] 1234\r\n"),
    ("gateway, events", GatewayPeer, b"1 2 USER BOOT_UP\r\n"),
    ("gateway, a line without an end", GatewayPeer, b"x"),
    ("gateway, an answer without an end", GatewayPeer, b"[2] "),
    ("socketcand, frames", SocketcandPeer, b"< frame 7FF 1.000000 00 >"),
    ("socketcand, SDO answers of another object", SocketcandPeer, b"< frame 581 1.000000 4F01200001000000 >"),
    ("socketcand, elements that mean nothing", SocketcandPeer, b"< what >"),
    ("socketcand, an element without an end", SocketcandPeer, b"< frame 7FF "),
    ("Modbus TCP, answers to nobody", ModbusTcpPeer, struct.pack(">HHHBBBH", 60000, 0, 5, 1, 3, 2, 7)),
    ("Modbus RTU, bytes", ModbusPeer, b"\x55"),
    ("Modbus RTU, the beginnings of answers", ModbusPeer, b"\x01\x03\x02"),
    ("slcan, frames", SlcanPeer, b"t7FF100\r"),
    ("slcan, a line without an end", SlcanPeer, b"t"),
]


def begin(peer, timeout, *words):
    errors = tempfile.TemporaryFile("w+", dir=folder)
    process = subprocess.Popen([servoctl, "-b", peer.bus, *words, "-n", "1", *peer.family, "--timeout", timeout, "--retries", "0"],
                               env=env, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors)
    return process, errors


def wait(process):
    """Exit code, most memory in kB, or None where it had to be killed."""
    limit = threading.Timer(PATIENCE, process.kill)
    limit.start()
    _, status, usage = os.wait4(process.pid, 0)
    limit.cancel()
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, usage.ru_maxrss


def text(errors):
    errors.seek(0)
    return errors.read()


for name, kind, chatter in PEERS:
    line = ("param", "get", "Fn_33") if kind in (ModbusPeer, ModbusTcpPeer) else ("read", "0x1000")
    peer = kind(chatter)
    process, errors = begin(peer, f"{TIMEOUT}s", *line)
    code, memory = wait(process)
    said = text(errors)
    check(f"{name}: the read ends with an error\n{said}", peer.asked.is_set() and code in (3, 4, 6) and "error: " in said)
    check(f"{name}: the error is none of servoctl\n{said}", "bug" not in said)
    check(f"{name}: {memory} kB of memory, {peer.said} bytes came", memory < MOST_MEMORY_KB)
    peer.close()
    for number in (signal.SIGINT, signal.SIGTERM):
        peer = kind(chatter)
        process, errors = begin(peer, "600s", *line)
        asked = peer.asked.wait(PATIENCE)
        while asked and peer.said < 65536 and process.poll() is None and peer.thread.is_alive():
            time.sleep(0.01)  # The signal finds it in the midst of the chatter.
        if process.poll() is None:
            process.send_signal(number)
            code, memory = wait(process)
            check(f"{name}: one {signal.Signals(number).name} ends it with 130, not {code}\n{text(errors)}", code == 130)
        else:
            check(f"{name}: it ended by itself with {process.returncode}\n{text(errors)}", "without an end" in name and process.returncode in (3, 6))
        peer.close()

finish()
