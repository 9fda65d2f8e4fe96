# SPDX-License-Identifier: Apache-2.0
"""Runs Limn's real programs against one another, over real sockets and files. Standard library only.

The environment: LIMN_BIN, the folder of the programs; LIMN_MODELS, a folder of real meshes (optional); LIMN_PREPARED, a
folder where prepared shapes are kept from test to test (optional).
"""

import contextlib
import hashlib
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time
import unittest

from meshes import canonical, manifold_fault, read_ply, write_obj

BIN = pathlib.Path(os.environ.get("LIMN_BIN", "build/dev/bin"))
PREPARED = pathlib.Path(os.environ["LIMN_PREPARED"]) if "LIMN_PREPARED" in os.environ else None
REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
DEADLINE_S = 120  # for anything: a hang is a failure, not a wait


def models():
    """The folder of real meshes, or None. An empty LIMN_MODELS means none."""
    named = os.environ.get("LIMN_MODELS")
    folder = pathlib.Path(named) if named else REPOSITORY.parent / "shared" / "models"
    return folder if named != "" and folder.is_dir() else None


# ---- Programs --------------------------------------------------------------------------------------------------------


def run(program, *arguments, expect=0):
    """Runs a program to its end; its standard output. A crash (death by signal) always fails."""
    command = [str(BIN / program), *map(str, arguments)]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=DEADLINE_S,
                          errors="replace")
    if expect is not None and done.returncode != expect:
        raise AssertionError("%s\n  exit status %d, expected %d\n%s%s" % (
            " ".join(command), done.returncode, expect, done.stdout[-2000:], done.stderr[-4000:]))
    if done.returncode < 0:
        raise AssertionError("%s died of signal %d\n%s" % (" ".join(command), -done.returncode, done.stderr[-4000:]))
    return done.stdout


def wait_until(condition, what, seconds=DEADLINE_S):
    """What the condition comes to, once that is something."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := condition():
            return found
        time.sleep(0.05)
    raise AssertionError("waited in vain: " + what)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Server:
    """A limn-server process; `port` survives restarts."""

    def __init__(self, store, *arguments):
        self.store, self.arguments, self.port, self.metrics_port = store, arguments, free_port(), 0
        self.process, self.log = None, ""

    @property
    def url(self):
        return "ws://127.0.0.1:%d" % self.port

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        if self.process and self.process.poll() is None:
            self.process.kill()
        if self.process:
            self.process.wait()
            self.process.stdout.close()

    def start(self):
        self.metrics_port = free_port()
        command = [str(BIN / "limn-server"), "--store", str(self.store), "--listen", "127.0.0.1:%d" % self.port,
                   "--metrics-listen", "127.0.0.1:%d" % self.metrics_port, *map(str, self.arguments)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                        errors="replace")
        ready = threading.Event()
        lines = []

        def read(stream):
            with contextlib.suppress(ValueError):  # closed meanwhile
                for line in stream:
                    lines.append(line)
                    if "listening on" in line:
                        ready.set()
            ready.set()

        threading.Thread(target=read, args=(self.process.stdout,), daemon=True).start()
        if not ready.wait(DEADLINE_S) or self.process.poll() is not None:
            raise AssertionError("limn-server did not start: " + "".join(lines))

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def terminate(self):
        """SIGTERM; the exit status."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(DEADLINE_S)

    def get(self, path, port=None, headers=()):
        """Status and body of a GET, on the main port unless told."""
        lines = ["GET %s HTTP/1.1" % path, "Host: localhost", "Connection: close", *headers]
        with socket.create_connection(("127.0.0.1", port or self.port), timeout=10) as line:
            line.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
            answer = b"".join(iter(lambda: line.recv(65536), b""))
        head, _, body = answer.partition(b"\r\n\r\n")
        if b"transfer-encoding: chunked" in head.lower():
            parts = []
            while body:
                size, _, body = body.partition(b"\r\n")
                length = int(size.split(b";")[0], 16)
                parts.append(body[:length])
                body = body[length + 2:]
                if not length:
                    break
            body = b"".join(parts)
        return int(head.split()[1]), body.decode()

    def metric(self, series):
        """The number of one series, "name" or 'name{label="value"}'."""
        for line in self.get("/metrics", self.metrics_port)[1].splitlines():
            name, _, value = line.rpartition(" ")
            if name == series:
                return float(value)
        raise AssertionError("no metric " + series)

    def wait_for_metric(self, series, least):
        end = time.monotonic() + DEADLINE_S
        while self.metric(series) < least:
            assert time.monotonic() < end, "%s stays at %g" % (series, self.metric(series))
            time.sleep(0.02)

    def wait_for_model(self, name, state="ready"):
        end = time.monotonic() + DEADLINE_S
        while time.monotonic() < end:
            for entry in json.loads(self.get("/models")[1]):
                if entry["name"] == name and entry["state"] in (state, "failed"):
                    assert entry["state"] == state, entry
                    return entry
            time.sleep(0.05)
        raise AssertionError("%s did not become %s" % (name, state))


