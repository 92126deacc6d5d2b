# SPDX-License-Identifier: Apache-2.0
"""Chapter 65 of the specification, sections 2 and 4: the scene of a device, and its path in the ticks of the server."""
from __future__ import annotations

from typing import Optional

from conventions import round_div
from rigid import predict
from scene import Declaration, Object, State

MOST_PACKETS = 2048                                         # that are remembered


def device_scene(scene: Declaration) -> Declaration:
    device = Object("device", 63, State(0, (0, 0, 0), (1 << 30, 0, 0, 0)))
    return Declaration(scene.version, scene.profile, scene.tick_rate, scene.position_exp, scene.velocity_exp, scene.rotation_exp,
                       scene.angular_exp, round_div(scene.tick_rate, 10), 64, objects=[device])


class DevicePath:
    """The states of a device in its scene, by the numbers of their packets, which of these act, and its tick mappings."""

    def __init__(self, scene: Declaration):
        self.scene = scene
        self.states: dict[int, State] = {}
        self.accepted: set[int] = set()
        self.acknowledged = 0                               # the highest
        self.revision = 0                                   # of what is known of the past
        self.offsets: dict[int, int] = {}                   # of tick mappings, by the tick of the server from which they hold

    def begin(self, tick: int, offset: int) -> None:
        if tick > max(self.offsets, default=-1):
            self.offsets[tick] = offset
            self.revision += 1

    def device_tick(self, t: int) -> Optional[int]:
        tick = None
        begun = [begin for begin in self.offsets if begin <= t]
        for begin, after in zip(begun, begun[1:] + [t + 1]):
            reached = after - 1 - self.offsets[begin]
            tick = reached if tick is None else max(tick, reached)
        return tick

    def add(self, number: int, state: State) -> None:
        self.states[number] = state
        self.states = {n: kept for n, kept in self.states.items() if n > number - MOST_PACKETS}

    def acknowledge(self, numbers: set[int]) -> None:
        """These packets take effect, and others below the highest do not as far as is known."""
        self.revision += 1
        self.acknowledged = max(self.acknowledged, *numbers)
        self.accepted = {n for n in self.accepted | numbers if n > self.acknowledged - MOST_PACKETS}

    def takes_effect(self, number: int) -> bool:
        return number > self.acknowledged or number in self.accepted

    def position(self, t: int) -> Optional[tuple]:
        tick = self.device_tick(t)
        if tick is None:
            return None
        effective = (n for n in sorted(self.states, reverse=True) if self.states[n].tick <= tick and self.takes_effect(n))
        number = next(effective, None)
        return None if number is None else predict(self.scene, self.states[number], tick)[0]
