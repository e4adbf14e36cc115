#!/usr/bin/env python3
"""On a terminal every command that takes over half a second says how far it is, or how long it has been going on, and leaves
nothing of that behind; in a pipe and with -q there is none. Each command stands here with a line, or with why it has none.
usage: bars_test.py SERVOCTL"""
import concurrent.futures
import os
import pty
import re
import select
import shlex
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time
import fcntl

import checks
from checks import check
from terminal_screen import Screen

servoctl = os.path.abspath(sys.argv[1])
BAR, ELAPSED, LATEST = r"\[#*\.*\] +\d+%", r"\d s so far(?!, )", r"\d s so far, \d+ (s|min) at most"
ANY = "|".join((BAR, ELAPSED, LATEST))
LEFT = BAR + r", \d+ (s|min) left"
COUNTED = BAR + r" \(\d+/\d+\), \d+ (s|min) left"
# A node that does not answer is waited for.
SILENT = " -b sim:gsd600@1 -n 9 -d gsd600 --timeout 900ms"
THERE = " -b sim:gsd600@1 -n 1 -d gsd600"
TURN = THERE + " --turn 131072"
# Many answers of a drive that takes its time.
SLOW = " -b sim:gsd600@1?delay=5ms -n 1 -d gsd600"
QUICK = "reads data or files of this machine, and is done in less"
KERNEL = "needs an interface of the kernel, which a machine need not have"
RING = "a slave follows in a few cycles, and one that does not is given up soon"
UNTIL_ENDED = "goes on until Ctrl-C and says so"

