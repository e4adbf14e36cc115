#!/usr/bin/env python3
"""What comes from files and drives: JSON in JSON without end, text of a drive that looks like options, commands and comments
in generated lines, COB-IDs of other services from every source, batch files that grow without end.
usage: foreign_input.py SERVOCTL COUNT [SEED]"""
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
work = pathlib.Path(tempfile.mkdtemp(prefix="servoctl-foreign-"))
env = dict(os.environ, HOME=str(work), XDG_STATE_HOME=str(work / "state"))
lab = pathlib.Path(__file__).resolve().parent.parent / "cli/data/drives/lab/lab.eds"
SECRET = "the content of a file of the host"
(work / "secret").write_text(SECRET)
FAMILIES = ("gsd600", "dm", "cia402")


def run(*words, timeout=60):
    done = subprocess.run([servoctl, *map(str, words)], env=env, cwd=work, stdin=subprocess.DEVNULL, capture_output=True, timeout=timeout)
    return done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace")


def deep_json():
    opening = rng.choice(["[", '{"a":', '[{"servoctl_backup":', '{"pdo":['])
    text = opening * rng.choice([100, 1000, 10_000, 100_000])
    if rng.random() < 0.3:
        text = '{"servoctl_backup":1,"entries":' + text
    (work / "deep.json").write_text(text)
    at = ["-b", "sim:gsd600@1", "-n", "1", "-d", "gsd600"]
    words = rng.choice([["restore", "deep.json", "--yes"], ["verify", "deep.json"], ["diff", "deep.json", "node:1"],
                        ["diff", "deep.json", "factory"], ["pdo", "apply", "deep.json", "--yes"], ["report", "page.html"]])
    code, _, err = run(*words, *at)
    return "" if code in (0, 1, 2, 7) else f"{words} of {opening!r} ended with {code}: {err[:300]}"


def hostile_text():
    pieces = ["--from=secret", "--from", "secret", "--yes", "-h", "--", '"', "'", "\\", "#", "${A}", "$", "\n", "\r\n", "\nuse 2\n", " ",
              "\t", "=1+1", "@x", "hex:", "\x1b[2J", "\x9b", "\u202e", "\u6d4b", "[1017]\n", ",", ";", "\x01", "\x7f"]
    return "".join(rng.choice(pieces) for _ in range(rng.randint(0, 6)))


