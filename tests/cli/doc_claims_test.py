#!/usr/bin/env python3
"""Sentences of the documents that say what servoctl does or does not do are compared with the program. Each such sentence has a line in
doc_claims.txt: PAGE | SENTENCE | PROOF. The proof is a command line and a pattern that its output contains (`COMMAND => PATTERN`) or does
not contain (`COMMAND =/> PATTERN`), or the name of a test that shows it (`test NAME`).

usage: doc_claims_test.py SERVOCTL SOURCE_DIR
"""
import glob
import os
import re
import subprocess
import sys
import tempfile

servoctl, source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
# What such a sentence looks like.
CLAIM = re.compile(r"servoctl (does not|never|cannot|refuses|only)|preflight check (does not|says|shows|never|warns)|[Tt]here is no `"
                   r"|`[a-z -]+` (does not|never|refuses)")


def sentences(page):
    text = re.sub(r"^```.*?^```", "", open(os.path.join(source, page), encoding="utf-8").read(), flags=re.S | re.M)
    for paragraph in re.split(r"\n\s*\n|\n(?=[|#-])", text):
        for cell in " ".join(paragraph.split()).strip("| ").split(" | "):
            yield from re.split(r"(?<=[.;]) ", cell)


def claims():
    with open(os.path.join(source, "tests/cli/doc_claims.txt"), encoding="utf-8") as rows:
        for row in rows:
            if row.strip() and not row.startswith("#"):
                page, sentence, proof = (part.strip() for part in row.split(" | ", 2))
                yield page, sentence, proof


def output_of(command, folder):
    environment = {**os.environ, "HOME": folder, "XDG_STATE_HOME": folder, "XDG_CONFIG_HOME": folder, "LC_ALL": "C.UTF-8"}
    for name in ("SERVOCTL_BUS", "SERVOCTL_DRIVE", "SERVOCTL_NODE"):
        environment.pop(name, None)
    done = subprocess.run(command.replace("servoctl", servoctl), shell=True, cwd=folder, env=environment, text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60)
    return done.stdout


def all_tests():
    out = []
    for pattern in ("tests/**/*.cpp", "tests/**/*.py", "tests/**/*.sh", "tests/cli/golden_cases.txt"):
        out += [open(file, encoding="utf-8").read() for file in glob.glob(os.path.join(source, pattern), recursive=True)]
    return "\n".join(out)


def problem_of(sentence, proof, tests, folder):
    if proof.startswith("test "):
        suite, _, name = proof[len("test "):].partition(".")
        shown = f"TEST({suite}, {name})" in tests or f"TEST_F({suite}, {name})" in tests or f"TEST_P({suite}, {name})" in tests
        return None if shown or re.search(rf"^{re.escape(proof[5:])}:", tests, flags=re.M) else f"there is no {proof}"
    negated = " =/> " in proof
    command, pattern = proof.split(" =/> " if negated else " => ")
    text = output_of(command, folder)
    if bool(re.search(pattern, text)) != negated:
        return None
    return f"`{command}` {'prints' if negated else 'does not print'} '{pattern}':\n{text}"


problems = []
listed = {}
tests = all_tests()
with tempfile.TemporaryDirectory() as folder:
    for page, sentence, proof in claims():
        listed.setdefault(page, set()).add(sentence)
        if not any(sentence == each for each in sentences(page)):
            problems.append(f"{page}: no longer says: {sentence}")
        elif problem := problem_of(sentence, proof, tests, folder):
            problems.append(f"{page}: {sentence}\n  {problem}")
pages = [os.path.relpath(page, source) for page in glob.glob(os.path.join(source, "docs/*.md"))] + ["README.md", "CONTRIBUTING.md"]
for page in sorted(pages):
    for sentence in sentences(page):
        if CLAIM.search(sentence) and sentence not in listed.get(page, ()):
            problems.append(f"{page}: nothing in tests/cli/doc_claims.txt shows: {sentence}")
print("\n".join(problems) or f"{sum(map(len, listed.values()))} sentences compared")
sys.exit(bool(problems))
