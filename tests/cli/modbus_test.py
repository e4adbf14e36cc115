#!/usr/bin/env python3
"""Modbus between two processes: over a serial line of two pseudo-terminals, and over TCP on this machine.
usage: modbus_test.py SERVOCTL"""
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time

from checks import check, finish, needs_serial_lines
from joined_ptys import JoinedPtys

servoctl = os.path.abspath(sys.argv[1])
needs_serial_lines(servoctl)
folder = tempfile.mkdtemp(prefix="servoctl-modbus-")
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env.update(LANG="C", SERVOCTL_DRIVE="ts", XDG_STATE_HOME=folder)


def run(bus, *words):
    return subprocess.run([servoctl, "-b", bus, *words], env=env, capture_output=True, text=True, cwd=folder)


def serve(bus, spec):
    out = subprocess.Popen([servoctl, "sim", spec, "-b", bus, "-o", "jsonl"], env=env, stdout=subprocess.PIPE, text=True, cwd=folder)
    out.stdout.readline()
    return out


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def value(answer):
    return json.loads(answer.stdout)["result"][0]["value"]


def everything(what, asks, serves):
    drive = serve(serves, "ts@1,ts@2")
    try:
        answer = run(asks, "param", "set", "Fn_33=-200", "-n", "1")
        check(f"{what}: a parameter is written\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
        check(f"{what}: and nothing proves what it is", "nothing proves that it is a ts" in answer.stderr)
        answer = run(asks, "param", "get", "Fn_33", "-n", "1", "--json")
        check(f"{what}: and read\n{answer.stdout}{answer.stderr}", value(answer) == -200)
        answer = run(asks, "scan", "-n", "1-3", "--timeout", "200ms", "--json")
        nodes = [row["node"] for row in json.loads(answer.stdout)["result"]]
        check(f"{what}: scan finds both\n{answer.stdout}{answer.stderr}", nodes == [1, 2])
        run(asks, "param", "set", "Fn_12E=77", "-n", "1")
        answer = run(asks, "backup", "one.json", "-n", "1", "--yes")
        check(f"{what}: backup\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
        run(asks, "param", "set", "Fn_33=5", "Fn_12E=50", "-n", "1")
        answer = run(asks, "verify", "one.json", "-n", "1")
        check(f"{what}: verify sees a difference\n{answer.stdout}", answer.returncode == 1)
        answer = run(asks, "restore", "one.json", "-n", "1", "--yes")
        check(f"{what}: restore\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
        check(f"{what}: puts it back", value(run(asks, "param", "get", "Fn_12E", "-n", "1", "--json")) == 77)
        check(f"{what}: but no speed, which a drive that an input enables would follow\n{answer.stderr}",
              value(run(asks, "param", "get", "Fn_33", "-n", "1", "--json")) == 5 and "stays as it is" in answer.stderr)
        # Address 0 calls all, and none answers to it.
        run(asks, "backup", "zero.csv", "-n", "1", "--yes")
        with open(os.path.join(folder, "zero.csv")) as file:
            table = file.read()
        with open(os.path.join(folder, "zero.csv"), "w") as file:
            file.write(table.replace(",Fn_3A,Modbus address,u16,1,,hex:01 00", ",Fn_3A,Modbus address,u16,0,,hex:00 00"))
        answer = run(asks, "restore", "zero.csv", "-n", "1", "--with-address", "--yes")
        check(f"{what}: the address 0 is not restored\n{answer.stderr}", answer.returncode == 8 and "answer nobody on Modbus" in answer.stderr)
        check(f"{what}: and stays as it is", value(run(asks, "param", "get", "Fn_3A", "-n", "1", "--json")) == 1)
        answer = run(asks, "restore", "one.json", "-n", "1", "--with-address", "--yes")
        check(f"{what}: another address is no reason to refuse\n{answer.stderr}", answer.returncode == 0)
        run("sim:ts@1", "backup", "can.json", "-n", "1", "--yes")
        answer = run(asks, "diff", "one.json", "can.json", "--json")
        told = [row["id"] for row in json.loads(answer.stdout)["result"]["differences"]]
        check(f"{what}: a backup compares with one over CAN\n{answer.stdout}{answer.stderr}", told == ["Fn_12E", "Fn_33"] or told == ["Fn_33", "Fn_12E"])
        answer = run(asks, "restore", "can.json", "-n", "1", "--yes")
        check(f"{what}: which can be put back\n{answer.stdout}{answer.stderr}",
              answer.returncode == 0 and "have no Modbus register" in answer.stderr)
        answer = run(asks, "param", "set", "Fn_38=1", "-n", "1", "--yes")
        check(f"{what}: what may turn the motor is told\n{answer.stderr}", "nothing stops it" in answer.stderr)
        answer = run(asks, "restore", "one.json", "-n", "1", "--yes")
        check(f"{what}: not into a drive that is enabled\n{answer.stderr}", answer.returncode == 8)
        answer = run(asks, "jog", "60rpm", "-n", "1", "--yes")
        check(f"{what}: no motion\n{answer.stderr}", answer.returncode == 2 and "Fn_33" in answer.stderr)
        check(f"{what}: several at once", both_at_once(asks) if asks.startswith("modbus://") else refused_at_once(asks))
        begin = time.monotonic()
        waiting = subprocess.Popen([servoctl, "-b", asks, "scan"], env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(0.5)
        waiting.send_signal(signal.SIGINT)
        waiting.wait(10)
        check(f"{what}: Ctrl-C ends a scan at once", waiting.returncode == 130 and time.monotonic() - begin < 2)
    finally:
        drive.terminate()
        drive.wait()


def both_at_once(asks):
    lines = [subprocess.Popen([servoctl, "-b", asks, "param", "get", "Fn_33", "-n", "1", "--json"], env=env, stdout=subprocess.PIPE, text=True)
             for _ in range(4)]
    return all(json.loads(line.communicate()[0])["result"][0]["value"] == 5 for line in lines)


def refused_at_once(asks):
    first = subprocess.Popen([servoctl, "-b", asks, "watch", "Dn_00", "--for", "2s", "-n", "1", "-o", "jsonl"], env=env, stdout=subprocess.PIPE)
    first.stdout.readline()
    answer = run(asks, "param", "get", "Fn_33", "-n", "1")
    first.terminate()
    first.communicate()
    return answer.returncode == 3 and "is in use by another program" in answer.stderr


line = JoinedPtys()
everything("RTU", f"modbus:{line.ends[0]}@115200,8N1", f"modbus:{line.ends[1]}@115200,8N1")
everything("ASCII", f"modbus:{line.ends[0]}@9600,7E1,ascii", f"modbus:{line.ends[1]}@9600,7E1,ascii")
port = free_port()
everything("TCP", f"modbus://127.0.0.1:{port}", f"modbus://127.0.0.1:{port}")

# Frames of another form.
drive = serve(f"modbus:{line.ends[1]}@9600,8N1,ascii", "ts@1")
answer = run(f"modbus:{line.ends[0]}@9600,8N1", "param", "get", "Fn_33", "-n", "1", "--timeout", "100ms")
check(f"RTU to a drive of ASCII is silence\n{answer.stderr}", answer.returncode == 4 and "RTU" in answer.stderr)
drive.terminate()
drive.wait()
line.close()

# An adapter that hands back what it sends: a write that nobody takes is not acknowledged.
line = JoinedPtys(echo=True)
asks = f"modbus:{line.ends[0]}@115200,8N1"
answer = run(asks, "write", "Fn_33", "200", "-n", "1", "--timeout", "100ms")
check(f"an echo is no drive\n{answer.stdout}{answer.stderr}", answer.returncode == 4 and "only the request itself" in answer.stderr)
drive = serve(f"modbus:{line.ends[1]}@115200,8N1", "ts@1")
answer = run(asks, "param", "set", "Fn_33=200", "-n", "1")
check(f"with an echo everything works\n{answer.stdout}{answer.stderr}", answer.returncode == 0 and "hands back" in answer.stderr)
drive.terminate()
drive.wait()
line.close()

# A device that goes while it is watched, and nobody there.
drive = serve(f"modbus://127.0.0.1:{port}", "ts@1")
watching = subprocess.Popen([servoctl, "-b", f"modbus://127.0.0.1:{port}", "watch", "Dn_00", "--for", "3s", "-n", "1", "-o", "jsonl"], env=env,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
watching.stdout.readline()
drive.kill()
drive.wait()
out, err = watching.communicate(timeout=10)
check(f"a connection that is lost ends a watch with exit code 3\n{out[-300:]}{err}", watching.returncode == 3)
answer = run(f"modbus://127.0.0.1:{port}", "param", "get", "Fn_33", "-n", "1")
check(f"nobody listens\n{answer.stderr}", answer.returncode == 3 and "nothing listens at" in answer.stderr)

for bus, says in (("modbus:/dev/nosuchtty@9600", "there is no /dev/nosuchtty"), ("modbus://no.such.host.invalid", "not found")):
    answer = run(bus, "scan")
    check(f"{bus}: {says}\n{answer.stderr}", answer.returncode == 3 and says in answer.stderr)

# Another service than Modbus.
with socket.socket() as other:
    other.bind(("127.0.0.1", 0))
    other.listen()
    asking = subprocess.Popen([servoctl, "-b", f"modbus://127.0.0.1:{other.getsockname()[1]}", "param", "get", "Fn_33", "-n", "1"], env=env,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    talk, _ = other.accept()
    talk.recv(100)
    talk.send(b"SSH-2.0-OpenSSH_9.2\r\n")
    out, err = asking.communicate(timeout=10)
    check(f"another service is told\n{err}", asking.returncode == 3 and "no Modbus TCP" in err)
    talk.close()
finish()
