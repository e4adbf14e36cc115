#!/usr/bin/env python3
"""Every command and option that a sentence names: in the documents, in what the program says (both languages of the catalogue), in
the data of the drives. What stands between backticks and begins with a command is known to `help` with its options; a whole line
is accepted by `run --check` for one of the families; what `explain` is said to explain, it explains.

usage: told_lines_test.py SERVOCTL SOURCE_DIR
"""
import glob
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile

servoctl, source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
sys.path.insert(0, os.path.join(source, "tests/lint"))
import catalogue  # noqa: E402  Its reader of PO files.

FAMILIES = ("gsd600", "dm", "da200", "ts", "sv2")
# What stands for something else: an ellipsis, {}, <value>, FILE, ${NODE}.
PLACEHOLDER = re.compile(r"[…{}<>*$]|\.\.\.|(?<![\w-])[A-Z][A-Z_:=.]*(?![\w-])|命令|词|文件")
# Options of other programs that our sentences name.
FOREIGN = {"--delay", "--device", "--net=host", "--privileged"}
# What begins as one of our lines and is none.
OTHER = {
    "man servoctl": "the program man",
    "man -l -": "the program man",
    "jog 60 --limit 100": "a drive whose unit nothing states, and the families state theirs",
    'heartbeat = "500ms"': "a line of a cabinet file",
    "state error 0x001A": "what the prompt says",
    "param set Pn0000=": "a line that is not whole yet",
}
PROMPT = ("use", "drive", "bus", "undo", "log", "exit")
CABINET = '[bus.main]\nurl = "sim:gsd600@1"\n' + "".join(
    f'[axis.{name}]\nbus = "main"\nnode = {node}\nfamily = "gsd600"\nper_turn = "5 mm"\n'
    for node, name in enumerate(("feeder", "lift", "joint", "gripper"), 1))


def said(*words, **more):
    return subprocess.run([servoctl, *words], capture_output=True, text=True, timeout=60, **more)


def commands():
    """The commands and the words of the prompt, with the text of their help."""
    listing = said("help").stdout
    names = re.findall(r"^  (\S+(?: \S+)*?) {2,}\S", listing.split("Commands:\n")[1].split("\n\nOptions")[0], flags=re.M)
    names += PROMPT
    return {name: said("help", *name.split()).stdout for name in names}


def spans(text):
    for span in re.findall(r"`([^`]+)`", text):
        yield " ".join(span.split())


def told():
    """Every span between backticks, and where it stands."""
    pages = glob.glob(os.path.join(source, "README*.md")) + glob.glob(os.path.join(source, "docs/**/*.md"), recursive=True)
    for page in sorted(pages):
        if page.endswith("/json.md"):  # Rows of keys, made from the schemas.
            continue
        text = open(page, encoding="utf-8").read()
        lines = [line for block in re.findall(r"^```sh\n(.*?)^```", text, flags=re.S | re.M) for line in block.splitlines()]
        for line in lines:
            if line.startswith("servoctl "):
                yield re.split(r" +#| [|>&]", line)[0], os.path.relpath(page, source)
        for span in spans(re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)):
            yield span, os.path.relpath(page, source)
    for text in catalogue.read(os.path.join(source, catalogue.CATALOGUE)):  # The Chinese has the same spans: Lint.catalogue.
        for span in spans(catalogue.PLACE.sub("…", text)):
            yield span, catalogue.CATALOGUE
    for file in sorted(glob.glob(os.path.join(source, "eds/**/*.toml"), recursive=True)):
        for span in spans(open(file, encoding="utf-8").read()):
            yield span, os.path.relpath(file, source)


def alternatives(span):
    """`nmt start|stop` is two commands."""
    choice = re.search(r"[^\s|]+(?:\|[^\s|]+)+", span)
    return [span] if not choice else [span.replace(choice.group(0), each) for each in choice.group(0).split("|")]


def words_of(span):
    try:
        return shlex.split(span)
    except ValueError:  # A lone quote.
        return span.split()


def named(words, known):
    """The command that the words begin with, the longest one; None when it is none."""
    for count in (2, 1):
        if " ".join(words[:count]) in known:
            return " ".join(words[:count])
    return None


def options_of(text):
    return set(re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", text))


def wrong_in(span, known, groups, every_option):
    """What is wrong with the names in it; "" when nothing is. And the words of a whole line, which are to be parsed."""
    if span in OTHER:
        return "", None
    words = words_of(span)
    program = words and words[0] == "servoctl"
    words = words[1:] if program else words
    if not words:
        return "", None
    if re.match(r"--?[a-z]", words[0]):
        strange = {word.split("=")[0] for word in words if word.startswith("--")} - every_option
        return (f"no command has {', '.join(sorted(strange))}" if strange else ""), None
    command = named(words, known)
    if not command:
        if words[0] in groups and (len(words) == 1 or PLACEHOLDER.search(words[1])):
            return "", None
        if words[0] in groups or (program and not PLACEHOLDER.search(words[0]) and words[0] not in ("-", "__complete")):
            return f"`{' '.join(words[:2])}` is no command", None
        return "", None
    strange = {word.split("=")[0] for word in words if re.match(r"--?[a-zA-Z]", word)} - options_of(known[command])
    if strange:
        return f"{command} has no {', '.join(sorted(strange))}", None
    rest = words[len(command.split()):]
    return "", words if rest and command not in PROMPT and not PLACEHOLDER.search(span) else None


def refused(lines, family, folder):
    """{number of a line: why} of the lines that are not accepted for a family. A sentence may leave an argument out."""
    bus = [] if family is None else ["-b", f"sim:{family}@1", "-n", "1", "-d", family]
    answer = said("run", "-", "--check", "--json", *bus, input="\n".join(lines) + "\n", cwd=folder)
    return {error["line"]: error["message"] for error in json.loads(answer.stdout)["result"]["errors"]
            if not re.search(r" (is missing|needs a value|needs a node)$", error["message"])}


def main():
    known = commands()
    groups = {name.split()[0] for name in known} - set(known)
    every_option = set().union(FOREIGN, *map(options_of, known.values()))
    failures, lines, explained, seen = [], {}, {}, 0
    for span, place in ((each, place) for span, place in told() for each in alternatives(span)):
        seen += 1
        wrong, words = wrong_in(span, known, groups, every_option)
        if wrong:
            failures.append(f"{place}: `{span}`: {wrong}")
        elif words and words[0] in ("explain", "help"):
            explained.setdefault(tuple(words), place)
        elif words:
            lines.setdefault(shlex.join(words), place)
    numbered = list(lines)
    with tempfile.TemporaryDirectory() as cell, tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(cell, "cabinet.toml"), "w", encoding="utf-8") as file:
            file.write(CABINET)
        # With a cabinet, which knows axes by their names; and without one.
        whys = [refused(numbered, None, cell), *(refused(numbered, family, folder) for family in FAMILIES)]
        for number, line in enumerate(numbered, 1):
            if all(number in why for why in whys):
                failures.append(f"{lines[line]}: `{line}`: {whys[-1][number]}")
        for words, place in explained.items():
            asked = [[]] if words[0] == "help" else [["-d", family] for family in FAMILIES]
            if all(said(*words, *more, cwd=folder).returncode for more in asked):
                failures.append(f"{place}: `{' '.join(words)}` says nothing, for no family")
    if seen < 3000 or len(lines) < 120 or len(explained) < 25:
        failures.append(f"only {seen} spans, {len(lines)} lines, {len(explained)} words: the test itself is broken")
    print("\n".join(failures) or f"{len(lines)} lines and {len(explained)} words are as the program has them")
    return bool(failures)


sys.exit(main())
