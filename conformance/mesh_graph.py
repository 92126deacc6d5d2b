# SPDX-License-Identifier: Apache-2.0
"""Chapter 60, section 4, of the specification: rings, coding order and parents, which follow from the mesh."""
from __future__ import annotations

from math import isqrt
from typing import NamedTuple

from conventions import clamp, round_div, round_shift
from mesh_header import Mesh

# ---- Section 4.1: rings ---------------------------------------------------------------------------------------------


def triangles_of_vertices(mesh: Mesh) -> list[list[int]]:
    """For each vertex its triangles, ascending."""
    of = [[] for _ in mesh.rest]
    for number, corners in enumerate(mesh.triangles):
        for vertex in corners:
            of[vertex].append(number)
    return of


def ring_list(mesh: Mesh, triangles_of: list[list[int]], triangle: int, rings: int) -> list[int]:
    """The triangles within `rings` rings around one, in the order of the list."""
    listed = [triangle]
    seen = {triangle}
    vertices = list(mesh.triangles[triangle])
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
            for vertex in mesh.triangles[t]:
                if vertex not in known:
                    known.add(vertex)
                    vertices.append(vertex)
    return listed


def area_of_interest(mesh: Mesh, triangles_of: list[list[int]], triangle: int) -> set[int]:
    return {vertex for t in ring_list(mesh, triangles_of, triangle, mesh.rings) for vertex in mesh.triangles[t]}


# ---- Section 4.2: coding order --------------------------------------------------------------------------------------
HIGHEST_LEVEL = 23


def first_graph(mesh: Mesh) -> list[set]:
    """G_0: the neighbours of every vertex."""
    neighbours: list[set] = [set() for _ in mesh.rest]
    last_at: dict[tuple, int] = {}
    for v, place in enumerate(mesh.rest):
        if place in last_at:
            neighbours[v].add(last_at[place])
            neighbours[last_at[place]].add(v)
        last_at[place] = v
    for a, b, c in mesh.triangles:
        neighbours[a].update((b, c))
        neighbours[b].update((a, c))
        neighbours[c].update((a, b))
    return neighbours


class Hierarchy:
    """`order`, and for every vertex `level`, `parents` and `weights`."""

    def __init__(self, mesh: Mesh):
        self.rest = mesh.rest
        extent = max(max(axis) - min(axis) for axis in zip(*mesh.rest))
        self.shift = max(0, extent.bit_length() - 18)
        size = len(mesh.rest)
        self.level = [0] * size
        self.parents: list[list[int]] = [[] for _ in range(size)]
        self.weights: list[list[int]] = [[] for _ in range(size)]
        vertices = list(range(size))
        neighbours = first_graph(mesh)
        levels = []
        for level in range(HIGHEST_LEVEL + 1):
            kept = self.keep(vertices, neighbours)
            roots = len(kept) == len(vertices) or level == HIGHEST_LEVEL
            coded = vertices if roots else [v for v in vertices if v not in kept]
            for v in coded:
                self.level[v] = level
                if not roots:
                    self.parents[v] = self.choose_parents(v, neighbours, kept)
                    self.weights[v] = self.weigh(v, self.parents[v])
                    del self.parents[v][len(self.weights[v]):]
            levels.append(coded)
            if roots:
                break
            neighbours = self.join(vertices, neighbours, kept)
            vertices = [v for v in vertices if v in kept]
        self.order = [v for coded in reversed(levels) for v in coded]

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
        joined = {}
        for v in vertices:
            joined[v] = v if v in kept else min(neighbours[v] & kept, key=lambda k: (self.distance(v, k), k))
        after: list[set] = [set() for _ in neighbours]
        for v in vertices:
            for n in neighbours[v]:
                if joined[v] != joined[n]:
                    after[joined[v]].add(joined[n])
        return after

    # ---- Section 4.3: parents ----

    def choose_parents(self, v: int, neighbours: list[set], kept: set[int]) -> list[int]:
        near = sorted(neighbours[v])
        visits = near + [w for n in near for w in sorted(neighbours[n])]
        candidates = {w for w in visits[:64] if w != v and (w in kept or w < v)}
        nearest = sorted(candidates, key=lambda p: (self.distance(v, p), p))
        return nearest[:1] if self.rest[nearest[0]] == self.rest[v] else nearest[:8]

    def weigh(self, v: int, p: list[int]) -> list[int]:
        if self.rest[p[0]] == self.rest[v]:
            return [1 << 15]
        n = len(p)
        reach = 94 * sum(self.distance(v, parent) for parent in p) // n
        m = [[like(self.distance(p[i], p[j]), reach) for j in range(i)] + [Q + 335544] for i in range(n)]
        a = [like(self.distance(v, parent), reach) for parent in p]
        b = [Q] * n
        for j in range(n):
            if m[j][j] < LEAST_PIVOT:
                return [1 << 15]                            # of p[0], the only parent
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
        share = [to(34, round_div(x << 24, max(LEAST_PIVOT, sum(b)))) for x in b]
        return [clamp(round_shift(x + round_shift(s * rest, 24), 9), -65536, 65536) for x, s in zip(a, share)]


Q = 1 << 24
LEAST_PIVOT = 1 << 18


def to(e: int, v: int) -> int:
    return clamp(v, -1 << e, 1 << e)


def like(d: int, reach: int) -> int:
    if d >= reach:
        return 0
    r = isqrt(((d << 24) // reach) << 24)
    t = ((Q - r) * (Q - r)) >> 24
    return (((t * t) >> 24) * (4 * r + Q)) >> 24
