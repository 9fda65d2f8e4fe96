# SPDX-License-Identifier: Apache-2.0
"""`limn-client render --svg`: a document that other programs read, in layers, whose lines are the picture's."""

import re
import shutil
import struct
import subprocess
import unittest
import xml.etree.ElementTree
import zlib

from harness import Case, hills, run, torus, write_obj

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


def read_png(path):
    """Rows of brightness, 0 to 255, of an 8-bit RGB or RGBA picture."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack_from(">IIBB", body)
            assert depth == 8 and colour in (2, 6)
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    step = 3 if colour == 2 else 4
    raw, above, rows = zlib.decompress(packed), bytes(width * step), []
    for y in range(height):
        begin = y * (width * step + 1)
        kind, row = raw[begin], bytearray(raw[begin + 1:begin + 1 + width * step])
        for i in range(len(row)):
            left = row[i - step] if i >= step else 0
            corner = above[i - step] if i >= step else 0
            if kind == 1:
                row[i] = (row[i] + left) & 255
            elif kind == 2:
                row[i] = (row[i] + above[i]) & 255
            elif kind == 3:
                row[i] = (row[i] + (left + above[i]) // 2) & 255
            elif kind == 4:
                p = left + above[i] - corner
                near = min((abs(p - left), 0, left), (abs(p - above[i]), 1, above[i]), (abs(p - corner), 2, corner))
                row[i] = (row[i] + near[2]) & 255
        above = bytes(row)
        rows.append([(above[i] + above[i + 1] + above[i + 2]) // 3 for i in range(0, len(above), step)])
    return rows


def inked(rows):
    return {(x, y) for y, row in enumerate(rows) for x, value in enumerate(row) if value < 128}


def share_near(ours, theirs, reach):
    """Of our pixels, how many have one of theirs within so many pixels."""
    near = {(x + dx, y + dy) for x, y in theirs for dx in range(-reach, reach + 1) for dy in range(-reach, reach + 1)}
    return sum(p in near for p in ours) / len(ours)


class Svg(Case):

    def render(self, shape, *arguments):
        mesh = write_obj(self.folder / "shape.obj", shape)
        svg, png = self.folder / "drawing.svg", self.folder / "picture.png"
        run("limn-client", "render", "--mesh", mesh, "--camera", "orbit:40,25", "--size", "%dx%d" % (SIZE, SIZE), "--style",
            "ink", "--gl", "osmesa", "--svg", svg, "--out", png, *arguments)
        return svg, png

    def test_is_a_document_in_layers_of_closed_and_open_paths(self):
        svg, _ = self.render(torus(96, 48, 0.3))
        root = xml.etree.ElementTree.parse(svg).getroot()
        self.assertEqual(root.tag, SVG + "svg")
        self.assertEqual(root.get("viewBox"), "0 0 %d %d" % (SIZE, SIZE))
        self.assertEqual(root.find(SVG + "title").text, "shape")
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
        run("limn-client", "render", "--mesh", mesh, "--svg", svg, "--style", "no-such-style", expect=2)

    def test_rasterised_it_is_the_picture(self):
        if not shutil.which("rsvg-convert"):
            self.skipTest("no rsvg-convert: install librsvg2-bin")
        for shape in (torus(96, 48, 0.3), hills(40, 30)):
            for kind in ("smooth", "edges"):
                svg, png = self.render(shape, "--hidden", "off", "--silhouette", kind)
                raster = self.folder / "raster.png"
                subprocess.run(["rsvg-convert", str(svg), "-o", str(raster)], check=True)
                ours, theirs = inked(read_png(raster)), inked(read_png(png))
                self.assertGreater(len(theirs), 500)
                self.assertGreater(share_near(ours, theirs, 1), 0.99, kind)
                self.assertGreater(share_near(theirs, ours, 1), 0.99, kind)


if __name__ == "__main__":
    unittest.main(verbosity=2)
