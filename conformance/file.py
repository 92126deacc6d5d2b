# SPDX-License-Identifier: Apache-2.0
"""Chapter 80 of the specification: stream file."""
from __future__ import annotations

import zlib
from collections import Counter
from typing import Iterator, NamedTuple

from conventions import Cursor, require
from packet import LARGEST_NUMBER, LARGEST_TICK
from scene import Limits, read_declaration

PACKET, INDEX, TRAILER, NUMBERED, FIRST_EXTENSION = 1, 2, 3, 4, 128
PACKETS = (PACKET, NUMBERED)
FIL_2 = ("truncated", "R-FIL-2")
FIL_6 = ("malformed", "R-FIL-6")


class FilePacket(NamedTuple):
    tick: int
    number: int
    data: bytes


class File:
    """A scene declaration and the packets of the records after it; index and extension records are skipped."""

    def __init__(self, data: bytes, limits: Limits = Limits()):
        self.data, self.limits = data, limits
        self.declaration, self.first_record = read_declaration(data, limits)
        self.packet_type = 0                                # of all packet records, once there was one
        self.complete = False

    def packets(self) -> Iterator[FilePacket]:
        """Yields the packets; sets `complete` when the trailer was read."""
        several = len(self.declaration.substreams()) > 1
        tick, counts = 0, Counter()
        rest = Cursor(self.data, self.first_record, len(self.data))
        while rest.left() > 0:
            require(not self.complete, "malformed", "R-FIL-8")
            kind, payload = self.record(rest)
            self.complete = kind == TRAILER
            if kind in PACKETS:
                content = Cursor(payload, 0, len(payload))
                tick += content.varint(FIL_6, FIL_6)
                require(tick <= LARGEST_TICK, *FIL_6)
                number = content.varint(FIL_6, FIL_6) if kind == NUMBERED else 0
                packet = payload[content.position:]
                if kind == PACKET:
                    substream = packet[:1] if several else b""
                    counts[substream] += 1
                    number = counts[substream]
                require(1 <= number <= LARGEST_NUMBER, *FIL_6)
                yield FilePacket(tick, number, packet)

    def record(self, rest: Cursor) -> tuple[int, bytes]:
        start = rest.position
        kind = rest.number(1, FIL_2)
        size = rest.varint(FIL_2, FIL_6)
        require(kind in (*PACKETS, INDEX, TRAILER) or kind >= FIRST_EXTENSION, "unsupported", "R-FIL-3")
        if kind in PACKETS:
            require(self.packet_type in (0, kind), "malformed", "R-FIL-9")
            self.packet_type = kind
            most = self.limits.packet_size + (6 if kind == PACKET else 6 + 9)
            require(size <= most, "limit_exceeded", "R-FIL-4")
        require(kind != TRAILER or size == 8, *FIL_6)
        payload = rest.take(size, FIL_2)
        expected = zlib.crc32(self.data[start:rest.position])
        require(rest.number(4, FIL_2) == expected, "checksum", "R-FIL-5")
        return kind, payload
