# SPDX-License-Identifier: Apache-2.0
"""Chapter 60, section 2, of the specification: what the stream header says about meshes."""
from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import NamedTuple

from conventions import STR_5, STR_5_VARINT, Cursor, require, text

THESIS, MAIN = 0, 1
MOST_VERTICES, MOST_TRIANGLES = 1 << 20, 1 << 21
LARGEST_ENTRY = 2047


class Mode(NamedTuple):
    step: int                                               # quantiser step, x 2^-12 of the visual bound
    entries: list[int]                                      # 3 for each vertex


@dataclass
class Mesh:
    profile: int
    name: str
    rings: int
    quant_bits: int = 0                                     # thesis
    models_kept: int = 0                                    # thesis
    frame_period: int = 0                                   # main
    split: int = 0                                          # main
    rest: list[tuple] = field(default_factory=list)
    triangles: list[tuple] = field(default_factory=list)
    modes: list[Mode] = field(default_factory=list)         # main


def read_meshes(body: Cursor, most_meshes: int, vertices_left: int, triangles_left: int) -> list[Mesh]:
    mesh_count = body.varint(STR_5, STR_5_VARINT)
    require(mesh_count >= 1, "malformed", "R-MES-1")
    require(mesh_count <= 255, "invalid", "R-MES-1")
    require(mesh_count <= most_meshes, "limit_exceeded", "R-STR-14")
    meshes = []
    for _ in range(mesh_count):
        mesh = read_mesh(body, vertices_left, triangles_left)
        vertices_left -= len(mesh.rest)
        triangles_left -= len(mesh.triangles)
        meshes.append(mesh)
    return meshes


def read_mesh(body: Cursor, vertices_left: int, triangles_left: int) -> Mesh:
    profile = body.take(1, STR_5)[0]
    require(profile in (THESIS, MAIN), "unsupported", "R-MES-2")
    name_bytes = body.take(body.take(1, STR_5)[0], STR_5)
    rings = body.take(1, STR_5)[0]
    quant_bits = models_kept = frame_period = split = 0
    if profile == THESIS:
        quant_bits, models_kept = body.take(2, STR_5)
        require(models_kept <= 1, "malformed", "R-MES-3")
    else:
        frame_period = struct.unpack("<I", body.take(4, STR_5))[0]
        split = body.take(1, STR_5)[0]
        require(split <= 1, "malformed", "R-MES-3")
    vertex_count = body.varint(STR_5, STR_5_VARINT)
    triangle_count = body.varint(STR_5, STR_5_VARINT)
    mesh = Mesh(profile, "", rings, quant_bits, models_kept, frame_period, split)
    check_numbers(mesh)
    require(1 <= vertex_count <= MOST_VERTICES and triangle_count <= MOST_TRIANGLES, "invalid", "R-MES-4")
    require(vertex_count <= vertices_left and triangle_count <= triangles_left, "limit_exceeded", "R-STR-14")
    require(3 * (vertex_count + triangle_count) <= body.left(), *STR_5)
    mesh.rest = read_rest(body, vertex_count)
    mesh.triangles = read_triangles(body, vertex_count, triangle_count)
    if profile == MAIN:
        mesh.modes = read_modes(body, vertex_count)
    mesh.name = text(name_bytes)
    return mesh


def check_numbers(mesh: Mesh) -> None:
    require(mesh.rings <= 32, "invalid", "R-MES-3")
    if mesh.profile == THESIS:
        require(1 <= mesh.quant_bits <= 12, "invalid", "R-MES-3")
    else:
        require(1 <= mesh.frame_period <= 1 << 28, "invalid", "R-MES-3")


def zigzag(z: int) -> int:
    return z // 2 if z % 2 == 0 else -((z + 1) // 2)


def read_zigzag(body: Cursor) -> int:
    return zigzag(body.varint(STR_5, STR_5_VARINT))


def read_rest(body: Cursor, count: int) -> list[tuple]:
    rest = []
    point = [0, 0, 0]
    for _ in range(count):
        for axis in range(3):
            point[axis] += read_zigzag(body)
            require(-1 << 31 <= point[axis] < 1 << 31, "invalid", "R-MES-5")
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
        require(all(0 <= c < vertex_count for c in corners) and len(set(corners)) == 3, "invalid", "R-MES-6")
        triangles.append(corners)
    return triangles


def read_modes(body: Cursor, vertex_count: int) -> list[Mode]:
    mode_count = body.varint(STR_5, STR_5_VARINT)
    require(mode_count <= 64, "invalid", "R-MES-7")
    require(mode_count * (3 * vertex_count + 2) <= body.left(), *STR_5)
    modes = []
    for _ in range(mode_count):
        step = struct.unpack("<H", body.take(2, STR_5))[0]
        require(step >= 1, "invalid", "R-MES-7")
        modes.append(Mode(step, [read_entry(body) for _ in range(3 * vertex_count)]))
    return modes


def read_entry(body: Cursor) -> int:
    entry = read_zigzag(body)
    require(abs(entry) <= LARGEST_ENTRY, "invalid", "R-MES-7")
    return entry
