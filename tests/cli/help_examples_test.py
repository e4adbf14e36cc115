#!/usr/bin/env python3
"""Every example that `help COMMAND` shows, run as it stands there on simulated drives; and that every command and every word of
the prompt has one to three of them.

usage: help_examples_test.py SERVOCTL SOURCE_DIR
"""
import concurrent.futures
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile

from checks import obeying

servoctl, source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
WIDEST = 76  # Columns of a line; two more stand before it.

# What needs a CAN interface of the kernel: only read by `run --check`, not run.
KERNEL = ("bus status", "bus up", "bus down", "bus detect", "doctor can0")
# What goes on until Ctrl-C and has no --for: ended when it has said something.
UNTIL_ENDED = ("state safeop", "state op", "sim", "gateway")
# Lines with a negative answer here, which is exit code 1, and why.
NEGATIVE = {
    "cabinet diff cabinet.toml backup": "a value differs",
    "cabinet plan": "there is something to do",
    "test io": "nobody actuates an input",
}
# What holds times against limits, which a busy machine may spoil: run behind the others, tried three times, and a verdict that
# fails for these alone will do.
TIMED = ("test comm", "test jog", "test home", "test all", "units learn", "units forget", "report")
OF_THE_MACHINE = r"((forward|backward): )?(longest round trip|最长往返时间|speed deviation|time to standstill): "
# Other buses than that of the family in the line; the first beginning counts.
BUSES = {
    "address 5": "sim:gsd600@1",
    "eds verify": "sim:sv2@1",
    "eds learn": "sim:sv2@1",
    "cabinet init -b can0 --family": "sim:gsd600@1,da200@2",
    "lss scan --vendor": "sim:sv2@3,sv2@4?lss",
    "lss scan": "sim:sv2@255,da200@255,gsd600@1?lss",
    "lss store -n 5": "sim:sv2@5?lss",
    "lss": "sim:sv2@3?lss",
    "home 17": "sim:sv2@1?panel=PA-20=0,PA-74=1",
    "test home 17": "sim:sv2@1?panel=PA-20=0,PA-74=1",
}
# Lines that are run before, on the same bus.
BEFORE = {
    "nmt start -n 1 --wait": ["heartbeat set 100ms -n 1 -d gsd600"],
    "nmt preop -n 1 --wait": ["heartbeat set 100ms -n 1 -d gsd600"],
    "nmt watch -n 1,2": ["heartbeat set 100ms -n 1,2 -d gsd600"],
    "nmt watch -n 1 --for": ["heartbeat set 100ms -n 1 -d gsd600"],
    "pdo watch": ["nmt start -n 1 --yes"],
    "pdo send": ["nmt start -n 1 --yes"],
    "undo": ["param set Pn0214 45Hz -n 1 -d gsd600"],
    "test home --limit": ["param set Pn0603=0 -n 1 -d gsd600", "store -n 1 -d gsd600", "nmt reset -n 1 --wait"],
    "test all 60rpm -n 1 -d gsd600": ["param set Pn0603=0 -n 1 -d gsd600", "store -n 1 -d gsd600", "nmt reset -n 1 --wait"],
    "units forget": ["units learn -n 1 -d gsd600 --yes"],
    "sync stop": ["sync start --period 10ms --yes"],
}
# The words of the prompt: lines of a pipe.
PROMPT = {"use", "drive", "bus", "undo", "log", "exit"}
# Lines that find bus and family in cabinet.toml.
OF_CABINET = ("cabinet show", "cabinet plan", "cabinet apply", "cabinet backup", "cabinet swap", "move lift", "use feeder")
# What is shown until Ctrl-C unless --for is given.
WATCHING = ("watch", "nmt watch", "pdo watch", "monitor", "sync start", "cabinet show feeder,lift --watch")
AXES = '[axis.feeder]\nbus = "main"\nnode = 3\nfamily = "{0}"\n[axis.lift]\nbus = "main"\nnode = 2\nfamily = "{0}"\n{1}'
GAIN = '[axis.lift.parameters]\nPn0214 = "45Hz"\n'
LOAD = 'per_turn = "5 mm"\n'
FILES = {
    "cabinet.toml": '[bus.main]\nurl = "sim:gsd600@2,gsd600@3"\n' + AXES.format("gsd600", GAIN),
    "from.toml": '[bus.main]\nurl = "sim:gsd600@1,gsd600@3"\n' + AXES.format("gsd600", GAIN),
    "load.toml": '[bus.main]\nurl = "sim:sv2@2,sv2@3"\n' + AXES.format("sv2", LOAD),
    "monday.toml": '[bus.main]\nurl = "sim:gsd600@2,gsd600@3"\n' + AXES.format("gsd600", GAIN),
    "cell/cabinet.toml": '[bus.main]\nurl = "can0"\n' + AXES.format("gsd600", GAIN),
    "drives/mine.toml": 'format = 1\nfamily = "mine"\nparent = "gsd600"\n',
    "params.csv": "No.,Name,Index,Sub\nP1,Position loop gain 1,2001h,3\n",
    "faults.csv": "code,name\n2310h,Overcurrent\n",
    "nodes.csv": "node,new\n1,11\n2,12\n",
    "setup.servoctl": "set NODE=1\ndrive gsd600\nuse ${NODE}\nparam set Pn0214 45Hz\nread 0x6041\n",
}
# Cabinet files other than cabinet.toml.
CABINETS = {
    "cabinet swap lift --from": "from.toml",
    "move lift": "load.toml",
}
COPIES = {
    "gripper.eds": "eds/vmmore/gsd600.eds",
    "drive.eds": "eds/sinsegye/sv2.eds",
    "device.xml": "tests/cli/data/pair.xml",
    "trace.trc": "tests/cli/data/talk.trc",
}
# What makes the other files.
MADE = (
    "backup good.json -n 1 -d gsd600 -b sim:gsd600@1",
    "pdo save pdos.toml -n 1 -d gsd600 -b sim:gsd600@1",
    "read 0x6041 -n 1 -b sim:gsd600@1 --trace session.log",
    "cabinet backup",
)


