#!/usr/bin/env python3
"""What a prompt remembers: where it was last time, what its last write replaced (undo), and what goes into a log.
usage: prompt_memory_test.py SERVOCTL"""
import datetime
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time

from pty_terminal import Terminal, expect, failures

servoctl = os.path.abspath(sys.argv[1])
cell = f"local:memory-{os.getpid()}"
other = f"local:memory-other-{os.getpid()}"
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
drives = [subprocess.Popen([servoctl, "sim", "gsd600@1,gsd600@2", "--bus", bus], env=env, stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL) for bus in (cell, other)]


def run(*words, bus=cell):
    return subprocess.run([servoctl, *words, "-b", bus, "-d", "gsd600"], env=env, capture_output=True, text=True)


def value(node=1):
    answer = run("param", "get", "Pn0214", "-n", str(node), "--json")
    return json.loads(answer.stdout)["result"][0]["raw"] if answer.returncode == 0 else None


def remembered(place, folder=None, time_then="2026-01-01T00:00:00Z"):
    """The document of one place, of this folder unless another is named."""
    place = {key: value for key, value in place.items() if value != ""}
    return json.dumps({"servoctl_prompt": 2, "places": [{"folder": folder or os.getcwd(), "time": time_then, **place}]})


def last_place(state):
    # Without a state there is nothing to say, and the prompt is nowhere.
    t = Terminal(servoctl, state=state)
    t.see(r"^`bus detect`[^\n]*\n`scan`[^\n]*\nwithout a drive:[^\n]*\n?servoctl> ")
    t.type(f"bus {cell}\n")
    t.see(r"servoctl local:\S+> ")
    t.type("use 2\n")
    t.see(r"node 2[^>]*> ")
    t.type("drive gsd600\n")
    t.see(r"gsd600[^>]*> ")
    t.type("exit\n")
    expect("exit code of the first prompt", 0, t.exit_code())
    t = Terminal(servoctl, state=state)
    t.see(r"notice: as last time \(\d{4}-[^)]*Z\): bus " + cell + r", node 2, family gsd600; `bus`, `use` and `drive` change it")
    t.see(r"servoctl " + cell + r" node 2 gsd600[^>]*> ")
    t.type("use 1\n")
    t.see(r"node 1 gsd600[^>]*> ")
    t.type("exit\n")
    expect("exit code of the second prompt", 0, t.exit_code())
    # What is named wins, whole.
    t = Terminal(servoctl, "-b", other, state=state)
    t.see(r"servoctl " + other + r"> ")
    if "as last time" in t.text:
        failures.append("last time was told although a bus was named")
    t.type("exit\n")
    expect("exit code with -b", 0, t.exit_code())
    # A bus that is not there any more, and one behind which another device may be.
    file = os.path.join(state, "servoctl", "prompt.json")
    for bus, told in (("can77", r"not as last time \(bus can77, node 1\): [^\n]*can77[^\n]*"), ("slcan:/dev/nowhere@500k", r"the first line that needs the bus opens it")):
        with open(file, "w", encoding="utf-8") as out:
            out.write(remembered({"bus": bus, "nodes": "1"}))
        t = Terminal(servoctl, state=state)
        t.see(told)
        t.see(r"servoctl[^>]*> ")
        t.type("\x04")
        expect(f"exit code after {bus}", 0, t.exit_code())
    # All nodes are none to begin with, and not those from before.
    t = Terminal(servoctl, "-b", cell, "-n", "2", "-d", "gsd600", state=state)
    t.see(r"node 2 gsd600[^>]*> ")
    t.type("use all\n")
    t.see(r"node all[^>]*> ")
    t.type("exit\n")
    expect("exit code behind `use all`", 0, t.exit_code())
    with open(file, encoding="utf-8") as written:
        expect("the nodes kept of `use all`", None, json.load(written)["places"][0]["nodes"])
    # What was remembered in another folder, or before folders were, is not taken here.
    for text in (remembered({"bus": cell, "nodes": "1"}, folder="/elsewhere"),
                 json.dumps({"servoctl_prompt": 1, "bus": cell, "nodes": "1", "time": "2026-01-01T00:00:00Z"})):
        with open(file, "w", encoding="utf-8") as out:
            out.write(text)
        t = Terminal(servoctl, state=state)
        t.see(r"^`bus detect`[^\n]*\n`scan`[^\n]*\nwithout a drive:[^\n]*\n?servoctl> ")
        t.type("\x04")
        expect("exit code in another folder", 0, t.exit_code())
    # A FIFO in its place, and in that of the history, is waited for neither at the beginning nor at the end.
    for name in (file, os.path.join(state, "servoctl", "history")):
        os.remove(name)
        os.mkfifo(name)
    began = time.monotonic()
    t = Terminal(servoctl, "--drive", "gsd600", state=state)
    t.see(r"servoctl gsd600> ")
    t.type(f"bus {cell}\n")
    t.see(r"servoctl local:\S+ gsd600> ")
    t.type("exit\n")
    expect("exit code beside a FIFO", 0, t.exit_code())
    t = Terminal(servoctl, state=state)
    t.see(r"notice: [^\n]*prompt\.json is no regular file[\s\S]*servoctl> ")
    t.type("exit\n")
    expect("exit code beside a FIFO without a place", 0, t.exit_code())
    if time.monotonic() - began > 15:
        failures.append("a FIFO was waited for")
    os.remove(file)
    with open(file, "w", encoding="utf-8") as out:
        out.write("{")
    t = Terminal(servoctl, state=state)
    t.see(r"notice: [^\n]*prompt\.json")
    t.see(r"servoctl> ")
    t.type("\x04")
    expect("exit code after a damaged file", 0, t.exit_code())


