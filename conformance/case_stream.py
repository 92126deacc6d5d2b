# SPDX-License-Identifier: Apache-2.0
"""Chapter 80 of the specification for cases: a stream file from the blocks of a case, and the blocks of a stream file."""
from __future__ import annotations

import functools
import zlib
from typing import NamedTuple, Optional

from case_coder import Recorder, Writer, given_packet, install, taken_elements
from case_text import Block, CaseError, Element, bytes_of, digits, parse, words
from conventions import Cursor, StreamError
from declaration_syntax import given_declaration, taken_declaration, varint_bytes
from file import INDEX, NUMBERED, PACKET, PACKETS, TRAILER
from packet import Receiver
from range_coder import RangeDecoder
from scene import Declaration, read_declaration
from scene_decoder import SceneDecoder

CUT = ("truncated", "")
MOST_CHANGES = 4


@functools.lru_cache(maxsize=4)
def scene_of(declaration: bytes) -> Declaration:
    """A basis that has to be computed takes seconds."""
    return read_declaration(declaration)[0]


class Earlier(NamedTuple):
    """What later cases of a stem refer to, by the name of the case."""
    scenes: dict[str, list[Element]]
    streams: dict[str, bytes]


class Decoders:
    """The decoders of a stream's scene, if it has one, and the state that each of them is in."""

    def __init__(self, declaration: bytes):
        self.tick = 0                                       # of the packet record before
        self.numbers: dict[bytes, int] = {}                 # of the packet record before, by substream byte
        try:
            self.scene: Optional[SceneDecoder] = SceneDecoder(scene_of(declaration))
        except StreamError:
            self.scene = None

    def of(self, part: Optional[int]):
        numbers = self.scene.substreams if self.scene else {}
        return numbers.get(part if part is not None else next(iter(numbers), None))

    def several(self) -> bool:
        return self.scene is not None and len(self.scene.substreams) > 1

    def byte(self, part: Optional[int]) -> bytes:
        """The substream byte."""
        return bytes([part]) if part is not None and self.several() else b""

    def next_number(self, byte: bytes) -> int:
        return self.numbers.get(byte, 0) + 1

    def follow(self, number: int, data: bytes) -> None:
        """Receives a packet as any decoder does."""
        install(RangeDecoder)
        try:
            substream, packet = self.scene.split(data)
            self.scene.substreams[substream].decode(number, packet)
        except StreamError:
            pass


def state_of(receiver: Receiver) -> dict:
    return {**receiver.__dict__, "kept": dict(receiver.kept)}


# ---- Blocks to bytes ------------------------------------------------------------------------------------------------
def record(kind: int, payload: bytes, fields: dict) -> bytes:
    size = fields.get("size", len(payload))
    data = bytes([kind]) + varint_bytes(size) + payload
    return data + (bytes_of(fields["crc"]) if "crc" in fields else zlib.crc32(data).to_bytes(4, "little"))


def split_elements(elements: list[Element], names: tuple) -> tuple[dict, list[Element]]:
    return {k: v for k, v in elements if k in names}, [e for e in elements if e[0] not in names]


def head_of(text: str) -> tuple[dict, str]:
    """What stands before the colon of a packet, and what after it."""
    head, _, rest = text.rpartition(":")
    return dict(parse(head)), rest


def packet_of(decoders: Decoders, text: str, before: list[bytes], kind: int) -> bytes:
    """A packet record. Its tick is the packet's unless `after` says otherwise."""
    fields, rest = head_of(text)
    elements = parse(rest)
    over, elements = split_elements(elements, ("size", "crc", "after"))
    packet = None
    if elements and elements[0][0] in ("hex", "again"):
        name, value = elements[0]
        data = bytes_of(value) if name == "hex" else before[value]
        byte = data[:1] if decoders.several() else b""
        number = fields.get("number", decoders.next_number(byte))
        if decoders.scene and isinstance(number, int):
            decoders.follow(number, data)
    else:
        part = fields.get("of")
        byte = decoders.byte(part)
        number = fields.get("number", decoders.next_number(byte))
        decoder = decoders.of(part)
        if decoder is None:
            raise CaseError(f"there is no substream {part}")
        if not isinstance(number, int):
            raise CaseError("a number in hexadecimal digits goes with `hex`")
        kept = state_of(decoder.receiver)
        install(Writer)
        data, packet = given_packet(decoder, number, elements)
        data = byte + data
        if any(name in ("then", "append", "list_bytes") for name, _ in elements):
            decoder.receiver.__dict__.update(kept)
            decoders.follow(number, data)
    before.append(data)
    after = over.get("after", packet.tick - decoders.tick if packet else 0)
    start = varint_bytes(after) if isinstance(after, int) else bytes_of(after)
    decoders.tick += after if isinstance(after, int) else 0
    if isinstance(number, int):
        decoders.numbers[byte] = number
    if kind == NUMBERED:
        start += varint_bytes(number) if isinstance(number, int) else bytes_of(number)
    return record(kind, start + data, over)


