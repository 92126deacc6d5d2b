# SPDX-License-Identifier: Apache-2.0
"""Chapter 20 of the specification: stream header and stream file."""
from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass, field
from typing import Iterator, NamedTuple, Optional

from conventions import ONE, STR_5, STR_5_VARINT, Cursor, require, text
from mesh_header import THESIS, Mesh, read_meshes
from packets import LARGEST_TICK


class Limits(NamedTuple):
    """What this decoder accepts at most (R-STR-14, R-STR-18, R-FIL-4, R-PKT-1)."""
    objects: int = 4096
    body_size: int = 1 << 20
    packet_size: int = 1 << 20
    vertices: int = 1 << 20                                 # of all meshes
    triangles: int = 1 << 21                                # of all meshes
    state_bytes: int = 1 << 28                              # R-STR-18


# ---- Chapter 20, section 3: header ----------------------------------------------------------------------------------
MAGIC = b"\x89TCT"
SMALLEST_OBJECT = 32
HAS_MESHES = 1                                              # bit 0 of `flags`


class State(NamedTuple):                                    # chapter 40, section 1
    tick: int
    position: tuple
    rotation: tuple
    velocity: tuple = (0, 0, 0)
    spin: tuple = (0, 0, 0)


class Object(NamedTuple):
    name: str
    dof: int
    initial: State


class Bounds(NamedTuple):
    """Section 3.1: elements in the order in which they are read, f64 as the hexadecimal digits of their bits."""
    rigid: Optional[list]
    meshes: list[list]


@dataclass
class Header:
    version: int
    profile: int
    tick_rate: int
    position_exp: int
    velocity_exp: int
    rotation_exp: int
    spin_exp: int
    max_extrapolation: int
    baseline_span: int
    objects: list[Object] = field(default_factory=list)
    meshes: list[Mesh] = field(default_factory=list)
    bounds: Optional[Bounds] = None

    def moving(self) -> list[int]:
        """Chapter 40, section 2: the moving objects M, as indices into `objects`."""
        return [i for i, item in enumerate(self.objects) if item.dof != 0]


STR_16 = ("malformed", "R-STR-16")
BOUNDS = 2                                                  # type of an extension record


def read_header(data: bytes, limits: Limits = Limits()) -> tuple[Header, int]:
    """Returns the header and its size in bytes."""
    require(len(data) >= 4, "truncated", "R-STR-1")
    require(data[:4] == MAGIC, "malformed", "R-STR-1")
    require(len(data) >= 12, *STR_5)
    version, profile, flags, body_size = struct.unpack_from("<BBHI", data, 4)
    require(version == 1, "unsupported", "R-STR-2")
    require(profile <= 1, "malformed", "R-STR-3")
    require(profile == 0, "unsupported", "R-STR-3")
    require(flags <= HAS_MESHES, "malformed", "R-STR-4")
    require(body_size <= limits.body_size, "limit_exceeded", "R-STR-14")
    end = 12 + body_size
    require(len(data) >= end + 4, *STR_5)
    require(zlib.crc32(data[:end]) == struct.unpack_from("<I", data, end)[0], "checksum", "R-STR-15")

    body = Cursor(data, 12, end)
    header = Header(version, profile, *struct.unpack("<IBBBBHB", body.take(11, STR_5)))
    object_count = body.varint(STR_5, STR_5_VARINT)
    check_numbers(header)
    require(object_count <= limits.objects, "limit_exceeded", "R-STR-14")
    require(object_count * SMALLEST_OBJECT <= body.left(), *STR_5)
    header.objects = [read_object(body) for _ in range(object_count)]
    if flags & HAS_MESHES:
        header.meshes = read_meshes(body, limits.objects - object_count, limits.vertices, limits.triangles)
    while body.left() > 0:
        kind = body.varint(STR_16, STR_16)
        content = body.take(body.varint(STR_16, STR_16), STR_16)
        if kind == BOUNDS:
            require(header.bounds is None, "invalid", "R-STR-17")
            header.bounds = read_bounds(Cursor(content, 0, len(content)), header)
    names = [item.name for item in (*header.objects, *header.meshes)]
    require(len(set(names)) == len(names), "invalid", "R-STR-11")
    require(state_bytes(header) <= limits.state_bytes, "limit_exceeded", "R-STR-18")
    return header, end + 4


