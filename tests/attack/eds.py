#!/usr/bin/env python3
"""Data sheets with their bytes, lines, keys and encodings in disorder: `eds check` ends by itself, with 0, 1 or 7 and one JSON
document that lists the sheet, and says the same of it in any order beside another. usage: eds.py SERVOCTL COUNT [SEED]"""
import json
import pathlib
import random
import subprocess
import sys
import tempfile

servoctl, count = sys.argv[1], int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
data = pathlib.Path(__file__).resolve().parent.parent / "cli/data"
sheets = [(data / name).read_bytes() for name in ("foreign.eds", "wild.eds", "broken.eds", "node5.dcf", "node.eds")]
words = {"cp932": "速度指令モータ", "cp950": "馬達額定電流", "cp1251": "Скорость двигателя", "gbk": "目标速度", "utf-16": "速度"}


def disorder(text, dice):
    lines = text.split(b"\n")
    for _ in range(dice.randrange(1, 8)):
        at = dice.randrange(len(lines))
        act = dice.randrange(6)
        if act == 0 and lines[at]:
            byte = dice.randrange(len(lines[at]))
            lines[at] = lines[at][:byte] + bytes([dice.randrange(256)]) + lines[at][byte + 1:]
        elif act == 1:
            lines.insert(dice.randrange(len(lines)), lines[at])
        elif act == 2:
            encoding = dice.choice(list(words))
            lines[at] = lines[at].partition(b"=")[0] + b"=" + words[encoding].encode(encoding)
        elif act == 3 and b"=" in lines[at]:
            value = dice.choice([b"0777", b"$NODEID+0xFFFFFFFF", b"255", b"-1", b"0xA0", b"0x60400099", b"9" * 200])
            lines[at] = lines[at].partition(b"=")[0] + b"=" + value
        elif act == 4 and len(lines[at]) > 2:
            byte = dice.randrange(len(lines[at]) - 1)
            lines[at] = lines[at][:byte] + lines[at][byte + 1:byte + 2] + lines[at][byte:byte + 1] + lines[at][byte + 2:]
        elif act == 5 and len(lines) > 2:
            del lines[at]
    return b"\n".join(lines)


def check(files, text=None):
    run = subprocess.run([servoctl, "eds", "check", *files, "--json"], input=text, capture_output=True, timeout=20)
    document = json.loads(run.stdout) if run.returncode in (0, 1, 7) else None
    return run.returncode, document and document["result"]


failures = 0
with tempfile.TemporaryDirectory() as folder:
    path = folder + "/x.eds"
    for attack in range(count):
        dice = random.Random(f"{seed}/{attack}")
        text = disorder(dice.choice(sheets), dice)
        pathlib.Path(path).write_bytes(text)
        try:
            code, alone = check([path])
            other_code, other = check(["-"], text)
            first_code, first = check([path, path + ".none"])
            last_code, last = check([path + ".none", path])
            good = (alone is not None and len(alone) == 1 and code == other_code and other[0]["findings"] == alone[0]["findings"]
                    and first_code == last_code == 7 and first[0] == last[1] == alone[0])
        except (subprocess.TimeoutExpired, ValueError, KeyError, TypeError):
            good = False
        if not good:
            failures += 1
            print(f"eds.py {servoctl} {attack + 1} {seed}: attack {attack}: exit {code}: {text[:200]!r}")
print(f"eds: {count} attacks, {failures} failures")
sys.exit(1 if failures else 0)
