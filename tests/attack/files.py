#!/usr/bin/env python3
"""Files the program writes, where links, devices, modes, limits and kills stand in their way: a file is the old or the
new one as a whole, keeps its mode and its links, a device stays a device, and what was not written is told with exit 7.
usage: files.py SERVOCTL COUNT [SEED]"""
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time

servoctl, count = str(pathlib.Path(sys.argv[1]).resolve()), int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else random.randrange(1 << 32)
rng = random.Random(seed)
top = pathlib.Path(tempfile.mkdtemp(prefix="servoctl-files-"))
families = ("gsd600", "dm", "da200", "ts", "sv2", "cia402")
env = dict(os.environ, HOME=str(top), XDG_STATE_HOME=str(top / "state"))
env.pop("SERVOCTL_BUS", None)
FULL = "No space left"


def command(path, family):
    at = ["-b", f"sim:{family}@1", "-n", "1", "-d", family, "--yes"]
    return rng.choice([["backup", path, *at], ["backup", path, "--format", "csv", *at], ["backup", path, "--format", "dcf", *at],
                       ["scope", "0x6041", "--for", "50ms", "--csv", path, *at], ["scope", "0x6041", "--for", "50ms", "--svg", path, *at]])


def run(words, limit=None, umask=None):
    def before():
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        if umask is not None:
            os.umask(umask)
    done = subprocess.run([servoctl, *words], env=env, stdin=subprocess.DEVNULL, capture_output=True, timeout=60, preexec_fn=before)
    return done.returncode, done.stderr.decode(errors="replace")


def mode(path):
    return stat.S_IMODE(os.stat(path).st_mode)


def leftovers(folder):
    return [name for name in os.listdir(folder) if name.startswith(".servoctl-")]


def told(code, err, what):
    if code != 7:
        return f"exit {code}, not 7: {err}"
    return "" if what in err else f"does not say {what!r}: {err}"


def replaced(folder, family):
    """An old file with any mode and owner, directly or behind links."""
    path, wanted = folder / "out", rng.choice([0o600, 0o640, 0o644, 0o660, 0o755])
    path.write_text("old")
    path.chmod(wanted)
    owner = (rng.randint(1000, 2000), rng.randint(1000, 2000)) if os.geteuid() == 0 and rng.random() < 0.5 else None
    if owner:
        os.chown(path, *owner)
    name = path
    for i in range(rng.randint(0, 3)):
        link = folder / f"link{i}"
        link.symlink_to(name if rng.random() < 0.5 else name.name)
        name = link
    links = [p for p in folder.iterdir() if p.is_symlink()]
    words = command(str(name), family)
    code, err = run([word for word in words if word != "--yes"])
    if code != 8 or path.read_text(errors="replace") != "old":
        return words, f"without --yes: exit {code}: {err}"
    code, err = run(words)
    if code != 0:
        return words, f"exit {code}: {err}"
    if path.is_symlink() or path.read_text(errors="replace") == "old":
        return words, "the file is not replaced"
    if mode(path) != wanted or (owner and (path.stat().st_uid, path.stat().st_gid) != owner):
        return words, f"mode {mode(path):o}, it was {wanted:o}; owner {path.stat().st_uid}"
    return words, "" if all(p.is_symlink() for p in links) else "a link is gone"


def made(folder, family):
    umask = rng.choice([0o022, 0o027, 0o077, 0])
    path = folder / "out"
    name = path
    if rng.random() < 0.4:
        name = folder / "dangling"
        name.symlink_to("out")
    words = command(str(name), family)
    code, err = run(words, umask=umask)
    if code != 0:
        return words, f"exit {code}: {err}"
    return words, "" if mode(path) == 0o666 & ~umask else f"mode {mode(path):o} with umask {umask:o}"


def device(folder, family):
    path, full = folder / "node", rng.random() < 0.5
    try:
        os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 7 if full else 3))
        path.chmod(0o666)
    except PermissionError:
        path = pathlib.Path("/dev/full" if full else "/dev/null")
    words = command(str(path), family)
    code, err = run(words)
    if not stat.S_ISCHR(path.stat().st_mode):
        return words, "the device is a file now"
    return words, told(code, err, FULL) if full else "" if code == 0 else f"exit {code}: {err}"


