# SPDX-License-Identifier: Apache-2.0
"""Clients that are not ours, in other languages and libraries, open a session and read its first messages. What is not
installed is skipped: python3-websockets, npm's ws (NODE_PATH says where), Chromium."""

import base64
import functools
import http.server
import json
import os
import pathlib
import queue
import shutil
import signal
import subprocess
import sys
import threading
import unittest

from harness import DEADLINE_S, Case, Server
from meshes import torus
from rude_client import hello, open_dragon, vector

PEERS = pathlib.Path(__file__).resolve().parent / "interop"

PAGE = """<!doctype html><script src="limn_peer.js"></script><script>
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
const vectors = Object.fromEntries(Object.entries(%s).map(([name, text]) => [name, bytes(text)]));
const say = (value) => fetch("/seen", {method: "POST", body: value});
addEventListener("load", () => talk(new WebSocket("%s", "limn.1"), vectors)
  .then((seen) => say(JSON.stringify(seen)), (error) => say(error.message)));
</script><body></body>
"""


def works(*command, **options):
    try:
        return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=DEADLINE_S,
                              **options).returncode == 0
    except OSError:
        return False


class Interop(Case):

    def setUp(self):
        super().setUp()
        messages = {"hello": hello(), "get_catalogue": vector("get_catalogue"), "open": open_dragon()}
        self.messages = {name: base64.b64encode(data).decode() for name, data in messages.items()}
        self.vectors = self.folder / "vectors.json"
        self.vectors.write_text(json.dumps(self.messages))

    def serve(self, *arguments):
        self.prepare_shape("dragon", torus(24, 12))
        server = Server(self.store, *arguments)
        server.start()
        self.addCleanup(server.__exit__)
        server.wait_for_model("dragon")
        return server

    def check(self, text):
        seen = json.loads(text)
        self.assertEqual((seen["protocol"], seen["model"]), ("limn.1", "dragon"))
        self.assertIn("limn-server", seen["server"])
        self.assertGreater(seen["baseBytes"], 100)

    def run_peer(self, *command, **options):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=DEADLINE_S, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_python_websockets(self):
        python = next((p for p in (sys.executable, "/usr/bin/python3") if works(p, "-c", "import websockets")), None)
        if not python:
            self.skipTest("no python3-websockets")
        server = self.serve()
        self.check(self.run_peer(python, "-B", PEERS / "limn_peer.py", server.url, self.vectors))

    def test_npm_ws(self):
        places = [p for p in (os.environ.get("NODE_PATH", ""), "/usr/share/nodejs", "/usr/lib/node_modules",
                              "/usr/local/lib/node_modules") if p]
        environment = {**os.environ, "NODE_PATH": os.pathsep.join(places)}
        if not works("node", "-e", "require('ws')", env=environment):
            self.skipTest("no node with ws")
        server = self.serve()
        self.check(self.run_peer("node", PEERS / "limn_peer.js", server.url, self.vectors, env=environment))

    def test_chromium(self):
        browser = next(filter(None, map(shutil.which, ("chromium", "chromium-headless-shell", "google-chrome"))), None)
        if not browser:
            self.skipTest("no Chromium")
        server = self.serve()
        shutil.copy(PEERS / "limn_peer.js", self.folder)
        (self.folder / "page.html").write_text(PAGE % (json.dumps(self.messages), server.url))

        seen = queue.Queue()

        class Pages(http.server.SimpleHTTPRequestHandler):
            def log_message(self, *_):
                pass

            def do_POST(self):
                seen.put(self.rfile.read(int(self.headers["Content-Length"])).decode())
                self.send_response(204)
                self.end_headers()

        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Pages, directory=self.folder)) as pages:
            threading.Thread(target=pages.serve_forever, daemon=True).start()
            page = "http://127.0.0.1:%d/page.html" % pages.server_address[1]
            peer = subprocess.Popen([browser, "--headless", "--no-sandbox", "--disable-gpu", page,
                                     "--user-data-dir=%s" % (self.folder / "profile")],
                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
            try:
                self.check(seen.get(timeout=DEADLINE_S))
            finally:
                os.killpg(peer.pid, signal.SIGKILL)
                peer.wait()
                pages.shutdown()


if __name__ == "__main__":
    unittest.main(verbosity=2)
