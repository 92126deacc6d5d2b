# SPDX-License-Identifier: Apache-2.0
"""Chapter 20 of the specification as a syntax: the names and types of a scene declaration's elements, in order.

One walk serves both ways: over `Taken`, which reads elements from bytes, and over `Given`, which writes bytes from elements.
It checks nothing; where bytes are no elements any more, the rest is `bytes`.
"""
from __future__ import annotations

import json
import struct
import zlib

from case_text import CaseError, Element, Elements, Value, bytes_of, digits
from conventions import Cursor, StreamError, zigzag
from deformable_header import CLUSTERS, COMPUTED, DECLARED, MAIN, THESIS
from scene import BOUNDS, HAS_BODIES, HAS_DEFORMABLES, HAS_INTEREST, HAS_LOADS, HAS_MOTION, IS_DRIVEN, MAGIC, PARTS, STIFFNESS, VERSION

FIXED = struct.Struct("<4sBBHI")
APART = ("magic", "version", "stream_profile", "body_size", "crc", "cut")
CUT = ("truncated", "")


class NoElement(Exception):
    """What follows is no element."""


def varint_bytes(value: int) -> bytes:
    if not isinstance(value, int) or value < 0:
        raise CaseError(f"{value} is not a number of 0 or more")
    out = bytearray()
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes(out) + bytes([value])


def zigzagged(value: int) -> int:
    return 2 * value if value >= 0 else -2 * value - 1


class Taken:
    """Reads elements from bytes."""

    def __init__(self, data: bytes):
        self.cursor = Cursor(data, 0, len(data))
        self.elements: list[Element] = []

    def more(self) -> bool:
        return self.cursor.left() > 0

    def add(self, name: str, value: Value) -> Value:
        self.elements.append((name, value))
        return value

    def bytes(self, size: int) -> bytes:
        try:
            return self.cursor.take(size, CUT)
        except StreamError:
            raise NoElement from None

    def number(self, name: str, form: str) -> int:
        return self.add(name, struct.unpack("<" + form, self.bytes(struct.calcsize("<" + form)))[0])

    def f64(self, name: str) -> None:
        data = self.bytes(8)
        value = struct.unpack("<d", data)[0]
        text = repr(value)
        exact = value == value and abs(value) != float("inf") and struct.pack("<d", float(text)) == data
        self.add(name, text if exact else digits(data))

    def plain_varint(self) -> int:
        start = self.cursor.position
        try:
            return self.cursor.varint(CUT, CUT)
        except StreamError:
            self.cursor.position = start
            raise NoElement from None

    def varint(self, name: str) -> int:
        return self.add(name, self.plain_varint())

    def zigzag(self, name: str) -> int:
        return self.add(name, zigzag(self.plain_varint()))

    def text(self, name: str) -> None:
        start = self.cursor.position
        try:
            data = self.bytes(self.bytes(1)[0])
        except NoElement:
            self.cursor.position = start
            raise
        try:
            quoted = json.dumps(data.decode("utf-8"))
        except UnicodeDecodeError:
            quoted = digits(data)
        self.add(name, quoted)

    def rest(self, name: str = "bytes") -> None:
        if self.more():
            self.add(name, digits(self.bytes(self.cursor.left())))

    def extension(self, walk) -> None:
        start, count = self.cursor.position, len(self.elements)
        try:
            kind = self.varint("extension")
            content = Taken(self.bytes(self.plain_varint()))
            walk(content, kind)
            self.elements += content.elements
        except NoElement:
            self.cursor.position = start
            del self.elements[count:]
            raise


class Given:
    """Writes bytes from elements."""

    def __init__(self, elements: Elements):
        self.given, self.out = elements, bytearray()

    def more(self) -> bool:
        return self.given.next_name() is not None

    def take(self, name: str) -> Value:
        if self.given.next_name() in (None, "bytes", "content") or self.given.next_name() == "extension" != name:
            raise NoElement
        return self.given.take(name)

    def number(self, name: str, form: str) -> int:
        value = self.take(name)
        try:
            self.out += struct.pack("<" + form, value)
        except struct.error as error:
            raise CaseError(f"{name} {value}: {error}") from None
        return value

    def f64(self, name: str) -> None:
        value = self.take(name)
        self.out += bytes_of(value) if str(value).startswith("#") else struct.pack("<d", float(value))

    def varint(self, name: str) -> int:
        value = self.take(name)
        self.out += varint_bytes(value)
        return value

    def zigzag(self, name: str) -> int:
        value = self.take(name)
        self.out += varint_bytes(zigzagged(value))
        return value

    def text(self, name: str) -> None:
        value = str(self.take(name))
        data = json.loads(value).encode("utf-8") if value.startswith('"') else bytes_of(value)
        self.out += bytes([len(data)]) + data

    def rest(self, name: str = "bytes") -> None:
        while self.given.next_name() == name:
            self.out += bytes_of(self.given.take(name))

    def extension(self, walk) -> None:
        kind = self.varint("extension")
        content = Given(self.given)
        walk(content, kind)
        self.out += varint_bytes(len(content.out)) + content.out


# ---- The walk -------------------------------------------------------------------------------------------------------
def several(f, name: str, form: str, count: int) -> None:
    for _ in range(count):
        f.number(name, form)


def part(f, flags: int, flag: int) -> None:
    for element in PARTS[flag] if flags & flag else ():
        several(f, *element)


def body(f, flags: int) -> None:
    """All of the declaration after `body_size` and before `crc`."""
    try:
        elements_of_body(f, flags)
    except NoElement:
        pass
    f.rest()


