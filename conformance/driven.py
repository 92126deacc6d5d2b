# SPDX-License-Identifier: Apache-2.0
"""Chapter 42 of the specification, section 4: the motion of an object that the client's own device pushes or holds."""
from __future__ import annotations

from math import isqrt
from typing import Callable, Optional

from conventions import clamp, mul, renorm, round_div, round_shift, sat32
from scene import Declaration, State

AXES = range(3)
NOTHING = (0, 0, 0)

Position = Callable[[int], Optional[tuple]]                    # of the device, by tick (65, section 4)


def lim(v: int, n: int) -> int:
    return clamp(v, -1 << n, 1 << n)


def scaled(v: int, e: int, f: int) -> int:
    """From x 2^-e to x 2^-f."""
    return v << (f - e) if f >= e else round_shift(v, e - f)


def dot(v: tuple, w: tuple) -> int:
    return sum(a * b for a, b in zip(v, w))


def cross(v: tuple, w: tuple) -> tuple:
    return v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]


def length(v: tuple) -> int:
    return isqrt(dot(v, v))


def unit(v: tuple) -> tuple:
    """The direction of a vector, x 2^-30."""
    n = length(v)
    return tuple(round_div(c << 30, n) for c in v) if n > 0 else NOTHING


def rows(q: tuple) -> tuple:
    """Rotation matrix, x 2^-30."""
    w, x, y, z = q

    def e(v: int) -> int:
        return lim(round_shift(v, 29), 30)

    h = 1 << 59
    return ((e(h - y * y - z * z), e(x * y - w * z), e(x * z + w * y)),
            (e(x * y + w * z), e(h - x * x - z * z), e(y * z - w * x)),
            (e(x * z - w * y), e(y * z + w * x), e(h - x * x - y * y)))


def turn(m: tuple, v: tuple) -> tuple:
    """To the world."""
    return tuple(round_shift(dot(row, v), 30) for row in m)


def back(m: tuple, v: tuple) -> tuple:
    """To the object's frame."""
    return turn(tuple(zip(*m)), v)


def small(h: tuple) -> tuple:
    return renorm(renorm((1 << 30,) + tuple(lim(c, 28) for c in h)))


