# SPDX-License-Identifier: Apache-2.0
"""PNG pictures with Python's standard library alone: what limn-client and rsvg-convert write, and sheets of them."""
import struct
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def read(path):
    """(width, height, rows) of an 8-bit RGB or RGBA picture; rows are bytes, three a pixel, alpha dropped."""
    data = path.read_bytes()
    assert data[:8] == SIGNATURE, path
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack_from(">IIBB", body)
            assert depth == 8 and colour in (2, 6), path
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    step = 3 if colour == 2 else 4
    raw, above, rows = zlib.decompress(packed), bytes(width * step), []
    for y in range(height):
        begin = y * (width * step + 1)
        above = unfiltered(raw[begin], bytearray(raw[begin + 1:begin + 1 + width * step]), above, step)
        if step == 3:
            rows.append(above)
            continue
        row = bytearray(3 * width)
        for channel in range(3):
            row[channel::3] = above[channel::4]
        rows.append(bytes(row))
    return width, height, rows


def unfiltered(kind, row, above, step):
    """A row of bytes as it was before the PNG filter `kind`."""
    if kind == 1:
        for i in range(step, len(row)):
            row[i] = (row[i] + row[i - step]) & 255
    elif kind == 2:
        row = bytes((a + b) & 255 for a, b in zip(row, above))
    elif kind == 3:
        for i in range(len(row)):
            row[i] = (row[i] + ((row[i - step] if i >= step else 0) + above[i]) // 2) & 255
    elif kind == 4:
        for i in range(len(row)):
            left, corner = (row[i - step], above[i - step]) if i >= step else (0, 0)
            p = left + above[i] - corner
            near = min((abs(p - left), 0, left), (abs(p - above[i]), 1, above[i]), (abs(p - corner), 2, corner))
            row[i] = (row[i] + near[2]) & 255
    return bytes(row)


def write(path, width, rows):
    """rows: bytes, three a pixel."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    header = struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)
    packed = zlib.compress(b"".join(b"\0" + row for row in rows), 6)
    path.write_bytes(SIGNATURE + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b""))


def brightness(rows):
    """Rows of mean brightness, 0 to 255, one number a pixel."""
    return [[(row[i] + row[i + 1] + row[i + 2]) // 3 for i in range(0, len(row), 3)] for row in rows]
