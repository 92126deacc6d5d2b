# SPDX-License-Identifier: Apache-2.0
"""Chapter 85 of the specification, section 3: a client that interpolates from what it showed to where dead reckoning has an object."""
from __future__ import annotations

from collections import deque
from typing import Optional

from conventions import clamp, round_div
from curve import AT_REST, NO_OFFSET, Offset, cubic, difference, displaced, offset
from device_path import DevicePath
from replica import Replica, ReplicaObject
from rigid import motion
from scene import Declaration, State

MODES = ("linear", "hermite", "blending")
FRACTION = 49152                                               # P = 75 %, x 2^-16
MOST_GAPS = 5
LONGEST_GAP = (1 << 31) - 1


class InterpolatedObject(ReplicaObject):
    """From `begin` to `end` an object is shown beside where its state has it."""
    error: Offset
    change: Offset

    def __init__(self, index: int, state: State):
        super().__init__(index, state)
        self.end = 0
        self.gaps: deque[int] = deque(maxlen=MOST_GAPS)


class InterpolatedReplica(Replica):
    """Of a scene that is not smoothed; mode is "linear", "hermite" or "blending"."""
    Object = InterpolatedObject

    def __init__(self, scene: Declaration, mode: str, path: Optional[DevicePath] = None):
        super().__init__(scene, path)
        self.mode = mode
        self.shortest = round_div(5 * scene.tick_rate, 1000)
        self.longest = round_div(100 * scene.tick_rate, 1000)

    def apply_state(self, o: InterpolatedObject, state: State, now: int) -> None:
        shown = self.pose(o, now)
        before, running = self.velocities(o.state, now), now < o.end
        if o.number > 0:                                    # this is not the first update
            o.gaps.append(min(now - o.begin, LONGEST_GAP))
        o.state = state
        o.begin = o.end = now
        if running or not o.gaps:
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

    def pose(self, o: InterpolatedObject, now: int) -> tuple[tuple, tuple]:
        now = max(now, o.begin)
        if now >= o.end:
            return self.expected(o, now)
        u = round_div((o.end - now) << 30, o.end - o.begin)
        c, b = cubic(u)
        k = c if self.mode == "hermite" else u
        return displaced(self.expected(o, now), o.error, o.change, k, k, b)
