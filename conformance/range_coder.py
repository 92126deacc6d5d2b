# SPDX-License-Identifier: Apache-2.0
"""Chapter 30 of the specification: the range decoder."""
from __future__ import annotations

from conventions import require


class RangeDecoder:
    """A model is a list [zero, rate]; models are lists of them, numbered from 1 (entry 0 is not used)."""

    def __init__(self, payload: bytes):
        self.payload = payload
        self.range, self.code, self.position = (1 << 32) - 1, 0, 0
        for _ in range(4):
            self.code = (self.code << 8) | self.next()

    def next(self) -> int:
        self.position += 1
        return self.payload[self.position - 1] if self.position <= len(self.payload) else 0

    def normalise(self) -> None:
        while self.range < 1 << 24:
            self.code = ((self.code << 8) | self.next()) & 0xFFFFFFFF
            self.range <<= 8

    def bit(self, m: list[int]) -> int:
        zero, rate = m
        bound = (self.range >> 15) * zero
        if self.code < bound:
            value = 0
            self.range = bound
            m[0] += (32768 - zero) >> rate
        else:
            value = 1
            self.code -= bound
            self.range -= bound
            m[0] -= zero >> rate
        if rate < 6:
            m[1] += 1
        self.normalise()
        return value

    def raw(self, n: int) -> int:
        step = self.range >> n
        last = (1 << n) - 1
        value = min(self.code // step, last)
        self.code -= value * step
        self.range = self.range - value * step if value == last else step
        self.normalise()
        return value

    def tree(self, models: list, n: int) -> int:
        node = 1
        for _ in range(n):
            node = 2 * node + self.bit(models[node])
        return node - (1 << n)

    def magnitude(self, models: list) -> int:
        w = self.tree(models, 4)
        if w == 15:
            w = 15 + self.raw(5)
        if w < 2:
            return w
        require(w <= 32, "malformed", "R-RNG-4")
        v, left = 1, w - 1
        while left > 0:
            n = min(left, 16)
            left -= n
            v = (v << n) | self.raw(n)
        return v

    def signed(self, models: list) -> int:
        m = self.magnitude(models)
        if m == 0:
            return 0
        negative = self.raw(1)
        require(m < 1 << 31, "malformed", "R-RNG-4")
        return -m if negative else m

    def signed_like(self, models: list, model: list[int], like: int) -> int:
        """A number that often has the sign of `like`."""
        m = self.magnitude(models)
        return 0 if m == 0 else self.with_sign(m, model, like)

    def nonzero_like(self, models: list, model: list[int], like: int) -> int:
        """The same of a number that is not 0."""
        return self.with_sign(self.magnitude(models) + 1, model, like)

    def with_sign(self, m: int, model: list[int], like: int) -> int:
        negative = bool(self.raw(1)) if like == 0 else bool(self.bit(model)) != (like < 0)
        require(m < 1 << 31, "malformed", "R-RNG-4")
        return -m if negative else m

    def check_end(self) -> None:
        """After the last symbol."""
        require(len(self.payload) <= self.position, "malformed", "R-RNG-2")
        require(self.payload[-1:] != b"\x00", "malformed", "R-RNG-3")
