# SPDX-License-Identifier: Apache-2.0
"""Chapter 50 of the specification, section 11: the basis of a mesh whose vertices are in clusters. Floats are binary64."""
from __future__ import annotations

from math import floor, sqrt

from deformable_graph import first_graph
from deformable_header import DeformableObject, Mode

MOST_WEIGHTS = 4
WHOLE = 1 << 16
FLAT = 2.0 ** -30
AXES = range(3)


def work(item: DeformableObject) -> int:
    """As 50, section 1.5 counts it."""
    return 0 if item.clusters is None else len(item.rest) * (item.blend + 4) // 4


def weights_of(item: DeformableObject) -> list[dict[int, int]]:
    """By vertex: the weights of clusters, x 2^-16."""
    graph = first_graph(item)
    weights = [{c: WHOLE} for c in item.clusters]
    for _ in range(item.blend):
        weights = [blended(weights[v], [weights[w] for w in graph[v]]) for v in range(len(weights))]
    return weights


def blended(own: dict[int, int], others: list[dict[int, int]]) -> dict[int, int]:
    if not others:
        return own
    sums = {c: len(others) * weight for c, weight in own.items()}
    for other in others:
        for c, weight in other.items():
            sums[c] = sums.get(c, 0) + weight
    kept = sorted(sums, key=lambda c: (-sums[c], c))[:MOST_WEIGHTS]
    total = sum(sums[c] for c in kept)
    out = {c: (sums[c] << 16) // total for c in kept}
    out[kept[0]] += WHOLE - sum(out.values())
    return {c: weight for c, weight in out.items() if weight > 0}


def product(w: list[float], a: list[float], b: list[float]) -> float:
    total = 0.0
    for of, x, y in zip(w, a, b):
        total += of * x * y
    return total


def functions(item: DeformableObject, members: list[int], w: list[float]) -> list[list[float]]:
    f = [[1.0] * len(members)]
    for axis in AXES:
        x = [float(item.rest[v][axis] - item.rest[members[0]][axis]) for v in members]
        before = product(w, x, x)
        for g in f:
            square = product(w, g, g)
            if square > 0:
                p = product(w, g, x) / square
                x = [a - p * b for a, b in zip(x, g)]
        f.append(x if product(w, x, x) > FLAT * before else [0.0] * len(x))
    return f


def cluster_modes(item: DeformableObject) -> list[Mode]:
    weights = weights_of(item)
    modes = []
    for cluster in range(item.mode_count // 12):
        members = [v for v, of in enumerate(weights) if cluster in of]
        w = [float(weights[v][cluster]) for v in members]
        for f in functions(item, members, w):
            values = [of * x for of, x in zip(w, f)]
            largest = max((abs(x) for x in values), default=0.0) or 1.0
            square = 0.0
            for x in values:
                square += (x / largest) * (x / largest)
            step = floor(3 / sqrt(max(1.0, square)) * 4096 * 2048 / 2047 + 0.5)
            for axis in AXES:
                entries = [0, 0, 0] * len(item.rest)
                for v, x in zip(members, values):
                    entries[3 * v + axis] = floor(x / largest * 2047 + 0.5)
                modes.append(Mode(step, entries))
    return modes
