# SPDX-License-Identifier: Apache-2.0
"""A slow network between a client and a server on this machine. Standard library only.

    python3 shaping_proxy.py --target 127.0.0.1:8600 --listen 127.0.0.1:8601 --down-kbps 1000 --delay-ms 40

Every connection gets a link of its own: so many kilobits a second each way, a delay each way, and a router's buffer in
front of the bottleneck, after which the sender has to wait.
"""

import argparse
import collections
import contextlib
import socket
import threading
import time

SEGMENT = 1400  # bytes read at once: about what a packet carries


class Pipe:
    """One direction of one connection."""

    def __init__(self, source, sink, bytes_per_second, delay_s, buffer_bytes):
        self.source, self.sink = source, sink
        self.rate, self.delay, self.room = bytes_per_second, delay_s, buffer_bytes
        self.queue, self.queued, self.ended = collections.deque(), 0, False
        self.changed = threading.Condition()
        self.passed = 0

    def start(self):
        for work in (self._fill, self._drain):
            threading.Thread(target=work, daemon=True).start()

    def _fill(self):
        free = 0.0  # when the bottleneck has passed all before
        with contextlib.suppress(OSError):
            while data := self.source.recv(SEGMENT):
                now = time.monotonic()
                free = max(free, now) + (len(data) / self.rate if self.rate else 0.0)
                with self.changed:
                    self.changed.wait_for(lambda: self.queued < self.room or self.ended)
                    self.queue.append((free + self.delay, data))
                    self.queued += len(data)
                    self.changed.notify_all()
        with self.changed:
            self.queue.append((time.monotonic() + self.delay, b""))
            self.changed.notify_all()

    def _drain(self):
        with contextlib.suppress(OSError):
            while True:
                with self.changed:
                    self.changed.wait_for(lambda: self.queue)
                    due, data = self.queue.popleft()
                    self.queued -= len(data)
                    self.changed.notify_all()
                time.sleep(max(0.0, due - time.monotonic()))
                if not data:
                    break
                self.sink.sendall(data)
                self.passed += len(data)
        with self.changed:
            self.ended = True
            self.changed.notify_all()
        for side in (self.source, self.sink):
            with contextlib.suppress(OSError):
                side.shutdown(socket.SHUT_RDWR)


class ShapingProxy:
    """Rates are bytes a second, None or 0 for no limit. As a context manager it closes its listener at the end; links
    that are open then end with their connections."""

    def __init__(self, target_port, down=None, up=None, delay_s=0.0, buffer_bytes=32 * 1024, host="127.0.0.1",
                 listen=("127.0.0.1", 0)):
        self.target, self.down, self.up = (host, target_port), down, up
        self.delay, self.buffer = delay_s, buffer_bytes
        self.links = []  # (from the server, from the client), by connection
        self.listener = socket.create_server(listen)
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def url(self):
        return "ws://127.0.0.1:%d" % self.port

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.listener.close()

    def _accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            server = socket.socket()
            # The kernel's own buffers would hide a slow link from its sender.
            for side, option in ((client, socket.SO_SNDBUF), (client, socket.SO_RCVBUF), (server, socket.SO_RCVBUF),
                                 (server, socket.SO_SNDBUF)):
                side.setsockopt(socket.SOL_SOCKET, option, 16 * 1024)
            try:
                server.connect(self.target)
            except OSError:
                client.close()
                continue
            for side in (client, server):
                side.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            link = (Pipe(server, client, self.down, self.delay, self.buffer),
                    Pipe(client, server, self.up, self.delay, self.buffer))
            self.links.append(link)
            for pipe in link:
                pipe.start()


def address(text):
    host, _, port = text.rpartition(":")
    return host or "127.0.0.1", int(port)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--target", type=address, required=True, metavar="HOST:PORT")
    parser.add_argument("--listen", type=address, default=("127.0.0.1", 0), metavar="HOST:PORT")
    parser.add_argument("--down-kbps", type=float, default=0, help="from the server; 0: no limit")
    parser.add_argument("--up-kbps", type=float, default=0, help="to the server; 0: no limit")
    parser.add_argument("--delay-ms", type=float, default=0, help="each way")
    parser.add_argument("--buffer-kib", type=int, default=32)
    options = parser.parse_args()
    proxy = ShapingProxy(options.target[1], options.down_kbps * 125, options.up_kbps * 125, options.delay_ms / 1000,
                         options.buffer_kib * 1024, options.target[0], options.listen)
    print("shaping_proxy: listening on %s" % proxy.url, flush=True)
    with contextlib.suppress(KeyboardInterrupt):
        threading.Event().wait()


if __name__ == "__main__":
    main()
