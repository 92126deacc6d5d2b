# SPDX-License-Identifier: Apache-2.0
"""Chapter 60 of the specification, section 3: offsets that fade, on which objects are shown between two motions."""
from __future__ import annotations

from math import isqrt
from typing import NamedTuple

from conventions import ONE, asin30, axis_angle, conj, mul, renorm, round_div, round_shift, sat32
from rigid import HALF_RADIAN
from scene import Declaration

AT_REST = ((0, 0, 0), (0, 0, 0))


class Offset(NamedTuple):
    position: tuple                                         # on the grid
    rotation: tuple                                         # half the angle times the axis, as binary angles


NO_OFFSET = Offset(*AT_REST)


def offset(a: tuple, b: tuple) -> Offset:
    """From pose a to pose b."""
    return Offset(tuple(sat32(y - x) for x, y in zip(a[0], b[0])), half_vector(mul(b[1], conj(a[1]))))


def half_vector(d: tuple) -> tuple:
    if d[0] < 0:
        d = tuple(-c for c in d)
    s = isqrt(sum(c * c for c in d[1:]))
    if s == 0:
        return 0, 0, 0
    h = asin30(min(s, ONE))
    return tuple(round_div(c * h, s) for c in d[1:])


def difference(scene: Declaration, before: tuple, after: tuple, time: int) -> Offset:
    """What the motion `after`, a velocity and an angular velocity, does beyond `before` in so many ticks."""
    position = []
    rotation = []
    for axis in range(3):
        d = sat32(after[0][axis] - before[0][axis]) * time << (scene.position_exp - scene.velocity_exp)
        position.append(sat32(round_div(d, scene.tick_rate)))
        d = round_div((after[1][axis] - before[1][axis]) * time, scene.tick_rate)
        rotation.append(sat32(round_shift(d * HALF_RADIAN, scene.angular_exp)))
    return Offset(tuple(position), tuple(rotation))


def displaced(pose: tuple, error: Offset, change: Offset, i: int, j: int, b: int) -> tuple[tuple, tuple]:
    p, q = pose
    position = tuple(sat32(p[axis] + round_shift(i * error.position[axis] + b * change.position[axis], 30)) for axis in range(3))
    r = tuple(round_shift(j * e + b * d, 30) for e, d in zip(error.rotation, change.rotation))
    n = isqrt(sum(c * c for c in r))
    if n == 0:
        return position, q
    return position, renorm(mul(axis_angle(tuple(round_div(c << 30, n) for c in r), n), q))


def cubic(u: int) -> tuple[int, int]:
    u2 = round_shift(u * u, 30)
    u3 = round_shift(u2 * u, 30)
    return 3 * u2 - 2 * u3, u3 - u2
