# SPDX-License-Identifier: Apache-2.0
"""Chapter 25 of the specification: what packets of every kind have in common. R-PKT-1 and 3 to 5."""
from __future__ import annotations

from typing import Any

from conventions import require

LARGEST_TICK = (1 << 32) - 2
LARGEST_NUMBER = (1 << 62) - 1
FARTHEST = 4095                                             # baseline_delta


class Receiver:
    """What is kept for a substream. A state has a `tick`."""

    def __init__(self, initial: Any, span: int, largest_packet: int):
        self.initial, self.span, self.largest_packet = initial, span, largest_packet
        self.kept: dict[int, Any] = {}                      # states that may be baselines, by number

    @property
    def newest(self) -> int:
        return max(self.kept, default=0)

    @property
    def current(self) -> Any:
        return self.kept[self.newest] if self.kept else self.initial

    def open(self, number: int, data: bytes) -> None:
        """Whether the packet of this number may be decoded."""
        require(len(data) <= self.largest_packet, "limit_exceeded", "R-PKT-1")
        require(not self.kept or number > min(self.kept) and number not in self.kept, "state", "R-PKT-5")

    def baseline(self, number: int, key: int, baseline_delta: int) -> Any:
        require(1 <= baseline_delta <= FARTHEST, "invalid", "R-PKT-3")
        if key:
            return self.initial
        require(number - baseline_delta in self.kept, "state", "R-PKT-4")
        return self.kept[number - baseline_delta]

    def tick(self, number: int, baseline: Any, tick_delta: int, rule: str) -> int:
        tick = baseline.tick + tick_delta
        fits = tick >= self.current.tick if number > self.newest else tick <= self.current.tick
        require(fits and tick <= LARGEST_TICK, "invalid", rule)
        return tick

    def accept(self, number: int, state: Any) -> None:
        """Keeps a state."""
        self.kept[number] = state
        if len(self.kept) > self.span:
            del self.kept[min(self.kept)]

    def at(self, tick: int) -> Any:
        """The state that a client shows at a tick in the past (60, section 6)."""
        past = [number for number, state in self.kept.items() if state.tick <= tick]
        if past:
            return self.kept[max(past)]
        return self.kept[min(self.kept)] if self.kept else self.initial