def fifo(folder, family):
    path = folder / "fifo"
    os.mkfifo(path)
    got = folder / "got"
    reader = subprocess.Popen(["cat", str(path)], stdout=got.open("wb")) if rng.random() < 0.7 else None
    words = command(str(path), family)
    try:
        begin = time.monotonic()
        code, err = run(words)
        if not stat.S_ISFIFO(path.stat().st_mode):
            return words, "the FIFO is a file now"
        if reader is None:
            return words, told(code, err, str(path)) or ("" if time.monotonic() - begin < 20 else "it waited for ever")
        if code != 0:
            return words, f"exit {code}: {err}"
        reader.wait(20)
        return words, "" if got.stat().st_size > 0 else f"exit {code}, {got.stat().st_size} bytes: {err}"
    finally:
        if reader is not None:
            reader.kill()
            reader.wait()


def limited(folder, family):
    """The disk is full in the middle: the old file stands."""
    path = folder / "out"
    path.write_text("old")
    path.chmod(0o600)
    words = command(str(path), family)
    code, err = run(words, limit=rng.choice([1, 100, 1000]))
    if code == 0:  # What is short enough fits.
        return words, "" if mode(path) == 0o600 else "the mode is gone"
    if path.read_text(errors="replace") != "old" or mode(path) != 0o600:
        return words, "the old file is not what it was"
    return words, told(code, err, "too large") or ("" if not leftovers(folder) else "something is left behind")


def read_only(folder, family):
    """A file that may not be written to; root may everything, and is not kept from it."""
    path = folder / "out"
    path.write_text("old")
    path.chmod(0o444)
    words = command(str(path), family)
    code, err = run(words)
    if os.geteuid() == 0:
        return words, "" if code == 0 and mode(path) == 0o444 else f"exit {code}, mode {mode(path):o}: {err}"
    return words, told(code, err, "ermission") or ("" if path.read_text() == "old" else "the file is replaced")


def killed(folder, family):
    path = folder / "out.json"
    at = ["-b", f"sim:{family}@1", "-n", "1", "-d", family, "--yes"]
    words = ["backup", str(path), *at]
    old = json.dumps({"old": "x" * rng.choice([10, 100000])})
    path.write_text(old)
    path.chmod(0o640)
    process = subprocess.Popen([servoctl, *words], env=env, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    end = time.monotonic() + rng.uniform(0, 0.6)
    # Most often while the new file is being written.
    while time.monotonic() < end and process.poll() is None and not leftovers(folder):
        pass
    process.send_signal(signal.SIGKILL)
    process.wait()
    now = path.read_text()
    if mode(path) != 0o640:
        return words, f"mode {mode(path):o}"
    if now == old:
        return words, ""
    try:
        return words, "" if "servoctl_backup" in json.loads(now) else "neither the old nor the new file"
    except ValueError:
        return words, f"half a file of {len(now)} bytes"


def trace(folder, family):
    """A trace that cannot be written is told, and what the command did is done."""
    kind = rng.choice(["full", "limit", "null", "folder", "link"])
    path = {"full": "/dev/full", "null": "/dev/null"}.get(kind, str(folder / "t.log"))
    if kind == "folder":
        path = str(folder)
    if kind == "link":
        (folder / "t.log").symlink_to("real.log")
    many = rng.random() < 0.5
    words = [*(["watch", "0x6041", "--for", "400ms"] if many else ["read", "0x6041"]), "-b", f"sim:{family}@1", "-n", "1", "-d", family,
             "--trace", path]
    code, err = run(words, limit=50 if kind == "limit" else None)
    if kind in ("null", "link"):
        return words, "" if code == 0 and stat.S_ISCHR(os.stat("/dev/null").st_mode) else f"exit {code}: {err}"
    return words, told(code, err, "cannot write the trace")


kinds = [replaced, replaced, made, device, fifo, limited, read_only, killed, killed, trace, trace]
failures = done = 0
deadline = time.monotonic() + max(20, 3 * count)
try:
    for at in range(count):
        if time.monotonic() > deadline:
            break
        done += 1
        folder = top / str(at)
        folder.mkdir()
        kind, family = rng.choice(kinds), rng.choice(families)
        try:
            words, wrong = kind(folder, family)
        except OSError as error:
            words, wrong = [kind.__name__], str(error)
        if kind is not killed and leftovers(folder):
            wrong = wrong or f"left behind: {leftovers(folder)}"
        if wrong:
            failures += 1
            print(f"attack {at} of seed {seed} ({kind.__name__}): {' '.join(words)}: {wrong}")
finally:
    shutil.rmtree(top, ignore_errors=True)
print(f"files: {done} attacks, {failures} failures")
sys.exit(1 if failures else 0)
