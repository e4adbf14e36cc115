#!/usr/bin/env python3
"""Random numbers, units and signs (nan, inf, huge, tiny) into jog, move, home, torque, write, param set, wait and the options
that limit them, on simulated drives of every family. Never a crash, never "done" when what was measured or read back is not
what was asked, never energised afterwards.
usage: values.py SERVOCTL COUNT [SEED]"""
import json
import math
import os
import random
import re
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from checks import obeying

servoctl, count, seed = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 1
LONGEST = 90  # Seconds that one command may take: homing gives up after 50.
FAMILIES = {"cia402": 10000, "gsd600": 131072, "da200": 10000, "sv2": 0, "ts": 10000, "dm": 0}
SPEED = {"rpm": 1, "rev/s": 60, "rad/s": 30 / math.pi, "deg/s": 1 / 6}
ANGLE = {"deg": 1, "rev": 360, "rad": 180 / math.pi}
TIME = re.compile(r"\+?[0-9.]+(e[+-]?[0-9]+)?\s*(us|ms|s|min)$", re.I)
failures = 0


def failed(number, what, words):
    global failures
    failures += 1
    print(f"FAILED {servoctl} … (attack {number} of seed {seed}): {what}: {words}")


def number(r):
    kind = r.randrange(6)
    if kind == 0:
        return r.choice(["nan", "inf", "-inf", "1e30", "1e-30", "1e400", "-0", "0", "1e-320", "9223372036854775808", "0x80000000",
                         "-1e19", "", "1e", ".", "0.0001", "4294967296", "1,5", "١٠"])
    if kind == 1:
        return f"{r.uniform(-1, 1) * 10 ** r.uniform(-12, 12):.{r.randrange(1, 12)}g}"
    return f"{r.choice([1, 1, -1]) * r.uniform(0.2, 200):.{r.randrange(1, 5)}g}"


def turns(r):
    """Not so many that it takes minutes."""
    text = number(r)
    try:
        return text if not 2 < float(text) < 1e12 else "1"
    except ValueError:
        return text


def value(r, units):
    unit = r.choice(units) if r.random() < 0.85 else r.choice(["", "V", "h", "s", "Nm", "%", "parsec", "rpm", " rpm", "inc", "inc/s"])
    return r.choice(["", "", "", "", "", "+", "-", "+-", "--", " "]) + number(r) + unit


def asked(text, units):
    """What a text asks for in the first of the units; None where that is not for this script to say."""
    match = re.fullmatch(r"\s*\+?(-?[0-9.]+(?:e[+-]?[0-9]+)?)\s*([a-z/%]+)", text, re.I)
    if not match or match[2].lower() not in units:
        return None
    try:
        return float(match[1]) * units[match[2].lower()]
    except ValueError:
        return None


def command(r):
    limit = ["--limit", value(r, ["rpm"])] if r.random() < 0.3 else []
    more = r.choice([[], [], [], ["--window", value(r, ["deg"])], ["--accel", value(r, ["rpm/s", "ms", "inc/s2"])],
                     ["--max-torque", value(r, ["%", "Nm"])], ["--max-following-error", value(r, ["deg", "inc"])]])
    kind = r.choice(["jog", "jog", "move", "move", "home", "torque", "write", "param", "wait", "for", "timeout"])
    if kind == "jog":
        end = r.choice([["--for", "1200ms"], ["--for", "1200ms"], ["--turns", turns(r)]])
        return kind, ["jog", value(r, list(SPEED)), *end, *limit, *more]
    if kind == "move":
        words = ["move", value(r, list(ANGLE))] + (["--relative"] if r.random() < 0.5 else [])
        return kind, words + (["--speed", value(r, list(SPEED))] if r.random() < 0.4 else ["--speed", "120rpm"]) + limit + more
    if kind == "home":
        words = ["home", r.choice(["0", "35", "37", "1", "17", number(r)]), "--within", "3s"]
        for option, units in (("--speed", ["rpm"]), ("--search", ["rpm"]), ("--offset", ["deg"])):
            words += [option, value(r, units)] if r.random() < 0.5 else []
        return kind, words + limit + more
    if kind == "torque":
        return kind, ["torque", value(r, ["%", "Nm", "mNm"]), "--limit", r.choice(["60rpm", "200rpm", value(r, ["rpm"])]), "--for",
                      "1200ms", *more]
    if kind == "write":
        target = r.choice(["0x6083", "0x6081", "0x60FF", "0x607A", "0x6071", "0x6072", "0x1017", "0x6065", "0x6087"])
        return kind, ["write", target, value(r, list(SPEED) + list(ANGLE) + ["%", "ms", "inc", "inc/s2", "%/s"])]
    if kind == "param":
        return "write", ["param", "set", r.choice(["Pn0214", "Fn_33", "P0.25", "0x6083", "0x1017"]), value(r, ["Hz", "ms", "rpm", ""])]
    text = number(r).strip() + r.choice(["", "", "s", "ms", "us", "min", "h", " s"])
    if kind == "wait":
        return kind, ["run", "-", text]
    return kind, ["nmt", "watch", "--for", text] if kind == "for" else ["read", "0x6041", "--timeout", text]


