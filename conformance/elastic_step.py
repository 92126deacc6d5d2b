# SPDX-License-Identifier: Apache-2.0
"""Chapter 55 of the specification, sections 3.4, 5.1 and 5.2: the step of an elastic body from one frame to the next.

Numbers are binary64 in the written order, so no sum() here.
"""
from __future__ import annotations

from math import sqrt

from elastic_header import BACKWARD_EULER, STABILITY_STEPS, TR_BDF2, VELOCITY_VERLET, ElasticBody
from elastic_matrix import AXES, Matrix, dot, elements_and_masses, quotient
from elastic_touch import Push

ROUNDS, GRADIENTS = 2, 4
G = 2 - sqrt(2.0)                                           # what TR-BDF2 does of its step by the trapezoidal rule
STABLE = 3.61
TURNS_OF_ELEMENT, TURNS_OF_VERTEX = 6, 4
NINE = range(9)


def cofactors(m: tuple) -> tuple:
    return (m[4] * m[8] - m[5] * m[7], m[5] * m[6] - m[3] * m[8], m[3] * m[7] - m[4] * m[6],
            m[2] * m[7] - m[1] * m[8], m[0] * m[8] - m[2] * m[6], m[1] * m[6] - m[0] * m[7],
            m[1] * m[5] - m[2] * m[4], m[2] * m[3] - m[0] * m[5], m[0] * m[4] - m[1] * m[3])


def determinant(m: tuple, c: tuple) -> float:
    return m[0] * c[0] + m[1] * c[1] + m[2] * c[2]


def turn(m: tuple, steps: int) -> tuple:
    """The orthogonal matrix nearest to a matrix."""
    for _ in range(steps):
        c = cofactors(m)
        s = quotient(0.5, determinant(m, c))
        m = tuple(0.5 * a + s * b for a, b in zip(m, c))
    return m


def rotation(m: tuple) -> tuple:
    """The rotation nearest to a matrix that may be thin or mirror."""
    det = determinant(m, cofactors(m))
    r = m
    if det < 0.125:
        for _ in range(4):
            c = cofactors(r)
            e = determinant(r, c)
            t = sqrt(sqrt(quotient(squares(c), squares(r) * (e * e))))
            own, other = 0.5 * t, quotient(0.5, t * e)
            r = tuple(own * a + other * b for a, b in zip(r, c))
    r = turn(r, TURNS_OF_ELEMENT)
    return turned_over(m, r) if det < 0 else r


