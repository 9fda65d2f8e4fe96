# SPDX-License-Identifier: Apache-2.0
"""`limn-client render --svg`: a document that other programs read, in layers, whose lines are the picture's."""

import pathlib
import re
import shutil
import subprocess
import sys
import unittest
import xml.etree.ElementTree

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import png
from harness import Case, run
from meshes import hills, torus, write_obj

SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
LENGTHS = {"M": 2, "l": 2, "c": 6, "z": 0}
SIZE = 512


def commands(data):
    """A path's commands as (letter, numbers); anything that is not such a path is an error."""
    out = []
    for letter, numbers in re.findall(r"([A-Za-z])([^A-Za-z]*)", data):
        values = [float(n) for n in re.findall(r"[-+]?(?:\d+\.?\d*|\.\d+)", numbers)]
        length = LENGTHS[letter]
        assert len(values) % length == 0 if length else not values, data
        out.append((letter, values))
    assert out and out[0][0] == "M" and len(out[0][1]) == 2, data
    return out


def inked(path):
    _, _, rows = png.read(path)
    rows = png.brightness(rows)
    return {(x, y) for y, row in enumerate(rows) for x, value in enumerate(row) if value < 128}


def share_near(ours, theirs, reach):
    """Of our pixels, how many have one of theirs within so many pixels."""
    near = {(x + dx, y + dy) for x, y in theirs for dx in range(-reach, reach + 1) for dy in range(-reach, reach + 1)}
    return sum(p in near for p in ours) / len(ours)


class Svg(Case):

    def render(self, shape, *arguments, style="ink"):
        asset = self.store / "assets" / self.prepare_shape("shape", shape)[0]["asset"]
        svg, picture = self.folder / "drawing.svg", self.folder / "picture.png"
        run("limn-client", "render", "--asset", asset, "--camera", "orbit:40,25", "--size", "%dx%d" % (SIZE, SIZE), "--style",
            style, "--gl", "osmesa", "--svg", svg, "--out", picture, *arguments)
        return svg, picture

    def test_is_a_document_in_layers_of_closed_and_open_paths(self):
        svg, _ = self.render(torus(96, 48, 0.3))
        root = xml.etree.ElementTree.parse(svg).getroot()
        self.assertEqual(root.tag, SVG + "svg")
        self.assertEqual(root.get("viewBox"), "0 0 %d %d" % (SIZE, SIZE))
        layers = {g.get(INKSCAPE + "label"): g for g in root.findall(SVG + "g")}
        self.assertTrue(all(g.get(INKSCAPE + "groupmode") == "layer" for g in layers.values()))
        for name in ("Paper", "Silhouettes, visible", "Silhouettes, hidden"):
            self.assertIn(name, layers)
        self.assertIsNone(layers["Silhouettes, visible"].get("stroke-dasharray"))
        self.assertIsNotNone(layers["Silhouettes, hidden"].get("stroke-dasharray"))
        count = 0
        for path in root.iter(SVG + "path"):
            letters = [letter for letter, _ in commands(path.get("d"))]
            self.assertEqual(letters.count("M"), 1)
            self.assertLessEqual(letters.count("z"), 1)
            count += 1
        self.assertGreater(count, 3)

    def test_hidden_lines_are_off_or_as_visible_when_asked(self):
        off, _ = self.render(torus(96, 48, 0.3), "--hidden", "off")
        self.assertNotIn("hidden", off.read_text())
        same, _ = self.render(torus(96, 48, 0.3), "--hidden", "as-visible")
        self.assertIn("Silhouettes, hidden", same.read_text())
        self.assertNotIn("stroke-dasharray", same.read_text())

    def test_a_vector_file_needs_no_picture(self):
        mesh = write_obj(self.folder / "shape.obj", hills(20, 20))
        svg = self.folder / "f%02d.svg"
        run("limn-client", "render", "--mesh", mesh, "--path", "orbit", "--frames", "3", "--svg", svg)
        self.assertEqual(len(list(self.folder.glob("f0?.svg"))), 3)
        root = xml.etree.ElementTree.parse(self.folder / "f00.svg").getroot()
        self.assertEqual(root.find(SVG + "title").text, "shape")
        run("limn-client", "render", "--mesh", mesh, "--svg", svg, "--style", "no-such-style", expect=2)

    def test_rasterised_it_is_the_picture(self):
        if not shutil.which("rsvg-convert"):
            self.skipTest("no rsvg-convert: install librsvg2-bin")
        for shape in (torus(96, 48, 0.3), hills(40, 30)):
            for kind in ("smooth", "edges"):
                svg, picture = self.render(shape, "--hidden", "off", "--silhouette", kind)
                raster = self.folder / "raster.png"
                subprocess.run(["rsvg-convert", str(svg), "-o", str(raster)], check=True)
                ours, theirs = inked(raster), inked(picture)
                self.assertGreater(len(theirs), 500)
                self.assertGreater(share_near(ours, theirs, 1), 0.99, kind)
                self.assertGreater(share_near(theirs, ours, 1), 0.99, kind)

    def test_dashes_lie_where_the_pictures_do(self):
        if not shutil.which("rsvg-convert"):
            self.skipTest("no rsvg-convert: install librsvg2-bin")
        svg, picture = self.render(torus(96, 48, 0.3), style="technical")
        self.assertIn("stroke-dashoffset", svg.read_text())
        raster = self.folder / "raster.png"
        subprocess.run(["rsvg-convert", str(svg), "-o", str(raster)], check=True)
        ours, theirs = inked(raster), inked(picture)
        self.assertGreater(share_near(ours, theirs, 1), 0.98)
        self.assertGreater(share_near(theirs, ours, 1), 0.98)


if __name__ == "__main__":
    unittest.main(verbosity=2)
