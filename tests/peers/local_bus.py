"""A member of the bus `local:NAME` that shares no code with servoctl: Unix datagrams, one file a member (src/can/local.hpp)."""
import fcntl
import itertools
import os
import select
import socket
import struct

numbers = itertools.count(1)
EXTENDED, REMOTE, ERROR = 1, 2, 4


class LocalBus:
    def __init__(self, name):
        own = os.path.join(os.environ["XDG_RUNTIME_DIR"], "servoctl")
        self.folder = os.path.join(own, f"bus-{name}")
        for folder in (own, self.folder):
            if not os.path.isdir(folder):
                os.mkdir(folder, 0o700)
        self.lock = os.open(os.path.join(self.folder, "lock"), os.O_RDWR | os.O_CREAT, 0o600)
        self.name = f"member-{os.getpid()}-{1000 + next(numbers)}"
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.setblocking(False)
        self.socket.bind(os.path.join(self.folder, self.name))

    def close(self):
        os.unlink(os.path.join(self.folder, self.name))
        self.socket.close()

    def send(self, identifier, data, flags=0):
        """Hands the frame to every other member, in the order that the lock gives; waits for one whose queue is full."""
        datagram = struct.pack("<4sBBHI8s", b"SVC\x01", flags, len(data), 0, identifier, bytes(data))
        fcntl.flock(self.lock, fcntl.LOCK_EX)
        try:
            for member in os.listdir(self.folder):
                if member.startswith("member-") and member != self.name:
                    self.deliver(datagram, os.path.join(self.folder, member))
        finally:
            fcntl.flock(self.lock, fcntl.LOCK_UN)

    def deliver(self, datagram, path):
        for _ in range(1000):
            try:
                self.socket.sendto(datagram, path)
                return
            except BlockingIOError:
                select.select([], [], [], 0.0005)
            except OSError:  # It has left.
                return

    def receive(self, timeout):
        """The next frame as (identifier, data, flags); None when the time is over."""
        if not select.select([self.socket], [], [], timeout)[0]:
            return None
        _, flags, size, _, identifier, data = struct.unpack("<4sBBHI8s", self.socket.recv(20))
        return identifier, data[:size], flags
