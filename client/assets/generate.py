#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the stroke textures of Limn's own texture sets: NAME/visible.png and NAME/hidden.png.

Usage: generate.py [FOLDER]     (default: the folder of this script)

A texture is one repeat of a stroke, left to right, and closes on itself there. Its alpha is ink. The
middle BODY of its height is the stroke at its nominal width; the rest is room for wobble. Only the
standard library is used, and the same bytes come out every time.
"""
import math
import pathlib
import random
import struct
import sys
import zlib

WIDTH, HEIGHT = 1024, 32
BODY = 0.6
TEXELS_ALONG, TEXELS_ACROSS = 4.0, 7.7  # to a pixel of the drawing, for ends of dashes that are round there


def write_png(path, rows):
    """rows: HEIGHT lists of WIDTH ink values 0 … 1; written as grey + alpha, black with alpha = ink."""
    raw = bytearray()
    for row in rows:
        raw.append(0)
        for ink in row:
            raw += bytes((0, max(0, min(255, round(255 * ink)))))
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))
    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 4, 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(raw), 9)) + chunk(b"IEND", b""))


class Noise:
    """Smooth value noise, −1 … 1, periodic in x over WIDTH texels."""

    def __init__(self, seed, cells_x, cell_y=None):
        rng = random.Random(seed)
        self.cells_x, self.cell_y = cells_x, cell_y
        rows = 1 if cell_y is None else HEIGHT // cell_y + 2
        self.values = [[rng.uniform(-1, 1) for _ in range(cells_x)] for _ in range(rows)]

    def __call__(self, x, y=0.0):
        def along(row):
            t = (x / WIDTH) % 1.0 * self.cells_x
            i = int(t)
            f = t - i
            f = f * f * (3 - 2 * f)
            return row[i % self.cells_x] * (1 - f) + row[(i + 1) % self.cells_x] * f
        if self.cell_y is None:
            return along(self.values[0])
        t = y / self.cell_y
        i = min(int(t), len(self.values) - 2)
        f = t - i
        f = f * f * (3 - 2 * f)
        return along(self.values[i]) * (1 - f) + along(self.values[i + 1]) * f


def smoothstep(low, high, x):
    t = max(0.0, min(1.0, (x - low) / (high - low)))
    return t * t * (3 - 2 * t)


def px_across(v):
    """A distance across the strip, which is −1 … 1 wide, in pixels of the drawing."""
    return v * HEIGHT / 2 / TEXELS_ACROSS


def dashes(seed, count, share, uneven, start=0.0):
    """Dashes of uneven length round the repeat: [(begin, end)] in texels from start on, gaps between them."""
    rng = random.Random(seed)
    periods = [1 + rng.uniform(-uneven, uneven) for _ in range(count)]
    scale = WIDTH / sum(periods)
    at, result = start, []
    for period in periods:
        length = period * scale
        ink = length * share * (1 + rng.uniform(-uneven, uneven) * 0.4)
        result.append((at, at + ink))
        at += length
    return result


def from_dash_ends(x, spans):
    """Signed distance into the nearest dash, in texels: > 0 inside."""
    best = -float(WIDTH)
    for begin, end in spans:
        for shift in (-WIDTH, 0, WIDTH):
            best = max(best, min(x - begin - shift, end + shift - x))
    return best


# A pen: pen(seed, weight) gives its ink at texel x, y, 0 … 1. v: y as −1 … 1 across the strip; inside: how
# far x is inside its dash, in pixels of the drawing, or None in a stroke without dashes.


def pencil(seed, weight):
    """Graphite: a soft edge, pressure that comes and goes, streaks along and grain across."""
    centre, slow = Noise(seed, 9), Noise(seed + 1, 4)
    width, pressure = Noise(seed + 2, 14), Noise(seed + 3, 11)
    streaks, grain = Noise(seed + 4, 70, 2), Noise(seed + 5, 420, 1)
    fine = Noise(seed + 6, 800, 1)

    def ink_at(x, y, v, inside):
        half = BODY * weight * (0.92 + 0.10 * width(x))
        off = abs(v - 0.14 * centre(x) - 0.08 * slow(x)) / half
        ink = smoothstep(1.12, 0.45, off)
        ink *= 0.86 + 0.12 * pressure(x)
        ink *= 0.86 + 0.16 * streaks(x, y) + 0.20 * grain(x, y) + 0.10 * fine(x, y)
        if inside is not None:
            # Ends of dashes: round, fading as the pencil lifts.
            away = px_across(off * half)
            ink *= smoothstep(-0.4, 1.6, inside - 0.35 * away * away)
        return ink
    return ink_at


def ink_pen(seed, weight):
    """A steel nib: full black, a crisp edge, the width breathing with the hand."""
    centre, slow = Noise(seed, 7), Noise(seed + 1, 3)
    width, swell = Noise(seed + 2, 17), Noise(seed + 3, 5)
    upper, lower = Noise(seed + 4, 120), Noise(seed + 5, 120)

    def ink_at(x, y, v, inside):
        half = BODY * weight * (0.98 + 0.07 * width(x) + 0.10 * swell(x))
        side = v - 0.07 * centre(x) - 0.06 * slow(x)
        if inside is None:
            edge = half + 0.035 * (upper(x) if side < 0 else lower(x))
            return smoothstep(edge + 0.09, edge - 0.09, abs(side))
        # Round ends, where ink pools a little.
        radius = px_across(half)
        bulge = radius * (1 + 0.12 * smoothstep(2.2 * radius, radius, inside))
        reach = math.hypot(max(bulge - inside, 0.0), px_across(abs(side)))
        return smoothstep(bulge + 0.35, bulge - 0.35, reach)
    return ink_at


def coloured_pencil(seed, weight):
    """Wax and pigment: a broad soft lead that skips the paper's hollows, in streaks along the stroke."""
    centre, width = Noise(seed, 8), Noise(seed + 1, 12)
    pressure, streaks = Noise(seed + 2, 7), Noise(seed + 3, 40, 3)
    grain, specks = Noise(seed + 4, 300, 2), Noise(seed + 5, 620, 1)

    def ink_at(x, y, v, inside):
        half = BODY * weight * (0.98 + 0.12 * width(x))
        off = abs(v - 0.10 * centre(x)) / half
        ink = smoothstep(1.08, 0.75, off)
        # The lead's own hollows, deeper towards its edges.
        tooth = 0.55 * grain(x, y) + 0.35 * specks(x, y) + 0.30 * streaks(x, y)
        ink *= smoothstep(-0.62, 0.25, tooth + 0.42 + 0.22 * pressure(x) - 0.55 * off * off)
        ink *= 0.92
        if inside is not None:
            away = px_across(off * half)
            ink *= smoothstep(-0.4, 2.0, inside - 0.30 * away * away)
        return ink
    return ink_at


