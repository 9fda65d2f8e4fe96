# SPDX-License-Identifier: Apache-2.0
"""limn-server as an installed service: its configuration file, and what it tells the service manager."""

import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import unittest

from harness import BIN, DEADLINE_S, Case, Server, free_port, run
from meshes import torus, write_obj
from rude_client import WebSocket, hello

CONFIGURATION = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "limn-server.toml"


class Service(Case):
    def test_every_key_of_the_configuration_is_an_option(self):
        keys = re.findall(r"^(?:# )?([a-z-]+) = ", CONFIGURATION.read_text(), re.MULTILINE)
        self.assertGreater(len(keys), 10)
        options = set(re.findall(r"--([a-z-]+)", run("limn-server", "--help")))
        self.assertEqual([key for key in keys if key not in options], [])

    def test_the_configuration_is_accepted_as_it_is(self):
        server = subprocess.Popen(
            [BIN / "limn-server", "--config", CONFIGURATION, "--store", self.store,
             "--listen", "127.0.0.1:%d" % free_port()], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            self.assertIn("listening", server.stdout.readline())
        finally:
            server.kill()
            server.communicate()

    def test_a_wrong_line_of_the_configuration_is_named(self):
        file = self.folder / "limn-server.toml"
        for text, said in (("window-kib = 64\nmax-client = 3\n", "line 2: there is no key 'max-client'; write one of"),
                           ("max-clients-per-address = 1\nmax-clients = 'many'\n", "line 2: (.*)--max-clients"),
                           ("\nhandshake-ms = 5\n", "line 2: --handshake-ms(.*)100(.*)600000"),
                           ("listen = [\n", "line [12]: ")):
            file.write_text(text)
            with self.assertRaisesRegex(AssertionError, "exit status 2(.|\n)*limn-server: %s: %s" % (file, said)):
                run("limn-server", "--store", self.store, "--config", file)

    def test_metrics_are_prometheus_text_and_logs_are_json(self):
        folder = self.folder / "models"
        folder.mkdir()
        write_obj(folder / "dragon.obj", torus(16, 8))
        log = open(self.folder / "log", "w+")
        ports = free_port(), free_port()
        server = subprocess.Popen(
            [BIN / "limn-server", "--store", self.store, "--models", folder, "--listen", "127.0.0.1:%d" % ports[0],
             "--metrics-listen", "127.0.0.1:%d" % ports[1], "--log-format", "json", "--max-clients-per-address", "1"],
            stdout=subprocess.PIPE, stderr=log, text=True)
        try:
            self.assertIn("listening", server.stdout.readline())
            known = Server(self.store)
            known.port, known.metrics_port = ports
            known.wait_for_model("dragon")
            client = WebSocket(known.port)
            client.send(hello())
            client.receive()
            self.assertEqual(WebSocket(known.port).status, 429)
            client.line.close()
            known.wait_for_metric('limn_connections_closed_total{reason="left"}', 1)
            status, text = known.get("/metrics", known.metrics_port)
            self.assertEqual(status, 200)
            self.assertEqual(known.get("/metrics")[0], 404, "on a listener of their own")
            self.assertEqual(known.get("/livez"), (200, "ok\n"))
            self.assertEqual(known.get("/readyz"), (200, "ok\n"))
            self.assertEqual(json.loads(known.get("/version")[1])["name"], "limn-server")
        finally:
            server.terminate()
            self.assertEqual(server.wait(DEADLINE_S), 0)
            server.stdout.close()
        self.assertIn('limn_loop_lag_seconds_bucket{le="+Inf"}', text)
        self.assertIn("# TYPE limn_loop_lag_seconds histogram", text)
        if shutil.which("promtool"):
            subprocess.run(["promtool", "check", "metrics"], input=text, text=True, check=True, timeout=DEADLINE_S)
        log.seek(0)
        lines = [json.loads(line) for line in log]
        log.close()
        for line in lines:
            self.assertLessEqual({"time", "level", "event", "message"}, set(line))
        jobs = [line["job"] for line in lines if line["event"] == "preparation" and line.get("model") == "dragon"]
        self.assertEqual(len(jobs), 2, "begun and done")
        self.assertEqual(len(set(jobs)), 1, "one number for both")
        came = [line["connection"] for line in lines if line["event"] == "connection_opened"]
        self.assertEqual(came, [line["connection"] for line in lines if line["event"] == "connection_closed"])
        self.assertEqual([line["reason"] for line in lines if line["event"] == "connection_refused"], ["address"])

    def test_a_hostile_file_gets_no_more_than_its_limits(self):
        folder = self.folder / "models"
        folder.mkdir()
        write_obj(folder / "large.obj", torus(400, 200))
        for flag, value in (("--prepare-cpu-s", "1"), ("--prepare-memory-mib", "24")):
            if "LIMN_SANITIZED" in os.environ and "memory" in flag:
                continue
            with Server(self.folder / flag, "--models", folder, flag, value) as server:
                entry = server.wait_for_model("large", "failed")
                self.assertTrue(entry["reason"], entry)
                self.assertEqual(server.get("/livez")[0], 200)

    def test_the_service_manager_hears_that_it_is_ready_and_alive(self):
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
            path = str(self.folder / "notify")
            manager.bind(path)
            manager.settimeout(DEADLINE_S)
            # The watchdog is armed for this process alone, as systemd does; env keeps the number.
            server = subprocess.Popen(
                ["sh", "-c", 'WATCHDOG_PID=$$ exec "$0" "$@"', str(BIN / "limn-server"), "--store",
                 str(self.store), "--listen", "127.0.0.1:%d" % free_port()],
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                env={**os.environ, "NOTIFY_SOCKET": path, "WATCHDOG_USEC": "100000"})
            try:
                self.assertIn("READY=1", manager.recv(4096).decode())
                for _ in range(3):
                    self.assertEqual("WATCHDOG=1", manager.recv(4096).decode())
            finally:
                server.terminate()
                self.assertEqual(server.wait(DEADLINE_S), 0)


if __name__ == "__main__":
    unittest.main()
