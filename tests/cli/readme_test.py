#!/usr/bin/env python3
"""Runs the commands that README and the pages of docs/ show, and compares what the program says with what is printed there; checks the
tables of commands; compares what a Chinese page shows and names with its English page.

usage: readme_test.py SERVOCTL SOURCE_DIR [PAGE…]   (SERVOCTL_REWRITE_README=1 writes outputs and tables anew)
"""
import concurrent.futures
import glob
import os
import re
import subprocess
import sys
import tempfile

servoctl, source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
rewrite = os.environ.get("SERVOCTL_REWRITE_README") == "1"
LONGEST_README = 200  # Lines: the front page is read in five minutes.
LONGEST = 240  # Seconds for one command, many times what it takes: only one that hangs is ended.
FEWEST_COMMANDS = 350  # Of all pages together; fewer means that the test no longer finds them.


def tour(document):
    """The document with the output of every command in its console blocks as it is now, and how many were run. Blocks with a
    title are files that are written before the commands below them run, in a home folder of their own."""
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
                    env[export.group(1)] = export.group(2).strip("'")
                    continue
                unset = re.match(r"\$ unset (\w+(?: \w+)*)$", line)
                if unset:
                    for name in unset.group(1).split():
                        env.pop(name, None)
                    continue
                done = subprocess.run(["bash", "-c", line[2:]], env=env, cwd=home, capture_output=True, text=True, timeout=LONGEST)
                # In ~/.config/servoctl/ there may be /servoctl/, where the sources are.
                shown = re.sub(rf"(?<![\w.~-]){re.escape(source)}/", "", done.stdout + done.stderr)
                out += shown.replace(home + "/", "~/").splitlines()
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
    return document, ran


def table(page, translated):
    """The page with the commands as they are now. What a translation says of a command is kept."""
    begin, end = "<!-- commands: begin -->", "<!-- commands: end -->"
    words = dict(re.findall(r"^\| `(.+?)` \| (.+) \|$", page[page.index(begin):], flags=re.M)) if translated else {}
    listing = subprocess.run([servoctl, "help"], capture_output=True, text=True, check=True).stdout
    rows = ["| 命令 | 作用 |" if translated else "| command | what it does |", "|---|---|"]
    for line in listing.split("Commands:\n")[1].split("\n\n")[0].splitlines():
        name, summary = re.match(r"  (\S+(?: \S+)*?) {2,}(.*)", line).groups()
        rows.append(f"| `{name}` | {words.get(name, summary)} |")
    return re.sub(f"{begin}.*{end}", lambda _: "\n".join([begin, *rows, end]), page, flags=re.S)


def read(name):
    with open(os.path.join(source, name), encoding="utf-8") as file:
        return file.read()


def check(name):
    """What is wrong with the page (empty: nothing), and how many commands were run."""
    text = read(name)
    try:
        fresh, ran = tour(text)
    except subprocess.TimeoutExpired as late:
        return f"{name}: {late}", 0, text
    if "<!-- commands: begin -->" in fresh:
        fresh = table(fresh, translated="/zh/" in name)
    return difference(name, text, fresh), ran, fresh


def check_alone(name):
    """The same, when no other page runs: a simulated drive on a busy machine may be late. With SERVOCTL_REWRITE_README=1 the page is
    written anew."""
    problem, ran, fresh = check(name)
    if rewrite and problem:
        with open(os.path.join(source, name), "w", encoding="utf-8") as file:
            file.write(fresh)
        return "", ran, fresh
    return problem, ran, fresh


def difference(name, text, fresh):
    """The first line that differs; empty: none."""
    if fresh == text:
        return ""
    old, new = text.splitlines(), fresh.splitlines()
    for number in range(max(len(old), len(new))):
        before = old[number] if number < len(old) else "(no line)"
        now = new[number] if number < len(new) else "(no line)"
        if before != now:
            return f"{name}:{number + 1}:\n- {before}\n+ {now}"
    return f"{name} ends in another way"


def shape(name):
    """What a page and its translation have in common: the levels of the headings, the commands that are shown up to the first pipe,
    the number of table rows, and the numbers in the sentences from three digits on (lines of the manual, objects, times)."""
    text = read(name)
    commands = []
    for block in re.findall(r"^```console\n(.*?)^```", text, flags=re.S | re.M):
        commands += [re.split(r" [|;&] ?|[|]| \d?>", line)[0] for line in re.findall(r"^\$ (.*)$", block, flags=re.M)]
    commands = [line for line in commands if not re.match(r"export SERVOCTL_LANG=|printf |echo |servoctl param search ", line)]
    prose = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    prose = re.sub(r"<!-- commands: begin.*commands: end -->", "", prose, flags=re.S)
    return {
        "headings": [len(each) for each in re.findall(r"^(#+) ", prose, flags=re.M)],
        "commands": commands,
        "rows of tables": len(re.findall(r"^\|", prose, flags=re.M)),
        "numbers": sorted(set(re.findall(r"(?<![0-9A-Za-z_#])[0-9A-F]*\d[0-9A-F]{2,}(?![0-9A-Za-z_])", re.sub(r"\]\([^)]*\)", "]", prose)))),
    }


def unlike(translation):
    """What a Chinese page shows otherwise than the English page that it translates."""
    name = translation.replace("docs/zh/", "docs/").replace(".zh.md", ".md")
    if translation == "docs/zh/README.md":  # An index of its own: it has the pages that there are.
        return ""
    if not os.path.exists(os.path.join(source, name)):
        return f"{translation}: there is no {name}"
    ours, theirs = shape(translation), shape(name)
    for what, there in theirs.items():
        here = ours[what]
        if here != there:
            if isinstance(there, list):
                extra, missing = [each for each in here if each not in there], [each for each in there if each not in here]
                return f"{translation}: {what} unlike {name}: only here {extra}, only there {missing}, {len(here)} and {len(there)}"
            return f"{translation}: {what}: {here}, {name}: {there}"
    return ""


PAGES = sys.argv[3:] or ["README.md", "README.zh.md",
                         *sorted(os.path.relpath(each, source) for each in glob.glob(os.path.join(source, "docs/**/*.md"), recursive=True))]

# Side by side: the commands of a page wait for simulated drives most of their time.
with concurrent.futures.ThreadPoolExecutor() as pool:
    results = list(pool.map(check, PAGES))
results = [check_alone(page) if result[0] else result for page, result in zip(PAGES, results)]
problems = [problem for problem, _, _ in results if problem]
problems += [each for each in map(unlike, (page for page in PAGES if "zh" in re.split(r"[/.]", page))) if each]
problems += [f"{page}: more than {LONGEST_README} lines" for page in ("README.md", "README.zh.md") if read(page).count("\n") > LONGEST_README]
count = sum(ran for _, ran, _ in results)
if len(sys.argv) < 4 and count < FEWEST_COMMANDS:
    problems.append(f"only {count} commands were run: the test itself is broken")
if problems:
    sys.exit("\n".join(problems) + "\n`SERVOCTL_REWRITE_README=1` writes outputs and tables anew; read the diff")
print(f"{len(PAGES)} pages with {count} commands are as the program has them")
