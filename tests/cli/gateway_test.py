#!/usr/bin/env python3
"""A gateway of CiA 309-3 and its clients: the lines of cocomm, garbage, half lines, floods, clients that go or are killed, and
what is refused.
usage: gateway_test.py SERVOCTL"""
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time

from checks import check, finish

servoctl = sys.argv[1]
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env["LANG"] = "C"
folder = tempfile.mkdtemp(prefix="servoctl-gateway-")


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return probe.getsockname()[1]


class Gateway:
    """The program, and what it said."""

    def __init__(self, *options, listen=None):
        self.listen = listen or f"127.0.0.1:{free_port()}"
        self.errors = open(os.path.join(folder, "stderr"), "w+")
        self.process = subprocess.Popen([servoctl, "gateway", "-b", "sim:gsd600@1,gsd600@2", "--listen", self.listen, *options],
                                        env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=self.errors, text=True)
        self.first = self.process.stdout.readline()

    def connect(self):
        if self.listen.startswith("/"):
            client = socket.socket(socket.AF_UNIX)
            client.connect(self.listen)
        else:
            host, port = self.listen.rsplit(":", 1)
            client = socket.create_connection((host, int(port)))
        client.settimeout(10)
        return client

    def said(self):
        self.errors.flush()
        with open(self.errors.name, encoding="utf-8") as file:
            return file.read()

    def awaits(self, text, seconds=10):
        end = time.monotonic() + seconds
        while text not in self.said() and time.monotonic() < end:
            time.sleep(0.02)
        return text in self.said()

    def end(self, number=signal.SIGINT):
        self.process.send_signal(number)
        self.process.communicate(timeout=20)
        return self.process.returncode


def answers(client, count):
    """So many lines, without their ends."""
    text = b""
    while text.count(b"\r\n") < count:
        piece = client.recv(65536)
        if not piece:
            break
        text += piece
    return text.decode().split("\r\n")[:-1]


def ask(client, *lines):
    client.sendall("".join(line + "\n" for line in lines).encode())
    return answers(client, len(lines))


def expect(client, line, pattern):
    got = ask(client, line)
    check(f"{line!r} is answered by {pattern!r}: {got}", len(got) == 1 and re.fullmatch(pattern, got[0]))


# What only reads.
gateway = Gateway()
check(f"it says what it does: {gateway.first}", f"at {gateway.listen}, read only" in gateway.first)
first, second = gateway.connect(), gateway.connect()
expect(first, "[1] 1 r 0x1000 0 u32", r"\[1\] 131474")
expect(first, "[2] 1 r 0x1000 0", r"\[2\] 92 01 02 00")
expect(first, "[3] 9 r 0x1000 0 u32", r"\[3\] ERROR:0x05040000 #.*")
expect(first, "[4] 1 w 0x1017 0 u16 100", r"\[4\] ERROR:102 #.*only reads.*")
expect(first, "[5] 1 start", r"\[5\] ERROR:102 #.*")
check("a refusal is told", gateway.awaits("refused 'w 0x1017 0 u16 100' of a client: --allow write allows it"))
for garbage in (b"\xff\xfe\x00\x01\n", b"GET / HTTP/1.1\r\n", b"[\n", b"]" * 3000 + b"\n", b"[1] " + b"9" * 4000 + b"\n", b'"\n'):
    second.sendall(garbage)
    got = answers(second, 1)
    check(f"{garbage[:20]!r} is refused: {got}", len(got) == 1 and re.search("ERROR:10[01]", got[0]))
second.sendall(b"[1] r " + b"x" * 1_000_000 + b"\n")
got = answers(second, 1)
check(f"a line of a megabyte: {got}", got and got[0].startswith("[1] ERROR:101") and "4096" in got[0])
for byte in b"[6] 1 r 0x1000 0 u32\n":
    second.sendall(bytes([byte]))
check("bytes that come alone are a line", answers(second, 1) == ["[6] 131474"])

# Each client has its answers in its order, whatever the other one does.
second.sendall(b"[0] set sdo_timeout 3000\n[1] 9 r 0x1000 0\n" + b"".join(b"[%d] 2 r 0x1001 0 u8\n" % i for i in range(2, 300)))
started = time.monotonic()
expect(first, "[7] 1 r 0x1000 0 u32", r"\[7\] 131474")
check("nobody waits for the silent node of another", time.monotonic() - started < 2)
got = answers(second, 300)
check(f"300 answers in order: {got[:3]}", [line.split("]")[0] for line in got] == [f"[{i}" for i in range(300)])

