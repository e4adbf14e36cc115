"""What a one-shot command executes, as a linker script: `one_shot_order.py LAST MAP TRACE...`.

MAP is what the linker says of a program that was not linked as PIE, each TRACE what `valgrind --tool=lackey
--trace-mem=yes` wrote of a run of it. Sections stand in the order in which they are first executed; behind them those of
SocketCAN that LAST, the script of before, has.
"""
import bisect
import collections
import re
import sys


def sections(path):
    """(address, size, name, object) of each input section with code."""
    out, waiting = [], None
    for line in open(path):
        whole = re.match(r"^ (\.text\S*)\s+0x([0-9a-f]+)\s+0x([0-9a-f]+)\s+(\S.*)$", line)
        rest = re.match(r"^\s+0x([0-9a-f]+)\s+0x([0-9a-f]+)\s+(\S.*)$", line)
        alone = re.match(r"^ (\.text\S*)$", line)
        if whole:
            out.append((int(whole[2], 16), int(whole[3], 16), whole[1], whole[4].strip()))
        elif rest and waiting:
            out.append((int(rest[1], 16), int(rest[2], 16), waiting, rest[3].strip()))
        waiting = alone[1] if alone else None
    return sorted(s for s in out if s[0] and s[1])


def executed(trace, found, starts, order):
    for line in open(trace):
        if not line.startswith("I"):
            continue
        address = int(line[1:].split(",")[0], 16)
        at = bisect.bisect_right(starts, address) - 1
        if at >= 0 and address < found[at][0] + found[at][1]:
            order.setdefault(at)


def main(last, map_file, *traces):
    found = sections(map_file)
    starts = [s[0] for s in found]
    names = collections.Counter(s[2] for s in found)
    order = {}
    for trace in traces:
        executed(trace, found, starts, order)
    print("/* What a one-shot command executes, in the order of its first use. Written by bench/one_shot_order.sh. */")
    print("SECTIONS\n{\n  .text.one_shot :\n  {")
    lines = {}
    for at in order:
        _, _, name, file = found[at]
        if name == ".text":
            continue
        # Every command has a `run` in an anonymous namespace.
        member = re.sub(r".*\((.*)\)$", r"\1", file).split("/")[-1] if names[name] > 1 else ""
        lines[f"    *{member}({name})"] = True
    for line in open(last):
        if "SocketCan" in line or "socketcan" in line:
            lines.setdefault(line.rstrip())
    print("\n".join(lines))
    print("  }\n}\nINSERT BEFORE .text;")


main(*sys.argv[1:])
