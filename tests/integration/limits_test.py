# SPDX-License-Identifier: Apache-2.0
"""Every limit of limn-server, reached by one client: it is told why, and the others go on."""

import contextlib
import socket
import struct
import unittest

from harness import DEADLINE_S, Case, Server
from meshes import torus
from rude_client import BINARY, CLOSE, CONTINUATION, WebSocket, acknowledge, hello, kind, open_dragon, pose

WELCOME, CATALOGUE, BASE, LEVEL_BLOCK, PACKET, SEEDS, SETTLED, ERROR = 8, 9, 11, 12, 13, 14, 15, 16
PAYLOAD = (BASE, LEVEL_BLOCK, PACKET, SEEDS)


def greeted(server, **options):
    client = WebSocket(server.port, **options)
    client.send(hello())
    assert kind(client.receive()[1]) == WELCOME
    return client


class Limits(Case):

    def assert_alive(self, server):
        self.assertEqual(server.get("/livez")[0], 200)

    def test_clients_in_all(self):
        with Server(self.store, "--max-clients", 2) as server:
            first, second = WebSocket(server.port), WebSocket(server.port)
            third = WebSocket(server.port)
            self.assertEqual((third.status, third.answer), (503, "too many clients; try again later\n"))
            self.assertIn("retry-after:", third.headers)
            self.assert_alive(server)
            first.line.close()
            server.wait_for_metric('limn_connections_closed_total{reason="left"}', 1)
            self.assertEqual(WebSocket(server.port).status, 101)
            self.assertEqual(server.metric('limn_connections_refused_total{reason="total"}'), 1)
            second.line.close()

    def test_clients_from_one_address(self):
        with Server(self.store, "--max-clients-per-address", 2) as server:
            first, second = WebSocket(server.port), WebSocket(server.port)
            third = WebSocket(server.port)
            self.assertEqual(third.status, 429)
            self.assertEqual(third.answer, "too many connections from your address; at most 2\n")
            elsewhere = socket.create_connection(("127.0.0.1", server.port), DEADLINE_S, ("127.0.0.2", 0))
            self.assertEqual(WebSocket(server.port, line=elsewhere).status, 101)
            first.line.close()
            server.wait_for_metric('limn_connections_closed_total{reason="left"}', 1)
            self.assertEqual(WebSocket(server.port).status, 101)
            second.line.close()

    def test_sockets_that_ask_for_nothing(self):
        with Server(self.store, "--max-clients-per-address", 2) as server:
            silent = [socket.create_connection(("127.0.0.1", server.port), DEADLINE_S) for _ in range(18)]
            one_more = socket.create_connection(("127.0.0.1", server.port), DEADLINE_S)
            with contextlib.suppress(ConnectionResetError):
                self.assertIn(one_more.recv(4096)[:12], (b"HTTP/1.1 503", b""))
            for line in silent:
                line.close()

    def test_time_for_a_handshake(self):
        with Server(self.store, "--handshake-ms", 300) as server:
            silent = socket.create_connection(("127.0.0.1", server.port), DEADLINE_S)
            self.assertIn(b"408", silent.recv(4096))
            self.assertEqual(silent.recv(4096), b"")
            dribbling = socket.create_connection(("127.0.0.1", server.port), DEADLINE_S)
            dribbling.sendall(b"GET / HTTP/1.1\r\nHost: x\r\nX-")
            self.assertIn(b"no request within 300 ms", dribbling.recv(4096))
            mute = WebSocket(server.port)  # upgrades, then no Hello
            self.assertEqual(kind(mute.receive()[1]), ERROR)
            self.assertEqual(mute.ending(), (1008, "no Hello within 300 ms"))
            self.assertEqual(server.metric('limn_connections_closed_total{reason="late"}'), 1)
            self.assert_alive(server)

    def test_time_for_a_handshake_over_tls(self):
        certificate, key = self.certificate()
        with Server(self.store, "--handshake-ms", 1000, "--tls-cert", certificate, "--tls-key", key) as server:
            silent = socket.create_connection(("127.0.0.1", server.port), DEADLINE_S)
            with contextlib.suppress(ConnectionResetError):
                self.assertEqual(silent.recv(4096), b"")

    def test_size_of_headers(self):
        with Server(self.store) as server:
            line = socket.create_connection(("127.0.0.1", server.port), DEADLINE_S)
            with contextlib.suppress(ConnectionResetError, BrokenPipeError):
                line.sendall(b"GET /models HTTP/1.1\r\nHost: x\r\nAuthorization: " + b"y" * 5000 + b"\r\n\r\n")
                self.assertNotIn(b" 200 ", line.recv(4096))
            self.assert_alive(server)

    def test_size_of_a_message(self):
        with Server(self.store, "--max-message-bytes", 2048) as server:
            whole = greeted(server)
            whole.send(bytes(2049))
            self.assertEqual(whole.ending(), (1009, "a message may have 2048 bytes"))
            pieces = greeted(server)
            for i in range(3):
                pieces.send(bytes(1000), CONTINUATION if i else BINARY, False)
            self.assertEqual(pieces.ending(), (1009, "a message may have 2048 bytes"))
            announced = greeted(server)  # cut off by its header alone
            announced.line.sendall(bytes([0x80 | BINARY, 0x80 | 127]) + struct.pack(">Q", 1 << 40) + bytes(4 + 1))
            self.assertEqual(announced.close_code(), 1009)
            for client in (whole, pieces, announced):
                client.line.close()
            server.wait_for_metric('limn_connections_closed_total{reason="too_large"}', 3)

    def test_rate_of_messages(self):
        with Server(self.store, "--messages-per-second", 20) as server:
            flood = greeted(server)
            with contextlib.suppress(OSError):
                for _ in range(200):
                    flood.send(acknowledge(0))
            self.assertEqual(kind(flood.receive()[1]), ERROR)
            self.assertEqual(flood.ending(), (1008, "too many messages; at most 20 a second"))
            empty = greeted(server)  # a message of empty pieces, without end
            with contextlib.suppress(OSError):
                for i in range(200):
                    empty.send(b"", CONTINUATION if i else BINARY, False)
            self.assertEqual(empty.close_code(), 1008)
            self.assertEqual(server.metric('limn_connections_closed_total{reason="too_many"}'), 2)
            self.assert_alive(server)

    def test_poses_are_coalesced_to_the_newest(self):
        self.prepare_shape("dragon", torus(48, 24))
        with Server(self.store, "--poses-per-second", 10) as server:
            server.wait_for_model("dragon")
            client = greeted(server)
            client.send(open_dragon())
            for number in range(1, 301):
                client.send(pose(number))
            received, settled = 0, 0
            while settled != 300:
                opcode, message = client.receive()
                self.assertEqual(opcode, BINARY)
                if kind(message) in PAYLOAD:
                    received += len(message)
                    client.send(acknowledge(received))
                elif kind(message) == SETTLED:
                    settled = 300 if struct.pack("<I", 300) in message else settled
            self.assertEqual(server.metric("limn_poses_total"), 300)
            self.assertGreater(server.metric("limn_poses_replaced_total"), 250)

    def test_bytes_in_flight_and_progress(self):
        self.prepare_shape("dragon", torus(112, 56, 0.3))
        with Server(self.store, "--window-kib", 16, "--progress-ms", 700) as server:
            server.wait_for_model("dragon")
            greedy = greeted(server)  # reads all, acknowledges nothing
            greedy.send(open_dragon())
            greedy.send(pose(1))
            sizes, reason = [], None
            while reason is None:
                opcode, message = greedy.receive()
                if opcode == CLOSE:
                    reason = struct.unpack(">H", message[:2])[0], message[2:].decode()
                elif kind(message) in PAYLOAD:
                    sizes.append(len(message))
            self.assertLessEqual(sum(sizes), max(16 * 1024, max(sizes)), sizes)
            self.assertEqual(reason, (1008, "nothing taken or acknowledged for 700 ms"))
            polite = greeted(server)
            polite.send(open_dragon())
            polite.send(pose(1))
            received = 0
            while received < 20 * 1024:
                opcode, message = polite.receive()
                self.assertEqual(opcode, BINARY)
                if kind(message) in PAYLOAD:
                    received += len(message)
                    polite.send(acknowledge(received))
            self.assertEqual(server.metric('limn_connections_closed_total{reason="stalled"}'), 1)

    def test_other_methods_than_get(self):
        with Server(self.store) as server:
            line = socket.create_connection(("127.0.0.1", server.port), DEADLINE_S)
            line.sendall(b"POST /models HTTP/1.1\r\nHost: x\r\nContent-Length: 30\r\n\r\nGET /models HTTP/1.1\r\nHost: x\r\n\r\n")
            answer = b""
            with contextlib.suppress(ConnectionResetError):
                while data := line.recv(4096):
                    answer += data
            self.assertEqual(answer.count(b"HTTP/1.1"), 1, "the body is no request")
            self.assertIn(b" 405 ", answer)


if __name__ == "__main__":
    unittest.main(verbosity=2)
