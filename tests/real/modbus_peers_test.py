#!/usr/bin/env python3
"""Modbus against other stacks: the server of libmodbus, pymodbus as server and as client of a simulated drive, mbpoll as its client.
All are Debian packages that `./dev` installs.
usage: modbus_peers_test.py SERVOCTL"""
import atexit
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from checks import check, finish, needs_serial_lines
from joined_ptys import JoinedPtys

servoctl = os.path.abspath(sys.argv[1])
needs_serial_lines(servoctl)
folder = tempfile.mkdtemp(prefix="servoctl-peers-")
atexit.register(shutil.rmtree, folder, ignore_errors=True)
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env.update(LANG="C", SERVOCTL_DRIVE="ts", XDG_STATE_HOME=folder)

LIBMODBUS_SERVER = r"""
#include <modbus/modbus.h>
#include <stdlib.h>
#include <string.h>
int main(int argc, char** argv) {
  const int tcp = strcmp(argv[1], "tcp") == 0;
  modbus_t* line = tcp ? modbus_new_tcp("127.0.0.1", atoi(argv[2])) : modbus_new_rtu(argv[2], 19200, 'N', 8, 1);
  modbus_mapping_t* map = modbus_mapping_new(4, 8, 0x1030, 0);
  uint8_t query[MODBUS_TCP_MAX_ADU_LENGTH];
  int listening = -1;
  map->tab_registers[0x33] = 200;
  map->tab_registers[0x99] = 1;
  map->tab_registers[0x100A] = 0xF32D;
  map->tab_input_bits[2] = 1;
  map->tab_bits[0] = 1;
  modbus_set_slave(line, 1);
  if (tcp) listening = modbus_tcp_listen(line, 1);
  else if (modbus_connect(line) != 0) return 1;
  for (;;) {
    if (tcp) modbus_tcp_accept(line, &listening);
    for (;;) {
      const int size = modbus_receive(line, query);
      if (size > 0) modbus_reply(line, query, size, map);
      if (size < 0 && tcp) break;
    }
  }
}
"""

# Version 3.8 (Debian 13) names framers by one type, 3.0 (Debian 12) by classes.
PYMODBUS_FRAMERS = r"""
try:
    from pymodbus import FramerType
    FRAMERS = {"rtu": FramerType.RTU, "ascii": FramerType.ASCII, "tcp": FramerType.SOCKET}
except ImportError:
    from pymodbus.transaction import ModbusAsciiFramer, ModbusRtuFramer, ModbusSocketFramer
    FRAMERS = {"rtu": ModbusRtuFramer, "ascii": ModbusAsciiFramer, "tcp": ModbusSocketFramer}
"""

PYMODBUS_SERVER = PYMODBUS_FRAMERS + r"""
import sys
from pymodbus.datastore import ModbusSequentialDataBlock as Block, ModbusServerContext, ModbusSlaveContext
from pymodbus.server import StartSerialServer, StartTcpServer
registers = [0] * 0x1030
registers[0x33], registers[0x99] = 200, 1
unit = ModbusSlaveContext(hr=Block(1, registers), di=Block(1, [0, 0, 1, 0, 0, 0, 0, 0]), co=Block(1, [1, 0, 0, 0]))
context = ModbusServerContext(slaves={1: unit}, single=False)
kind, where = sys.argv[1:]
if kind == "tcp":
    StartTcpServer(context=context, address=("127.0.0.1", int(where)), framer=FRAMERS[kind])
else:
    StartSerialServer(context=context, port=where, framer=FRAMERS[kind], baudrate=19200,
                      bytesize=8, parity="N", stopbits=1)
"""

PYMODBUS_CLIENT = PYMODBUS_FRAMERS + r"""
import sys
from pymodbus.client import ModbusSerialClient, ModbusTcpClient
kind, where = sys.argv[1:]
if kind == "tcp":
    client = ModbusTcpClient("127.0.0.1", port=int(where))
else:
    client = ModbusSerialClient(where, framer=FRAMERS[kind], baudrate=19200, bytesize=8,
                                parity="N", stopbits=1, timeout=1)
assert client.connect()
assert client.read_holding_registers(0x00, count=1, slave=1).registers == [2]
assert not client.write_register(0x33, 200, slave=1).isError()
assert client.read_holding_registers(0x33, count=1, slave=1).registers == [200]
assert not client.write_registers(0x30, [5, 6], slave=1).isError()
assert client.read_holding_registers(0x30, count=2, slave=1).registers == [5, 6]
assert client.read_discrete_inputs(0, count=8, slave=1).bits == [False] * 8
assert len(client.read_coils(0, count=4, slave=1).bits) == 8
assert client.read_holding_registers(0x0500, count=1, slave=1).exception_code == 2
assert client.write_register(0x99, 2, slave=1).exception_code == 3
assert client.write_register(0x1000, 2, slave=1).exception_code == 2
assert client.read_input_registers(0, count=1, slave=1).exception_code == 1
print("good")
"""