def helped(words, env):
    done = subprocess.run([servoctl, "help", *words], env={**env, "COLUMNS": "80"}, capture_output=True, text=True, check=True)
    return done.stdout


def rows(title, text):
    """The names of a list in the help."""
    block = text.split(title + ":\n")[1].split("\n\n")[0]
    return [re.match(r"  (\S+(?: \S+)*?) {2,}", line).group(1) for line in block.splitlines() if re.match(r"  \S", line)]


def examples_of(text):
    """Lines, and what stands under each."""
    if "\nExamples:\n" not in text:
        return []
    block = text.split("\nExamples:\n")[1].split("\n\n")[0]
    return re.findall(r"^  (\S.*)\n((?:      .*\n?)+)", block + "\n", flags=re.M)


def fits(line, beginnings):
    return any(line == each or line.startswith(each + " ") for each in beginnings)


def on_simulated_drives(line, folder):
    """The line with what stands for its bus here, and no longer than it has to be."""
    family = re.search(r" -d (gsd600|dm|da200|ts|sv2)\b", line)
    family = family.group(1) if family else "gsd600"
    drives = ",".join(f"{family}@{node}" for node in range(1, 6))
    bus = next((url for begin, url in BUSES.items() if line.startswith(begin)), f"sim:{drives}{obeying(family)}")
    line = re.sub(r"(-b|^bus) can0\b", rf"\1 {bus}", line)
    line = re.sub(r"coe:eth0\b", "coe:sim:sv2@1,sv2@2", line)
    line = re.sub(r"modbus:/dev/\S+", "modbus:sim:ts@5", line)
    line = re.sub(r"\b(local:\w+)", rf"\1-{os.getpid()}-{abs(hash(folder))}", line)
    line = line.replace("/run/gateway", folder + "/gateway")
    if line.startswith("gateway") and "--listen" not in line:
        line += f" --listen {folder}/socket"
    if line.startswith("test comm"):  # How long an answer takes is a matter of this machine.
        line = re.sub(r" --longest \S+", "", line) + " --longest 10s"
    line = re.sub(r"--for (\d+min|[3-9]s|\d\ds)\b", "--for 1s", line)
    return line, bus


def clean_environment(folder):
    env = {k: v for k, v in os.environ.items() if not k.startswith(("SERVOCTL_", "XDG_"))}
    env.update(LANG="C.UTF-8", HOME=folder, SERVOCTL_DRIVES=os.path.join(source, "eds"), SOURCE_DATE_EPOCH="1795376400")
    return env


def make_files(folder):
    """The files that the lines name."""
    for title, content in FILES.items():
        os.makedirs(os.path.dirname(os.path.join(folder, title)), exist_ok=True)
        with open(os.path.join(folder, title), "w", encoding="utf-8") as out:
            out.write(content)
    for title, origin in COPIES.items():
        shutil.copy(os.path.join(source, origin), os.path.join(folder, title))
    env = clean_environment(folder)
    for line in MADE:
        subprocess.run([servoctl, *shlex.split(line)], env=env, cwd=folder, capture_output=True, text=True, check=True)
    line = "test comm --count 5 --longest 10s -n 1 -d gsd600 -b sim:gsd600@1 --json"
    with open(os.path.join(folder, "test.json"), "w", encoding="utf-8") as out:
        subprocess.run([servoctl, *shlex.split(line)], env=env, stdout=out, stderr=subprocess.DEVNULL, check=True)


def only_slow(said):
    """Whether the verdict failed, and for nothing but times of this machine."""
    failures = re.findall(r"^error: .*?\bfailed: (.*)$", said, flags=re.M)
    return bool(failures) and all(re.match(OF_THE_MACHINE, each) for line in failures for each in line.split(". "))


