# SPDX-License-Identifier: Apache-2.0
"""Chapter 40 of the specification: rigid packets."""
from __future__ import annotations

import struct
from math import isqrt
from typing import NamedTuple, Optional

from conventions import (FNV_START, ONE, axis_angle, clamp, fnv1a, mul, renorm, require, round_div, round_shift,
                         sat32)
from packet import Receiver
from range_coder import RangeDecoder
from scene import Contact, Declaration, Limits, State
from start_models import Models

# ---- Residual, prediction, reconstruction ---------------------------------------------------------------------------
HAPTIC = 3
LARGEST_ANGULAR = 1 << 25
BALLISTIC, SLIDE, DRIVEN = 1, 2, 3
HALF_RADIAN = 341782638                                     # 2^32 / (4 pi), a binary angle
SIZE, NEAR = (0, 1, 1, 2, 2, 2, 3), (0, 1, 2, 2, 3, 3, 4)   # by width, at most 6


def included(dof: int, q: int) -> list[int]:
    """The axes of vector q (position, velocity, rotation, angular velocity) that `dof` does not exclude."""
    return [a for a in range(3) if dof >> (a if q < 2 else 3 + a) & 1]


def residual(decoder: RangeDecoder, models: Models, dof: int, reason: int) -> list[list[int]]:
    r = [[0, 0, 0] for _ in range(4)]
    for k in range(2):
        pose, motion = r[2 * k], r[2 * k + 1]
        axes = included(dof, 2 * k)
        largest = 0
        for a in axes:
            c = reason if a == axes[0] else 4 + min(largest.bit_length(), 7)
            pose[a] = decoder.signed(models[f"POSE[{k}][{c}]"])
            largest = max(largest, abs(pose[a]))
        largest = 0
        for a in axes:
            c = 5 * (0 if a == axes[0] else 1 + SIZE[min(largest.bit_length(), 6)]) + NEAR[min(abs(pose[a]).bit_length(), 6)]
            motion[a] = decoder.signed_like(models[f"MOTION[{k}][{c}]"], models[f"SIGN[{k}][{reason}]"][1], pose[a])
            largest = max(largest, abs(motion[a]))
    return r


def predict(scene: Declaration, state: State, t: int) -> tuple[tuple, tuple]:
    dt = min(t - state.tick, scene.max_extrapolation)
    if state.predictor == SLIDE:
        rest = rest_time(scene, state)
        dt = min(dt, (rest + 255) >> 8)
    if dt == 0:
        return state.position, state.rotation
    shift = scene.position_exp - scene.velocity_exp
    fraction = 1 << 15
    if state.predictor == SLIDE:
        fraction = (1 << 15) - round_div(dt << 22, rest) if dt << 8 <= rest else round_div(rest << 14, dt << 8)
    moved = [clamp(round_div((v * dt) << shift, scene.tick_rate), -1 << 33, 1 << 33) for v in state.velocity]
    x = tuple(sat32(p + round_shift(m * fraction, 15)) for p, m in zip(state.position, moved))
    if state.predictor == BALLISTIC:
        x = tuple(sat32(p + round_div((g * dt) << shift, 2 * scene.tick_rate)) for p, g in zip(x, gained(scene, dt)))
    speed = isqrt(sum(c * c for c in state.angular_velocity) << 10)
    if speed == 0:
        return x, state.rotation
    angle = round_shift(round_div(speed * dt, scene.tick_rate) * fraction, 15)
    half = (((angle * HALF_RADIAN + (1 << (scene.angular_exp + 4))) % (1 << 64)) >> (scene.angular_exp + 5)) % (1 << 32)
    if half == 0:
        return x, state.rotation
    u = tuple(round_div(c << 35, speed) for c in state.angular_velocity)
    return x, renorm(mul(axis_angle(u, half), state.rotation))


def rest_time(scene: Declaration, state: State) -> int:
    """Until a sliding object rests, x 2^-8 ticks."""
    return round_div((isqrt(sum(c * c for c in state.velocity)) * scene.tick_rate) << 8, scene.motion.slide_deceleration)


