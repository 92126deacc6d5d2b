# SPDX-License-Identifier: Apache-2.0
"""Chapter 25 of the specification: what packets of every kind have in common. R-PKT-1 to 5 and 7."""
from __future__ import annotations

from collections import deque
from typing import Any, Optional

from conventions import StreamError, require

LARGEST_TICK = (1 << 32) - 2
LATE = 128
AHEAD = 32767


class Receiver:
    """What is kept for a substream. A state has a `tick`."""

    def __init__(self, initial: Any, span: int, largest_packet: int, tick_rate: int):
        self.initial, self.span, self.largest_packet = initial, span, largest_packet
        self.kept: deque[tuple[int, Any]] = deque(maxlen=span)    # states that may be baselines, by number
        self.current = initial
        self.newest = 0                                     # number of the packet accepted last
        self.arrival: Optional[int] = None                  # tick of the receiver's clock when it arrived
        self.discard_after = max(1 << 14, 16 * tick_rate)

    def open(self, data: bytes, now: Optional[int] = None) -> int:
        """The number of a packet that may be decoded. It arrives at tick `now` of the receiver's clock, if that has one."""
        require(len(data) <= self.largest_packet, "limit_exceeded", "R-PKT-1")
        require(len(data) >= 2, "truncated", "R-PKT-2")
        if now is not None and self.arrival is not None and now - self.arrival > self.discard_after:
            self.kept.clear()
        sequence = data[0] | data[1] << 8
        require(not self.kept or (self.newest - sequence) % (1 << 16) >= LATE, "state", "R-PKT-5")
        return self.newest + 1 + (sequence - self.newest - 1) % (1 << 16)

    def baseline(self, number: int, key: int, baseline_delta: int) -> Any:
        require(1 <= baseline_delta <= self.span, "invalid", "R-PKT-3")
        if key:
            return self.initial
        if self.kept and number - self.newest > AHEAD:
            self.kept.clear()
            raise StreamError("state", "R-PKT-7")
        for kept_number, state in self.kept:
            if kept_number == number - baseline_delta:
                return state
        raise StreamError("state", "R-PKT-4")

    def tick(self, baseline: Any, key: int, tick_delta: int, rule: str) -> int:
        tick = baseline.tick + tick_delta
        require((key or tick >= self.current.tick) and tick <= LARGEST_TICK, "invalid", rule)
        return tick

    def accept(self, number: int, key: int, state: Any, now: Optional[int] = None) -> None:
        if key and (number - self.newest > AHEAD or state.tick < self.current.tick):
            self.kept.clear()
        self.kept.append((number, state))
        self.current, self.newest, self.arrival = state, number, now
