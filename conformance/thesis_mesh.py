# SPDX-License-Identifier: Apache-2.0
"""Chapter 85 of the specification, section 2: meshes of profile thesis."""
from __future__ import annotations

import struct
from typing import TYPE_CHECKING, NamedTuple

from conventions import STR_5, Cursor, clamp, require, round_div, zigzag
from packet import Receiver
from range_coder import RangeDecoder

if TYPE_CHECKING:
    from deformable_header import DeformableObject

DEF_11 = ("truncated", "R-DEF-11")
DEF_11_VALUE = ("malformed", "R-DEF-11")
INITIAL = (16384, 1)
LIST_BITS = 8
FARTHEST = 1 << 27


# ---- Section 2.1: declaration ---------------------------------------------------------------------------------------
def read_parameters(body: Cursor) -> tuple[int, int]:
    """quant_bits and models_kept."""
    quant_bits, models_kept = body.take(2, STR_5)
    require(models_kept <= 1, "malformed", "R-DEF-3")
    return quant_bits, models_kept


def check_parameters(item: DeformableObject) -> None:
    require(1 <= item.quant_bits <= 12, "invalid", "R-DEF-3")


def models_bytes(item: DeformableObject, states: int) -> int:
    """What the models take, as the chapter counts it."""
    return (states + 2 if item.models_kept else 2) * 4 * (254 + (1 << item.quant_bits))


# ---- Sections 2.2 and 2.3: state, packet ----------------------------------------------------------------------------
class ThesisModels(NamedTuple):
    """Two trees: of gaps and of errors."""
    list: list
    errors: list

    def copy(self) -> ThesisModels:
        return ThesisModels(*([list(m) for m in tree] for tree in self))


class ThesisState(NamedTuple):
    tick: int
    u: list[int]                                            # 3 for each vertex
    models: ThesisModels
    models_kept: int

    def hashed(self) -> bytes:
        """What the state hash is taken of."""
        data = struct.pack(f"<Q{len(self.u)}i", self.tick, *self.u)
        if self.models_kept:
            for tree in self.models:
                data += b"".join(struct.pack("<I", zero + (rate << 16)) for zero, rate in tree[1:])
        return data


class Head(NamedTuple):
    key: int
    baseline_delta: int
    tick_delta: int
    count: int
    lowest: int
    range: int
    list: bytes
    errors: bytes


class ThesisCodec:
    """Decodes packets of one deformable object."""

    def __init__(self, item: DeformableObject):
        self.item = item
        models = ThesisModels([INITIAL] * (1 << LIST_BITS), [INITIAL] * (1 << item.quant_bits))
        self.initial = ThesisState(0, [0] * (3 * len(item.rest)), models, item.models_kept)

    def decode(self, payload: bytes, receiver: Receiver, number: int) -> tuple[ThesisState, int, list[int], RangeDecoder]:
        head = self.read_head(payload, receiver.span)
        base = receiver.baseline(number, head.key, head.baseline_delta)
        tick = receiver.tick(number, base, head.tick_delta, "R-DEF-8")
        models = (base if self.item.models_kept else self.initial).models.copy()
        listed = self.read_list(RangeDecoder(head.list), models.list, head.count)

        decoder = RangeDecoder(head.errors)
        q = self.item.quant_bits
        u = list(base.u)
        for v in listed:
            for i in range(3 * v, 3 * v + 3):
                symbol = decoder.tree(models.errors, q)
                u[i] = clamp(u[i] + head.lowest + round_div(symbol * head.range, (1 << q) - 1), -FARTHEST, FARTHEST)
        decoder.check_end()
        return base._replace(tick=tick, u=u, models=models), head.key, listed, decoder

    def expect(self, state: ThesisState, tick: int) -> list[int]:
        """Prediction in time is to hold (thesis eq. 3.9)."""
        return state.u

    def read_head(self, payload: bytes, span: int) -> Head:
        rest = Cursor(payload, 0, len(payload))
        key = rest.number(1, DEF_11)
        require(key <= 1, *DEF_11_VALUE)
        baseline_delta = rest.varint(DEF_11, DEF_11_VALUE) if not key and span > 1 else 1
        tick_delta, count, list_bytes, lowest, extent = (rest.varint(DEF_11, DEF_11_VALUE) for _ in range(5))
        require(tick_delta < 1 << 32 and 1 <= count <= len(self.item.rest) and lowest <= 1 << 29 and extent <= 1 << 29,
                "invalid", "R-DEF-12")
        return Head(key, baseline_delta, tick_delta, count, zigzag(lowest), extent,
                    rest.take(list_bytes, DEF_11), rest.take(rest.left(), DEF_11))

    def read_list(self, decoder: RangeDecoder, models: list, count: int) -> list[int]:
        listed: list[int] = []
        for _ in range(count):
            vertex = (listed[-1] if listed else -1) + 1
            symbol = 255
            while symbol == 255:
                symbol = decoder.tree(models, LIST_BITS)
                vertex += symbol
                require(vertex < len(self.item.rest), "invalid", "R-DEF-13")
            listed.append(vertex)
        decoder.check_end()
        return listed
