#!/usr/bin/env python3
"""-v tells on stderr the bus, the cabinet file, the family and why, each transfer with time, value and bytes or what went wrong, and
each command for the state of a node, on every bus; results stay as they are, and without it nothing is told.
usage: verbose_test.py SERVOCTL"""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import pty_terminal
from checks import check, finish
from pty_terminal import Terminal

servoctl = os.path.abspath(sys.argv[1])
home = tempfile.mkdtemp()
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env.update(LANG="C.UTF-8", XDG_STATE_HOME=os.path.join(home, "state"), HOME=home)
BUSES = (("sim:gsd600@1", "gsd600", "CAN"), ("coe:sim:sv2@1", "sv2", "CANopen over EtherCAT"), ("modbus:sim:ts@1", "ts", "Modbus"))
CLOSING = r"^detail: sent to node \d: the request for (SAFE-)?OP$[\s\S]*^detail: sent to node \d: the request for PRE-OP$"
CAN = ("-b", "sim:gsd600@1", "-n")
CABINET = ('[bus.main]\nurl = "sim:gsd600@1,gsd600@2"\n[bus.ring]\nurl = "coe:sim:sv2@1"\n'
           '[axis.lift]\nbus = "main"\nnode = 1\nfamily = "gsd600"\n[axis.feed]\nbus = "ring"\nnode = 1\nfamily = "sv2"\n')


def run(*words, given=None, folder=home, **more):
    done = subprocess.run([servoctl, *words], env={**env, **more}, capture_output=True, text=True, input=given, cwd=folder)
    return done.stdout, done.stderr, done.returncode


def is_told(what, pattern, text):
    check(f"{what}: {pattern} in {text}", re.search(pattern, text, re.M))


def on_a_bus(bus, family, kind, words=("status",)):
    told = run(*words, "-b", bus, "-n", "1", "-d", family, "-v")[1]
    is_told(bus, rf"^detail: bus {re.escape(bus)} is open \({kind}\); longest wait for an answer: 500 ms, retries of a read: 1$", told)
    is_told(bus, rf"^detail: family {family}: named by --drive; objects from .*{family}", told)
    is_told(bus, r"^detail: node 1, object 0x[0-9A-F]{4}:[0-9A-F]+h? \(.+\): read in \d+\.\d ms: .+ \(bytes: [0-9A-F]{2}", told)


def what_is_read_and_written():
    out, told, code = run("read", "0x1001", *CAN, "1", "-v")
    plain = run("read", "0x1001", *CAN, "1")
    check("the result is the same", (out, code) == (plain[0], plain[2]))
    check("without -v nothing is told", plain[1] == "")
    check("each transfer is told once", told.count("object 0x1001:0: read in") == 1)
    is_told("a name and a value", r"^detail: node 1, object 0x6041:0 \(Statusword\): read in \d+\.\d ms: 0x0270 switch on disabled \(voltage enabled, remote\) \(bytes: 70 02\)$",
            run("read", "statusword", *CAN, "1", "-d", "gsd600", "-v")[1])
    is_told("a label", r"\(Modes of operation display\): read in .* ms: 1 Profile position \(pp\) \(bytes: 01\)$",
            run("read", "0x6061", *CAN, "1", "-d", "gsd600", "-v")[1])
    is_told("an abort", r"^detail: node 1, object 0x5999:0: read failed after .* ms, tries: 1: refused: .*0x06020000",
            run("read", "0x5999", *CAN, "1", "-v")[1])
    told = run("read", "0x1000", *CAN, "9", "-v", "--timeout", "20ms", "--retries", "2")[1]
    is_told("retries", r"^detail: node 9, object 0x1000:0: read failed after [6-9]\d\.\d ms, tries: 3: no answer within 20 ms$", told)
    is_told("the wait", "longest wait for an answer: 20 ms, retries of a read: 2", told)
    is_told("a write", r"^detail: node 1, object 0x1017:0: written in .* ms: 500 \(bytes: F4 01\)$",
            run("write", "0x1017", "500", "--type", "u16", *CAN, "1", "-v")[1])
    is_told("a refused write", r"^detail: node 1, object 0x1000:0: write of 1 \(bytes: 01 00 00 00\) failed after .* ms: refused: ",
            run("write", "0x1000", "1", "--type", "u32", *CAN, "1", "-v")[1])
    told = run("jog", "60rpm", "--for", "100ms", "-d", "gsd600", "--turn", "131072", "-y", *CAN, "1", "-v")[1]
    is_told("the way out of a motion", r"^detail: node 1, object 0x6040:0 \(Controlword\): written in .* ms: 0x0007 switch on \(bytes: 07 00\)$", told)
    check("nothing is written in a dry run", "written in" not in
          run("write", "0x1017", "500", "--type", "u16", *CAN, "1", "-v", "--dry-run")[1])


