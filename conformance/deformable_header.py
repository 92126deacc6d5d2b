# SPDX-License-Identifier: Apache-2.0
"""Chapter 50 of the specification, section 1: what the scene declaration says about deformable objects."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple, Optional

import thesis_mesh
from conventions import STR_5, STR_5_VARINT, Cursor, require, text, zigzag
from deformable_graph import first_graph

if TYPE_CHECKING:
    from elastic_header import ElasticBody

THESIS, MAIN = 0, 1
NO_BASIS, DECLARED, COMPUTED, CLUSTERS = 0, 1, 2, 3
MOST_CLUSTERS, MOST_BLEND = 64, 32
MOST_VERTICES, MOST_TRIANGLES = 1 << 20, 1 << 21
LARGEST_ENTRY = 2047


class Mode(NamedTuple):
    step: int                                               # quantiser step, x 2^-12 of the visual bound
    entries: list[int]                                      # 3 for each vertex


@dataclass
class DeformableObject:
    profile: int
    name: str
    rings: int
    quant_bits: Optional[int] = None                        # thesis: chapter 85
    models_kept: Optional[int] = None                       # thesis: the same
    frame_period: Optional[int] = None                      # main
    layered: Optional[int] = None                           # main
    fade: int = 0                                           # main: fraction per frame, x 2^-16
    weight_sets: int = 1                                    # main: one bit each
    rest: list[tuple] = field(default_factory=list)
    triangles: list[tuple] = field(default_factory=list)
    mode_count: int = 0                                     # main
    modes: list[Mode] = field(default_factory=list)         # main: declared, or computed when the whole declaration is checked
    fixed: Optional[list[int]] = None                       # main: of a basis to compute
    clusters: Optional[list[int]] = None                    # main: of a basis of clusters, by vertex
    blend: int = 0                                          # with clusters
    stiffness: Optional[bytes] = None                       # levels, if declared
    body: Optional[ElasticBody] = None                      # main


def read_deformable_objects(body: Cursor, most: int, vertices_left: int, triangles_left: int, thesis: bool) -> list[DeformableObject]:
    """`thesis`: this decoder has component thesis."""
    count = body.varint(STR_5, STR_5_VARINT)
    require(count >= 1, "malformed", "R-DEF-1")
    require(count <= 255, "invalid", "R-DEF-1")
    require(count <= most, "limit_exceeded", "R-STR-14")
    items = []
    for _ in range(count):
        item = read_deformable_object(body, vertices_left, triangles_left, thesis)
        vertices_left -= len(item.rest)
        triangles_left -= len(item.triangles)
        items.append(item)
    return items


def read_deformable_object(body: Cursor, vertices_left: int, triangles_left: int, thesis: bool) -> DeformableObject:
    profile = body.number(1, STR_5)
    require(profile == MAIN or profile == THESIS and thesis, "unsupported", "R-DEF-2")
    name_bytes = body.take(body.number(1, STR_5), STR_5)
    item = DeformableObject(profile, "", body.number(1, STR_5))
    if profile == THESIS:
        item.quant_bits, item.models_kept = thesis_mesh.read_parameters(body)
    else:
        item.frame_period, item.layered = body.number(4, STR_5), body.number(1, STR_5)
        require(item.layered <= 1, "malformed", "R-DEF-3")
        item.fade, item.weight_sets = body.number(2, STR_5), body.number(1, STR_5)
    vertex_count = body.varint(STR_5, STR_5_VARINT)
    triangle_count = body.varint(STR_5, STR_5_VARINT)
    check_numbers(item)
    require(1 <= vertex_count <= MOST_VERTICES and triangle_count <= MOST_TRIANGLES, "invalid", "R-DEF-4")
    require(vertex_count <= vertices_left and triangle_count <= triangles_left, "limit_exceeded", "R-STR-14")
    require(3 * (vertex_count + triangle_count) <= body.left(), *STR_5)
    item.rest = read_rest(body, vertex_count)
    item.triangles = read_triangles(body, vertex_count, triangle_count)
    if profile == MAIN:
        read_basis(body, item)
    item.name = text(name_bytes)
    return item


def check_numbers(item: DeformableObject) -> None:
    require(item.rings <= 32, "invalid", "R-DEF-3")
    if item.profile == THESIS:
        thesis_mesh.check_parameters(item)
    else:
        require(1 <= item.frame_period <= 1 << 28 and 1 <= item.weight_sets <= 7, "invalid", "R-DEF-3")


def read_zigzag(body: Cursor) -> int:
    return zigzag(body.varint(STR_5, STR_5_VARINT))


def read_rest(body: Cursor, count: int) -> list[tuple]:
    rest = []
    point = [0, 0, 0]
    for _ in range(count):
        for axis in range(3):
            point[axis] += read_zigzag(body)
            require(-1 << 31 <= point[axis] < 1 << 31, "invalid", "R-DEF-5")
        rest.append(tuple(point))
    return rest


def read_triangles(body: Cursor, vertex_count: int, count: int) -> list[tuple]:
    triangles = []
    first = 0
    for _ in range(count):
        first += read_zigzag(body)
        second = first + read_zigzag(body)
        third = second + read_zigzag(body)
        corners = (first, second, third)
        require(all(0 <= c < vertex_count for c in corners) and len(set(corners)) == 3, "invalid", "R-DEF-6")
        triangles.append(corners)
    return triangles


def read_basis(body: Cursor, item: DeformableObject) -> None:
    basis = body.number(1, STR_5)
    require(basis in (NO_BASIS, DECLARED, COMPUTED, CLUSTERS), "malformed", "R-DEF-7")
    if basis == NO_BASIS:
        return
    if basis == CLUSTERS:
        read_clusters(body, item)
        return
    item.mode_count = body.varint(STR_5, STR_5_VARINT)
    require(1 <= item.mode_count <= 64, "invalid", "R-DEF-7")
    if basis == DECLARED:
        item.modes = read_modes(body, item.mode_count, len(item.rest))
    else:
        item.fixed = read_fixed(body, len(item.rest), "R-DEF-7")
        require(item.mode_count <= 3 * (len(item.rest) - len(item.fixed)), "invalid", "R-DEF-7")


def read_clusters(body: Cursor, item: DeformableObject) -> None:
    count = body.varint(STR_5, STR_5_VARINT)
    item.blend = body.number(1, STR_5)
    surprise_count = body.varint(STR_5, STR_5_VARINT)
    require(1 <= count <= MOST_CLUSTERS and item.blend <= MOST_BLEND, "invalid", "R-DEF-7")
    require(2 * surprise_count <= body.left(), *STR_5)
    item.mode_count = 12 * count
    item.clusters = []
    graph = first_graph(item)
    for _ in range(surprise_count):
        gap = body.varint(STR_5, STR_5_VARINT)
        cluster = body.varint(STR_5, STR_5_VARINT)
        require(len(item.clusters) + gap < len(item.rest) and cluster < count, "invalid", "R-DEF-7")
        expect_clusters(item, graph, gap)
        require(cluster != expected_cluster(item, graph), "invalid", "R-DEF-7")
        item.clusters.append(cluster)
    expect_clusters(item, graph, len(item.rest) - len(item.clusters))


def expect_clusters(item: DeformableObject, graph: list[set], number: int) -> None:
    for _ in range(number):
        item.clusters.append(expected_cluster(item, graph))


def expected_cluster(item: DeformableObject, graph: list[set]) -> int:
    """Of the vertex after those whose cluster is known."""
    v = len(item.clusters)
    lowest = min(graph[v], default=v)
    if lowest < v:
        return item.clusters[lowest]
    return item.clusters[v - 1] if v > 0 else 0


def read_fixed(body: Cursor, vertex_count: int, rule: str) -> list[int]:
    run_count = body.varint(STR_5, STR_5_VARINT)
    require(2 * run_count <= body.left(), *STR_5)
    fixed = []
    end = 0
    for run in range(run_count):
        gap = body.varint(STR_5, STR_5_VARINT)
        more = body.varint(STR_5, STR_5_VARINT)
        require((gap > 0 or run == 0) and end + gap + more < vertex_count, "invalid", rule)
        fixed += range(end + gap, end + gap + more + 1)
        end += gap + more + 1
    return fixed


def read_modes(body: Cursor, mode_count: int, vertex_count: int) -> list[Mode]:
    require(mode_count * (3 * vertex_count + 2) <= body.left(), *STR_5)
    modes = []
    for _ in range(mode_count):
        step = body.number(2, STR_5)
        require(step >= 1, "invalid", "R-DEF-7")
        modes.append(Mode(step, [read_entry(body) for _ in range(3 * vertex_count)]))
    return modes


def read_entry(body: Cursor) -> int:
    entry = read_zigzag(body)
    require(abs(entry) <= LARGEST_ENTRY, "invalid", "R-DEF-7")
    return entry
