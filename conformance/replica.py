# SPDX-License-Identifier: Apache-2.0
"""Chapter 60 of the specification: what a client shows of rigid objects."""
from __future__ import annotations

import struct
from collections import deque
from typing import Optional

from conventions import FNV_START, clamp, fnv1a, round_div
from curve import AT_REST, NO_OFFSET, Offset, cubic, difference, displaced, offset
from device_path import DevicePath
from driven import DrivenBody
from rigid import DRIVEN, Packet, motion, predict
from scene import Declaration, State
from smoothing import kept, smoothed

FRACTION = 49152                                               # P = 75 %, x 2^-16
MOST_GAPS = 5
LONGEST_GAP = (1 << 31) - 1


class ReplicaObject:
    """From `begin` to `end` an object is shown beside where its state has it."""
    error: Offset
    change: Offset

    def __init__(self, index: int, state: State):
        self.index = index
        self.body: Optional[DrivenBody] = None              # of `state`, by the path as it was then known
        self.known = 0
        self.state, self.left = state, NO_OFFSET            # `left` is of a smoothed scene
        self.number = 0                                     # of the packet of the newest update
        self.begin = self.end = 0
        self.arrival: Optional[int] = None
        self.gaps: deque[int] = deque(maxlen=MOST_GAPS)


class Replica:
    """What a client shows that applies packets; mode is "none", "linear", "hermite" or "blending". It may know its device."""

    def __init__(self, scene: Declaration, mode: str, path: Optional[DevicePath] = None):
        self.scene, self.mode = scene, "none" if scene.smoothed else mode             # section 1
        self.path = path
        self.shortest = round_div(5 * scene.tick_rate, 1000)
        self.longest = round_div(100 * scene.tick_rate, 1000)
        self.objects = [ReplicaObject(i, item.initial) for i, item in enumerate(scene.objects)]
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
        before, running = self.velocities(o.state, now), now < o.end
        if o.arrival is not None:
            o.gaps.append(min(now - o.arrival, LONGEST_GAP))
        if state.smoothing_exp > 0:
            o.left = kept(self.smoothed(o, max(state.tick, o.state.tick)), state)
        o.arrival, o.state = now, state
        o.begin = o.end = now
        if self.mode == "none" or running or not o.gaps:
            return
        o.end = now + clamp(round_div(sum(o.gaps) * FRACTION, len(o.gaps) << 16), self.shortest, self.longest)
        o.error = offset(self.expected(o, now), shown)
        if self.mode == "linear":
            o.change = NO_OFFSET
        else:
            o.change = difference(self.scene, before, self.velocities(state, now), o.end - now)

    def velocities(self, state: State, now: int) -> tuple[tuple, tuple]:
        if now - state.tick >= self.scene.max_extrapolation:
            return AT_REST
        return motion(self.scene, state, now - state.tick)

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
        now = max(now, o.begin)
        if now >= o.end:
            return self.smoothed(o, now)
        u = round_div((o.end - now) << 30, o.end - o.begin)
        c, b = cubic(u)
        k = c if self.mode == "hermite" else u
        return displaced(self.expected(o, now), o.error, o.change, k, k, b)

    def pose_hash(self, now: int) -> int:
        h = FNV_START
        for i in self.moving:
            position, rotation = self.pose(self.objects[i], now)
            h = fnv1a(struct.pack("<7i", *position, *rotation), h)
        return h
