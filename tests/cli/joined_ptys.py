"""Two pseudo-terminals that are joined: a serial line with two ends."""
import os
import pty
import select
import threading
import tty


class JoinedPtys:
    """`ends` are the names of both ends. `echo`: the first end gets back what it sends, as from some adapters."""

    def __init__(self, echo=False):
        self.masters, self.slaves, self.ends = [], [], []
        for _ in range(2):
            master, slave = pty.openpty()
            tty.setraw(slave)
            self.masters.append(master)
            self.slaves.append(slave)
            self.ends.append(os.ttyname(slave))
        self.echo = echo
        self.stop = os.pipe()
        self.thread = threading.Thread(target=self.carry, daemon=True)
        self.thread.start()

    def carry(self):
        first, second = self.masters
        while True:
            ready, _, _ = select.select([first, second, self.stop[0]], [], [])
            if self.stop[0] in ready:
                return
            for end in ready:
                try:
                    data = os.read(end, 512)
                except OSError:
                    continue
                os.write(second if end == first else first, data)
                if self.echo and end == first:
                    os.write(first, data)

    def close(self):
        os.write(self.stop[1], b"x")
        self.thread.join()
        for fd in self.masters + self.slaves + list(self.stop):
            os.close(fd)