LINES = {
    "scan": ("scan -b sim:gsd600@1 --timeout 900ms", ELAPSED),
    "doctor": ("doctor -b sim:gsd600@1", LEFT),
    "info": ("info" + SILENT, ELAPSED),
    "status": ("status" + SILENT, ELAPSED),
    "read": ("read 0x60*" + SLOW.replace("5ms", "30ms"), COUNTED),
    "write": ("write 0x607A 1" + SILENT, ELAPSED),
    "param get": ("param get 'Pn*'" + SLOW, COUNTED),
    "param set": ("param set Pn0214 45Hz" + SILENT, ELAPSED),
    "backup": ("backup late.json" + SLOW, COUNTED),
    "cabinet init": ("cabinet init new.toml -b sim:gsd600@1 --timeout 900ms", ELAPSED),
    "cabinet show": ("cabinet show --cabinet away.toml --timeout 900ms", ANY),
    "cabinet plan": ("cabinet plan --cabinet away.toml --timeout 900ms", ANY),
    "cabinet apply": ("cabinet apply --cabinet away.toml --timeout 900ms", ANY),
    "cabinet backup": ("cabinet backup --cabinet away.toml --timeout 900ms", ANY),
    "cabinet swap": ("cabinet swap lift --from 7 --cabinet away.toml --timeout 900ms", ANY),
    "diff": ("diff factory node:9" + SILENT.replace("-n 9", ""), ELAPSED),
    "verify": ("verify factory" + SLOW, COUNTED),
    "restore": ("restore good.json" + SLOW, COUNTED),
    "clone": ("clone --from 9 --to 1 -d gsd600 -b sim:gsd600@1 --timeout 900ms", ELAPSED),
    "address": ("address 5 --wait 3s -n 1 -d da200 -b sim:da200@1", LATEST),
    "lss scan": ("lss scan -b sim:sv2@255,da200@255,gsd600@1?lss", r"\r\x1b\[K(?!\d).{10,}\r"),
    "lss inquire": ("lss inquire --only -b sim:gsd600@1 --timeout 900ms", ELAPSED),
    "lss select": ("lss select --only -b sim:gsd600@1 --timeout 900ms", ELAPSED),
    "lss set-node": ("lss set-node 5 --only -b sim:gsd600@1 --timeout 900ms", ELAPSED),
    "lss set-bitrate": ("lss set-bitrate 500k --only -b sim:gsd600@1 --timeout 900ms", ELAPSED),
    "lss store": ("lss store --only -b sim:gsd600@1 --timeout 900ms", ELAPSED),
    "store": ("store" + SILENT, ELAPSED),
    "defaults": ("defaults" + SILENT, ELAPSED),
    "fault show": ("fault show" + SILENT, ELAPSED),
    "fault reset": ("fault reset" + SILENT, ELAPSED),
    "fault clear-history": ("fault clear-history" + SILENT, ELAPSED),
    "enable": ("enable" + SILENT, ELAPSED),
    "disable": ("disable" + SILENT, ELAPSED),
    "quick-stop": ("quick-stop" + SILENT, ELAPSED),
    "stop": ("stop" + SILENT, ELAPSED),
    "mode": ("mode" + SILENT, ELAPSED),
    "jog": ("jog 60rpm --for 2s" + TURN, LEFT),
    "move": ("move 2rev --relative --speed 60rpm" + TURN, LEFT),
    "home": ("home 17 --window 5rev --limit 900rpm --panel PA-20=0,PA-74=1 -n 1 -d sv2 -b sim:sv2@1?panel=PA-20=0,PA-74=1", LATEST),
    "torque": ("torque 5% --for 2s --limit 60rpm -n 1 -d sv2 -b sim:sv2@1", LEFT),
    "units show": ("units show" + SILENT, ELAPSED),
    "units learn": ("units learn" + THERE, LEFT),
    "units forget": ("units forget" + SILENT, ELAPSED),
    "heartbeat set": ("heartbeat set 100ms" + SILENT, ELAPSED),
    "heartbeat consume": ("heartbeat consume 10=500ms -b sim:ts@1 -n 9 -d ts --timeout 900ms", ELAPSED),
    "heartbeat show": ("heartbeat show" + SILENT, ANY),
    "watchdog": ("watchdog" + SILENT, ELAPSED),
    "nmt start": ("nmt start --wait -b sim:gsd600@1 -n 9 --timeout 900ms", ANY),
    "nmt stop": ("nmt stop --wait -b sim:gsd600@1 -n 9 --timeout 900ms", ANY),
    "nmt preop": ("nmt preop --wait -b sim:gsd600@1 -n 9 --timeout 900ms", ANY),
    "nmt reset": ("nmt reset --wait -b sim:gsd600@1 -n 9", LATEST),
    "nmt reset-comm": ("nmt reset-comm --wait -b sim:gsd600@1 -n 9", LATEST),
    "pdo show": ("pdo show" + SILENT, ELAPSED),
    "pdo map": ("pdo map TPDO2 0x6064" + SILENT, ELAPSED),
    "pdo enable": ("pdo enable TPDO1" + SILENT, ELAPSED),
    "pdo disable": ("pdo disable TPDO1" + SILENT, ELAPSED),
    "pdo clear": ("pdo clear TPDO4" + SILENT, ELAPSED),
    "pdo preset": ("pdo preset pv" + SILENT, ELAPSED),
    "pdo apply": ("pdo apply pdos.toml" + SILENT, ELAPSED),
    "pdo save": ("pdo save late.toml" + SILENT, ELAPSED),
    "witness": ("witness late.json" + SILENT, ELAPSED),
    "pdo watch": ("pdo watch --for 2s -o jsonl" + THERE, LEFT),
    "pdo send": ("pdo send RPDO1 0x06" + SILENT, ELAPSED),
    "test comm": ("test comm --count 80 --longest 10s -b sim:gsd600@1?delay=20ms -n 1 -d gsd600", LEFT),
    "eds verify": ("eds verify many.eds" + SLOW, BAR),
    "eds learn": ("eds learn -o learned.eds --range 4000-4180" + SLOW, BAR),
    "test io": ("test io --for 2s" + THERE, LATEST),
    "test jog": ("test jog 60rpm --limit 600rpm" + TURN, BAR),
    "test home": ("test home 17 --spread 5 --limit 900rpm --window 5rev --panel PA-20=0,PA-74=1 -n 1 -d sv2 -b sim:sv2@1?panel=PA-20=0,PA-74=1", LATEST),
    "test all": ("test all 60rpm --no-home --limit 600rpm --window 5rev" + TURN, BAR),
    "report": ("report late.html" + SLOW, COUNTED),
    "sync start": ("sync start --period 10ms --for 2s -b sim:gsd600@1", LEFT),
    "watch": ("watch 0x6041 --for 2s -o jsonl" + THERE, LEFT),
    "scope": ("scope 0x6064 --for 2s" + THERE, LEFT),
    "monitor": ("monitor --for 2s -b sim:gsd600@1", LEFT),
    "nmt watch": ("nmt watch --for 2s -o jsonl -b sim:gsd600@1 -n 1", LEFT),
    "replay": ("replay slow.log -b sim:gsd600@1", BAR),
    "run": ("run slow.servoctl -b sim:gsd600@1", LEFT),
}
REASONS = {
    "bus status": KERNEL, "bus up": KERNEL, "bus down": KERNEL, "bus detect": KERNEL,
    "explain": QUICK, "objects": QUICK, "param list": QUICK, "param search": QUICK, "param explain": QUICK,
    "cabinet check": QUICK, "cabinet diff": QUICK, "fault list": QUICK, "decode": QUICK, "drives": QUICK, "help": QUICK,
    "drives check": QUICK, "drives new": QUICK, "man": QUICK, "completion": QUICK, "eds check": QUICK,
    "state init": RING, "state preop": RING, "state safeop": UNTIL_ENDED, "state op": UNTIL_ENDED,
    "sync once": "one frame", "sync stop": "waits for nobody", "sim": UNTIL_ENDED, "gateway": UNTIL_ENDED,
}
FILES = {
    "away.toml": '[bus.main]\nurl = "sim:gsd600@1"\n[axis.lift]\nbus = "main"\nnode = 9\nfamily = "gsd600"\n'
                 '[axis.lift.parameters]\nPn0214 = "45Hz"\n',
    "slow.log": "(0.000000) can0 080#\n(0.700000) can0 080#\n(1.800000) can0 080#\n",
    "slow.servoctl": "wait 2s\n",
    "many.eds": "".join(f"[{index:X}]\nParameterName=own {index:X}\nObjectType=0x7\nDataType=0x5\nAccessType=ro\nPDOMapping=0\n"
                        for index in range(0x4000, 0x4180)),
}
MADE = ("backup good.json -n 1 -d gsd600 -b sim:gsd600@1", "pdo save pdos.toml -n 1 -d gsd600 -b sim:gsd600@1")


