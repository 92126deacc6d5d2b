# SPDX-License-Identifier: Apache-2.0
"""Packets as elements. The second decoder's own parsing process runs over one of two coders in place of its range decoder:
`Recorder` writes down which elements it decodes, `Writer` takes them from a case's text and encodes them with the same models.
So the syntax of packets is written once. Elements bear the names of their models in lower case, numbers without a model are `raw`.
"""
from __future__ import annotations

import deformable_main
import load
import rigid
import thesis_mesh
from case_text import CaseError, Element, Elements, bytes_of
from conventions import Cursor, StreamError, require, zigzag
from declaration_syntax import varint_bytes, zigzagged
from range_coder import RangeDecoder
from range_encoder import RangeEncoder
from start_models import Models

HEAD = ("tick_delta", "count", "list_bytes", "lowest", "range")


class NoMore(Exception):
    """The elements end here, and other bytes follow."""


class NamedModel(list):
    name = ""


class NamedTree(list):
    name = ""


def named(tree: list, name: str) -> NamedTree:
    out = NamedTree([tree[0], *(NamedModel(m) for m in tree[1:])])
    out.name = name.partition("[")[0].lower()
    for model in out[1:]:
        model.name = out.name
    return out


class NamedModels(Models):
    def __missing__(self, name: str) -> list:
        self[name] = named(super().__missing__(name), name)
        return self[name]


class NamedInitialModels(load.InitialModels):
    def __missing__(self, name: str) -> list:
        self[name] = named(super().__missing__(name), name)
        return self[name]


class NamedThesisModels(thesis_mesh.ThesisModels):
    def copy(self):
        plain = super().copy()
        return NamedThesisModels(named(plain.list, "symbol"), named(plain.errors, "error"))


class Recorder(RangeDecoder):
    """Writes down the elements that are decoded whole."""
    elements: list[Element] = []
    inside = 0

    def note(self, name: str, decode, *arguments):
        if Recorder.inside:
            return decode(*arguments)
        Recorder.inside = 1
        try:
            value = decode(*arguments)
        finally:
            Recorder.inside = 0
        self.elements.append((name, value))
        return value

    def bit(self, m):
        return self.note(getattr(m, "name", ""), super().bit, m)

    def raw(self, n):
        return self.note("raw", super().raw, n)

    def tree(self, models, n):
        return self.note(models.name, super().tree, models, n)

    def magnitude(self, models):
        return self.note(models.name, super().magnitude, models)

    def signed(self, models):
        return self.note(models.name, super().signed, models)

    def signed_like(self, models, model, like):
        return self.note(models.name, super().signed_like, models, model, like)

    def nonzero_like(self, models, model, like):
        return self.note(models.name, super().nonzero_like, models, model, like)


class Writer:
    """A range decoder that is given what it decodes, and encodes it. The payloads of a packet are in `made`."""
    elements: Elements
    made: list[RangeEncoder] = []
    range = code = 0

    def __init__(self, _payload: bytes):
        self.encoder = RangeEncoder()
        self.made.append(self.encoder)

    def take(self, name: str, least: int, most: int) -> int:
        if self.elements.next_name() in ("then", "hex"):
            raise NoMore
        value = self.elements.take(name)
        if not isinstance(value, int) or not least <= value <= most:
            raise CaseError(f"{name} {value} is not in {least}..{most}")
        return value

    def bit(self, m) -> int:
        value = self.take(m.name, 0, 1)
        self.encoder.bit(m, value)
        return value

    def raw(self, n: int) -> int:
        value = self.take("raw", 0, (1 << n) - 1)
        self.encoder.raw(n, value)
        return value

    def tree(self, models, n: int) -> int:
        value = self.take(models.name, 0, (1 << n) - 1)
        self.encoder.tree(models, n, value)
        return value

    def magnitude(self, models) -> int:
        value = self.take(models.name, 0, 1 << 32)
        self.encoder.magnitude(models, value)
        require(value < 1 << 32, "malformed", "R-RNG-4")
        return value

    def signed(self, models) -> int:
        value = self.take(models.name, -1 << 32, 1 << 32)
        self.encoder.signed(models, value)
        require(abs(value) < 1 << 31, "malformed", "R-RNG-4")
        return value

    def signed_like(self, models, model, like: int) -> int:
        value = self.take(models.name, -1 << 32, 1 << 32)
        self.encoder.magnitude(models, abs(value))
        return self.with_sign(value, model, like) if value else 0

    def nonzero_like(self, models, model, like: int) -> int:
        value = self.take(models.name, -1 << 32, 1 << 32)
        if value == 0:
            raise CaseError(f"{models.name} is 0")
        self.encoder.magnitude(models, abs(value) - 1)
        return self.with_sign(value, model, like)

    def with_sign(self, value: int, model, like: int) -> int:
        if like == 0:
            self.encoder.raw(1, int(value < 0))
        else:
            self.encoder.bit(model, int((value < 0) != (like < 0)))
        require(abs(value) < 1 << 31, "malformed", "R-RNG-4")
        return value

    def check_end(self) -> None:
        pass


