# SPDX-License-Identifier: Apache-2.0
"""Chapter 60, sections 5 to 7, of the specification: packets of profile main."""
from __future__ import annotations

import struct
from typing import NamedTuple, Optional

from conventions import clamp, require, round_div, round_shift
from mesh_graph import Hierarchy, area_of_interest, ring_list, triangles_of_vertices
from mesh_header import Mesh
from mesh_motion import Motion, ahead, combine, learn, lim
from packets import Receiver
from range_decoder import RangeDecoder
from start_models import Models

NONE = (1 << 32) - 1
STILL = (0, 0, 0)
WHOLE, HAPTIC, VISUAL = "whole", "haptic", "visual"          # what of the shape a packet codes
FINEST_HAPTIC = (32768, 36781, 41285, 46341, 52016, 58386)  # M


class MainState(NamedTuple):
    tick: int
    u: list[int]                                            # 3 for each vertex
    motion: list[Motion]
    triangle: int = NONE
    haptic: int = 0
    visual: int = 0
    density: int = 0
    touched: int = 0
    motion_tick: int = 0
    felt: Optional[dict[int, tuple]] = None                 # with split; vertices that are not there have 0

    def hashed(self) -> bytes:
        """Section 3: what the state hash is taken of."""
        data = struct.pack(f"<Q{len(self.u)}i4I", self.tick, *self.u, self.visual, self.triangle, self.haptic,
                           self.density + 4 * self.touched)
        for c in self.motion:
            data += struct.pack("<2i5Q", c.last, c.before, *(s % (1 << 64) for s in c[2:]))
        if self.felt is not None:
            data += struct.pack("<Q", self.motion_tick)
            for v in range(len(self.u) // 3):
                data += struct.pack("<3i", *self.felt.get(v, STILL))
        return data


class Known(NamedTuple):
    """What a half need not code."""
    half: str
    area: set[int]                                          # the area of interest
    felt: dict[int, tuple]                                  # of the haptic half that it completes

    def codes(self, v: int) -> bool:
        return self.half != (VISUAL if v in self.area else HAPTIC)


class Place(NamedTuple):
    """The elements up to `late`."""
    key: int
    half: str
    completes: int
    base: MainState
    tick: int


def klass(number: int) -> int:
    """Section 5: the class of a number."""
    return min(2, abs(number))


def raw_number(decoder: RangeDecoder, bits: int) -> int:
    """Upper bits first in groups of at most 16."""
    value = 0
    while bits > 0:
        n = min(bits, 16)
        bits -= n
        value = value << n | decoder.raw(n)
    return value


def step(bound: int) -> int:
    return max(1, (bound * 37837) >> 15)


def haptic_bound(haptic: int) -> int:
    return 0 if haptic == 0 else (FINEST_HAPTIC[(haptic - 1) % 6] << ((haptic - 1) // 6)) >> 15


class MainCodec:
    """Decodes packets of one mesh; what follows from the mesh is worked out once."""

    def __init__(self, mesh: Mesh):
        self.mesh = mesh
        self.hierarchy = Hierarchy(mesh)
        self.triangles_of = triangles_of_vertices(mesh)
        self.initial = MainState(0, [0] * (3 * len(mesh.rest)), [Motion()] * len(mesh.modes), felt={} if mesh.split else None)

    def decode(self, payload: bytes, receiver: Receiver, number: int) -> tuple[MainState, int, list[int], RangeDecoder]:
        decoder, models = RangeDecoder(payload), Models("mesh-start-models.csv")
        place = self.read_place(decoder, models, receiver, number)
        base, tick = place.base, place.tick
        state = self.read_head(decoder, models, place)._replace(tick=tick)
        coefficients = self.read_coefficients(decoder, models) if place.half != HAPTIC else [0] * len(self.mesh.modes)

        steps = [clamp((mode.step * state.visual) >> 12, 1, 1 << 28) for mode in self.mesh.modes]
        q = [lim(c * s) for c, s in zip(coefficients, steps)]
        area = area_of_interest(self.mesh, self.triangles_of, state.triangle) if state.touched else set()
        expected = self.expected(base, tick)
        u = list(expected)
        felt = base.felt if place.completes else {}
        for v in area & felt.keys():
            for axis in range(3):
                expected[3 * v + axis] -= felt[v][axis]
        combine(self.mesh.modes, q, expected)
        moved, coded = self.read_vertices(decoder, models, state, Known(place.half, area, felt), expected, u)
        decoder.check_end()
        if self.mesh.split:
            state = state._replace(felt={v: moved[v] for v in area} if place.half == HAPTIC else {})
        if place.half != HAPTIC:
            n = self.frames(base, tick)
            motion = [learn(c, n, lim(ahead(c, n) + x)) for c, x in zip(base.motion, q)]
            state = state._replace(motion=motion, motion_tick=tick)
        return state._replace(u=u), place.key, coded, decoder

    def frames(self, state: MainState, tick: int) -> int:
        return round_div((tick - state.motion_tick) << 8, self.mesh.frame_period)

    def expected(self, state: MainState, tick: int) -> list[int]:
        """Section 6: where the vertices are expected at a later tick."""
        x = list(state.u)
        n, m = self.frames(state, tick), self.frames(state, state.tick)
        combine(self.mesh.modes, [lim(ahead(c, n) - ahead(c, m)) for c in state.motion], x)
        return x

    # ---- Section 5: head ----

    def read_place(self, decoder: RangeDecoder, models: Models, receiver: Receiver, number: int) -> Place:
        key = decoder.bit(models["KEY"][1])
        named = not key and receiver.span > 1
        baseline_delta = decoder.magnitude(models["BASELINE"]) if named else 1
        half = VISUAL if self.mesh.split else WHOLE
        if self.mesh.split and self.mesh.triangles and not decoder.bit(models["HALF"][1]):
            half = HAPTIC
        completes = int(half == VISUAL and not key and decoder.bit(models["COMPLETES"][1]))
        if completes:
            tick_delta = 0
        elif key:
            tick_delta = decoder.magnitude(models["TICK"])
        else:
            tick_delta = max(0, round_shift(self.mesh.frame_period, 8) + decoder.signed(models["LATE"]))
        base = receiver.baseline(number, key, baseline_delta)
        return Place(key, half, completes, base, receiver.tick(base, key, tick_delta, "R-MES-8"))

    def read_head(self, decoder: RangeDecoder, models: Models, place: Place) -> MainState:
        state = place.base if place.completes else self.read_bounds(decoder, models, place)
        density = state.density
        if place.half != HAPTIC:
            density = decoder.tree(models[f"DENSITY[{state.density}]"], 2)
        require(not state.touched or state.triangle < len(self.mesh.triangles), "invalid", "R-MES-9")
        require(state.haptic <= 168 and state.visual <= 1 << 28, "invalid", "R-MES-10")
        return state._replace(density=density)

    def read_bounds(self, decoder: RangeDecoder, models: Models, place: Place) -> MainState:
        base = place.base
        touched, triangle, haptic = int(place.half == HAPTIC), base.triangle, base.haptic
        if self.mesh.triangles and place.half != HAPTIC:
            touched = decoder.bit(models[f"TOUCHED[{base.touched}]"][1])
        if touched:
            triangle = self.read_triangle(decoder, models, base.triangle)
            haptic = clamp(base.haptic + decoder.signed(models["HAPTIC"]), 0, 169)
        visual = base.visual
        if not decoder.bit(models["SAME_VISUAL"][1]):
            visual = decoder.magnitude(models["VISUAL"])
        return base._replace(triangle=triangle, haptic=haptic, visual=visual, touched=touched)

    def read_triangle(self, decoder: RangeDecoder, models: Models, before: int) -> int:
        if before != NONE:
            if decoder.bit(models["SAME_TRIANGLE"][1]):
                return before
            if decoder.bit(models["NEAR_TRIANGLE"][1]):
                place = decoder.tree(models["NEAR_PLACE"], 6)
                near = ring_list(self.mesh, self.triangles_of, before, 2)[1:64]
                return near[place] if place < len(near) else NONE
        return raw_number(decoder, (len(self.mesh.triangles) - 1).bit_length())

    def read_coefficients(self, decoder: RangeDecoder, models: Models) -> list[int]:
        coefficients: list[int] = []
        for k in range(len(self.mesh.modes)):
            group = 0 if k < 4 else 1 if k < 12 else 2 if k < 24 else 3
            before = klass(coefficients[-1]) if coefficients else 0
            coefficients.append(decoder.signed(models[f"COEFFICIENT[{group}][{before}]"]))
        return coefficients

    # ---- Section 7: vertices ----

    def read_vertices(self, decoder: RangeDecoder, models: Models, state: MainState, known: Known, expected: list[int],
                      u: list[int]) -> tuple[list[tuple], list[int]]:
        """How far every vertex is from where it is expected, and the vertices with a residual other than 0. Completes `u`."""
        h = haptic_bound(state.haptic)
        moved, coded, residuals = [STILL] * len(self.mesh.rest), [0] * len(self.mesh.rest), []
        for v in self.hierarchy.order:
            if known.codes(v):
                haptic = v in known.area and h < state.visual
                bound = h if haptic else state.visual
                tightness = 0 if not haptic else 1 if 3 * h > 2 * state.visual else 2 if 4 * h > state.visual else 3
                p, w = self.hierarchy.parents[v], self.hierarchy.weights[v]
                level = min(2, self.hierarchy.level[v])
                near = min(2, sum(coded[i] for i in p))
                r = [0, 0, 0]
                if decoder.bit(models[f"SIGNIFICANT[{state.density}][{tightness}][{near}][{level}]"][1]):
                    r = self.read_residual(decoder, models, int(tightness > 0), level)
                for axis in range(3):
                    i = 3 * v + axis
                    place = lim(expected[i] + round_shift(sum(a * moved[b][axis] for a, b in zip(w, p)), 15))
                    u[i] = lim(place + r[axis] * step(bound))
                coded[v] = int(any(r))
                residuals += [v] if coded[v] else []
            else:
                coded[v] = int(known.felt.get(v, STILL) != STILL)
            moved[v] = tuple(u[3 * v + axis] - expected[3 * v + axis] for axis in range(3))
        return moved, residuals

    @staticmethod
    def read_residual(decoder: RangeDecoder, models: Models, tight: int, level: int) -> list[int]:
        r: list[int] = []
        for _ in range(3):
            before = klass(max((abs(c) for c in r), default=0))
            r.append(decoder.signed(models[f"COMPONENT[{tight}][{level}][{before}]"]))
        return r
