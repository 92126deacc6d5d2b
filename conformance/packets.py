# SPDX-License-Identifier: Apache-2.0
"""Chapter 40, sections 2 and 7: what packets of every kind have in common. R-PKT-1 to 5."""
from __future__ import annotations

from collections import deque
from typing import Any

from conventions import StreamError, require

LARGEST_TICK = (1 << 32) - 2


class Receiver:
    """Keeps the initial state and the states after the newest `span` packets. A state has a `tick`."""

    def __init__(self, initial: Any, span: int, largest_packet: int):
        self.initial, self.span, self.largest_packet = initial, span, largest_packet
        self.kept: deque[tuple[int, Any]] = deque(maxlen=span)

    def current(self) -> Any:
        return self.kept[-1][1] if self.kept else self.initial

    def open(self, data: bytes) -> int:
        """The sequence number of a packet that may be decoded."""
        require(len(data) <= self.largest_packet, "limit_exceeded", "R-PKT-1")
        require(len(data) >= 2, "truncated", "R-PKT-2")
        sequence = data[0] | data[1] << 8
        if self.kept:
            require(1 <= (sequence - self.kept[-1][0]) % (1 << 16) <= 32767, "state", "R-PKT-5")
        return sequence

    def baseline(self, sequence: int, key: int, baseline_delta: int) -> Any:
        require(1 <= baseline_delta <= self.span, "invalid", "R-PKT-3")
        if key:
            return self.initial
        wanted = (sequence - baseline_delta) % (1 << 16)
        for kept_sequence, state in reversed(self.kept):
            if kept_sequence == wanted:
                return state
        raise StreamError("state", "R-PKT-4")

    def tick(self, baseline: Any, tick_delta: int, rule: str) -> int:
        tick = baseline.tick + tick_delta
        require(self.current().tick <= tick <= LARGEST_TICK, "invalid", rule)
        return tick

    def keep(self, sequence: int, state: Any) -> None:
        self.kept.append((sequence, state))
