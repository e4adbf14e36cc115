#!/usr/bin/env python3
"""Holds what servoctl prints as JSON against docs/schema/: every document of the golden cases, and what the lines of
json_schemas_lines.txt print. A form of an answer that nothing here shows is an error, unless it stands in NOT_HERE.

usage: json_schemas_test.py SERVOCTL SOURCE_DIR
"""
import concurrent.futures
import glob
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import time
import warnings

from json_schemas import FILES, Schemas, jsonschema, read, samples_and_documents

servoctl, source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
BUSES = [("sim:da200@1", "da200"), ("sim:dm@1", "dm"), ("sim:gsd600@1", "gsd600"), ("sim:sv2@1", "sv2"), ("sim:ts@1", "ts"),
         ("coe:sim:sv2@1", "sv2"), ("modbus:sim:ts@1", "ts")]  # The last is slow: one request at a time.
# What needs something that is not in every machine, and why; the first words of a place. Real.field holds it against the schemas.
NOT_HERE = {
    "bus-status.schema.json#": "a CAN interface of the kernel",
    "bus-up.schema.json#": "a CAN interface of the kernel, and the right to change it",
    "bus-down.schema.json#": "a CAN interface of the kernel, and the right to change it",
    "bus-detect.schema.json#": "a CAN interface of the kernel with a bitrate",
    "scan.schema.json#/anyOf/4": "a CAN interface of the kernel: --all-bitrates --dry-run",
}
CABINETS = {
    "cabinet.toml": open(os.path.join(source, "tests/cli/data/two-axes.toml"), encoding="utf-8").read(),
    "away.toml": '[bus.main]\nurl = "sim:gsd600@1"\n[axis.lift]\nnode = 1\nfamily = "gsd600"\n'
                 '[axis.gone]\nnode = 2\nfamily = "gsd600"\n',
    "swap.toml": '[bus.main]\nurl = "sim:gsd600@5"\n[axis.lift]\nnode = 2\nfamily = "gsd600"\n',
    "mixed.toml": '[bus.main]\nurl = "sim:gsd600@1,gsd600@2"\n[bus.ring]\nurl = "coe:sim:sv2@1"\n'
                  '[axis.lift]\nbus = "main"\nnode = 1\nfamily = "gsd600"\n[axis.feed]\nbus = "ring"\nnode = 1\nfamily = "sv2"\n',
    "rings.toml": '[bus.one]\nurl = "coe:sim:sv2@1"\n[bus.two]\nurl = "coe:sim:sv2@1,sv2@2"\n'
                  '[axis.lift]\nbus = "one"\nnode = 1\nfamily = "sv2"\n',
    "settled.toml": '[bus.main]\nurl = "sim:gsd600@1"\n[axis.lift]\nnode = 1\nfamily = "gsd600"\nturn = 131072\nper_turn = "20 mm"\n'
                    'limits.speed = "600rpm"\nheartbeat = "100ms"\npdos = "pp"\nparameters.Pn0214 = "45Hz"\n',
    "logo.svg": '<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"/>',
    "two-buses.toml": '[bus.main]\nurl = "sim:gsd600@1"\n[bus.other]\nurl = "sim:sv2@255?lss"\n'
                      '[axis.lift]\nbus = "main"\nnode = 1\nfamily = "gsd600"\n',
}
schemas = Schemas(os.path.join(source, "docs/schema"))
problems = []
documents = 0


def hold(where, lines):
    """Each document among the lines against its schema."""
    global documents
    try:
        found = list(samples_and_documents(lines))
    except ValueError as error:
        problems.append(f"{where}: {error}")
        return
    for name, document in found:
        documents += 1
        if name not in schemas.names():
            problems.append(f"{where}: docs/schema/ has no {name}.schema.json")
            continue
        command = f" ({document['command']})" if name == "envelope" else ""
        problems.extend(f"{where}: {name}{command}: {text}" for text in schemas.errors(name, document))