def elements_of_body(f, flags: int) -> None:
    for name, form in (("tick_rate", "I"), ("position_exp", "B"), ("velocity_exp", "B"), ("rotation_exp", "B"), ("angular_exp", "B"),
                       ("max_extrapolation", "H"), ("baseline_span", "B")):
        f.number(name, form)
    moving = sum(rigid_object(f) for _ in range(f.varint("object_count")))
    count = f.varint("deformable_count") if flags & HAS_DEFORMABLES else 0
    vertices = [deformable_object(f) for _ in range(count)]
    part(f, flags, HAS_LOADS)
    part(f, flags, HAS_MOTION)
    for _ in range(moving):
        part(f, flags, IS_DRIVEN)
    if flags & HAS_BODIES:
        for _ in range(count):
            method = f.number("method", "B")
            if method:
                elastic_body(f, method)
    part(f, flags, HAS_INTEREST)
    while f.more():
        f.extension(lambda content, kind: extension(content, kind, moving, vertices, bool(flags & HAS_LOADS)))


def rigid_object(f) -> bool:
    f.number("kind", "B")
    dof = f.number("dof", "B")
    f.text("name")
    several(f, "position", "i", 3)
    several(f, "rotation", "i", 4)
    return dof != 0


def deformable_object(f) -> int:
    profile = f.number("profile", "B")
    f.text("name")
    f.number("rings", "B")
    for name, form in ((("quant_bits", "B"), ("models_kept", "B")) if profile == THESIS else
                       (("frame_period", "I"), ("layered", "B"), ("fade", "H"), ("weight_sets", "B"))):
        f.number(name, form)
    vertex_count, triangle_count = f.varint("vertex_count"), f.varint("triangle_count")
    for _ in range(3 * vertex_count):
        f.zigzag("rest")
    for _ in range(3 * triangle_count):
        f.zigzag("corners")
    if profile == MAIN:
        basis(f, f.number("basis", "B"), vertex_count)
    return vertex_count


def basis(f, kind: int, vertex_count: int) -> None:
    if kind == CLUSTERS:
        f.varint("cluster_count")
        f.number("blend", "B")
        for _ in range(f.varint("surprise_count")):
            f.varint("gap")
            f.varint("cluster")
    if kind == DECLARED:
        for _ in range(f.varint("mode_count")):
            f.number("mode_step", "H")
            for _ in range(3 * vertex_count):
                f.zigzag("entries")
    if kind == COMPUTED:
        f.varint("mode_count")
        runs(f)


def runs(f) -> None:
    for _ in range(f.varint("run_count")):
        f.varint("gap")
        f.varint("more")


def elastic_body(f, method: int) -> None:
    if method == 3:
        f.number("sub_steps", "B")
    for name, count in (("mass_damping", 1), ("stiffness_damping", 1), ("gravity", 3), ("coupling", 1), ("friction", 1)):
        for _ in range(count):
            f.f64(name)
    materials = f.number("material_count", "B")
    for _ in range(materials):
        for name in ("young", "poisson", "density"):
            f.f64(name)
    inner_count, tet_count = f.varint("inner_count"), f.varint("tet_count")
    for _ in range(3 * inner_count):
        f.zigzag("inner")
    for _ in range(4 * tet_count):
        f.zigzag("tetrahedra")
    left = tet_count if materials > 1 else 0
    while left > 0:
        left -= max(1, f.varint("length"))
        f.number("material", "B")
    runs(f)


def extension(f, kind: int, moving: int, vertices: list[int], has_loads: bool) -> None:
    """The content of an extension record; `content` is what is not as expected."""
    try:
        if kind == BOUNDS:
            if moving:
                for _ in range(3):
                    f.f64("rigid_bounds")
                for _ in range({0: 0, 2: 3}.get(f.number("haptic", "B"), 2)):
                    f.f64("haptic_bounds")
            for _ in vertices:
                for _ in range(3 if f.number("bound_flags", "B") & 2 else 1):
                    f.f64("deformable_bounds")
            for _ in range(2 if has_loads else 0):
                f.f64("load_bounds")
        if kind == STIFFNESS:
            index = f.number("stiffness_of", "B")
            several(f, "levels", "B", vertices[index] if index < len(vertices) else 0)
    except NoElement:
        pass
    f.rest("content")


# ---- A whole declaration --------------------------------------------------------------------------------------------
def taken_declaration(data: bytes) -> tuple[list[Element], int]:
    """Its elements, and where it ends."""
    if len(data) < FIXED.size:
        return [("cut", digits(data))], len(data)
    magic, version, profile, flags, body_size = FIXED.unpack_from(data)
    content = data[FIXED.size:FIXED.size + body_size]
    f = Taken(content)
    f.add("flags", flags)
    body(f, flags)
    for name, value, usual in (("magic", digits(magic), digits(MAGIC)), ("version", version, VERSION), ("stream_profile", profile, 0),
                               ("body_size", body_size, len(content))):
        if value != usual:
            f.add(name, value)
    end = FIXED.size + len(content)
    crc = data[end:end + 4]
    if crc != zlib.crc32(data[:end]).to_bytes(4, "little"):
        f.add("crc", digits(crc))
    return f.elements, end + len(crc)


def given_declaration(elements: list[Element]) -> bytes:
    given = Elements(elements, APART)
    if "cut" in given.apart:
        return bytes_of(given.apart["cut"])
    flags = given.take("flags")
    f = Given(given)
    body(f, flags)
    if given.next_name() is not None:
        raise CaseError(f"the declaration ends before {given.next_name()}")
    apart = given.apart
    head = FIXED.pack(bytes_of(apart.get("magic", digits(MAGIC))), apart.get("version", VERSION), apart.get("stream_profile", 0), flags,
                      apart.get("body_size", len(f.out)))
    data = head + bytes(f.out)
    return data + (bytes_of(apart["crc"]) if "crc" in apart else zlib.crc32(data).to_bytes(4, "little"))
