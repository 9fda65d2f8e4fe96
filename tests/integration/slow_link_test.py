# SPDX-License-Identifier: Apache-2.0
"""Programs over slow links, with little memory, and with several models on one connection."""

import json
import unittest

from harness import Case, Server, run
from meshes import torus
from shaping_proxy import ShapingProxy

MBIT = 125_000  # bytes a second
LARGE = torus(160, 80, 0.3)


class SlowLink(Case):

    def load(self, url, body, expect=0):
        script, report = self.folder / "script.toml", self.folder / "load.json"
        script.write_text("decode = 1.0\n[[phase]]\nclients = 1\n" + body +
                          "[thresholds]\nfailed = 0\ndropped = 0\ndecode_errors = 0\n")
        run("limn-load", "--server", url, "--script", script, "--report", report, expect=expect)
        return json.loads(report.read_text())

    def test_a_new_pose_takes_effect_within_a_window_over_one_megabit(self):
        prepared, _ = self.prepare_shape("large", LARGE)
        splits = prepared["bytes"]["splits"]
        with Server(self.store) as server, ShapingProxy(server.port, down=MBIT, up=MBIT, delay_s=0.02) as link:
            report = self.load(link.url, 'model = "large"\nhold_s = 6\nspeed_deg_s = 60\nerror_px = 0.25\n')
        waited = report["pose_to_packet_bytes"]
        self.assertGreater(report["latency_ms"]["pose_to_packet"]["samples"], 5)
        self.assertGreater(report["bytes_received"], splits / 10, "the link had something to carry")
        # The largest window there is bounds what a pose finds on its way; on this link, once it is known, far less.
        self.assertLessEqual(waited["max"], 64 * 1024 + 16 * 1024)
        self.assertLessEqual(waited["p50"], 32 * 1024)

    def test_several_models_come_over_one_connection(self):
        self.prepare_shape("one", torus(64, 32, 0.3))
        self.prepare_shape("two", torus(48, 32))
        with Server(self.store) as server:
            report = self.load(server.url, 'model = "one"\nalso = ["two", "one"]\nhold_s = 2\n')
            self.assertEqual(report["clients"]["connected"], 1)
            self.assertEqual(report["errors"], {})
            self.assertGreater(report["latency_ms"]["pose_to_packet"]["samples"], 0)
            self.load(server.url, 'model = "one"\nalso = ["missing"]\nhold_s = 0.5\n', expect=1)

    def test_a_client_with_little_memory_draws_a_moving_camera(self):
        self.prepare_shape("large", LARGE)
        arguments = ("--path", "orbit", "--frames", "8", "--until", "settled", "--error-px", "0.5",
                     "--gl", "osmesa", "--out", self.folder / "f%04d.png")
        with Server(self.store) as server:
            bound, mesh = self.draw(server.url, "large", *arguments, "--memory", "1")
            self.draw(server.url, "large", "--until", "complete", "--memory", "1", expect=1)  # that does not fit
        self.assertEqual(bound["state"], "settled")
        # Three copies of at most this many bytes a vertex.
        self.assertLess(3 * 80 * bound["mesh"]["splits_held"], 1 << 20)
        self.assert_manifold(mesh, "after drops")


if __name__ == "__main__":
    unittest.main(verbosity=2)
