# SPDX-License-Identifier: Apache-2.0
"""What a viewer sees over a slow link while a model arrives, and as a diagram (SVG)."""

import json
import subprocess

import harness
from shaping_proxy import ShapingProxy

MOMENTS_S = (0.25, 0.35, 0.5, 0.75, 1, 1.5, 2, 3, 4, 6)  # since the client was started


def watch(server, asset, name, folder, kbps=1000, delay_ms=25, camera="orbit:30,15"):
    """Sessions over a link of so many kilobits a second and a delay each way, from one cold view: when the base mesh came
    and when the view had settled at 1 px, and what a client that is stopped at a moment has: distance between its
    visible contours and the whole model's, p95 and worst way, pixels of 1024, and its picture."""
    report, moments = folder / "link.json", []
    view = ("--model", name, "--camera", camera, "--size", "1024x1024", "--report", report)

    def session(link, *more):
        try:
            harness.run("limn-client", "render", "--server", link.url, *view, *more)
        except (AssertionError, subprocess.TimeoutExpired):
            return None  # nothing to draw yet
        return json.loads(report.read_text())

    with ShapingProxy(server.port, down=125 * kbps, up=125 * kbps, delay_s=delay_ms / 1000) as link:
        whole = session(link, "--until", "settled", "--out", folder / "settled.png")
        for seconds in MOMENTS_S:
            if seconds > 2 * whole["seconds"]["settled"] and len(moments) > 3:
                break
            out = folder / ("%s-%.2fs.png" % (name, seconds))
            seen = session(link, "--until", "seconds:%g" % seconds, "--check", "--reference", asset, "--out", out)
            if seen is not None:
                moments.append({"seconds": seconds, "bytes": seen["bytes"]["received"], "faces": seen["mesh"]["faces"],
                                "p95_px": seen["contour_error_px"]["p95"], "picture": out})
    return {"base_s": whole["seconds"]["base"], "settled_s": whole["seconds"]["settled"], "moments": moments,
            "bytes": whole["bytes"]["received"]}


def diagram(name, watched, draco_s, path, width=640, height=360):
    """Error against time: the stream's falls, Draco's file shows nothing until all of it has come."""
    left, right, top, bottom = 60, 20, 30, 50
    last = 1.1 * max([draco_s] + [m["seconds"] for m in watched["moments"]])
    most = max(4.0, 1.1 * max(m["p95_px"] for m in watched["moments"]))

    def at(seconds, pixels):
        return (left + (width - left - right) * seconds / last, height - bottom - (height - top - bottom) * pixels / most)

    def text(x, y, words, more=""):
        return '<text x="%.0f" y="%.0f" %s>%s</text>' % (x, y, more, words)

    points = [at(m["seconds"], m["p95_px"]) for m in watched["moments"]]
    base, settled, draco = (at(s, 0)[0] for s in (watched["base_s"], watched["settled_s"], draco_s))
    floor = height - bottom
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" font-family="sans-serif" font-size="12">'
             % (width, height), '<rect width="100%" height="100%" fill="white"/>',
             text(left, 18, "%s over 1 Mbit/s: contours off (p95, px of 1024) against seconds" % name, 'font-weight="bold"'),
             '<path d="M%d %d V%d H%d" fill="none" stroke="black"/>' % (left, top, floor, width - right)]
    for tick in range(0, int(last) + 1):
        x = at(tick, 0)[0]
        parts += ['<path d="M%.1f %d v5" stroke="black"/>' % (x, floor), text(x, floor + 18, tick, 'text-anchor="middle"')]
    step = max(1, round(most / 5))
    for tick in range(0, int(most) + 1, step):
        y = at(0, tick)[1]
        parts += ['<path d="M%d %.1f h-5" stroke="black"/>' % (left, y), text(left - 8, y + 4, tick, 'text-anchor="end"')]
    parts += ['<polyline points="%s" fill="none" stroke="#1f5fa8" stroke-width="2"/>'
              % " ".join("%.1f,%.1f" % p for p in points)]
    parts += ['<circle cx="%.1f" cy="%.1f" r="3" fill="#1f5fa8"/>' % p for p in points]
    for x, color, words in ((base, "#1f5fa8", "base mesh"), (settled, "#1f5fa8", "settled at 1 px"),
                            (draco, "#b03a2e", "Draco, whole")):
        parts += ['<path d="M%.1f %d V%d" stroke="%s" stroke-dasharray="4 3"/>' % (x, top, floor, color),
                  text(x, floor + 34, words, 'text-anchor="middle" fill="%s"' % color)]
    path.write_text("\n".join(parts + ["</svg>"]) + "\n")
