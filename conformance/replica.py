# SPDX-License-Identifier: Apache-2.0
"""Chapter 60 of the specification: what a client shows of rigid objects."""
from __future__ import annotations

import struct
from collections import deque
from math import isqrt
from typing import Optional

from conventions import FNV_START, ONE, asin30, axis_angle, clamp, conj, fnv1a, mul, renorm, round_div, sat32
from easing import Offset, add, offset
from rigid import Packet, predict
from scene import Declaration, State

SHARE = 49152                                               # P = 75 %, x 2^-16
MOST_GAPS = 5
LONGEST_GAP = (1 << 31) - 1


class ReplicaObject:
    """From `begin` to `end` an object is shown between two poses, `start` and `target` (`from` and `to` of the chapter)."""
    start: tuple
    target: tuple
    half: int
    u: tuple

    def __init__(self, state: State):
        self.state, self.offset = state, Offset()           # `offset` is of an eased scene
        self.number = 0                                     # of the packet of the newest update
        self.begin = self.end = 0
        self.arrival: Optional[int] = None
        self.gaps: deque[int] = deque(maxlen=MOST_GAPS)


class Replica:
    """What a client shows that applies packets; mode is "none" or "linear"."""

    def __init__(self, scene: Declaration, mode: str):
        self.scene, self.mode = scene, mode
        self.shortest = round_div(5 * scene.tick_rate, 1000)
        self.longest = round_div(100 * scene.tick_rate, 1000)
        self.objects = [ReplicaObject(item.initial) for item in scene.objects]
        self.moving = scene.moving()

    def apply(self, packet: Packet, now: int) -> None:
        for update in packet.updates:
            o = self.objects[update.object]
            if packet.number < o.number:
                continue
            o.number = packet.number
            arrivals = (now, packet.tick) if o.arrival is None else (now, packet.tick, o.arrival)
            self.apply_state(o, packet.moment.states[update.object], max(arrivals))

    def apply_state(self, o: ReplicaObject, state: State, now: int) -> None:
        shown = self.pose(o, now)
        running = now < o.end
        if o.arrival is not None:
            o.gaps.append(min(now - o.arrival, LONGEST_GAP))
        if state.ease > 0:
            o.offset = offset(self.eased(o, max(state.tick, o.state.tick)), state)
        o.arrival, o.state = now, state
        o.begin = o.end = now
        if self.mode == "none" or running or not o.gaps:
            return
        o.end = now + clamp(round_div(sum(o.gaps) * SHARE, len(o.gaps) << 16), self.shortest, self.longest)
        if o.end == now:
            return
        o.start, o.target = shown, predict(self.scene, state, o.end)
        d = mul(o.target[1], conj(o.start[1]))
        if d[0] < 0:
            d = tuple(-c for c in d)
        s = isqrt(sum(c * c for c in d[1:]))
        if s == 0:
            o.half, o.u = 0, (0, 0, 0)
        else:
            o.half, o.u = asin30(min(s, ONE)), tuple(round_div(c << 30, s) for c in d[1:])

    def eased(self, o: ReplicaObject, t: int) -> tuple[tuple, tuple]:
        return add(predict(self.scene, o.state, t), o.state, o.offset, t)

    def pose(self, o: ReplicaObject, now: int) -> tuple[tuple, tuple]:
        now = max(now, o.begin)
        if now >= o.end:
            return self.eased(o, now)
        part, whole = now - o.begin, o.end - o.begin
        position = tuple(sat32(a + round_div((b - a) * part, whole)) for a, b in zip(o.start[0], o.target[0]))
        h = round_div(o.half * part, whole)
        rotation = o.start[1] if h == 0 else renorm(mul(axis_angle(o.u, h), o.start[1]))
        return position, rotation

    def pose_hash(self, now: int) -> int:
        h = FNV_START
        for i in self.moving:
            position, rotation = self.pose(self.objects[i], now)
            h = fnv1a(struct.pack("<7i", *position, *rotation), h)
        return h
