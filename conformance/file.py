# SPDX-License-Identifier: Apache-2.0
"""Chapter 80 of the specification: stream file."""
from __future__ import annotations

import zlib
from typing import Iterator

from conventions import Cursor, require
from packet import LARGEST_TICK
from scene import Limits, read_declaration

PACKET, INDEX, TRAILER, FIRST_EXTENSION = 1, 2, 3, 128
FIL_2 = ("truncated", "R-FIL-2")
FIL_6 = ("malformed", "R-FIL-6")


class File:
    """A scene declaration and the packets of the records after it; index and extension records are skipped."""

    def __init__(self, data: bytes, limits: Limits = Limits()):
        self.data, self.limits = data, limits
        self.declaration, self.first_record = read_declaration(data, limits)
        self.complete = False

    def packets(self) -> Iterator[tuple[int, bytes]]:
        """Yields the tick of each packet record and the packet; sets `complete` when the trailer was read."""
        tick = 0
        rest = Cursor(self.data, self.first_record, len(self.data))
        while rest.left() > 0:
            require(not self.complete, "malformed", "R-FIL-8")
            kind, payload = self.record(rest)
            self.complete = kind == TRAILER
            if kind == PACKET:
                content = Cursor(payload, 0, len(payload))
                tick += content.varint(FIL_6, FIL_6)
                require(tick <= LARGEST_TICK, *FIL_6)
                yield tick, payload[content.position:]

    def record(self, rest: Cursor) -> tuple[int, bytes]:
        start = rest.position
        kind = rest.number(1, FIL_2)
        size = rest.varint(FIL_2, FIL_6)
        require(kind in (PACKET, INDEX, TRAILER) or kind >= FIRST_EXTENSION, "unsupported", "R-FIL-3")
        require(kind != PACKET or size <= self.limits.packet_size + 6, "limit_exceeded", "R-FIL-4")
        require(kind != TRAILER or size == 8, *FIL_6)
        payload = rest.take(size, FIL_2)
        expected = zlib.crc32(self.data[start:rest.position])
        require(rest.number(4, FIL_2) == expected, "checksum", "R-FIL-5")
        return kind, payload