def other_record(block: Block) -> bytes:
    fields, elements = split_elements(parse(block.text), ("size", "crc"))
    if block.kind == "index":
        return record(INDEX, b"".join(varint_bytes(value) for _, value in elements), fields)
    if block.kind == "trailer":
        return record(TRAILER, elements[0][1].to_bytes(8, "little"), fields)
    return record(elements[0][1], b"".join(bytes_of(value) for _, value in elements[1:]), fields)


def declaration_elements(text: str, scenes: dict[str, list[Element]]) -> list[Element]:
    """`as CASE` takes the elements of an earlier case; `but` replaces some of them, `and` adds others."""
    first, _, rest = text.partition(" ")
    if first != "as":
        return parse(text)
    name, _, rest = rest.partition(" ")
    elements = list(scenes[name])
    changes, _, added = rest.partition("and ") if rest.startswith("and ") or " and " in rest else (rest, "", "")
    for change in filter(None, (c.strip() for c in changes.removeprefix("but ").split(","))):
        element, value = change.split(" ", 1)
        key, _, number = element.partition("[")
        indices = [i for i, (n, _) in enumerate(elements) if n == key]
        elements[indices[int(number.rstrip("]") or 0)]] = parse(f"{key} {value}")[0]
    return elements + parse(added)


def stream_of(blocks: list[Block], name: str, earlier: Earlier) -> bytes:
    """The bytes of a case's stream."""
    data, decoders, before = b"", None, []
    kind = NUMBERED if any("number" in head_of(block.text)[0] for block in blocks if block.kind == "packet") else PACKET
    for block in blocks:
        if block.kind == "scene":
            earlier.scenes[name] = declaration_elements(block.text, earlier.scenes)
            data = given_declaration(earlier.scenes[name])
        elif block.kind == "stream":
            data = earlier.streams[block.text.removeprefix("as ")]
        elif block.kind == "packet":
            decoders = decoders or Decoders(data)
            data += packet_of(decoders, block.text, before, kind)
        elif block.kind == "bytes":
            data += b"".join(bytes_of(value) for _, value in parse(block.text))
        elif block.kind in ("index", "trailer", "record"):
            data += other_record(block)
        else:
            raise CaseError(f"there is no block `{block.kind}`")
    earlier.streams[name] = data
    return data


# ---- Bytes to blocks ------------------------------------------------------------------------------------------------
def label(elements: list[Element], index: int) -> str:
    name = elements[index][0]
    indices = [i for i, (n, _) in enumerate(elements) if n == name]
    return name if len(indices) == 1 else f"{name}[{indices.index(index)}]"


def declaration_text(elements: list[Element], scenes: dict[str, list[Element]]) -> str:
    """In full, or as changes of an earlier one if that is shorter."""
    full = " ".join(words(elements))
    best = full
    for name, other in scenes.items():
        if len(other) > len(elements) or not other:
            continue
        if any(a[0] != b[0] for a, b in zip(other, elements)):
            continue
        changed = [i for i, (a, b) in enumerate(zip(other, elements)) if a != b]
        if len(changed) > MOST_CHANGES or any("," in str(elements[i][1]) or " and " in str(elements[i][1]) for i in changed):
            continue
        text = f"as {name}"
        if changed:
            text += " but " + ", ".join(f"{label(elements, i)} {elements[i][1]}" for i in changed)
        if len(elements) > len(other):
            text += " and " + " ".join(words(elements[len(other):]))
        if len(text) < len(best) and (not changed or len(text) < 0.7 * len(full)):
            best = text
    return best


