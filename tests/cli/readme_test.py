#!/usr/bin/env python3
"""Runs the tour of README.md and compares what the program says with what stands there; checks the table of commands.

usage: readme_test.py SERVOCTL SOURCE_DIR   (SERVOCTL_REWRITE_README=1 writes both anew)
"""
import json
import os
import re
import subprocess
import sys
import tempfile

servoctl, source = os.path.abspath(sys.argv[1]), sys.argv[2]
path = os.path.join(source, "README.md")
text = open(path, encoding="utf-8").read()
rewrite = os.environ.get("SERVOCTL_REWRITE_README") == "1"


def tour(readme):
    """The README with the output of every command in its console blocks as it is now."""
    env = dict(os.environ, SERVOCTL_DRIVES=os.path.join(source, "eds"), LANG="C.UTF-8")
    ran = 0
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(servoctl, os.path.join(folder, "servoctl"))
        env["PATH"] = folder + ":" + env["PATH"]

        def block(match):
            nonlocal ran
            out = []
            for line in match.group(1).splitlines():
                if not line.startswith("$ "):
                    continue
                out.append(line)
                export = re.match(r"\$ export (\w+)=(\S+)$", line)
                if export:
                    env[export.group(1)] = export.group(2)
                    continue
                done = subprocess.run(["bash", "-c", line[2:]], env=env, capture_output=True, text=True, timeout=60)
                out += (done.stdout + done.stderr).splitlines()
                ran += 1
            return "```console\n" + "\n".join(out) + "\n```"

        readme = re.sub(r"```console\n(.*?)\n```", block, readme, flags=re.S)
    if ran < 8:
        sys.exit(f"only {ran} commands of the tour were run: the test itself is broken")
    return readme


def table(readme):
    listing = subprocess.run([servoctl, "help"], capture_output=True, text=True, check=True).stdout
    rows = ["| command | what it does |", "|---|---|"]
    for line in listing.split("Commands:\n")[1].split("\n\n")[0].splitlines():
        name, summary = re.match(r"  (\S+(?: \S+)*?) {2,}(.*)", line).groups()
        rows.append(f"| `{name}` | {summary} |")
    body = "<!-- commands: begin -->\n" + "\n".join(rows) + "\n<!-- commands: end -->"
    return re.sub(r"<!-- commands: begin -->.*<!-- commands: end -->", lambda _: body, readme, flags=re.S)


fresh = table(tour(text))
if rewrite:
    open(path, "w", encoding="utf-8").write(fresh)
elif fresh != text:
    for old, new in zip(text.splitlines(), fresh.splitlines()):
        if old != new:
            print(f"README.md says: {old}\nthe program says: {new}")
            break
    sys.exit("README.md is not fresh: run SERVOCTL_REWRITE_README=1 tests/cli/readme_test.py BINARY SOURCE and read the diff")
print("README.md is fresh")
