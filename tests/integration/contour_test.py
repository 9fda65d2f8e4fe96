# SPDX-License-Identifier: Apache-2.0
"""A settled client draws the silhouettes of the full mesh: visible ones within 2 px (95th percentile) of the full mesh's
visible ones, both ways, as the client itself draws and measures them."""

import json
import unittest

from harness import Case, Server, models, run
from meshes import hills, pair, torus

SHAPES = {"bumpy": torus(96, 48, 0.3), "pair": pair(), "hills": hills(40, 30)}
MODELS = ("bunny-low.off", "casting.off")
CAMERAS = ("orbit:30,15", "orbit:200,-20,2")
LIMIT_PX = 2.0


class Contours(Case):

    def contour_error(self, server, name, asset, until, camera, kind):
        """p95 and maximum, in pixels at 1024 x 1024, of what a fresh client has."""
        report = self.folder / "contour.json"
        run("limn-client", "render", "--server", server.url, "--model", name, "--until", until, "--camera", camera,
            "--silhouette", kind, "--size", "1024x1024", "--draw", "shaded", "--check", "--reference", self.store / "assets" / asset,
            "--report", report)
        report = json.loads(report.read_text())
        self.assertEqual(report["state"], until)
        return report["contour_error_px"], report["mesh"]

    def assert_settled_matches(self, names):
        with Server(self.store) as server:
            for name, asset in names.items():
                for camera, kind in zip(CAMERAS, ("edges", "smooth")):
                    error, mesh = self.contour_error(server, name, asset, "settled", camera, kind)
                    self.assertLessEqual(error["p95"], LIMIT_PX, "%s, %s, %s: %s" % (name, camera, kind, mesh))

    def test_settled_matches_the_full_mesh_on_generated_shapes(self):
        self.assert_settled_matches({n: self.prepare_shape(n, shape)[0]["asset"] for n, shape in SHAPES.items()})

    def test_settled_matches_the_full_mesh_on_real_models(self):
        folder = models()
        files = [folder / name for name in MODELS if (folder / name).exists()] if folder else []
        if not files:
            self.skipTest("no real models: set LIMN_MODELS to a folder of meshes")
        self.assert_settled_matches({f.stem: self.prepare(f, f.stem)[0]["asset"] for f in files})

    def test_a_mesh_too_coarse_is_found_out(self):
        """The negative control: the base mesh alone does not pass."""
        asset = self.prepare_shape("bumpy", torus(128, 64, 0.5))[0]["asset"]
        with Server(self.store) as server:
            for kind in ("edges", "smooth"):
                error, _ = self.contour_error(server, "bumpy", asset, "base", CAMERAS[0], kind)
                self.assertGreater(error["p95"], LIMIT_PX, kind)


if __name__ == "__main__":
    unittest.main(verbosity=2)
