#!/usr/bin/env python3
"""Runs the session that docs/session.svg shows once more, and compares what is to be seen.

usage: session_test.py SERVOCTL SOURCE_DIR   (SERVOCTL_REWRITE_README=1 records it anew, typed as slowly as a person does)
"""
import os
import re
import sys

from session_recording import record
from session_svg import settled_rows, svg

servoctl, source = sys.argv[1], sys.argv[2]
path = os.path.join(source, "docs", "session.svg")
TITLE = "A session of servoctl with a simulated drive: a fault, a parameter, a jog, undo"
LARGEST = 300_000
RED = "\u0332"  # Underlines the character before it, where a difference is printed.

# What a motion measures is never twice the same; nor is how many lines tell of it on the way.
SAMPLE = re.compile(r" +\d+\.\d+ s +-?[\d.]+ deg +")
MEASURED = re.compile(r"(seconds|quantity|position|velocity|torque) +")


def lines(rows):
    """The screen line by line, without what depends on the moment."""
    out = []
    texts = ["".join(cell[0] + (RED if cell[1] and cell[0] else "") for cell in row).rstrip() for row in rows]
    goes_on = False
    for text, row in zip(texts, rows):
        plain = "".join(cell[0] for cell in row).rstrip()
        if goes_on:
            out[-1] += text.replace(" ", "")
            goes_on = False
        elif SAMPLE.match(plain):
            pass
        elif plain.startswith("servoctl sim:"):
            # A state that was heard longer ago than 5 s has a mark, which moves the end of a long line.
            out.append(re.sub(f"\\?{RED}?]", "]", text).replace(" ", ""))
            goes_on = row[78][0] != " " or row[79][0] != " "
        else:
            out.append(re.sub(r"\s+", " ", re.sub(r"-?\d[\d.]*", "#", plain)) if MEASURED.match(plain) else text)
    while out and not out[-1]:
        out.pop()
    return out


def same(old, new):
    """Where fewer lines told of a motion, more of what was before is to be seen."""
    common = min(len(old), len(new))
    return old == new or (common > 12 and abs(len(old) - len(new)) < 6 and old[1 - common:] == new[1 - common:])


def without_repeats(screens):
    return [screen for i, screen in enumerate(screens) if i == 0 or screen != screens[i - 1]]


def compare(shown, fresh):
    old, new = (without_repeats([lines(rows) for rows in settled_rows(text)]) for text in (shown, fresh))
    if len(old) < 150:
        sys.exit(f"the picture has {len(old)} frames only: the test itself is broken")
    for before, now in zip(old, new):
        if not same(before, now):
            print("docs/session.svg shows", *before, "", "and the program", *now, "", sep="\n")
            sys.exit("`SERVOCTL_REWRITE_README=1` records docs/session.svg anew")
    if len(old) != len(new):
        sys.exit(f"docs/session.svg has {len(old)} different screens, the session {len(new)}")


rewrite = os.environ.get("SERVOCTL_REWRITE_README") == "1"
recorded = record(servoctl, slow=rewrite)
fresh = svg(recorded, TITLE)
if settled_rows(fresh) != [frame.rows for frame in recorded if frame.settled]:
    sys.exit("the picture does not show what was recorded")
if rewrite:
    with open(path, "w", encoding="utf-8") as file:
        file.write(fresh)
with open(path, encoding="utf-8") as file:
    shown = file.read()
if len(shown.encode()) > LARGEST:
    sys.exit(f"docs/session.svg is larger than {LARGEST} bytes")
compare(shown, fresh)
print("docs/session.svg is fresh")
