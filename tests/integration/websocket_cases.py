# SPDX-License-Identifier: Apache-2.0
"""A table of RFC 6455 cases for limn-server. Numbers are those of the Autobahn test suite, whose echo server ours is
not: where Autobahn wants an echo, a message here is GetCatalogue padded to its size, and its echo the Catalogue. Text is
no part of limn.1, so every text message ends in 1003, valid or not. A number with a letter is a case of our own beside
Autobahn's; one that begins with "rfc" has the section it is about."""

import collections
import struct

from rude_client import BINARY, CLOSE, CONTINUATION, PING, PONG, TEXT, vector

Case = collections.namedtuple("Case", "number what pieces wanted")
"""pieces: bytes objects, each sent by itself after the upgrade and Hello. wanted: what the server must answer."""

Answers = collections.namedtuple("Answers", "")  # a Catalogue (one, however often it was asked for before it is sent)
Echoes = collections.namedtuple("Echoes", "")  # a Catalogue for each piece, which waits for the one before
Pongs = collections.namedtuple("Pongs", "payloads then")  # pongs in this order, then a Catalogue or none
Closes = collections.namedtuple("Closes", "codes")  # a close frame with one of these codes; None: no code in it
Fails = collections.namedtuple("Fails", "")  # a close frame with 1002, or none: libwebsockets cuts some off without a word
CutOff = collections.namedtuple("CutOff", "")  # the connection ends, with a close frame or without

LIMIT = 64 * 1024
ASK = vector("get_catalogue")
MASK = b"\x37\xfa\x21\x3d"


