# SPDX-License-Identifier: Apache-2.0
"""Chapter 50 of the specification: rings, coding order and parents, which follow from the surface."""
from __future__ import annotations

from itertools import count
from math import isqrt
from typing import TYPE_CHECKING, Optional

from conventions import clamp, round_div, round_shift

if TYPE_CHECKING:
    from deformable_header import DeformableObject

GREATEST_DEPTH = 23
Q = 1 << 24
NUGGETS = (335544, 838861, 5033165)                         # by set of weights: 2, 5, 30 %
LEAST_PIVOT = 1 << 18


# ---- Rings ----------------------------------------------------------------------------------------------------------
def triangles_of_vertices(item: DeformableObject) -> list[list[int]]:
    """For each vertex its triangles, ascending."""
    of = [[] for _ in item.rest]
    for number, corners in enumerate(item.triangles):
        for vertex in corners:
            of[vertex].append(number)
    return of


def ring_list(item: DeformableObject, triangles_of: list[list[int]], triangle: int, rings: int) -> list[int]:
    """The triangles within `rings` rings around one, in the order of the list."""
    listed = [triangle]
    seen = {triangle}
    vertices = list(item.triangles[triangle])
    known = set(vertices)
    next_vertex = 0
    for _ in range(rings):
        begin, end = len(listed), len(vertices)
        while next_vertex < end:
            new = [t for t in triangles_of[vertices[next_vertex]] if t not in seen]
            listed += new
            seen.update(new)
            next_vertex += 1
        for t in listed[begin:]:
            for vertex in item.triangles[t]:
                if vertex not in known:
                    known.add(vertex)
                    vertices.append(vertex)
    return listed


def area_of_interest(item: DeformableObject, triangles_of: list[list[int]], triangle: int) -> set[int]:
    return {vertex for t in ring_list(item, triangles_of, triangle, item.rings) for vertex in item.triangles[t]}


# ---- Coding order ---------------------------------------------------------------------------------------------------
def first_graph(item: DeformableObject) -> list[set]:
    """G_0: the neighbours of every vertex."""
    neighbours: list[set] = [set() for _ in item.rest]
    last_at: dict[tuple, int] = {}
    for v, position in enumerate(item.rest):
        if position in last_at:
            neighbours[v].add(last_at[position])
            neighbours[last_at[position]].add(v)
        last_at[position] = v
    for a, b, c in item.triangles:
        neighbours[a].update((b, c))
        neighbours[b].update((a, c))
        neighbours[c].update((a, b))
    return neighbours


class Hierarchy:
    """`order`, and for every vertex `depth`; `parents` and `weights` for every set and vertex: of the declared sets, or of others."""

    def __init__(self, item: DeformableObject, sets: Optional[int] = None):
        self.rest = item.rest
        extent = max(max(axis) - min(axis) for axis in zip(*item.rest))
        self.shift = max(0, extent.bit_length() - 18)
        size = len(item.rest)
        self.depth: dict[int, int] = {}
        nuggets = [nugget for i, nugget in enumerate(NUGGETS) if (item.weight_sets if sets is None else sets) >> i & 1]
        self.parents: list[list[list[int]]] = [[[] for _ in range(size)] for _ in nuggets]
        self.weights: list[list[list[int]]] = [[[] for _ in range(size)] for _ in nuggets]
        vertices = list(range(size))
        neighbours = first_graph(item)
        coded_at = []
        for depth in count():
            kept = self.keep(vertices, neighbours)
            roots = len(kept) == len(vertices) or depth == GREATEST_DEPTH
            coded = vertices if roots else [v for v in vertices if v not in kept]
            for v in coded:
                self.depth[v] = depth
                if not roots:
                    candidates = self.candidates(v, neighbours, kept)[:8]
                    for parents, weights, nugget in zip(self.parents, self.weights, nuggets):
                        weights[v] = self.weigh(v, candidates, nugget)
                        parents[v] = candidates[:len(weights[v])]
            coded_at.append(coded)
            if roots:
                break
            neighbours = self.join(vertices, neighbours, kept)
            vertices = [v for v in vertices if v in kept]
        self.order = [v for coded in reversed(coded_at) for v in coded]

    def distance(self, a: int, b: int) -> int:
        return max(1, sum(((p - q) >> self.shift) ** 2 for p, q in zip(self.rest[a], self.rest[b])))

    @staticmethod
    def keep(vertices: list[int], neighbours: list[set]) -> set[int]:
        kept = set()
        for v in vertices:
            if not neighbours[v] & kept:
                kept.add(v)
        return kept

    def join(self, vertices: list[int], neighbours: list[set], kept: set[int]) -> list[set]:
        """The neighbours in the next graph."""
        join = {}
        for v in vertices:
            join[v] = v if v in kept else min(neighbours[v] & kept, key=lambda k: (self.distance(v, k), k))
        after: list[set] = [set() for _ in neighbours]
        for v in vertices:
            for n in neighbours[v]:
                if join[v] != join[n]:
                    after[join[v]].add(join[n])
        return after

    # ---- Parents and their weights: simple kriging with the covariance of Wendland C2 ----
    def candidates(self, v: int, neighbours: list[set], kept: set[int]) -> list[int]:
        """The nearest first. v itself is none: it is not kept."""
        near = sorted(neighbours[v])
        visits = near + [w for n in near for w in sorted(neighbours[n])]
        return sorted({w for w in visits[:64] if w in kept or w < v}, key=lambda w: (self.distance(v, w), w))

    def weigh(self, v: int, p: list[int], nugget: int) -> list[int]:
        """The weights of the parents p of v; one weight if the first is the only parent."""
        if self.rest[p[0]] == self.rest[v]:
            return [1 << 15]
        n = len(p)
        support = 94 * sum(self.distance(v, parent) for parent in p) // n
        m = [[covariance(self.distance(p[i], p[j]), support) for j in range(i)] + [Q + nugget] for i in range(n)]
        a = [covariance(self.distance(v, parent), support) for parent in p]
        b = [Q] * n
        for j in range(n):
            if m[j][j] < LEAST_PIVOT:
                return [1 << 15]
            for i in range(j + 1, n):
                f = to(28, round_div(m[i][j] << 24, m[j][j]))
                for k in range(j + 1, i + 1):
                    m[i][k] = to(25, m[i][k] - round_shift(f * m[k][j], 24))
                a[i] = to(34, a[i] - round_shift(f * a[j], 24))
                b[i] = to(34, b[i] - round_shift(f * b[j], 24))
        for i in reversed(range(n)):
            for k in range(i + 1, n):
                a[i] = to(34, a[i] - round_shift(m[k][i] * a[k], 24))
                b[i] = to(34, b[i] - round_shift(m[k][i] * b[k], 24))
            a[i] = to(34, round_div(a[i] << 24, m[i][i]))
            b[i] = to(34, round_div(b[i] << 24, m[i][i]))
        rest = to(26, Q - sum(a))
        fraction = [to(34, round_div(x << 24, max(LEAST_PIVOT, sum(b)))) for x in b]
        return [clamp(round_shift(x + round_shift(s * rest, 24), 9), -65536, 65536) for x, s in zip(a, fraction)]


def to(e: int, v: int) -> int:
    return clamp(v, -1 << e, 1 << e)


def covariance(d: int, support: int) -> int:
    if d >= support:
        return 0
    r = isqrt(((d << 24) // support) << 24)
    t = ((Q - r) * (Q - r)) >> 24
    return (((t * t) >> 24) * (4 * r + Q)) >> 24
