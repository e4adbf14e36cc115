#!/usr/bin/env python3
"""Compares the tables of docs/json.md with docs/schema/, from which they are made.

usage: json_page_test.py SERVOCTL SOURCE_DIR   (SERVOCTL_REWRITE_JSON_PAGE=1 writes them anew)
"""
import os
import re
import subprocess
import sys

from json_page import Page

servoctl, source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
path = os.path.join(source, "docs/json.md")
BEGIN, END = "<!-- schemas: begin -->", "<!-- schemas: end -->"


def commands():
    listing = subprocess.run([servoctl, "help"], capture_output=True, text=True, check=True).stdout
    lines = listing.split("Commands:\n")[1].split("\n\n")[0].splitlines()
    return [re.match(r"  (\S+(?: \S+)*?) {2,}", line).group(1) for line in lines]


with open(path, encoding="utf-8") as file:
    text = file.read()
head, begin, rest = text.partition(BEGIN)
_, end, tail = rest.partition(END)
if not begin or not end:
    sys.exit(f"{path} has no place for the tables: {BEGIN} … {END}")
fresh = f"{head}{BEGIN}\n{Page(os.path.join(source, 'docs/schema')).text(commands())}\n{END}{tail}"
anchors = re.findall(r'<a id="([^"]+)">', fresh)
if len(anchors) != len(set(anchors)):
    sys.exit("docs/json.md: a name appears twice: " + ", ".join(sorted({each for each in anchors if anchors.count(each) > 1})))
for link in sorted(set(re.findall(r"\]\(#([^)]+)\)", fresh)) - set(anchors)):
    sys.exit(f"docs/json.md: nothing is called #{link}")
if os.environ.get("SERVOCTL_REWRITE_JSON_PAGE") == "1":
    with open(path, "w", encoding="utf-8") as file:
        file.write(fresh)
elif fresh != text:
    for old, new in zip(text.splitlines(), fresh.splitlines()):
        if old != new:
            print(f"- {old[:300]}\n+ {new[:300]}")
            break
    sys.exit("docs/json.md is not what docs/schema/ says: `SERVOCTL_REWRITE_JSON_PAGE=1` writes its tables anew; read the diff")
print("docs/json.md is fresh")