def felt_pen(seed, weight):
    """A fibre tip: even ink that bleeds a little, darker where it lingers, edges softly frayed."""
    centre, width = Noise(seed, 6), Noise(seed + 1, 26)
    linger, cloud = Noise(seed + 2, 9), Noise(seed + 3, 60, 6)
    upper, lower = Noise(seed + 4, 210), Noise(seed + 5, 210)

    def ink_at(x, y, v, inside):
        half = BODY * weight * (0.97 + 0.05 * width(x) + 0.06 * linger(x))
        side = v - 0.05 * centre(x)
        edge = half + 0.05 * (upper(x) if side < 0 else lower(x))
        ink = smoothstep(edge + 0.16, edge - 0.14, abs(side))
        ink *= 0.88 + 0.07 * linger(x) + 0.06 * cloud(x, y) + 0.05 * smoothstep(0.5, 1.0, abs(side) / half)
        if inside is not None:
            radius = px_across(half)
            reach = math.hypot(max(radius - inside, 0.0), px_across(abs(side)))
            ink *= smoothstep(radius + 0.6, radius - 0.6, reach)
        return ink
    return ink_at


def marker(seed, weight):
    """A chisel marker: broad, translucent, straight edges darker than the middle, dry streaks now and then."""
    width, dry = Noise(seed, 10), Noise(seed + 1, 8)
    streaks, pools = Noise(seed + 2, 26, 2), Noise(seed + 3, 14)

    def ink_at(x, y, v, inside):
        half = BODY * weight * (1.0 + 0.03 * width(x))
        off = abs(v) / half
        ink = smoothstep(1.06, 0.94, off)
        tone = 0.78 + 0.10 * pools(x) + 0.16 * smoothstep(0.70, 0.98, off)
        tone -= 0.26 * smoothstep(0.15, 0.75, streaks(x, y) + 0.55 * dry(x))
        if inside is not None:
            # Cut square, as the chisel is.
            ink *= smoothstep(-0.4, 0.5, inside)
        return ink * tone
    return ink_at


def technical(_, weight):
    """A plotter's line: one width, one black, square dashes."""
    def ink_at(_x, _y, v, inside):
        ink = smoothstep(BODY * weight + 0.05, BODY * weight - 0.05, abs(v))
        return ink if inside is None else ink * smoothstep(-0.35, 0.35, inside)
    return ink_at


def draw(ink_at, spans=None):
    """The picture of a pen's stroke, in dashes if spans are given; nothing touches its upper and lower edge."""
    inside = [None if spans is None else from_dash_ends(x + 0.5, spans) / TEXELS_ALONG for x in range(WIDTH)]
    rows = []
    for y in range(HEIGHT):
        v = 2 * (y + 0.5) / HEIGHT - 1
        margin = smoothstep(1.0, 0.92, abs(v))
        rows.append([ink_at(x, y, v, inside[x]) * margin for x in range(WIDTH)])
    return rows


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent
    for name, pen, seed, dash in (
        ("pencil", pencil, 100, dict(count=17, share=0.62, uneven=0.16)),
        ("ink", ink_pen, 200, dict(count=20, share=0.58, uneven=0.07)),
        ("coloured-pencil", coloured_pencil, 300, dict(count=15, share=0.60, uneven=0.18)),
        ("felt-pen", felt_pen, 400, dict(count=16, share=0.52, uneven=0.10)),
        ("marker", marker, 500, dict(count=11, share=0.58, uneven=0.06, start=30.0)),
        ("technical", technical, 600, dict(count=16, share=0.66, uneven=0.0)),
    ):
        (folder / name).mkdir(parents=True, exist_ok=True)
        write_png(folder / name / "visible.png", draw(pen(seed, 1.0)))
        write_png(folder / name / "hidden.png", draw(pen(seed + 20, 0.72), dashes(seed + 50, **dash)))


main()
