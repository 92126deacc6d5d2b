# SPDX-License-Identifier: Apache-2.0
"""Chapter 60 of the specification, section 7: a client that shows the past and interpolates over known gaps."""
from __future__ import annotations

import struct
from typing import NamedTuple

from conventions import FNV_START, fnv1a, round_div
from curve import NO_OFFSET, Offset, cubic, difference, displaced, offset
from rigid import Packet, motion, predict
from scene import OUT_OF_INTEREST, Declaration, State
from smoothing import kept, smoothed

MOST_SMOOTHED = 64
HEARD = 1024


class KnownUpdate(NamedTuple):
    tick: int
    number: int                                             # 0: the initial state
    state: State


class Playout:
    def __init__(self, scene: Declaration):
        self.scene = scene
        self.moving = scene.moving()
        self.reach = min(round_div(300 * scene.tick_rate, 1000), scene.max_extrapolation)
        self.updates = [[KnownUpdate(0, 0, item.initial)] for item in scene.objects]
        self.heard: set[int] = set()

    def apply(self, packet: Packet, now: int) -> None:
        self.heard.add(packet.number)
        newest = max(self.heard)
        self.heard = {number for number in self.heard if number > newest - HEARD}
        for update in packet.updates:
            known = self.updates[update.object]
            known.append(KnownUpdate(packet.tick, packet.number, packet.moment.states[update.object]))
            known.sort(key=lambda u: (u.tick, u.number))

    def pose(self, i: int, s: int) -> tuple[tuple, tuple]:
        known = self.updates[i]
        before = [u for u in known if u.tick <= s]
        a = before[-1] if before else known[0]
        s = max(s, a.tick)
        k = known.index(a)
        path = self.between(known, k, s)
        return smoothed(path, a.state, self.left(known, k), s) if self.scene.smoothed else path

    def between(self, known: list[KnownUpdate], k: int, s: int) -> tuple[tuple, tuple]:
        """The path from update k to the next one."""
        a, after = known[k], known[k + 1:k + 2]
        if not after or a.number == 0 or a.state.lod == OUT_OF_INTEREST or not 0 < after[0].tick - a.tick <= self.reach:
            return predict(self.scene, a.state, s)
        if all(number in self.heard for number in range(a.number + 1, after[0].number)):
            return predict(self.scene, a.state, s)
        return self.interpolate_gap(a.state, after[0].state, s)

    def left(self, known: list[KnownUpdate], k: int, back: int = 0) -> Offset:
        """What is left to go at update k, `back` before the one that is shown."""
        if k == 0 or back > MOST_SMOOTHED:
            return NO_OFFSET
        a, z = known[k].state, known[k - 1].state
        path = self.between(known, k - 1, a.tick)
        counts = z.smoothing_exp > 0 and a.tick < z.tick + (1 << z.smoothing_exp)
        return kept(smoothed(path, z, self.left(known, k - 1, back + 1), a.tick) if counts else path, a)

    def interpolate_gap(self, a: State, b: State, s: int) -> tuple[tuple, tuple]:
        scene, whole = self.scene, b.tick - a.tick
        u = round_div((s - a.tick) << 30, whole)
        c, rate = cubic(u)
        i = c if any(a.velocity) or any(b.velocity) else u
        j = c if any(a.angular_velocity) or any(b.angular_velocity) else u
        error = offset(predict(scene, a, b.tick), (b.position, b.rotation))
        change = difference(scene, motion(scene, a, whole), (b.velocity, b.angular_velocity), whole)
        return displaced(predict(scene, a, s), error, change, i, j, rate)

    def pose_hash(self, now: int) -> int:
        h = FNV_START
        for i in self.moving:
            position, rotation = self.pose(i, now)
            h = fnv1a(struct.pack("<7i", *position, *rotation), h)
        return h
