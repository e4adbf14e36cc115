#!/usr/bin/env python3
"""The program on buses behind adapters of the LAWICEL protocol: a simulated drive behind one, commands behind another, and
adapters as bad as real ones.
usage: slcan_test.py SERVOCTL"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time

from checks import check, finish, needs_serial_lines
from pty_terminal import Terminal
from pty_terminal import failures as prompt_failures
from serial_adapters import Adapter, Wire

servoctl = sys.argv[1]
needs_serial_lines(servoctl)
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env["LANG"] = "C"


def run(bus, *words):
    return subprocess.run([servoctl, "-b", bus, *words], env=env, capture_output=True, text=True, timeout=60)


class World:
    """A drive behind one adapter, and another adapter that is as told."""

    def __init__(self, rate="500k", spec="gsd600@1", **options):
        self.wire = Wire()
        self.adapter = Adapter(self.wire, **options)
        self.far = Adapter(self.wire)
        self.bus = f"slcan:{self.adapter.path}@500k"
        self.drive = subprocess.Popen([servoctl, "sim", spec, "-b", f"slcan:{self.far.path}@{rate}"], env=env,
                                      stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.drive.stdout.readline()  # `1 drive on …`

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.drive.terminate()
        self.drive.communicate()
        self.wire.close()


def answers(world, what):
    answer = run(world.bus, "read", "0x1000", "-n", "1", "--json")
    check(f"{what}: a drive answers\n{answer.stdout}{answer.stderr}", answer.returncode == 0 and "131474" in answer.stdout)
    return answer


def closes(adapter, what):
    for _ in range(100):
        if not adapter.is_open and adapter.heard[-1] == "C":
            return
        time.sleep(0.01)
    check(f"{what}: the adapter is closed at the end, {adapter.heard[-3:]}", False)


for name, options in {
        "a good adapter": {},
        "both line ends": {"end": "\r\n"},
        "lines in pieces": {"piece": 3},
        "time stamps": {"stamps": True},
        "firmware without acknowledges": {"silent": True, "version": "b158aa7 github.com/example"},
        "a late adapter": {"delay": 0.02},
        "an adapter without a version": {"refuses": "V"},
        "an adapter without flags": {"refuses": "F"}}.items():
    with World(**options) as world:
        answers(world, name)
        closes(world.adapter, name)

with World() as world:
    answer = run(world.bus, "scan", "--json")
    check(f"scan finds the drive\n{answer.stderr}", [n["node"] for n in json.loads(answer.stdout)["result"]] == [1])
    answer = run(world.bus, "jog", "60rpm", "--for", "200ms", "-n", "1", "-d", "gsd600", "--turn", "10000", "--yes")
    check(f"a jog goes through\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
    closes(world.adapter, "a jog")

    # The adapter is left open by a program that was killed.
    world.adapter.is_open, world.adapter.bitrate = True, 500
    for _ in range(200):
        world.adapter.say("t58184300100092010200")
    answers(world, "an adapter that was left open")

    # Ctrl-C and SIGTERM close it.
    for number in (signal.SIGINT, signal.SIGTERM):
        monitor = subprocess.Popen([servoctl, "-b", world.bus, "monitor"], env=env, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        for _ in range(200):
            if world.adapter.is_open:
                break
            time.sleep(0.02)
        answer = run(world.bus, "read", "0x1000", "-n", "1")
        check(f"a second program is told that the port is in use\n{answer.stderr}",
              answer.returncode == 3 and "is in use by another program" in answer.stderr)
        monitor.send_signal(number)
        monitor.wait(timeout=10)
        closes(world.adapter, f"signal {number}")

with World(loss=0.002, seed=7) as world:
    good = sum(run(world.bus, "read", "0x1000", "-n", "1").returncode == 0 for _ in range(20))
    check(f"bytes that are lost now and then cost little: {good} of 20", good >= 15)
    for _ in range(5):
        answer = run(world.bus, "write", "0x6083", "1234", "-n", "1", "-d", "gsd600")
        if answer.returncode == 0:
            check("what counts as written is written", "1234" in run(f"{world.bus}", "read", "0x6083", "-n", "1", "-d", "gsd600").stdout
                  or "1234" in run(world.bus, "read", "0x6083", "-n", "1", "-d", "gsd600").stdout)

# Unplugged in the middle of a motion, and plugged in again under the same name: the drive is stopped.
with World() as world, tempfile.TemporaryDirectory() as folder:
    name = os.path.join(folder, "adapter")
    os.symlink(world.adapter.path, name)
    jog = subprocess.Popen([servoctl, "-b", f"slcan:{name}@500k", "jog", "60rpm", "--for", "20s", "-n", "1", "-d", "gsd600",
                            "--turn", "10000", "--yes"], env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(300):
        if any(line.startswith("t6018") and "4060000F" in line for line in world.adapter.heard):
            break
        time.sleep(0.02)
    time.sleep(0.3)
    os.remove(name)
    world.adapter.unplug()
    world.wire.adapters.remove(world.adapter)
    time.sleep(1.0)
    world.adapter = Adapter(world.wire)
    os.symlink(world.adapter.path, name)
    out, err = jog.communicate(timeout=30)
    check(f"the loss is told and the drive stopped over the new port\n{out}{err}", "is gone" in err and "is back after" in err)
    check(f"the motion has failed\n{out}{err}", jog.returncode not in (0, 70))
    state = run(f"slcan:{world.adapter.path}@500k", "status", "-n", "1", "-d", "gsd600", "--json").stdout
    check(f"the drive is not energised\n{state}", json.loads(state)["result"][0]["energised"] is False)

# The adapter is gone when a batch file ends that has left the drive energised, and somebody presses Ctrl-C: it is waited for.
with World() as world, tempfile.TemporaryDirectory() as folder:
    name = os.path.join(folder, "adapter")
    os.symlink(world.adapter.path, name)
    with open(os.path.join(folder, "lines"), "w") as lines:
        lines.write("enable -n 1 --yes\nwait 20s\n")
    batch = subprocess.Popen([servoctl, "-b", f"slcan:{name}@500k", "-d", "gsd600", "run", lines.name], env=env,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(500):
        if any(line.startswith("t6018") and "4060000F" in line for line in world.adapter.heard):
            break
        time.sleep(0.02)
    time.sleep(0.5)
    os.remove(name)
    world.adapter.unplug()
    world.wire.adapters.remove(world.adapter)
    time.sleep(0.5)
    silent = Adapter(world.wire, silent=True, version="")  # Opening it takes its time, in which the signals come.
    os.symlink(silent.path, name)
    for _ in range(3):
        time.sleep(0.3)
        batch.send_signal(signal.SIGINT)
    time.sleep(0.3)
    os.remove(name)
    silent.unplug()
    world.wire.adapters.remove(silent)
    world.adapter = Adapter(world.wire)
    os.symlink(world.adapter.path, name)
    out, err = batch.communicate(timeout=40)
    state = run(f"slcan:{world.adapter.path}@500k", "status", "-n", "1", "-d", "gsd600", "--json").stdout
    check(f"a drive left energised is stopped though signals came\n{out}{err}{state}",
          json.loads(state)["result"][0]["energised"] is False and "disabled" in err)

# Unplugged while it is read, saved, restored, listened and looked: told once, and with an adapter of that name the next line works.
with World(spec="gsd600@1?delay=5ms") as world, tempfile.TemporaryDirectory() as folder:
    name = os.path.join(folder, "adapter")
    bus = f"slcan:{name}@500k"
    node = ("-n", "1", "-d", "gsd600")
    good, cut = os.path.join(folder, "good.json"), os.path.join(folder, "cut.json")
    lines = os.path.join(folder, "lines")
    with open(lines, "w") as file:
        file.write("read 0x1000\n" * 1000)

    def unplug():
        os.remove(name)
        world.adapter.unplug()
        world.wire.adapters.remove(world.adapter)

    def plug():
        world.adapter = Adapter(world.wire)
        os.symlink(world.adapter.path, name)

    os.symlink(world.adapter.path, name)
    answer = run(bus, "backup", good, *node)
    check(f"a backup in peace\n{answer.stderr}", answer.returncode == 0)
    run(bus, "param", "set", "Pn0214=45Hz", *node)
    for words in (["run", lines], ["backup", cut], ["restore", good, "--yes"], ["monitor", "--for", "2s"], ["watch", "0x6041", "--for", "2s"],
                  ["nmt", "watch", "--for", "2s"]):
        line = subprocess.Popen([servoctl, "-b", bus, *node, *words], env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True)
        time.sleep(0.8)
        check(f"{words} is under way", line.poll() is None)
        unplug()
        begun = time.monotonic()
        said = line.communicate(timeout=60)[1]
        check(f"unplugged in {words}: exit code {line.returncode}\n{said}", line.returncode == 3 and time.monotonic() - begun < (14 if words[0] == "backup" else 3))
        check(f"unplugged in {words}: told once\n{said}", 1 <= said.count("is gone") <= 2 and said.count("error:") == 1)
        check("half a backup is no file", not os.path.exists(cut))
        plug()
        answer = run(bus, "read", "0x1000", "-n", "1")
        check(f"plugged in behind {words}\n{answer.stderr}", answer.returncode == 0)
        if "--resume" in said:
            check("a restore goes on", run(bus, "restore", good, "--resume", "--yes", *node).returncode == 0)
    # The same at a prompt.
    terminal = Terminal(os.path.abspath(servoctl), "-b", bus, *node, state=folder, size=(40, 200))
    terminal.see(r"> ")
    terminal.type("read 0x1000\n")
    terminal.see(r"0x00020192[\s\S]*> ")
    unplug()
    terminal.see(r"is gone", seconds=3)
    time.sleep(1)
    terminal.read(0.2)
    check(f"a prompt tells it once {terminal.text!r}", "is gone" not in terminal.text)
    plug()
    terminal.type("read 0x1000\n")
    terminal.see(r"0x00020192[\s\S]*> ")
    terminal.type("watch 0x6041 --changes\n")
    time.sleep(1)
    terminal.text = ""
    unplug()
    terminal.see(r"is gone[\s\S]*waiting until it can", seconds=3)
    plug()
    terminal.see(r"can be used again after")
    terminal.type("\x03")
    terminal.see(r"> ")
    terminal.type("read 0x1000\n")
    terminal.see(r"0x00020192[\s\S]*> ")
    terminal.type("exit\n")
    terminal.exit_code()
    check(f"a prompt goes on when its adapter was unplugged: {prompt_failures}", not prompt_failures)

# The bitrate is found by listening: nothing is sent, and the adapter is closed afterwards.
def chatter(world, rate):
    """Somebody talks at `rate`; at another one an adapter that listens counts errors."""
    def talk():
        while not world.adapter.gone:
            if world.adapter.is_open and world.adapter.bitrate == rate:
                world.adapter.say("t701105")
            world.adapter.flags = "F00" if world.adapter.bitrate == rate else "F80"
            time.sleep(0.05)
    threading.Thread(target=talk, daemon=True).start()


with World(rate="250k") as world:
    port = world.bus.split("@")[0]
    chatter(world, 250)
    answer = subprocess.run([servoctl, "bus", "detect", port, "--for", "1500ms", "--json"], env=env, capture_output=True, text=True, timeout=60)
    result = json.loads(answer.stdout)
    heard = [(row["bitrate"], row["heard"]) for row in result["result"]["heard"]]
    check(f"bus detect finds 250k\n{answer.stdout}{answer.stderr}",
          answer.returncode == 0 and result["result"]["bitrate"] == 250000
          and heard == [(500000, "errors only"), (1000000, "errors only"), (250000, "frames")])
    check(f"it says how the bus is called\n{answer.stdout}", f"{port}@250k" in answer.stdout)
    closes(world.adapter, "bus detect")
    words = {word for word in world.adapter.heard if word[:1] not in "F"}
    check(f"it only listened: {words}", "O" not in words and "L" in words and not any(word[:1] in "tTrR" for word in words))
    answer = run(world.bus, "scan", "--all-bitrates", "--yes")
    check(f"where somebody talks nobody is asked\n{answer.stderr}", answer.returncode == 8 and "is in use" in answer.stderr)
    for number in (signal.SIGINT, signal.SIGTERM):
        search = subprocess.Popen([servoctl, "bus", "detect", port, "--bitrate", "500k", "--for", "30s"], env=env,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for _ in range(200):
            if world.adapter.is_open:
                break
            time.sleep(0.02)
        search.send_signal(number)
        search.wait(timeout=10)
        closes(world.adapter, f"bus detect and signal {number}")

# At the prompt the bus that has the adapter is closed for it, and opened again by the next line.
with World() as world, tempfile.TemporaryDirectory() as folder:
    port = world.bus.split("@")[0]
    with open(os.path.join(folder, "lines"), "w") as lines:
        lines.write(f"read 0x1000 -n 1\nbus detect {port} --bitrate 250k --bitrate 500k --for 2s --yes\nread 0x1000 -n 1\n")
    talker = threading.Event()
    def boot_up():
        while not talker.is_set():
            if world.adapter.listens_only and world.adapter.is_open and world.adapter.bitrate == 500:
                world.adapter.say("t701105")
            time.sleep(0.05)
    threading.Thread(target=boot_up, daemon=True).start()
    answer = run(world.bus, "run", lines.name)
    talker.set()
    check(f"bus detect between two reads\n{answer.stdout}{answer.stderr}",
          answer.returncode == 0 and answer.stdout.count("131474") == 2 and "500 kbit/s" in answer.stdout)
    with open(lines.name, "w") as lines:
        lines.write(f"enable -n 1 --yes\nbus detect {port} --bitrate 250k --for 300ms --yes\n")
    answer = run(world.bus, "-d", "gsd600", "run", lines.name)
    check(f"not while a drive is energised over it\n{answer.stdout}{answer.stderr}",
          answer.returncode == 8 and "energised over it" in answer.stderr)

with World(refuses="L") as world:
    answer = subprocess.run([servoctl, "bus", "detect", world.bus], env=env, capture_output=True, text=True, timeout=60)
    check(f"an adapter that cannot listen only is told\n{answer.stderr}",
          answer.returncode == 2 and "cannot listen without acknowledging" in answer.stderr)
    check(f"and was not opened: {world.adapter.heard}", "O" not in world.adapter.heard and not world.adapter.is_open)
with World(silent=True, version="b158aa7 github.com/example") as world:
    answer = subprocess.run([servoctl, "bus", "detect", world.bus], env=env, capture_output=True, text=True, timeout=60)
    check(f"firmware that answers to nothing as well\n{answer.stderr}", answer.returncode == 2 and "nobody knows" in answer.stderr)
    check(f"it was sent C and V: {world.adapter.heard}", set(world.adapter.heard) == {"C", "V"})

# Drives that say nothing are asked at each bitrate; the adapter is back at its own in the end.
with World(rate="125k") as world:
    answer = run(world.bus, "scan", "--all-bitrates", "--yes", "--json")
    check(f"scan --all-bitrates finds the drive\n{answer.stdout}{answer.stderr}",
          answer.returncode == 0 and [n["node"] for n in json.loads(answer.stdout)["result"]] == [1])
    check(f"it says how the bus is called from now on\n{answer.stdout}", f"-b slcan:{world.adapter.path}@125k" in answer.stdout)
    closes(world.adapter, "scan --all-bitrates")
    check(f"the adapter is at its own bitrate: {world.adapter.bitrate}", world.adapter.bitrate == 500)
    answer = run(f"slcan:{world.adapter.path}@125k", "read", "0x1000", "-n", "1")
    check(f"under that name the drive answers\n{answer.stderr}", answer.returncode == 0)
with World(rate="10k", refuses="") as world:
    world.drive.terminate()
    answer = run(world.bus, "scan", "--all-bitrates", "--yes")
    check(f"nobody at any bitrate\n{answer.stdout}{answer.stderr}", answer.returncode == 4 and "is at 500 kbit/s again" in answer.stderr)
    check(f"all nine were tried: {world.adapter.heard}", {f"S{n}" for n in range(9)} <= set(world.adapter.heard))
    closes(world.adapter, "scan of nobody")

# Elsewhere it is said why not, and what to do.
for words, text in (
        (["bus", "detect", "socketcand://192.168.7.2/can1"], "run servoctl there: `bus detect can1`"),
        (["scan", "--all-bitrates", "--yes", "-b", "socketcand://192.168.7.2/can1"], "run servoctl there: `scan --all-bitrates -b can1`"),
        (["bus", "detect", "gateway://192.168.7.2"], "is set where the gateway runs"),
        (["bus", "detect", "modbus:/dev/ttyUSB0@19200,8E1"], "silent until they are asked"),
        (["scan", "--all-bitrates", "--yes", "-b", "modbus://192.168.7.2"], "silent until they are asked"),
        (["bus", "detect", "coe:eth0"], "EtherCAT has one speed"),
        (["bus", "detect", "local:x"], "has no bitrate to find"),
        (["bus", "detect", "slcan:/dev/no-such-port"], "is the adapter plugged in?")):
    answer = subprocess.run([servoctl, *words], env=env, capture_output=True, text=True, timeout=30)
    check(f"{words}: {answer.returncode} {answer.stderr}", answer.returncode in (2, 3) and text in answer.stderr)

# An adapter that starts anew, or hangs, while it is only listened to.
for what, text in (("starts anew", "has started anew"), ("hangs", "does not answer any more")):
    with World() as world:
        monitor = subprocess.Popen([servoctl, "-b", world.bus, "monitor", "--for", "7s"], env=env, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        for _ in range(200):
            if world.adapter.is_open and "F" in world.adapter.heard:
                break
            time.sleep(0.02)
        time.sleep(1.2)
        begin = time.monotonic()
        if what == "hangs":
            world.adapter.silent, world.adapter.version, world.adapter.end = True, "", ""
        else:
            world.adapter.is_open = False
        out, err = monitor.communicate(timeout=30)
        took = time.monotonic() - begin
        # One that starts anew is opened again, and the monitor goes on.
        check(f"an adapter that {what} is told, after {took:.1f} s\n{out}{err}",
              monitor.returncode == (3 if what == "hangs" else 0) and text in out + err and took < 14)

# What it says of itself is in the picture of the doctor.
with World(flags="F21") as world:
    answer = run(world.bus, "doctor", "--json")
    codes = {finding["code"] for bus in json.loads(answer.stdout)["result"] for finding in [bus]}
    check(f"the doctor knows version and flags\n{answer.stdout}", {"adapter", "overrun", "error-passive"} <= codes and "V1013" in answer.stdout)

for bus, code, words in (
        ("slcan:/dev/null@500k", 3, "/dev/null is no serial port"),
        (f"slcan:{__file__}@500k", 3, "is no serial port"),
        ("slcan:/dev/ttyACM0@83k", 2, "'83k' is no bitrate that such an adapter has"),
        ("slcan:/dev/ttyACM0", 2, "the bitrate of the bus is missing"),
        ("slcan:/dev/no-such-port@500k", 3, "is the adapter plugged in?"),
        ("slcan:", 2, "the bitrate of the bus is missing")):
    answer = run(bus, "scan")
    check(f"{bus}: {answer.returncode} {answer.stderr}", answer.returncode == code and words in answer.stderr)
finish()