def what_is_sent_and_decided():
    is_told("NMT", r'^detail: sent to node 1: NMT "preop"$', run("nmt", "preop", *CAN, "1", "-v")[1])
    is_told("NMT of all", r'^detail: sent to all nodes: NMT "stop"$', run("nmt", "stop", "-y", *CAN, "all", "-v")[1])
    is_told("AL state", r"^detail: sent to node 1: the request for PRE-OP$", run("status", "-b", "coe:sim:sv2@1", "-n", "1", "-v")[1])
    state = {"XDG_STATE_HOME": os.path.join(home, "other")}
    is_told("a guess", r"^detail: family gsd600: the identity of the drive fits it, a guess; ",
            run("read", "statusword", *CAN, "1", "-v", **state)[1])
    run("status", *CAN, "1", "-d", "gsd600", **state)
    is_told("what was said before", r"^detail: family gsd600: as it was said of this drive before; ",
            run("read", "statusword", *CAN, "1", "-v", **state)[1])
    is_told("the environment", r"^detail: family gsd600: named by \$SERVOCTL_DRIVE; ",
            run("read", "statusword", *CAN, "1", "-v", SERVOCTL_DRIVE="gsd600")[1])
    is_told("the recording", r"^detail: every frame is written to t\.log$", run("read", "0x1000", *CAN, "1", "-v", "--trace", "t.log")[1])


