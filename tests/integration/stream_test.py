# SPDX-License-Identifier: Apache-2.0
"""What a client holds after a stream is what was prepared, whatever the order it came in."""

import collections
import json
import os
import unittest

from harness import Case, Server, models, run
from meshes import Mesh, canonical, hills, manifold_fault, pair, read_ply, torus, write_painted, write_two_materials

SHAPES = {"torus": torus(48, 24), "bumpy": torus(96, 48, 0.3), "hills": hills(40, 30), "pair": pair()}
CAMERAS = ["orbit:0,0", "orbit:130,40,1.5", "orbit:250,-75,8"]
# Real models up to this size; LIMN_MAX_MODEL_BYTES raises it to all of them (a release build's matter).
MAX_MODEL_BYTES = int(os.environ.get("LIMN_MAX_MODEL_BYTES", "150000" if "LIMN_SANITIZED" in os.environ else "450000"))


class Stream(Case):

    def test_complete_is_the_prepared_mesh_from_every_camera(self):
        wanted = {name: self.prepare_shape(name, shape)[1] for name, shape in SHAPES.items()}
        with Server(self.store) as server:
            for name in SHAPES:
                for camera in CAMERAS:
                    report, mesh = self.draw(server.url, name, "--until", "complete", "--camera", camera)
                    self.assertEqual(report["state"], "complete")
                    self.assertEqual(report["mesh"]["splits_held"], report["mesh"]["splits_total"])
                    self.assert_same_mesh(mesh, wanted[name], "%s from %s" % (name, camera))

    def test_complete_is_the_prepared_mesh_in_random_legal_order(self):
        wanted = {name: self.prepare_shape(name, shape)[1] for name, shape in SHAPES.items()}
        for seed in (1, 2, 3):
            with Server(self.store, "--random-order", seed) as server:
                for name in SHAPES:
                    _, mesh = self.draw(server.url, name, "--until", "complete")
                    self.assert_same_mesh(mesh, wanted[name], "%s, seed %d" % (name, seed))

    def test_vertices_that_move_end_where_they_were_prepared(self):
        placed = ("--placement", "volume")
        report, hills = self.prepare_shape("hills", SHAPES["hills"], *placed)
        self.assertEqual(report["placement"], "volume")
        _, painted = self.prepare(write_painted(self.folder / "painted.ply", SHAPES["bumpy"]), "painted", *placed)
        vertices = lambda mesh: collections.Counter(zip(mesh.positions, mesh.attributes))
        with Server(self.store) as server:
            for until in ("settled", "exact"):
                _, mesh = self.draw(server.url, "painted", "--until", until, "--silhouette", "edges")
                self.assert_manifold(mesh, until)
            _, mesh = self.draw(server.url, "hills", "--until", "complete")
            self.assert_same_mesh(mesh, hills, "hills")
        with Server(self.store, "--random-order", 4) as server:
            _, mesh = self.draw(server.url, "painted", "--until", "complete")
            self.assert_same_mesh(mesh, painted, "painted")
            self.assertEqual(vertices(mesh), vertices(painted))

    def test_colours_and_normals_arrive_as_they_were_prepared(self):
        vertices = lambda mesh: collections.Counter(zip(mesh.positions, mesh.attributes))
        report, wanted = self.prepare(write_painted(self.folder / "painted.ply", SHAPES["bumpy"]), "painted")
        self.assertTrue(report["mesh"]["colors"] and report["mesh"]["normals"])
        self.assertGreater(report["bytes"]["attributes"], 0)
        self.assertEqual(len(wanted.attributes[0]), 6)
        with Server(self.store) as server:
            _, mesh = self.draw(server.url, "painted", "--until", "complete")
            self.assert_same_mesh(mesh, wanted, "painted")
            self.assertEqual(vertices(mesh), vertices(wanted))
            known = dict(zip(wanted.positions, wanted.attributes))
            _, mesh = self.draw(server.url, "painted", "--until", "settled")
            for position, attributes in zip(mesh.positions, mesh.attributes):
                self.assertEqual(known[position], attributes, "a coarse vertex is as it will stay")
        with Server(self.store, "--random-order", 5) as server:
            _, mesh = self.draw(server.url, "painted", "--until", "complete")
            self.assertEqual(vertices(mesh), vertices(wanted))

    def test_seams_between_materials_are_streamed_and_drawn(self):
        report, _ = self.prepare(write_two_materials(self.folder / "two.ply", SHAPES["torus"]), "two")
        self.assertEqual(report["mesh"]["seams"], 48, "two rings of the torus, 24 edges each")
        lines = self.folder / "lines.json"
        with Server(self.store) as server:
            for features, kinds in (("seam", {"seam"}), ("crease,border", set())):
                self.draw(server.url, "two", "--until", "complete", "--features", features, "--dump-lines", lines)
                drawn = json.loads(lines.read_text())["lines"]
                self.assertEqual({line["kind"] for line in drawn} - {"silhouette"}, kinds)
                if kinds:
                    seams = [line for line in drawn if line["kind"] == "seam"]
                    self.assertEqual([(line["closed"], len(line["points"])) for line in seams], [(True, 24)] * 2)

    def test_every_state_on_the_way_is_a_manifold(self):
        sizes = {name: self.prepare_shape(name, shape)[0]["bytes"] for name, shape in SHAPES.items()}
        with Server(self.store) as server:
            for name, size in sizes.items():
                faces = []
                # What is sent beside base and splits (the model's description, frames) is about a kilobyte.
                some = [size["base"] + 1500 + size["splits"] * part // 10 for part in (2, 5, 8)]
                for until in ("base", *("bytes:%d" % n for n in some), "settled", "exact"):
                    _, mesh = self.draw(server.url, name, "--until", until)
                    self.assert_manifold(mesh, "%s until %s" % (name, until))
                    faces.append(len(mesh.faces))
                self.assertLess(faces[0], len(SHAPES[name][1]), "the base mesh of %s is coarser" % name)

    def test_parts_of_the_bytes_add_up_to_what_was_received(self):
        self.prepare_shape("torus", SHAPES["torus"])
        with Server(self.store) as server:
            for until in ("base", "settled", "complete"):
                received = dict(self.draw(server.url, "torus", "--until", until)[0]["bytes"])
                whole = received.pop("received")
                self.assertEqual(sum(received.values()), whole, until)

    def test_asset_without_a_server_gives_the_same_mesh(self):
        report, wanted = self.prepare_shape("torus", SHAPES["torus"])
        dump = self.folder / "asset.ply"
        run("limn-client", "render", "--asset", self.store / "assets" / report["asset"], "--until", "complete",
            "--size", "64x64", "--dump-mesh", dump)
        self.assert_same_mesh(read_ply(dump), wanted, "from the asset")

    def test_real_models_stream_completely(self):
        folder = models()
        if folder is None:
            self.skipTest("no real models: set LIMN_MODELS to a folder of meshes")
        files = sorted((f for f in folder.iterdir() if f.suffix in (".ply", ".obj", ".stl", ".off", ".glb")
                        and f.stat().st_size <= MAX_MODEL_BYTES), key=lambda f: f.stat().st_size)
        self.assertTrue(files)
        wanted = {f.name: self.prepare(f, f.name)[1] for f in files}
        with Server(self.store) as server, Server(self.store, "--random-order", 7) as shuffled:
            for index, name in enumerate(wanted):
                camera = CAMERAS[index % len(CAMERAS)]
                for host in (server, shuffled):
                    _, mesh = self.draw(host.url, name, "--until", "complete", "--camera", camera)
                    self.assert_same_mesh(mesh, wanted[name], name)
                self.assert_manifold(self.draw(server.url, name, "--until", "settled", "--camera", camera)[1], name)


class Oracle(unittest.TestCase):
    """The checks above can fail."""

    def test_canonical_form_ignores_numbering_and_nothing_else(self):
        mesh = Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2), (0, 2, 3)])
        renumbered = Mesh([(0, 0, 1), (0, 1, 0), (0, 0, 0), (1, 0, 0)], [(1, 0, 2), (3, 1, 2)])
        flipped = Mesh(mesh.positions, [(0, 2, 1), (0, 2, 3)])
        moved = Mesh([(0, 0, 0), (2, 0, 0), (0, 1, 0), (0, 0, 1)], mesh.faces)
        self.assertEqual(canonical(mesh), canonical(renumbered))
        self.assertNotEqual(canonical(mesh), canonical(flipped))
        self.assertNotEqual(canonical(mesh), canonical(moved))

    def test_manifold_check_names_faults(self):
        points = [(i, i * i, 0) for i in range(8)]
        self.assertIsNone(manifold_fault(Mesh(points, [(0, 1, 2), (0, 2, 3)])))
        self.assertIsNone(manifold_fault(Mesh(points, [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)])))
        self.assertIsNotNone(manifold_fault(Mesh(points, [(0, 1, 2), (0, 1, 3)])))
        self.assertIsNotNone(manifold_fault(Mesh(points, [(0, 1, 2), (0, 3, 4)])))
        self.assertIsNotNone(manifold_fault(Mesh(points, [(0, 1, 1)])))
        closed = [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)]
        touching = closed + [(0, 4, 5), (0, 5, 6), (0, 6, 4), (4, 6, 5)]
        self.assertIsNotNone(manifold_fault(Mesh(points, touching)))


if __name__ == "__main__":
    unittest.main(verbosity=2)
