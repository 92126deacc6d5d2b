# SPDX-License-Identifier: Apache-2.0
"""Chapter 25 of the specification: what packets of every kind have in common. R-PKT-1 to 5 and 7."""
from __future__ import annotations

from typing import Any, Optional

from conventions import StreamError, require

LARGEST_TICK = (1 << 32) - 2
BEHIND = 127
AHEAD = 32767


class Receiver:
    """What is kept for a substream. A state has a `tick`."""

    def __init__(self, initial: Any, span: int, largest_packet: int, tick_rate: int):
        self.initial, self.span, self.largest_packet = initial, span, largest_packet
        self.kept: dict[int, Any] = {}                      # states that may be baselines, by number
        self.current = initial
        self.newest = 0                                     # highest number accepted
        self.arrival: Optional[int] = None                  # tick of the receiver's clock when it arrived
        self.discard_after = max(1 << 14, 16 * tick_rate)

    def open(self, data: bytes, now: Optional[int] = None) -> int:
        """The number of a packet that may be decoded. It arrives at tick `now` of the receiver's clock, if that has one."""
        require(len(data) <= self.largest_packet, "limit_exceeded", "R-PKT-1")
        require(len(data) >= 2, "truncated", "R-PKT-2")
        if now is not None and self.arrival is not None and now - self.arrival > self.discard_after:
            self.kept.clear()
        sequence = data[0] | data[1] << 8
        behind = (self.newest - sequence) % (1 << 16)
        if not self.kept or behind > BEHIND:
            return self.newest + 1 + (sequence - self.newest - 1) % (1 << 16)
        number = self.newest - behind
        require(number > min(self.kept) and number not in self.kept, "state", "R-PKT-5")
        return number

    def baseline(self, number: int, key: int, baseline_delta: int) -> Any:
        require(1 <= baseline_delta <= self.span, "invalid", "R-PKT-3")
        if key:
            return self.initial
        if self.kept and number - self.newest > AHEAD:
            self.kept.clear()
            raise StreamError("state", "R-PKT-7")
        require(number - baseline_delta in self.kept, "state", "R-PKT-4")
        return self.kept[number - baseline_delta]

    def tick(self, number: int, baseline: Any, key: int, tick_delta: int, rule: str) -> int:
        tick = baseline.tick + tick_delta
        fits = tick <= self.current.tick if number <= self.newest else key or tick >= self.current.tick
        require(fits and tick <= LARGEST_TICK, "invalid", rule)
        return tick

    def accept(self, number: int, key: int, state: Any, now: Optional[int] = None) -> bool:
        """Keeps a state. True if the packet restarts the substream."""
        ahead = number - self.newest
        restarts = ahead > 0 and bool(key) and (ahead > AHEAD or state.tick < self.current.tick)
        if restarts:
            self.kept.clear()
        self.kept[number] = state
        if len(self.kept) > self.span:
            del self.kept[min(self.kept)]
        if ahead > 0:
            self.current, self.newest, self.arrival = state, number, now
        return restarts

    def at(self, tick: int) -> Any:
        """The state that a client shows at a tick in the past (60, section 6)."""
        past = [number for number, state in self.kept.items() if state.tick <= tick]
        if past:
            return self.kept[max(past)]
        return self.kept[min(self.kept)] if self.kept else self.current
