# SPDX-License-Identifier: Apache-2.0
"""Tokens, origins and TLS: what a client may not see, it does not see, and it is told what to do."""

import base64
import hashlib
import hmac
import json
import os
import socket
import ssl
import subprocess
import time
import unittest

from harness import BIN, DEADLINE_S, Case, Server, run
from meshes import torus
from rude_client import BINARY, WebSocket, hello, kind, open_dragon, vector

CATALOGUE, MODEL_INFO, ERROR = 9, 10, 16


def bearer(token):
    return ["Authorization: Bearer " + token]


def web_token(secret, claims, header={"alg": "HS256", "typ": "JWT"}):
    """A token as any other implementation makes it."""
    part = lambda value: base64.urlsafe_b64encode(json.dumps(value).encode()).rstrip(b"=").decode()
    text = part(header) + "." + part(claims)
    signature = hmac.new(secret.encode(), text.encode(), hashlib.sha256).digest()
    return text + "." + base64.urlsafe_b64encode(signature).rstrip(b"=").decode()


class Access(Case):

    def setUp(self):
        super().setUp()
        self.keys = self.folder / "keys"
        self.keys.write_text(run("limn-server", "token", "--new-key", "main"))

    def mint(self, *arguments):
        return run("limn-server", "token", "--key-file", self.keys, *arguments).strip()

    def test_nothing_is_told_without_a_token(self):
        with Server(self.store, "--token-key-file", self.keys) as server:
            refused = WebSocket(server.port)
            self.assertEqual((refused.status, refused.answer), (401, "send Authorization: Bearer TOKEN\n"))
            self.assertIn("www-authenticate: bearer", refused.headers)
            for path in ("/models", "/version", "/metrics", "/", "/other"):
                self.assertEqual(server.get(path), (401, "send Authorization: Bearer TOKEN\n"), path)
            self.assertEqual(server.get("/livez"), (200, "ok\n"))
            self.assertEqual(server.get("/readyz"), (200, "ok\n"))
            self.assertEqual(server.get("/metrics", server.metrics_port)[0], 200)
            self.assertEqual(server.metric('limn_connections_refused_total{reason="token"}'), 6)

    def test_only_good_tokens_let_anybody_in(self):
        secret = self.keys.read_text().split()[1]
        soon = time.time() + 60
        (self.folder / "other").write_text(run("limn-server", "token", "--new-key", "main"))
        good = self.mint("--models", "*")
        bad = {
            "has expired": web_token(secret, {"exp": time.time() - 1, "models": ["*"]}),
            "not valid yet": web_token(secret, {"exp": soon, "nbf": soon, "models": ["*"]}),
            "not signed": run("limn-server", "token", "--key-file", self.folder / "other", "--models", "*").strip(),
            "HS256": web_token(secret, {"exp": soon, "models": ["*"]}, {"alg": "none"}),
            "models": web_token(secret, {"exp": soon}),
            "exp": web_token(secret, {"models": ["*"]}),
            "three parts": "0123456789abcdef",
        }
        head, body, signature = good.split(".")
        tampered = [head + "." + body + "." + signature[::-1], head + "." + body[:-2] + "." + signature, good[:-1],
                    head + "." + web_token(secret, {"exp": soon, "models": ["a"]}).split(".")[1] + "." + signature]
        with Server(self.store, "--token-key-file", self.keys) as server:
            for why, token in bad.items():
                refused = WebSocket(server.port, headers=bearer(token))
                self.assertEqual(refused.status, 401, why)
                self.assertIn(why, refused.answer)
                self.assertEqual(server.get("/models", headers=bearer(token))[0], 401, why)
            for token in tampered:
                self.assertEqual(WebSocket(server.port, headers=bearer(token)).status, 401, token)
            for token in (good, web_token(secret, {"exp": soon, "models": []})):
                self.assertEqual(WebSocket(server.port, headers=bearer(token)).status, 101)
                self.assertEqual(server.get("/models", headers=bearer(token))[0], 200)

    def test_a_token_shows_its_models_and_no_others(self):
        self.prepare_shape("dragon", torus(24, 12))
        self.prepare_shape("secret", torus(24, 12))
        with Server(self.store, "--token-key-file", self.keys) as server:
            everything = bearer(self.mint("--models", "*"))
            deadline = time.monotonic() + DEADLINE_S
            while len(json.loads(server.get("/models", headers=everything)[1])) < 2:
                self.assertLess(time.monotonic(), deadline)
            for models, opens in (("dragon", True), ("secret", False), ("dra*,x", True), ("d", False)):
                token = bearer(self.mint("--models", models))
                names = [entry["name"] for entry in json.loads(server.get("/models", headers=token)[1])]
                self.assertEqual(names, ["dragon"] if opens else ["secret"] if models == "secret" else [], models)
                client = WebSocket(server.port, headers=token)
                client.send(hello())
                client.receive()
                client.send(vector("get_catalogue"))
                opcode, catalogue = client.receive()
                self.assertEqual((opcode, kind(catalogue)), (BINARY, CATALOGUE))
                self.assertEqual(b"dragon" in catalogue, opens, models)
                self.assertEqual(b"secret" in catalogue, models == "secret")
                client.send(open_dragon())
                answer = client.receive()[1]
                self.assertEqual(kind(answer), MODEL_INFO if opens else ERROR, models)
                if not opens:
                    self.assertIn(b"no model is named 'dragon'", answer, "as if it were not there")

    def test_clients_show_tokens_from_files_and_the_environment(self):
        self.prepare_shape("dragon", torus(24, 12))
        token = self.folder / "token"
        token.write_text(self.mint("--models", "dragon") + "\n")
        with Server(self.store, "--token-key-file", self.keys) as server:
            server.wait_for_metric('limn_models{state="ready"}', 1)
            self.draw(server.url, "dragon", "--token-file", token, "--until", "complete")
            command = [BIN / "limn-client", "render", "--server", server.url, "--model", "dragon", "--size", "64x64",
                       "--report", self.folder / "r.json"]
            outcomes = {}
            for value in (None, token.read_text().strip(), "nonsense"):
                environment = {**os.environ, **({"LIMN_TOKEN": value} if value else {})}
                outcomes[value] = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True,
                                                 stderr=subprocess.PIPE, timeout=DEADLINE_S)
            self.assertEqual([done.returncode for done in outcomes.values()], [1, 0, 1], outcomes)
            self.assertIn("the server asks for a token, give it with --token-file", outcomes[None].stderr)
            self.assertIn("does not take this token", outcomes["nonsense"].stderr)

    def test_tls_is_verified_and_carries_everything(self):
        self.prepare_shape("dragon", torus(24, 12))
        certificate, key = self.certificate()
        with Server(self.store, "--tls-cert", certificate, "--tls-key", key) as server:
            server.wait_for_metric('limn_models{state="ready"}', 1)
            url = "wss://localhost:%d" % server.port
            self.draw(url, "dragon", "--ca-file", certificate, "--until", "complete")
            dump = self.folder / "none.ply"
            run("limn-client", "render", "--server", url, "--model", "dragon", "--dump-mesh", dump, expect=1)
            self.assertFalse(dump.exists(), "a certificate that nobody vouches for")
            context = ssl.create_default_context(cafile=certificate)
            line = context.wrap_socket(socket.create_connection(("127.0.0.1", server.port), DEADLINE_S),
                                       server_hostname="localhost")
            self.assertIn(line.version(), ("TLSv1.2", "TLSv1.3"))
            client = WebSocket(server.port, line=line)
            client.send(hello())
            self.assertEqual(client.receive()[0], BINARY)
            plain = socket.create_connection(("127.0.0.1", server.port), DEADLINE_S)
            plain.sendall(b"GET /models HTTP/1.1\r\nHost: localhost\r\n\r\n")
            try:
                self.assertNotIn(b"dragon", plain.recv(4096))
            except ConnectionResetError:
                pass

    def test_pages_of_other_hosts_are_refused(self):
        with Server(self.store, "--origin", "viewer.example") as server:
            for origin, status in (("https://viewer.example", 101), ("http://localhost:3000", 101), ("http://evil.example", 403),
                                   ("https://viewer.example.evil.example", 403), ("null", 403)):
                client = WebSocket(server.port, headers=["Origin: " + origin])
                self.assertEqual(client.status, status, origin)
            self.assertEqual(client.answer, "pages of that origin may not connect\n")

    def test_a_key_that_is_none_is_said_in_a_line(self):
        self.keys.write_text("main too-short\n")
        for command in (["--store", self.store, "--token-key-file", self.keys],
                        ["token", "--key-file", self.keys, "--models", "a"]):
            done = subprocess.run([BIN / "limn-server", *command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                  timeout=DEADLINE_S)
            self.assertIn(done.returncode, (1, 2))
            self.assertIn("line 1: write a name, a blank, and a secret", done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1)
        self.assertIn("2", str(subprocess.run([BIN / "limn-server", "token"], stderr=subprocess.DEVNULL).returncode))


if __name__ == "__main__":
    unittest.main(verbosity=2)
