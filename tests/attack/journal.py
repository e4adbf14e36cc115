#!/usr/bin/env python3
"""Restores that are killed, run twice at once, or find their journal, before-file or backup mutated by bytes or fields:
afterwards the drive holds all of what it held before or all of what was wanted, or the error was told; and no journal ever
makes servoctl write an object that is no setting.
usage: journal.py SERVOCTL COUNT [SEED]"""
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

servoctl, count = str(pathlib.Path(sys.argv[1]).resolve()), int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else random.randrange(1 << 32)
rng = random.Random(seed)
work = pathlib.Path(tempfile.mkdtemp(prefix="servoctl-journal-"))
env = dict(os.environ, HOME=str(work), XDG_STATE_HOME=str(work / "state"))
# A family, settings as they are and as they are wanted, and what makes the way through a memory switch or password.
FAMILIES = {
    "gsd600": (["Pn0202=401", "Pn0203=201", "Pn0214=601", "Pn0215=1001", "Pn0217=401"],
               ["Pn0202=321", "Pn0203=220", "Pn0214=450", "Pn0215=900", "Pn0217=300"], []),
    "ts": (["Fn_33=120", "Fn_3A=3"], ["Fn_33=90", "Fn_3A=5"], ["--keep"]),
    "da200": (["P5.12=77"], ["P5.12=33"], []),
}
family = rng.choice(sorted(FAMILIES))
others, wanted, how = FAMILIES[family]
bus = f"local:journal-{os.getpid()}"
base = ["-b", bus, "-n", "1", "-d", family]
failures = []
sim = subprocess.Popen([servoctl, "sim", f"{family}@1?delay=2ms", "-b", bus], env=env, stdin=subprocess.DEVNULL,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def run(*words, timeout=60):
    done = subprocess.run([servoctl, *words, *base], env=env, cwd=work, stdin=subprocess.DEVNULL, capture_output=True, timeout=timeout)
    return done.returncode, done.stderr.decode(errors="replace")


def start(*words):
    return subprocess.Popen([servoctl, *words, *base], env=env, cwd=work, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)


def holds(name):
    return run("verify", name)[0] == 0


def clean():
    for file in work.glob("good.json.before-*"):
        file.unlink()


BEFORE = work / "good.json.before-node-1.json"
JOURNAL = work / "good.json.before-node-1.json.journal"


def cut_off(lasts):
    """A restore that was killed in its writes; False when it was over, or had not begun."""
    clean()
    assert run("param", "set", *others)[0] == 0
    victim = start("restore", "good.json", "--yes", *how)
    time.sleep(rng.uniform(lasts / 3, lasts))
    victim.kill()
    victim.wait()
    return JOURNAL.exists()


def mutate(text):
    """Bytes turned, cut, doubled; or a field of the JSON set to something of another kind or value."""
    if rng.random() < 0.5:
        data = bytearray(text)
        for _ in range(rng.randint(1, 4)):
            what, at = rng.randrange(4), rng.randrange(len(data) + 1)
            if what == 0 and at < len(data):
                data[at] ^= 1 << rng.randrange(8)
            elif what == 1:
                del data[at:at + rng.randint(1, 20)]
            elif what == 2:
                data[at:at] = rng.randbytes(rng.randint(1, 8))
            else:
                data = data[:at] or data
        return bytes(data)
    document = json.loads(text)
    keys = [key for key in document if key not in ("entries", "identity")]
    key = rng.choice(keys)
    document[key] = rng.choice([None, 0, -1, 1, 128, 300, 2**40, 1.5, True, False, "", "x", "fnv1a64:0", [], {}, [[]],
                                [{"index": 0x6040, "sub": 0, "bytes": "0F 00"}], [{"index": 0x1010, "sub": 1, "bytes": "73 61 76 65"}],
                                [{"index": 0x607A, "sub": 0, "bytes": "FF FF 00 00"}]])
    return json.dumps(document).encode()


def whole(told):
    """The drive holds all of one or all of the other, or somebody was told."""
    return holds("good.json") or holds("other.json") or told


def attack_mutated(lasts):
    if not cut_off(lasts):
        return "" if holds("good.json") or holds("other.json") else "values of both, and no journal"
    target = rng.choice([JOURNAL, JOURNAL, BEFORE, work / "good.json"])
    kept = {file: file.read_bytes() for file in (JOURNAL, BEFORE, work / "good.json") if file.exists()}
    target.write_bytes(mutate(kept[target]))
    words = rng.choice([["restore", "good.json", "--yes", "--resume"], ["restore", BEFORE.name, "--yes"], ["restore", "good.json", "--yes"]])
    code, err = run(*words)
    control = json.loads(subprocess.run([servoctl, "read", "0x6040", "--json", *base], env=env, capture_output=True).stdout)["result"]
    problem = ""
    if code < 0 or code in (70, 139):
        problem = f"{words} of a mutated {target.name} ended with {code}: {err}"
    elif code == 0 and not (holds_bytes(kept) if target.name == "good.json" else whole(False)):
        problem = f"{words} of a mutated {target.name} said it was done, and the drive holds values of both"
    elif control and control[0].get("value") not in (0, None):
        problem = f"{words} of a mutated {target.name} wrote the controlword: {control}"
    mutated = target.read_bytes() if target.exists() else b""
    for file, data in kept.items():
        file.write_bytes(data)
    if problem:
        return problem + f"\n    it was {mutated[:300]!r}"
    # With the files as they were the way back is open, however the first try went.
    if code != 0:
        code, err = run("restore", BEFORE.name, "--yes")
        if code != 0 or not holds("other.json"):
            return f"after {words} of a mutated {target.name} nothing is undone any more: {code} {err}"
    return ""


def holds_bytes(kept):
    (work / "good.json").write_bytes(kept[work / "good.json"])
    return whole(False)


def values(file):
    entries = json.loads(file.read_bytes())["entries"]
    return {(entry["index"], entry["sub"]): entry["bytes"] for entry in entries if entry.get("bytes")}


def attack_two_at_once(lasts):
    clean()
    assert run("param", "set", *others)[0] == 0
    before = time.time()
    pair = [start("restore", "good.json", "--yes", *how)]
    time.sleep(rng.uniform(0, lasts / 2))
    pair.append(start("restore", "good.json", "--yes", *how))
    killed = rng.random() < 0.3
    if killed:
        time.sleep(rng.uniform(0, lasts))
        pair[0].kill()
    codes = [each.wait(timeout=60) for each in pair]
    if JOURNAL.exists():
        code, err = run("restore", "good.json", "--yes", "--resume")
        if code != 0:
            return f"two at once ({codes}, killed {killed}) left a journal that cannot be gone on with: {code} {err}"
        return "" if holds("good.json") else f"two at once ({codes}): gone on with, and not as wanted"
    if 0 in codes and not holds("good.json"):
        return f"two at once: one said it was done ({codes}), and the drive holds something else"
    if BEFORE.exists() and BEFORE.stat().st_mtime >= before - 1:
        # What stands there as from before is what was there before, and no mixture. The addresses, which no restore
        # writes, are not in it.
        held = values(BEFORE)
        if not any(held.items() <= values(work / name).items() for name in ("good.json", "other.json")):
            return f"two at once ({codes}): the before-file is neither what was there nor what was wanted"
    return ""


try:
    for _ in range(200):
        if run("read", "0x6041")[0] == 0:
            break
        time.sleep(0.02)
    # Ours only: what other parameters do in a restart of the drive is no matter here.
    assert run("param", "set", *wanted)[0] == 0
    names = [word.split("=")[0] for word in wanted]

    def save(name):
        assert run("backup", name)[0] == 0

    save("good.json")
    assert run("param", "set", *others)[0] == 0
    save("other.json")
    began = time.monotonic()
    code, err = run("restore", "good.json", "--yes", *how)
    assert code == 0, err
    lasts = time.monotonic() - began
    for number in range(count):
        problem = rng.choice([attack_mutated, attack_two_at_once])(lasts)
        clean()
        if problem:
            failures.append(f"  attack {number} of seed {seed} ({family}): {problem}")
finally:
    sim.terminate()
    sim.wait()
    shutil.rmtree(work, ignore_errors=True)
for line in failures:
    print(line)
print(f"journal: {count} attacks, {len(failures)} failures")
sys.exit(1 if failures else 0)