def install(coder: type) -> None:
    """Lets the decoders of packets run over a coder."""
    for module in (rigid, load, deformable_main, thesis_mesh):
        module.RangeDecoder = coder
    rigid.Models = deformable_main.Models = NamedModels
    load.InitialModels = NamedInitialModels
    thesis_mesh.ThesisModels = NamedThesisModels


def fixed_bytes(encoder: RangeEncoder) -> bytes:
    """The first bytes, which are the same whatever follows."""
    size = 4 + encoder.size
    low, high = encoder.low.to_bytes(size, "big"), (encoder.low + encoder.range - 1).to_bytes(size, "big")
    same = next((i for i in range(size) if low[i] != high[i]), size)
    return low[:same]


def is_thesis(decoder) -> bool:
    return isinstance(getattr(decoder, "codec", None), thesis_mesh.ThesisCodec)


# ---- Heads of profile thesis, which are not range coded -------------------------------------------------------------
def given_head(elements: Elements) -> tuple[bytes, bytes]:
    """The bytes of a head before and after `list_bytes`."""
    parts = [bytes([elements.take("key")]), b""]
    for name in ("baseline_delta", *HEAD):
        if name == "list_bytes" or name == "baseline_delta" and elements.next_name() != name:
            continue
        value = elements.take(name)
        parts[name in ("lowest", "range")] += varint_bytes(zigzagged(value) if name == "lowest" else value)
    return parts[0], parts[1]


def taken_head(data: bytes, span: int) -> tuple[list[Element], int]:
    """The elements of a head, and its `list_bytes`."""
    rest = Cursor(data, 0, len(data))
    elements: list[Element] = [("key", rest.number(1, ("", "")))]
    for name in (*(["baseline_delta"] if not elements[0][1] and span > 1 else []), *HEAD):
        value = rest.varint(("", ""), ("", ""))
        if name == "list_bytes":
            size = value
        else:
            elements.append((name, zigzag(value) if name == "lowest" else value))
    return elements, size


# ---- Packets --------------------------------------------------------------------------------------------------------
def given_packet(decoder, number: int, elements: list[Element]):
    """A packet's bytes, and what is decoded from it or None. The decoder goes on as if it had received it."""
    given = Writer.elements = Elements(elements, ("append", "list_bytes"))
    Writer.made = []
    head = given_head(given) if is_thesis(decoder) else None
    placeholder = head[0] + b"\0" + head[1] if head else b""
    packet = None
    try:
        packet = decoder.decode(number, placeholder)
    except (StreamError, NoMore):
        pass
    then = bytes_of(given.take("then")) if given.next_name() == "then" else None
    if given.next_name() is not None:
        raise CaseError(f"the packet ends before element {given.at}, {given.next_name()}")
    payloads = [m.finish() for m in Writer.made]
    if then is not None:
        payloads[-1:] = [fixed_bytes(Writer.made[-1]) + then] if Writer.made else [then]
    if head:
        listed = payloads[0] if payloads else b""
        size = given.apart.get("list_bytes", len(listed))
        payloads[:1] = [head[0] + varint_bytes(size) + head[1] + listed]
    return b"".join(payloads) + bytes_of(given.apart.get("append", "#")), packet


def taken_elements(decoder, number: int, data: bytes) -> list[Element]:
    """What is decoded from a packet, up to the first fault; the decoder is left as if it had received it."""
    Recorder.elements = []
    head: list[Element] = []
    if is_thesis(decoder):
        head, _ = taken_head(data, decoder.receiver.span)
    try:
        decoder.decode(number, data)
    except StreamError:
        pass
    return head + Recorder.elements


