# SPDX-License-Identifier: Apache-2.0
"""limn-server as an installed service: its configuration file, and what it tells the service manager."""

import os
import pathlib
import re
import socket
import subprocess
import unittest

from harness import BIN, DEADLINE_S, Case, free_port, run

CONFIGURATION = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "limn-server.toml"


class Service(Case):
    def test_every_key_of_the_configuration_is_an_option(self):
        keys = re.findall(r"^(?:# )?([a-z-]+) = ", CONFIGURATION.read_text(), re.MULTILINE)
        self.assertGreater(len(keys), 10)
        options = set(re.findall(r"--([a-z-]+)", run("limn-server", "--help")))
        self.assertEqual([key for key in keys if key not in options], [])

    def test_the_configuration_is_accepted_as_it_is(self):
        server = subprocess.Popen(
            [BIN / "limn-server", "--config", CONFIGURATION, "--store", self.store,
             "--listen", "127.0.0.1:%d" % free_port()], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            self.assertIn("listening", server.stdout.readline())
        finally:
            server.kill()
            server.communicate()

    def test_the_service_manager_hears_that_it_is_ready_and_alive(self):
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
            path = str(self.folder / "notify")
            manager.bind(path)
            manager.settimeout(DEADLINE_S)
            # The watchdog is armed for this process alone, as systemd does; env keeps the number.
            server = subprocess.Popen(
                ["sh", "-c", 'WATCHDOG_PID=$$ exec "$0" "$@"', str(BIN / "limn-server"), "--store",
                 str(self.store), "--listen", "127.0.0.1:%d" % free_port()],
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                env={**os.environ, "NOTIFY_SOCKET": path, "WATCHDOG_USEC": "100000"})
            try:
                self.assertIn("READY=1", manager.recv(4096).decode())
                for _ in range(3):
                    self.assertEqual("WATCHDOG=1", manager.recv(4096).decode())
            finally:
                server.terminate()
                self.assertEqual(server.wait(DEADLINE_S), 0)


if __name__ == "__main__":
    unittest.main()
