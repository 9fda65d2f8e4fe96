# SPDX-License-Identifier: Apache-2.0
"""Writes silhouette_sweep.md and its plots beside this file: every detector along the 400-frame circle of M. Mohr's
thesis (Silhouette Rendering on Mobile Devices, Graz 2013, chapter 5), on meshes like the thesis's, beside its findings.
  LIMN_BIN=build/release/bin LIMN_MODELS=../shared/models python3 tests/bench/sweep_page.py [FOLDER]"""

import csv
import math
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
MESHES = ("torus-2304.off", "torus-4608.ply", "torus-8192.ply", "bunny-low.off")
LARGE = "turbine-blade.ply"
KNOT = "rough-knot-400k"
# Pictures of large meshes in software GL take minutes, and say nothing new.
ALL_BUT_IMAGE = "brute,cones,exact,random,coherence-a,coherence-b,precomputed"
FINDINGS = """
| the thesis (2013, Java, 1,589 to 21,334 faces) | here |
|---|---|
| Brute force is the ground truth, and slowest on the tablet. | It is still the truth. With vector instructions it is faster than every seeded method but Coherence A: what random, Coherence B and precomputed seeds save in faces they lose in jumps. |
| Random (10 % of the faces) finds nearly all, at a time that depends little on the mesh. | It finds nearly all of smooth shapes; on scans it misses small loops. Its time grows with the mesh. |
| Coherence A is always fastest, and loses edges until the next reseeding (every 30 frames). | Confirmed, saw teeth included: see the plot of recall. Of the thesis's methods it is the fastest, and the only one faster than brute force. |
| Coherence B behaves like precomputed. | Confirmed; new loops wait for the next reseeding. |
| Precomputed (8 x 5 viewpoints) is nearly complete, and scales best. | Nearly complete now that it follows the camera's motion, too; it does not scale better than the others. |
| Image-based seeds are far slower than brute force, by their read-back, and find no hidden silhouettes. | Confirmed: software GL makes the pictures slower still. |
"""
THESIS = ("random", "coherence-a", "coherence-b", "image", "precomputed")


def write_knot(path, segments=2500, sides=80, roughness=0.002):
    """A (2,3) torus knot whose vertices are a little off, 400,000 faces: tests/corpus/torus_knots."""
    def curve(t):
        r = 2 + math.cos(3 * t)
        return (r * math.cos(2 * t), r * math.sin(2 * t), math.sin(3 * t))

    def unit(v):
        return [c / math.hypot(*v) for c in v]

    def cross(u, v):
        return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])

    noise = random.Random(1)
    with open(path, "w") as out:
        for i in range(segments):
            t = 2 * math.pi * i / segments
            center = curve(t)
            tangent = unit([a - b for a, b in zip(curve(t + 1e-4), curve(t - 1e-4))])
            side = unit(cross(tangent, center))
            outward = cross(side, tangent)
            for j in range(sides):
                a = 2 * math.pi * j / sides
                radius = 0.35 * (1 + roughness * noise.uniform(-1, 1))
                out.write("v %.7f %.7f %.7f\n" % tuple(
                    c + radius * (math.cos(a) * o - math.sin(a) * s) for c, o, s in zip(center, outward, side)))
        for i in range(segments):
            for j in range(sides):
                here, right = i * sides + j + 1, (i + 1) % segments * sides + j + 1
                up, across = i * sides + (j + 1) % sides + 1, (i + 1) % segments * sides + (j + 1) % sides + 1
                out.write("f %d %d %d\nf %d %d %d\n" % (here, right, across, here, across, up))
    return path


def median_ms(frames):
    return statistics.median(float(f["detect_ms"]) for f in frames)


def mean_recall(frames):
    return 100 * statistics.mean(float(f["recall"]) for f in frames)


def span(values, form):
    return (form + " to " + form) % (min(values), max(values))


