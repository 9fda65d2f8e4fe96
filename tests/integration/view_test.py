# SPDX-License-Identifier: Apache-2.0
"""limn-client view in a window of a virtual display, driven by keys and a pointer as a user would."""

import contextlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import png
from harness import BIN, DEADLINE_S, Case, Server, wait_until
from meshes import hills, torus, write_obj


class Window:
    """A virtual display with limn-client view on it."""

    def __init__(self, folder, *arguments):
        self.folder, self.arguments = folder, arguments

    def __enter__(self):
        # Xvfb chooses a free display and says which; without -noreset it would start anew, and lose whoever is just
        # connecting, whenever the last of xdotool's looks for a window ends.
        read, write = os.pipe()
        self.display = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-noreset", "-screen", "0", "1000x800x24"],
                                        pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as numbers:
            self.environment = dict(os.environ, DISPLAY=":" + numbers.readline().strip())
        try:
            self.start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def start(self):
        self.client = subprocess.Popen(
            [str(BIN / "limn-client"), "view", *map(str, self.arguments), "--size", "800x600", "--save-to", self.folder,
             "--remember", self.folder / "memory.json", "--report", self.folder / "report.json"],
            env=self.environment, stderr=subprocess.PIPE, text=True)
        self.window = wait_until(lambda: self.xdotool("search", "--name", "Limn"), "a window").split()[0]

    def __exit__(self, *_):
        for process in (self.client, self.display):
            with contextlib.suppress(ProcessLookupError):
                process.kill()
            process.wait()
        self.client.stderr.close()

    def xdotool(self, *arguments):
        return subprocess.run(["xdotool", *map(str, arguments)], env=self.environment, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True, timeout=DEADLINE_S).stdout.strip()

    def key(self, name):
        # Held for longer than a frame: keys are looked at once a frame.
        self.xdotool("keydown", name, "sleep", 0.3, "keyup", name, "sleep", 0.1)

    def drag(self, button, dx, dy):
        self.xdotool("mousemove", 600, 400, "mousedown", button, "sleep", 0.3, "mousemove_relative", "--sync", "--", dx, dy,
                     "sleep", 0.3, "mouseup", button)

    def picture(self, number, suffix=".png", model="one"):
        """Asks for a picture by its key, waits for the file."""
        path = self.folder / ("%s-%03d%s" % (model, number, suffix))
        end = time.monotonic() + DEADLINE_S
        while not path.exists() and time.monotonic() < end:  # before the first picture there is nothing to save
            self.key("p" if suffix == ".png" else "v")
            with contextlib.suppress(AssertionError):
                wait_until(path.exists, path.name, 5)
        self.last = path
        return path.read_bytes()

    def quit(self):
        end = time.monotonic() + DEADLINE_S
        while self.client.poll() is None and time.monotonic() < end:  # a window that is just opening hears no key yet
            self.key("q")
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.client.wait(2)
        assert self.client.poll() == 0, self.client.stderr.read() if self.client.poll() is not None else "does not quit"
        return json.loads((self.folder / "report.json").read_text())


def ink(path):
    """Share of dark pixels."""
    width, height, rows = png.read(path)
    return sum(sum(red < 128 for red in row[::3]) for row in rows) / (width * height)


