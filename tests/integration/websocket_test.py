# SPDX-License-Identifier: Apache-2.0
"""Plays the table of RFC 6455 cases (websocket_cases.py) over raw sockets, and what an upgrade may look like."""

import base64
import hashlib
import select
import socket
import struct
import unittest

from harness import DEADLINE_S, Case, Server
from rude_client import BINARY, CLOSE, PONG, WebSocket, hello, kind
from websocket_cases import SECTIONS, Closes, CutOff, Echoes, Fails, Pongs, ask, close, frame

CATALOGUE = 9
GUID = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
KEY = "dGhlIHNhbXBsZSBub25jZQ=="


class Player:
    """Plays one case. `log` is what the server sent: ("answer",), ("pong", payload), ("close", code) or ("cut",)."""

    def __init__(self, port, case):
        self.client, self.log = WebSocket(port), []
        assert self.client.status == 101
        self.client.line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        ends = isinstance(case.wanted, (Closes, CutOff, Fails))
        try:
            self.client.line.sendall(frame(BINARY, hello()))
            for number, piece in enumerate(case.pieces, 1):
                self.client.line.sendall(piece)
                if isinstance(case.wanted, Echoes):
                    self.listen(number)
                # What is sent to a server that has closed resets the line, and its close frame is lost.
                elif ends and len(case.pieces) > 2 and select.select([self.client.line], [], [], 0.0005)[0]:
                    if self.log or not self.listen_once():
                        break
        except (BrokenPipeError, ConnectionResetError):
            pass
        if not ends:
            self.listen(len(case.wanted.payloads) + case.wanted.then if isinstance(case.wanted, Pongs)
                        else len(case.pieces) if isinstance(case.wanted, Echoes) else 1)
            # An answered close shows that all was read and nothing else was to be said.
            if not self.ended():
                self.client.line.sendall(close(1000))
        while not self.ended():
            self.listen_once()
        self.client.line.close()

    def ended(self):
        return bool(self.log) and self.log[-1][0] in ("close", "cut")

    def listen(self, count):
        while len(self.log) < count and not self.ended():
            self.listen_once()

    def listen_once(self):
        opcode, payload = self.client.receive()
        if opcode is None:
            self.log.append(("cut",))
        elif opcode == BINARY:
            if kind(payload) == CATALOGUE:
                self.log.append(("answer",))
        elif opcode == PONG:
            self.log.append(("pong", payload))
        elif opcode == CLOSE:
            assert len(payload) != 1, "a close frame with one byte"
            payload[2:].decode()  # must be UTF-8
            self.log.append(("close", struct.unpack(">H", payload[:2])[0] if payload else None))
        else:
            raise AssertionError("opcode %d" % opcode)
        return not self.ended()

    def fault(self, wanted):
        """None, or what is wrong."""
        answers = self.log.count(("answer",))
        pongs = tuple(entry[1] for entry in self.log if entry[0] == "pong")
        end = self.log[-1]
        if isinstance(wanted, CutOff):
            return None  # it ended
        if isinstance(wanted, Fails):
            return None if end in (("cut",), ("close", 1002)) and not pongs and not answers else "wanted the end"
        if isinstance(wanted, Closes):
            return None if end[0] == "close" and end[1] in wanted.codes and not pongs else "wanted a close with %s" % (wanted.codes,)
        if end != ("close", 1000):
            return "wanted an answer to the last close"
        if isinstance(wanted, Pongs):
            if pongs[:len(wanted.payloads)] != wanted.payloads or len(self.log) < len(wanted.payloads) + wanted.then:
                return "wanted pongs %s, then %d answers" % (wanted.payloads, wanted.then)
            return None
        return "wanted answers, and no pong" if pongs or not answers else None


