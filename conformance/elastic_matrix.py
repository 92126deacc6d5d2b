# SPDX-License-Identifier: Apache-2.0
"""Chapter 55 of the specification, section 3: the elements of an elastic body, the order of its vertices and its matrix.

Numbers are binary64 in the written order, so no sum() here: it does not round after each term everywhere.
"""
from __future__ import annotations

from math import copysign, inf, nan
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from elastic_header import ElasticBody

AXES = range(3)


# ---- Arithmetic (section 2) -----------------------------------------------------------------------------------------
def quotient(a: float, b: float) -> float:
    """a / b of IEEE 754, for divisors that may be 0."""
    if b != 0:
        return a / b
    return nan if a == 0 or a != a else copysign(inf, a) * copysign(1.0, b)


def dot(p: tuple, q: tuple) -> float:
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def cross(p: tuple, q: tuple) -> tuple:
    return p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]


def minus(p: tuple, q: tuple) -> tuple:
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


# ---- Elements (section 3.1) -----------------------------------------------------------------------------------------
class Element(NamedTuple):
    corners: tuple
    g: tuple                                                # four vectors
    mu2: float
    lambda_: float


def edges(rest: list[tuple], corners: tuple) -> tuple:
    """x, y, z"""
    return tuple(minus(rest[c], rest[corners[0]]) for c in corners[1:])


def six_volumes(x: tuple, y: tuple, z: tuple) -> float:
    return dot(cross(x, y), z)


def elements_and_masses(body: ElasticBody) -> tuple[list[Element], list[float]]:
    elements, mass = [], [0.0] * len(body.rest)
    for corners, number in zip(body.tetrahedra, body.material_of):
        young, poisson, density = body.materials[number]
        x, y, z = edges(body.rest, corners)
        six = six_volumes(x, y, z)
        g1, g2, g3 = (tuple(c / six for c in n) for n in (cross(y, z), cross(z, x), cross(x, y)))
        g0 = tuple(-(g1[a] + g2[a] + g3[a]) for a in AXES)
        mu2 = six / 3 * (young / (2 * (1 + poisson)))
        lambda_ = six / 6 * (young * poisson / ((1 + poisson) * (1 - 2 * poisson)))
        elements.append(Element(corners, (g0, g1, g2, g3), mu2, lambda_))
        for c in corners:
            mass[c] = mass[c] + density * six / 24
    return elements, mass


# ---- Order (section 3.2) --------------------------------------------------------------------------------------------
class Order(NamedTuple):
    order: list[int]                                        # of the free vertices
    order_index: dict[int, int]                                   # of each in `order`
    first: list[int]


def order_of(body: ElasticBody) -> Order:
    near: dict[int, set] = {v: set() for v in range(len(body.rest)) if v not in body.fixed}
    for corners in body.tetrahedra:
        free = [c for c in corners if c in near]
        for v in free:
            near[v].update(w for w in free if w != v)

    def walk(s: int) -> list[int]:
        listed, seen = [s], {s}
        for v in listed:                                    # also those appended meanwhile
            new = sorted((w for w in near[v] if w not in seen), key=lambda w: (len(near[w]), w))
            listed += new
            seen.update(new)
        return listed

    order: list[int] = []
    done: set[int] = set()
    for s in near:
        if s not in done:
            part = walk(walk(s)[-1])
            order += part
            done.update(part)
    order.reverse()
    order_index = {v: i for i, v in enumerate(order)}
    return Order(order, order_index, [min([i, *(order_index[w] for w in near[v])]) for i, v in enumerate(order)])


def work(order: Order) -> int:
    """Chapter 55, section 1.3: what factoring takes."""
    total = 0
    for i, first in enumerate(order.first):
        for a in AXES:
            total += (3 * (i - first) + a + 64) ** 2
    return total


# ---- Matrix (section 3.3) -------------------------------------------------------------------------------------------
class Matrix:
    """A = L D L^T. Rows begin at their first column."""

    def __init__(self, order: Order, elements: list[Element], mass: list[float], heavy: float, stiff: float):
        self.first = [3 * order.first[row // 3] for row in range(3 * len(order.order))]
        self.rows = [[0.0] * (row + 1 - first) for row, first in enumerate(self.first)]
        self.assemble(order.order_index, elements, stiff)
        for i, v in enumerate(order.order):
            for a in AXES:
                self.rows[3 * i + a][-1] += heavy * mass[v]
        self.lower: list[list[float]] = []                  # L, without its diagonal
        self.diagonal: list[float] = []                     # D
        for row in range(len(self.rows)):
            self.factor(row)

    def assemble(self, order_index: dict[int, int], elements: list[Element], stiff: float) -> None:
        for corners, g, mu2, lambda_ in elements:
            rows = [order_index.get(c) for c in corners]
            for r, i in enumerate(rows):
                for q, j in enumerate(rows):
                    if i is None or j is None or j > i:
                        continue
                    along = dot(g[r], g[q])
                    for a in AXES:
                        row = 3 * i + a
                        for b in AXES:
                            if 3 * j + b <= row:
                                k = lambda_ * g[r][a] * g[q][b] + mu2 / 2 * g[r][b] * g[q][a]
                                k = k + (mu2 / 2 * along if a == b else 0)
                                self.rows[row][3 * j + b - self.first[row]] += stiff * k

    def factor(self, i: int) -> None:
        f, a = self.first[i], self.rows[i]
        t: list[float] = []                                 # from column f on
        for j in range(f, i):
            x = a[j - f]
            start = max(f, self.first[j])
            for tk, ljk in zip(t[start - f:], self.lower[j][start - self.first[j]:]):
                x = x - tk * ljk
            t.append(x)
        d = a[i - f]
        lower = []
        for j in range(f, i):
            lower.append(quotient(t[j - f], self.diagonal[j]))
            d = d - t[j - f] * lower[-1]
        self.lower.append(lower)
        self.diagonal.append(d)

    def solve(self, b: list[float]) -> list[float]:
        """A^-1 b"""
        b = list(b)
        for i, (f, row) in enumerate(zip(self.first, self.lower)):
            x = b[i]
            for j, ljk in enumerate(row, start=f):
                x = x - ljk * b[j]
            b[i] = x
        for i, d in enumerate(self.diagonal):
            b[i] = quotient(b[i], d)
        for i in range(len(b) - 1, -1, -1):
            x = b[i]
            for j, ljk in enumerate(self.lower[i], start=self.first[i]):
                b[j] = b[j] - ljk * x
        return b
