# SPDX-License-Identifier: Apache-2.0
"""Chapter 50 of the specification: packets of profile main."""
from __future__ import annotations

import struct
from typing import NamedTuple, Optional

from conventions import clamp, require, round_div, round_shift
from deformable_graph import Hierarchy, area_of_interest, ring_list, triangles_of_vertices
from deformable_header import DeformableObject
from deformable_motion import Motion, combine, extrapolate, lim, update
from packet import Receiver
from range_coder import RangeDecoder
from start_models import Models

NONE = (1 << 32) - 1
STILL = (0, 0, 0)
KEPT, FADING = 1, 2                                         # values of `following`
ALL, HAPTIC, VISUAL = "all", "haptic", "visual"             # layers
FINEST_HAPTIC = (32768, 36781, 41285, 46341, 52016, 58386)  # H


class MainState(NamedTuple):
    tick: int
    u: list[int]                                            # 3 for each vertex
    motion: list[Motion]
    triangle: int = NONE
    haptic_index: int = 0
    visual: int = 0
    density: int = 0
    touched: int = 0
    motion_tick: int = 0
    weight_set: int = 0
    following: int = 0
    haptic_correction: Optional[dict[int, tuple]] = None    # if layered; vertices that are not there have 0
    off_basis: Optional[list[int]] = None                   # if anything fades: 3 for each vertex

    def hashed(self) -> bytes:
        """What the state hash is taken of."""
        data = struct.pack(f"<Q{len(self.u)}i4I", self.tick, *self.u, self.visual, self.triangle, self.haptic_index,
                           self.density + 4 * self.touched + 8 * self.weight_set + 32 * self.following)
        for c in self.motion:
            data += struct.pack("<2i5Q", c.last, c.before, *(s % (1 << 64) for s in c[2:]))
        if self.haptic_correction is not None:
            data += struct.pack("<Q", self.motion_tick)
            for v in range(len(self.u) // 3):
                data += struct.pack("<3i", *self.haptic_correction.get(v, STILL))
        if self.off_basis is not None:
            data += struct.pack(f"<{len(self.off_basis)}i", *self.off_basis)
        return data


class Known(NamedTuple):
    """What a layer need not code."""
    layer: str
    area: set[int]                                          # the area of interest
    correction: dict[int, tuple]                            # of the haptic layer of the same frame

    def codes(self, v: int) -> bool:
        return self.layer != (VISUAL if v in self.area else HAPTIC)


class Start(NamedTuple):
    """The elements up to `late`."""
    key: int
    layer: str
    same_frame: int
    base: MainState
    tick: int


def klass(number: int) -> int:
    """The class of a number."""
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


def haptic_bound(index: int) -> int:
    return 0 if index == 0 else (FINEST_HAPTIC[(index - 1) % 6] << ((index - 1) // 6)) >> 15


def mode_unit(mode_step: int, state: MainState) -> int:
    """What a coefficient of 1 stands for."""
    reach = state.visual
    if state.touched:
        reach = clamp(8 * haptic_bound(state.haptic_index), state.visual >> 2, state.visual)
    return clamp((mode_step * reach) >> 12, 1, 1 << 28)


class MainCodec:
    """Decodes packets of one deformable object; what follows from its surface is computed once."""

    def __init__(self, item: DeformableObject):
        self.item = item
        self.hierarchy = Hierarchy(item)
        self.triangles_of = triangles_of_vertices(item)
        self.initial = MainState(0, [0] * (3 * len(item.rest)), [Motion()] * len(item.modes),
                                 haptic_correction={} if item.layered else None,
                                 off_basis=[0] * (3 * len(item.rest)) if item.fade > 0 else None)

    def decode(self, payload: bytes, receiver: Receiver, number: int) -> tuple[MainState, int, list[int], RangeDecoder]:
        decoder, models = RangeDecoder(payload), Models("deformable-start-models.csv")
        start = self.read_start(decoder, models, receiver, number)
        base, tick = start.base, start.tick
        state = self.read_head(decoder, models, start)._replace(tick=tick)
        coefficients = self.read_coefficients(decoder, models) if start.layer != HAPTIC else [0] * len(self.item.modes)

        q = [lim(c * mode_unit(mode.step, state)) for mode, c in zip(self.item.modes, coefficients)]
        area = area_of_interest(self.item, self.triangles_of, state.triangle) if state.touched else set()
        expected = self.expect(base, tick)
        correction = base.haptic_correction if start.same_frame else {}
        known = Known(start.layer, area, correction)
        faded = self.fade(base, tick, known, expected)
        u = list(expected)
        for v in area & correction.keys():
            for axis in range(3):
                expected[3 * v + axis] -= correction[v][axis]
        combine(self.item.modes, q, expected)
        corrections, coded = self.read_vertices(decoder, models, state, known, expected, u)
        decoder.check_end()
        if self.item.fade > 0:
            off_basis = [lim(f + c) for v, c3 in sorted(corrections.items()) for f, c in zip(faded[3 * v:3 * v + 3], c3)]
            for v in area & correction.keys():
                for axis in range(3):
                    off_basis[3 * v + axis] = lim(off_basis[3 * v + axis] - correction[v][axis])
            state = state._replace(off_basis=off_basis)
        if self.item.layered:
            state = state._replace(haptic_correction={v: corrections[v] for v in area} if start.layer == HAPTIC else {})
        if start.layer != HAPTIC:
            n = self.frames(base, tick)
            motion = [update(c, n, lim(extrapolate(c, n) + x)) for c, x in zip(base.motion, q)]
            state = state._replace(motion=motion, motion_tick=tick)
        return state._replace(u=u), start.key, coded, decoder

    def frames(self, state: MainState, tick: int) -> int:
        return round_div((tick - state.motion_tick) << 8, self.item.frame_period)

    def fade(self, base: MainState, tick: int, known: Known, expected: list[int]) -> list[int]:
        """Takes from `expected` what fades, and returns what is left."""
        if self.item.fade == 0:
            return []
        left = 1 << 16
        if known.layer != HAPTIC:
            for _ in range(min(8, self.frames(base, tick))):
                left = (left * ((1 << 16) - self.item.fade)) >> 16
        faded = list(base.off_basis)
        for i, before in enumerate(base.off_basis):
            if known.codes(i // 3):
                faded[i] = (abs(before) * left >> 16) * (1 if before > 0 else -1)
                expected[i] = lim(expected[i] - before + faded[i])
        return faded

    def expect(self, state: MainState, tick: int) -> list[int]:
        """Where the vertices are expected at a later tick."""
        x = list(state.u)
        n, m = self.frames(state, tick), self.frames(state, state.tick)
        combine(self.item.modes, [lim(extrapolate(c, n) - extrapolate(c, m)) for c in state.motion], x)
        return x

    # ---- Head ----

    def read_start(self, decoder: RangeDecoder, models: Models, receiver: Receiver, number: int) -> Start:
        key = decoder.bit(models["KEY"][1])
        named = not key and receiver.span > 1
        baseline_delta = decoder.magnitude(models["BASELINE"]) if named else 1
        layer = VISUAL if self.item.layered else ALL
        if self.item.layered and self.item.triangles and not decoder.bit(models["LAYER"][1]):
            layer = HAPTIC
        same_frame = int(layer == VISUAL and not key and decoder.bit(models["SAME_FRAME"][1]))
        if same_frame:
            tick_delta = 0
        elif key:
            tick_delta = decoder.magnitude(models["TICK"])
        else:
            tick_delta = max(0, round_shift(self.item.frame_period, 8) + decoder.signed(models["LATE"]))
        base = receiver.baseline(number, key, baseline_delta)
        return Start(key, layer, same_frame, base, receiver.tick(number, base, tick_delta, "R-DEF-8"))

    def read_head(self, decoder: RangeDecoder, models: Models, start: Start) -> MainState:
        state = start.base if start.same_frame else self.read_bounds(decoder, models, start)
        density = state.density
        if start.layer != HAPTIC:
            density = decoder.tree(models[f"DENSITY[{state.density}]"], 2)
        sets, weight_set = len(self.hierarchy.weights), 0
        if sets > 1:
            weight_set = decoder.tree(models[f"WEIGHT_SET[{start.base.weight_set}]"], 2)
        following = self.read_following(decoder, models, start.base) if self.item.body else 0
        require(not state.touched or state.triangle < len(self.item.triangles), "invalid", "R-DEF-9")
        require(state.haptic_index <= 168 and state.visual <= 1 << 28, "invalid", "R-DEF-10")
        require(weight_set < sets, "invalid", "R-DEF-14")
        return state._replace(density=density, weight_set=weight_set, following=following)

    @staticmethod
    def read_following(decoder: RangeDecoder, models: Models, base: MainState) -> int:
        if not decoder.bit(models[f"DRIVEN[{int(base.following > 0)}]"][1]):
            return 0
        return KEPT + decoder.bit(models[f"FADES[{int(base.following == FADING)}]"][1])

    def read_bounds(self, decoder: RangeDecoder, models: Models, start: Start) -> MainState:
        base = start.base
        touched, triangle, haptic_index = int(start.layer == HAPTIC), base.triangle, base.haptic_index
        if self.item.triangles and start.layer != HAPTIC:
            touched = decoder.bit(models[f"TOUCHED[{base.touched}]"][1])
        if touched:
            triangle = self.read_triangle(decoder, models, base.triangle)
            haptic_index = clamp(base.haptic_index + decoder.signed(models["HAPTIC"]), 0, 169)
        visual = base.visual
        if not decoder.bit(models["SAME_VISUAL"][1]):
            visual = decoder.magnitude(models["VISUAL"])
        return base._replace(triangle=triangle, haptic_index=haptic_index, visual=visual, touched=touched)

    def read_triangle(self, decoder: RangeDecoder, models: Models, before: int) -> int:
        if before != NONE:
            if decoder.bit(models["SAME_TRIANGLE"][1]):
                return before
            if decoder.bit(models["NEAR_TRIANGLE"][1]):
                number = decoder.tree(models["NEAR_INDEX"], 6)
                near = ring_list(self.item, self.triangles_of, before, 2)[1:64]
                return near[number] if number < len(near) else NONE
        return raw_number(decoder, (len(self.item.triangles) - 1).bit_length())

    def read_coefficients(self, decoder: RangeDecoder, models: Models) -> list[int]:
        coefficients: list[int] = []
        for k in range(len(self.item.modes)):
            group = 0 if k < 4 else 1 if k < 12 else 2 if k < 24 else 3
            before = klass(coefficients[-1]) if coefficients else 0
            coefficients.append(decoder.signed(models[f"COEFFICIENT[{group}][{before}]"]))
        return coefficients

    # ---- Vertices ----

    def read_vertices(self, decoder: RangeDecoder, models: Models, state: MainState, known: Known, expected: list[int],
                      u: list[int]) -> tuple[dict[int, tuple], list[int]]:
        """The correction of every vertex, and the vertices with a residual other than 0. Completes `u`."""
        h = haptic_bound(state.haptic_index)
        corrections: dict[int, tuple] = {}
        coded: dict[int, int] = {}
        residual_of: dict[int, tuple] = {}                  # of the vertices that the packet codes
        parents, weights = self.hierarchy.parents[state.weight_set], self.hierarchy.weights[state.weight_set]
        for v in self.hierarchy.order:
            if known.codes(v):
                haptic = v in known.area and h < state.visual
                bound = h if haptic else state.visual
                bound_ratio = 0 if not haptic else 1 if 3 * h > 2 * state.visual else 2 if 4 * h > state.visual else 3
                p, w = parents[v], weights[v]
                depth = min(2, self.hierarchy.depth[v])
                near = min(2, sum(coded[i] for i in p))
                s = [sum(a * corrections[b][axis] for a, b in zip(w, p)) for axis in range(3)]
                r = STILL
                if decoder.bit(models[f"SIGNIFICANT[{state.density}][{bound_ratio}][{near}][{depth}]"][1]):
                    m = [sum(a * residual_of.get(b, STILL)[axis] for a, b in zip(w, p)) for axis in range(3)]
                    r = self.read_residual(decoder, models, f"COMPONENT[{int(bound_ratio > 0)}][{depth}]", m, s, step(bound))
                for axis in range(3):
                    i = 3 * v + axis
                    u[i] = lim(lim(expected[i] + round_shift(s[axis], 15)) + r[axis] * step(bound))
                coded[v], residual_of[v] = int(any(r)), r
            else:
                coded[v] = int(known.correction.get(v, STILL) != STILL)
            corrections[v] = tuple(u[3 * v + axis] - expected[3 * v + axis] for axis in range(3))
        return corrections, [v for v in coded if coded[v] and known.codes(v)]

    @staticmethod
    def read_residual(decoder: RangeDecoder, models: Models, component: str, m: list[int], s: list[int], size: int) -> tuple:
        """`m` is what the residuals of the parents predict, `s` what their corrections do, both x 2^15; steps are of `size`."""
        r: list[int] = []
        for axis in range(3):
            before = klass(max((abs(c) for c in r), default=0))
            like, i, j = expected_sign(m[axis], s[axis], size)
            sign = models[f"SIGN[{i}][{j + 2}]"][1] if like else None
            if axis == 2 and before == 0:
                r.append(decoder.nonzero_like(models[f"{component}[3][{level(m[axis], 1 << 15)}]"], sign, like))
            else:
                r.append(decoder.signed_like(models[f"{component}[{before}][{level(m[axis], 1 << 15)}]"], sign, like))
        return tuple(r)


def level(a: int, unit: int) -> int:
    """How large a is."""
    return 0 if 8 * abs(a) < unit else 1 if 2 * abs(a) < unit else 2 if abs(a) < 2 * unit else 3


def expected_sign(m: int, s: int, size: int) -> tuple[int, int, int]:
    """What the residuals of the parents say, else their corrections: -1, 1 or 0, and which model tells whether it is so."""
    i, j = min(2, level(m, 1 << 15)), min(2, level(s, size << 15))
    if i == 0 and j == 0:
        return 0, 0, 0
    like = (-1 if m < 0 else 1) if i > 0 else (-1 if s < 0 else 1)
    return like, i, j if (s < 0) == (like < 0) else -j