def last_place_in_chinese(state):
    """The notice at the start, and why the prompt is not where it was."""
    here = os.path.join(state, "chinese")
    os.mkdir(here)
    cabinet = os.path.join(os.path.realpath(here), "cabinet.toml")
    with open(cabinet, "w", encoding="utf-8") as out:
        out.write(f'[bus.main]\nurl = "{cell}"\n[axis.lift]\nbus = "main"\nnode = 1\nfamily = "gsd600"\n')
    adapter = "slcan:/dev/nowhere@500k"
    time_then = "2026-01-01T00:00:00Z"
    there = f"提示：沿用上次（{time_then}）的位置："
    changes = "；可用 `bus`、`use` 和 `drive` 改变"
    not_there = "提示：未沿用上次的位置"
    go_on = "；用 `bus` 和 `use` 指定去向"
    in_cabinet = {"bus": "main", "nodes": "lift", "drive": "", "cabinet": cabinet}
    file = os.path.join(state, "servoctl", "prompt.json")
    os.makedirs(os.path.dirname(file), exist_ok=True)
    at = os.getcwd()
    for folder, place, told, prompt in (
            (at, {"bus": cell, "nodes": "2", "drive": "gsd600"}, f"{there}总线 {cell}，节点 2，驱动器系列 gsd600{changes}", f"servoctl {cell} 节点 2 gsd600"),
            (at, {"bus": adapter, "nodes": "1"}, f"{there}总线 {adapter}，节点 1{changes}；第一条需要总线的行将打开它", f"servoctl {adapter} 节点 1"),
            (at, in_cabinet, f"{not_there}（lift，控制柜 {cabinet}）：此处没有使用控制柜文件{go_on}", "servoctl"),
            (here, in_cabinet, f"{there}lift，控制柜 {cabinet}{changes}", "servoctl main lift gsd600"),
            (here, {**in_cabinet, "cabinet": "/elsewhere/cabinet.toml"}, f"{not_there}（lift，控制柜 /elsewhere/cabinet.toml）：控制柜文件不是上次那个{go_on}", "servoctl"),
            (at, None, f"提示：{file}:1：不是 JSON，或不完整", "servoctl")):
        with open(file, "w", encoding="utf-8") as out:
            out.write(remembered(place, os.path.realpath(folder), time_then) if place else "{")
        os.chdir(folder)
        try:
            t = Terminal(servoctl, "--lang", "zh", state=state)
            t.see("^" + re.escape(told) + r"\r\n[^\n]*" + re.escape(prompt) + "> ")
            t.type("\x04")
            expect(f"exit code behind '{told}'", 0, t.exit_code())
        finally:
            os.chdir(at)


