# SPDX-License-Identifier: Apache-2.0
"""Draws selection.svg: what a settled client holds of a shape, as it sees it and from the side.

    LIMN_BIN=build/release/bin python3 server/session/selection_figure.py
"""

import json
import math
import pathlib
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests" / "integration"))
import harness  # noqa: E402
import meshes  # noqa: E402

PANEL = 420
CAMERA = "orbit:35,25"


def read_model_ply(path):
    """Vertices in model coordinates and faces of a --dump-mesh."""
    grid = meshes.read_ply(path)
    return [tuple(float(c) for c in p) for p in grid.positions], grid.faces


def centred(vertices):
    low = [min(v[k] for v in vertices) for k in range(3)]
    high = [max(v[k] for v in vertices) for k in range(3)]
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    moved = [tuple(v[k] - middle[k] for k in range(3)) for v in vertices]
    radius = max(math.sqrt(sum(c * c for c in v)) for v in moved)
    return [tuple(c / radius for c in v) for v in moved]


def seen_from(vertices, azimuth, elevation, distance=3.0):
    """As orbit:azimuth,elevation: picture coordinates, about -1 to 1, and the eye."""
    a, e = math.radians(azimuth), math.radians(elevation)
    back = (math.cos(e) * math.sin(a), math.sin(e), math.cos(e) * math.cos(a))
    right = (math.cos(a), 0.0, -math.sin(a))
    up = (-math.sin(e) * math.sin(a), math.cos(e), -math.sin(e) * math.cos(a))
    dot = lambda p, q: sum(x * y for x, y in zip(p, q))  # noqa: E731
    scale = math.sqrt(distance * distance - 1)
    flat = [(dot(v, right) * scale / (distance - dot(v, back)), dot(v, up) * scale / (distance - dot(v, back)))
            for v in vertices]
    return flat, tuple(distance * c for c in back)


def normal(vertices, face):
    a, b, c = (vertices[i] for i in face)
    u = [b[k] - a[k] for k in range(3)]
    v = [c[k] - a[k] for k in range(3)]
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def front(vertices, face, eye):
    n, a = normal(vertices, face), vertices[face[0]]
    return sum(n[k] * (eye[k] - a[k]) for k in range(3)) > 0


def path(edges, flat, left):
    at = lambda i: "%d %d" % (left + PANEL / 2 + 195 * flat[i][0], PANEL / 2 - 195 * flat[i][1])  # noqa: E731
    return "".join("M%sL%s" % (at(a), at(b)) for a, b in sorted(edges))


def panel(vertices, faces, camera, eye_of, left):
    """The mesh's front faces from `camera`; silhouette edges of the view `eye_of` in red."""
    flat, eye = seen_from(vertices, *camera)
    _, client = seen_from(vertices, *eye_of)
    grey, sides = set(), {}
    for face in faces:
        here = front(vertices, face, client)
        for a, b in zip(face, face[1:] + face[:1]):
            key = (min(a, b), max(a, b))
            sides.setdefault(key, []).append(here)
            if front(vertices, face, eye):
                grey.add(key)
    red = {edge for edge, facing in sides.items() if len(set(facing)) == 2 and edge in grey}
    return ('<path d="%s" stroke="#8a8f98" stroke-width="0.5"/><path d="%s" stroke="#c8371b" stroke-width="1.6"/>'
            % (path(grey, flat, left), path(red, flat, left)))


def main():
    folder = pathlib.Path(tempfile.mkdtemp(prefix="limn-figure-"))
    store, dump, report = folder / "store", folder / "client.ply", folder / "report.json"
    shape = meshes.write_obj(folder / "shape.obj", meshes.torus(256, 128, 0.25))
    harness.run("limn-prepare", shape, "--store", store, "--name", "shape", "--base-faces", "300")
    with harness.Server(store) as server:
        harness.run("limn-client", "render", "--server", server.url, "--model", "shape", "--until", "settled", "--camera",
                    CAMERA, "--silhouette", "edges", "--size", "1024x1024", "--dump-mesh", dump, "--report", report)
    vertices, faces = read_model_ply(dump)
    vertices = centred(vertices)
    total = json.loads(report.read_text())["mesh"]
    view = tuple(float(x) for x in CAMERA.split(":")[1].split(","))
    caption = "%s of %s splits: as the client sees it, and the same mesh from behind (its contour in red)" % (
        format(total["splits_held"], ","), format(total["splits_total"], ","))
    svg = ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" font-family="sans-serif" font-size="14">'
           '<!-- SPDX-License-Identifier: Apache-2.0; drawn by selection_figure.py -->'
           '<rect width="100%%" height="100%%" fill="#fff"/><g fill="none" stroke-linecap="round">%s%s</g>'
           '<text x="%d" y="%d" text-anchor="middle">%s</text></svg>\n') % (
               2 * PANEL, PANEL + 30, panel(vertices, faces, view, view, 0),
               panel(vertices, faces, (view[0] + 180, 20), view, PANEL), PANEL, PANEL + 15, caption)
    (HERE / "selection.svg").write_text(svg)


if __name__ == "__main__":
    main()
