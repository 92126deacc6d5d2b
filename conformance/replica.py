# SPDX-License-Identifier: Apache-2.0
"""Chapter 60 of the specification: what a client in the mode none shows of rigid objects."""
from __future__ import annotations

import struct
from typing import Optional

from conventions import FNV_START, fnv1a
from curve import NO_OFFSET
from device_path import DevicePath
from driven import DrivenBody
from rigid import DRIVEN, Packet, predict
from scene import Declaration, State
from smoothing import kept, smoothed


class ReplicaObject:
    def __init__(self, index: int, state: State):
        self.index = index
        self.body: Optional[DrivenBody] = None              # of `state`, by the path as it was then known
        self.known = 0
        self.state, self.left = state, NO_OFFSET            # `left` is of a smoothed scene
        self.number = 0                                     # of the packet of the newest update
        self.begin = 0                                      # tick at which it was applied


class Replica:
    """What a client shows that applies packets. It may know its device."""
    Object = ReplicaObject

    def __init__(self, scene: Declaration, path: Optional[DevicePath] = None):
        self.scene, self.path = scene, path
        self.objects = [self.Object(i, item.initial) for i, item in enumerate(scene.objects)]
        self.moving = scene.moving()

    def apply(self, packet: Packet, now: int) -> None:
        for update in packet.updates:
            o = self.objects[update.object]
            if packet.number < o.number:
                continue
            self.apply_state(o, packet.moment.states[update.object], max(now, packet.tick, o.begin))
            o.number = packet.number

    def apply_state(self, o: ReplicaObject, state: State, now: int) -> None:
        if state.smoothing_exp > 0:
            o.left = kept(self.smoothed(o, max(state.tick, o.state.tick)), state)
        o.state, o.begin = state, now

    def smoothed(self, o: ReplicaObject, t: int) -> tuple[tuple, tuple]:
        return smoothed(self.expected(o, t), o.state, o.left, t)

    def expected(self, o: ReplicaObject, t: int) -> tuple[tuple, tuple]:
        """By dead reckoning, or by the device of this client."""
        if not self.path or o.state.predictor != DRIVEN:
            return predict(self.scene, o.state, t)
        if o.body is None or o.body.state is not o.state or o.known != self.path.revision or t < o.body.tick:
            o.body, o.known = DrivenBody(self.scene, o.index, o.state), self.path.revision
        return o.body.pose(t, self.path.position)

    def pose(self, o: ReplicaObject, now: int) -> tuple[tuple, tuple]:
        return self.smoothed(o, max(now, o.begin))

    def pose_hash(self, now: int) -> int:
        h = FNV_START
        for i in self.moving:
            position, rotation = self.pose(self.objects[i], now)
            h = fnv1a(struct.pack("<7i", *position, *rotation), h)
        return h