class Case:
    """A line of an example in a folder of its own."""

    def __init__(self, name, line, options):
        self.name, self.line, self.options = name, line, options

    def environment(self, folder, bus):
        env = clean_environment(folder)
        if not fits(self.line, OF_CABINET) and " -b " not in self.line:
            env["SERVOCTL_BUS"] = bus
        for begin, file in CABINETS.items():
            if self.line.startswith(begin):
                env["SERVOCTL_CABINET"] = os.path.join(folder, file)
        return env

    def run(self):
        """What is wrong with it; empty: nothing."""
        wrong = ""
        for _ in range(3 if fits(self.line, TIMED) else 1):
            with tempfile.TemporaryDirectory() as above:
                folder = os.path.join(above, "home")
                shutil.copytree(template, folder)
                wrong = self.run_in(folder)
            if not wrong:
                break
        return wrong

    def run_in(self, folder):
        line, bus = on_simulated_drives(self.line, folder)
        env = self.environment(folder, bus)
        if fits(self.line, KERNEL):
            return self.read_only(folder, env)
        if fits(self.line, UNTIL_ENDED):
            return self.until_ended(line, folder, env)
        if fits(self.line, ["cabinet init -b can0"]):
            os.remove(os.path.join(folder, "cabinet.toml"))
        if "--for" in self.options and "--for" not in line and fits(self.line, WATCHING):
            line += " --for 300ms"
        words, batch = [servoctl, *shlex.split(line), "--yes"], None
        before = next((lines for begin, lines in BEFORE.items() if self.line.startswith(begin)), [])
        if before or self.name in PROMPT:
            words = [servoctl, "--yes"] if self.name in PROMPT else [servoctl, "-", "--yes"]
            batch = "\n".join([*before, line, ""])
        try:
            done = subprocess.run(words, env=env, cwd=folder, input=batch, capture_output=True, text=True, timeout=120)
        except subprocess.TimeoutExpired:
            return "does not end"
        expected = 1 if any(self.line.startswith(each) for each in NEGATIVE) else 0
        if done.returncode == expected or (done.returncode == 1 and fits(self.line, TIMED) and only_slow(done.stderr)):
            return ""
        return f"exit code {done.returncode}, not {expected}\n    ran {line} on {bus}\n" + (done.stdout + done.stderr)[-1500:]

    def read_only(self, folder, env):
        with open(os.path.join(folder, "line"), "w", encoding="utf-8") as out:
            out.write(self.line + "\n")
        done = subprocess.run([servoctl, "run", "--check", "line"], env=env, cwd=folder, capture_output=True, text=True)
        return "" if done.returncode == 0 else f"is not accepted: {done.stderr}"

    @staticmethod
    def until_ended(line, folder, env):
        words = [servoctl, *shlex.split(line), "--yes"]
        with subprocess.Popen(words, env=env, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
            said = process.stdout.readline()
            process.send_signal(signal.SIGINT)
            said += process.stdout.read()
        return "" if process.returncode in (0, 130) and "error" not in said else f"exit code {process.returncode}: {said}"


def shape_of(name, examples):
    """What is wrong with how the examples of a command are written."""
    if not 1 <= len(examples) <= 3:
        yield f"{name}: has {len(examples)} examples, not one to three"
    for line, what in examples:
        if not fits(line, [name]):
            yield f"{name}: an example is of another command: {line}"
        if len(line) > WIDEST:
            yield f"{name}: {len(line)} columns, more than {WIDEST}: {line}"
        if what.strip().endswith("."):
            yield f"{name}: ends with a full stop: {what.strip()}"


def main():
    env = {k: v for k, v in os.environ.items() if not k.startswith(("SERVOCTL_", "XDG_"))}
    listing = subprocess.run([servoctl, "help"], env=env, capture_output=True, text=True, check=True).stdout
    words = [each.split()[0] for each in rows("At the prompt also", listing)]
    names = rows("Commands", listing) + words
    if len(names) < 100 or set(words) != PROMPT:
        sys.exit(f"{len(names)} commands, and {words} are in the help: the test itself is broken")
    problems, cases = [], []
    for name in names:
        text = helped(name.split(), env)
        examples = examples_of(text)
        problems += shape_of(name, examples)
        cases += [Case(name, line, text) for line, _ in examples]
    for table in (KERNEL, UNTIL_ENDED, NEGATIVE, TIMED, BUSES, BEFORE, OF_CABINET, CABINETS, WATCHING):
        for begin in table:
            if not any(case.line.startswith(begin) for case in cases):
                problems.append(f"'{begin}' stands in a table of this test, and no example begins so")
    make_files(template)
    for timed in (False, True):
        some = [case for case in cases if fits(case.line, TIMED) == timed]
        with concurrent.futures.ThreadPoolExecutor(2 if timed else 6) as pool:
            for case, wrong in zip(some, pool.map(Case.run, some)):
                if wrong:
                    problems.append(f"{case.name}: {case.line}: {wrong}")
    if problems:
        sys.exit("\n".join(problems) + f"\n{len(problems)} problems in {len(cases)} examples")
    kernel = sum(fits(case.line, KERNEL) for case in cases)
    print(f"{len(cases)} examples of {len(names)} commands and words; {kernel} of them want a CAN interface of the kernel and were only read")


with tempfile.TemporaryDirectory() as template:
    main()
