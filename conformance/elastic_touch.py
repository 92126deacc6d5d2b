# SPDX-License-Identifier: Apache-2.0
"""Chapter 55 of the specification, section 4: where a device touches an elastic body, and how it pushes."""
from __future__ import annotations

from math import sqrt
from typing import NamedTuple, Optional

from elastic_matrix import AXES, cross, dot, minus, quotient

MOST_STEPS = 64


class Foot(NamedTuple):
    triangle: int
    weights: tuple                                          # of its corners
    point: tuple
    far: float                                              # squared distance


class Push(NamedTuple):
    corners: tuple
    weights: tuple
    force: tuple                                            # N


class Proxy(NamedTuple):
    """What a body keeps from tick to tick."""
    touches: bool = False
    triangle: Optional[int] = None
    weights: tuple = ()
    last: Optional[tuple] = None                            # the device at the tick before


class Surface:
    """The triangles at one shape of the body."""

    def __init__(self, triangles: list[tuple], triangles_of: list[list[int]], s: list[tuple]):
        self.triangles, self.triangles_of, self.s = triangles, triangles_of, s

    def point(self, triangle: int, weights: tuple) -> tuple:
        a, b, c = (self.s[v] for v in self.triangles[triangle])
        return tuple(weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i] for i in AXES)

    def inside(self, p: tuple, q: Foot) -> bool:
        a, b, c = (self.s[v] for v in self.triangles[q.triangle])
        return dot(minus(p, q.point), cross(minus(b, a), minus(c, a))) < 0

    def foot(self, p: tuple, triangle: int) -> Foot:
        weights = self.weights(p, *(self.s[v] for v in self.triangles[triangle]))
        point = self.point(triangle, weights)
        away = minus(p, point)
        return Foot(triangle, weights, point, dot(away, away))

    @staticmethod
    def weights(p: tuple, a: tuple, b: tuple, c: tuple) -> tuple:
        ab, ac, ap, bp, cp = minus(b, a), minus(c, a), minus(p, a), minus(p, b), minus(p, c)
        a1, a2 = dot(ab, ap), dot(ac, ap)
        b1, b2 = dot(ab, bp), dot(ac, bp)
        c1, c2 = dot(ab, cp), dot(ac, cp)
        in_c, in_b, in_a = a1 * b2 - b1 * a2, c1 * a2 - a1 * c2, b1 * c2 - c1 * b2
        if a1 <= 0 and a2 <= 0:
            return 1.0, 0.0, 0.0
        if b1 >= 0 and b2 <= b1:
            return 0.0, 1.0, 0.0
        if in_c <= 0 and a1 >= 0 and b1 <= 0:
            s = quotient(a1, a1 - b1)
            return 1 - s, s, 0.0
        if c2 >= 0 and c1 <= c2:
            return 0.0, 0.0, 1.0
        if in_b <= 0 and a2 >= 0 and c2 <= 0:
            s = quotient(a2, a2 - c2)
            return 1 - s, 0.0, s
        if in_a <= 0 and b2 - b1 >= 0 and c1 - c2 >= 0:
            s = quotient(b2 - b1, (b2 - b1) + (c1 - c2))
            return 0.0, 1 - s, s
        s = in_a + in_b + in_c
        v, w = quotient(in_b, s), quotient(in_c, s)
        return 1 - v - w, v, w

    def nearest(self, p: tuple) -> int:
        best = self.foot(p, 0)
        for triangle in range(1, len(self.triangles)):
            q = self.foot(p, triangle)
            if q.far < best.far or best.far != best.far:    # a NaN gives way
                best = q
        return best.triangle

    def descend(self, p: tuple, triangle: int) -> Foot:
        q = self.foot(p, triangle)
        for _ in range(MOST_STEPS):
            best = q
            for s in self.beside(q):
                foot = self.foot(p, s)
                if foot.far < best.far:
                    best = foot
            if best is q:
                break
            q = best
        return q

    def beside(self, q: Foot) -> list[int]:
        """The other triangles that hold the foot."""
        held = [set(self.triangles_of[c]) for c, weight in zip(self.triangles[q.triangle], q.weights) if weight != 0]
        return sorted(set.intersection(*held) - {q.triangle})

    def met(self, p: tuple, q: Foot, last: Optional[tuple]) -> Foot:
        """Where the path of the device met the surface."""
        if last is None:
            return q
        a, b, c = (self.s[v] for v in self.triangles[q.triangle])
        n = cross(minus(b, a), minus(c, a))
        over, under = dot(minus(last, a), n), dot(minus(p, a), n)
        if not over > 0:
            return q
        fraction = quotient(over, over - under)
        return self.descend(tuple(x + fraction * (y - x) for x, y in zip(last, p)), q.triangle)

    def hold(self, p: tuple, proxy: Proxy, friction: float) -> Foot:
        a, b, c = (self.s[v] for v in self.triangles[proxy.triangle])
        held = self.point(proxy.triangle, proxy.weights)
        n = cross(minus(b, a), minus(c, a))
        deep = quotient(dot(minus(p, held), n), dot(n, n))
        base = tuple(p[i] - deep * n[i] for i in AXES)
        lag, down = minus(held, base), minus(p, base)
        size, rim = sqrt(dot(lag, lag)), friction * sqrt(dot(down, down))
        if size <= rim:
            return Foot(proxy.triangle, proxy.weights, held, 0.0)
        fraction = quotient(rim, size)
        return self.descend(tuple(base[i] + fraction * lag[i] for i in AXES), proxy.triangle)

    def touch(self, p: tuple, proxy: Proxy, first_tick: bool, coupling: float, friction: float) -> tuple[Proxy, Optional[Push]]:
        """`p` is where the device is; `first_tick`: of its frame."""
        if not self.triangles:
            return proxy, None
        q = self.descend(p, self.nearest(p) if proxy.triangle is None else proxy.triangle)
        touches = self.inside(p, q)
        if first_tick and proxy.triangle is not None and not proxy.touches and not touches:
            q = self.descend(p, self.nearest(p))
            touches = self.inside(p, q)
        if touches and friction > 0:
            if not proxy.touches:
                first = self.met(p, q, proxy.last)
                proxy = proxy._replace(triangle=first.triangle, weights=first.weights)
            q = self.hold(p, proxy, friction)
        proxy = Proxy(touches, q.triangle, q.weights, p)
        if not touches:
            return proxy, None
        force = tuple(coupling * c for c in minus(p, q.point))
        return proxy, Push(self.triangles[q.triangle], q.weights, force)
