# SPDX-License-Identifier: Apache-2.0
"""Shapes to prepare, files of them, and what a mesh that came back is compared by. Standard library only."""

import collections
import itertools
import math
import pathlib
import struct

# Grid triples, index triples; a tuple a vertex of its colour and normal, as far as the mesh has them.
Mesh = collections.namedtuple("Mesh", "positions faces attributes", defaults=(None,))


def torus(rings, sides, bump=0.0):
    vertices, faces = [], []
    for i, j in itertools.product(range(rings), range(sides)):
        a, b = 2 * math.pi * i / rings, 2 * math.pi * j / sides
        r = 0.4 * (1 + bump * math.sin(7 * a) * math.cos(5 * b))
        vertices.append(((1 + r * math.cos(b)) * math.cos(a), (1 + r * math.cos(b)) * math.sin(a), r * math.sin(b)))
        here, right = i * sides + j, (i + 1) % rings * sides + j
        up, across = i * sides + (j + 1) % sides, (i + 1) % rings * sides + (j + 1) % sides
        faces += [(here, right, across), (here, across, up)]
    return vertices, faces


def hills(columns, rows):
    """A height field: open, one border."""
    vertices = [(x / columns, y / rows, 0.1 * math.sin(9 * x / columns) * math.cos(7 * y / rows))
                for y in range(rows + 1) for x in range(columns + 1)]
    faces = []
    for y, x in itertools.product(range(rows), range(columns)):
        a = y * (columns + 1) + x
        faces += [(a, a + 1, a + columns + 2), (a, a + columns + 2, a + columns + 1)]
    return vertices, faces


def pair():
    """Two closed components."""
    vertices, faces = torus(24, 16)
    moved = [(x + 3, y + 0.5, z) for x, y, z in vertices]
    return vertices + moved, faces + [tuple(i + len(vertices) for i in f) for f in faces]


def write_obj(path, shape):
    vertices, faces = shape
    with open(path, "w") as out:
        out.writelines("v %.9g %.9g %.9g\n" % v for v in vertices)
        out.writelines("f %d %d %d\n" % tuple(i + 1 for i in f) for f in faces)
    return path


PLY_TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
             "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f",
             "float64": "d"}


def read_ply(path):
    """A mesh as --dump-mesh writes it: positions are the grid's integers qx, qy, qz."""
    data = pathlib.Path(path).read_bytes()
    end = data.index(b"end_header") + len(b"end_header")
    header, body = data[:end].decode().split("\n"), data[data.index(b"\n", end) + 1:]
    binary = "format binary_little_endian 1.0" in header
    elements = []
    for line in header:
        words = line.split()
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    positions, faces, attributes = [], [], []
    tokens, offset = (iter(body.split()), 0)
    for name, count, properties in elements:
        if name == "vertex":
            where = [p[-1] for p in properties]
            q = [where.index(axis) for axis in ("qx", "qy", "qz")]
            more = [i for i, name in enumerate(where) if name in ("red", "green", "blue", "nx", "ny", "nz")]
            if binary:
                record = struct.Struct("<" + "".join(PLY_TYPES[p[0]] for p in properties))
                rows = record.iter_unpack(body[offset:offset + count * record.size])
                offset += count * record.size
            else:
                rows = ([float(next(tokens)) for _ in properties] for _ in range(count))
            for row in rows:
                positions.append(tuple(int(row[i]) for i in q))
                attributes.append(tuple(row[i] for i in more))
        elif name == "face":
            for _ in range(count):
                if binary:
                    length_type, index_type = PLY_TYPES[properties[0][1]], PLY_TYPES[properties[0][2]]
                    (length,) = struct.unpack_from("<" + length_type, body, offset)
                    offset += struct.calcsize("<" + length_type)
                    faces.append(struct.unpack_from("<%d%s" % (length, index_type), body, offset))
                    offset += struct.calcsize("<%d%s" % (length, index_type))
                else:
                    faces.append(tuple(int(next(tokens)) for _ in range(int(next(tokens)))))
    return Mesh(positions, faces, attributes)


def write_painted(path, shape):
    """A PLY file of a shape with a colour and a normal a vertex: stripes and gradients."""
    lines = ["ply", "format ascii 1.0", "element vertex %d" % len(shape[0])]
    lines += ["property float " + name for name in ("x", "y", "z", "nx", "ny", "nz")]
    lines += ["property uchar " + name for name in ("red", "green", "blue")]
    lines += ["element face %d" % len(shape[1]), "property list uchar int vertex_indices", "end_header"]
    for i, (x, y, z) in enumerate(shape[0]):
        color = (200, 40, 10) if i // 5 % 2 else (i % 256, 7 * i % 256, 128)
        lines.append("%r %r %r %r %r %r %d %d %d" % (x, y, z, x, y + 0.3, z - 0.2, *color))
    lines += [" ".join(map(str, (len(face), *face))) for face in shape[1]]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_two_materials(path, shape):
    """A PLY file whose faces have colours: the first half red, the rest blue."""
    lines = ["ply", "format ascii 1.0", "element vertex %d" % len(shape[0])]
    lines += ["property float " + name for name in ("x", "y", "z")]
    lines += ["element face %d" % len(shape[1]), "property list uchar int vertex_indices"]
    lines += ["property uchar " + name for name in ("red", "green", "blue")] + ["end_header"]
    lines += ["%r %r %r" % tuple(position) for position in shape[0]]
    for i, face in enumerate(shape[1]):
        color = "220 20 20" if 2 * i < len(shape[1]) else "20 20 220"
        lines.append(" ".join(map(str, (len(face), *face))) + " " + color)
    path.write_text("\n".join(lines) + "\n")
    return path


def canonical(mesh):
    """The mesh up to numbering: how often each oriented triangle of positions occurs. Vertices that share a place (split
    for manifoldness) cannot be told apart, nor need they be."""
    counts = collections.Counter()
    for face in mesh.faces:
        corners = [mesh.positions[i] for i in face]
        first = corners.index(min(corners))
        counts[tuple(corners[first:] + corners[:first])] += 1
    return counts


def manifold_fault(mesh):
    """None, or what is wrong: an oriented manifold uses each directed edge once and has one fan of faces a vertex."""
    outgoing = collections.defaultdict(dict)  # vertex -> {next corner: previous corner}
    for face in mesh.faces:
        if len(set(face)) != 3 or max(face) >= len(mesh.positions):
            return "face %s" % (face,)
        for a, b, c in (face, face[1:] + face[:1], face[2:] + face[:2]):
            if b in outgoing[a]:
                return "edge %d-%d has two faces of one direction" % (a, b)
            outgoing[a][b] = c
    for vertex, fan in outgoing.items():
        starts = set(fan) - set(fan.values())
        if len(starts) > 1:
            return "vertex %d has %d fans" % (vertex, len(starts))
        first = next(iter(starts or fan))
        corner, steps = fan[first], 1
        while corner in fan and corner != first:
            corner, steps = fan[corner], steps + 1
        if steps != len(fan):
            return "vertex %d has more than one fan" % vertex
    return None
