"""What the tests of the program on terminals and pipes have in common."""
import errno
import json
import os
import pty
import select
import subprocess
import sys
import time

failures = 0


def check(what, condition):
    global failures
    if not condition:
        failures += 1
        print("FAILED", what)


def machine_of(program):
    with open(program, "rb") as file:
        return file.read(20)[18:]  # e_machine of ELF.


def needs_serial_lines(servoctl):
    """Skips the test where qemu runs the program and does not know how serial lines are set (TCGETS2)."""
    if machine_of(servoctl) == machine_of(sys.executable):
        return
    ends = pty.openpty()
    line = ["scan", "-n", "1", "--timeout", "20ms", "-b", f"slcan:{os.ttyname(ends[1])}@500k"]
    said = subprocess.run([servoctl, *line], capture_output=True, text=True).stderr
    if os.strerror(errno.ENOSYS) in said:
        print("skipped: qemu runs the program, and has no serial lines")
        sys.exit(77)


def obeying(*families):
    """What simulated drives of these families need to obey 6040h: as delivered, some select another source of commands."""
    panel = {"da200": "P0.03=7", "ts": "Fn_00=20"}
    needed = [panel[family] for family in dict.fromkeys(families) if family in panel]
    return "?panel=" + ",".join(needed) if needed else ""


def status(servoctl, env):
    """What `status` says of the drive; None while nobody answers."""
    answer = subprocess.run([servoctl, "status", "--json"], env=env, capture_output=True)
    return json.loads(answer.stdout)["result"][0] if answer.returncode == 0 else None


def asked(words, env, answer, meanwhile=lambda: None, typed_before=b"", folder=None):
    """What a line says at a terminal, and its exit code: its question is answered behind what happens meanwhile."""
    process, terminal = pty.fork()
    if process == 0:
        if folder:
            os.chdir(folder)
        os.execvpe(words[0], words, env)
    out, answered = b"", False
    if typed_before:
        os.write(terminal, typed_before)
    end = time.monotonic() + 60
    while time.monotonic() < end:
        if select.select([terminal], [], [], 0.1)[0]:
            try:
                data = os.read(terminal, 4096)
            except OSError:
                break
            if not data:
                break
            out += data
        if not answered and b"[y/N]" in out:
            answered = True
            meanwhile()
            os.write(terminal, answer)
    return out.decode(errors="replace"), os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])


def finish():
    print("failures:", failures)
    sys.exit(1 if failures else 0)
