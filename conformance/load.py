# SPDX-License-Identifier: Apache-2.0
"""Chapter 45 of the specification: packets of loads."""
from __future__ import annotations

import struct
from typing import NamedTuple, Optional

from conventions import FNV_START, fnv1a, require, round_shift, sat32
from packet import Receiver
from range_coder import RangeDecoder
from scene import Declaration, Limits

PUSH = 2                                                    # kind of all vectors from this one on


class InitialModels(dict):
    """The models of one packet, by name: each begins as an initial model, each tree with as many as it has nodes."""

    def __missing__(self, name: str) -> list:
        self[name] = [None] + [[16384, 1] for _ in range(15)]
        return self[name]


class Loads(NamedTuple):
    tick: int
    vectors: list[list[tuple]]                              # for each moving object 2 + load_users of them


class LoadPacket(NamedTuple):
    number: int
    key: int
    loads: int                                              # objects named
    state: Loads
    range: int                                              # final state of the range decoder
    code: int

    @property
    def tick(self) -> int:
        return self.state.tick


class LoadDecoder:
    """Keeps the initial state and the states after the newest `baseline_span` packets."""

    def __init__(self, scene: Declaration, limits: Limits = Limits()):
        self.scene = scene
        self.moving = len(scene.moving())
        initial = Loads(0, [[(0, 0, 0)] * (2 + scene.loads.users) for _ in range(self.moving)])
        self.receiver = Receiver(initial, scene.baseline_span, limits.packet_size)

    def decode(self, number: int, data: bytes, record_tick: Optional[int] = None) -> LoadPacket:
        """Decodes the packet of a number, in a file of a record at `record_tick`; an error leaves the decoder unchanged."""
        self.receiver.open(number, data)
        decoder, models = RangeDecoder(data), InitialModels()
        several = self.moving > 1

        key = decoder.bit(models["KEY"][1])
        named = not key and self.scene.baseline_span > 1
        baseline_delta = decoder.magnitude(models["BASELINE"]) if named else 1
        tick_delta = decoder.magnitude(models["TICK"])
        count = decoder.magnitude(models["COUNT"]) if several else 1
        baseline = self.receiver.baseline(number, key, baseline_delta)
        tick = self.receiver.tick(number, baseline, tick_delta, "R-LOD-1")
        require(1 <= count <= self.moving, "invalid", "R-LOD-2")

        state = Loads(tick, [list(vectors) for vectors in baseline.vectors])
        index = -1
        for _ in range(count):
            index += 1 + (decoder.magnitude(models["GAP"]) if several else 0)
            require(index < self.moving, "invalid", "R-LOD-3")
            read_load(decoder, models, state.vectors[index])
        decoder.check_end()
        require(record_tick in (None, tick), "invalid", "R-FIL-7")
        self.receiver.accept(number, state)
        return LoadPacket(number, key, count, state, decoder.range, decoder.code)

    def state_hash(self) -> int:
        state = self.receiver.current
        components = [c for vectors in state.vectors for vector in vectors for c in vector]
        return fnv1a(struct.pack(f"<Q{len(components)}i", state.tick, *components), FNV_START)


def read_load(decoder: RangeDecoder, models: InitialModels, vectors: list[tuple]) -> None:
    """Replaces the vectors of the baseline by the new ones."""
    s = 2 * decoder.tree(models["LEVEL"], 3)
    for v, base in enumerate(vectors):
        kind = min(v, PUSH)
        if not decoder.bit(models[f"CHANGED[{kind}]"][1]):
            continue
        step, context = [], 0
        for _ in range(3):
            step.append(decoder.signed(models[f"STEP[{kind}][{context}]"]))
            w = max(map(abs, step)).bit_length()
            context = 1 if w == 0 else 2 if w <= 2 else 3 if w <= 5 else 4
        vectors[v] = tuple(sat32((round_shift(base[a], s) + step[a]) << s) for a in range(3))
