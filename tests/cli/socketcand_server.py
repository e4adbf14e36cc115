"""A server of the socketcand protocol, written from its doc/protocol.md: what one client sends, the others receive."""
import socket
import threading
import time


class Server:
    """Raw mode of one interface, vcan0. Like socketcand it ends the connection when it reads half an element."""

    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.clients = []
        self.halves = 0
        self.bus = threading.Lock()  # A bus has one order for all: without it an answer could come before its question.
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        client.sendall(b"< hi >")
        try:
            while data := client.recv(8290):
                if not data.endswith(b">"):
                    self.halves += 1
                    break
                for element in data.decode().split(">")[:-1]:
                    if not self.answer(client, element.lstrip("< ").split()):
                        return
        except OSError:
            pass
        finally:
            if client in self.clients:
                self.clients.remove(client)
            client.close()

    def answer(self, client, words):
        if words[0] == "open":
            client.sendall(b"< ok >" if words[1] == "vcan0" else b"< error could not open bus >")
            return words[1] == "vcan0"
        if words[0] == "rawmode":
            self.clients.append(client)
            client.sendall(b"< ok >")
        elif words[0] == "echo":
            client.sendall(b"< echo >")
        elif words[0] == "send":
            data = "".join(f"{int(word, 16):02X}" for word in words[3:])
            frame = f"< frame {words[1]} {time.time():.6f} {data} >".encode()
            with self.bus:
                self.forward(client, frame)
        return True

    def forward(self, sender, frame):
        for other in list(self.clients):
            if other is sender:
                continue
            try:
                other.sendall(frame)
            except OSError:
                pass  # It is gone; its own thread finds out.
