# SPDX-License-Identifier: Apache-2.0
"""`limn-client render --draw …`: every way to draw, from a server, an asset and a file, with both GL backends."""

import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import png
from harness import Case, Server, run
from meshes import torus, write_obj

WAYS = ["image-edges", "geometry-shader", "conditional-lines"] + [
    "image-precision:" + way for way in ("wireframe", "translate", "z-scale", "offset", "fatten", "charcoal")]
SIZE = 160


class Draw(Case):

    def picture(self, *arguments):
        """Brightness of a picture, and its report."""
        out, report = self.folder / "picture.png", self.folder / "report.json"
        run("limn-client", "render", "--camera", "orbit:40,25", "--size", "%dx%d" % (SIZE, SIZE), "--style", "technical",
            "--out", out, "--report", report, *arguments)
        _, _, rows = png.read(out)
        return png.brightness(rows), json.loads(report.read_text())

    def test_every_way_draws_the_same_from_server_asset_and_file(self):
        shape = torus(64, 32)
        mesh = write_obj(self.folder / "shape.obj", shape)
        report, _ = self.prepare(mesh, "shape")
        asset = self.store / "assets" / report["asset"]
        with Server(self.store) as server:
            for way in WAYS:
                streamed, report = self.picture("--server", server.url, "--model", "shape", "--until", "complete", "--draw", way)
                self.assertEqual(report["state"], "complete", way)
                self.assertEqual(report["detector"]["name"], "none", way)
                self.assertGreater(report["frame_ms"]["draw"], 0, way)
                stored, _ = self.picture("--asset", asset, "--draw", way, "--gl", "osmesa")
                dark = sum(value < 160 for row in stored for value in row)
                self.assertGreater(dark, SIZE, way)
                # Vertices are numbered as they came, so a pixel may round the other way.
                differ = sum(abs(a - b) > 64 for ours, theirs in zip(streamed, stored) for a, b in zip(ours, theirs))
                self.assertLess(differ, 12, way)
        direct, _ = self.picture("--mesh", mesh, "--draw", WAYS[-2])
        stored, _ = self.picture("--asset", asset, "--draw", WAYS[-2])
        self.assertEqual(direct, stored)

    def test_a_moving_camera_draws_a_frame_each(self):
        mesh = write_obj(self.folder / "shape.obj", torus(32, 16))
        run("limn-client", "render", "--mesh", mesh, "--draw", "image-precision:fatten", "--path", "orbit", "--frames", "3",
            "--size", "96x96", "--out", self.folder / "f%d.png")
        frames = {(self.folder / ("f%d.png" % i)).read_bytes() for i in range(3)}
        self.assertEqual(len(frames), 3)


if __name__ == "__main__":
    unittest.main()