@unittest.skipUnless(shutil.which("Xvfb") and shutil.which("xdotool"), "Xvfb and xdotool are not installed")
class View(Case):

    def test_a_server_is_browsed_turned_and_saved(self):
        self.prepare_shape("one", torus(48, 24))
        self.prepare_shape("two", hills(20, 20))
        with Server(self.store) as server, Window(self.folder, "--server", server.url, "--model", "one") as window:
            wait_until(lambda: "one" in window.xdotool("getwindowname", window.window), "the model")
            first = window.picture(1)
            self.assertEqual(png.read(window.last)[:2], (800, 600))
            self.assertGreater(ink(window.last), 0.001)
            window.drag(1, 120, 40)
            turned = window.picture(2)
            self.assertNotEqual(turned, first)
            window.drag(3, 60, 0)
            slid = window.picture(3)
            self.assertNotEqual(slid, turned)
            window.xdotool("mousemove", 600, 400, "click", 4, "sleep", 0.2, "click", 4)
            self.assertNotEqual(window.picture(4), slid)
            window.key("r")
            window.drag(1, -80, 20)
            window.key("r")
            recorded = wait_until(lambda: list(self.folder.glob("one-*-path.json")), "a camera path")[0]
            self.assertGreater(len(json.loads(recorded.read_text())), 1)
            self.draw(server.url, "one", "--path", recorded, "--frames", 3, "--out", self.folder / "r%d.png")
            self.assertNotEqual((self.folder / "r0.png").read_bytes(), (self.folder / "r2.png").read_bytes())
            window.key("h")
            window.key("s")  # the next style
            self.assertNotEqual(window.picture(5), first)
            self.assertIn(b"<svg", window.picture(1, ".svg"))
            window.key("n")
            wait_until(lambda: "two" in window.xdotool("getwindowname", window.window), "the next model")
            window.picture(1, model="two")
            report = window.quit()
            self.assertEqual(report["model"], "two")
            self.assertEqual(len(report["saved"]), 8)
            self.assertNotEqual(json.loads((self.folder / "memory.json").read_text())["style"], "pencil")

    def test_every_key_and_every_control_of_the_menu_can_be_used(self):
        self.prepare_shape("one", torus(48, 24))
        self.prepare_shape("two", hills(20, 20))
        with Server(self.store) as server, Window(self.folder, "--server", server.url, "--model", "one") as window:
            wait_until(lambda: "one" in window.xdotool("getwindowname", window.window), "the model")
            window.picture(1)
            for key in ("F1", "F1", "n", "b", "s", "a", "s", "d", "w", "w", "x", "o", "l", "t", "m", "m", "h"):
                window.key(key)
            # Clicks all the way up and down the panel open its sections, change what they hold and press its buttons;
            # which click meets what depends on what is open by then.
            clicks = [("mousemove", 60, y, "click", 1, "sleep", 0.05) for y in range(590, 20, -12)]
            window.xdotool(*(word for click in clicks + clicks[::-1] for word in click))
            window.xdotool("mousemove", 600, 400, "click", "--repeat", 2, "--delay", 80, 1)  # flies there
            self.assertIsNone(window.client.poll(), "the window is gone")
            report = window.quit()
        self.assertGreater(report["pictures"], 10)
        chosen = json.loads((self.folder / "memory.json").read_text())
        before = {"style": "pencil", "draw": "strokes", "hidden": "style", "orthographic": False, "width_px": 0.0,
                  "texture_size": 1.0, "detector": "exact"}
        self.assertGreater(sum(chosen[key] != value for key, value in before.items()), 3, chosen)

    def test_a_lost_server_is_found_again(self):
        self.prepare_shape("one", torus(48, 24))
        with Server(self.store) as server, Window(self.folder, "--server", server.url) as window:
            wait_until(lambda: "one" in window.xdotool("getwindowname", window.window), "the server's first model")
            window.picture(1)
            server.kill()
            window.drag(1, 80, 0)  # still answers
            window.picture(2)
            server.start()
            window.drag(1, 80, 0)
            window.picture(3)
            self.assertEqual(window.quit()["model"], "one")

    def test_a_file_that_is_no_mesh_is_said_in_the_window(self):
        (self.folder / "bad.obj").write_text("hello\n")
        with Window(self.folder, "--mesh", self.folder / "bad.obj") as window:
            self.assertEqual(window.quit()["pictures"], 0)

    def test_a_mesh_file_is_shown(self):
        mesh = write_obj(self.folder / "mesh.obj", torus(24, 12))
        with Window(self.folder, "--mesh", mesh) as window:
            wait_until(lambda: "mesh" in window.xdotool("getwindowname", window.window), "the mesh")
            window.picture(1, model="mesh")
            self.assertGreater(ink(window.last), 0.001)
            window.quit()


if __name__ == "__main__":
    unittest.main(verbosity=2)