def environment():
    env = {k: v for k, v in os.environ.items() if not k.startswith(("SERVOCTL_", "XDG_", "LC_"))}
    env.update(LANG="C.UTF-8", HOME=folder, XDG_STATE_HOME=folder, TERM="xterm", NO_COLOR="1")
    return env


def on_terminal(line, typed=(), **more):
    """All that the program wrote to a terminal of 80x24, and how long it took."""
    pid, master = pty.fork()
    if pid == 0:
        os.chdir(folder)
        fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        os.execve(servoctl, [servoctl, *shlex.split(line)], {**environment(), **more})
    data, begin, typed = b"", time.monotonic(), list(typed)
    while time.monotonic() < begin + 60:
        ready, _, _ = select.select([master], [], [], 0.2)
        try:
            data += os.read(master, 65536) if ready else b""
        except OSError:
            break
        if typed and typed[0][0] in data.decode(errors="replace"):
            time.sleep(typed[0][2])
            os.write(master, typed.pop(0)[1])
    else:
        os.kill(pid, signal.SIGKILL)
    _, status = os.waitpid(pid, 0)
    os.close(master)
    return data.decode(errors="replace"), time.monotonic() - begin, os.waitstatus_to_exitcode(status)


def left_on_screen(text):
    screen = Screen()
    screen.take(re.sub(r"\x1b\[\?1049[hl]|\x1b\[H", "", text).encode())
    return [row for row in ("".join(cell[0] for cell in row) for row in screen.rows) if re.search(ANY, row)]


def walk(entry):
    name, (line, pattern) = entry
    text, took, _ = on_terminal(line + " --yes --no-pager")
    found = re.search(pattern, text)
    return name, found is not None, left_on_screen(text), f"({took:.1f} s) {text[-600:]!r}"


def commands():
    listing = subprocess.run([servoctl, "help"], env=environment(), capture_output=True, text=True, check=True).stdout
    block = listing.split("Commands:\n")[1].split("\n\n")[0]
    return [re.match(r"  (\S+(?: \S+)*?) {2,}", each).group(1) for each in block.splitlines() if re.match(r"  \S", each)]


def walk_all():
    names = commands()
    check(f"each command stands once: {set(names) ^ (set(LINES) | set(REASONS))}, {set(LINES) & set(REASONS)}",
          set(names) == set(LINES) | set(REASONS) and not set(LINES) & set(REASONS) and len(names) > 90)
    with concurrent.futures.ThreadPoolExecutor(6) as pool:
        for name, found, left, text in pool.map(walk, LINES.items()):
            check(f"`{name}` says how far it is: {text}", found)
            check(f"`{name}` leaves nothing of it: {left}", not left)


def quiet_ones():
    line = "read 0x6041" + SILENT
    text, _, _ = on_terminal(line + " -q")
    check(f"nothing of it with -q: {text!r}", not re.search(ANY, text))
    done = subprocess.run([servoctl, *shlex.split(line)], env=environment(), capture_output=True, text=True)
    check(f"nothing of it in a pipe: {done.stderr!r}", "\r" not in done.stderr and not re.search(ANY, done.stderr))
    text, _, _ = on_terminal(line, LANG="zh_CN.UTF-8")
    check(f"in Chinese: {text!r}", re.search(r"已用 1\.\d s", text))
    text, _, _ = on_terminal("doctor -b sim:gsd600@1 --for 3s", LANG="C")
    check(f"in ASCII: {text!r}", re.search(LEFT, text) and text.isascii())


def a_question():
    """Nobody is asked under a bar: while the answer is awaited there is none, and the question stands whole."""
    text, _, _ = on_terminal("jog 60rpm --for 1s" + TURN, [("[y/N]", b"y\n", 1.5)])
    asked = text.split("[y/N]")[1].split("y\r\n")[0]
    check(f"none while a question waits: {asked!r}", not re.search(ANY, asked))
    check(f"and then the bar of the motion: {text!r}", re.search(BAR, text))
    before = re.split(r"\x1b\[K|\n(?! )", text.split("[y/N]")[0])[-1]
    check(f"the question begins its line: {before!r}", before.startswith("The motor of node 1 will move"))


with tempfile.TemporaryDirectory() as folder:
    for title, content in FILES.items():
        with open(os.path.join(folder, title), "w", encoding="utf-8") as out:
            out.write(content)
    for made in MADE:
        subprocess.run([servoctl, *shlex.split(made)], env=environment(), cwd=folder, capture_output=True, check=True)
    walk_all()
    quiet_ones()
    a_question()
checks.finish()
