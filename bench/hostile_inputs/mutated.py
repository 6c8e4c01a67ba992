"""Valid inputs, damaged by a seeded generator."""

import random
import struct
import zlib

NASTY = [b"nan", b"-inf", b"1e999", b"-1", b"0", b"18446744073709551616", b"[[[[[[[[", b"{", b"}", b'"', b"\\",
         b"\n", b"\r\n", b"# ", b"../../etc/passwd", b"%s%n", b"\xff\xfe", b"&a *a", b"\x1b[2J", b"\0",
         b"4294967308", "\u202e".encode(), b"\n[[camera]]\n"]
NESTING = [b"[", b"{", b'{"a":', b"[{a = ", b"a.", b"- ", b"? ", b"("]


def damaged(data, rng):
    """With one to eight damages."""
    data = bytearray(data)
    for _ in range(rng.randint(1, 8)):
        at = rng.randrange(len(data) + 1)
        end = at + rng.randint(1, 32)
        kind = rng.randrange(8)
        if kind == 0 and at < len(data):
            data[at] ^= 1 << rng.randrange(8)
        elif kind == 1 and at < len(data):
            data[at] = rng.randrange(256)
        elif kind == 2:
            del data[at:end]
        elif kind == 3:
            data[at:at] = data[:end - at]
        elif kind == 4 and rng.random() < 0.3:
            del data[at:]
        elif kind == 5:
            data[at:end] = rng.choice(NASTY)
        elif kind == 6:
            data[at:at] = rng.choice(NESTING) * rng.randint(1, 4000)
        else:
            data[at:at + 4] = b"\x7f\xff\xff\xff"
    return bytes(data)


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def forged_map(good, rng):
    """A map whose records are damaged and whose checksum is right: bytes, doubles, counts, lengths."""
    payload = bytearray(good[24:])
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(payload) - 8)
        kind = rng.randrange(6)
        if kind == 0:
            payload[at] = rng.randrange(256)
        elif kind == 1:
            at -= at % 4
            payload[at:at + 4] = struct.pack(">i", rng.choice([-1, 0, 1, 2**31 - 1, -2**31, 10**6]))
        elif kind in (2, 3):
            value = rng.choice([float("nan"), float("inf"), -1.0, 0.0, 1e308, 5e-324, 1e6 + 1, rng.uniform(-10, 10)])
            payload[at:at + 8] = struct.pack(">d", value)
        elif kind == 4:
            del payload[at:at + rng.randint(1, 64)]
        else:
            payload[at:at] = payload[:rng.randint(1, 256)]
        if len(payload) < 16:
            payload += bytes(16)
    version = good[8:12] if rng.random() < 0.8 else struct.pack("<I", rng.choice([0, 1, 2, 3, 2**32 - 1]))
    length = len(payload) if rng.random() < 0.9 else rng.choice([0, 2**63, len(payload) + 1, 2**64 - 1])
    head = good[:8] + version + struct.pack("<Q", length)
    return head + struct.pack("<I", crc32c(head + payload)) + bytes(payload)


def png(width, height, depth=8, kind=0, rows=None, extra=b""):
    """Rows are zero unless given; they are compressed as they come."""
    channels = {0: 1, 2: 3, 4: 2, 6: 4}[kind]
    rows = height if rows is None else rows
    packer = zlib.compressobj(1)
    packed = b"".join(packer.compress(bytes(1 + (width * channels * depth + 7) // 8)) for _ in range(rows)) + packer.flush()
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0)) +
            extra + chunk(b"IDAT", packed) + chunk(b"IEND", b""))


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def with_checksums(data):
    """A damaged PNG whose chunks have right checksums, as far as chunks can be told."""
    at, out = 8, bytearray(data)
    while at + 12 <= len(out):
        length = struct.unpack_from(">I", out, at)[0]
        if at + 12 + length > len(out):
            break
        struct.pack_into(">I", out, at + 8 + length, zlib.crc32(out[at + 4:at + 8 + length]))
        at += 12 + length
    return bytes(out)


def jpeg(width, height, scans=0):
    """All of one grey; baseline, or progressive with so many scans behind the first."""
    def segment(marker, content):
        return bytes([0xFF, marker]) + struct.pack(">H", len(content) + 2) + content
    blocks = ((width + 7) // 8) * ((height + 7) // 8)
    table = bytes([1] + [0] * 15 + [0])  # one code, "0": no bits (DC), end of block (AC)
    head = b"\xff\xd8" + segment(0xDB, b"\0" + bytes([16] * 64))
    head += segment(0xC2 if scans else 0xC0, struct.pack(">BHHB", 8, height, width, 1) + b"\1\x11\0")
    head += segment(0xC4, b"\x00" + table) + segment(0xC4, b"\x10" + table)
    if not scans:
        return head + segment(0xDA, b"\1\1\0\0\x3f\0") + bytes((2 * blocks + 7) // 8) + b"\xff\xd9"
    data = bytes((blocks + 7) // 8)
    first = segment(0xDA, b"\1\1\0\0\0\0") + data
    return head + first + scans * (segment(0xDA, b"\1\1\0\1\x3f\0") + data) + b"\xff\xd9"


def generator(name):
    return random.Random(f"20261130 {name}")
