# SPDX-License-Identifier: Apache-2.0
"""Chapter 55 of the specification, section 1: what the scene declaration says about elastic bodies."""
from __future__ import annotations

import functools
import struct
from dataclasses import dataclass, field
from typing import NamedTuple

from conventions import STR_5, STR_5_VARINT, Cursor, require
from deformable_header import MAIN, DeformableObject, read_fixed, read_rest, read_zigzag
from elastic_matrix import Order, edges, order_of, six_volumes, work

MOST = 1e15
MOST_POISSON = 0.4999
BACKWARD_EULER, TR_BDF2, VELOCITY_VERLET = 1, 2, 3          # method
STABILITY_STEPS = 24                                        # of the power method
LONGEST_FRAME = 1 << 18                                     # 1/256 ticks
MOST_VERTICES, MOST_TETRAHEDRA = 1 << 20, 1 << 21


class Material(NamedTuple):
    young: float                                            # N/m^2
    poisson: float
    density: float                                          # kg/m^3


@dataclass
class ElasticBody:
    mass_damping: float                                     # 1/s
    stiffness_damping: float                                # s
    gravity: tuple                                          # m/s^2
    coupling: float                                         # N/m
    friction: float
    materials: list[Material]
    rest: list[tuple] = field(default_factory=list)         # X, m: vertices of the object, then inner ones
    tetrahedra: list[tuple] = field(default_factory=list)
    material_of: list[int] = field(default_factory=list)    # of each tetrahedron
    fixed: set = field(default_factory=set)
    method: int = BACKWARD_EULER
    sub_steps: int = 1                                      # of velocity Verlet

    @functools.cached_property
    def order(self) -> Order:
        return order_of(self)

    @functools.cached_property
    def work(self) -> int:
        if self.method == VELOCITY_VERLET:
            return 128 * (self.sub_steps + STABILITY_STEPS) * len(self.tetrahedra)
        return work(self.order)


def read_elastic_bodies(body: Cursor, deformables: list[DeformableObject], position_exp: int) -> None:
    for item in deformables:
        method = body.number(1, STR_5)
        require(method <= VELOCITY_VERLET, "malformed", "R-ELA-1")
        if method:
            require(item.profile == MAIN and item.layered == 0, "invalid", "R-ELA-1")
            require(item.frame_period % 256 == 0 and item.frame_period <= LONGEST_FRAME, "invalid", "R-ELA-1")
            item.body = read_elastic_body(body, method, item, position_exp)
    require(any(item.body for item in deformables), "invalid", "R-ELA-1")


def read_elastic_body(body: Cursor, method: int, item: DeformableObject, position_exp: int) -> ElasticBody:
    sub_steps = body.number(1, STR_5) if method == VELOCITY_VERLET else 1
    require(sub_steps >= 1, "invalid", "R-ELA-5")
    elastic = read_constants(body)
    elastic.method, elastic.sub_steps = method, sub_steps
    inner_count = body.varint(STR_5, STR_5_VARINT)
    tet_count = body.varint(STR_5, STR_5_VARINT)
    count = len(item.rest) + inner_count
    require(count <= MOST_VERTICES and 1 <= tet_count <= MOST_TETRAHEDRA, "invalid", "R-ELA-3")
    require(3 * inner_count + 4 * tet_count <= body.left(), *STR_5)
    points = item.rest + read_rest(body, inner_count)
    step = 2.0 ** -position_exp
    elastic.rest = [(x * step, y * step, z * step) for x, y, z in points]
    elastic.tetrahedra = read_tetrahedra(body, count, tet_count)
    elastic.material_of = read_materials(body, len(elastic.materials), tet_count)
    elastic.fixed = set(read_fixed(body, count, "R-ELA-3"))
    check_shape(elastic)
    return elastic


def read_constants(body: Cursor) -> ElasticBody:
    mass_damping, stiffness_damping, *gravity, coupling, friction = struct.unpack("<7d", body.take(56, STR_5))
    material_count = body.number(1, STR_5)
    materials = [Material(*struct.unpack("<3d", body.take(24, STR_5))) for _ in range(material_count)]
    sound = all(0 <= c <= MOST for c in (mass_damping, stiffness_damping, friction)) and all(-MOST <= c <= MOST for c in gravity)
    require(sound and 0 < coupling <= MOST and material_count >= 1, "invalid", "R-ELA-2")
    for m in materials:
        require(0 < m.young <= MOST and 0 < m.density <= MOST and -1 < m.poisson <= MOST_POISSON, "invalid", "R-ELA-2")
    return ElasticBody(mass_damping, stiffness_damping, tuple(gravity), coupling, friction, materials)


def read_tetrahedra(body: Cursor, vertex_count: int, count: int) -> list[tuple]:
    tetrahedra = []
    first = 0
    for _ in range(count):
        corners = [first + read_zigzag(body)]
        for _ in range(3):
            corners.append(corners[-1] + read_zigzag(body))
        require(all(0 <= c < vertex_count for c in corners) and len(set(corners)) == 4, "invalid", "R-ELA-3")
        tetrahedra.append(tuple(corners))
        first = corners[0]
    return tetrahedra


def read_materials(body: Cursor, material_count: int, tet_count: int) -> list[int]:
    """By tetrahedron."""
    if material_count == 1:
        return [0] * tet_count
    of: list[int] = []
    while len(of) < tet_count:
        length = body.varint(STR_5, STR_5_VARINT)
        material = body.number(1, STR_5)
        require(1 <= length <= tet_count - len(of) and material < material_count, "invalid", "R-ELA-3")
        of += [material] * length
    return of


def check_shape(elastic: ElasticBody) -> None:
    require(len(elastic.fixed) < len(elastic.rest), "invalid", "R-ELA-4")
    require(all(six_volumes(*edges(elastic.rest, corners)) > 0 for corners in elastic.tetrahedra), "invalid", "R-ELA-4")
    held = elastic.fixed.union(*elastic.tetrahedra)
    require(len(held) == len(elastic.rest), "invalid", "R-ELA-4")
