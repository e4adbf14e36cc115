"""Adapters of the LAWICEL protocol behind pseudo-terminals, written from the CAN232 manual: what one is told to send, the
others on its wire receive. They can be as bad as real ones: late, split, lossy, silent, still open from the last program."""
import os
import pty
import random
import select
import threading
import time
import tty

BITRATES = {"0": 10, "1": 20, "2": 50, "3": 100, "4": 125, "5": 250, "6": 500, "7": 800, "8": 1000}


class Wire:
    """What joins adapters of one bitrate."""

    def __init__(self):
        self.adapters = []

    def carry(self, sender, line):
        for adapter in self.adapters:
            if adapter is not sender and adapter.is_open and adapter.bitrate == sender.bitrate:
                adapter.say(line)

    def close(self):
        for adapter in self.adapters:
            adapter.unplug()


class Adapter(threading.Thread):
    """`end` ends its lines; `delay` is the time before each answer; `piece` cuts what it says into so many bytes; `loss` is
    the share of bytes that are lost on the way to the computer; `silent` firmware acknowledges nothing."""

    def __init__(self, wire, end="\r", delay=0.0, piece=0, loss=0.0, silent=False, version="V1013", stamps=False, flags="F00",
                 refuses="", seed=1):
        super().__init__(daemon=True)
        self.wire, self.end, self.delay, self.piece, self.loss = wire, end, delay, piece, loss
        self.silent, self.version, self.stamps, self.flags, self.refuses = silent, version, stamps, flags, refuses
        self.random = random.Random(seed)
        self.is_open, self.listens_only, self.bitrate = False, False, None
        self.heard = []
        self.lock = threading.Lock()
        self.master, slave = pty.openpty()
        tty.setraw(slave)
        self.slave = slave  # Held, so that the port stays when a program closes it.
        self.path = os.ttyname(slave)
        self.gone = False
        wire.adapters.append(self)
        self.start()

    def unplug(self):
        with self.lock:
            if self.gone:
                return
            self.gone = True
        self.join()  # Else it would read from whatever has the number of its descriptor next.
        os.close(self.slave)
        os.close(self.master)

    def write(self, text):
        data = bytes(byte for byte in text.encode() if self.random.random() >= self.loss)
        pieces = [data[at:at + self.piece] for at in range(0, len(data), self.piece)] if self.piece else [data]
        with self.lock:
            for piece in pieces:
                if self.gone:
                    return
                try:
                    os.write(self.master, piece)
                except OSError:
                    return
                if self.piece:
                    time.sleep(0.0005)

    def say(self, line):
        if self.stamps:
            line += f"{int(time.monotonic() * 1000) % 60000:04X}"
        self.write(line + self.end)

    def answer(self, text):
        if self.silent:
            return
        if self.delay:
            time.sleep(self.delay)
        self.write(text)

    def run(self):
        pending = b""
        while not self.gone:
            try:
                if not select.select([self.master], [], [], 0.05)[0]:
                    continue
                pending += os.read(self.master, 4096)
            except (OSError, ValueError):
                return
            while b"\r" in pending:
                line, pending = pending.split(b"\r", 1)
                self.on_line(line.decode("ascii", "replace"))

    def on_line(self, line):
        self.heard.append(line)
        word, rest = line[:1], line[1:]
        if word and word in self.refuses:
            return self.answer("\a")
        if word == "V":
            if self.delay:
                time.sleep(self.delay)
            self.write(self.version + self.end)
        elif word == "C":
            was, self.is_open = self.is_open, False
            self.answer(self.end if was else "\a")
        elif word == "S" and not self.is_open and rest in BITRATES:
            self.bitrate = BITRATES[rest]
            self.answer(self.end)
        elif word in "OL" and word and not self.is_open and self.bitrate:
            self.is_open, self.listens_only = True, word == "L"
            self.answer(self.end)
        elif word == "F" and self.is_open:
            self.answer(self.flags + self.end)
        elif word in "tTrR" and word and self.is_open and not self.listens_only and self.is_whole(line):
            self.wire.carry(self, line)
            self.answer(("z" if word in "tr" else "Z") + self.end)
        else:
            self.answer("\a")

    @staticmethod
    def is_whole(line):
        digits = 3 if line[0] in "tr" else 8
        if len(line) < digits + 2 or not line[1 + digits].isdigit():
            return False
        data = 2 * int(line[1 + digits]) if line[0] in "tT" else 0
        return len(line) == digits + 2 + data
