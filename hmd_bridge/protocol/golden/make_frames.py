#!/usr/bin/env python3
"""Writes frames.json beside it: binary frames byte by byte, which the tests of both sides read. Laid out in PROTOCOL.md."""

import json
import pathlib
import struct
import zlib


def deflated(payload):
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    return packer.compress(payload) + packer.flush()


def frame(kind, flags, level, stream, count, revision, payload):
    body = deflated(payload) if flags & 1 else payload
    return struct.pack("<BBBBIIIQ", kind, flags, level, 0, stream, count, len(payload), revision) + body


def chunk(cells):
    bits = bytearray(512)
    for x, y, z in cells:
        v = x + 16 * y + 256 * z
        bits[v // 8] |= 1 << v % 8
    return bytes(bits)


def row(name, kind, flags, level, stream, count, revision, payload, good=True):
    return {"name": name, "good": good, "kind": kind, "flags": flags, "level": level, "stream": stream, "count": count,
            "revision": revision, "payload": payload.hex(),
            "hex": frame(kind, flags, level, stream, count, revision, payload).hex()}


corner, line = chunk([(0, 0, 0), (15, 15, 15)]), chunk([(x, 3, 7) for x in range(16)])
told = 1 << 0 | 1 << 5 | 1 << 63
filled = 1 << 5 | 1 << 63
block = struct.pack("<3iQQ", -2, 0, 1, told, filled) + corner + line
whole = struct.pack("<3iQQ", 3, -1, 0, 2**64 - 1, 1) + line
forget = struct.pack("<6i", -2, 0, 1, 7, 8, -9)
points = struct.pack("<6f", 0.25, -1.5, 2.0, 1e3, 0.0, -0.125)
cells = struct.pack("<4i", -4, 10, 5, 1) + bytes([0b10_01_00_10, 0b01])
labels = struct.pack("<3iI", 0, 0, -1, 2) + struct.pack("<4I", 1, 1, 1, 2) + struct.pack("<I", 2) + bytes([0x80, 0x01, 3, 0, 0, 1, 1])
pose = struct.pack("<7f", 1, 2, 1.5, 0, 0, 0, 1)
mesh = pose + struct.pack("<3I", 9, 3, 1) + struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<3I", 0, 1, 2)
gone = pose + struct.pack("<3I", 9, 0, 0)
voxels = struct.pack("<d2f", 0.05, 0.9, 0.2) + pose + struct.pack("<3i", -1, 0, 2) + corner + line

bad_index = pose + struct.pack("<3I", 9, 3, 1) + struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<3I", 0, 1, 3)
not_finite = pose + struct.pack("<3I", 9, 1, 0) + struct.pack("<3f", float("nan"), 0, 0)

rows = [
    row("block", 1, 0, 2, 0, 2, 57, block),
    row("block, deflated", 1, 1, 2, 0, 2, 57, block),
    row("block, whole", 1, 3, 0, 17, 1, 2**40, whole),
    row("forget", 2, 0, 1, 0, 2, 58, forget),
    row("points", 3, 1, 0, 12, 2, 0, points),
    row("cells", 4, 0, 0, 13, 5, 0, cells),
    row("labels", 5, 0, 0, 4, 2, 59, labels),
    row("mesh", 65, 1, 0, 14, 1, 0, mesh),
    row("mesh that is gone", 65, 0, 0, 15, 1, 1, gone),
    row("an empty look", 65, 0, 0, 16, 0, 2, pose),
    row("voxels", 66, 1, 0, 17, 1, 3, voxels),
    row("no such kind", 9, 0, 0, 0, 0, 0, b"", good=False),
    row("no such flag", 2, 4, 0, 0, 0, 0, b"", good=False),
    row("level too high", 2, 0, 6, 0, 0, 0, b"", good=False),
    row("block that ends early", 1, 0, 0, 0, 2, 0, block[:-1], good=False),
    row("block with filled chunks untold", 1, 0, 0, 0, 1, 0, struct.pack("<3iQQ", 0, 0, 0, 0, 1) + line, good=False),
    row("block that says more than it holds", 1, 0, 0, 0, 3, 0, block, good=False),
    row("forget that goes on", 2, 0, 0, 0, 1, 0, forget, good=False),
    row("labels that end early", 5, 0, 0, 4, 2, 59, labels[:-1], good=False),
    row("labels that go on", 5, 0, 0, 4, 2, 59, labels + bytes([0]), good=False),
    row("labels of a thing that is none", 5, 0, 0, 4, 2, 59, labels[:-1] + bytes([2]), good=False),
    row("mesh with a corner that is none", 65, 0, 0, 1, 1, 0, bad_index, good=False),
    row("mesh that is no number", 65, 0, 0, 1, 1, 0, not_finite, good=False),
    row("mesh that ends early", 65, 0, 0, 1, 1, 0, mesh[:-4], good=False),
    row("voxels that end early", 66, 0, 0, 1, 1, 0, voxels[:-1], good=False),
]
file = pathlib.Path(__file__).resolve().parent / "frames.json"
file.write_text("[\n" + ",\n".join(json.dumps(r) for r in rows) + "\n]\n")