def place_in_a_cabinet(state):
    """Names of a cabinet file are taken where that file is in use, and nowhere else."""
    here = os.path.join(state, "here")
    elsewhere = os.path.join(state, "elsewhere")
    for folder, node in ((here, 1), (elsewhere, 2)):
        os.mkdir(folder)
        with open(os.path.join(folder, "cabinet.toml"), "w", encoding="utf-8") as out:
            out.write(f'[bus.main]\nurl = "{cell}"\n[axis.lift]\nbus = "main"\nnode = {node}\nfamily = "gsd600"\n')
    at = os.getcwd()
    try:
        os.chdir(here)
        t = Terminal(servoctl, state=state)
        t.see(r"servoctl> ")
        t.type("use lift\n")
        t.see(r"main lift gsd600[^>]*> ")
        t.type("exit\n")
        t.exit_code()
        t = Terminal(servoctl, state=state)
        t.see(r"as last time \([^)]*\): lift, cabinet [^\n]*here/cabinet.toml")
        t.see(r"main lift gsd600[^>]*> ")
        t.type("read 0x6061\n")
        t.see(r"lift +1 +0x6061[^>]*> ")
        t.type("bus main\n")
        t.see(r"lift gsd600[^>]*> ")
        t.type("exit\n")
        t.exit_code()
        t = Terminal(servoctl, state=state)
        t.see(r"as last time \([^)]*\): lift, cabinet")
        t.see(r"main lift gsd600[^>]*> ")
        t.type("exit\n")
        t.exit_code()
        file = os.path.join(state, "servoctl", "prompt.json")
        os.chdir(elsewhere)
        in_here = {"bus": "main", "nodes": "lift", "cabinet": os.path.realpath(os.path.join(here, "cabinet.toml"))}
        for place, why in ((in_here, "the cabinet file is another one"), ({"bus": cell, "nodes": "1"}, r"[^\n]*cabinet\.toml is in use here")):
            with open(file, "w", encoding="utf-8") as out:
                out.write(remembered(place))
            t = Terminal(servoctl, state=state)
            t.see(r"not as last time \([^)]*\): " + why)
            t.see(r"servoctl> ")
            t.type("exit\n")
            t.exit_code()
        # An interface that is gone is none of the cabinet's buses of that name.
        with open("cabinet.toml", "a", encoding="utf-8") as out:
            out.write(f'[bus.can77]\nurl = "{other}"\n')
        for place, why in (({"bus": "can77", "nodes": "1", "drive": "gsd600", "cabinet": None}, r"[^\n]*cabinet\.toml is in use here"),
                           ({"bus": cell, "nodes": "lift", "drive": "gsd600", "cabinet": None}, "the cabinet file is another one")):
            with open(file, "w", encoding="utf-8") as out:
                out.write(remembered(place))
            t = Terminal(servoctl, state=state)
            t.see(r"not as last time \([^)]*\): " + why)
            t.see(r"servoctl> ")
            t.type("\x04")
            t.exit_code()
        os.chdir(at)
        with open(file, "w", encoding="utf-8") as out:
            out.write(remembered(in_here))
        t = Terminal(servoctl, state=state)
        t.see(r"not as last time [^\n]*: no cabinet file is in use here")
        t.see(r"servoctl> ")
        t.type("exit\n")
        t.exit_code()
        t = Terminal(servoctl, "--cabinet", os.path.join(here, "cabinet.toml"), state=state)
        t.see(r"as last time \([^)]*\): lift, cabinet")
        t.see(r"main lift gsd600[^>]*> ")
        t.type("exit\n")
        t.exit_code()
    finally:
        os.chdir(at)


