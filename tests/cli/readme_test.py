#!/usr/bin/env python3
"""Runs the tour of README.md and compares what the program says with what stands there; checks the table of commands.

usage: readme_test.py SERVOCTL SOURCE_DIR   (SERVOCTL_REWRITE_README=1 writes both anew)
"""
import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile

servoctl, source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
rewrite = os.environ.get("SERVOCTL_REWRITE_README") == "1"


def tour(document, fewest):
    """The document with the output of every command in its console blocks as it is now. Blocks with a title are files that
    are written before the commands below them run, in a home folder of their own."""
    ran = 0
    with tempfile.TemporaryDirectory() as folder:
        home = os.path.join(folder, "home")
        os.makedirs(home)
        os.symlink(servoctl, os.path.join(folder, "servoctl"))
        env = {k: v for k, v in os.environ.items() if not k.startswith(("SERVOCTL_", "XDG_"))}
        env.update(LANG="C.UTF-8", HOME=home, PATH=folder + ":" + env["PATH"])

        def console(text):
            nonlocal ran
            out = []
            for line in text.splitlines():
                if not line.startswith("$ "):
                    continue
                out.append(line)
                export = re.match(r"\$ export (\w+)=(\S+)$", line)
                if export:
                    env[export.group(1)] = export.group(2)
                    continue
                unset = re.match(r"\$ unset (\w+)$", line)
                if unset:
                    env.pop(unset.group(1), None)
                    continue
                done = subprocess.run(["bash", "-c", line[2:]], env=env, cwd=home, capture_output=True, text=True, timeout=60)
                out += (done.stdout + done.stderr).replace(source + "/", "").replace(home + "/", "~/").splitlines()
                ran += 1
            return "```console\n" + "\n".join(out) + "\n```"

        def block(match):
            language, title, body = match.groups()
            if title:
                file = os.path.join(home, title)
                os.makedirs(os.path.dirname(file), exist_ok=True)
                with open(file, "w", encoding="utf-8") as out:
                    out.write(body + "\n")
            return console(body) if language == "console" else match.group(0)

        document = re.sub(r"^```(\w+)(?: title=(\S+))?\n(.*?)\n```$", block, document, flags=re.S | re.M)
    if ran < fewest:
        sys.exit(f"only {ran} commands were run: the test itself is broken")
    return document


def table(readme, heads=("command", "what it does"), translated=False):
    """The readme with the commands as they are now. What a translation says of a command is kept."""
    begin, end = "<!-- commands: begin -->", "<!-- commands: end -->"
    words = dict(re.findall(r"^\| `(.+?)` \| (.+) \|$", readme[readme.index(begin):], flags=re.M)) if translated else {}
    listing = subprocess.run([servoctl, "help"], capture_output=True, text=True, check=True).stdout
    rows = [f"| {heads[0]} | {heads[1]} |", "|---|---|"]
    for line in listing.split("Commands:\n")[1].split("\n\n")[0].splitlines():
        name, summary = re.match(r"  (\S+(?: \S+)*?) {2,}(.*)", line).groups()
        rows.append(f"| `{name}` | {words.get(name, summary)} |")
    return re.sub(f"{begin}.*{end}", lambda _: "\n".join([begin, *rows, end]), readme, flags=re.S)


def chinese_table(readme):
    return table(readme, ("命令", "作用"), translated=True)


def check(name, fewest, change=lambda text: text):
    """Whether the document says what the program says; with SERVOCTL_REWRITE_README=1 it is written anew instead."""
    path = os.path.join(source, name)
    text = open(path, encoding="utf-8").read()
    fresh = change(tour(text, fewest))
    if rewrite:
        open(path, "w", encoding="utf-8").write(fresh)
    if fresh == text or rewrite:
        print(f"{name} is fresh")
        return True
    for old, new in zip(text.splitlines(), fresh.splitlines()):
        if old != new:
            print(f"{name}:\n- {old}\n+ {new}")
            break
    return False


PAGES = [
    ("README.md", 8, table),
    ("README.zh.md", 8, chinese_table),
    ("docs/adding-a-drive.md", 12),
    ("docs/lss.md", 4),
    ("docs/commissioning-gsd600.md", 20),
    ("docs/commissioning-da200.md", 20),
    ("docs/safety.md", 8),
    ("docs/troubleshooting.md", 15),
    ("docs/commissioning-dm.md", 25),
    ("docs/commissioning-ts.md", 25),
    ("docs/commissioning-sv2.md", 20),
    ("docs/cookbook.md", 30),
]

# Side by side: the commands of a page wait for simulated drives most of their time.
with concurrent.futures.ThreadPoolExecutor() as pool:
    fresh = list(pool.map(lambda page: check(*page), PAGES))
if not all(fresh):
    sys.exit("`SERVOCTL_REWRITE_README=1` writes the documents anew; read the diff")