def with_a_slave_in_op():
    """Closing the bus sends orders, which are told: everybody who tells them has to be there still."""
    ring = ("-b", "coe:sim:sv2@1,sv2@2", "-d", "sv2", "-v")
    for lines in ("state op -n 1", "state op -n 1,2\nstatus -n 1", "state safeop -n 2", "enable -n 1 -y", "state op -n 1\nread 0x5999 -n 1"):
        done = run(*ring, given=lines + "\n")
        check(f"'{lines}' ends well ({done[2]}): {done[1]}", done[2] == (5 if "0x5999" in lines else 0))
        is_told("the order of closing", CLOSING, done[1])
    with open(os.path.join(home, "ring"), "w", encoding="utf-8") as file:
        file.write("state op -n 1\nread 0x6041 -n 1\n")
    check("a file", run("run", "ring", *ring)[2] == 0)
    check("with a trace", run("run", "ring", *ring, "--trace", "ring.pcap")[2] == 0)
    os.symlink("/dev/full", os.path.join(home, "full.pcap"))
    check("with a trace that fails", run(*ring, "--trace", "full.pcap", given="state op -n 1\n")[2] == 7)
    for line in (("state", "op", "-n", "1"), ("enable", "-n", "1", "-y")):
        held = subprocess.Popen([servoctl, *line, *ring], env=env, cwd=home, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        told = ""
        for text in held.stderr:
            told += text
            if "Ctrl-C ends it" in text:
                held.send_signal(signal.SIGINT)
        check(f"{line} is held and ended: {told}", held.wait(60) == 0)
        is_told(f"{line}: the order of closing", CLOSING, told)


def of_axes():
    with open(os.path.join(home, "cabinet.toml"), "w", encoding="utf-8") as file:
        file.write(CABINET)
    out, told, code = run("status", "-n", "all", "--cabinet", "cabinet.toml", "-v")
    check(f"it is answered ({code})", code == 0 and "detail" not in out)
    is_told("the file, once", r"^detail: cabinet file .*cabinet\.toml, named by --cabinet, axes: 2$", told)
    check(f"the file is told once: {told}", told.count("detail: cabinet file") == 1)
    is_told("the family of an axis", r"^detail: family sv2: that of the axis in the cabinet file; ", told)
    is_told("axes by name", r"^detail: lift, object 0x6041:0 \(Statusword\): read in ", told)
    is_told("axes by name", r"^detail: feed, object 0x6041:0 \(Statusword\): read in ", told)
    os.remove(os.path.join(home, "cabinet.toml"))


def in_other_forms():
    out, told, _ = run("read", "0x1018:1", *CAN, "1", "-v", "--json")
    check("JSON stays JSON", json.loads(out)["ok"] and "detail" not in out and "detail: " in told)
    told = run("read", "statusword", *CAN, "1", "-d", "gsd600", "-v", "--lang", "zh")[1]
    is_told("Chinese", r"^详情：总线 sim:gsd600@1 已打开（CAN）；等待应答最长 500 ms", told)
    is_told("Chinese", r"^详情：节点 1，对象 0x6041:0（状态字.*）：读取用时 \d+\.\d ms：0x0270 伺服无故障（.*）（字节：70 02）$", told)
    check(f"nothing of it is English: {told}", not re.search(r"^详情：.*(?<!-)\b(read|object|family|bus|bytes)\b", told, re.M))
    told = run("read", "0x5999", *CAN, "1", "-v", "--lang", "zh")[1]
    is_told("an abort in Chinese", r"^详情：节点 1，对象 0x5999:0：读取失败，历时 .* ms，尝试次数 1：[^a-z]*（中止码 0x06020000）", told)


def with_quiet():
    out, told, code = run("read", "0x1000", *CAN, "1", "-q", "-v")
    check(f"-q and -v are refused ({code}): {told}", code == 2 and "contradict" in told and out == "")
    lines = "read 0x1001\nread 0x1017 -v\nread 0x1018:3\n"
    told = run(*CAN, "1", "-q", given=lines)[1]
    check(f"-v of a line holds for that line: {told}",
          "0x1017" in told and "0x1001" not in told and "0x1018:3" not in told)
    told = run(*CAN, "1", "-v", given="read 0x1001\nread 0x1017 -q\nread 0x1018:3\n")[1]
    check(f"-q of a line holds for that line: {told}",
          "0x1017" not in told and "0x1001" in told and "0x1018:3" in told)
    with open(os.path.join(home, "lines"), "w", encoding="utf-8") as file:
        file.write("read 0x1001\nread 0x1017\n")
    told = run("run", "lines", "-v", *CAN, "1")[1]
    check(f"-v of `run` holds for its lines: {told}", "0x1001:0: read in" in told and "0x1017:0: read in" in told)


def at_the_prompt():
    before = dict(os.environ)
    os.environ.update(env)
    terminal = Terminal(servoctl, "-b", "sim:gsd600@1", "-n", "1", state=os.path.join(home, "prompt"))
    os.environ.clear()
    os.environ.update(before)
    terminal.see("> ")
    terminal.type("read 0x1018:1 -v\r")
    terminal.see(r"detail: node 1, object 0x1018:1: read in")
    terminal.see("> ")
    terminal.type("read 0x1018:2\r")
    terminal.see(r"0x1018:2((?!detail)[\s\S])*0x00000000")
    terminal.see("> ")
    terminal.type("exit\r")
    check("the prompt ends well", terminal.exit_code() == 0)


def over_a_gateway():
    socket = os.path.join(home, "gateway")
    gateway = subprocess.Popen([servoctl, "gateway", "-b", "sim:gsd600@1", "--listen", socket, "-v"], env=env, text=True,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    try:
        end = time.monotonic() + 10
        while not os.path.exists(socket) and time.monotonic() < end:
            time.sleep(0.05)
        on_a_bus(f"gateway:{socket}", "gsd600", "a gateway of CiA 309-3", ("read", "statusword"))
    finally:
        gateway.terminate()
        told = gateway.communicate()[1]
    is_told("the gateway itself", r"^detail: node 1, object 0x6041:0.*: read in \d+\.\d ms: ", told)


try:
    for one in BUSES:
        on_a_bus(*one, ("info",) if one[2] == "Modbus" else ("status",))
    for test in (what_is_read_and_written, what_is_sent_and_decided, with_a_slave_in_op, of_axes, in_other_forms, with_quiet, at_the_prompt, over_a_gateway):
        test()
    for failure in pty_terminal.failures:
        check(failure, False)
finally:
    shutil.rmtree(home)
finish()