def gained(scene: Declaration, dt: int) -> list[int]:
    """Velocity, by gravity."""
    return [sat32(round_div(g * dt, scene.tick_rate)) for g in scene.motion.gravity]


def motion(scene: Declaration, state: State, dt: int) -> tuple[list, list]:
    """Velocities after dt ticks."""
    v, o = list(state.velocity), list(state.angular_velocity)
    if state.predictor == BALLISTIC:
        v = [sat32(c + g) for c, g in zip(v, gained(scene, dt))]
    if state.predictor == SLIDE and dt > 0:
        rest = rest_time(scene, state)
        left = (1 << 15) - round_div(dt << 23, rest) if dt << 8 < rest else 0
        v = [round_shift(c * left, 15) for c in v]
        o = [round_shift(c * left, 15) for c in o]
    return v, o


def reconstruct_pose(scene: Declaration, base: State, t: int, r: list[list[int]], s: int) -> tuple[tuple, tuple]:
    p, q = predict(scene, base, t)
    position = tuple(sat32(p[a] + (r[0][a] << s)) for a in range(3))
    m = [c << s for c in r[2]]
    n = sum(c * c for c in m)
    length = 1 << scene.rotation_exp
    require(all(abs(c) <= length for c in m) and n <= length * length, "invalid", "R-RIG-6")
    if n == 0:
        return position, q
    k = min(30, 60 - 2 * scene.rotation_exp)
    d = (length * length + n) >> (30 - k)
    w = round_div((length * length - n) << k, d)
    v = [round_div((2 * length * c) << k, d) for c in m]
    return position, renorm(mul(tuple(clamp(c, -ONE, ONE) for c in (w, *v)), q))


def reconstruct_motion(scene: Declaration, base: State, t: int, r: list[list[int]], s: int, reason: int) -> tuple[tuple, tuple]:
    dt = t - base.tick
    v, o = motion(scene, base, min(dt, scene.max_extrapolation))
    if reason == HAPTIC and dt > 0:
        for a in range(3):
            e, f = sat32(r[0][a] << s), sat32(r[2][a] << s)
            if e != 0:
                v[a] = sat32(v[a] + round_div(3 * e * scene.tick_rate, (2 * dt) << (scene.position_exp - scene.velocity_exp)))
            if f != 0:
                o[a] = sat32(o[a] + round_div(6 * f * scene.tick_rate, dt << (scene.rotation_exp - scene.angular_exp)))
    velocity = tuple(sat32((round_shift(v[a], s) + r[1][a]) << s) for a in range(3))
    angular = tuple(clamp((round_shift(o[a], s) + r[3][a]) << s, -LARGEST_ANGULAR, LARGEST_ANGULAR) for a in range(3))
    return velocity, angular


def read_contact(decoder: RangeDecoder, models: Models, base: Contact) -> Contact:
    def beside(k: int, before: int) -> int:
        return clamp(before + decoder.signed(models[f"CONTACT[{k}]"]), -1 << 20, 1 << 20)

    held = decoder.raw(1)
    point = tuple(beside(0, c) for c in base.point)
    if held:
        return Contact(held, point)
    normal = tuple(beside(1, c) for c in base.normal)
    return Contact(held, point, normal, beside(2, base.drag))


# ---- Packets --------------------------------------------------------------------------------------------------------
class Moment(NamedTuple):
    """The state of all objects."""
    tick: int
    states: list[State]


class Update(NamedTuple):
    object: int                                             # index in the declaration
    reason: int
    level: int


class Packet(NamedTuple):
    number: int
    key: int
    updates: list[Update]
    moment: Moment
    range: int                                              # final state of the range decoder
    code: int

    @property
    def tick(self) -> int:
        return self.moment.tick


