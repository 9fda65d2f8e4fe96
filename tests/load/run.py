# SPDX-License-Identifier: Apache-2.0
"""The table of tests/load/run.sh: every script against a server of its own, on this machine, the generator included."""

import argparse
import contextlib
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "integration"), str(HERE.parent / "bench")]
import harness  # noqa: E402
import meshes  # noqa: E402
import plot  # noqa: E402

harness.DEADLINE_S = 3000  # of one program: a soak
EXTENSIONS = (".ply", ".obj", ".stl", ".off", ".glb")
GENERATED = {"dragon": (256, 128, 0.3), "turbine-blade": (192, 96, 0.2), "bunny-closed": (96, 48, 0.1)}
# Everybody here has one address.
LIMITS = ("--max-clients", 19000, "--max-clients-per-address", 0)
# Some go around first, so that the server knows the model's views, as one does that has run for a while.
SWEEP = """decode = 0
[[phase]]
clients = 40
ramp_s = 1
hold_s = 4
model = "{1}"
measured = false
[[phase]]
clients = {0}
ramp_s = 2
hold_s = 8
model = "{1}"
[thresholds]
failed = 0
"""


DRAIN = """decode = 0
[[phase]]
clients = %d
ramp_s = %g
hold_s = 60
model = "turbine-blade"
behaviour = "idle"
"""
MEMORY = """decode = 0
[[phase]]
clients = %d
ramp_s = %g
hold_s = 300
model = "turbine-blade"
behaviour = "%s"
"""
# What a client costs is the difference between few and many, since what all share is there either way.
MEMORY_CLIENTS = {"idle": (2000, 12000), "normal": (200, 1200)}
MEMORY_REST_S = 40.0  # then all that poses need has come, and all that is shared
RESTART = """decode = 1
[[phase]]
clients = %d
ramp_s = 3
hold_s = 17
model = "turbine-blade"
returns = true
[thresholds]
failed = 0
dropped = 0
decode_errors = 0
"""


def prepare(names, models, folder):
    store = folder / "store"
    for name in sorted(names):
        found = [models / (name + e) for e in EXTENSIONS if models and (models / (name + e)).exists()]
        mesh = found[0] if found else meshes.write_obj(folder / (name + ".obj"), meshes.torus(*GENERATED[name]))
        harness.run("limn-prepare", mesh, "--store", store, "--name", name)
    return store