def undo(state):
    before = value()
    t = Terminal(servoctl, "-b", cell, "-n", "1", "-d", "gsd600", state=state)
    t.see(r"> ")
    t.type("undo\n")
    t.see(r"there is nothing to put back")
    t.type("param set Pn0214 400\n")
    t.see(r"read back[^>]*> ")
    t.type("undo\n")
    t.see(rf"Put back Pn0214 on node 1: {before} = \d+ Hz in place of 400 = 40 Hz\? \[y/N\] ")
    t.type("n\n")
    t.see(r"not confirmed; nothing was changed[^>]*> ")
    expect("the value after No", 400, value())
    t.type("undo\n")
    t.see(r"\[y/N\] ")
    t.type("y\n")
    t.see(r"read back[^>]*> ")
    expect("the value after undo", before, value())
    t.type("undo\n")
    t.see(r"This takes back the last `undo`\.\s+Put\s+back\s+Pn0214\s+on\s+node\s+1:\s+400\s+=\s+40\s+Hz\s+in\s+place\s+of[^?]*\?\s+\[y/N\] ")
    t.type("y\n")
    t.see(r"read back[^>]*> ")
    expect("the value after undo of undo", 400, value())
    t.type("write 607F 70000\n")
    t.see(r"written[^>]*> ")
    t.type("undo\n")
    t.see(r"Put\s+back\s+0x607F:0\s+Max\s+profile\s+velocity\s+on\s+node\s+1: [^?]*\?\s+\[y/N\] ")
    t.type("y\n")
    t.see(r"written[^>]*> ")
    t.type("param set Pn0214 420\n")
    t.see(r"read back[^>]*> ")
    # Somebody else has written meanwhile.
    expect("a write of another process", 0, run("param", "set", "Pn0214", "500", "-n", "1").returncode)
    t.type("undo --yes\n")
    t.see(r"no longer holds in Pn0214 [^\n]* what was written[^>]*> ")
    expect("the value of somebody else", 500, value())
    # The prompt is elsewhere.
    t.type("param set Pn0214 450\n")
    t.see(r"read back[^>]*> ")
    t.type("use 2\n")
    t.see(r"node 2[^>]*> ")
    t.type("undo --yes\n")
    t.see(r"made with 1 in use, and now 2 is[^>]*> ")
    t.type("use 1\n")
    t.see(r"node 1[^>]*> ")
    t.type(f"bus {other}\n")
    t.see(other + r" node 1[^>]*> ")
    t.type("undo --yes\n")
    t.see(r"the prompt is not there any more[^>]*> ")
    t.type(f"bus {cell}\n")
    t.see(cell + r" node 1[^>]*> ")
    t.type("undo -n 2\n")
    t.see(r"'undo' takes nothing but --yes[^>]*> ")
    # Back on that bus it is put back: no restart was missed that the value does not show.
    t.type("undo --yes\n")
    t.see(r"500 = 50 Hz +written, read back[^>]*> ")
    t.type("param set Pn0214 450\n")
    t.see(r"read back[^>]*> ")
    # The drive has restarted: what was not kept is gone, and it may be another one.
    t.type("nmt reset --wait --yes\n")
    t.see(r"reset +yes[^>]*> ")
    t.type("undo --yes\n")
    t.see(r"has restarted since it was written to[^>]*> ")
    # What is kept is kept again, and said before.
    t.type("param set Pn0214 410 --keep\n")
    t.see(r"read back +yes[^>]*> ")
    t.type("undo\n")
    t.see(r"Put back, and keep at power-off, Pn0214 on node 1: \d+ = [\d.]+ Hz in place of 410 = 41 Hz\? \[y/N\] ")
    t.type("y\n")
    t.see(r"read back +yes[^>]*> ")
    # What moves a motor is no setting, and hides what was written before it.
    t.type("write 0x607A 1000\n")
    t.see(r"written[^>]*> ")
    t.type("undo --yes\n")
    t.see(r"the last write is not put back: 0x607A on node 1: it drives the motor[^>]*> ")
    t.type("exit\n")
    expect("exit code of exit", 0, t.exit_code())
    for bus, node, family, line, question in (
            ("sim:ts@3", 3, "ts", "param set Fn_103 7", "Put back Fn_103 on node 3: 0 rpm in place of 7 rpm"),
            ("modbus:sim:ts@3", 3, "ts", "param set Fn_103 7", "nothing tells whether it is the same drive. Put back Fn_103")):
        answer = subprocess.run([servoctl, "-b", bus, "-n", str(node), "-d", family], env=env, input=f"{line}\nundo\nexit\n",
                                capture_output=True, text=True)
        if question not in answer.stderr:
            failures.append(f"a value whose type is learned on {bus}: {answer.stderr}")
    # From a pipe it is the same, and asks for --yes.
    lines = "param set Pn0214 410\nundo\n"
    answer = subprocess.run([servoctl, "-b", cell, "-n", "1", "-d", "gsd600"], env=env, input=lines, capture_output=True, text=True)
    expect("exit code of undo without --yes in a pipe", 8, answer.returncode)
    expect("the value then", 410, value())


