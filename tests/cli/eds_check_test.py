#!/usr/bin/env python3
"""`eds check` of several files in every order, and of standard input. usage: eds_check_test.py SERVOCTL SOURCE_DIR"""
import itertools
import json
import subprocess
import sys

from checks import check, finish

servoctl, source = sys.argv[1:]
data = source + "/tests/cli/data/"


def checked(files, text=b""):
    run = subprocess.run([servoctl, "eds", "check", *files, "--json"], input=text, capture_output=True)
    return run.returncode, json.loads(run.stdout)


files = [data + "node.eds", data + "broken.eds", data + "empty.eds", data + "no-such.eds"]
for order in itertools.permutations(files):
    code, document = checked(order)
    check(f"exit code of {order}: {code}", code == 7)
    check(f"all files of {order}", [entry["file"] for entry in document["result"]] == list(order))
    for entry in document["result"]:
        usable = entry["file"].endswith(("node.eds", "broken.eds"))
        check(f"error of {entry['file']}", (entry["error"] is None) == usable)
        check(f"counts of {entry['file']}", (entry["errors"] is None) != usable)
for order in itertools.permutations(files[:2]):
    check("exit code with errors in one file", checked(order)[0] == 1)
check("exit code without errors", checked(files[:1])[0] == 0)

with open(data + "broken.eds", "rb") as file:
    text = file.read()
code, document = checked(["-"], text)
check("standard input", code == 1 and document["result"][0]["file"] == "-" and document["result"][0]["errors"] == 3)
code, document = checked(["-"], b"")
check("nothing on standard input", code == 7 and document["result"][0]["error"]["exit"] == 7)
run = subprocess.run([servoctl], input=b"eds check - --json\n" + text, capture_output=True)
check("standard input behind the command line", run.returncode == 1 and json.loads(run.stdout)["result"][0]["errors"] == 3)
run = subprocess.run([servoctl, "-"], input=b"eds check -\n", capture_output=True)
check("standard input that was a batch file", run.returncode == 2 and b"name a file" in run.stderr)
finish()