def figures(document):
    rows = (document.get("result") or {}).get("summary") or []
    return {row["quantity"]: row for row in rows}


def judge(kind, words, document):
    """What is wrong with an answer of exit code 0; empty where nothing is."""
    result = document.get("result")
    if kind in ("jog", "move", "torque", "home"):
        if result.get("result") != "done" or not result["end"]["verified"]:
            return f"exit 0 with {result.get('result')}"
        seen = figures(document)
    if kind == "jog":
        wanted, speed = asked(words[1], SPEED), seen.get("velocity")
        # With ramps or turns of its own it need not reach its speed: then that is said.
        if wanted is None or not speed or speed["unit"] != "rpm" or result["unchecked"]:
            return ""
        most = max(speed["greatest"], speed["least"], key=abs)
        if wanted == 0 or abs(most - wanted) > abs(wanted) * 0.15 + 4:
            return f"{wanted:g} rpm asked for, {most:g} seen"
    if kind == "move":
        wanted, place = asked(words[1], ANGLE), seen.get("position")
        if wanted is None or not place or place["unit"] != "deg":
            return ""
        target = wanted + (place["first"] if "--relative" in words else 0)
        if abs(place["last"] - target) > max(0.5, abs(target) * 1e-4) or (wanted != 0 and "--relative" in words
                                                                       and place["last"] == place["first"]):
            return f"{target:g} deg asked for, {place['last']:g} seen"
    if kind == "torque":
        wanted, torque = asked(words[1], {"%": 1}), seen.get("torque")
        if wanted is not None and (wanted == 0 or abs(wanted) > 100 and "--max-torque" not in words):
            return f"{wanted:g} % was sent"
        if wanted is not None and torque and torque["unit"] == "%" and not result["unchecked"]:
            if abs(torque["last"] - wanted) > abs(wanted) * 0.25 + 1.5:
                return f"{wanted:g} % asked for, {torque['last']:g} seen"
    if kind == "home" and words[1] in ("0", "-0"):
        return "method 0 was done"
    if kind == "write":
        for one in result:
            wanted = asked(words[-1], {(one.get("unit") or "").lower(): 1})
            if wanted is not None and abs(one["value"] - wanted) > abs(wanted) * 0.011:
                return f"{wanted:g} asked for, {one['value']} stands there"
    if kind in ("wait", "for", "timeout") and not TIME.match(words[-1].strip()):
        return "a time without a unit"
    return ""


def attack(n):
    r = random.Random(f"{seed}-{n}")
    family, turn = r.choice(list(FAMILIES.items()))
    kind, words = command(r)
    bus = f"local:values-{os.getpid()}-{n}"
    env = dict(os.environ, SERVOCTL_BUS=bus, SERVOCTL_NODE="1", SERVOCTL_DRIVE=family)
    drive = subprocess.Popen([servoctl, "sim", f"{family}@1{obeying(family)}"], env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def status():
        answer = subprocess.run([servoctl, "status", "--json"], env=env, capture_output=True)
        return json.loads(answer.stdout)["result"][0] if answer.returncode == 0 else None

    try:
        end = time.monotonic() + 20
        while status() is None and time.monotonic() < end:
            time.sleep(0.05)
        line, script = [servoctl, *words, "--json"], ""
        if kind in ("jog", "move", "home", "torque"):
            line += ["--yes"] + (["--turn", str(turn)] if turn else [])
        if kind == "wait":
            line, script = [servoctl, "run", "-", "--check", "--json"], f"wait {words[-1]}\n"
        if kind == "for" and asked(words[-1], {"s": 1, "ms": 1, "us": 1, "min": 1}) and TIME.match(words[-1].strip()):
            words[-1] = line[-2] = "0.3s"  # Whoever asks for an hour gets one.
        where = f"{family}: {' '.join(map(repr, words))}"
        try:
            done = subprocess.run(line, env=env, input=script, capture_output=True, text=True, timeout=LONGEST)
        except subprocess.TimeoutExpired:
            return failed(n, f"it takes longer than {LONGEST} s", where)
        if not 0 <= done.returncode <= 8:
            return failed(n, f"exit {done.returncode} {done.stderr[-300:]}", where)
        try:
            document = json.loads(done.stdout)
        except ValueError:
            return failed(n, f"no JSON: {done.stdout[:200]!r}", where)
        if done.returncode == 0 and (wrong := judge(kind, words, document)):
            failed(n, wrong, where)
        after = status()
        if after is None or after["energised"] is not False:
            failed(n, f"afterwards the drive is {after}", where)
    finally:
        drive.terminate()
        drive.wait()


for i in range(count):
    attack(i)
print(f"values: {count} attacks, {failures} failures")
sys.exit(1 if failures else 0)
