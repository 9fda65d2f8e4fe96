# SPDX-License-Identifier: Apache-2.0
"""WebSocket clients that are polite or rude, and the protocol's messages as bytes."""

import base64
import os
import pathlib
import socket
import struct

from harness import DEADLINE_S

VECTORS = pathlib.Path(__file__).resolve().parents[2] / "protocol" / "vectors" / "v1"
CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG = 0, 1, 2, 8, 9, 10


class WebSocket:
    """Just enough of RFC 6455 to be polite or rude. `status` is that of the upgrade's answer, `answer` its body."""

    def __init__(self, port, subprotocol="limn.1", headers=(), line=None):
        self.line = line or socket.create_connection(("127.0.0.1", port), timeout=DEADLINE_S)
        lines = ["GET / HTTP/1.1", "Host: localhost:%d" % port, "Upgrade: websocket", "Connection: Upgrade",
                 "Sec-WebSocket-Key: " + base64.b64encode(os.urandom(16)).decode(), "Sec-WebSocket-Version: 13"]
        if subprotocol:
            lines.append("Sec-WebSocket-Protocol: " + subprotocol)
        self.line.sendall(("\r\n".join([*lines, *headers]) + "\r\n\r\n").encode())
        head = b""
        while b"\r\n\r\n" not in head:
            try:
                data = self.line.recv(4096)
            except ConnectionResetError:
                data = b""
            if not data:
                break
            head += data
        head, _, self.rest = head.partition(b"\r\n\r\n")
        self.status = int(head.split()[1]) if head else None
        self.headers = head.decode("latin-1").lower()
        self.answer = ""
        if self.status != 101:
            self.answer = self._rest_of_the_line().decode()

    def send(self, payload, opcode=BINARY, final=True):
        mask = b"\x01\x02\x03\x04"
        size = len(payload)
        length = bytes([0x80 | size]) if size < 126 else bytes([0x80 | 126]) + struct.pack(">H", size) \
            if size < 65536 else bytes([0x80 | 127]) + struct.pack(">Q", size)
        masked = bytes(b ^ mask[i % 4] for i, b in enumerate(payload))
        self.line.sendall(bytes([(0x80 if final else 0) | opcode]) + length + mask + masked)

    def _take(self, count):
        while len(self.rest) < count:
            data = self.line.recv(65536)
            if not data:
                raise EOFError
            self.rest += data
        taken, self.rest = self.rest[:count], self.rest[count:]
        return taken

    def receive(self):
        """(opcode, payload); (None, b"") when the line is closed without a word."""
        try:
            first, second = self._take(2)
            size = second & 0x7F
            if size == 126:
                size, = struct.unpack(">H", self._take(2))
            elif size == 127:
                size, = struct.unpack(">Q", self._take(8))
            return first & 0x0F, self._take(size)
        except (EOFError, ConnectionResetError):
            return None, b""

    def _rest_of_the_line(self):
        try:
            while data := self.line.recv(65536):
                self.rest += data
        except (ConnectionResetError, TimeoutError):
            pass
        return self.rest

    def ending(self):
        """Reads to the end; code and reason of the close frame, or (None, "")."""
        while True:
            opcode, payload = self.receive()
            if opcode == CLOSE:
                return (struct.unpack(">H", payload[:2])[0], payload[2:].decode()) if payload else (1005, "")
            if opcode is None:
                return None, ""

    def close_code(self):
        return self.ending()[0]


def vector(name):
    """A message of the protocol's frozen vectors."""
    return (VECTORS / (name + ".bin")).read_bytes()


def hello():
    return vector("hello")


def open_dragon():
    """Opens the model "dragon" on channel 3, from nothing."""
    message = bytearray(vector("open"))
    message[0x2f] = 0  # resume
    return bytes(message)


def pose(number):
    """A pose of channel 3, with room for every split."""
    message = bytearray(vector("pose"))
    struct.pack_into("<I", message, 0xa8, number)
    struct.pack_into("<I", message, 0x40, 0)
    return bytes(message)


def acknowledge(count):
    message = bytearray(vector("acknowledge"))
    struct.pack_into("<Q", message, len(message) - 8, count)
    return bytes(message)


def kind(message):
    """What a message is: the number of its type in limn.fbs' union Body."""
    table, = struct.unpack_from("<I", message)
    vtable = table - struct.unpack_from("<i", message, table)[0]
    field, = struct.unpack_from("<H", message, vtable + 4)
    return message[table + field]
