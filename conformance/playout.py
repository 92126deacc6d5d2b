# SPDX-License-Identifier: Apache-2.0
"""Chapter 60 of the specification, section 7: a client that shows the past and bends over known gaps."""
from __future__ import annotations

import struct
from math import isqrt
from typing import NamedTuple

from conventions import (FNV_START, ONE, asin30, axis_angle, conj, fnv1a, mul, renorm, round_div, round_shift, sat32)
from rigid import HALF_RADIAN, Packet, motion, predict
from scene import Declaration, State

MOST_UPDATES = 64
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
        self.reset()

    def reset(self) -> None:
        self.updates = [[KnownUpdate(0, 0, item.initial)] for item in self.scene.objects]
        self.heard: set[int] = set()

    def apply(self, packet: Packet, now: int) -> None:
        if packet.restarts:
            self.reset()
        self.heard.add(packet.number)
        newest = max(self.heard)
        self.heard = {number for number in self.heard if number > newest - HEARD}
        for update in packet.updates:
            known = self.updates[update.object]
            known.append(KnownUpdate(packet.tick, packet.number, packet.moment.states[update.object]))
            known.sort(key=lambda u: (u.tick, u.number))
            del known[:-MOST_UPDATES]

    def pose(self, i: int, s: int) -> tuple[tuple, tuple]:
        known = self.updates[i]
        before = [u for u in known if u.tick <= s]
        a = before[-1] if before else known[0]
        s = max(s, a.tick)
        after = known[known.index(a) + 1:]
        if not after or a.number == 0 or after[0].tick - a.tick > self.reach:
            return predict(self.scene, a.state, s)
        if all(number in self.heard for number in range(a.number + 1, after[0].number)):
            return predict(self.scene, a.state, s)
        return self.bend(a.state, after[0].state, s)

    def bend(self, a: State, b: State, s: int) -> tuple[tuple, tuple]:
        scene, whole = self.scene, b.tick - a.tick
        u = round_div((s - a.tick) << 30, whole)
        u2 = round_shift(u * u, 30)
        u3 = round_shift(u2 * u, 30)
        cubic, rate = 3 * u2 - 2 * u3, u3 - u2
        p, q = predict(scene, a, s)
        end_p, end_q = predict(scene, a, b.tick)
        v, o = motion(scene, a, whole)

        k = cubic if any(a.velocity) or any(b.velocity) else u
        position = []
        for axis in range(3):
            e = sat32(b.position[axis] - end_p[axis])
            d = sat32(b.velocity[axis] - v[axis]) * whole << (scene.position_exp - scene.velocity_exp)
            d = sat32(round_div(d, scene.tick_rate))
            position.append(sat32(p[axis] + round_shift(k * e + rate * d, 30)))

        k = cubic if any(a.angular_velocity) or any(b.angular_velocity) else u
        e = half_vector(mul(b.rotation, conj(end_q)))
        r = []
        for axis in range(3):
            d = round_div((b.angular_velocity[axis] - o[axis]) * whole, scene.tick_rate)
            d = sat32(round_shift(d * HALF_RADIAN, scene.angular_exp))
            r.append(round_shift(k * e[axis] + rate * d, 30))
        n = isqrt(sum(c * c for c in r))
        if n == 0:
            return tuple(position), q
        axis_of_r = tuple(round_div(c << 30, n) for c in r)
        return tuple(position), renorm(mul(axis_angle(axis_of_r, n), q))

    def pose_hash(self, now: int) -> int:
        h = FNV_START
        for i in self.moving:
            position, rotation = self.pose(i, now)
            h = fnv1a(struct.pack("<7i", *position, *rotation), h)
        return h


def half_vector(d: tuple) -> tuple[int, int, int]:
    if d[0] < 0:
        d = tuple(-c for c in d)
    s = isqrt(sum(c * c for c in d[1:]))
    if s == 0:
        return 0, 0, 0
    h = asin30(min(s, ONE))
    return tuple(round_div(c * h, s) for c in d[1:])
