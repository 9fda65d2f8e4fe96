# SPDX-License-Identifier: Apache-2.0
"""The table of tests/bench/run.sh. References are measured in the same run, by the tool the row names, or quoted with
their source. Times are wall clock of a release build; run on a quiet machine."""

import argparse
import json
import math
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "integration"))
import harness  # noqa: E402
import meshes  # noqa: E402
import slow_link  # noqa: E402

harness.DEADLINE_S = 1800  # of one program: the largest meshes on a busy machine

GROUPS = ("stream", "simplify", "hull", "silhouette", "visibility", "clip", "draw", "link", "server")
# Bytes until settled and exact (edges) over one Draco mesh of the same 12-bit grid.
SELECTION_TARGETS = {
    "bunny-closed": {"settled": 0.10, "exact": 0.60},
    "horse": {"settled": 0.10, "exact": 0.60},
    "turbine-blade": {"settled": 0.10, "exact": 0.45},
    "dragon": {"settled": 0.08, "exact": 0.70},
}
# Outer hull volume over mesh volume at so many faces, target, and libigl 2.4's progressive_hulls at its best (mean edge
# scaled to 1): measured once on these files, with its quadratic program and one core; see server/preprocess/README.md.
HULL_TARGETS = {"bunny-closed": (500, 1.09, 1.120), "torus-knot": (1000, 1.11, 1.130), "rocker-arm": (1000, 1.05, 1.060)}
# Frame times over those of the shaded frame in papers/000, section 5: Venus, 5,672 faces (66 frames a second shaded, 40, 50
# and 11.5), and the face of 13,408 (30 and 5). Its other ways have no times.
DRAW_COSTS = {"wireframe": 66 / 40, "z-scale": 66 / 50, "fatten": 66 / 11.5, "charcoal": 30 / 5}
# papers/003, table 1: times faster than drawing the original.
CLIPPED = {"bunny-closed": 4.4, "dragon": 4.1, "torus-knot": 7.9, "three-torus": 16.4}
# papers/003, table 2, of its models next to ours: edges and nodes tested, and times faster than brute force.
CONE_FORESTS = {"bunny-closed": (10256, 4282, 5.0), "dragon": (67934, 26291, 4.2), "torus-knot": (13134, 7926, 7.9),
                "three-torus": (5976, 4594, 15.6)}
LIBIGL = "libigl progressive_hulls, quoted"
EXTENSIONS = {".ply", ".obj", ".stl", ".off", ".glb", ".gltf"}


class Table:

    def __init__(self):
        self.rows = []

    def add(self, row, mesh, ours, reference=None, target=None, unit="", quoted=None, better="lower"):
        """target: an upper bound on ours / reference, or on ours where there is no reference."""
        ratio = ours / reference if reference else None
        judged = ratio if reference else ours
        met = None if target is None else (judged <= target if better == "lower" else judged >= target)
        entry = {"row": row, "mesh": mesh, "ours": ours, "reference": reference, "ratio": ratio, "target": target,
                 "met": met, "unit": unit, "source": quoted}
        self.rows.append(entry)
        print("%-36s %-22s %12s %12s %8s %8s  %s" % (
            row, mesh[:22], number(ours, unit), number(reference, unit), "" if ratio is None else "%.3f" % ratio,
            "" if target is None else ("%g" % target), {None: "", True: "met", False: "NOT MET"}[met]), flush=True)

    def head(self):
        print("%-36s %-22s %12s %12s %8s %8s  %s" % ("row", "mesh", "ours", "reference", "ratio", "target", "met"))


def number(value, unit):
    if value is None:
        return "-"
    return ("%d" % value if isinstance(value, int) or value >= 1000 else "%.3g" % value) + (" " + unit if unit else "")


