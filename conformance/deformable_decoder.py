# SPDX-License-Identifier: Apache-2.0
"""Chapter 50 of the specification: decoder of one deformable object, of either profile."""
from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Optional, Union

from conventions import fnv1a, require
from deformable_header import MAIN, DeformableObject
from deformable_main import MainCodec, MainState
from packet import Receiver
from scene import Declaration, Limits
from thesis_mesh import ThesisCodec, ThesisState

if TYPE_CHECKING:
    from elastic import Shapes


class DeformablePacket(NamedTuple):
    number: int
    key: int
    vertices: list[int]                                     # that have a residual of their own
    range: int                                              # final state of the range decoder
    code: int
    state: Union[MainState, ThesisState]

    @property
    def tick(self) -> int:
        return self.state.tick


class DeformableDecoder:
    def __init__(self, scene: Declaration, item: DeformableObject, limits: Limits = Limits()):
        self.codec = MainCodec(item) if item.profile == MAIN else ThesisCodec(item)
        self.receiver = Receiver(self.codec.initial, scene.baseline_span, limits.packet_size)

    def decode(self, number: int, data: bytes, record_tick: Optional[int] = None) -> DeformablePacket:
        """Decodes the packet of a number, in a file of a record at `record_tick`; an error leaves the decoder unchanged."""
        self.receiver.open(number, data)
        state, key, vertices, decoder = self.codec.decode(data, self.receiver, number)
        require(record_tick in (None, state.tick), "invalid", "R-FIL-7")
        self.receiver.accept(number, state)
        return DeformablePacket(number, key, vertices, decoder.range, decoder.code, state)

    def shown(self, tick: int, playout: bool = False, shapes: Optional[Shapes] = None) -> list[int]:
        """The displacements that a client shows at a tick; one before the state's counts as that.

        `shapes` are those that the client's own device gives the object.
        """
        state = self.receiver.at(tick) if playout else self.receiver.current
        tick = max(tick, state.tick)
        following = shapes.shown(state, tick) if shapes and state.following else None
        return self.codec.expect(state, tick) if following is None else following

    def state_hash(self) -> int:
        return fnv1a(self.receiver.current.hashed())