class DrivenBody:
    """An object from the tick of its state on; names are those of the section."""

    def __init__(self, scene: Declaration, index: int, state: State):
        self.scene, self.state, self.dof = scene, state, scene.objects[index].dof
        self.tick = state.tick
        self.constants, self.held = scene.driven[index], state.contact.held
        self.x = tuple(c << (32 - scene.position_exp) for c in state.position)
        self.q = state.rotation
        self.touching = True
        self.c = tuple(lim(c << 15, 28) for c in state.contact.point)
        self.n = unit(tuple(lim(c << 20, 30) for c in state.contact.normal))
        gravity = scene.motion.gravity if scene.motion else NOTHING
        self.g = tuple(lim(scaled(c, scene.velocity_exp, 16), 30) for c in gravity)
        self.down = unit(self.g)
        self.v = tuple(lim(scaled(c, scene.velocity_exp, 27), 30) for c in state.velocity)
        self.w = tuple(lim(scaled(c, scene.angular_exp, 22), 30) for c in state.angular_velocity)
        if not self.held:
            self.find_screw()

    def find_screw(self) -> None:
        m = rows(self.q)
        v, w = back(m, self.v), back(m, self.w)
        r = tuple(lim(round_shift(isqrt(i << 30) * c, 25), 30) for i, c in zip(self.constants.inertia, w))
        s = isqrt(dot(v, v) + dot(r, r))
        self.speed = 0 if s < 1 << 10 else s
        if self.speed == 0:
            return
        self.along = tuple(lim(round_div(c << 24, s), 24) for c in v)
        self.about = tuple(lim(round_div(c << 24, s), 30) for c in w)
        direction = turn(m, self.along)
        fall = round_shift(dot(direction, self.down), 30)
        level = tuple(direction[a] - round_shift(fall * self.down[a], 30) for a in AXES)
        weight = length(self.g)
        self.rub = 0
        if weight > 0:
            deceleration = lim(scaled(self.scene.motion.slide_deceleration, self.scene.velocity_exp, 16), 30)
            self.rub = lim(round_div(length(level) * deceleration, weight), 30)
        self.first: Optional[int] = None

    def step(self, position: Optional[tuple]) -> None:
        """To the next tick; `position` is that of the device at this one."""
        m = rows(self.q)
        pull = self.pull(m, position)
        if self.held:
            self.step_held(m, pull)
        elif self.speed > 0:
            self.step_pushed(m, pull)

    def step_held(self, m: tuple, pull: tuple) -> None:
        rate, damping = self.scene.tick_rate, self.constants.damping
        moment = (lim(round_shift(c, 16), 37) for c in cross(self.c, pull))
        turned = turn(m, tuple(lim(round_div(round_div(c << 24, i), rate), 30) for c, i in zip(moment, self.constants.inertia)))
        v = tuple(lim(c + round_div((p + g) << 11, rate), 33) for c, p, g in zip(self.v, turn(m, pull), self.g))
        w = tuple(lim(c + t, 33) for c, t in zip(self.w, turned))
        self.x = tuple(lim(x + round_div(c << 5, rate), 58) for x, c in zip(self.x, v))
        self.q = renorm(mul(small(tuple(round_div(c << 7, rate) for c in w)), self.q))
        self.v = tuple(c - round_shift(c * damping, 20) for c in v)
        self.w = tuple(c - round_shift(c * damping, 20) for c in w)

    def step_pushed(self, m: tuple, pull: tuple) -> None:
        rate = self.scene.tick_rate
        direction, lever = turn(m, self.along), cross(self.about, self.c)
        load = max(0, round_shift(dot(tuple(lim(p + g, 30) for p, g in zip(turn(m, pull), self.g)), self.down), 30))
        if self.first is None:
            self.first = load
        j = tuple(lim(a + round_shift(c, 23), 30) for a, c in zip(self.along, lever))
        drive = round_shift(dot(pull, j) + dot(self.g, direction), 24)
        brake = (self.state.contact.drag << 12) + round_shift(self.rub * (load - self.first), 24)
        speed = clamp(self.speed + round_div((drive - brake) << 11, rate), 1, 1 << 33)
        s = min(round_div(speed << 5, rate), 1 << 31)
        self.x = tuple(lim(x + round_shift(s * c, 24), 58) for x, c in zip(self.x, direction))
        self.q = renorm(mul(self.q, small(tuple(round_shift(s * c, 22) for c in self.about))))
        self.speed = speed - round_shift(speed * self.constants.damping, 20)

    def pull(self, m: tuple, position: Optional[tuple]) -> tuple:
        """Acceleration by the device, object's frame."""
        if not self.touching or position is None:
            return self.lets_go()
        d = tuple(round_shift((p << (32 - self.scene.position_exp)) - x, 4) for p, x in zip(position, self.x))
        if any(abs(c) > 1 << 28 for c in d):
            return self.lets_go()
        d = back(m, d)
        if not self.held:
            depth = round_shift(dot(tuple(c - p for c, p in zip(self.c, d)), self.n), 30)
            if depth <= 0:
                return self.lets_go()
            self.slide(d, depth)
        k = self.constants.hold if self.held else self.constants.coupling
        return tuple(lim(round_shift(k * (p - c), 20), 30) for p, c in zip(d, self.c))

    def lets_go(self) -> tuple:
        self.touching = False
        return NOTHING

    def slide(self, d: tuple, depth: int) -> None:
        """The proxy, where the push leaves the cone of friction."""
        foot = tuple(p + round_shift(depth * c, 30) for p, c in zip(d, self.n))
        lag = tuple(lim(c - f, 30) for c, f in zip(self.c, foot))
        far, rim = length(lag), round_shift(self.constants.friction * depth, 8)
        if far > rim:
            self.c = tuple(lim(f + round_div(c * rim, far), 28) for f, c in zip(foot, lag))

    def pose(self, t: int, position: Position) -> tuple[tuple, tuple]:
        """What a client with a device shows in place of predict(); t never falls."""
        while self.tick < min(t, self.state.tick + self.scene.max_extrapolation):
            self.step(position(self.tick))
            self.tick += 1
        return self.shown()

    def shown(self) -> tuple[tuple, tuple]:
        shift = 32 - self.scene.position_exp
        position = tuple(sat32(round_shift(x, shift)) if self.dof >> a & 1 else p
                         for a, (x, p) in enumerate(zip(self.x, self.state.position)))
        return position, self.q if self.dof >> 3 else self.state.rotation
