#!/usr/bin/env python3
"""Every command that uses the bus, with its interface down from the beginning and going down in the midst of it: exit code 3,
the bus is named once, nothing hangs or crashes, and the next line works.
Runs inside with-vcan.sh, with can0 and can1 on one bus. usage: every_command_test.py SERVOCTL"""
import os
import re
import subprocess
import sys
import tempfile
import time

servoctl = os.path.abspath(sys.argv[1])
if os.environ.get("VCAN_GUEST") != "uml":
    print("skipped: there is no can0 and can1")
    sys.exit(0)
env = {k: v for k, v in os.environ.items() if not k.startswith("SERVOCTL_")}
env["LANG"] = "C"
work = tempfile.mkdtemp()
os.chdir(work)
env["XDG_STATE_HOME"] = work
failures = 0
checks = 0

# A line of each command; FILES are made below.
LINES = """
scan
info
status
read 0x1000
write 0x6083 1000
param get Pn0214
param set Pn0214=45Hz
backup down.json
witness down-witness.json
cabinet init down.toml
cabinet plan
cabinet apply --yes
cabinet backup
cabinet swap one --yes
diff good.json node:1
verify good.json
eds verify good.eds
eds learn --output down.eds
restore good.json --yes
clone --from 1 --to 2 --yes
address 5 --yes
lss scan
lss inquire --only
lss select --only
lss set-node 5 --only --yes
lss set-bitrate 500k --only --yes
lss store --only --yes
store --yes
defaults --yes
fault show
fault reset --yes
fault clear-history --yes
enable --yes
disable
quick-stop
stop
mode
jog 60rpm --for 5s --turn 131072 --yes
move 1rev --relative --turn 131072 --yes
home 35 --yes
torque 1% --for 1s --yes
units show
units learn --yes
heartbeat set 100ms
heartbeat consume 127 500ms
heartbeat show
watchdog
nmt start
nmt stop
nmt preop
nmt reset --wait --yes
nmt reset-comm --wait --yes
nmt watch --for 5s
pdo show
pdo map tpdo1 0x6041
pdo enable tpdo1
pdo disable tpdo1
pdo clear tpdo1
pdo preset velocity
pdo apply good.toml
pdo save down.toml
pdo watch --for 5s
pdo send rpdo1 controlword=6 --yes
test comm
test io --for 2s
test jog 60rpm --turn 131072 --yes
test home --yes
test all 60rpm --turn 131072 --yes
report down.html
sync once --yes
sync start --period 100ms --for 5s --yes
watch 0x6041 --for 5s
scope 0x6064 --for 5s
monitor --for 5s
replay good.log --yes
run lines
sim gsd600@9
gateway --listen 127.0.0.1:29555
"""
# Those that are no line of a test like this, and why.
LEFT_OUT = {
    "bus status": "shows interfaces that are down", "bus up": "its work is an interface that is down", "bus down": "the same",
    "bus detect": "takes the interface down and up itself", "doctor": "says what is wrong with an interface that is down, with exit code 1",
    "state init": "EtherCAT", "state preop": "EtherCAT", "state safeop": "EtherCAT", "state op": "EtherCAT",
    "sync stop": "stops what a line of the prompt began",
    **{path: "uses no bus" for path in ("explain", "objects", "param list", "param search", "param explain", "cabinet check", "cabinet show",
                                        "cabinet diff", "fault list", "units forget", "decode", "drives", "drives check", "drives new",
                                        "eds check", "help", "man", "completion")},
}
# Those that are over before anything can happen: they send a frame and wait for none, or for one that comes at once.
AT_ONCE = {"nmt start", "nmt stop", "nmt preop", "nmt reset", "nmt reset-comm", "sync once", "replay", "lss scan", "lss inquire", "lss select", "lss set-node",
           "lss set-bitrate", "lss store"}
# Ways out, which wait for a bus that is lost.
WAIT = {"disable", "quick-stop", "stop"}


def run(*words):
    return subprocess.run(words, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True)


def set_link(state):
    run("ip", "link", "set", "can0", state)


def check(what, condition, answer):
    global failures
    if not condition:
        failures += 1
        print("FAILED", what, "\n" + answer)


