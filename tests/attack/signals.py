#!/usr/bin/env python3
"""Signals, SIGKILL among them, single and in pairs up to 5 ms apart, at a random moment: in a motion, in a batch and at a
prompt with a drive enabled; while the output is read, is not read, or goes to a terminal that is held, and while nobody
reads the trace. Every family on its own bus, the ts over Modbus as well, one drive behind a serial adapter, a socketcand server and on
vcan0 (where there is one), and `servoctl gateway` with its clients.
Afterwards the process has ended, the exit code says so, and the drive is de-energised where docs/safety.md promises it.
usage: signals.py SERVOCTL COUNT [SEED [PAIR]]; PAIR is one of gsd600, dm, da200, ts, sv2, ts-modbus, gateway, slcan, socketcand, vcan"""
import fcntl
import json
import os
import pty
import random
import re
import select
import signal
import socket
import subprocess
import sys
import tempfile
import termios
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from serial_adapters import Adapter, Wire  # noqa: E402
from socketcand_server import Server  # noqa: E402

servoctl, count = sys.argv[1], int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
rng = random.Random(seed)
# The family, its bus, the control mode that obeys the bus, and what a motion needs.
PAIRS = {"gsd600": ("gsd600", "local:{name}", "", ["--turn", "131072"]),
         "dm": ("dm", "local:{name}", "", []),
         "da200": ("da200", "local:{name}", "P0.03=7", ["--turn", "10000"]),
         "ts": ("ts", "local:{name}", "Fn_00=20", ["--turn", "10000"]),
         "sv2": ("sv2", "coe:local:{name}", "", []),
         "ts-modbus": ("ts", "modbus://127.0.0.1:{port}", "", []),
         "gateway": ("gsd600", "local:{name}", "", []),
         "slcan": ("gsd600", "slcan:{adapter}@500k", "", ["--turn", "131072"]),
         "socketcand": ("gsd600", "socketcand://127.0.0.1:{server}/vcan0", "", ["--turn", "131072"]),
         "vcan": ("gsd600", "vcan0", "", ["--turn", "131072"])}
pairs = sys.argv[4:5] or [pair for pair in PAIRS if pair != "vcan" or os.path.exists("/sys/class/net/vcan0")]
SIGNALS = ["INT", "TERM", "HUP", "QUIT", "TSTP", "USR1", "KILL"]
# These end what is running, and not a prompt.
INTERRUPTS = {"INT", "TSTP"}
# Lines that end as interrupted ones, whatever they were about.
LINES = ["batch", "last line", "last line of input", "pipe", "last line of a pipe"]
MOTIONS = ["jog", "move"]
# The gateway itself, and its client that has enabled the drive.
SERVED = ["gateway", "client"]
PLACES = {"sv2": [*MOTIONS, *LINES, "prompt", "enable"], "ts-modbus": [*LINES, "prompt"],
          "gateway": [*SERVED, *LINES]}
# After SIGKILL these stop a motion by themselves; the sv2 does so whatever its outputs were about.
WATCHED = {"gsd600", "dm", "ts", "sv2"}
FORMS = [[], [], ["--json"], ["-o", "jsonl"]]
OUTPUTS = ["read", "stalled pipe", "held terminal", "stalled trace"]
# What a cycle brought back: the working counter is 3, and the inputs begin with the statusword.
CYCLE = re.compile(rb"\x88\xa4..\x0c.{9}.{21}(..).{25}\x03\x00", re.S)
# A client that enables the drive; it reads its answers, or it does not.
CLIENT = """import socket, sys, time
gateway = socket.socket(socket.AF_UNIX)
gateway.connect(sys.argv[1])
for word in 6, 7, 15:
    answer = b""
    while b"OK" not in answer:  # Another master who reads may disturb it.
        gateway.sendall(b"[1] 1 w 0x6040 0 u16 %d\\n" % word)
        answer = gateway.recv(100)
while True:
    gateway.sendall(b"[1] 1 r 0x6041 0\\n" * 100 if sys.argv[2] != "read" else b"")
    time.sleep(0.5)"""
failures = []
number = 0


