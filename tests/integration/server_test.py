# SPDX-License-Identifier: Apache-2.0
"""limn-server as its operators and rude clients meet it: sockets, HTTP, background preparation, drain."""

import json
import os
import pathlib
import subprocess
import time
import unittest

from harness import BIN, DEADLINE_S, Case, Server
from meshes import hills, torus, write_obj
from rude_client import BINARY, TEXT, WebSocket, hello


def rss_kib(process):
    for line in pathlib.Path("/proc/%d/status" % process.pid).read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    raise AssertionError("no VmRSS")


class ServerProcess(Case):

    def test_only_our_subprotocol_is_spoken(self):
        with Server(self.store) as server:
            self.assertEqual(WebSocket(server.port).status, 101)
            self.assertEqual(WebSocket(server.port, "other, limn.1").status, 101)
            self.assertNotEqual(WebSocket(server.port, "other").status, 101)
            self.assertNotEqual(WebSocket(server.port, None).status, 101)

    def test_token_and_origin_are_asked_for(self):
        tokens = self.folder / "tokens"
        tokens.write_text("# ours\n0123456789abcdef\n")
        with Server(self.store, "--token-file", tokens) as server:
            self.assertNotEqual(WebSocket(server.port).status, 101)
            self.assertNotEqual(WebSocket(server.port, headers=["Authorization: Bearer 0123456789abcdeX"]).status, 101)
            good = ["Authorization: Bearer 0123456789abcdef"]
            self.assertEqual(WebSocket(server.port, headers=good).status, 101)
            self.assertNotEqual(WebSocket(server.port, headers=[*good, "Origin: https://evil.example"]).status, 101)
            self.assertEqual(WebSocket(server.port, headers=[*good, "Origin: http://localhost:3000"]).status, 101)
            self.assertEqual(server.get("/models")[0], 401)
            self.assertEqual(server.get("/livez")[0], 200)

    def test_rude_messages_close_the_connection_with_a_reason(self):
        with Server(self.store) as server:
            for payload, opcode, code in ((b"hi", TEXT, 1003), (b"x" * 70000, BINARY, 1009), (b"garbage", BINARY, 1008)):
                rude = WebSocket(server.port)
                rude.send(payload, opcode)
                self.assertEqual(rude.close_code(), code, payload[:10])
            split = WebSocket(server.port)  # one message in many frames is fine
            data = hello()
            for i in range(0, len(data), 7):
                split.send(data[i:i + 7], BINARY if i == 0 else 0, i + 7 >= len(data))
            self.assertEqual(split.receive()[0], BINARY)
            endless = WebSocket(server.port)  # but it may not grow without end
            for i in range(80):
                try:
                    endless.send(b"x" * 1024, BINARY if i == 0 else 0, False)
                except OSError:
                    break
            self.assertIn(endless.close_code(), (1009, None))
            self.assertEqual(server.get("/livez")[0], 200)

    def test_listens_where_it_is_told_and_nowhere_else(self):
        with Server(self.store) as server:
            wanted = "0100007F:%04X" % server.port
            for table in ("/proc/net/tcp", "/proc/net/tcp6"):
                if not os.path.exists(table):
                    continue
                for line in pathlib.Path(table).read_text().splitlines()[1:]:
                    fields = line.split()
                    if fields[3] == "0A" and fields[1].endswith(":%04X" % server.port):
                        self.assertEqual((table, fields[1]), ("/proc/net/tcp", wanted))

    def test_a_taken_port_is_said_in_one_line(self):
        with Server(self.store) as server:
            done = subprocess.run([BIN / "limn-server", "--store", self.store, "--listen", "127.0.0.1:%d" % server.port],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=DEADLINE_S)
            self.assertEqual(done.returncode, 1)
            self.assertIn("cannot listen on 127.0.0.1:%d" % server.port, done.stderr)

    def test_wrong_usage_exits_2_with_a_line_that_helps(self):
        store = ["--store", self.store]
        for arguments in ([], ["--store", "s3://bucket"], [*store, "--listen", "here"], [*store, "--tls-cert", "x"],
                          [*store, "--token-file", self.folder / "none"], [*store, "--models", self.folder / "none"],
                          [*store, "--nonsense"]):
            done = subprocess.run([BIN / "limn-server", *map(str, arguments)], stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True, timeout=DEADLINE_S)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)

    def test_sigterm_sends_open_clients_away(self):
        with Server(self.store) as server:
            clients = [WebSocket(server.port) for _ in range(20)]
            for client in clients:
                client.send(hello())
                self.assertEqual(client.receive()[0], BINARY)
            server.process.terminate()
            for client in clients:
                self.assertEqual(client.receive()[0], BINARY, "why")
                self.assertEqual(client.close_code(), 1001)
                client.line.close()
            self.assertEqual(server.process.wait(DEADLINE_S), 0)

    def test_a_folder_of_models_is_followed(self):
        folder = self.folder / "models"
        folder.mkdir()
        write_obj(folder / "hills.obj", hills(20, 20))
        (folder / "broken.obj").write_text("this is no mesh\n")
        with Server(self.store, "--models", folder) as server:
            first = server.wait_for_model("hills")
            self.assertGreater(first["faces"], 0)
            broken = server.wait_for_model("broken", "failed")
            self.assertTrue(broken["reason"])
            write_obj(folder / "hills.obj", torus(24, 12))
            self.wait_until(lambda: self.entry(server, "hills")["asset"] not in (first["asset"], None))
            report, _ = self.draw(server.url, "hills", "--until", "complete")
            self.assertEqual(report["mesh"]["faces"], 2 * 24 * 12)
            (folder / "hills.obj").unlink()
            self.wait_until(lambda: self.entry(server, "hills") is None)
            write_obj(folder / "broken.obj", hills(10, 10))
            self.wait_until(lambda: self.entry(server, "broken")["state"] == "ready")
        (folder / "broken.obj").unlink()
        with Server(self.store, "--models", folder) as server:
            self.assertIsNone(self.entry(server, "broken"), "deleted while no server ran")

    def test_models_prepared_by_hand_appear(self):
        with Server(self.store) as server:
            self.prepare_shape("torus", torus(24, 12))
            server.wait_for_model("torus")

    @unittest.skipIf("LIMN_SANITIZED" in os.environ, "a sanitizer's memory says nothing")
    def test_idle_clients_cost_little(self):
        self.prepare_shape("torus", torus(48, 24))
        with Server(self.store, "--max-clients-per-address", 0) as server:
            server.wait_for_model("torus")

            def connect(count):
                clients = []
                for _ in range(count):
                    client = WebSocket(server.port)
                    client.send(hello())
                    self.assertEqual(client.receive()[0], BINARY)
                    clients.append(client)
                return clients

            few = connect(20)
            before = rss_kib(server.process)
            many = connect(300)
            each = (rss_kib(server.process) - before) / len(many)
            print("%.1f KiB an idle client" % each)
            self.assertLess(each, 16)
            for client in few + many:
                client.line.close()

    def entry(self, server, name):
        return next((e for e in json.loads(server.get("/models")[1]) if e["name"] == name), None)

    def wait_until(self, condition):
        end = time.monotonic() + DEADLINE_S
        while not condition():
            self.assertLess(time.monotonic(), end, "it did not happen")
            time.sleep(0.05)


if __name__ == "__main__":
    unittest.main(verbosity=2)
