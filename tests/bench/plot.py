# SPDX-License-Identifier: Apache-2.0
"""A small diagram of curves, as SVG, for benches in Python. (Programs draw with shared/plot.)"""

import math

COLORS = ("#1f5fa8", "#b03a2e", "#2e7d4f", "#7d5a2e")
WIDTH, HEIGHT = 640, 360
LEFT, RIGHT, TOP, BOTTOM = 60, 20, 34, 50


def ticks(most):
    """Round numbers from 0, about five."""
    step = 10 ** math.floor(math.log10(most / 4))
    step *= next(f for f in (1, 2, 5, 10) if most / (f * step) <= 6)
    return [i * step for i in range(int(most / step) + 1)]


def text(x, y, words, more=""):
    return '<text x="%.1f" y="%.1f" %s>%s</text>' % (x, y, more, words)


def write(path, title, curves, marks=()):
    """curves: points (x, y) by name; marks: (x, words), upright lines. Both axes begin at 0."""
    points = [p for curve in curves.values() for p in curve]
    right = 1.05 * max([x for x, _ in points] + [x for x, _ in marks])
    top = 1.1 * max([y for _, y in points] + [1e-9])
    floor = HEIGHT - BOTTOM

    def at(x, y):
        return LEFT + (WIDTH - LEFT - RIGHT) * x / right, floor - (floor - TOP) * y / top

    parts = ['<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" font-family="sans-serif" font-size="12">'
             % (WIDTH, HEIGHT), '<rect width="100%" height="100%" fill="white"/>',
             text(LEFT, 18, title, 'font-weight="bold"'),
             '<path d="M%d %d V%d H%d" fill="none" stroke="black"/>' % (LEFT, TOP, floor, WIDTH - RIGHT)]
    for x in ticks(right):
        parts += ['<path d="M%.1f %d v5" stroke="black"/>' % (at(x, 0)[0], floor),
                  text(at(x, 0)[0], floor + 18, "%g" % x, 'text-anchor="middle"')]
    for y in ticks(top):
        parts += ['<path d="M%d %.1f h-5" stroke="black"/>' % (LEFT, at(0, y)[1]),
                  text(LEFT - 8, at(0, y)[1] + 4, "%g" % y, 'text-anchor="end"')]
    for color, (name, curve) in zip(COLORS, curves.items()):
        places = [at(*p) for p in curve]
        parts += ['<polyline points="%s" fill="none" stroke="%s" stroke-width="2"/>'
                  % (" ".join("%.1f,%.1f" % p for p in places), color)]
        parts += ['<circle cx="%.1f" cy="%.1f" r="3" fill="%s"/>' % (*p, color) for p in places]
        if len(curves) > 1:
            parts += [text(places[-1][0] - 6, places[-1][1] - 8, name, 'text-anchor="end" fill="%s"' % color)]
    for i, (x, words) in enumerate(marks):
        parts += ['<path d="M%.1f %d V%d" stroke="#555" stroke-dasharray="4 3"/>' % (at(x, 0)[0], TOP, floor),
                  text(at(x, 0)[0] + 3, TOP + 12 + 14 * i, words, 'fill="#555"')]
    path.write_text("\n".join(parts + ["</svg>"]) + "\n")
