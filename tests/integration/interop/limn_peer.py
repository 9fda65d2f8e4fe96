# SPDX-License-Identifier: Apache-2.0
"""python3 limn_peer.py URL VECTORS.json: opens a session with python3-websockets and prints what came first."""

import asyncio
import base64
import json
import pathlib
import struct
import sys

import websockets

WELCOME, CATALOGUE, MODEL_INFO, BASE = 8, 9, 10, 11


class Table:
    """A table of a FlatBuffer."""

    def __init__(self, data, at):
        self.data, self.at = data, at

    def field(self, index):
        vtable = self.at - struct.unpack_from("<i", self.data, self.at)[0]
        if 4 + 2 * index >= struct.unpack_from("<H", self.data, vtable)[0]:
            return 0
        offset, = struct.unpack_from("<H", self.data, vtable + 4 + 2 * index)
        return self.at + offset if offset else 0

    def indirect(self, index):
        at = self.field(index)
        return at + struct.unpack_from("<I", self.data, at)[0]

    def text(self, index):
        at = self.indirect(index)
        size, = struct.unpack_from("<I", self.data, at)
        return self.data[at + 4:at + 4 + size].decode()


def decode(data):
    assert data[4:8] == b"LIMN"
    root = Table(data, struct.unpack_from("<I", data)[0])
    return data[root.field(0)], Table(data, root.indirect(1))


async def talk(url, vectors):
    async with websockets.connect(url, subprotocols=["limn.1"], compression=None) as socket:
        seen = {"protocol": socket.subprotocol}
        await socket.send(vectors["hello"])
        while True:
            data = await asyncio.wait_for(socket.recv(), 30)
            kind, body = decode(data)
            if kind == WELCOME:
                seen["server"] = body.text(1)
                await socket.send(vectors["get_catalogue"])
            elif kind == CATALOGUE:
                seen["catalogueBytes"] = len(data)
                await socket.send(vectors["open"])
            elif kind == MODEL_INFO:
                seen["model"] = body.text(1)
            elif kind == BASE:
                seen["baseBytes"] = len(data)
                return seen
            else:
                raise AssertionError("message of type %d" % kind)


if __name__ == "__main__":
    messages = {name: base64.b64decode(text) for name, text in json.loads(pathlib.Path(sys.argv[2]).read_text()).items()}
    print(json.dumps(asyncio.run(talk(sys.argv[1], messages))))