def mbpoll(kind, where, *words):
    """What one question of mbpoll answers: references from 0, registers of 16 bits."""
    how = ["-m", "tcp", "-p", where] if kind == "tcp" else ["-m", "rtu", "-b", "19200", "-P", "none"]
    target, values = ("127.0.0.1" if kind == "tcp" else where), [word for word in words if not word.startswith("-r")]
    reference = next(word for word in words if word.startswith("-r"))
    done = subprocess.run(["mbpoll", *how, "-a", "1", "-0", "-1", "-q", "-t", "4", reference, target, *values], capture_output=True, text=True,
                          timeout=30)
    return done.returncode, done.stdout + done.stderr


def ask_by_mbpoll(kind, where):
    answer = mbpoll(kind, where, "-r51", "250")
    check(f"mbpoll over {kind}: a register is written {answer}", answer[0] == 0)
    answer = mbpoll(kind, where, "-r51")
    check(f"mbpoll over {kind}: it is read {answer}", answer[0] == 0 and re.search(r"\[51\]:\s+250", answer[1]))
    answer = mbpoll(kind, where, "-r1280")
    check(f"mbpoll over {kind}: a register that is not there is refused {answer}", "Illegal data address" in answer[1])


def run(bus, *words):
    return subprocess.run([servoctl, "-b", bus, *words], env=env, capture_output=True, text=True, cwd=folder)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def ask(what, bus, server):
    begin = time.monotonic()
    while run(bus, "param", "get", "Fn_33", "-n", "1", "--timeout", "200ms").returncode != 0 and time.monotonic() - begin < 10:
        time.sleep(0.1)
    try:
        answer = run(bus, "param", "get", "Fn_33", "-n", "1", "--json")
        check(f"{what}: a register is read\n{answer.stdout}{answer.stderr}", json.loads(answer.stdout)["result"][0]["value"] == 200)
        answer = run(bus, "param", "set", "Fn_33=-300", "-n", "1")
        check(f"{what}: written, and read back\n{answer.stdout}{answer.stderr}", answer.returncode == 0 and "read back" in answer.stdout)
        answer = run(bus, "info", "-n", "1", "--json")
        told = json.loads(answer.stdout)["result"][0]
        check(f"{what}: inputs and outputs\n{answer.stdout}{answer.stderr}",
              told["inputs"] == [False, False, True] + [False] * 5 and told["outputs"] == [True, False, False, False])
        answer = run(bus, "backup", "peer.json", "-n", "1", "--yes")
        check(f"{what}: backup of all parameters\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
        answer = run(bus, "read", "Dn_2F", "-n", "1", "--json")
        check(f"{what}: the last register\n{answer.stdout}", answer.returncode == 0)
        answer = run(bus, "watch", "Dn_00", "--for", "300ms", "--every", "50ms", "-n", "1")
        check(f"{what}: watch\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
        answer = run(bus, "scan", "-n", "1,2", "--timeout", "300ms")
        check(f"{what}: scan\n{answer.stdout}{answer.stderr}", answer.returncode == 0)
    finally:
        server.terminate()
        server.wait()


def python(text, *words):
    # That of Debian, whose packages those are.
    return subprocess.Popen(["/usr/bin/python3", "-c", text, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


program = os.path.join(folder, "server")
with open(program + ".c", "w", encoding="utf-8") as source:
    source.write(LIBMODBUS_SERVER)
built = subprocess.run(["cc", program + ".c", "-o", program, "-lmodbus"], capture_output=True, text=True)
check(f"a server of libmodbus (libmodbus-dev)\n{built.stderr}", built.returncode == 0)
if built.returncode == 0:
    port = free_port()
    ask("libmodbus over TCP", f"modbus://127.0.0.1:{port}", subprocess.Popen([program, "tcp", str(port)]))
    line = JoinedPtys()
    ask("libmodbus over RTU", f"modbus:{line.ends[0]}@19200,8N1", subprocess.Popen([program, "rtu", line.ends[1]]))
    line.close()
there = python("import pymodbus.server, pymodbus.client")
told = there.communicate()[0]
check(f"pymodbus (python3-pymodbus, python3-serial-asyncio)\n{told}", there.returncode == 0)
if there.returncode == 0:
    for kind in ("tcp", "rtu", "ascii"):
        port, line = free_port(), JoinedPtys()
        form = "19200,8N1" + (",ascii" if kind == "ascii" else "")
        near, far = (f"modbus://127.0.0.1:{port}",) * 2 if kind == "tcp" else (f"modbus:{line.ends[i]}@{form}" for i in range(2))
        ask(f"pymodbus over {kind}", near, python(PYMODBUS_SERVER, kind, str(port) if kind == "tcp" else line.ends[1]))
        drive = subprocess.Popen([servoctl, "sim", "ts@1", "-b", near, "-o", "jsonl"], env=env, stdout=subprocess.PIPE, text=True, cwd=folder)
        drive.stdout.readline()
        client = python(PYMODBUS_CLIENT, kind, str(port) if kind == "tcp" else line.ends[1])
        told = client.communicate(timeout=30)[0]
        check(f"pymodbus asks a simulated drive over {kind}\n{told}", "good" in told)
        if kind != "ascii":  # It does not speak it.
            ask_by_mbpoll(kind, str(port) if kind == "tcp" else line.ends[1])
        drive.terminate()
        drive.wait()
        line.close()
finish()
