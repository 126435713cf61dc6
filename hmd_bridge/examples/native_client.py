#!/usr/bin/env python3
"""native_client.py ADDRESS [TOKEN]: a client of hmd.v1 in plain Python, written from PROTOCOL.md.

Shows the whole map, adds a box of 0.2 m over the first occupied voxel, waits until it sees it, and takes it back.
Prints what it saw as JSON. ADDRESS is http://127.0.0.1:8443/, or https://... with TOKEN from another machine.
"""
import base64, json, os, socket, ssl, struct, sys, urllib.parse, urllib.request, zlib


class WebSocket:
    """RFC 6455, as much as a client needs: whole messages, masked, pings answered."""

    def __init__(self, address):
        url = urllib.parse.urlsplit(address)
        self.socket = socket.create_connection((url.hostname, url.port), timeout=20)
        if url.scheme == "https":
            context = ssl.create_default_context(cafile=os.environ.get("CONCORD_CERT"))
            self.socket = context.wrap_socket(self.socket, server_hostname=url.hostname)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET /ws HTTP/1.1\r\nHost: {url.netloc}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                             f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
                             "Sec-WebSocket-Protocol: hmd.v1\r\n\r\n").encode())
        self.buffer = b""
        while b"\r\n\r\n" not in self.buffer:
            self.buffer += self.receive()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        if b" 101 " not in head.split(b"\r\n")[0]:
            sys.exit("refused: " + head.decode())

    def receive(self):
        data = self.socket.recv(65536)
        if not data:
            sys.exit("the bridge closed the connection")
        return data

    def take(self, count):
        while len(self.buffer) < count:
            self.buffer += self.receive()
        out, self.buffer = self.buffer[:count], self.buffer[count:]
        return out

    def send(self, payload, opcode=1):
        mask = os.urandom(4)
        length = len(payload)
        size = bytes([128 | length]) if length < 126 else struct.pack("!BH", 128 | 126, length)
        masked = bytes(byte ^ mask[i % 4] for i, byte in enumerate(payload))
        self.socket.sendall(bytes([128 | opcode]) + size + mask + masked)

    def read(self):
        """The next message: text as str, a frame as bytes."""
        while True:
            first, second = self.take(2)
            length = second & 127
            if length == 126:
                length = struct.unpack("!H", self.take(2))[0]
            elif length == 127:
                length = struct.unpack("!Q", self.take(8))[0]
            payload, opcode = self.take(length), first & 15
            if opcode == 9:
                self.send(payload, 10)
            elif opcode == 8:
                sys.exit("the bridge said bye: " + payload[2:].decode())
            elif opcode in (1, 2):
                return payload.decode() if opcode == 1 else payload


class Client:
    def __init__(self, address, token):
        ticket = {}
        if token:
            request = urllib.request.Request(address + "api/ticket", method="POST", headers={"Authorization": "Bearer " + token})
            context = ssl.create_default_context(cafile=os.environ.get("CONCORD_CERT"))
            with urllib.request.urlopen(request, context=context) as answer:
                ticket = {"ticket": json.load(answer)["ticket"]}
        self.socket, self.id, self.taken = WebSocket(address), 0, 0
        self.complete = {"synced": False, "revision": 0}
        self.chunks = {}  # (block x, y, z, number) -> 512 bytes
        self.hello = self.ask("hello", {"version": "hmd.v1", "name": "native", "device": "Python", **ticket})
        self.grant()

    def notice(self, name, body):
        self.socket.send(json.dumps({"notice": name, "body": body}).encode())

    def grant(self):
        self.notice("credit", {"bytes": self.taken + 4_000_000})

    def ask(self, request, body):
        self.id += 1
        self.socket.send(json.dumps({"id": self.id, "request": request, "body": body}).encode())
        while True:
            message = self.next()
            if message.get("id") == self.id:
                if "error" in message:
                    sys.exit(f"{request}: {message['error']}")
                return message["answer"]

    def wait_complete(self, least):
        """Until everything that is in view has come, as of the bridge's revision `least` or later."""
        while not (self.complete["synced"] and self.complete["revision"] >= least):
            self.next()
        return self.complete["revision"]

    def next(self):
        message = self.socket.read()
        if isinstance(message, str):
            message = json.loads(message)
            if message.get("event") == "complete":  # it may come before the answer to what it follows from
                self.complete = message["body"]
            return message
        self.take_frame(message)
        self.taken += len(message)
        self.grant()
        return {}

    def take_frame(self, frame):
        kind, flags, level, _, stream, count, size, revision = struct.unpack_from("<4B3IQ", frame)
        payload = zlib.decompress(frame[24:], -15) if flags & 1 else frame[24:]
        if kind != 1 or level != 0:
            return
        x, y, z, told, filled = struct.unpack_from("<3i2Q", payload)
        if flags & 2:
            told = 2 ** 64 - 1
        at = 28
        for number in range(64):
            if told >> number & 1:
                self.chunks.pop((x, y, z, number), None)
            if filled >> number & 1:
                self.chunks[x, y, z, number] = payload[at:at + 512]
                at += 512

    def voxels(self):
        return sum(int.from_bytes(bits, "little").bit_count() for bits in self.chunks.values())

    def first(self):
        (x, y, z, number), bits = min(self.chunks.items())
        cell = next(i for i in range(4096) if bits[i // 8] >> i % 8 & 1)
        return [64 * x + number % 4 * 16 + cell % 16, 64 * y + number // 4 % 4 * 16 + cell // 16 % 16,
                64 * z + number // 16 * 16 + cell // 256]


def main():
    client = Client(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else None)
    client.ask("view", {"layer": "map", "frame": "map", "centre": [0, 0, 0], "radii": [1000]})
    revision, before = client.wait_complete(0), client.voxels()
    resolution = client.hello["resolution"]
    x, y, z = client.first()
    low = [x, y, z - 40]  # below everything: nothing stands there yet
    box = [*low, low[0] + 1, low[1] + 1, low[2] + 1]
    shape = {"kind": "voxels", "resolution": resolution, "boxes": [box]}
    edit = client.ask("edit", {"op": "add", "frame": "map", "shape": shape})
    revision = client.wait_complete(revision + 1)
    added = client.voxels()
    client.ask("undo", {"edit": edit["edit"]})
    client.wait_complete(revision + 1)
    print(json.dumps({"before": before, "added": added, "after": client.voxels(), "bytes": client.taken}))


main()