def words_of(line):
    words = line.split()
    if words[0] in ("sim", "gateway", "lss"):
        return [servoctl, "-b", "can0", *words]
    if words[0] == "cabinet":
        return [servoctl, *(["-b", "can0"] if words[1] == "init" else []), *words]
    return [servoctl, "-b", "can0", "-n", "1", "-d", "gsd600", *words]


def path_of(line):
    words = line.split()
    return " ".join(words[:2]) if " ".join(words[:2]) in COMMANDS else words[0]


def hold(what, code, out, took, limit=4):
    global checks
    checks += 1
    check(f"{what}: exit code {code}", code == 3, out)
    check(f"{what}: {took:.1f} s", took < limit, out)
    told = [text for text in out.splitlines() if text.startswith("error") and "can0" in text]
    check(f"{what}: the bus is named {len(told)} times", len(told) == 1, out)


def before(line):
    begun = time.monotonic()
    answer = subprocess.run(words_of(line), env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True,
                            timeout=20)
    hold(f"down before `{line}`", answer.returncode, answer.stdout, time.monotonic() - begun)


def during(line, tries=3):
    process = subprocess.Popen(words_of(line), env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True)
    time.sleep(0.15)  # The drive has not answered for the first time yet.
    if process.poll() is not None:
        check(f"down in `{line}`: it was over", False, process.communicate()[0])
        return
    set_link("down")
    begun = time.monotonic()
    try:
        out = process.communicate(timeout=20)[0]
    except subprocess.TimeoutExpired:
        process.kill()
        out = process.communicate()[0] + "\nIT DID NOT END"
    if process.returncode == 0 and tries > 1:  # It may have had its answer while this machine took its time.
        set_link("up")
        time.sleep(0.2)
        return during(line, tries - 1)
    # Who listens waits for the bus until its own end.
    most = 12 if path_of(line) in WAIT else 7 if "--for 5s" in line else 4
    hold(f"down in `{line}`", process.returncode, out, time.monotonic() - begun, most)
    set_link("up")
    time.sleep(0.1)


COMMANDS = re.findall(r"^  ([a-z-]+(?: [a-z-]+)?)  +[A-Z]", run(servoctl, "help").stdout.split("At the prompt also")[0], re.M)
lines = LINES.split("\n")[1:-1]
covered = {path_of(line) for line in lines}
for path in COMMANDS:
    check(f"`{path}` is neither tried nor left out", (path in covered) != (path in LEFT_OUT), "")
check("commands that are no more", not (covered | set(LEFT_OUT)) - set(COMMANDS), str((covered | set(LEFT_OUT)) - set(COMMANDS)))

with open("cabinet.toml", "w") as file:
    file.write('[bus.main]\nurl = "can0"\n[axis.one]\nbus = "main"\nnode = 1\nfamily = "gsd600"\n[axis.one.parameters]\nPn0214 = "47Hz"\n')
with open("good.eds", "w") as file:
    file.write("[1000]\nParameterName=Device type\nObjectType=0x7\nDataType=0x7\nAccessType=ro\nPDOMapping=0\n")
with open("lines", "w") as file:
    file.write("read 0x1000\n" * 5)
with open("good.log", "w") as file:
    file.write("(0.0) can0 601#4000100000000000\n")
# The drive answers at once while the files are made, and later so that each line is still under way.
for delay in ("0ms", "300ms"):
    sim = subprocess.Popen([servoctl, "sim", f"gsd600@1?delay={delay}", "-b", "can1"], env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for _ in range(50):
        if run(*words_of("read 0x1000")).returncode == 0:
            break
        time.sleep(0.1)
    if delay == "0ms":
        for line in ("backup good.json", "pdo save good.toml"):
            answer = run(*words_of(line))
            check(line, answer.returncode == 0, answer.stdout)
        set_link("down")
        for line in lines:
            before(line)
        set_link("up")
        time.sleep(0.2)
    else:
        for line in lines:
            if path_of(line) not in AT_ONCE:
                during(line)
    answer = run(*words_of("read 0x1000"))
    check("the next line works", answer.returncode == 0 and "0x00020192" in answer.stdout, answer.stdout)
    sim.terminate()
    sim.wait()
print(f"{checks} checks, {failures} failed")
sys.exit(1 if failures else 0)
