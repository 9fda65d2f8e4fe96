# SPDX-License-Identifier: Apache-2.0
"""`limn-client sweep`: every detector along a circle of cameras, as a table, a CSV file and a plot."""

import csv
import unittest
import xml.etree.ElementTree

from harness import Case, run
from meshes import torus, write_obj

COLUMNS = ["mesh", "faces", "detector", "frame", "detect_ms", "segments", "recall", "faces_visited"]
COMPLETE = ("brute", "cones", "exact")
DETECTORS = COMPLETE + ("random", "coherence-a", "coherence-b", "image", "precomputed")
FRAMES = 12


class Sweep(Case):

    def sweep(self, *arguments):
        """Standard output, the rows of the CSV file and the root of the plot."""
        mesh = write_obj(self.folder / "ring.obj", torus(32, 16, 0.2))
        table, plot = self.folder / "sweep.csv", self.folder / "sweep.svg"
        out = run("limn-client", "sweep", "--mesh", mesh, "--frames", FRAMES, "--size", "64x64", "--gl", "osmesa",
                  "--csv", table, "--plot", plot, *arguments)
        with open(table, newline="") as lines:
            reader = csv.DictReader(lines)
            rows = list(reader)
        self.assertEqual(reader.fieldnames, COLUMNS)
        return out, rows, xml.etree.ElementTree.parse(plot).getroot()

    def test_has_a_row_for_every_detector_and_frame(self):
        for kind in ("edges", "smooth"):
            out, rows, _ = self.sweep("--detectors", "all", "--silhouette", kind)
            self.assertEqual([(r["detector"], int(r["frame"])) for r in rows],
                             [(d, f) for d in DETECTORS for f in range(FRAMES)])
            truth = {r["frame"]: int(r["segments"]) for r in rows if r["detector"] == "brute"}
            self.assertTrue(all(truth.values()))
            for row in rows:
                self.assertEqual((row["mesh"], int(row["faces"])), ("ring", 1024))
                self.assertGreaterEqual(float(row["detect_ms"]), 0)
                recall = int(row["segments"]) / truth[row["frame"]]
                self.assertAlmostEqual(float(row["recall"]), recall, places=5)
                self.assertLessEqual(recall, 1)
                if row["detector"] in COMPLETE:
                    self.assertEqual(recall, 1, row)
            for detector in DETECTORS:
                self.assertIn(detector, out)

    def test_the_plot_is_well_formed_and_names_what_was_asked_for(self):
        _, rows, root = self.sweep("--detectors", "exact,coherence-b")
        self.assertEqual({r["detector"] for r in rows}, {"exact", "coherence-b"})
        self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
        text = " ".join(root.itertext())
        for word in ("exact", "coherence-b", "ring"):
            self.assertIn(word, text)
        lines = [e for e in root.iter() if e.tag.endswith(("polyline", "path"))]
        self.assertTrue(lines)


if __name__ == "__main__":
    unittest.main()
