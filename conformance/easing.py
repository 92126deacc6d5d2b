# SPDX-License-Identifier: Apache-2.0
"""Chapter 60 of the specification, section 8: how a client passes over to an update of an eased scene."""
from __future__ import annotations

from math import isqrt
from typing import NamedTuple

from conventions import ONE, asin30, axis_angle, conj, mul, renorm, round_div, round_shift, sat32
from scene import State

SIXTEENTHS = (16, 15, 12, 8)


class Offset(NamedTuple):
    """What is left to go at the tick of an update."""
    o: tuple = (0, 0, 0)
    u: tuple = (0, 0, 0)
    half: int = 0


def offset(shown: tuple[tuple, tuple], state: State) -> Offset:
    n = SIXTEENTHS[state.keep]
    o = tuple(sat32(round_shift((a - b) * n, 4)) for a, b in zip(shown[0], state.position))
    d = mul(shown[1], conj(state.rotation))
    if d[0] < 0:
        d = tuple(-c for c in d)
    s = isqrt(sum(c * c for c in d[1:]))
    if s == 0:
        return Offset(o)
    return Offset(o, tuple(round_div(c << 30, s) for c in d[1:]), round_shift(asin30(min(s, ONE)) * n, 4))


def add(pose: tuple[tuple, tuple], state: State, what: Offset, t: int) -> tuple[tuple, tuple]:
    left = (1 << state.ease) - (t - state.tick)
    if state.ease == 0 or left <= 0:
        return pose
    position = tuple(sat32(p + round_shift(c * left, state.ease)) for p, c in zip(pose[0], what.o))
    h = round_shift(what.half * left, state.ease)
    return position, pose[1] if h == 0 else renorm(mul(axis_angle(what.u, h), pose[1]))