def mistyped_bus(state):
    """Of a bus that cannot be opened nothing changes: SYNC goes on, and a drive stays enabled."""
    t = Terminal(servoctl, "-b", cell, "-n", "1", "-d", "gsd600", state=state)
    t.see(r"> ")
    t.type("sync start --period 10ms --yes\n")
    t.see(r"period \(ms\)[^>]*> ")
    t.type("enable --yes\n")
    t.see(r"ENERGISED while servoctl runs[^>]*> ")
    t.type("bus foo\n")
    t.see(r"error: [^\n]*foo[^>]*" + cell + r" node 1 gsd600 \[operation enabled\??\]> ")
    answer = run("status", "-n", "1", "--json")
    expect("energised behind a bus that is none", True, json.loads(answer.stdout)["result"][0]["energised"])
    t.type(f"bus {other}\n")
    t.see(r"node 1 was still energised; it has been stopped and disabled[\s\S]*SYNC is no longer produced[\s\S]*> ")
    t.type("exit\n")
    expect("exit code behind a bus that is none", 0, t.exit_code())


def words_of_the_prompt():
    answer = run("undo", "-n", "1")
    if "'undo' is a word of the prompt" not in answer.stderr or answer.returncode != 2:
        failures.append(f"undo as a command: {answer.returncode} {answer.stderr}")


def log(state):
    file = os.path.join(state, "the log")
    t = Terminal(servoctl, "-b", cell, "-n", "1", "-d", "gsd600", state=state)
    t.see(r"> ")
    t.type(f"log on '{file}'\n")
    t.see(r"all that is typed and answered goes into [^\n]*the log")
    t.type("param search --lang zh 速度环增益\n")
    t.see(r"Pn0214")
    t.type("nmt reset\n")
    t.see(r"\[y/N\] ")
    time.sleep(0.5)  # The question has the time when it was asked.
    t.type("n\n")
    t.see(r"not confirmed[^>]*> ")
    with open(file, encoding="utf-8") as written:  # While the prompt goes on.
        text = written.read()
    stamp = r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z"
    for wanted in (rf"^{stamp} > param search --lang zh 速度环增益$", rf"^{stamp}   Pn0214 +速度环增益 1", rf"^{stamp} > nmt reset$",
                   rf"^{stamp}   .*\[y/N\] $", rf"^{stamp} > n$", rf"^{stamp}   error: not confirmed; nothing was changed$"):
        if not re.search(wanted, text, re.MULTILINE):
            failures.append(f"the log has no {wanted!r}: {text!r}")
    times = [datetime.datetime.fromisoformat(found[1]) for found in re.finditer(r"^(\S+)Z (?:  .*\[y/N\] |> n)$", text, re.MULTILINE)]
    if len(times) != 2 or (times[1] - times[0]).total_seconds() < 0.4:
        failures.append(f"times of question and answer: {times}")
    t.type("log off\n")
    t.see(r"went into [^>]*> ")
    t.type("read statusword\n")
    t.see(r"0x6041[^>]*> ")
    with open(file, encoding="utf-8") as written:
        if "statusword" in written.read():
            failures.append("a line after `log off` is in the log")
    for wrong in ("log on /dev/null", "log on /proc/nowhere/log", "log sideways"):
        t.type(wrong + "\n")
        t.see(r"error: [^>]*> ")
    t.type("exit\n")
    expect("exit code of exit", 0, t.exit_code())


def full_disk(state):
    # A limit of the size stands for a full disk: the line is carried out, and told.
    t = Terminal(servoctl, "-b", cell, "-n", "1", "-d", "gsd600", state=state)
    t.see(r"> ")
    resource.prlimit(t.pid, resource.RLIMIT_FSIZE, (200, 200))
    t.type(f"log on {os.path.join(state, 'full')}\n")
    t.see(r"goes into")
    t.type("param set Pn0214 420\n")
    t.see(r"notice: [^\n]*full: [^\n]*the log has ended here; make room")
    t.see(r"read back|> ")
    expect("the value written beside a full disk", 420, value())
    t.type("log\n")
    t.see(r"there is no log")
    t.type("exit\n")
    t.exit_code()


try:
    for _ in range(200):
        if value() is not None and run("read", "0x1000", "-n", "2", bus=other).returncode == 0:
            break
        time.sleep(0.05)
    words_of_the_prompt()
    for part in (last_place, last_place_in_chinese, place_in_a_cabinet, undo, mistyped_bus, log, full_disk):
        with tempfile.TemporaryDirectory() as folder:
            part(folder)
finally:
    for drive in drives:
        drive.terminate()
        drive.wait()

for failure in failures:
    print("FAILED", failure)
print(f"{len(failures)} failed")
sys.exit(1 if failures else 0)