class Records:
    """Takes a stream apart after its declaration."""

    def __init__(self, declaration: bytes):
        self.taken, self.given = Decoders(declaration), Decoders(declaration)
        self.kind = 0                                       # of packet records
        self.before: list[bytes] = []
        self.unreadable = 0                                 # bytes in hexadecimal digits

    def block(self, kind: int, payload: bytes, over: list[Element]) -> Optional[Block]:
        more = words(over)
        if kind in PACKETS and self.kind in (0, kind):
            self.kind = kind
            return self.packet(payload, over)
        if kind == INDEX:
            values, rest = [], Cursor(payload, 0, len(payload))
            try:
                while rest.left():
                    values.append(rest.varint(CUT, CUT))
            except StreamError:
                values = None
            if values:
                return Block("index", " ".join([*map(str, values), *more]))
        if kind == TRAILER and len(payload) == 8:
            return Block("trailer", " ".join([str(int.from_bytes(payload, "little")), *more]))
        self.unreadable += len(payload)
        return Block("record", " ".join([str(kind), digits(payload), *more]))

    def packet(self, payload: bytes, over: list[Element]) -> Block:
        cursor = Cursor(payload, 0, len(payload))
        number, after, start = 0, None, 0
        try:
            after = cursor.varint(CUT, CUT)
            start = cursor.position
            number = cursor.varint(CUT, CUT) if self.kind == NUMBERED else 0
        except StreamError:
            self.unreadable += len(payload)
            rest = digits(payload[start:])
            head = "number #" if after is None else f"number {rest}"
            head = f"{head}: " if self.kind == NUMBERED else ""
            return Block("packet", head + " ".join(words([("hex", "#"), ("after", rest if after is None else after), *over])))
        data = payload[cursor.position:]
        for text in self.texts(number, data):
            for with_after in ([], [("after", after)]):
                block = Block("packet", " ".join([text, *words([*with_after, *over])]))
                kept = {n: state_of(d.receiver) for n, d in self.given.scene.substreams.items()} if self.given.scene else {}
                tick, numbers, count = self.given.tick, dict(self.given.numbers), len(self.before)
                try:
                    made = packet_of(self.given, block.text, self.before, self.kind)
                except (CaseError, TypeError, AttributeError, IndexError, KeyError, OverflowError, ValueError):
                    made = b""
                if made == record(self.kind, payload, dict(over)):
                    return block
                for n, state in kept.items():
                    self.given.scene.substreams[n].receiver.__dict__.update(state)
                self.given.tick, self.given.numbers = tick, numbers
                del self.before[count:]
        raise CaseError("a packet cannot be written")

    def texts(self, number: int, data: bytes):
        """The ways to say a packet, the most readable one first."""
        byte = data[:1] if self.given.several() else b""
        following = self.given.next_number(byte)
        number = number if self.kind == NUMBERED else following
        given = [("number", number)] if number != following or self.kind == NUMBERED and not self.given.numbers else []
        if data in self.before and len(data) > 2:
            yield self.head(given) + f"again {self.before.index(data)}"
        split = None
        if self.taken.scene:
            try:
                part, packet = self.taken.scene.split(data)
                split = (part, packet, self.taken.scene.substreams[part])
            except StreamError:
                pass
        if split:
            part, packet, decoder = split
            install(Recorder)
            try:
                elements = taken_elements(decoder, number, packet)
            except (StreamError, IndexError):
                elements = []
                self.taken.follow(number, data)
            head = self.head([*([("of", part)] if self.given.several() else []), *given])
            yield " ".join([head.strip(), *words(elements)]).strip()
            yield from self.edited(part, number, head.strip(), elements, packet)
        self.unreadable += len(data)
        yield self.head(given) + " ".join(words([("hex", digits(data))]))

    @staticmethod
    def head(fields: list[Element]) -> str:
        """Which packet it is; a number that follows the one before is left out."""
        return " ".join(words(fields)) + (": " if fields else "")

    def edited(self, part: int, number: int, head: str, elements: list[Element], packet: bytes):
        """With other bytes after what is decoded. How many that are is tried out on the decoders of the given side."""
        given = self.given.scene.substreams[part]
        for more in ([], [("then", "#")]):
            kept = state_of(given.receiver)
            install(Writer)
            try:
                made, _ = given_packet(given, number, elements + more)
            except (CaseError, OverflowError, IndexError):
                made = None
            given.receiver.__dict__.update(kept)
            if made is not None and packet.startswith(made):
                rest = packet[len(made):]
                self.unreadable += len(rest)
                yield " ".join([head, *words([*elements, ("then" if more else "append", digits(rest))])]).strip()
                self.unreadable -= len(rest)


def blocks_of(data: bytes, name: str, earlier: Earlier) -> tuple[list[Block], int]:
    """The blocks of a stream, and how many of its bytes they show as hexadecimal digits."""
    same = next((other for other, stream in earlier.streams.items() if stream == data), None)
    if same is not None:
        return [Block("stream", f"as {same}")], 0
    earlier.streams[name] = data
    elements, end = taken_declaration(data)
    if given_declaration(elements) != data[:end]:
        elements = [("cut", digits(data[:end]))]
    text = declaration_text(elements, earlier.scenes)
    earlier.scenes[name] = elements
    blocks = [Block("scene", text)]
    hexadecimal = sum(len(bytes_of(v)) for k, v in elements if k in ("bytes", "content", "cut"))
    records = Records(data[:end])
    rest = Cursor(data, end, len(data))
    while rest.left():
        start = rest.position
        try:
            kind = rest.number(1, CUT)
            size = rest.varint(CUT, CUT)
            payload = rest.take(min(size, rest.left()), CUT)
            crc = rest.take(min(4, rest.left()), CUT)
            over: list[Element] = [("size", size)] if size != len(payload) else []
            if crc != zlib.crc32(data[start:rest.position - len(crc)]).to_bytes(4, "little"):
                over.append(("crc", digits(crc)))
            blocks.append(records.block(kind, payload, over))
        except StreamError:
            blocks.append(Block("bytes", digits(data[start:])))
            hexadecimal += len(data) - start
            break
    return blocks, hexadecimal + records.unreadable