class RigidDecoder:
    """Keeps the initial state and the scene states after the newest `baseline_span` packets."""

    def __init__(self, scene: Declaration, limits: Limits = Limits()):
        self.scene = scene
        self.moving = scene.moving()
        initial = Moment(0, [item.initial for item in scene.objects])
        self.receiver = Receiver(initial, scene.baseline_span, limits.packet_size)

    def decode(self, number: int, data: bytes, record_tick: Optional[int] = None) -> Packet:
        """Decodes the packet of a number, in a file of a record at `record_tick`; an error leaves the decoder unchanged."""
        self.receiver.open(number, data)
        decoder, models = RangeDecoder(data), Models("rigid-start-models.csv")
        several = len(self.moving) > 1

        key = decoder.bit(models["KEY"][1])
        named = not key and self.scene.baseline_span > 1
        baseline_delta = decoder.magnitude(models["BASELINE"]) if named else 1
        tick_delta = decoder.magnitude(models["TICK"])
        count = decoder.magnitude(models["COUNT"]) if several else 1
        baseline = self.receiver.baseline(number, key, baseline_delta)
        tick = self.receiver.tick(number, baseline, tick_delta, "R-RIG-1")
        require(1 <= count <= len(self.moving), "invalid", "R-RIG-3")

        moment = Moment(tick, list(baseline.states))
        updates = []
        index = -1
        for _ in range(count):
            index += 1 + (decoder.magnitude(models["GAP"]) if several else 0)
            require(index < len(self.moving), "invalid", "R-RIG-4")
            updates.append(self.read_update(decoder, models, moment, self.moving[index]))
        decoder.check_end()
        require(record_tick in (None, tick), "invalid", "R-FIL-7")
        self.receiver.accept(number, moment)
        return Packet(number, key, updates, moment, decoder.range, decoder.code)

    def read_update(self, decoder: RangeDecoder, models: Models, moment: Moment, index: int) -> Update:
        """Replaces the baseline's state of an object in `moment` by its new state."""
        reason = decoder.tree(models["REASON"], 2)
        level = decoder.tree(models["LEVEL"], 4)
        lod = (moment.states[index].lod + decoder.tree(models["LOD"], 3)) % 8 if self.scene.interest else 0
        smoothing_exp = 0
        if self.scene.smoothed:
            usual = max(0, min(self.scene.tick_rate // 62, 255).bit_length() - 1)
            smoothing_exp = (usual - decoder.tree(models["SMOOTHING_EXP"], 3)) % 8
        retained = decoder.tree(models["RETAINED"], 2) if smoothing_exp > 0 else 0
        context = reason + (4 if self.scene.driven else 0)
        predictor = decoder.tree(models[f"PREDICTOR[{context}]"], 2) if self.scene.motion or self.scene.driven else 0
        contact = moment.states[index].contact
        if self.scene.driven and predictor == DRIVEN:
            contact = read_contact(decoder, models, contact)
        r = residual(decoder, models, self.scene.objects[index].dof, reason)
        require(self.declares(predictor, index), "invalid", "R-RIG-7")
        base, s = moment.states[index], level
        position, rotation = reconstruct_pose(self.scene, base, moment.tick, r, s)
        velocity, angular = reconstruct_motion(self.scene, base, moment.tick, r, s, reason)
        moment.states[index] = State(moment.tick, position, rotation, velocity, angular, predictor, smoothing_exp, retained, contact, lod)
        return Update(index, reason, level)

    def declares(self, predictor: int, index: int) -> bool:
        """What a predictor needs."""
        motion = self.scene.motion
        if predictor == BALLISTIC:
            return motion is not None and any(motion.gravity)
        if predictor == SLIDE:
            return motion is not None and motion.slide_deceleration != 0
        if predictor == DRIVEN:
            return index in self.scene.driven and self.scene.driven[index].coupling != 0
        return True

    def state_hash(self) -> int:
        states = self.receiver.current.states
        h = FNV_START
        for i in self.moving:
            tick, *vectors, predictor, smoothing_exp, retained, (held, point, normal, drag), lod = states[i]
            h = fnv1a(struct.pack("<Q13i", tick, *(c for vector in vectors for c in vector)), h)
            if self.scene.smoothed:
                h = fnv1a(struct.pack("<I", smoothing_exp + 8 * retained), h)
            if self.scene.motion or self.scene.driven:
                h = fnv1a(struct.pack("<i", predictor), h)
            if self.scene.driven:
                h = fnv1a(struct.pack("<8i", held, *point, *normal, drag), h)
            if self.scene.interest:
                h = fnv1a(struct.pack("<i", lod), h)
        return h