class Watch(threading.Thread):
    """Memory of a process, MiB, a sample a second."""

    def __init__(self, process):
        super().__init__(daemon=True)
        self.process, self.memory, self.done = process, [], threading.Event()

    def run(self):
        while not self.done.wait(1.0):
            with contextlib.suppress(OSError, AttributeError):
                status = pathlib.Path("/proc/%d/status" % self.process.pid).read_text()
                self.memory.append(int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024)

    def growth(self):
        """By how much the last sixth is above the time from a third to a half; None for less than a minute."""
        if len(self.memory) < 60:
            return None
        middle, end = self.memory[len(self.memory) // 3:len(self.memory) // 2], self.memory[-(len(self.memory) // 6):]
        return sum(end) / len(end) / (sum(middle) / len(middle)) - 1


def descriptors(process):
    return len(os.listdir("/proc/%d/fd" % process.pid))


def play(store, script, folder, tls=False):
    """The report of one script, and what a script cannot see: descriptors left open, memory that grows over a soak."""
    report = folder / "report.json"
    secret = ("--tls-cert", folder / "server.pem", "--tls-key", folder / "server.key") if tls else ()
    with harness.Server(store, *LIMITS, *secret) as server:
        server.wait_for_metric("limn_ready", 1)
        before, watch = descriptors(server.process), Watch(server.process)
        watch.start()
        url = "wss://localhost:%d" % server.port if tls else server.url
        harness.run("limn-load", "--server", url, "--server-pid", server.process.pid, "--script", script, "--report", report,
                    *(("--ca-file", folder / "server.pem") if tls else ()), expect=None)
        watch.done.set()
        # The last clients' sockets close, and that of the metrics.
        time.sleep(1.0)
        left = descriptors(server.process) - before
    result = json.loads(report.read_text())
    if left > 0:
        result["failures"].append("%d descriptors left open" % left)
    if script.stem == "soak" and (watch.growth() or 0) > 0.02:
        result["failures"].append("memory still grew by %.1f %%" % (100 * watch.growth()))
    result["passed"] = not result["failures"]
    return result


def play_bare(store, script, folder):
    """The report of a script of one model against libwebsockets alone (tests/bench/bare_server.cpp), with the same payload."""
    report, port = folder / "bare.json", harness.free_port()
    [model] = set(re.findall(r'^model *= *"([^"]+)"', script.read_text(), re.M))
    server = subprocess.Popen([harness.BIN / "limn-bare-server", store, model, str(port)], stdout=subprocess.DEVNULL)
    try:
        deadline = time.monotonic() + 60  # it records first
        while True:
            with contextlib.suppress(ConnectionRefusedError), socket.create_connection(("127.0.0.1", port)):
                break
            if server.poll() is not None or time.monotonic() > deadline:
                raise AssertionError("limn-bare-server does not start")
            time.sleep(0.1)
        harness.run("limn-load", "--server", "ws://127.0.0.1:%d" % port, "--server-pid", server.pid, "--script", script,
                    "--report", report, expect=None)
    finally:
        server.kill()
        server.wait()
    return json.loads(report.read_text())


def beside_bare(limn, bare):
    """What a script's clients got of what a bare server gives them, and what that cost, in words."""
    def poses(report):
        return report["poses_sent"] / report["server"]["cpu_seconds"]
    return "of bare libwebsockets: %.0f %% of the bytes, %.0f %% of the poses a second of server CPU (%.0f of %.0f)" % (
        100 * limn["bytes_received"] / bare["bytes_received"], 100 * poses(limn) / poses(bare), poses(limn), poses(bare))


@contextlib.contextmanager
def crowd(store, folder, text, clients):
    """A server and a generator beside it, once everybody is connected."""
    script, report = folder / "crowd.toml", folder / "crowd.json"
    script.write_text(text)
    with harness.Server(store, *LIMITS) as server:
        server.wait_for_metric("limn_ready", 1)
        load = subprocess.Popen([harness.BIN / "limn-load", "--server", server.url, "--script", script, "--report", report],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            server.wait_for_metric("limn_connections", clients)
            time.sleep(2.0)  # some of what they want comes
            yield server, load, report
        finally:
            load.kill()
            load.wait()


def drain(store, folder, clients):
    """SIGTERM with so many connected; a line, and whether it went well."""
    with crowd(store, folder, DRAIN % (clients, clients / 600), clients) as (server, _, _):
        begun = time.monotonic()
        status = server.terminate()
        seconds = time.monotonic() - begun
    return "drain: %d clients in %.1f s, exit status %d" % (clients, seconds, status), status == 0 and seconds <= 25


def memory(store, folder, _):
    """KiB that a client costs the server, by behaviour, and of what; a line each, and whether they are within their targets."""
    lines, well = [], True
    for (behaviour, counts), most in zip(MEMORY_CLIENTS.items(), (16, 64)):
        seen = []
        for clients in counts:
            with crowd(store, folder, MEMORY % (clients, clients / 600, behaviour), clients) as (server, _, _):
                time.sleep(MEMORY_REST_S)
                status = pathlib.Path("/proc/%d/status" % server.process.pid).read_text()
                seen.append({
                    "all": int(re.search(r"VmRSS:\s+(\d+)", status)[1]),
                    "sessions": server.metric("limn_session_bytes") / 1024,
                    "models": server.metric("limn_model_bytes") / 1024,
                    "cells": server.metric("limn_target_cache_bytes") / 1024})
                [model] = [m for m in json.loads(server.get("/models")[1]) if m["name"] == "turbine-blade"]
        more = counts[1] - counts[0]
        each = {part: (seen[1][part] - seen[0][part]) / more for part in seen[0]}
        have = model["vertices"] / 8 / 1024
        own = each["all"] - have - each["models"] - each["cells"]
        well = well and own <= most
        lines.append(
            "memory, %s, %d to %d clients: %.1f KiB a client; have-set %.1f, models and packets %.1f, cells %.1f; besides %.1f "
            "(at most %d), of which the session %.1f" % (
                behaviour, *counts, each["all"], have, each["models"], each["cells"], own, most, each["sessions"] - have))
    return "\n".join(lines), well


def restart(store, folder, clients):
    """kill -9 while so many decode, and a new server on the same port; a line, and whether all went on."""
    with crowd(store, folder, RESTART % clients, clients) as (server, load, path):
        server.kill()
        server.start()
        load.wait(harness.DEADLINE_S)
        report = json.loads(path.read_text())
    return "restart: %d of %d clients went on from what they held; %s" % (
        report["clients"]["resumed"], clients, "; ".join(report["failures"]) or "no error"), (
            report["passed"] and report["clients"]["resumed"] >= clients)


def number(value, digits="%.0f"):
    return "-" if value is None else digits % value


HEAD = ("script", "clients", "failed", "connect p99", "pose p50", "pose p99", "settled p99", "MB", "server CPU", "own CPU",
        "MiB more", "")
LINE = "%-20s %8s %7s %12s %9s %9s %12s %8s %11s %9s %9s  %s"


def line(name, report):
    clients, latency, server = report["clients"], report["latency_ms"], report["server"] or {}
    seconds = report["seconds"]
    share = lambda used: None if used is None else 100 * used / seconds  # noqa: E731
    growth = server["rss_mib_peak"] - server["rss_mib_before"] if server else None
    return LINE % (
        name, clients["asked"], clients["failed"] + clients["dropped"], number(latency["connect"]["p99"]),
        number(latency["pose_to_packet"]["p50"]), number(latency["pose_to_packet"]["p99"]),
        number(latency["settled"]["p99"]), number(report["bytes_received"] / 1e6, "%.1f"),
        number(share(server.get("cpu_seconds")), "%.0f %%"), number(share(report["own_cpu_seconds"]), "%.0f %%"),
        number(growth, "%.1f"), "passed" if report["passed"] else "FAILED: " + "; ".join(report["failures"]))


def main():
    parser = argparse.ArgumentParser(prog="tests/load/run.sh")
    parser.add_argument("scripts", nargs="*", type=pathlib.Path)
    parser.add_argument("--models", type=pathlib.Path, default=harness.models())
    parser.add_argument("--soak", action="store_true")
    parser.add_argument("--tls", action="store_true")
    parser.add_argument("--bare", action="store_true")
    parser.add_argument("--drain", type=int, metavar="CLIENTS")
    parser.add_argument("--restart", type=int, metavar="CLIENTS")
    parser.add_argument("--memory", action="store_true")
    parser.add_argument("--plot", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    only = arguments.drain or arguments.restart or arguments.memory
    scripts = arguments.scripts or [s for s in sorted(HERE.glob("*.toml")) if not only and (arguments.soak or s.stem != "soak")]
    names = set()
    for script in scripts:
        text = script.read_text()
        names.update(re.findall(r'"([^"]+)"', " ".join(re.findall(r"^(?:model|also) *= *(.*)$", text, re.M))))
    if arguments.plot or only:
        names.add("turbine-blade")
    unknown = sorted(n for n in names if n not in GENERATED and not (arguments.models and any(
        (arguments.models / (n + e)).exists() for e in EXTENSIONS)))
    if unknown:
        parser.error("no mesh for %s: give --models DIR" % ", ".join(unknown))
    folder, reports, held = pathlib.Path(tempfile.mkdtemp(prefix="limn-load-")), {}, True
    try:
        store = prepare(names, arguments.models, folder)
        if arguments.tls:
            harness.make_certificate(folder)
        for case, clients in ((drain, arguments.drain), (restart, arguments.restart), (memory, arguments.memory)):
            if clients:
                text, well = case(store, folder, clients)
                held = held and well
                print(text + ("" if well else ": FAILED"), flush=True)
        if scripts:
            print(LINE % HEAD)
        for script in scripts:
            reports[script.stem] = play(store, script, folder, arguments.tls)
            print(line(script.stem, reports[script.stem]), flush=True)
            if arguments.bare:
                bare = play_bare(store, script, folder)
                print(line(script.stem + ", bare", bare), flush=True)
                print(beside_bare(reports[script.stem], bare))
        if arguments.plot:
            curves = {"p50": [], "p99": []}
            for clients in (1, 10, 50, 100, 200):
                script = folder / "sweep.toml"
                script.write_text(SWEEP.format(clients, "turbine-blade"))
                report = play(store, script, folder)
                for name, points in curves.items():
                    points.append((clients, report["latency_ms"]["pose_to_packet"][name] or 0.0))
                print(line("%d orbit" % clients, report), flush=True)
            plot.write(arguments.plot, "turbine-blade: pose to packet, ms, against clients that orbit it", curves)
        if arguments.json:
            arguments.json.write_text(json.dumps(reports, indent=1) + "\n")
    except (AssertionError, subprocess.SubprocessError, OSError) as error:
        print("run.sh: %s" % error, file=sys.stderr)
        return 1
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return 0 if held and all(report["passed"] for report in reports.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
