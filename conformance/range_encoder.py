# SPDX-License-Identifier: Apache-2.0
"""A range encoder whose payloads chapter 30 decodes. Written for reading: the payload is one large integer until the end."""
from __future__ import annotations


class RangeEncoder:
    def __init__(self) -> None:
        self.low, self.range, self.size = 0, (1 << 32) - 1, 0      # `low` has 32 + 8 * size bits

    def advance(self, offset: int, size: int) -> None:
        self.low += offset
        self.range = size
        while self.range < 1 << 24:
            self.low <<= 8
            self.range <<= 8
            self.size += 1

    def bit(self, m: list[int], value: int) -> None:
        zero, rate = m
        bound = (self.range >> 15) * zero
        if value:
            self.advance(bound, self.range - bound)
            m[0] -= zero >> rate
        else:
            self.advance(0, bound)
            m[0] += (32768 - zero) >> rate
        if rate < 6:
            m[1] += 1

    def raw(self, n: int, value: int) -> None:
        step, last = self.range >> n, (1 << n) - 1
        self.advance(value * step, self.range - last * step if value == last else step)

    def tree(self, models: list, n: int, value: int) -> None:
        node = 1
        for k in reversed(range(n)):
            self.bit(models[node], value >> k & 1)
            node = 2 * node + (value >> k & 1)

    def magnitude(self, models: list, value: int) -> None:
        width = value.bit_length()
        self.tree(models, 4, min(width, 15))
        if width >= 15:
            self.raw(5, width - 15)
        left = width - 1
        while left > 0:
            n = min(left, 16)
            left -= n
            self.raw(n, value >> left & ((1 << n) - 1))

    def signed(self, models: list, value: int) -> None:
        self.magnitude(models, abs(value))
        if value:
            self.raw(1, int(value < 0))

    def finish(self) -> bytes:
        """The shortest payload within the last interval."""
        for k in range(32, -1, -1):
            value = (self.low + (1 << k) - 1) >> k << k
            if value < self.low + self.range:
                break
        return value.to_bytes(4 + self.size, "big").rstrip(b"\0")
