# SPDX-License-Identifier: Apache-2.0
"""limn-server inspect: the bytes it accounts for are those that were prepared, and the errors it plots come down."""

import json
import unittest
import xml.etree.ElementTree

from harness import Case, run
from meshes import torus, write_painted

FRAME_AND_HEAD = 160  # of a message: WebSocket header, FlatBuffer, the run's head, the coder's end


class Inspect(Case):
    def setUp(self):
        super().setUp()
        self.report, _ = self.prepare_shape("bumpy", torus(48, 24, bump=0.1))

    def inspect(self, *arguments, expect=0):
        return run("limn-server", "inspect", *arguments, expect=expect)

    def test_every_byte_is_accounted_for(self):
        told = json.loads(self.inspect("bumpy", "--store", self.store, "--json"))
        sections = {section["name"]: section for section in told["sections"]}
        prepared = self.report["bytes"]
        self.assertEqual(sections["base"]["bytes"], prepared["base"] + prepared["features"])
        self.assertEqual(sections["blocks"]["bytes"], prepared["level_blocks"])
        self.assertEqual(sections["packets"]["bytes"], prepared["splits"])
        self.assertEqual(sections["forest"]["messages"], 0)
        self.assertEqual(len(told["levels"]), len(self.report["levels"]))
        for level, wanted in zip(told["levels"][1:], self.report["levels"][1:]):
            self.assertEqual(level["bytes"], wanted["bytes"])
            least = sum(level["bits"].values()) / 8
            self.assertGreater(least, 0)
            self.assertGreaterEqual(level["bytes"], least)
            self.assertLess(level["bytes"], least + FRAME_AND_HEAD)

    def test_attributes_are_accounted_for_by_kind(self):
        shape = torus(48, 24, bump=0.1)
        report, _ = self.prepare(write_painted(self.folder / "painted.ply", shape), "painted")
        told = json.loads(self.inspect("painted", "--store", self.store, "--json"))
        for level, wanted in zip(told["levels"][1:], report["levels"][1:]):
            self.assertEqual(level["bytes"], wanted["bytes"])
            self.assertGreater(level["bits"]["colors"], 0)
            self.assertGreater(level["bits"]["normals"], 0)
            least = sum(level["bits"].values()) / 8
            self.assertGreaterEqual(level["bytes"], least)
            self.assertLess(level["bytes"], least + FRAME_AND_HEAD)
        self.assertIn("attributes", self.inspect("painted", "--store", self.store))

    def test_placement_and_the_bits_of_moves_are_told(self):
        self.prepare_shape("placed", torus(48, 24, bump=0.1), "--placement", "volume")
        for name, placement in (("bumpy", "subset"), ("placed", "volume")):
            told = json.loads(self.inspect(name, "--store", self.store, "--json"))
            self.assertEqual(told["placement"], placement)
            moves = sum(level["bits"]["moves"] for level in told["levels"])
            self.assertEqual(moves > 0, placement == "volume")
            self.assertIn(placement + " placement", self.inspect(name, "--store", self.store))

    def test_errors_come_down_with_bytes_and_end_at_none(self):
        plot = self.folder / "plot.svg"
        told = json.loads(self.inspect("bumpy", "--store", self.store, "--json", "--views", 2, "--plot", plot))["rates"]
        levels, poses = told["by_level"], told["by_pose"]
        self.assertEqual([point["bytes"] for point in levels], sorted(point["bytes"] for point in levels))
        self.assertGreater(levels[0]["contour_px"], 1)
        self.assertEqual((levels[-1]["contour_px"], levels[-1]["surface_rms"]), (0, 0))
        self.assertEqual(levels[-1]["faces"], self.report["mesh"]["faces"])
        self.assertLess(poses[-1]["contour_px"], 1.5)
        self.assertLess(poses[-1]["bytes"], levels[-1]["bytes"])
        self.assertEqual(told["draco_lods"][-1]["bytes"], told["draco_bytes"])
        self.assertTrue(xml.etree.ElementTree.parse(plot).getroot().tag.endswith("svg"))

    def test_an_asset_is_named_by_directory_name_or_id(self):
        by_name = self.inspect("bumpy", "--store", self.store)
        self.assertEqual(by_name, self.inspect(self.report["asset"], "--store", self.store))
        self.assertEqual(by_name, self.inspect(self.store / "assets" / self.report["asset"]))
        self.inspect("nobody", "--store", self.store, expect=1)
        self.inspect(self.folder / "nowhere", expect=1)
        self.inspect(expect=2)


if __name__ == "__main__":
    unittest.main()