def draco_bytes(dump, bits, folder):
    """Size of one Draco mesh of the same quantised positions and faces: draco_encoder -cl 7 -qp bits. Its grid is the
    longest side divided by 2^bits - 1, as ours, so integer positions stay what they are."""
    mesh = meshes.read_ply(dump)
    plain, packed = folder / "draco.ply", folder / "draco.drc"
    with open(plain, "wb") as out:
        out.write(("ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
                   "property float z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n"
                   % (len(mesh.positions), len(mesh.faces))).encode())
        out.write(b"".join(struct.pack("<3f", *p) for p in mesh.positions))
        out.write(b"".join(struct.pack("<B3i", 3, *f) for f in mesh.faces))
    subprocess.run(["draco_encoder", "-cl", "7", "-qp", str(bits), "-i", str(plain), "-o", str(packed)], check=True,
                   stdout=subprocess.DEVNULL)
    return packed.stat().st_size


class Bench:

    def __init__(self, models, quick, folder):
        self.folder, self.store, self.quick = folder, folder / "store", quick
        self.files = self.find(models)
        self.reports, self.draco = {}, {}
        self.table = Table()

    def find(self, models):
        if models is None:
            named = harness.models()
            if named is None:
                made = {"torus": meshes.torus(96, 48), "bumpy": meshes.torus(256, 128, 0.3), "hills": meshes.hills(100, 80)}
                return {n: meshes.write_obj(self.folder / (n + ".obj"), shape) for n, shape in made.items()}
            models = named
        files = sorted((f for f in models.iterdir() if f.suffix.lower() in EXTENSIONS), key=lambda f: f.stat().st_size)
        if self.quick:
            files = [f for f in files if f.stat().st_size > 200_000][:3]
        if not files:
            sys.exit("run.sh: no meshes in %s" % models)
        # Two files of one stem keep their whole names apart.
        stems = [f.stem for f in files]
        return {(f.stem if stems.count(f.stem) == 1 else f.name): f for f in files}

    def prepare(self, name, bits=None):
        """The report of limn-prepare for a mesh, once a run; on a grid of `bits` under its name and -bits."""
        key = name if bits is None else "%s-%d" % (name, bits)
        if key not in self.reports:
            dump = self.folder / "dump.ply"
            grid = [] if bits is None else ["--quantization", str(bits)]
            report = json.loads(harness.run("limn-prepare", self.files[name], "--store", self.store, "--name", key,
                                            *grid, "--dump-mesh", dump, "--json"))
            self.reports[key] = report[0] if isinstance(report, list) else report
            if shutil.which("draco_encoder"):
                self.draco[key] = draco_bytes(dump, self.reports[key]["quantization_bits"], self.folder)
        return self.reports[key]

    def draw(self, *arguments):
        report = self.folder / "report.json"
        harness.run("limn-client", "render", *arguments, "--report", report)
        return json.loads(report.read_text())

    # ---- Groups

    def stream(self):
        """Wire bytes against one Draco mesh of the same grid. Targets: whole stream 1.5 x each, 1.25 x in the geometric
        mean at 12 bits and 1.2 x at 14, of the four meshes the targets name; 2,500 triangles; splits a second on one
        core; exact from one cold view: less than the whole Draco mesh on turbine-blade."""
        named = [n for n in ("bunny-closed", "horse", "turbine-blade", "dragon") if n in self.files] or list(self.files)
        for bits, mean in ((12, 1.25), (14, 1.2)):
            ratios = []
            for name in named:
                report = self.prepare(name, bits)
                size = report["bytes"]
                whole = size["base"] + size["level_blocks"] + size["splits"]
                draco = self.draco.get("%s-%d" % (name, bits))
                self.table.add("stream, complete, %d bit" % bits, name, whole, draco, 1.5, "B")
                ratios += [whole / draco] if draco else []
                # In level order; what is neither seeds nor features nor hulls nor splits is the model's description.
                first = size["total"] - sum(value for key, value in size.items() if key != "total")
                first -= size["features"]
                for level in report["levels"]:
                    first += level["bytes"]
                    if level["faces"] >= 2500:
                        break
                target = {"turbine-blade": 8192, "dragon": 12288}.get(name) if bits == 12 else None
                self.table.add("first 2,500 faces, %d bit" % bits, name, first, None, target, "B")
            if ratios:
                self.table.add("stream, mean ratio, %d bit" % bits, "%d meshes" % len(ratios),
                               math.exp(sum(map(math.log, ratios)) / len(ratios)), None, mean)
        for name in named:
            speed = json.loads(harness.run("limn-codec-bench", "12", self.files[name]))
            self.table.add("decode + apply, level runs", name, speed["decode_splits_per_s"], None, 1e6, "/s", better="higher")
            self.table.add("decode + apply, packets", name, speed["decode_view_splits_per_s"], None, 1e6, "/s",
                           better="higher")
            self.table.add("train + encode, faces", name, speed["encode_faces_per_s"], None, 1e5, "/s", better="higher")
            if "attribute_bits_per_split" in speed:
                self.table.add("attributes, bits a vertex", name, speed["attribute_bits_per_split"],
                               speed["draco_attribute_bits_per_vertex"], None, "bit")
        for name in self.files:
            self.prepare(name)
        with harness.Server(self.store) as server:
            for name in self.files:
                for until in ("settled", "exact"):
                    report = self.draw("--server", server.url, "--model", name, "--until", until, "--camera", "orbit:30,15",
                                       "--size", "1024x1024")
                    size = report["bytes"]
                    ours = size["received"] - size["seeds"] - size["features"]
                    target = 1 if until == "exact" and name == "turbine-blade" else None
                    self.table.add("stream, cold until %s" % until, name, ours, self.draco.get(name), target, "B")

        self.selection()

    def selection(self):
        """What a view needs, at 12 bits: sessions without a socket, from views evenly spread at 3 radii, 1024 x 1024, 1 px.
        p95: distance between the visible contours of the client and of the full mesh, by length, the worse way, worst view."""
        named = [n for n in SELECTION_TARGETS if n in self.files]
        if self.quick:
            named = [n for n in named if n != "dragon"]
        for name in named or self.files:
            targets = SELECTION_TARGETS.get(name, {})
            dump = self.folder / "dump12.ply"
            harness.run("limn-prepare", self.files[name], "--store", self.store, "--name", name + "-12", "--quantization", 12,
                        "--dump-mesh", dump)
            draco = draco_bytes(dump, 12, self.folder) if shutil.which("draco_encoder") else None
            out = json.loads(subprocess.run(
                [str(harness.BIN / "limn-selection-bench"), str(self.store), name + "-12", "--views", "4" if self.quick else "20"],
                check=True, stdout=subprocess.PIPE, text=True).stdout)
            for kind in ("edges", "smooth"):
                settled, exact = out["settled"][kind], out["exact"][kind]
                judged = targets if kind == "edges" else {}
                self.table.add("12 bits, settled, " + kind, name, settled["bytes"]["mean"], draco, judged.get("settled"), "B")
                self.table.add("  contours off, p95", name, settled["p95_px"]["max"], None, 1, "px")
                self.table.add("  search, CPU", name, settled["search_cpu_ms"]["mean"], None, None, "ms")
                self.table.add("12 bits, exact, " + kind, name, exact["bytes"]["mean"], draco, judged.get("exact"), "B")
                self.table.add("  each 5 degrees on", name, exact["turn_share"]["mean"], None, 0.15, "x")
            self.table.add("view cell, CPU", name, out["cell"]["choose_cpu_ms"]["max"], None, 50, "ms")

    def simplify(self):
        for name in self.files:
            report = self.prepare(name)
            dragon = name == "dragon"
            self.table.add("prepare, seconds", name, report["seconds"]["total"], None, 60 if dragon else None, "s")
            self.table.add("prepare, peak memory", name, report["peak_rss_mib"], None, 2048 if dragon else None, "MiB")
        if not (harness.BIN / "limn-simplify-bench").exists():
            print("limn-simplify-bench is not built: deploy/packages.sh bench, then again", file=sys.stderr)
            return
        for name in self.files:
            self.simplifiers(name)

    def simplifiers(self, name):
        """Ours at the level nearest to a tenth of the faces, 12 bits, beside OpenMesh, CGAL and meshoptimizer at as many.
        rms: both ways, 1e-5 of the diagonal. contour: mean distance of visible contours, px of 1024, 40 views.
        "placed": --placement volume. Contours at a share of Draco's bytes lie between levels."""
        views = "10" if self.quick or name == "dragon" else "40"
        rates = ["--no-rates"] if self.quick else []
        done = subprocess.run([harness.BIN / "limn-simplify-bench", self.files[name], "--shares", "0.1", "--views", views, *rates],
                              check=True, stdout=subprocess.PIPE, text=True, timeout=1800)
        rows = [json.loads(line) for line in done.stdout.splitlines()]
        for row in rows:
            row["method"] = row["method"].replace("cgal-", "").replace("openmesh-", "").replace("meshopt-simplify", "meshopt")
        errors = {row["method"]: row for row in rows if row["kind"] == "errors"}
        streams = {row["method"]: row for row in rows if row["kind"] == "stream"}
        judge = errors["modquadric"]
        for method, row in errors.items():
            isDefault = method == "memoryless"
            self.table.add("10%% rms, %s" % method, name, row["rms"], None if row is judge else judge["rms"],
                           1.2 if isDefault else None)
            for key in ("mean", "max", "contour_mean"):
                self.table.add("10%% %s, %s" % (key.replace("_", " "), method), name, row[key],
                               None if row is judge else judge[key])
            self.table.add("10%% volume, %s" % method, name, 100 * row["volume"], None, None, "%")
            if "faces_per_second" in row:
                self.table.add("faces a second, %s" % method, name, row["faces_per_second"])
        for method, row in streams.items():
            isDefault = method == "memoryless"
            self.table.add("10%% bytes to Draco, %s" % method, name, errors[method]["draco_ratio"], None,
                           1.25 if isDefault else None)
            self.table.add("faces a second, %s" % method, name, row["faces_per_second"], None,
                           100_000 if isDefault else None, better="higher")
            self.table.add("exact to Draco, %s" % method, name, row["exact_ratio"])
            self.table.add("stream to Draco, %s" % method, name, row["draco_ratio"])
        for row in rows:
            for key in (key for key in row if key.startswith("contour_at_")):
                self.table.add("contour at %s %% of Draco, %s" % (key[len("contour_at_"):], row["method"]), name, row[key])

    def hull(self):
        """Both hulls: CPU seconds of one core, volumes, self-crossings, and points of the wrong side among 10^5 a level."""
        names = [n for n in HULL_TARGETS if n in self.files] or list(self.files)
        for name in names[:1] if self.quick else names:
            faces, target, libigl = HULL_TARGETS.get(name, (500, None, None))
            report = json.loads(harness.run("limn-hull-bench", self.files[name], faces, 10_000 if self.quick else 100_000))
            if "reason" in report:
                print("%s: no hull, because %s" % (name, report["reason"]))
                continue
            outer, inner, at = report["outer"], report["inner"], ", %d faces" % faces
            self.table.add("hull, outer volume", name + at, outer["volume"], None, target)
            if libigl:
                self.table.add("hull, outer volume, libigl", name + at, libigl, None, None, quoted=LIBIGL)
            self.table.add("hull, inner volume", name + at, inner["volume"])
            self.table.add("hull, levels that cross", name + at, int(outer["crosses"]) + int(inner["crosses"]), None, 0)
            self.table.add("hull, points outside", name, outer["violations"] + inner["violations"], None, 0)
            self.table.add("hulls, CPU seconds", name, report["seconds"], None, 4 if name == "bunny-closed" else None, "s")

    def silhouette(self):
        """Detection and chaining of limn-silhouette-bench (processor time, medians over random views and an orbit), and
        VTK's silhouette filter on the same files where python3-vtk9 is installed."""
        names = [n for n in ("bunny-closed", "turbine-blade", "dragon") if n in self.files]
        if names:
            os.environ["LIMN_MODELS"] = str(self.files[names[0]].parent)
        cones = {}
        # Row by row: all of it takes minutes.
        bench = subprocess.Popen([harness.BIN / "limn-silhouette-bench", *(["--quick"] if self.quick else [])],
                                 stdout=subprocess.PIPE, text=True)
        for line in bench.stdout:
            row = json.loads(line)
            mesh = row["mesh"].removesuffix(".ply")
            if row["row"] == "cones, edges":
                cones[mesh] = row["ours"]
            self.table.add("silhouette, " + row["row"], mesh, row["ours"], row["reference"] or None, row["target"] or None,
                           row["unit"])
        if bench.wait() != 0:
            raise AssertionError("limn-silhouette-bench failed")
        script = pathlib.Path(__file__).resolve().parent / "vtk_silhouette.py"
        # Debian's module is for Debian's Python, which need not be the one that runs this.
        python = "/usr/bin/python3" if os.access("/usr/bin/python3", os.X_OK) else sys.executable
        for name in names:
            if name not in cones:
                continue
            run = subprocess.run([python, str(script), str(self.files[name])], capture_output=True, text=True)
            if run.returncode:
                print("silhouette: no rows against VTK: " + (run.stderr.strip().splitlines() or ["it failed"])[-1])
                break
            self.table.add("silhouette, cones / VTK", name, cones[name], float(run.stdout), 1 / 250, "ms")

    def visibility(self):
        """Which silhouette edges are visible, resolved on the CPU: six views at 1024 x 1024, against rays of Embree's where
        the bench was built with it."""
        limits = {"bunny-closed": 20, "dragon": 500}  # ms a view
        names = [n for n in ("bunny-closed", "turbine-blade", "dragon", "gears", "fandisk") if n in self.files]
        for name in names or list(self.files)[-1:]:
            os.environ["LIMN_MODELS"] = str(self.files[name].parent)
            row = json.loads(harness.run("limn-visibility-bench", self.files[name].name))
            if "edges" in row:
                wrong = row["false_visible_percent"] + row["false_hidden_percent"]
                self.table.add("visibility, CPU, wrong", name, wrong, None, 0.5, "%")
            self.table.add("visibility, CPU, edges", name, row["edges_ms"], row.get("embree_ms"), None, "ms")
            self.table.add("visibility, CPU, smooth", name, row["smooth_ms"], None, limits.get(name), "ms")
            self.table.add("visibility, tree of rays", name, row["build_ms"], None, None, "ms")
            device = json.loads(harness.run("limn-device-visibility-bench", self.files[name].name).splitlines()[0])
            for what, target in (("visible", 2), ("hidden", 0.1)):
                wrong = device["false_%s_percent" % what]
                self.table.add("visibility, device, false " + what, name, wrong, None, target, "%")
            self.table.add("visibility, device, spans > 2 px", name, device["long_spans_percent"], None, 0, "%")

    def clip(self):
        """Exact contours, and papers/003's tables: 1, frames of the original against those of a clipped hull, in one
        process each (what the GPU is decides much: the report names it); 2, searching against brute force."""
        names = [n for n in ("bunny-closed", "torus-knot", "three-torus", "turbine-blade", "armadillo", "brain", "dragon")
                 if n in self.files]
        names = (names or list(self.files))[:1 if self.quick else 7]
        for name in names:
            row = json.loads(harness.run("limn-contour-bench", self.files[name]))
            self.table.add("contour, bytes a point", name, row["bytes_a_point"], None, 12, "B")
            at_size = 100_000 < row["faces"] <= 250_000
            self.table.add("contour, answers a second a core", name, row["answers_a_second"], None,
                           200 if at_size else None, better="higher")
            self.cone_searches(name, row)
            store = self.prepare(name)
            if "reason" in store["hull"]:
                continue
            self.clipped_frames(name)
            self.table.add("maps, bytes", name, store["bytes"]["maps"])
            self.table.add("hulls and maps, seconds", name, store["seconds"]["hull"] + store["seconds"]["maps"], None, None, "s")

    def clipped_frames(self, name):
        """papers/003's table 1, processor time of a software renderer, and the outline against the mesh's own."""
        os.environ["LIMN_MODELS"] = str(self.files[name].parent)
        views = "3" if self.quick else "12"
        row = json.loads(harness.run("limn-clip-bench", "--times", "--views", views, "--size", "1024", self.files[name].name))
        paper = CLIPPED.get(name)
        self.table.add("frame, original / clipped", name, row["original_ms"] / row["clipped_ms"], paper, 1, "x",
                       quoted="papers/003, table 1" if paper else None, better="higher")
        self.table.add("  original, 2 x 2 samples / clipped", name, row["original_2x2_ms"] / row["clipped_ms"], None, None, "x")
        for what in ("original", "original_2x2", "coarse", "clipped", "find", "project", "coverage"):
            self.table.add("  " + what.replace("_", ", "), name, row[what + "_ms"], None, None, "ms")
        row = json.loads(harness.run("limn-clip-bench", "--views", "2" if self.quick else "20", self.files[name].name))
        for whose in ("client", "server"):
            self.table.add("outline by the %s's contours: leaks" % whose, name, row[whose]["leaks"], None, 0)
            self.table.add("  holes", name, row[whose]["holes"], None, 0)
            self.table.add("  grey levels from 256 samples", name, row[whose]["rms_to_256"], None, 8)
            self.table.add("  grey levels from 16 samples", name, row[whose]["rms_to_16"], row["rms_of_16_samples"])

    def cone_searches(self, name, row):
        """papers/003's forest beside the client's tree. Both faces of every edge are the paper's brute force."""
        edges, nodes, faster = CONE_FORESTS.get(name, (None, None, None))
        paper, source = row["forest_paper"], "papers/003, table 2" if edges else None
        self.table.add("silhouette edges", name, row["silhouette_edges"])
        self.table.add("  forest as in the paper: edges tested", name, paper["planes"] / 2, edges, 1.1, quoted=source)
        self.table.add("    nodes tested", name, paper["nodes"], nodes, 1.1, quoted=source)
        self.table.add("    times faster than brute force", name, row["brute_scalar"]["ms"] / paper["ms"], faster, None, "x",
                       quoted=source, better="higher")
        brute = {"forest": "brute_scalar", "tree_scalar": "brute_scalar", "tree": "brute"}
        for search, than in brute.items():
            found = row[search]
            self.table.add("  %s / brute force" % search, name, found["ms"], row[than]["ms"], None, "ms")
            self.table.add("    to build", name, found["build_ms"], None, None, "ms")
            self.table.add("    bytes a face", name, found["bytes"] / row["faces"], None, None, "B")
        self.table.add("  what the server searches, tree / forest", name, row["tree"]["ms"], row["forest"]["ms"], 1, "ms")

    def draw_methods(self):
        """Ways to draw that find silhouettes on the GPU: ink within 2 px of exact visible contours, the longest ink that is
        none of theirs nor a crease's, and frame times over the shaded frame's, beside the paper's. Charcoal means to draw on
        the front, and image edges find creases that run out below the truth's angle: no target for those."""
        names = [n for n in ("bunny-closed", "torus-knot", "fandisk") if n in self.files] or list(self.files)[:1]
        for name in names[:1] if self.quick else names:
            os.environ["LIMN_MODELS"] = str(self.files[name].parent)
            for line in harness.run("limn-draw-bench", self.files[name].name).splitlines():
                row = json.loads(line)
                way = row["draw"].replace("image-precision:", "")
                if way == "shaded":
                    self.table.add("frame, shaded, CPU", name, row["ms"], None, None, "ms")
                    continue
                self.table.add("frame, %s, of shaded" % way, name, row["of_shaded"], DRAW_COSTS.get(way), None, "x",
                               quoted="papers/000" if way in DRAW_COSTS else None)
                self.table.add("  contours covered", name, row["covered_percent"], None, 99, "%", better="higher")
                self.table.add("  false line, longest", name, row["false_px"], None, None if way in ("charcoal", "image-edges") else 3,
                               "px")

    def link(self):
        """Over 1 Mbit/s, 25 ms each way: when there is something to see, when it is as good as the whole, and how long the
        same mesh as one Draco file takes on that link, drawing apart. Pictures and the diagram stay in build/link."""
        kept = pathlib.Path(__file__).resolve().parents[2] / "build" / "link"
        kept.mkdir(parents=True, exist_ok=True)
        names = [n for n in ("dragon", "turbine-blade", "bunny-closed") if n in self.files] or list(self.files)
        for name in names[-1:] if self.quick else names:
            asset = self.store / "assets" / self.prepare(name, 12)["asset"]
            key = name + "-12"
            with harness.Server(self.store) as server:
                seen = slow_link.watch(server, asset, key, kept)
            draco = self.draco[key] / 125_000 + 0.1 if key in self.draco else None  # two round trips to ask for it
            self.table.add("1 Mbit/s, base mesh", name, seen["base_s"], draco, None, "s")
            self.table.add("1 Mbit/s, settled at 1 px", name, seen["settled_s"], draco, None, "s")
            self.table.add("  the first who looks from there", name, seen["cold_s"], draco, None, "s")
            for moment in seen["moments"]:
                self.table.add("  contours off after %.2f s" % moment["seconds"], name, moment["p95_px"], None, None, "px")
            if draco:
                slow_link.diagram(name, seen, draco, kept / (name + ".svg"))

    def server(self):
        name = "dragon" if "dragon" in self.files else list(self.files)[-1]
        self.prepare(name)
        work = json.loads(harness.run("limn-delivery-bench", self.store, name))
        self.table.add("pose, target set cached", name, work["pose_us"], None, 20, "us")
        self.table.add("  one that sends, besides splits", name, work["usual"]["us"], None, 20, "us")
        self.table.add("  each split sent", name, work["usual"]["ns"], None, 100, "ns")
        self.table.add("  each split sent that others got", name, work["shared"]["ns"], None, 100, "ns")
        self.table.add("  each split sent for the first time", name, work["first"]["ns"], None, None, "ns")
        clients, hold = (10, 5) if self.quick else (50, 30)
        script, out = self.folder / "load.toml", self.folder / "load.json"
        script.write_text('decode = 0.01\n[[phase]]\nclients = %d\nramp_s = 5\nhold_s = %d\nmodel = "%s"\n'
                          'speed_deg_s = 15\nrate_hz = 10\n' % (clients, hold, name))
        with harness.Server(self.store) as server:
            harness.run("limn-load", "--server", server.url, "--script", script, "--report", out)
        report = json.loads(out.read_text())
        people = "%s, %d clients" % (name, clients)
        bad = report["clients"]["failed"] + report["clients"]["dropped"] + report["decode_errors"]
        self.table.add("load, errors", people, bad, None, 0)
        for error, times in report["errors"].items():
            print("  %d x %s" % (times, error))
        for latency in ("base", "pose_to_packet", "settled"):
            value = report["latency_ms"][latency]["p99"]
            if value is not None:
                self.table.add("load, %s p99" % latency, people, value, None, None, "ms")
        growth = (report["server"]["rss_mib_peak"] - report["server"]["rss_mib_before"]) * 1024 / clients
        self.table.add("load, memory a client", people, growth, None, None, "KiB")
        self.table.add("load, server CPU a client", people, 1000 * report["server"]["cpu_seconds"] / clients, None, None, "ms")


def main():
    parser = argparse.ArgumentParser(prog="tests/bench/run.sh")
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=" ".join(GROUPS))
    parser.add_argument("--models", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    for group in arguments.groups:
        if group not in GROUPS:
            parser.error("unknown group '%s'; use %s" % (group, " ".join(GROUPS)))
    if arguments.models and not arguments.models.is_dir():
        parser.error("%s is no folder" % arguments.models)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="limn-bench-"))
    status = 0
    try:
        bench = Bench(arguments.models, arguments.quick, folder)
        bench.table.head()
        for group in [g for g in GROUPS if g in arguments.groups or not arguments.groups]:
            try:
                getattr(bench, "draw_methods" if group == "draw" else group)()
            except (AssertionError, subprocess.SubprocessError, OSError, KeyError, TypeError) as error:
                print("%s: %s" % (group, error), file=sys.stderr)
                status = 1
        if arguments.json:
            arguments.json.write_text(json.dumps({"rows": bench.table.rows}, indent=1) + "\n")
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