def beside_exact(series):
    """What `exact` costs beside brute force, beside the thesis's cheapest detector, and its cheapest complete one."""
    brute, cheapest, recalls, complete = [], [], [], []
    for found in series.values():
        ours = median_ms(found["exact"])
        thesis = {d: found[d] for d in THESIS if d in found}
        first = min(thesis, key=lambda d: median_ms(thesis[d]))
        brute.append(median_ms(found["brute"]) / ours)
        cheapest.append(median_ms(thesis[first]) / ours)
        recalls.append(mean_recall(thesis[first]))
        complete += [median_ms(f) / ours for f in thesis.values() if min(float(row["recall"]) for row in f) == 1.0]
    return ("| (not in the thesis) | `cones` and `exact` find everything. `exact` is %s times as fast as brute force, and %s "
            "times as fast as the cheapest of the thesis's detectors, which finds %s %% of the segments; where one of them "
            "finds all (the tori), `exact` is %s times as fast as it. To be sure of all, on any mesh, they would have to start "
            "afresh by brute force in every frame. |\n" %
            (span(brute, "%.1f"), span(cheapest, "%.1f"), span(recalls, "%.0f"), span(complete, "%.0f")))


def main(folder):
    models = pathlib.Path(os.environ.get("LIMN_MODELS", HERE.parents[2] / "shared" / "models"))
    client = pathlib.Path(os.environ.get("LIMN_BIN", "build/release/bin")) / "limn-client"
    meshes = [models / m for m in MESHES if (models / m).is_file()]
    if not meshes:
        sys.exit("sweep_page.py: no meshes: set LIMN_MODELS to a folder with some of " + ", ".join(MESHES))
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    with tempfile.TemporaryDirectory(prefix="limn-sweep-") as scratch:
        scratch = pathlib.Path(scratch)
        large = [models / LARGE] if (models / LARGE).is_file() else []
        large.append(write_knot(scratch / (KNOT + ".obj")))
        for some, detectors, plot in ((meshes, "all", "silhouette_sweep.svg"),
                                      (large, ALL_BUT_IMAGE, "silhouette_sweep_large.svg")):
            command = [client, "sweep", "--frames", "400", "--detectors", detectors, "--size", "128x128", "--csv",
                       scratch / "sweep.csv", "--plot", folder / plot]
            for mesh in some:
                command += ["--mesh", mesh]
            subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL)
            rows += csv.DictReader(open(scratch / "sweep.csv"))
    series = {}
    for row in rows:
        series.setdefault((row["mesh"], int(row["faces"])), {}).setdefault(row["detector"], []).append(row)
    lines = ["# Detectors along a circle of 400 frames", "",
             "Written by `python3 tests/bench/sweep_page.py`; one core of a machine that did nothing else, one sweep. Smooth",
             "silhouettes, parameters as in the thesis. Time: median ms a frame (image: a picture of 128 x 128). Recall: mean /",
             "worst frame, in % of the segments that brute force finds. The thesis's own scans are not public; the tori are like",
             "its own, the blade and the knot ten and twenty times its largest.", "",
             "The plots are in silhouette_sweep.svg and silhouette_sweep_large.svg, written beside this page by the same",
             "command.", ""]
    detectors = list(dict.fromkeys(row["detector"] for row in rows))
    lines += ["| mesh, faces | " + " | ".join(detectors) + " |", "|---" * (len(detectors) + 1) + "|"]
    for (mesh, faces), found in series.items():
        cells = []
        for detector in detectors:
            frames = found.get(detector)
            if not frames:
                cells.append("-")
                continue
            recall = [100 * float(f["recall"]) for f in frames]
            cells.append("%.3g ms, %.1f / %.1f" % (median_ms(frames), mean_recall(frames), min(recall)))
        lines.append("| %s, %s | %s |" % (mesh, format(faces, ","), " | ".join(cells)))
    lines += ["", "## Beside the thesis's findings", FINDINGS + beside_exact(series)]
    (folder / "silhouette_sweep.md").write_text("\n".join(lines))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else HERE)
