# SPDX-License-Identifier: Apache-2.0
"""limn-load against a real server."""

import json
import unittest

from harness import Case, Server, run
from meshes import torus

SCRIPT = """
decode = %s
[[phase]]
clients = %d
ramp_s = 0.5
hold_s = %s
model = "torus"
speed_deg_s = 90
behaviour = "%s"
[thresholds]
failed = 0
dropped = 0
decode_errors = 0
%s
"""


class Load(Case):

    def load(self, server, clients=10, hold=2.5, decode=1.0, behaviour="normal", more="", expect=0):
        script, report = self.folder / "script.toml", self.folder / "load.json"
        script.write_text(SCRIPT % (decode, clients, hold, behaviour, more))
        run("limn-load", "--server", server.url, "--script", script, "--report", report, expect=expect)
        return json.loads(report.read_text())

    def test_ten_clients_decode_everything_without_an_error(self):
        prepared, _ = self.prepare_shape("torus", torus(64, 32, 0.3))
        with Server(self.store) as server:
            report = self.load(server)
            self.assertEqual(report["clients"]["connected"], 10)
            self.assertTrue(report["passed"])
            self.assertGreater(report["splits_decoded"], 0)
            self.assertGreater(report["latency_ms"]["pose_to_packet"]["samples"], 0)
            self.assertGreater(report["server"]["rss_mib_before"], 0)
            self.assertGreater(report["bytes_received"], 10 * prepared["bytes"]["base"])

    def test_a_missed_threshold_fails_the_run(self):
        self.prepare_shape("torus", torus(32, 16))
        with Server(self.store) as server:
            report = self.load(server, 2, 0.5, more="connect_max_ms = 0", expect=1)
            self.assertFalse(report["passed"])

    def test_the_server_outlives_rude_clients(self):
        self.prepare_shape("torus", torus(64, 32, 0.3))
        with Server(self.store) as server:
            for behaviour in ("churn", "slow-reader", "idle", "flood", "malformed"):
                self.load(server, 3, 1.5, 0.0, behaviour, expect=None)
                self.assertIsNone(server.process.poll(), behaviour)
            report = self.load(server, 3, 1.0)
            self.assertTrue(report["passed"])

    def test_an_unknown_model_fails_every_client(self):
        self.prepare_shape("other", torus(16, 8))
        with Server(self.store) as server:
            report = self.load(server, 2, 0.5, expect=1)
            self.assertEqual(report["clients"]["failed"], 2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