def frame(opcode, payload=b"", final=True, rsv=0, masked=True, length_bytes=None):
    size = len(payload)
    if length_bytes is None:
        length_bytes = 0 if size < 126 else 2 if size < 65536 else 8
    head = bytes([(0x80 if final else 0) | rsv << 4 | opcode])
    bit = 0x80 if masked else 0
    if length_bytes == 0:
        head += bytes([bit | size])
    elif length_bytes == 2:
        head += bytes([bit | 126]) + struct.pack(">H", size)
    else:
        head += bytes([bit | 127]) + struct.pack(">Q", size)
    if not masked:
        return head + payload
    key = (MASK * (size // 4 + 1))[:size]
    return head + MASK + (int.from_bytes(payload, "big") ^ int.from_bytes(key, "big")).to_bytes(size, "big")


def ask(size=0):
    """GetCatalogue, padded to a size."""
    return ASK + bytes(max(0, size - len(ASK)))


def message(size=0):
    return frame(BINARY, ask(size))


def fragments(payload, sizes, opcode=BINARY):
    """Frames of one message, their payloads of the sizes given, the last one of what is left."""
    frames, at = [], 0
    for size in [*sizes, len(payload) - sum(sizes)]:
        frames.append(frame(CONTINUATION if frames else opcode, payload[at:at + size], at + size == len(payload)))
        at += size
    return frames


def even(payload, size):
    return fragments(payload, [size] * ((len(payload) - 1) // size))


def close(code=None, reason=b""):
    return frame(CLOSE, b"" if code is None else struct.pack(">H", code) + reason)


def chopped(data, size=1):
    return [data[i:i + size] for i in range(0, len(data), size)]


def whole(*frames):
    return [b"".join(frames)]


TOO_LARGE, POLICY, NO_TEXT, PROTOCOL, NOT_UTF8 = (Closes((code,)) for code in (1009, 1008, 1003, 1002, 1007))

VALID_UTF8 = [
    ("6.1.1", b""), ("6.2.1", "Hello-µ@ßöäüàá-UTF-8!!".encode()), ("6.5.1", "κόσμε".encode()),
    ("6.6.2", "κόσμε".encode()[:2]), ("6.6.5", "κ".encode() * 2), ("6.6.11", "κόσμε".encode() * 2),
    ("6.7.1", b"\x00"), ("6.7.2", b"\xc2\x80"), ("6.7.3", b"\xe0\xa0\x80"), ("6.7.4", b"\xf0\x90\x80\x80"),
    ("6.9.1", b"\x7f"), ("6.9.2", b"\xdf\xbf"), ("6.9.3", b"\xef\xbf\xbf"), ("6.9.4", b"\xf4\x8f\xbf\xbf"),
    ("6.11.1", b"\xed\x9f\xbf"), ("6.11.2", b"\xee\x80\x80"), ("6.11.3", b"\xef\xbf\xbd"), ("6.11.4", b"\xf4\x8f\xbf\xbf"),
    ("6.22.1", b"\xef\xbf\xbe"), ("6.22.2", b"\xef\xbf\xbf"), ("6.22.3", b"\xf0\x9f\xbf\xbe"), ("6.22.4", b"\xf0\x9f\xbf\xbf"),
    ("6.22.33", b"\xf4\x8f\xbf\xbe"), ("6.22.34", b"\xf4\x8f\xbf\xbf"), ("6.23.1", b"\xef\xbf\xb9"), ("6.23.4", b"\xef\xbf\xbc"),
    ("6.23.5", b"\xef\xbf\xbd"),
]
INVALID_UTF8 = [
    ("6.3.1", "κόσμε".encode() + b"\xed\xa0\x80edited"), ("6.4.1", "κόσμε".encode() + b"\xf4\x90\x80\x80edited"),
    ("6.6.1", b"\xce"), ("6.6.3", b"\xce\xba\xe1"), ("6.6.4", b"\xce\xba\xe1\xbd"), ("6.6.6", b"\xce\xba\xcf"),
    ("6.8.1", b"\xf8\x88\x80\x80\x80"), ("6.8.2", b"\xfc\x84\x80\x80\x80\x80"),
    ("6.10.1", b"\xf7\xbf\xbf\xbf"), ("6.10.2", b"\xfb\xbf\xbf\xbf\xbf"), ("6.10.3", b"\xfd\xbf\xbf\xbf\xbf\xbf"),
    ("6.11.5", b"\xf4\x90\x80\x80"), ("6.12.1", b"\x80"), ("6.12.2", b"\xbf"), ("6.12.3", b"\x80\xbf"),
    ("6.12.4", b"\x80\xbf\x80"), ("6.12.5", b"\x80\xbf\x80\xbf"), ("6.12.8", bytes(range(0x80, 0xc0))),
    ("6.13.1", b" ".join(bytes([c]) for c in range(0xc0, 0xe0)) + b" "), ("6.13.2", b" ".join(bytes([c]) for c in range(0xe0, 0xf0)) + b" "),
    ("6.13.3", b" ".join(bytes([c]) for c in range(0xf0, 0xf8)) + b" "), ("6.13.4", b"\xf8 \xf9 \xfa \xfb "), ("6.13.5", b"\xfc \xfd "),
    ("6.14.1", b"\xc0"), ("6.14.2", b"\xe0\x80"), ("6.14.3", b"\xf0\x80\x80"), ("6.14.6", b"\xdf"), ("6.14.7", b"\xef\xbf"),
    ("6.14.8", b"\xf7\xbf\xbf"), ("6.16.1", b"\xfe"), ("6.16.2", b"\xff"), ("6.16.3", b"\xfe\xfe\xff\xff"),
    ("6.17.1", b"\xc0\xaf"), ("6.17.2", b"\xe0\x80\xaf"), ("6.17.3", b"\xf0\x80\x80\xaf"), ("6.17.4", b"\xf8\x80\x80\x80\xaf"),
    ("6.18.1", b"\xc1\xbf"), ("6.18.2", b"\xe0\x9f\xbf"), ("6.18.3", b"\xf0\x8f\xbf\xbf"), ("6.18.4", b"\xf8\x87\xbf\xbf\xbf"),
    ("6.19.1", b"\xc0\x80"), ("6.19.2", b"\xe0\x80\x80"), ("6.19.3", b"\xf0\x80\x80\x80"),
    ("6.20.1", b"\xed\xa0\x80"), ("6.20.2", b"\xed\xad\xbf"), ("6.20.3", b"\xed\xae\x80"), ("6.20.4", b"\xed\xaf\xbf"),
    ("6.20.5", b"\xed\xb0\x80"), ("6.20.6", b"\xed\xbe\x80"), ("6.20.7", b"\xed\xbf\xbf"), ("6.21.1", b"\xed\xa0\x80\xed\xb0\x80"),
    ("6.21.2", b"\xed\xa0\x80\xed\xbf\xbf"), ("6.21.8", b"\xed\xaf\xbf\xed\xbf\xbf"),
]


def framing():
    """1.*: payloads of every length of length."""
    for i, size in enumerate((0, 125, 126, 127, 128, 65535, 65536), 1):
        yield Case("1.1.%d" % i, "text of %d bytes" % size, [frame(TEXT, b"*" * size)], NO_TEXT)
    yield Case("1.1.8", "text of 65536 bytes, chopped", chopped(frame(TEXT, b"*" * 65536), 997), NO_TEXT)
    yield Case("1.2.1", "an empty message is none of ours", [frame(BINARY)], POLICY)
    for i, size in enumerate((125, 126, 127, 128, 65535, 65536), 2):
        yield Case("1.2.%d" % i, "binary of %d bytes" % size, [message(size)], Answers())
    yield Case("1.2.8", "binary of 65536 bytes, chopped", chopped(message(65536), 997), Answers())
    yield Case("1.2.8a", "binary of 65537 bytes is over our limit", [message(65537)], TOO_LARGE)
    yield Case("1.2.8b", "a header that announces 2^40 bytes is enough",
               [bytes([0x82, 0xff]) + struct.pack(">Q", 1 << 40) + MASK + b"x"], TOO_LARGE)
    yield Case("rfc5.2a", "a length with its highest bit set", [bytes([0x82, 0xff]) + struct.pack(">Q", 1 << 63) + MASK], CutOff())


def pings():
    """2.*"""
    payloads = [b"", b"Hello, world!", b"\x00\xff\xfe\xfd\xfc\xfb\x00\xff", b"\xfe" * 125]
    for i, payload in enumerate(payloads, 1):
        yield Case("2.%d" % i, "ping of %d bytes" % len(payload), [frame(PING, payload)], Pongs((payload,), 0))
    yield Case("2.5", "ping of 126 bytes", [frame(PING, b"\xfe" * 126)], Fails())
    yield Case("2.6", "ping of 125 bytes, octet by octet", chopped(frame(PING, b"\xfe" * 125)), Pongs((b"\xfe" * 125,), 0))
    yield Case("2.7", "unsolicited pong, empty", whole(frame(PONG), message()), Answers())
    yield Case("2.8", "unsolicited pong with payload", whole(frame(PONG, b"unsolicited"), message()), Answers())
    yield Case("2.9", "unsolicited pong, then a ping", whole(frame(PONG, b"unsolicited"), frame(PING, b"ping")), Pongs((b"ping",), 0))
    # RFC 6455, 5.5.3: a ping that comes before the last one's pong need not be answered.
    many = [frame(PING, b"payload-%d" % i) for i in range(10)]
    yield Case("2.10", "ten pings at once: the first is answered, then the message", whole(*many, message()), Pongs((b"payload-0",), 1))
    yield Case("2.11", "ten pings, octet by octet", chopped(b"".join(many)) + [message()], Pongs((b"payload-0",), 1))
    yield Case("2.6a", "pong of 125 bytes", whole(frame(PONG, bytes(125)), message()), Answers())
    yield Case("2.5a", "pong of 126 bytes", [frame(PONG, bytes(126))], Fails())


def reserved_bits():
    """3.*"""
    for rsv in range(1, 8):
        for letter, opcode, payload in (("", TEXT, b"Hello"), ("a", BINARY, ASK), ("b", PING, b"p"), ("c", PONG, b"p"), ("d", CLOSE, b"\x03\xe8")):
            yield Case("3.%d%s" % (rsv, letter), "reserved bits %d with opcode %d" % (rsv, opcode),
                       whole(message(), frame(opcode, payload, rsv=rsv)), PROTOCOL)
    yield Case("3.4a1", "reserved bits, octet by octet", chopped(frame(BINARY, ASK, rsv=4)), Fails())
    yield Case("3.1a1", "reserved bits in a continuation", whole(fragments(ask(60), [30])[0], frame(CONTINUATION, bytes(30), rsv=1)), PROTOCOL)


def opcodes():
    """4.*"""
    for part, first in (("4.1", 3), ("4.2", 11)):
        for i in range(5):
            yield Case("%s.%d" % (part, i + 1), "reserved opcode %d" % (first + i), [frame(first + i)], PROTOCOL)
            yield Case("%s.%da" % (part, i + 1), "reserved opcode %d with payload, after a message" % (first + i),
                       whole(message(), frame(first + i, b"reserved"), frame(PING)), PROTOCOL)


def fragmentation():
    """5.*"""
    ping, pong = frame(PING, b"ping"), Pongs((b"ping",), 1)
    two = fragments(ask(200), [100])
    yield Case("5.1", "ping in two fragments", whole(frame(PING, b"fragment1", False), frame(CONTINUATION, b"fragment2")), PROTOCOL)
    yield Case("5.2", "pong in two fragments", whole(frame(PONG, b"fragment1", False), frame(CONTINUATION, b"fragment2")), PROTOCOL)
    yield Case("5.2a", "close that is not final", [frame(CLOSE, b"\x03\xe8", False)], PROTOCOL)
    yield Case("5.3", "a message in two fragments", two, Answers())
    yield Case("5.4", "at once", whole(*two), Answers())
    yield Case("5.5", "octet by octet", chopped(b"".join(two)), Answers())
    yield Case("5.6", "a ping in between", [two[0], ping, two[1]], pong)
    yield Case("5.7", "a ping in between, at once", whole(two[0], ping, two[1]), pong)
    yield Case("5.8", "a ping in between, octet by octet", chopped(two[0] + ping + two[1]), pong)
    yield Case("5.8a", "a pong in between", whole(two[0], frame(PONG), two[1]), Answers())
    stray, open_stray = frame(CONTINUATION, b"non-continuation"), frame(CONTINUATION, b"non-continuation", False)
    for first, piece in (("5.9", stray), ("5.12", open_stray)):
        number = int(first[2:])
        # A server that has closed may have reset the line before its close frame was read, if more is sent to it.
        yield Case("5.%d" % number, "a continuation of nothing", [piece], PROTOCOL)
        yield Case("5.%d" % (number + 1), "a continuation of nothing, at once", whole(piece, message()), PROTOCOL)
        yield Case("5.%d" % (number + 2), "a continuation of nothing, octet by octet", chopped(piece + message()), Fails())
    yield Case("5.15", "a continuation after a whole message", whole(*two, open_stray), PROTOCOL)
    yield Case("5.16", "continuations of nothing before messages", whole(open_stray, message(), open_stray, message()), PROTOCOL)
    yield Case("5.17", "final continuations of nothing before messages", whole(stray, message(), stray, message()), PROTOCOL)
    yield Case("5.18", "a second message instead of a continuation", whole(two[0], message()), PROTOCOL)
    yield Case("5.18a", "a second open message instead of a continuation", whole(two[0], two[0]), PROTOCOL)
    five = even(ask(250), 50)
    yield Case("5.19", "five fragments with pings after the second", whole(*five[:2], ping, *five[2:]), pong)
    yield Case("5.20", "five fragments with pings, apart", [*five[:2], ping, *five[2:]], pong)
    yield Case("5.19a", "empty fragments around the others", whole(*fragments(ask(200), [0, 100, 0])), Answers())
    yield Case("5.19b", "an empty fragment at the end", whole(frame(BINARY, ask(100), False), frame(CONTINUATION)), Answers())
    yield Case("5.19c", "a message after a fragmented one", whole(*two, message(), *two), Answers())


def utf8():
    """6.*: as text, refused whatever they are; as reasons of a close, where UTF-8 counts (7.5.1)."""
    for number, text in VALID_UTF8 + INVALID_UTF8:
        yield Case(number, "text", [frame(TEXT, text)], NO_TEXT)
    for number, text in VALID_UTF8:
        # 6.6.2 and so on are valid as they stand.
        yield Case(number + "r", "reason of a close", [close(1000, text)], Closes((1000,)))
    for number, text in INVALID_UTF8:
        yield Case(number + "r", "reason of a close, not UTF-8", [close(1000, text)], NOT_UTF8)
    yield Case("6.1.2", "empty fragments", whole(*fragments(b"", [0, 0], TEXT)), NO_TEXT)
    yield Case("6.2.2", "two fragments on a code point", whole(*fragments("Hello-µ@ßöä".encode(), [9], TEXT)), NO_TEXT)
    yield Case("6.2.4", "octet by octet", chopped(frame(TEXT, "κόσμε".encode())), NO_TEXT)


def closing():
    """7.*"""
    yield Case("7.1.1", "a message, then close", whole(message(), close(1000)), Closes((1000,)))
    yield Case("7.1.2", "close twice", whole(close(1000), close(1000)), Closes((1000,)))
    yield Case("7.1.3", "a ping after close", whole(close(1000), frame(PING, b"late")), Closes((1000,)))
    yield Case("7.1.4", "a message after close", whole(close(1000), message()), Closes((1000,)))
    yield Case("7.1.5", "close within a fragmented message", whole(fragments(ask(200), [100])[0], close(1000)), Closes((1000,)))
    yield Case("7.1.6", "a large message, then close, then a ping", whole(message(LIMIT), close(1000), frame(PING)), Closes((1000,)))
    yield Case("7.3.1", "close with nothing in it", [close()], Closes((None, 1000)))
    yield Case("7.3.2", "close with one byte", [frame(CLOSE, b"a")], PROTOCOL)
    yield Case("7.3.3", "close with a code", [close(1000)], Closes((1000,)))
    yield Case("7.3.4", "close with a code and a reason", [close(1000, b"Hello World!")], Closes((1000,)))
    yield Case("7.3.5", "close with a reason of 123 bytes", [close(1000, b"*" * 123)], Closes((1000,)))
    yield Case("7.3.6", "close with a reason of 124 bytes", [close(1000, b"*" * 124)], Fails())
    yield Case("7.5.1", "close with a reason that is not UTF-8", [close(1000, "κόσμε".encode() + b"\xed\xa0\x80edited")], NOT_UTF8)
    for i, code in enumerate((1000, 1001, 1002, 1003, 1007, 1008, 1009, 1010, 1011, 3000, 3999, 4000, 4999), 1):
        yield Case("7.7.%d" % i, "close with code %d" % code, [close(code)], Closes((code,)))
    # 1012 to 1014 were registered after the RFC; Autobahn lets a server do either.
    for i, code in enumerate((0, 999, 1004, 1005, 1006, 1016, 1100, 2000, 2999), 1):
        yield Case("7.9.%d" % i, "close with code %d" % code, [close(code)], PROTOCOL)
    yield Case("7.9.6a", "close with code 1015", [close(1015)], PROTOCOL)
    for i, code in enumerate((5000, 65535), 1):
        yield Case("7.13.%d" % i, "close with code %d" % code, [close(code)], Closes((code, 1002)))


def sizes():
    """9.*, reduced to our limit of 64 KiB."""
    for i, size in enumerate((4096, 16384, 32768, 65536), 1):
        yield Case("9.2.%d" % i, "a message of %d bytes" % size, [message(size)], Answers())
    for i, size in enumerate((256, 1024, 4096, 16384, 32768), 1):
        yield Case("9.4.%d" % i, "64 KiB in fragments of %d bytes" % size, whole(*even(ask(LIMIT), size)), Answers())
    for i, size in enumerate((64, 128, 256, 512, 1024, 2048), 1):
        yield Case("9.6.%d" % i, "16 KiB in segments of %d bytes" % size, chopped(message(16384), size), Answers())
    for i, size in enumerate((0, 16, 64, 256, 1024, 4096), 1):
        yield Case("9.8.%d" % i, "twenty messages of %d bytes" % size, [message(size)] * 20, Echoes())
    yield Case("9.4.6a", "a byte more than 64 KiB in fragments", whole(*even(ask(LIMIT + 1), 16384)), TOO_LARGE)
    for i, size in enumerate((256, 1024, 16384), 1):
        yield Case("9.3.%d" % i, "text in fragments of %d bytes" % size, fragments(b"*" * LIMIT, [size] * (LIMIT // size - 1), TEXT), NO_TEXT)
    yield Case("10.1.1", "64 KiB in fragments of 1300 bytes", whole(*even(ask(LIMIT), 1300)), Answers())


SECTIONS = {section.__name__: list(section()) for section in
            (framing, pings, reserved_bits, opcodes, fragmentation, utf8, closing, sizes)}
