#!/usr/bin/env python3
"""Files that nobody named, of another user or open to others: a cabinet file above, drive data, the folder for state.
What needs a second user is tried as root alone.
usage: foreign_files_test.py SERVOCTL"""
import os
import shutil
import subprocess
import sys
import tempfile

from checks import check, finish

servoctl = os.path.abspath(sys.argv[1])
eds = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../eds")
folder = tempfile.mkdtemp(prefix="foreign", dir="/tmp")  # Another user has to reach it.
os.chmod(folder, 0o755)
bare = {k: v for k, v in os.environ.items() if not k.startswith(("SERVOCTL_", "SUDO_"))} | {
    "XDG_STATE_HOME": os.path.join(folder, "state"), "XDG_CONFIG_HOME": os.path.join(folder, "config")}
env = bare | {"SERVOCTL_DRIVES": eds}
is_root = os.geteuid() == 0
other = 65534
cabinet = os.path.join(folder, "cabinet.toml")
below = os.path.join(folder, "cell/three")
os.makedirs(below)
with open(cabinet, "w") as file:
    file.write('format = 1\n[bus.main]\nurl = "sim:gsd600@3"\n[axis.lift]\nbus = "main"\nnode = 3\nfamily = "gsd600"\n')
os.chmod(cabinet, 0o644)


def run(*words, program=servoctl, env=env, user=None):
    who = ["setpriv", "--reuid", str(user), "--regid", str(user), "--clear-groups"] if user else []
    return subprocess.run([*who, program, *words], cwd=below, env=env, capture_output=True, text=True, timeout=60)


def refused(what, answer, *texts):
    said = answer.stdout + answer.stderr
    check(f"{what}: exit code {answer.returncode}\n{said}", answer.returncode == 8)
    for text in texts:
        check(f"{what}: '{text}' is missing in\n{said}", text in said)


def accepted(what, answer):
    check(f"{what}: exit code {answer.returncode}\n{answer.stdout}{answer.stderr}", answer.returncode == 0)


def cabinet_files():
    lines = (("read", "0x1000", "-n", "lift"), ("status",), ("jog", "60rpm", "--for", "1s", "-n", "lift", "--yes"), ("cabinet", "plan"),
             ("cabinet", "apply", "--yes"))
    accepted("one of this user", run("read", "0x1000", "-n", "lift"))
    os.chmod(cabinet, 0o666)
    for line in lines:
        refused(f"one that all may write, {line[0]}", run(*line), "can be changed by every user", f"--cabinet {cabinet}")
    accepted("the same, named", run("read", "0x1000", "-n", "lift", "--cabinet", cabinet))
    accepted("the same, named before", run("read", "0x1000", "-n", "lift", env=env | {"SERVOCTL_CABINET": cabinet}))
    accepted("a line that needs none", run("read", "0x1000", "-n", "3", "-b", "sim:gsd600@3"))
    os.chmod(cabinet, 0o644)
    if not is_root:
        return
    os.chown(cabinet, other, other)
    for line in lines:
        refused(f"one of another user, {line[0]}", run(*line), "belongs to the user", f"--cabinet {cabinet}")
    accepted("the same, named", run("read", "0x1000", "-n", "lift", "--cabinet", cabinet))
    accepted("one of who called sudo", run("read", "0x1000", "-n", "lift", env=env | {"SUDO_UID": str(other)}))
    accepted("one's own, as no root", run("read", "0x1000", "-n", "lift", user=other))
    os.chown(cabinet, other - 1, other - 1)
    refused("one of another user, as no root", run("read", "0x1000", "-n", "lift", user=other), "belongs to the user")
    os.chown(cabinet, 0, 0)
    accepted("root's, as no root", run("read", "0x1000", "-n", "lift", user=other))


def drive_data():
    line = ("read", "Pn0214", "-n", "3", "-b", "sim:gsd600@3", "-d", "gsd600")
    overlay = os.path.join(folder, "config/servoctl/drives")
    os.makedirs(overlay)
    for file in os.listdir(os.path.join(eds, "vmmore")):
        shutil.copy(os.path.join(eds, "vmmore", file), overlay)
    without = {k: v for k, v in env.items() if k != "SERVOCTL_DRIVES"}
    accepted("an overlay of this user", run(*line, env=without))
    os.chmod(os.path.join(overlay, "gsd600.params.csv"), 0o666)
    refused("an overlay that all may write", run(*line, env=without), "can be changed by every user", f"SERVOCTL_DRIVES={overlay}")
    accepted("the same, named", run(*line, env=without | {"SERVOCTL_DRIVES": f"{overlay}:{eds}"}))
    shutil.rmtree(overlay)
    if not is_root:
        return
    # Somebody puts drive data where a copied program looks for its own.
    copy = os.path.join(folder, "bin/servoctl")
    os.makedirs(os.path.dirname(copy))
    shutil.copy(servoctl, copy)
    data = os.path.join(folder, "share/servoctl/eds")
    shutil.copytree(eds, data)
    accepted("data beside the program", run(*line, program=copy, env=without))
    for file in os.listdir(os.path.join(data, "vmmore")):
        os.chown(os.path.join(data, "vmmore", file), other, other)
    refused("data of another user beside it", run(*line, program=copy, env=without), "belongs to the user", "SERVOCTL_DRIVES=")
    os.chown(copy, other, other)
    accepted("program and data of one other user", run(*line, program=copy, env=without))


def state():
    words = ("read", "0x1000", "-n", "3", "-b", "sim:gsd600@3", "-d", "gsd600")
    kept = os.path.join(folder, "state/servoctl")
    shutil.rmtree(kept, ignore_errors=True)
    run(*words)
    check("the folder for state is for this user alone", os.stat(kept).st_mode & 0o777 == 0o700)
    os.chmod(kept, 0o777)
    answer = run(*words)
    accepted("a line with a folder for state that all may write", answer)
    check(f"it is told\n{answer.stderr}", "nothing is kept or remembered there" in answer.stderr)
    os.chmod(kept, 0o700)
    check("one's own is not told of", "nothing is kept" not in run(*words).stderr)
    if not is_root:
        return
    victim = os.path.join(folder, "victim")
    with open(victim, "w") as file:
        file.write("root's")
    os.chown(kept, other, other)
    for name in ("history", "prompt.json"):
        os.symlink(victim, os.path.join(kept, name))
    before = sorted(os.listdir(kept))
    from pty_terminal import Terminal
    t = Terminal(servoctl, "-b", "sim:gsd600@3", state=os.path.join(folder, "state"))
    t.see(r"> ")
    t.type("use 3\n")
    t.see(r"node 3[^>]*> ")
    t.type("exit\n")
    t.exit_code()
    with open(victim) as file:
        check("a prompt of root writes through no link of another user", file.read() == "root's")
    check("and puts nothing there", sorted(os.listdir(kept)) == before)


cabinet_files()
drive_data()
state()
shutil.rmtree(folder)
finish()