def injection():
    """The string goes into a drive, out into lines, and through `run` into another."""
    text = hostile_text().encode("utf-8", "surrogateescape")
    if rng.random() < 0.3:
        text += bytes([rng.randrange(256) for _ in range(3)])
    bus = f"local:foreign-{os.getpid()}-{rng.randrange(1 << 30)}"
    eds = work / "lab.eds"
    shutil.copy(lab, eds)
    # The names of the data sheet are as foreign as the text.
    name = hostile_text().replace("\n", " ").replace("\r", " ")
    eds.write_bytes(eds.read_bytes().replace(b"ParameterName=Free text", b"ParameterName=Free " + name.encode()))
    sim = subprocess.Popen([servoctl, "sim", f"{eds}@1,{eds}@2", "-b", bus], env=env, cwd=work, stdin=subprocess.DEVNULL,
                           stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    at = ["-b", bus, "-d", "lab.eds"]
    try:
        for _ in range(200):
            if sim.poll() is not None:
                return f"no simulator: {sim.stderr.read().decode(errors='replace')}"
            if run("read", "0x1000", "-n", "1", *at)[0] == 0 and run("read", "0x1000", "-n", "2", *at)[0] == 0:
                break
            time.sleep(0.02)
        (work / "text.bin").write_bytes(text)
        code, _, err = run("write", "0x2000", "--from", "text.bin", "-n", "1", *at)
        if code:
            return f"{text!r} does not go into the drive: {err}"
        form = rng.choice(["diff", "batch", "json", "csv"])
        if form == "diff":
            _, out, _ = run("diff", "node:2", "node:1", "--batch", *at)
            (work / "lines.servoctl").write_text(out)
            words = ["run", "lines.servoctl", "--yes"]
        elif form == "batch":
            run("backup", "lines.servoctl", "--format", "batch", "-n", "1", *at)
            lines = (work / "lines.servoctl").read_bytes().replace(b"\nuse 1\n", b"\nuse 2\n")
            (work / "lines.servoctl").write_bytes(lines)
            words = ["run", "lines.servoctl", "--yes"]
        else:
            run("backup", f"saved.{form}", "-n", "1", *at)
            words = ["restore", f"saved.{form}", "--yes", "-n", "2"]
        code, out, err = run(*words, *at)
        (work / "got.bin").unlink(missing_ok=True)
        run("read", "0x2000", "--to", "got.bin", "-n", "2", *at)
        got = (work / "got.bin").read_bytes() if (work / "got.bin").exists() else None
        if got is not None and SECRET.encode() in got:
            return f"{form}: {text!r} sent a file of the host to the drive"
        if code == 0 and got != text:
            return f"{form}: {text!r} became {got!r} (name {name!r}): {out}{err}"
        if code not in (0, 1):
            return f"{form}: {text!r} (name {name!r}) is not taken: {code} {err}"
        return ""
    finally:
        sim.terminate()
        sim.communicate()


def restricted_cob_id():
    """None of CiA 301's restricted CAN-IDs gets into a drive, whatever the source."""
    family = rng.choice(FAMILIES)
    can_id = rng.choice([0, 0x80, rng.randrange(1, 0x80), rng.randrange(0x581, 0x600), rng.randrange(0x601, 0x680), rng.randrange(0x701, 0x800)])
    raw = can_id.to_bytes(4, "little")
    index = rng.choice([0x1400, 0x1401, 0x1800, 0x1801])
    (work / "t.csv").write_text(f"index,sub,raw\n0x{index:04X},1,hex:{raw.hex()}\n")
    (work / "t.servoctl").write_text(f"write 0x{index:04X}:1 0x{can_id:X}\n")
    (work / "t.bin").write_bytes(raw)
    (work / "t.concise").write_bytes(b"\x01\0\0\0" + index.to_bytes(2, "little") + b"\x01\x04\0\0\0" + raw)
    pdo = f"{'R' if index < 0x1800 else 'T'}PDO{(index & 0xFF) + 1}"
    (work / "t.toml").write_text(f'format = 1\nfamily = "{family}"\n[[pdo]]\npdo = "{pdo}"\ncob_id = "0x{can_id:X}"\nvalid = true\n')
    words = rng.choice([["restore", "t.csv", "--yes"], ["restore", "t.concise", "--yes"], ["restore", "t.servoctl", "--yes"],
                        ["run", "t.servoctl", "--yes"], ["write", f"0x{index:04X}:1", f"0x{can_id:X}"],
                        ["write", f"0x{index:04X}:1", "--from", "t.bin"], ["pdo", "apply", "t.toml", "--yes"],
                        ["pdo", "map", pdo, "0x6040" if pdo[0] == "R" else "0x6041", "--cob-id", f"0x{can_id:X}", "--yes"]])
    trace = work / "trace.log"
    trace.unlink(missing_ok=True)
    code, _, err = run(*words, "-b", f"sim:{family}@1", "-n", "1", "-d", family, "--trace", trace)
    want = "601#23" + index.to_bytes(2, "little").hex().upper() + "01" + raw.hex().upper()
    if trace.exists() and want in trace.read_text(errors="replace"):
        return f"{words} on {family} sent CAN-ID 0x{can_id:X}"
    return "" if code in (2, 7, 8) else f"{words} on {family} with CAN-ID 0x{can_id:X} ended with {code}: {err}"


def growing_batch():
    long = "q" * rng.choice([10, 1000, 4000])
    line = rng.choice(["read ${L}${A}", "param set Pn0214=${A}", "read " + "${L}" * rng.choice([1, 100, 5000]), "expect ${L}" + "${L}" * 500,
                       "write 0x2000 ${A} " + "x" * 1000, "nonsense${A}"])
    loops = rng.randint(0, 5)
    body = "\n".join(f"for {name} in {rng.choice(['1-10', '1-1000', '1-99999', 't.csv', '1,2,3'])}" for name in "ABCDE"[:loops])
    (work / "t.csv").write_text("n,m\n" + "".join(f"{i},{long}\n" for i in range(rng.choice([1, 100, 5000]))))
    text = f"drive gsd600\nuse 1\nset L={long} A=1\n{body}\n{line}\n" + "end\n" * loops
    (work / "grow.servoctl").write_text(text)
    began = time.monotonic()
    try:
        code, _, err = run("run", "--check", "grow.servoctl", timeout=120)
    except subprocess.TimeoutExpired:
        return f"more than 120 s for {text[:300]!r}"
    spent = time.monotonic() - began
    return "" if code in (0, 2, 7) else f"{code} after {spent:.1f} s for {text[:300]!r}: {err[:300]}"


failures = []
try:
    for number in range(count):
        attack = rng.choice([deep_json, injection, injection, restricted_cob_id, growing_batch])
        problem = attack()
        if problem:
            failures.append(f"  attack {number} of seed {seed}: {problem}")
finally:
    shutil.rmtree(work, ignore_errors=True)
for line in failures:
    print(line)
print(f"foreign_input: {count} attacks, {len(failures)} failures")
sys.exit(1 if failures else 0)