def check_references():
    """The files as they are, with their $ref, for a validator that reads them: what docs/json.md recommends."""
    envelope = schemas.files["envelope.schema.json"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # Newer ones have another way as well.
        resolver = jsonschema.RefResolver("envelope.schema.json", envelope, store=schemas.files)
    validator = jsonschema.Draft202012Validator(envelope, resolver=resolver)
    done = subprocess.run([servoctl, "objects", "-d", "gsd600", "--json"], capture_output=True, text=True, check=True,
                          env=environment(source))
    document = read(done.stdout)
    problems.extend(f"with $ref: {error.message[:300]}" for error in validator.iter_errors(document))
    document["result"][0]["index"] = "1000h"
    if validator.is_valid(document):
        sys.exit("with $ref a bad document is taken")


def registry():
    listing = subprocess.run([servoctl, "help"], capture_output=True, text=True, check=True).stdout
    lines = listing.split("Commands:\n")[1].split("\n\n")[0].splitlines()
    return [re.match(r"  (\S+(?: \S+)*?) {2,}", line).group(1) for line in lines]


def check_registry():
    commands = {command.replace(" ", "-") for command in registry()}
    if len(commands) < 90:
        sys.exit(f"only {len(commands)} commands are in the help: the test itself is broken")
    described = {name.removesuffix(".sample") for name in schemas.names()} - {"envelope", "defs", *FILES}
    for name in sorted(commands - described):
        problems.append(f"docs/schema/ has no {name}.schema.json: it describes the result of a command")
    for name in sorted(described - commands):
        problems.append(f"docs/schema/{name}.schema.json is of no command")


def check_golden():
    cases = 0
    for file in sorted(glob.glob(os.path.join(source, "tests/cli/golden/*.txt"))):
        with open(file, encoding="utf-8", newline="\n") as text:
            for case in re.split(r"^=== ", text.read(), flags=re.M)[1:]:
                cases += 1
                name, said = case.split("\n", 1)
                for block in re.split(r"^(?=\$ )", said, flags=re.M):
                    hold(name, block.split("\n"))
    if cases < 500:
        sys.exit("the golden cases are not there")


def lines_to_run(folder):
    """Each line, and whether it is refused as it stands; None where that depends on the bus."""
    with open(os.path.join(source, "tests/cli/json_schemas_lines.txt"), encoding="utf-8") as file:
        for line in file:
            line = line.strip().replace("{T}", folder)
            if not line or line.startswith("#"):
                continue
            if not any(place in line for place in ("{B}", "{N}", "{F}")):
                yield line.removeprefix("! "), line.startswith("! ")
                continue
            buses = BUSES if "{B}" in line else BUSES[:-1] if "{N}" in line else {f: (b, f) for b, f in BUSES}.values()
            for bus, family in buses:
                name = re.sub(r"[^a-z0-9]", "-", bus)
                yield re.sub(r"\{[BN]\}", "-b " + bus, line.replace("{B-}", name)).replace("{F}", family), None


def environment(folder):
    env = {key: value for key, value in os.environ.items() if not key.startswith(("SERVOCTL_", "XDG_"))}
    drives = ":".join(os.path.join(source, each) for each in ("eds", "tests/cli/data/drives"))
    return {**env, "LANG": "C.UTF-8", "HOME": folder, "SERVOCTL_DRIVES": drives, "SOURCE_DATE_EPOCH": "1795000000"}


def run(line, folder, env):
    words = [servoctl, *shlex.split(line), "--json"] if "-o jsonl" not in line else [servoctl, *shlex.split(line)]
    batch = None
    if " ;; " in line:
        words = [servoctl, "-", "-o", "jsonl" if "-o jsonl" in line else "json"]
        batch = "on-error continue\n" + line.replace(" ;; ", "\n").replace(" -o jsonl", "") + "\n"
    try:
        done = subprocess.run(words, env=env, cwd=folder, input=batch, capture_output=True, text=True, timeout=120)
    except subprocess.TimeoutExpired:
        return line, ["(it does not end)"]
    return line, done.stdout.split("\n") if done.stdout else [f"(it says nothing: {done.stderr.strip()[:200]})"]


def check_lines(folder, env):
    refused = dict(lines_to_run(folder))
    lines = list(refused)
    alone = [line for line in lines if folder in line]  # They share files.
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        answers = list(pool.map(lambda line: run(line, folder, env), [line for line in lines if line not in alone]))
    answers += [run(line, folder, env) for line in alone]
    for line, out in answers:
        if not any(each.startswith('{"servoctl"') for each in out):
            problems.append(f"{line}: prints no document: {out[0][:200]}")
        if refused[line] is not None and refused[line] != any('"error":{"code":"usage"' in each for each in out):
            problems.append(f"{line}: is {'taken' if refused[line] else 'refused'}: {out[-2][:300]}")
        hold(line.replace(folder + "/", ""), out)
    return len(lines)


def check_cut_off(folder, env):
    """What a restore leaves whose drive fell silent while it was written to, and a plan of addresses whose drive was not
    switched off and on: the journals."""
    def in_lines(bus, family, *lines):
        return subprocess.run([servoctl, "-", "-n", "1", "-d", family, "-b", bus], env=env, cwd=folder, text=True, input="\n".join(lines),
                              capture_output=True, timeout=120)

    in_lines("sim:gsd600@1", "gsd600", "param set Pn0214=45Hz Pn0202=33 Pn0215=900 Pn0203=20 Pn0204=10", "backup cut.json --only changed")
    # Killed when it has begun to write.
    restore = subprocess.Popen([servoctl, "restore", "cut.json", "-y", "-n", "1", "-d", "gsd600", "-b", "sim:gsd600@1?delay=50ms"], env=env,
                               cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not os.path.exists(os.path.join(folder, "cut.json.before-node-1.json.journal")) and restore.poll() is None:
        time.sleep(0.01)
    restore.kill()
    restore.wait()
    # A report with every kind of test in it.
    turn = " --turn 131072 --limit 600rpm"
    for each in (f"all 60rpm --for 1s --tolerance 50 --stop-within 5s --repeat 2{turn}",  # It may end before it comes to its home.
                 f"jog 60rpm --for 1s --tolerance 50 --stop-within 5s{turn}", f"home 35{turn}", "io --for 100ms"):
        tested = run(f"test {each} -n 1 -d gsd600 -y -b sim:gsd600@1", folder, env)[1]
        with open(os.path.join(folder, f"{each.split()[0]}.json"), "w", encoding="utf-8") as out:
            out.write("\n".join(tested))
    run("report tested.json --tests all.json --tests jog.json --tests home.json --tests io.json -n 1 -d gsd600 -b sim:gsd600@1", folder, env)
    with open(os.path.join(folder, "plan.csv"), "w", encoding="utf-8") as out:
        out.write("node,new\n1,5\n")
    in_lines("sim:ts@1", "ts", "address --plan plan.csv -n all --unlock --wait 100ms -y")


def check_files(folder):
    """Every file that was written there: what it is tells its first key."""
    global documents
    met = set()
    # What was killed leaves locks, too.
    files = [each for each in glob.glob(os.path.join(folder, "**/*"), recursive=True) if each.endswith((".json", ".jsonl", ".journal"))]
    for file in sorted(each for each in files if not each.startswith(os.path.join(folder, "tests"))):  # Those were written by hand.
        with open(file, encoding="utf-8") as text:
            document = read(text.read())
        for name, key in FILES.items():
            if next(iter(document)) == key:
                documents += 1
                met.add(name)
                problems.extend(f"{os.path.basename(file)}: {name}: {text}" for text in schemas.errors(name, document))
    problems.extend(f"no {name} was written here" for name in sorted(set(FILES) - met))


def check_until_ended(words, env):
    """A command that goes on until Ctrl-C: its sample when it has begun, its document when it has ended."""
    with subprocess.Popen([servoctl, *words, "-o", "jsonl"], env=env, cwd=env["HOME"], stdout=subprocess.PIPE, text=True) as process:
        out = [process.stdout.readline()]
        process.send_signal(signal.SIGINT)
        out += process.stdout.read().split("\n")
    hold(" ".join(words), out)


def check_coverage():
    """Each form of an answer and each field that is not always there was met."""
    for place in schemas.never_met():
        if not place.startswith(tuple(NOT_HERE)):
            problems.append(f"docs/schema/{place}: no document here is an example of it")
    if os.path.isdir("/sys/module/can_raw"):
        return
    for place in NOT_HERE:
        if not any(each.startswith(place) for each in schemas.never_met()):
            problems.append(f"{place} stands in NOT_HERE, and was met")


def check_of_itself():
    """A key that is missing and one that is unknown are noticed."""
    good = {"servoctl": 1, "command": "store", "ok": True, "bus": None, "notices": [],
            "result": [{"node": 1, "result": "stored", "error": None}]}
    if schemas.errors("envelope", good):
        sys.exit("a good document is refused: the test itself is broken")
    spoilt = [{**good, "more": 1}, {k: v for k, v in good.items() if k != "notices"}, {**good, "ok": False},
              {**good, "result": None}, {**good, "result": [{"node": 1, "result": "stored"}]},
              {**good, "result": [{"node": 1, "result": "stored", "error": None, "more": 1}]},
              {**good, "result": [{"node": "1", "result": "stored", "error": None}]},
              {**good, "error": {"code": "usage", "exit": 2, "message": "", "hint": None}}]
    for document in spoilt:
        if not schemas.errors("envelope", document):
            sys.exit(f"a bad document is taken: {document}")
    try:
        read('{"a":1,"a":2}')
    except ValueError:
        return
    sys.exit("a key that appears twice is taken")


problems += schemas.check()
if problems:
    sys.exit("\n".join(problems))
check_of_itself()
schemas.used.clear()
check_registry()
check_references()
check_golden()
with tempfile.TemporaryDirectory() as home:
    # Some commands leave files where they are run.
    for each in ("tests", "eds"):
        os.symlink(os.path.join(source, each), os.path.join(home, each))
    for title, content in CABINETS.items():
        with open(os.path.join(home, title), "w", encoding="utf-8") as out:
            out.write(content)
    ran = check_lines(home, environment(home))
    check_cut_off(home, environment(home))
    check_files(home)
    check_until_ended(["sim", "gsd600@1", "-b", f"local:json-schemas-{os.getpid()}"], environment(home))
    check_until_ended(["gateway", "--listen", os.path.join(home, "socket"), "-b", "sim:gsd600@1"], environment(home))
check_coverage()
for text in problems[:60]:
    print(text)
if problems:
    sys.exit(f"{len(problems)} problems in {documents} documents; docs/schema/ is the contract: docs/json.md shows it")
print(f"{documents} documents of the golden cases and of {ran} lines are as docs/schema/ says")
