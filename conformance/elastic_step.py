# SPDX-License-Identifier: Apache-2.0
"""Chapter 55 of the specification, sections 5.1 and 5.2: the step of an elastic body from one frame to the next.

Numbers are binary64 in the written order, so no sum() here.
"""
from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from elastic_matrix import AXES, Matrix, elements_and_masses, quotient
from elastic_touch import Push

if TYPE_CHECKING:
    from elastic_header import ElasticBody

ROUNDS, GRADIENTS = 2, 4
TURNS_OF_ELEMENT, TURNS_OF_VERTEX = 6, 4
NINE = range(9)


def turn(m: tuple, steps: int) -> tuple:
    """The rotation nearest to a matrix."""
    for _ in range(steps):
        c = (m[4] * m[8] - m[5] * m[7], m[5] * m[6] - m[3] * m[8], m[3] * m[7] - m[4] * m[6],
             m[2] * m[7] - m[1] * m[8], m[0] * m[8] - m[2] * m[6], m[1] * m[6] - m[0] * m[7],
             m[1] * m[5] - m[2] * m[4], m[2] * m[3] - m[0] * m[5], m[0] * m[4] - m[1] * m[3])
        s = quotient(0.5, m[0] * c[0] + m[1] * c[1] + m[2] * c[2])
        m = tuple(0.5 * a + s * b for a, b in zip(m, c))
    return m