def turned_over(m: tuple, r: tuple) -> tuple:
    """`r` mirrors, `m` as well: along the direction in which `m` is thinnest, turned over."""
    a_ = cofactors(tuple(r[a] * m[b] + r[3 + a] * m[3 + b] + r[6 + a] * m[6 + b] for a in AXES for b in AXES))
    for _ in range(5):
        s = quotient(1.0, a_[0] + a_[4] + a_[8])
        a_ = tuple(s * x for x in a_)
        a_ = tuple(a_[3 * a] * a_[b] + a_[3 * a + 1] * a_[3 + b] + a_[3 * a + 2] * a_[6 + b] for a in AXES for b in AXES)
    j = 0 if a_[0] >= a_[4] and a_[0] >= a_[8] else 1 if a_[4] >= a_[8] else 2
    d = (a_[j], a_[3 + j], a_[6 + j])
    s = quotient(2.0, d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
    out: list[float] = []
    for a in AXES:
        row = r[3 * a:3 * a + 3]
        along = s * (row[0] * d[0] + row[1] * d[1] + row[2] * d[2])
        out += [x - along * y for x, y in zip(row, d)]
    return tuple(out)


def squares(numbers: tuple) -> float:
    total = 0.0
    for c in numbers:
        total = total + c * c
    return total


def decay(x: float) -> float:
    """exp(-x)"""
    halved = 0
    while x > 0.1:
        x, halved = x / 2, halved + 1
    e = (1 - x / 2 + x * x / 12) / (1 + x / 2 + x * x / 12)
    for _ in range(halved):
        e = e * e
    return e


class Stepper:
    """Vectors of vertices are lists of three numbers each, those of fixed vertices 0."""

    def __init__(self, body: ElasticBody, ticks: int, tick_rate: int):
        self.body, self.ticks = body, ticks
        self.h = ticks / tick_rate
        self.elements, self.mass = elements_and_masses(body)
        self.order = body.order.order
        self.c = self.h                                     # what a stage reaches
        if body.method == TR_BDF2:
            self.c = G * self.h / 2
        self.heavy = (1 / self.c + body.mass_damping) / self.c
        self.stiff = 1 + body.stiffness_damping / self.c
        if body.method != VELOCITY_VERLET:
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
                self.rotations.append(rotation(tuple(gradient)))
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

    def step(self, u: list[float], w: list[float], k: list[float], load: list[float]) -> tuple[list[float], list[float], list[float]]:
        if self.body.method == BACKWARD_EULER:
            return self.backward_euler(u, w, k, load)
        if self.body.method == TR_BDF2:
            return self.tr_bdf2(u, w, k, load)
        return self.velocity_verlet(u, w, k, load)

    def backward_euler(self, u: list, w: list, k: list, load: list) -> tuple:
        x = [a + self.h * b for a, b in zip(u, w)]
        self.stage(x, u, w, load)
        return x, [(a - b) / self.h for a, b in zip(x, u)], k

    def tr_bdf2(self, u: list, w: list, k: list, load: list) -> tuple:
        c, h, alpha = self.c, self.h, self.body.mass_damping
        old = (1 - G) * (1 - G) / (G * (2 - G))
        new = 1 + old
        a = [p + c * q for p, q in zip(u, w)]
        b = list(self.still)
        for i, mass in self.axes(self.free):
            b[i] = (1 - c * alpha) * w[i] + quotient(c * (load[i] - k[i]), mass)
        x = [p + G * h * q for p, q in zip(u, w)]
        self.stage(x, a, b, load)
        v = [(p - q) / c for p, q in zip(x, a)]
        a = [new * p - old * q for p, q in zip(x, u)]
        b = [new * p - old * q for p, q in zip(v, w)]
        y = [p + (1 - G) * h * q for p, q in zip(x, v)]
        self.stage(y, a, b, load)
        v = [(p - q) / c for p, q in zip(y, a)]
        k = list(self.still)
        for i, mass in self.axes(self.free):
            k[i] = load[i] - mass * ((1 + c * alpha) * v[i] - b[i]) / c
        return y, v, k

    def velocity_verlet(self, u: list, w: list, k: list, load: list) -> tuple:
        body, s = self.body, self.h / self.body.sub_steps
        e = decay(body.mass_damping * s / 2)
        p = (1 - e) / body.mass_damping if body.mass_damping > 0 else s / 2

        def kicked() -> list[float]:
            out = list(self.still)
            for i, mass in self.axes(self.free):
                out[i] = e * w[i] + quotient(p, mass) * (load[i] - k[i])
            return out

        for _ in range(body.sub_steps):
            w = kicked()
            u = [a + s * b for a, b in zip(u, w)]
            k = self.forces([a + body.stiffness_damping * b for a, b in zip(u, w)], 1.0)
            w = kicked()
        return u, w, k

    def stage(self, x: list[float], a: list[float], b: list[float], load: list[float]) -> None:
        for _ in range(ROUNDS):
            self.round(x, a, b, load)

    def round(self, x: list[float], u: list[float], w: list[float], load: list[float]) -> None:
        """Brings `x` nearer to the end of a stage that begins with `u` and `w`."""
        h, body, free = self.c, self.body, self.axes(self.free)
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
            beta = 0.0 if before is None else now / before
            p = [a + beta * b for a, b in zip(z, p)]
            before = now
            k = self.forces(p, 0.0)
            q = list(self.still)
            for i, mass in free:
                q[i] = self.heavy * mass * p[i] + self.stiff * k[i]
            s = quotient(now, self.product(p, q))
            for i, _ in free:
                x[i] = x[i] + s * p[i]
                r[i] = r[i] - s * q[i]


def is_stable(body: ElasticBody, ticks: int, tick_rate: int) -> bool:
    """R-ELA-5"""
    if body.method != VELOCITY_VERLET:
        return True
    stepper = Stepper(body, ticks, tick_rate)
    s = stepper.h / body.sub_steps
    return s * (s + 2 * body.stiffness_damping) * largest_square(stepper) <= STABLE


def largest_square(stepper: Stepper) -> float:
    """Of the frequencies at rest, by the power method."""
    seed, square = 1, 0.0
    free = stepper.axes(stepper.free)
    stepper.rotations = [(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)] * len(stepper.elements)
    x = list(stepper.still)
    for i, _ in free:
        seed = (seed * 1664525 + 1013904223) % (1 << 32)
        x[i] = seed * 2.0 ** -32 - 0.5
    for _ in range(STABILITY_STEPS):
        k, y = stepper.forces(x, 0.0), list(stepper.still)
        for i, mass in free:
            y[i] = quotient(k[i], mass)
        before, after = 0.0, 0.0
        for v in stepper.free:
            mass, at = stepper.mass[v], slice(3 * v, 3 * v + 3)
            before = before + mass * dot(x[at], x[at])
            after = after + mass * dot(y[at], y[at])
        square = sqrt(quotient(after, before))
        x = list(stepper.still)
        for i, _ in free:
            x[i] = quotient(y[i], sqrt(after))
    return square


def scaled(n: list[float]) -> tuple:
    f = sqrt(quotient(3.0, squares(n)))
    return tuple(f * c for c in n)


def stresses(r: tuple, g: list[float], mu2: float, lambda_: float, one: float) -> list[float]:
    """Q, from the rotation and the gradient of an element."""
    e = [r[a] * g[b] + r[3 + a] * g[3 + b] + r[6 + a] * g[6 + b] for a in AXES for b in AXES]
    x, y, z = e[0] - one, e[4] - one, e[8] - one
    both = lambda_ * (x + y + z)
    xy, xz, yz = 0.5 * mu2 * (e[1] + e[3]), 0.5 * mu2 * (e[2] + e[6]), 0.5 * mu2 * (e[5] + e[7])
    t = (mu2 * x + both, xy, xz, xy, mu2 * y + both, yz, xz, yz, mu2 * z + both)
    return [r[3 * a] * t[b] + r[3 * a + 1] * t[3 + b] + r[3 * a + 2] * t[6 + b] for a in AXES for b in AXES]
