# SPDX-License-Identifier: Apache-2.0
"""Killing any side at any moment loses nothing; damage on disk is noticed and repaired."""

import json
import subprocess
import threading
import time
import unittest

from harness import BIN, Case, Proxy, Server, run
from meshes import hills, torus, write_obj

LARGE = torus(160, 80, 0.3)  # 25,600 faces


class Crash(Case):

    def test_a_client_goes_on_after_the_server_was_killed(self):
        # So large that what is lost with the line (a packet or two) is little of it; open, since hulls take time.
        report, wanted = self.prepare_shape("large", hills(260, 200), "--viewpoints", "2x1")
        whole = report["bytes"]["base"] + report["bytes"]["level_blocks"] + report["bytes"]["splits"]
        with Server(self.store) as server:

            def restart():
                server.kill()
                server.start()

            # So slow a line that even a sanitized client keeps up, and holds what the proxy has passed on.
            with Proxy(server.port, 100_000, whole // 2, restart) as proxy:
                client, mesh = self.draw(proxy.url, "large", "--until", "complete")
                self.assertEqual(client["state"], "complete")
                self.assert_same_mesh(mesh, wanted, "after a restart")
                self.assertGreaterEqual(len(proxy.received), 2, "the line was cut")
                # It resumes: what it holds is not sent again, what was under way is.
                self.assertGreaterEqual(client["bytes"]["packets"], 0.9 * report["bytes"]["splits"])
                self.assertLess(client["bytes"]["packets"], 1.25 * report["bytes"]["splits"])
                self.assertEqual(client["bytes"]["base"] + client["bytes"]["level_blocks"],
                                 report["bytes"]["base"] + report["bytes"]["level_blocks"])

    def test_a_killed_client_leaves_the_server_serving(self):
        _, wanted = self.prepare_shape("large", LARGE)
        with Server(self.store) as server:
            killed = threading.Event()
            with Proxy(server.port, 100_000, 20_000, killed.set) as proxy:
                client = subprocess.Popen(
                    [BIN / "limn-client", "render", "--server", proxy.url, "--model", "large", "--until", "complete",
                     "--dump-mesh", self.folder / "never.ply"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                self.assertTrue(killed.wait(60))
                client.kill()
                client.wait()
            self.assertFalse((self.folder / "never.ply").exists())
            _, mesh = self.draw(server.url, "large", "--until", "complete")
            self.assert_same_mesh(mesh, wanted, "the next client")

    def test_sigterm_drains_and_exits_cleanly(self):
        self.prepare_shape("hills", hills(60, 40))
        with Server(self.store) as server:
            self.draw(server.url, "hills", "--until", "settled")
            self.assertEqual(server.get("/livez")[0], 200)
            self.assertEqual(server.get("/readyz")[0], 200)
            self.assertEqual(server.terminate(), 0)

    def test_a_killed_preparation_leaves_no_half_asset(self):
        source = write_obj(self.folder / "large.obj", torus(64, 32, 0.3))
        command = [BIN / "limn-prepare", source, "--store", self.store, "--name", "large"]
        started = time.monotonic()
        run(*map(str, ["limn-prepare", source, "--store", self.folder / "elsewhere", "--name", "large"]))
        whole = time.monotonic() - started
        # Kills spread over the whole of a run, its last milliseconds included.
        for step in range(1, 13):
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                process.wait(whole * step / 12)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            assets = self.store / "assets"
            for asset in assets.iterdir() if assets.is_dir() else []:
                manifest = json.loads((asset / "manifest.json").read_text())
                for section in manifest["sections"]:
                    self.assertEqual((asset / section["file"]).stat().st_size, section["bytes"], section["file"])
        _, wanted = self.prepare(source, "large")
        with Server(self.store) as server:
            _, mesh = self.draw(server.url, "large", "--until", "complete")
            self.assert_same_mesh(mesh, wanted, "after twelve kills")
        self.assertEqual(list((self.store / "tmp").iterdir()), [], "nothing is left over")

    def test_a_flipped_byte_in_any_file_is_noticed_and_the_asset_rebuilt(self):
        source = write_obj(self.folder / "hills.obj", hills(24, 16))
        report, wanted = self.prepare(source, "hills")
        asset = self.store / "assets" / report["asset"]
        files = {f.name: f.read_bytes() for f in sorted(asset.iterdir())}
        self.assertGreater(len(files), 4)
        for index, name in enumerate(list(files)):
            whole = files[name]
            positions = [0, len(whole) // 2, max(len(whole) - 1, 0)]
            # Each is noticed; the asset is rebuilt after the last, which is at another place in every file.
            for position in positions[index % 3 + 1:] + positions[:index % 3 + 1]:
                damaged = bytearray(whole or b"\x10")  # an empty file cannot lose a byte, but gain one
                damaged[position] ^= 0x10
                (asset / name).write_bytes(damaged)
                if name != "forest.bin":  # the server's alone; a client does not read it
                    run("limn-client", "render", "--asset", asset, "--dump-mesh", self.folder / "x.ply", expect=1)
            again, mesh = self.prepare(source, "hills")
            self.assertEqual(again["asset"], report["asset"])
            self.assert_same_mesh(mesh, wanted, name)
            label = "%s is rebuilt, byte %d" % (name, position)
            if name.startswith("manifest"):  # holds the times of its preparation, so a new one differs
                self.assertNotEqual((asset / name).read_bytes(), bytes(damaged), label)
                files = {f.name: f.read_bytes() for f in asset.iterdir()}
            else:
                self.assertEqual((asset / name).read_bytes(), whole, label)

    def test_a_server_rebuilds_a_damaged_asset_of_its_models(self):
        folder = self.folder / "models"
        folder.mkdir()
        source = write_obj(folder / "hills.obj", hills(60, 40))
        report, wanted = self.prepare(source, "hills")
        damaged = self.store / "assets" / report["asset"] / "packets.bin"
        data = bytearray(damaged.read_bytes())
        data[len(data) // 2] ^= 1
        damaged.write_bytes(data)
        with Server(self.store, "--models", folder) as server:
            server.wait_for_model("hills")
            _, mesh = self.draw(server.url, "hills", "--until", "complete")
            self.assert_same_mesh(mesh, wanted, "rebuilt")


if __name__ == "__main__":
    unittest.main(verbosity=2)