# A client that sends and never reads.
flood = gateway.connect()
flood.setblocking(False)
sent = 0
end = time.monotonic() + 10
try:
    while time.monotonic() < end:
        sent += flood.send(b"[1] help\n" * 1000)
        end = time.monotonic() + 0.5
except BlockingIOError:
    pass
started = time.monotonic()
expect(first, "[8] 1 r 0x1000 0 u32", r"\[8\] 131474")
check(f"a flood of {sent} bytes keeps nobody waiting", time.monotonic() - started < 5)
with open(f"/proc/{gateway.process.pid}/status", encoding="utf-8") as status:
    memory = next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))
check(f"and takes no memory: {memory} kB", memory < 64_000)
flood.close()

# Half a line, and gone; what was asked is answered to who still reads.
third = gateway.connect()
third.sendall(b"[1] 1 r 0x10")
third.close()
fourth = gateway.connect()
fourth.sendall(b"[1] 1 r 0x1000 0 u32\n[2] 1 r 0x1001 0 u8")
fourth.shutdown(socket.SHUT_WR)
check("who only ends is answered", answers(fourth, 2) == ["[1] 131474", "[2] 0"])
check("and the connection ends", fourth.recv(10) == b"")
expect(first, "[9] 1 r 0x1000 0 u32", r"\[9\] 131474")
crowd = [gateway.connect() for _ in range(30)]
expect(first, "[10] 1 r 0x1000 0 u32", r"\[10\] 131474")
for client in crowd:
    client.close()
check("Ctrl-C ends it", gateway.end() == 0)

# What may write. A drive that a client enabled does not stay so.
path = os.path.join(folder, "socket")
stale = socket.socket(socket.AF_UNIX)
stale.bind(path)
stale.close()
gateway = Gateway("--allow", "write", "--yes", listen=path)
check(f"a socket that was left behind is replaced: {gateway.first}", "clients may write" in gateway.first)
second_try = subprocess.run([servoctl, "gateway", "-b", "sim:gsd600@1", "--listen", path], env=env, capture_output=True, text=True)
check(f"one that is used is not\n{second_try.stderr}", second_try.returncode == 3 and "another program listens there" in second_try.stderr)
watcher = gateway.connect()


def enable(client):
    return [ask(client, f"[1] 1 w 0x6040 0 u16 {word}")[0] for word in (6, 7, 15)]


def state():
    return int(ask(watcher, "[1] 1 r 0x6041 0 u16")[0].split()[1]) & 0x6F


def comes_to_rest():
    end = time.monotonic() + 10
    while state() == 0x27 and time.monotonic() < end:
        time.sleep(0.02)
    return state() != 0x27


client = gateway.connect()
check("a client enables", enable(client) == ["[1] OK"] * 3)
check(f"the drive is enabled: {state():02X}", state() == 0x27)
client.close()
check("it is stopped when the client goes", comes_to_rest())
check("that is told", gateway.awaits("node 1 was still energised; it has been stopped and disabled"))
child = subprocess.Popen([sys.executable, "-c", f"""
import socket, time
s = socket.socket(socket.AF_UNIX); s.connect({path!r})
for word in (6, 7, 15): s.sendall(b"[1] 1 w 0x6040 0 u16 %d\\n" % word); s.recv(99)
print(flush=True); time.sleep(60)"""], stdout=subprocess.PIPE)
child.stdout.readline()
check(f"enabled by another process: {state():02X}", state() == 0x27)
child.kill()
child.communicate()
check("it is stopped when that is killed", comes_to_rest())
# A last line without an end may have been cut short: it is read by, and changes nothing.
for line, answer in (("[1] 1 w 0x1017 0 u16 77", r"\[1\] ERROR:101 #.*no end.*"), ("[2] 1 start", r"\[2\] ERROR:101 #.*no end.*"),
                     ("[3] 1 r 0x1000 0 u32", r"\[3\] 131474")):
    client = gateway.connect()
    client.sendall(line.encode())
    client.shutdown(socket.SHUT_WR)
    got = answers(client, 1)
    check(f"{line!r} without an end: {got}", len(got) == 1 and re.fullmatch(answer, got[0]))
