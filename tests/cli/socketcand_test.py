#!/usr/bin/env python3
"""The program on a bus behind a server of the socketcand protocol: a simulated drive is one client, commands are others.
usage: socketcand_test.py SERVOCTL"""
import json
import os
import signal
import socket
import subprocess
import sys
import time

from checks import check, finish
from socketcand_server import Server

servoctl = sys.argv[1]
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env["LANG"] = "C"


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
          "closed the connection" in err and "can be opened: now stopping node 1" in err and jog.returncode not in (0, 70))
    state = json.loads(run(bus, "status", "-n", "1", "-d", "gsd600", "--json").stdout)
    check(f"the drive is not energised: {state}", state["result"][0]["energised"] is False)
    check("no command was sent in halves", server.halves == 0)
finally:
    drive.terminate()
    drive.communicate()
    server.listener.shutdown(socket.SHUT_RDWR)  # Its thread waits in accept().
    server.listener.close()

# A server that hangs, its connection not closed: what is under way ends with an error that says so, and the next line works.
code = "import sys, time; sys.path.insert(0, sys.argv[1]); from socketcand_server import Server; print(Server().port, flush=True); time.sleep(600)"
for words in (["backup", "hung.json"], ["watch", "0x6041", "--for", "6s"], ["monitor", "--for", "6s"]):
    hanging = subprocess.Popen([sys.executable, "-c", code, os.path.dirname(os.path.abspath(__file__))], stdout=subprocess.PIPE, text=True)
    far = f"socketcand://127.0.0.1:{hanging.stdout.readline().strip()}/vcan0"
    drive = subprocess.Popen([servoctl, "sim", "gsd600@1?delay=5ms", "-b", far], env=env, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    drive.stdout.readline()
    try:
        line = subprocess.Popen([servoctl, "-b", far, "-n", "1", "-d", "gsd600", *words], env=env, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(0.7)
        check(f"{words} is under way", line.poll() is None)
        hanging.send_signal(signal.SIGSTOP)
        begun = time.monotonic()
        out, said = line.communicate(timeout=60)
        # Whoever listens waits for it until its own end.
        check(f"{words} waits\n{out}{said}", words[0] == "backup" or "waiting until it can be used again" in out + said)
        # Whoever asks is without an answer before the server is known to be silent.
        what = "no answer within" if words[0] == "backup" else "does not answer any more"
        check(f"a server that hangs ends {words} with an error\n{said}", line.returncode == (4 if words[0] == "backup" else 3)
              and said.count("error:") == 1 and what in said and time.monotonic() - begun < 8)
        if words[0] == "monitor":
            # Ctrl-C ends the wait at once, whatever the server does not answer.
            hanging.send_signal(signal.SIGCONT)
            time.sleep(0.2)
            line = subprocess.Popen([servoctl, "-b", far, "monitor"], env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                    text=True)
            time.sleep(0.7)
            hanging.send_signal(signal.SIGSTOP)
            time.sleep(4.5)
            line.send_signal(signal.SIGINT)
            begun = time.monotonic()
            out = line.communicate(timeout=60)[0]
            check(f"Ctrl-C ends the wait for a server that hangs: {time.monotonic() - begun:.1f} s\n{out}",
                  "waiting until it can be used again" in out and time.monotonic() - begun < 1)
        check("no file is made of half a backup", not os.path.exists("hung.json"))
        hanging.send_signal(signal.SIGCONT)
        time.sleep(0.2)
        answer = run(far, "monitor", "--for", "100ms")
        check(f"the next line connects\n{answer.stderr}", answer.returncode == 0)
    finally:
        for process in (drive, hanging):
            process.kill()
            process.communicate()

answer = run(bus, "scan")
check(f"a server that is gone\n{answer.stderr}", answer.returncode == 3 and "nothing listens at" in answer.stderr)
for wrong in ("socketcand:vcan0", "socketcand://127.0.0.1", "socketcand://127.0.0.1:x/vcan0"):
    answer = run(wrong, "scan")
    check(f"{wrong}\n{answer.stderr}", answer.returncode == 2 and "write socketcand://HOST/can0" in answer.stderr)
finish()