class WebSockets(Case):

    def play(self, *sections):
        faults = []
        with Server(self.store, "--max-clients-per-address", 0) as server:
            for section in sections:
                for case in SECTIONS[section]:
                    player = Player(server.port, case)
                    if fault := player.fault(case.wanted):
                        faults.append("%s (%s): %s, got %s" % (case.number, case.what, fault, player.log))
            self.assertEqual(server.get("/livez")[0], 200)
        if faults:
            self.fail("\n".join(["%d cases" % len(faults), *faults]))

    def test_the_table_is_whole(self):
        numbers = [case.number for cases in SECTIONS.values() for case in cases]
        self.assertEqual(len(numbers), len(set(numbers)))
        self.assertGreaterEqual(len(numbers), 240)
        print("%d cases" % len(numbers))

    def test_framing_pings_and_reserved_bits(self):
        self.play("framing", "pings", "reserved_bits", "opcodes")

    def test_fragmentation_and_sizes(self):
        self.play("fragmentation", "sizes")

    def test_utf8(self):
        self.play("utf8")

    def test_closing(self):
        self.play("closing")

    def test_what_libwebsockets_takes_against_the_rules(self):
        """RFC 6455 5.1 and 5.2: frames that are not masked, and lengths that are not minimal, must be refused;
        libwebsockets 4.1 takes them, and does not let its user see them (server/transport/README.md). Autobahn has no
        case for either. When this fails, the library has learned it: move the cases into the table."""
        with Server(self.store) as server:
            for odd in (frame(BINARY, ask(), masked=False), frame(BINARY, ask(), length_bytes=2),
                        frame(BINARY, ask(), length_bytes=8)):
                client = WebSocket(server.port)
                client.send(hello())
                client.receive()
                client.line.sendall(odd)
                opcode, payload = client.receive()
                self.assertEqual((opcode, kind(payload)), (BINARY, CATALOGUE))

    def upgrade(self, server, change=None, extra=(), request="GET / HTTP/1.1"):
        """The head of the answer to an upgrade with some headers changed; None leaves one out."""
        headers = {"Host": "localhost", "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Key": KEY,
                   "Sec-WebSocket-Version": "13", "Sec-WebSocket-Protocol": "limn.1", **(change or {})}
        lines = [request] + ["%s: %s" % item for item in headers.items() if item[1] is not None] + list(extra)
        with socket.create_connection(("127.0.0.1", server.port), DEADLINE_S) as line:
            line.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
            answer = b""
            try:
                while b"\r\n\r\n" not in answer:
                    data = line.recv(4096)
                    if not data:
                        break
                    answer += data
            except ConnectionResetError:
                pass
        return answer.decode("latin-1")

    def test_upgrades(self):
        with Server(self.store) as server:
            good = self.upgrade(server)
            self.assertTrue(good.startswith("HTTP/1.1 101 "))
            accept = base64.b64encode(hashlib.sha1((KEY + GUID).encode()).digest()).decode()
            self.assertIn("sec-websocket-accept: " + accept.lower(), good.lower())
            self.assertIn("sec-websocket-protocol: limn.1", good.lower())
            for change in ({"Upgrade": "WebSocket"}, {"Connection": "keep-alive, Upgrade"}, {"Connection": "upgrade"},
                           {"Sec-WebSocket-Protocol": "other, limn.1"}, {"Host": "example.org:80"},
                           {"User-Agent": "x" * 500}):
                self.assertTrue(self.upgrade(server, change).startswith("HTTP/1.1 101 "), change)
            # 12.*, 13.*: compression is declined, not negotiated.
            for offer in ("permessage-deflate", "permessage-deflate; client_max_window_bits", "permessage-deflate; server_no_context_takeover, x-webkit-deflate-frame", "permessage-bzip2"):
                answer = self.upgrade(server, {"Sec-WebSocket-Extensions": offer})
                self.assertTrue(answer.startswith("HTTP/1.1 101 "), offer)
                self.assertNotIn("sec-websocket-extensions", answer.lower())
            refused = (
                ({"Sec-WebSocket-Version": "8"}, 426), ({"Sec-WebSocket-Version": "14"}, 426), ({"Sec-WebSocket-Version": "x"}, 426),
                ({"Sec-WebSocket-Version": None}, 426), ({"Sec-WebSocket-Key": None}, 400), ({"Sec-WebSocket-Key": "short"}, 400),
                ({"Sec-WebSocket-Key": KEY + "AAAA"}, 400), ({"Sec-WebSocket-Protocol": None}, 400),
                ({"Sec-WebSocket-Protocol": "LIMN.1"}, 400), ({"Sec-WebSocket-Protocol": "limn.2"}, 400),
                ({"Upgrade": "h2c"}, None), ({"Upgrade": "foo"}, None), ({"Connection": "keep-alive"}, None),
                ({"Connection": None}, None))
            for change, status in refused:
                answer = self.upgrade(server, change)
                self.assertFalse(answer.startswith("HTTP/1.1 101 "), change)
                if status:
                    self.assertTrue(answer.startswith("HTTP/1.1 %d " % status), (change, answer))
            self.assertIn("sec-websocket-version: 13", self.upgrade(server, {"Sec-WebSocket-Version": "8"}).lower())
            for request in ("POST / HTTP/1.1", "FOO / HTTP/1.1", "GET", "\x00\x01\x02", "GET / HTTP/1.0", "GET / HTTP/9.9", "GET /" + "a" * 5000 + " HTTP/1.1"):
                self.assertFalse(self.upgrade(server, request=request).startswith("HTTP/1.1 101 "), request)
            self.assertEqual(server.get("/livez")[0], 200)


if __name__ == "__main__":
    unittest.main(verbosity=2)