client = gateway.connect()
expect(client, "[4] 1 r 0x1017 0 u16", r"\[4\] (?!77$).*")
client = gateway.connect()
enable(client)
check("SIGTERM ends the gateway", gateway.end(signal.SIGTERM) in (0, 130, 143))
check(f"and the drive is stopped\n{gateway.said()}", gateway.said().count("it has been stopped and disabled") == 3)
check("its socket is gone", not os.path.exists(path))


def refused(code, words, *options):
    answer = subprocess.run([servoctl, "gateway", *options], env=env, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=20)
    check(f"{options}: {answer.returncode}\n{answer.stderr}", answer.returncode == code and words in answer.stderr)


bus = ("-b", "sim:gsd600@1")
refused(8, "neither login nor encryption", *bus, "--listen", "0.0.0.0:60000")
refused(8, "energise and move motors", *bus, "--allow", "write")
refused(8, "--read-only forbids it", *bus, "--allow", "write", "--yes", "--read-only")
refused(2, "'127.0.0.1:x' is not a place of a gateway", *bus, "--listen", "127.0.0.1:x")
refused(3, "that is no address of this machine", *bus, "--listen", "192.0.2.1:60000", "--yes")
refused(2, "does not work over Modbus", "-b", "modbus:sim:ts@1")
text = os.path.join(folder, "text")
with open(text, "w", encoding="utf-8") as file:
    file.write("mine")
refused(3, "that is a file or a folder, and no socket", *bus, "--listen", text)
check("a file is not replaced", open(text, encoding="utf-8").read() == "mine")

# Nobody has to read the line that they print.
def unread():
    """A pipe that is full, and that nobody reads."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    try:
        while True:
            os.write(writer, b"x" * 4096)
    except BlockingIOError:
        pass
    os.set_blocking(writer, True)
    return reader, writer


def closed():
    reader, writer = os.pipe()
    os.close(reader)
    return (writer,)


def serves(listen):
    end = time.monotonic() + 10
    while time.monotonic() < end:
        try:
            with socket.create_connection(tuple(listen.rsplit(":", 1)), 1) as client:
                client.settimeout(2)
                return ask(client, "[1] 1 r 0x1000 0 u32") == ["[1] 131474"]
        except ConnectionError:
            time.sleep(0.05)
        except OSError:
            return False
    return False


for name, descriptors in (("a full pipe", unread()), ("a pipe without reader", closed()), ("a full disk", (os.open("/dev/full", os.O_WRONLY),))):
    listen = f"127.0.0.1:{free_port()}"
    bus = f"local:gateway-unread-{os.getpid()}"
    process = subprocess.Popen([servoctl, "gateway", "-b", "sim:gsd600@1", "--listen", listen], env=env, stdin=subprocess.DEVNULL,
                               stdout=descriptors[-1], stderr=subprocess.DEVNULL)
    check(f"a gateway serves although its output goes to {name}", serves(listen))
    process.send_signal(signal.SIGINT)
    try:
        left = process.wait(20)
    except subprocess.TimeoutExpired:
        process.kill()
        left = None
    check(f"and ends by Ctrl-C: {left}", left in (0, 7))
    drives = subprocess.Popen([servoctl, "sim", "gsd600@1", "-b", bus], env=env, stdin=subprocess.DEVNULL, stdout=descriptors[-1],
                              stderr=subprocess.DEVNULL)
    end = time.monotonic() + 10
    answer = None
    while time.monotonic() < end and (answer is None or answer.returncode != 0):
        answer = subprocess.run([servoctl, "read", "0x1000", "-n", "1", "-b", bus, "--timeout", "100ms"], env=env, capture_output=True, text=True)
    check(f"so does sim: {answer.stderr}", answer.returncode == 0)
    drives.send_signal(signal.SIGINT)
    try:
        left = drives.wait(20)
    except subprocess.TimeoutExpired:
        drives.kill()
        left = None
    check(f"and ends by Ctrl-C: {left}", left in (0, 7))
    for descriptor in descriptors:
        os.close(descriptor)
finish()
