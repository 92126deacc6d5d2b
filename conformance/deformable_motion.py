# SPDX-License-Identifier: Apache-2.0
"""Chapter 50 of the specification: prediction in time of the coefficients of a basis, by recursive least squares."""
from __future__ import annotations

from typing import NamedTuple

from conventions import clamp, round_div, round_shift, sat32
from deformable_header import Mode

FARTHEST = 1 << 27
MOST_FRAMES = 8


def lim(x: int) -> int:
    return clamp(x, -FARTHEST, FARTHEST)


class Motion(NamedTuple):
    """The last two increments of a coefficient, and their correlations."""
    last: int = 0
    before: int = 0
    s11: int = 0
    s12: int = 0
    s22: int = 0
    s01: int = 0
    s02: int = 0


def predictor(c: Motion) -> tuple[int, int]:
    z = max(0, max(abs(s) for s in c[2:]).bit_length() - 24)
    s11, s12, s22, s01, s02 = (s >> z for s in c[2:])
    s11 += (s11 >> 6) + 1
    s22 += (s22 >> 6) + 1
    d = s11 * s22 - s12 * s12
    if d <= 0:
        return 0, 0
    return (clamp(round_div((s01 * s22 - s02 * s12) << 12, d), -8192, 8192),
            clamp(round_div((s02 * s11 - s01 * s12) << 12, d), -8192, 8192))


def extrapolate(c: Motion, frames: int) -> int:
    """The sum of the next increments."""
    if c.last == 0 and c.before == 0:
        return 0
    a1, a2 = predictor(c)
    x, y, total = c.last, c.before, 0
    bound = min(FARTHEST, 2 * max(abs(x), abs(y)))
    for _ in range(min(frames, MOST_FRAMES)):
        x, y = clamp(round_shift(a1 * x + a2 * y, 12), -bound, bound), x
        total += x
    return lim(total)


def update(c: Motion, frames: int, x: int) -> Motion:
    if frames == 0:
        return c._replace(last=sat32(c.last + x))
    now = round_div(x, frames)
    if frames > 1:
        return c._replace(last=now, before=now)
    w0, w1, w2 = (clamp(w, -1 << 24, 1 << 24) for w in (now, c.last, c.before))
    products = (w1 * w1, w1 * w2, w2 * w2, w0 * w1, w0 * w2)
    return Motion(now, c.last, *(s + p - (s >> 5) for s, p in zip(c[2:], products)))


def combine(modes: list[Mode], g: list[int], x: list[int]) -> None:
    """Adds the modes, each times its coefficient, to the components `x`."""
    if not any(g):
        return
    z = max(0, max(abs(c) for c in g).bit_length() - 14)
    used = [(mode.entries, round_shift(c, z)) for mode, c in zip(modes, g) if c != 0]
    for i in range(len(x)):
        x[i] = lim(x[i] + round_shift(sum(entries[i] * c for entries, c in used) << z, 11))
