# SPDX-License-Identifier: Apache-2.0
"""Chapter 70 of the specification, section 2: the syntax of datagrams."""
from __future__ import annotations

import struct
import zlib
from typing import Iterator

from conventions import Cursor, require, zigzag

UP, DOWN = 0, 1
HANDSHAKE, PARTS, PACKET = range(3)                         # forms
JOIN, WELCOME, REFUSAL, LEAVE = range(4)                    # kinds of handshakes
FORMS, KINDS = 4, 4                                         # how many there are, the reserved form among them
ACK, CLOCK, BUTTONS, PIECE, STATE, HASH, FRAGMENT, PACKET_PART = range(1, 9)
REPORT = PIECE                                              # up
TICK_MAPPING, SEAT, BASELINES = BUTTONS, STATE, HASH                # down
ACKNOWLEDGED = 1                                            # the last policy of baselines
LARGEST_DATAGRAM = 1200
BYE, WRONG_VERSION, FULL, TOO_LARGE, SILENCE, NO_SCENE, PROTOCOL = range(7)   # reasons
NO_TIMING, END_OF_TIME = 65535, 1 << 53
END_OF_TICKS, FARTHEST_OFFSET = 1 << 32, 1 << 33

CUT, SPARE = ("truncated", "R-SES-3"), ("malformed", "R-SES-3")


def check_of(body: bytes, epoch: int, direction: int) -> int:
    return zlib.crc32(struct.pack("<QB", epoch, direction) + body)


def sealed(body: bytes, epoch: int, direction: int = UP) -> bytes:
    return body + struct.pack("<I", check_of(body, epoch, direction))


def is_of_epoch(datagram: bytes, epoch: int, direction: int = DOWN) -> bool:
    return 6 <= len(datagram) <= LARGEST_DATAGRAM and \
        struct.unpack("<I", datagram[-4:])[0] == check_of(datagram[:-4], epoch, direction)


def head(form: int, value: int) -> bytes:
    return struct.pack("<H", form + 4 * value)


def varint(v: int) -> bytes:
    out = b""
    while v >= 0x80:
        out += bytes([v & 0x7F | 0x80])
        v >>= 7
    return out + bytes([v])


def part(kind: int, data: bytes) -> bytes:
    return bytes([kind]) + varint(len(data)) + data


COMES = {UP: (ACK, BUTTONS, REPORT, STATE, HASH, FRAGMENT, PACKET_PART),
         DOWN: (ACK, CLOCK, TICK_MAPPING, PIECE, SEAT, BASELINES, FRAGMENT, PACKET_PART)}


def elements_of(kind: int, direction: int, e: Cursor) -> tuple:
    if kind == ACK:
        out = e.number(2, CUT), e.number(2, CUT), e.varint(CUT, SPARE)
    elif kind == CLOCK:
        out = (e.varint(CUT, SPARE),)
    elif kind == TICK_MAPPING and direction == DOWN:
        out = e.varint(CUT, SPARE), zigzag(e.varint(CUT, SPARE))
        require(out[0] < END_OF_TICKS and abs(out[1]) <= FARTHEST_OFFSET, *SPARE)
    elif kind == BUTTONS:
        out = e.number(4, CUT), e.number(4, CUT)
    elif kind == BASELINES and direction == DOWN:
        out = (e.number(1, CUT),)
        require(out[0] <= ACKNOWLEDGED, *SPARE)
    elif kind == STATE:                                     # and seat
        out = (e.number(1, CUT),)
    elif kind == REPORT and direction == UP:
        out = e.varint(CUT, SPARE), e.number(1, CUT)
        if out[1] & 2:
            out += tuple(e.number(4, CUT) for _ in range(3))      # the viewpoint, as unsigned numbers: nobody looks here
        require(out[1] <= 3, *SPARE)
    elif kind == HASH:
        out = e.number(1, CUT), e.number(2, CUT), e.number(4, CUT)
    else:
        out = tuple(e.varint(CUT, SPARE) for _ in range(4 if kind == FRAGMENT else 1)) + (e.take(e.left(), CUT),)
    require(e.left() == 0 and (kind != STATE or direction == DOWN or out[0] <= 1) and (kind != CLOCK or out[0] < END_OF_TIME), *SPARE)
    return out


def reason_of(e: Cursor) -> int:
    reason = e.number(1, CUT)
    require(reason <= PROTOCOL and e.left() == 0, *SPARE)
    return reason


def read_parts(body: bytes, direction: int) -> Iterator[tuple[int, tuple]]:
    """Type and elements of each part of a datagram."""
    cursor, last, count = Cursor(body, 2, len(body)), 0, 0
    while cursor.left():
        kind = cursor.number(1, CUT)
        size = cursor.varint(CUT, SPARE)
        data = cursor.take(size, CUT)
        require(last <= kind and kind > 0, "malformed", "R-SES-5")
        require(kind in COMES[direction] or kind >= 64, "malformed", "R-SES-5")
        require(kind >= 64 or last < FRAGMENT or last == kind == PACKET_PART, "malformed", "R-SES-5")
        last, count = kind, count + 1
        if kind < 64:
            yield kind, elements_of(kind, direction, Cursor(data, 0, len(data)))
    alone = count == 1 and last == PACKET_PART and data[:1] == b"\0"
    require(count > 0 and not alone, "malformed", "R-SES-5")
