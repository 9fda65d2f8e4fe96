# SPDX-License-Identifier: Apache-2.0
"""What a viewer sees over a slow link while a model arrives, and as a diagram (SVG)."""

import json
import subprocess

import harness
import plot
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
        # The first to come waits for the server to read the model and to look at this view: told apart.
        cold = session(link, "--until", "settled")
        whole = session(link, "--until", "settled", "--out", folder / (name + "-settled.png"))
        for seconds in MOMENTS_S:
            if seconds > 2 * whole["seconds"]["settled"] and len(moments) > 3:
                break
            out = folder / ("%s-%.2fs.png" % (name, seconds))
            seen = session(link, "--until", "seconds:%g" % seconds, "--check", "--reference", asset, "--out", out)
            if seen is not None:
                moments.append({"seconds": seconds, "bytes": seen["bytes"]["received"], "faces": seen["mesh"]["faces"],
                                "p95_px": seen["contour_error_px"]["p95"], "picture": out})
    return {"cold_s": cold["seconds"]["settled"], "base_s": whole["seconds"]["base"], "settled_s": whole["seconds"]["settled"], "moments": moments,
            "bytes": whole["bytes"]["received"]}


def diagram(name, watched, draco_s, path):
    """Error against time: the stream's falls, Draco's file shows nothing until all of it has come."""
    plot.write(path, "%s over 1 Mbit/s: contours off (p95, px of 1024) against seconds" % name,
               {"stream": [(m["seconds"], m["p95_px"]) for m in watched["moments"]]},
               [(watched["base_s"], "base mesh"), (watched["settled_s"], "settled at 1 px"), (draco_s, "Draco, whole")])
