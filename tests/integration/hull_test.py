# SPDX-License-Identifier: Apache-2.0
"""Hulls arrive as they were prepared, and hold the mesh."""

import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import png
from harness import Case, Proxy, Server, run, wait_until
from meshes import hills, read_ply, torus, write_painted


def volume(mesh):
    six = 0.0
    for a, b, c in mesh.faces:
        p, q, r = mesh.positions[a], mesh.positions[b], mesh.positions[c]
        six += (p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2])
                + p[2] * (q[0] * r[1] - q[1] * r[0]))
    return six / 6


class Hulls(Case):

    def hulls(self, source, faces, *arguments):
        dumps = self.folder / "outer.ply", self.folder / "inner.ply"
        report = self.folder / "hull.json"
        run("limn-client", "render", *source, "--hull-faces", faces, "--dump-hull", dumps[0], "--dump-inner-hull", dumps[1],
            "--report", report, "--size", "64x64", *arguments)
        return read_ply(dumps[0]), read_ply(dumps[1]), json.loads(report.read_text())

    def test_hulls_from_a_server_are_those_of_the_asset_and_of_the_report(self):
        prepared, mesh = self.prepare_shape("torus", torus(48, 24))
        whole = 64 * volume(mesh)  # dumps are read in grid steps, and a hull's are four times finer
        asset = self.store / "assets" / prepared["asset"]
        with Server(self.store) as server:
            self.assertTrue(server.wait_for_model("torus")["has_hull"])
            last = whole
            for faces in (2000, 500, 200):
                outer, inner, report = self.hulls(("--server", server.url, "--model", "torus"), faces)
                self.assertEqual((len(outer.faces), len(inner.faces)), (faces, faces))
                self.assertGreater(volume(outer), last)
                self.assertLess(volume(inner), whole)
                last = volume(outer)
                self.assertGreater(report["bytes"]["hull"], 0)
                stored = self.hulls(("--asset", asset), faces)
                self.assertEqual((outer.positions, outer.faces), (stored[0].positions, stored[0].faces))
                self.assertEqual((inner.positions, inner.faces), (stored[1].positions, stored[1].faces))
                if faces == 500:
                    said = prepared["hull"]["outer"]
                    self.assertEqual(said["faces"], 500)
                    self.assertAlmostEqual(said["volume"] / prepared["hull"]["mesh_volume"], last / whole, places=6)

    def test_maps_come_once_and_are_kept_by_what_they_are(self):
        shape = torus(48, 24)
        for name in ("painted", "twin"):
            self.prepare(write_painted(self.folder / (name + ".ply"), shape), name)
        cache = self.folder / "cache"

        def maps_of(name, cache=cache):
            report = self.folder / "clip.json"
            out = self.folder / "clip.png"
            run("limn-client", "render", "--server", server.url, "--model", name, "--draw", "clip", "--size", "64x64",
                "--cache", cache, "--report", report, "--out", out)
            read = json.loads(report.read_text())["bytes"]
            self.assertEqual(read["received"], sum(v for k, v in read.items() if k != "received"))
            return read["maps"], out.read_bytes()

        with Server(self.store) as server:
            first, picture = maps_of("painted")
            self.assertGreater(first, 10_000)
            files = sorted(cache.iterdir())
            self.assertEqual(len(files), 2)  # of normals and of colours
            self.assertEqual(maps_of("painted"), (0, picture))
            self.assertEqual(maps_of("twin")[0], 0)  # another name, the same bytes
            self.assertEqual(maps_of("painted", "none"), (first, picture))
            damaged = bytearray(files[0].read_bytes())
            damaged[len(damaged) // 2] ^= 1
            files[0].write_bytes(damaged)
            files[1].write_bytes(b"")
            self.assertEqual(maps_of("painted"), (first, picture))
            self.assertEqual(maps_of("painted"), (0, picture))

    def test_several_models_share_a_picture(self):
        for name, shape in (("left", torus(48, 24)), ("right", torus(32, 16))):
            self.prepare_shape(name, shape)
        report = self.folder / "two.json"
        with Server(self.store) as server:
            for more in ((), ("--contours", "server"), ("--camera", "orbit:80,10,0.3")):
                run("limn-client", "render", "--server", server.url, "--model", "left", "--with", "right", "--with",
                    "left@0,4,0", "--draw", "clip", "--size", "96x96", "--out", self.folder / "two.png", "--report",
                    report, "--cache", "none", *more)
                read = json.loads(report.read_text())["bytes"]
                self.assertEqual(read["received"], sum(v for k, v in read.items() if k != "received"))
                self.assertGreater(read["maps"], 0)
                _, _, rows = png.read(self.folder / "two.png")
                self.assertGreater(len({bytes(row[x:x + 3]) for row in rows for x in range(0, len(row), 3)}), 50)

    def picture(self, *source):
        out, camera = self.folder / "picture.png", self.folder / "camera.json"
        camera.write_text('{"eye": [1, -2, 6], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40}')
        run("limn-client", "render", *source, "--size", "96x96", "--until", "complete", "--out", out, "--camera-file",
            camera)
        return out.read_bytes()

    def test_an_open_mesh_says_why_it_has_no_hull(self):
        prepared, _ = self.prepare_shape("hills", hills(20, 20))
        self.assertIn("no hull, because the mesh is open", prepared["hull"]["reason"])
        with Server(self.store) as server:
            self.assertFalse(server.wait_for_model("hills")["has_hull"])
            here = ("--server", server.url, "--model", "hills")
            for needs in (("--dump-hull", self.folder / "hull.ply"), ("--contours", "server", "--draw", "clip", "--out", "-")):
                with self.assertRaisesRegex(AssertionError, "exit status 1(.|\n)*has no hull, because the mesh is open"):
                    run("limn-client", "render", *here, *needs)
            whole = self.picture(*here, "--draw", "shaded")
            self.assertEqual(self.picture(*here, "--draw", "clip"), whole)
            asset = ("--asset", self.store / "assets" / prepared["asset"])
            self.assertEqual(self.picture(*asset, "--draw", "clip"), whole)
            self.prepare_shape("torus", torus(24, 12))
            server.wait_for_model("torus")
            self.picture(*here, "--with", "torus", "--draw", "clip")

    def test_a_model_prepared_again_without_a_hull_is_drawn_without(self):
        self.prepare_shape("shape", torus(96, 48, 0.3))
        with Server(self.store) as server:
            server.wait_for_model("shape")

            def prepare_again():
                self.prepare_shape("shape", hills(20, 20))
                wait_until(lambda: not json.loads(server.get("/models")[1])[0]["has_hull"], "the model without a hull")

            # Some of the hull has come when the line is cut.
            with Proxy(server.port, 100_000, 20_000, prepare_again) as proxy:
                clipped = self.picture("--server", proxy.url, "--model", "shape", "--draw", "clip")
                self.assertEqual(len(proxy.received), 2, "the line was cut")
            self.assertEqual(clipped, self.picture("--server", server.url, "--model", "shape", "--draw", "shaded"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
