# SPDX-License-Identifier: Apache-2.0
"""Chapter 10 of the specification: bytes, rounding, angles and quaternions, hash; errors of the registry."""
from __future__ import annotations


class StreamError(Exception):
    """Input that breaks a rule: its error class (registry, section 1) and the rule."""

    def __init__(self, errc: str, rule: str):
        super().__init__(f"{errc} {rule}")
        self.errc = errc
        self.rule = rule


def require(condition: bool, errc: str, rule: str) -> None:
    if not condition:
        raise StreamError(errc, rule)


# ---- Sections 4 and 5: bytes, rounding ------------------------------------------------------------------

class Cursor:
    """Reads data[position:end]; `cut` and `overlong` are the (class, rule) of the element that is read."""

    def __init__(self, data: bytes, position: int, end: int):
        self.data, self.position, self.end = data, position, end

    def left(self) -> int:
        return self.end - self.position

    def take(self, size: int, cut: tuple[str, str]) -> bytes:
        require(size <= self.left(), *cut)
        self.position += size
        return self.data[self.position - size:self.position]

    def number(self, size: int, cut: tuple[str, str]) -> int:
        """u8, u16, u32 or u64."""
        return int.from_bytes(self.take(size, cut), "little")

    def varint(self, cut: tuple[str, str], overlong: tuple[str, str]) -> int:
        value = 0
        for i in range(10):
            byte = self.number(1, cut)
            value |= (byte & 0x7F) << (7 * i)
            if byte < 0x80:
                require(value < 1 << 64 and (byte != 0 or i == 0), *overlong)
                return value
        raise StreamError(*overlong)


def zigzag(z: int) -> int:
    return z // 2 if z % 2 == 0 else -((z + 1) // 2)


STR_5 = ("truncated", "R-STR-5")
STR_5_VARINT = ("malformed", "R-STR-5")


def text(data: bytes) -> str:
    try:
        name = data.decode("utf-8")
    except UnicodeDecodeError:
        raise StreamError("invalid", "R-STR-11") from None
    require(name != "" and all(ord(c) >= 32 and ord(c) != 127 for c in name), "invalid", "R-STR-11")
    return name


def clamp(v: int, lo: int, hi: int) -> int:
    return max(lo, min(v, hi))


def round_shift(v: int, n: int) -> int:
    return v if n == 0 else (v + (1 << (n - 1))) >> n


def round_div(a: int, b: int) -> int:
    return (a + b // 2) // b


def sat32(v: int) -> int:
    return clamp(v, -1 << 31, (1 << 31) - 1)


# ---- Section 6: angles and quaternions -------------------------------------------------------------------

ONE = 1 << 30


def sin30(t: int) -> int:
    t %= 1 << 32
    quadrant = t >> 30
    x = t % ONE
    if quadrant % 2 == 1:
        x = ONE - x
    s = round_shift(x * x, 30)
    total = -3670
    for c in (172032, -5026852, 85569264, -693598663, 1686629713):
        total = c + round_shift(total * s, 30)
    y = round_shift(total * x, 30)
    return -y if quadrant >= 2 else y


def cos30(t: int) -> int:
    return sin30(t + ONE)


def asin30(s: int) -> int:
    low, high = 0, ONE
    while low < high:
        mid = low + ((high - low) >> 1)
        if sin30(mid) >= s:
            high = mid
        else:
            low = mid + 1
    return low


def unit30(c: int) -> int:
    return clamp(round_shift(c, 30), -ONE, ONE)


def mul(a: tuple, b: tuple) -> tuple:
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    product = (aw * bw - ax * bx - ay * by - az * bz,
               aw * bx + ax * bw + ay * bz - az * by,
               aw * by - ax * bz + ay * bw + az * bx,
               aw * bz + ax * by - ay * bx + az * bw)
    return tuple(unit30(c) for c in product)


def conj(q: tuple) -> tuple:
    w, x, y, z = q
    return (w, -x, -y, -z)


def renorm(q: tuple) -> tuple:
    n = sum(c * c for c in q)
    f = (3 * ONE - round_shift(n, 30)) >> 1
    return tuple(unit30(c * f) for c in q)


def axis_angle(u: tuple, h: int) -> tuple:
    s = sin30(h)
    return (cos30(h),) + tuple(round_shift(c * s, 30) for c in u)


# ---- Section 7: hash ------------------------------------------------------------------------------------

FNV_START = 0xCBF29CE484222325


def fnv1a(data: bytes, h: int = FNV_START) -> int:
    for byte in data:
        h = ((h ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return h