def until(condition, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return False


class Drive:
    """A simulated drive at its bus, and a gateway in front of it where the pair has one."""

    def __init__(self, pair, folder):
        family, bus, panel, self.turn = PAIRS[pair]
        self.pair, self.folder = pair, folder
        wire, form = Wire(), bus
        with socket.create_server(("127.0.0.1", 0)) as free:
            names = {"name": f"signals-{os.getpid()}-{pair}", "port": free.getsockname()[1],
                     "server": Server().port if pair == "socketcand" else 0}
        # Who has a serial adapter has it alone: the simulator, what is attacked, and who looks have one each.
        buses = [form.format(**names, adapter=Adapter(wire).path if pair == "slcan" else "") for _ in range(3)]
        bus, self.simulated, self.attacked = buses
        self.env = {**os.environ, "SERVOCTL_BUS": bus, "SERVOCTL_NODE": "1", "SERVOCTL_DRIVE": family,
                    "XDG_STATE_HOME": folder, "TERM": "xterm"}
        self.spec = f"{family}@1?panel={panel}" if panel else f"{family}@1"
        self.trace = os.path.join(folder, f"{pair}.pcap")
        self.simulator = self.master = None
        self.begin, self.last, self.lines = "enable -y\n", "watch statusword --every 2ms --for 60s\n", "status\nobjects\n"
        self.off = [["disable"]]
        self.holds = pair not in ("ts-modbus", "gateway")  # Whether lines and a prompt disable what they enabled.
        if pair == "ts-modbus":
            self.begin, self.last = "param set Fn_38=1 -y\n", "watch Dn_00 --every 2ms --for 60s\n"
            self.lines, self.off = "param get Fn_38\nobjects\n", [["param", "set", "Fn_38=0", "-y"]]
        if pair == "sv2":  # What computes for long ends its cycles.
            self.lines = "status\nread 0x6041 0x6064\n"
        if pair == "gateway":  # Nothing is energised over a gateway.
            self.begin = "write 0x1017 777 -y\n"
            self.off.append(["write", "0x1017", "0", "-y"])

    def start(self):
        trace = ["--trace", self.trace, "-y"] if self.pair == "sv2" else []
        self.simulator = subprocess.Popen([servoctl, *trace, "sim", self.spec, "-b", self.simulated], env=self.env, stdout=subprocess.DEVNULL)
        if not until(lambda: self.energised() is False, 20):
            sys.exit(f"signals.py: no simulated drive answers: {self.pair}")

    def stop(self):
        if self.simulator:
            self.simulator.terminate()
            self.simulator.wait()
        self.simulator = None

    def ask(self, *words):
        run = subprocess.run([servoctl, *words, "--timeout", "2s", "--json"], env=self.env, capture_output=True, timeout=60)
        return json.loads(run.stdout)["result"] if run.returncode == 0 else None

    def energised(self):
        if self.pair == "ts-modbus":
            answer = self.ask("param", "get", "Fn_38")
            return answer[0]["value"] == 1 if answer else None
        if self.pair == "sv2" and self.master and self.master.poll() is None:  # An EtherCAT ring has one at a time.
            # Its drive leaves OP by itself 100 ms after the last outputs.
            with open(self.trace, "rb") as trace:
                words = CYCLE.findall(trace.read())
            return words[-1][0] & 2 > 0 and time.time() - os.path.getmtime(self.trace) < 1 if words else None
        answer = self.ask("status")
        return answer[0]["energised"] if answer else None

    def begun(self, place):
        if self.pair == "gateway" and place in LINES:
            answer = self.ask("read", "0x1017")
            return answer and answer[0]["value"] == 777
        return self.energised()


class Run:
    """What is attacked: one servoctl, or a client of a gateway; and the ends of its pipes and terminals."""

    def __init__(self, drive, place, output):
        self.drive, self.held, self.terminal, self.others = drive, [], None, []
        self.said, self.unread = tempfile.TemporaryFile(), None
        command = {"jog": ["jog", "60rpm", "--for", "20s", *drive.turn, "-y"], "enable": ["enable", "-y"],
                   "move": ["move", "20rev", "--relative", "--speed", "60rpm", *drive.turn, "-y"]}.get(place, [])
        if place in ("batch", "last line"):
            script = os.path.join(drive.folder, "batch")
            with open(script, "w") as file:
                file.write(drive.begin + (drive.lines * 40 + "wait 60s\n" if place == "batch" else drive.last))
            command = ["run", script, *rng.choice(FORMS)]
        if place == "last line of input":
            command = ["run", "-", *rng.choice(FORMS)]
        listen, env = os.path.join(drive.folder, f"gateway{number}"), {**drive.env, "SERVOCTL_BUS": drive.attacked}
        gateway = ["gateway", "--allow", "write", "--listen", listen, "-y"]
        if place in SERVED:
            command = gateway
        elif drive.pair == "gateway":
            self.others.append(subprocess.Popen([servoctl, *gateway], env=env, stdout=self.said, stderr=self.said))
            until(lambda: listens(listen), 20)
            env = {**env, "SERVOCTL_BUS": f"gateway:{listen}"}
        if output == "stalled trace":
            command = ["--trace", self.fifo(), *command]
        stdin, stdout = subprocess.DEVNULL, self.said
        if place == "prompt" or output == "held terminal":
            self.terminal, tty = pty.openpty()
            os.set_blocking(self.terminal, False)
            stdin = stdout = tty
            if place != "prompt":
                stdin = subprocess.DEVNULL
            self.held.append(tty)
        if output == "stalled pipe" and place != "prompt":
            reader, stdout = os.pipe()
            fcntl.fcntl(stdout, fcntl.F_SETPIPE_SZ, 4096)
            self.unread = reader
            self.held += [reader, stdout]
        if place in ("pipe", "last line of a pipe", "last line of input"):
            stdin = subprocess.PIPE
        self.process = subprocess.Popen([servoctl, *command], env=env, stdin=stdin, stdout=stdout, stderr=stdout,
                                        start_new_session=True)
        self.victim = drive.master = self.process
        if place in SERVED:
            until(lambda: listens(listen), 20)
            if output == "stalled pipe":  # A gateway does not fill it by itself.
                with open(f"/proc/self/fd/{stdout}", "wb", opener=lambda path, flags: os.open(path, flags | os.O_NONBLOCK)) as full:
                    full.raw.write(b" " * 4096)
            self.others.append(subprocess.Popen([sys.executable, "-c", CLIENT, listen, output], stderr=subprocess.DEVNULL))
        if place == "client":
            self.victim = self.others[-1]
        if place in ("pipe", "last line of a pipe", "last line of input"):
            self.process.stdin.write((drive.begin + (drive.last if place != "pipe" else "")).encode())
            self.process.stdin.flush()
        if place in ("last line of a pipe", "last line of input"):
            self.process.stdin.close()
        if place == "prompt":
            time.sleep(0.3)
            self.read()
            os.write(self.terminal, drive.begin.replace("\n", "\r").encode())

    def fifo(self):
        path = os.path.join(self.drive.folder, f"fifo{number}" + (".pcap" if self.drive.pair == "sv2" else ""))
        os.mkfifo(path)
        reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        fcntl.fcntl(reader, fcntl.F_SETPIPE_SZ, 4096)
        self.held.append(reader)
        return path

    def read(self):
        if self.terminal is None:
            return
        try:
            while os.read(self.terminal, 65536):
                pass
        except OSError:
            pass

    def ended(self, reads):
        if reads:
            self.read()
        return self.process.poll() is not None

    def text(self):
        """What it has printed, where that is a file or a pipe that nobody reads."""
        self.said.seek(0)
        unread = b""
        if self.unread is not None and select.select([self.unread], [], [], 0)[0]:
            unread = os.read(self.unread, 1 << 20)
        return (self.said.read() + unread).decode(errors="replace")

    def close(self):
        for process in self.others:
            process.kill()
            process.wait()
        for descriptor in self.held + ([self.terminal] if self.terminal is not None else []):
            os.close(descriptor)
        if self.process.stdin and not self.process.stdin.closed:
            self.process.stdin.close()
        self.said.close()


def listens(path):
    with socket.socket(socket.AF_UNIX) as client:
        return client.connect_ex(path) == 0


def attack(drive):
    pair = drive.pair
    place = rng.choice(PLACES.get(pair, [*MOTIONS, *LINES, "prompt"]))
    untraced = pair == "ts-modbus" or pair == "gateway" and place in LINES
    output = rng.choice(OUTPUTS[:-1] if untraced else OUTPUTS)
    names = rng.choices(SIGNALS, k=rng.choice([1, 2, 2])) if place != "client" else ["KILL"]
    gap, delay = rng.choice([0, 0.0001, 0.001, 0.005]), rng.uniform(0, 1)
    what = f"{number}: {pair}, {place}, {output}, {' '.join(names)} {gap * 1000:g} ms apart after {delay * 1000:.0f} ms"

    def fail(text):
        failures.append(f"{what}: {text}: {run.text()[-600:]}")

    run = Run(drive, place, output)
    reads = output != "held terminal"
    if place in MOTIONS:
        time.sleep(rng.uniform(0, 2.5))
    elif not until(lambda: drive.begun(place) or run.ended(False), 60) or run.ended(False):
        if pair == "sv2" or run.ended(False):  # Its cycles were late, or a question of begun() disturbed its own.
            run.process.kill()
            run.process.wait()
            run.close()
            drive.stop()
            drive.start()
            return False
        fail("the drive is not enabled, nothing was tried")
    if place == "prompt" and output == "held terminal":
        termios.tcflow(run.held[0], termios.TCOOFF)
        os.write(run.terminal, b"half a line")
    time.sleep(delay)
    for name in names:
        if run.victim.poll() is None:
            run.victim.send_signal(getattr(signal, "SIG" + name))
        time.sleep(gap)
    if place == "prompt" and set(names) <= INTERRUPTS:
        if until(lambda: run.ended(reads), 0.3):
            fail("an interrupt ended the prompt")
        run.process.send_signal(signal.SIGTERM)
    # Held back before a drive was energised, it stopped the process; it does not do so afterwards.
    time.sleep(0.1)
    if run.process.poll() is None:
        run.process.send_signal(signal.SIGCONT)
        if set(names) == {"TSTP"} and (place in MOTIONS or not drive.holds):
            run.process.send_signal(signal.SIGINT)
    killed = "KILL" in names and place != "client"
    stops = drive.holds or place in SERVED
    if killed:
        stops = pair == "sv2" or place in MOTIONS and pair in WATCHED
    # Who never reads holds the end back, but not the drive's.
    if stops and not until(lambda: drive.energised() is False, 15):
        fail(f"the drive is energised: {drive.ask('status')}")
    if place == "client":
        run.process.terminate()
    if place == "prompt" and output == "held terminal":
        termios.tcflow(run.held[0], termios.TCOON)
    if run.unread is not None:  # From now on somebody reads, and a document of 20 MB may wait.
        fcntl.fcntl(run.unread, fcntl.F_SETPIPE_SZ, 1 << 20)
    end = time.monotonic() + 15
    while run.process.poll() is None and time.monotonic() < end:
        run.read()
        run.text()
        time.sleep(0.01)
    if run.process.poll() is None:
        fail("it does not end")
        run.process.kill()
    code = run.process.wait()
    # Two of the keyboard end a process that holds no drive at once; its code is that of an interruption as well.
    # The cycles of the sv2 are late on a busy machine: then it ends as one that does not answer, or in fault.
    right = {130, 4, 1} if pair == "sv2" else {130}
    if not killed and (place in LINES and code not in right or place in MOTIONS and code == 0):
        fail(f"the exit code is {code}")
    # Nothing that servoctl does by itself stops such a motor: that is printed, if not a second signal ends it at once.
    if pair == "ts-modbus" and output == "read" and place in LINES and len(names) == 1 and not killed and "Fn_38=0" not in run.text():
        fail("what may be energised is not printed")
    if stops and drive.energised():
        fail("the drive is energised afterwards")
    if killed or not stops or drive.energised():
        for command in drive.off:
            if drive.ask(*command) is None:
                fail(f"'{' '.join(command)}' fails afterwards")
        if drive.energised() is not False:
            fail("the drive is not de-energised by the next servoctl")
    run.close()
    lost = drive.simulator.poll() is not None  # On a busy machine the simulator may not get the bus.
    # What was set is as the motion left it, or the watchdog of the sv2 has tripped on a busy machine: the drive starts anew.
    if killed or lost or pair == "sv2":
        drive.stop()
        drive.start()
    return not lost


with tempfile.TemporaryDirectory() as folder:
    done = 0
    drives = {}
    try:
        for number in range(count):
            pair = rng.choice(pairs)
            if pair not in drives:
                drives[pair] = Drive(pair, folder)
                drives[pair].start()
            before = len(failures)
            if attack(drives[pair]):
                done += 1
            else:
                del failures[before:]
    finally:
        for drive in drives.values():
            drive.stop()
if count - done > 1 + count // 4:
    failures.append(f"{count - done} were not tried: the program ended before the signals")
print(f"signals: {done} attacks, {len(failures)} failures (seed {seed})")
for failure in failures:
    print(failure)
sys.exit(1 if failures else 0)