class Stepper:
    """Vectors of vertices are lists of three numbers each, those of fixed vertices 0."""

    def __init__(self, body: ElasticBody, ticks: int, tick_rate: int):
        self.body, self.ticks = body, ticks
        self.h = ticks / tick_rate
        self.elements, self.mass = elements_and_masses(body)
        self.order = body.order.order
        self.heavy = (1 / self.h + body.mass_damping) / self.h
        self.stiff = 1 + body.stiffness_damping / self.h
        self.matrix = Matrix(body.order, self.elements, self.mass, self.heavy, self.stiff)
        self.free = sorted(self.order)
        self.still = [0.0] * (3 * len(body.rest))
        self.rotations: list[tuple] = []                    # R of each element

    def axes(self, vertices: list[int]) -> list[tuple]:
        """Index into vectors, and mass, of each component."""
        return [(3 * v + a, self.mass[v]) for v in vertices for a in AXES]

    def load(self, pushes: list[Push]) -> list[float]:
        load = [m * g for m in self.mass for g in self.body.gravity]
        for corners, weights, force in pushes:
            for v, weight in zip(corners, weights):
                for a in AXES:
                    load[3 * v + a] = load[3 * v + a] + weight * force[a] / self.ticks
        return load

    def forces(self, p: list[float], one: float) -> list[float]:
        k = list(self.still)
        if one:
            self.rotations = []
        for number, (corners, g, mu2, lambda_) in enumerate(self.elements):
            gradient = [one, 0.0, 0.0, 0.0, one, 0.0, 0.0, 0.0, one]
            for r in (1, 2, 3):
                for a in AXES:
                    d = p[3 * corners[r] + a] - p[3 * corners[0] + a]
                    for b in AXES:
                        gradient[3 * a + b] = gradient[3 * a + b] + d * g[r][b]
            if one:
                self.rotations.append(turn(tuple(gradient), TURNS_OF_ELEMENT))
            q = stresses(self.rotations[number], gradient, mu2, lambda_, one)
            for r in (1, 2, 3):
                x, y, z = g[r]
                for a in AXES:
                    s = q[3 * a] * x + q[3 * a + 1] * y + q[3 * a + 2] * z
                    i, j = 3 * corners[r] + a, 3 * corners[0] + a
                    k[i] = k[i] + s
                    k[j] = k[j] - s
        return k

    def turns(self) -> dict[int, tuple]:
        """V of each free vertex."""
        n = {v: [0.0] * 9 for v in self.free}
        for (corners, _, mu2, _), rotation in zip(self.elements, self.rotations):
            for v in corners:
                if v in n:
                    for i in NINE:
                        n[v][i] = n[v][i] + rotation[i] * mu2
        return {v: turn(scaled(m), TURNS_OF_VERTEX) for v, m in n.items()}

    def conditioned(self, v: dict[int, tuple], r: list[float]) -> list[float]:
        """turned(solve(turned back(r)))"""
        b: list[float] = []
        for vertex in self.order:
            m, (x, y, z) = v[vertex], r[3 * vertex:3 * vertex + 3]
            b += [m[a] * x + m[3 + a] * y + m[6 + a] * z for a in AXES]
        b = self.matrix.solve(b)
        out = list(self.still)
        for i, vertex in enumerate(self.order):
            m, (x, y, z) = v[vertex], b[3 * i:3 * i + 3]
            out[3 * vertex:3 * vertex + 3] = [m[3 * a] * x + m[3 * a + 1] * y + m[3 * a + 2] * z for a in AXES]
        return out

    def product(self, p: list[float], q: list[float]) -> float:
        """Sum over the free vertices in the order of `order`."""
        total = 0.0
        for v in self.order:
            for i in (3 * v, 3 * v + 1, 3 * v + 2):
                total = total + p[i] * q[i]
        return total

    def step(self, u: list[float], w: list[float], load: list[float]) -> tuple[list[float], list[float]]:
        h = self.h
        x = [a + h * b for a, b in zip(u, w)]
        for _ in range(ROUNDS):
            self.round(x, u, w, load)
        return x, [(a - b) / h for a, b in zip(x, u)]

    def round(self, x: list[float], u: list[float], w: list[float], load: list[float]) -> None:
        """Brings `x` nearer."""
        h, body, free = self.h, self.body, self.axes(self.free)
        k = self.forces([a + body.stiffness_damping * ((a - b) / h) for a, b in zip(x, u)], 1.0)
        v = self.turns()
        r, p = list(self.still), list(self.still)
        for i, mass in free:
            r[i] = -(mass * ((1 / h + body.mass_damping) * ((x[i] - u[i]) / h) - w[i] / h) + k[i] - load[i])
        before = None
        for _ in range(GRADIENTS):
            z = self.conditioned(v, r)
            now = self.product(r, z)
            if not now > 0:
                return
            share = 0.0 if before is None else now / before
            p = [a + share * b for a, b in zip(z, p)]
            before = now
            k = self.forces(p, 0.0)
            q = list(self.still)
            for i, mass in free:
                q[i] = self.heavy * mass * p[i] + self.stiff * k[i]
            s = quotient(now, self.product(p, q))
            for i, _ in free:
                x[i] = x[i] + s * p[i]
                r[i] = r[i] - s * q[i]


def scaled(n: list[float]) -> tuple:
    total = 0.0
    for c in n:
        total = total + c * c
    f = sqrt(quotient(3.0, total))
    return tuple(f * c for c in n)


def stresses(r: tuple, g: list[float], mu2: float, lambda_: float, one: float) -> list[float]:
    """Q, from the rotation and the gradient of an element."""
    e = [r[a] * g[b] + r[3 + a] * g[3 + b] + r[6 + a] * g[6 + b] for a in AXES for b in AXES]
    x, y, z = e[0] - one, e[4] - one, e[8] - one
    both = lambda_ * (x + y + z)
    xy, xz, yz = 0.5 * mu2 * (e[1] + e[3]), 0.5 * mu2 * (e[2] + e[6]), 0.5 * mu2 * (e[5] + e[7])
    t = (mu2 * x + both, xy, xz, xy, mu2 * y + both, yz, xz, yz, mu2 * z + both)
    return [r[3 * a] * t[b] + r[3 * a + 1] * t[3 + b] + r[3 * a + 2] * t[6 + b] for a in AXES for b in AXES]