class Proxy:
    """Stands between a client and a server: counts and throttles what the server sends, and calls `at_bytes()` once
    when `cut_after` bytes have passed; that connection is then cut, and what was under way on it is lost."""

    def __init__(self, port, bytes_per_second=2_000_000, cut_after=None, at_bytes=None):
        self.target, self.rate, self.cut_after, self.at_bytes = port, bytes_per_second, cut_after, at_bytes
        self.received = []  # bytes from the server, by connection
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.closed = False
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def url(self):
        return "ws://127.0.0.1:%d" % self.port

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.closed = True
        self.listener.close()

    def _accept(self):
        while not self.closed:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            try:
                server = socket.create_connection(("127.0.0.1", self.target), timeout=10)
            except OSError:
                client.close()  # the server is down; the client will try again
                continue
            index = len(self.received)
            self.received.append(0)
            threading.Thread(target=self._pump, args=(client, server, None), daemon=True).start()
            threading.Thread(target=self._pump, args=(server, client, index), daemon=True).start()

    def _pump(self, source, sink, index):
        with contextlib.suppress(OSError):
            while data := source.recv(16384 if index is not None else 65536):
                if index is not None:
                    self.received[index] += len(data)
                    time.sleep(len(data) / self.rate)
                    if self.cut_after is not None and sum(self.received) >= self.cut_after:
                        self.cut_after = None
                        self.at_bytes()
                        break
                sink.sendall(data)
        for side in (source, sink):
            with contextlib.suppress(OSError):
                side.shutdown(socket.SHUT_RDWR)
            side.close()


def make_certificate(folder):
    """Files of a certificate for localhost that signs itself, and of its key."""
    certificate, key = folder / "server.pem", folder / "server.key"
    if not certificate.exists():
        subprocess.run(
            ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2",
             "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost,IP:127.0.0.1", "-keyout", key, "-out",
             certificate], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=DEADLINE_S)
    return certificate, key


class Case(unittest.TestCase):
    """A test with a scratch folder and a store in it."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="limn-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.store = self.folder / "store"

    def certificate(self):
        return make_certificate(self.folder)

    def prepare(self, source, name, *arguments):
        """The report, and the prepared mesh as limn-prepare dumps it."""
        dump = self.folder / (name + "-prepared.ply")
        out = run("limn-prepare", source, "--store", self.store, "--name", name, "--dump-mesh", dump, "--json", *arguments)
        report = json.loads(out)
        return (report[0] if isinstance(report, list) else report), read_ply(dump)

    def prepare_shape(self, name, shape, *arguments):
        """As prepare(). What any test has prepared before is not prepared again: its asset is put into the store, where
        limn-prepare finds it and checks it."""
        source = write_obj(self.folder / (name + ".obj"), shape)
        program = (BIN / "limn-prepare").stat()
        what = repr((program.st_mtime_ns, program.st_size, arguments)).encode() + source.read_bytes()
        kept = PREPARED and PREPARED / hashlib.sha256(what).hexdigest()
        if kept and kept.is_dir():
            shutil.copytree(kept, self.store / "assets", dirs_exist_ok=True)
        report, mesh = self.prepare(source, name, *arguments)
        if kept and not kept.is_dir():
            PREPARED.mkdir(exist_ok=True)
            copy = pathlib.Path(tempfile.mkdtemp(dir=PREPARED))
            shutil.copytree(self.store / "assets" / report["asset"], copy / report["asset"])
            try:
                copy.rename(kept)
            except OSError:  # another test was faster
                shutil.rmtree(copy)
        return report, mesh

    def draw(self, url, name, *arguments, expect=0):
        """limn-client render: its report, and its mesh. Nothing is drawn unless the arguments say what to draw into:
        that would take ten times as long as the rest."""
        dump, report = self.folder / "client.ply", self.folder / "client.json"
        frames = () if {"--out", "--dump-lines"} & set(arguments) else ("--frames", 0)
        run("limn-client", "render", "--server", url, "--model", name, "--size", "64x64", "--dump-mesh", dump, "--report",
            report, *frames, *arguments, expect=expect)
        return json.loads(report.read_text()), read_ply(dump)

    def assert_same_mesh(self, got, wanted, label):
        self.assertEqual(len(got.faces), len(wanted.faces), label)
        self.assertEqual(len(got.positions), len(wanted.positions), label)
        if canonical(got) != canonical(wanted):
            self.fail("%s: the faces differ" % label)

    def assert_manifold(self, mesh, label):
        self.assertGreater(len(mesh.faces), 0, label)
        self.assertIsNone(manifold_fault(mesh), label)
