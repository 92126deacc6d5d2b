# SPDX-License-Identifier: Apache-2.0
"""Chapter 60 of the specification, section 8: how a client passes over to an update of a smoothed scene."""
from __future__ import annotations

from conventions import round_shift
from curve import NO_OFFSET, Offset, displaced, offset
from scene import State

SIXTEENTHS = (16, 15, 12, 8)


def kept(shown: tuple[tuple, tuple], state: State) -> Offset:
    """What is left to go at the tick of a state."""
    d = offset((state.position, state.rotation), shown)
    n = SIXTEENTHS[state.retained]
    return Offset(*(tuple(round_shift(c * n, 4) for c in vector) for vector in d))


def smoothed(pose: tuple[tuple, tuple], state: State, left: Offset, t: int) -> tuple[tuple, tuple]:
    rest = (1 << state.smoothing_exp) - (t - state.tick)
    if state.smoothing_exp == 0 or rest <= 0:
        return pose
    w = rest << (30 - state.smoothing_exp)
    return displaced(pose, left, NO_OFFSET, w, w, 0)