def check_numbers(h: Header) -> None:
    require(1 <= h.tick_rate <= 1000000, "invalid", "R-STR-6")
    require(8 <= h.position_exp <= 30 and h.velocity_exp <= h.position_exp <= h.velocity_exp + 12
            and 8 <= h.rotation_exp <= 28 and h.spin_exp <= 20
            and h.spin_exp <= h.rotation_exp <= h.spin_exp + 12, "invalid", "R-STR-7")
    require(h.max_extrapolation >= 1, "invalid", "R-STR-8")
    require(1 <= h.baseline_span <= 64, "invalid", "R-STR-9")


def state_bytes(h: Header) -> int:
    """Section 5."""
    states = h.baseline_span + 2
    total = 64 * states * len(h.objects)
    for mesh in h.meshes:
        total += states * ((24 if mesh.split else 12) * len(mesh.rest) + 48 * len(mesh.modes))
        if mesh.profile == THESIS:
            total += (states + 2 if mesh.models_kept else 2) * 4 * (254 + (1 << mesh.quant_bits))
    return total


def read_object(body: Cursor) -> Object:
    kind = body.take(1, STR_5)[0]
    require(kind == 1, "unsupported", "R-STR-10")
    dof, name_size = body.take(2, STR_5)
    name_bytes = body.take(name_size, STR_5)
    pose = struct.unpack("<7i", body.take(28, STR_5))
    name = text(name_bytes)
    require(dof < 64 and (dof >> 3) in (0, 1, 2, 4, 7), "invalid", "R-STR-12")
    position, rotation = pose[:3], pose[3:]
    require(all(-ONE <= c <= ONE for c in rotation)
            and abs(sum(c * c for c in rotation) - (1 << 60)) <= 1 << 41, "invalid", "R-STR-13")
    return Object(name, dof, State(0, position, rotation))


def read_bounds(data: Cursor, header: Header) -> Bounds:
    """Section 3.1."""
    def f64s(count: int) -> list[str]:
        return [f64() for _ in range(count)]

    def f64() -> str:
        bits = struct.unpack("<Q", data.take(8, ("truncated", "R-STR-17")))[0]
        require(bits < 0x7FF0000000000000, "invalid", "R-STR-17")
        return f"{bits:016x}"

    def choice() -> int:
        value = data.take(1, ("truncated", "R-STR-17"))[0]
        require(value <= 3, "invalid", "R-STR-17")
        return value

    rigid = None
    if header.moving():
        rigid = f64s(3)
        haptic = choice()
        rigid += [haptic, *f64s((0, 2, 3, 2)[haptic])]
    meshes = []
    for _ in header.meshes:
        promise = choice()
        meshes.append([promise, *f64s(3 if promise & 2 else 1)])
    return Bounds(rigid, meshes)


# ---- Chapter 20, section 4: file ------------------------------------------------------------------------------------
PACKET, INDEX, TRAILER, FIRST_EXTENSION = 1, 2, 3, 128
FIL_2 = ("truncated", "R-FIL-2")
FIL_6 = ("malformed", "R-FIL-6")


class File:
    """A header and the packets of the records after it; index and extension records are skipped."""

    def __init__(self, data: bytes, limits: Limits = Limits()):
        self.data, self.limits = data, limits
        self.header, self.first_record = read_header(data, limits)
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
        kind = rest.take(1, FIL_2)[0]
        size = rest.varint(FIL_2, FIL_6)
        require(kind in (PACKET, INDEX, TRAILER) or kind >= FIRST_EXTENSION, "unsupported", "R-FIL-3")
        require(kind != PACKET or size <= self.limits.packet_size + 6, "limit_exceeded", "R-FIL-4")
        require(kind != TRAILER or size == 8, *FIL_6)
        require(size + 4 <= rest.left(), *FIL_2)
        payload = rest.take(size, FIL_2)
        expected = zlib.crc32(self.data[start:rest.position])
        require(struct.unpack("<I", rest.take(4, FIL_2))[0] == expected, "checksum", "R-FIL-5")
        return kind, payload
