"""The program on a pseudo-terminal, as a person has it before them."""
import fcntl
import os
import pty
import re
import select
import signal
import struct
import termios
import time

failures = []


class Terminal:
    def __init__(self, servoctl, *arguments, state, lang="C.UTF-8", size=(0, 0), term="xterm"):
        self.text = ""
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            env = dict(os.environ, TERM=term, XDG_STATE_HOME=state, LANG=lang, COLUMNS="80", LINES="24")
            for name in ("SERVOCTL_BUS", "SERVOCTL_NODE", "SERVOCTL_DRIVE", "LC_ALL", "LC_CTYPE"):
                env.pop(name, None)
            fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", *size, 0, 0))
            os.execve(servoctl, [servoctl, *arguments], env)

    def type(self, text):
        os.write(self.fd, text.encode())

    def see(self, pattern, seconds=20, colours=False):
        """Waits until the screen text shows the pattern; forgets everything up to its end."""
        end = time.monotonic() + seconds
        while True:
            marks = r"\x1b\[[0-9;?]*[A-Zln-z]" if colours else r"\x1b\[[0-9;?]*[A-Za-z]|\x1b[=>]"
            plain = re.sub(marks, "", self.text)
            found = re.search(pattern, plain)
            if found:
                self.text = plain[found.end():]
                return
            if time.monotonic() > end or not self.read(end - time.monotonic()):
                failures.append(f"did not see {pattern!r} in {plain[-400:]!r}")
                return

    def read(self, seconds):
        ready, _, _ = select.select([self.fd], [], [], max(0, seconds))
        if not ready:
            return True
        try:
            data = os.read(self.fd, 4096)
        except OSError:
            return False
        self.text += data.decode(errors="replace")
        return bool(data)

    def exit_code(self):
        end = time.monotonic() + 10
        while time.monotonic() < end:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                return os.waitstatus_to_exitcode(status)
            self.read(0.05)
        os.kill(self.pid, signal.SIGKILL)
        failures.append("the program did not end")
        return None


def expect(name, expected, actual):
    if expected != actual:
        failures.append(f"{name}: expected {expected!r}, got {actual!r}")
