# SPDX-License-Identifier: Apache-2.0
"""Elastic bodies in the second decoder: a block of tetrahedra, fixed below, that a device pushes from above."""
from __future__ import annotations

import dataclasses
import itertools
import math
import random
import struct
import unittest
import zlib
from typing import Optional

from conventions import StreamError
from deformable_main import FADING, KEPT, MainState
from device_path import DevicePath, device_scene
from elastic import STILL, Shapes
from elastic_matrix import quotient
from elastic_step import Stepper, rotation, turn
from elastic_touch import Proxy, Surface
from scene import MAGIC, VERSION, Declaration, Limits, State, read_declaration

SIDE = 3                                                    # vertices along an edge of the block
UNIT = 1 << 16                                              # of the grid, between two of them: 16 mm
TICKS = 5                                                   # of a frame


def varint(v: int) -> bytes:
    out = b""
    while v >= 128:
        out, v = out + bytes([v & 127 | 128]), v >> 7
    return out + bytes([v])


def zigzag(v: int) -> bytes:
    return varint(2 * v if v >= 0 else -2 * v - 1)


def chained(groups: list[tuple]) -> bytes:
    """Corners: the first from the first before, the others from the one before."""
    out, first = b"", 0
    for group in groups:
        out += zigzag(group[0] - first) + b"".join(zigzag(b - a) for a, b in zip(group, group[1:]))
        first = group[0]
    return out


def points(where: list[tuple]) -> bytes:
    return b"".join(zigzag(b - a) for p, q in zip([(0, 0, 0)] + where, where) for a, b in zip(p, q))


class Block:
    """Six tetrahedra in each cube. The vertex inside is numbered last."""

    def __init__(self) -> None:
        grid = sorted(itertools.product(range(SIDE), repeat=3), key=lambda p: (p == (1, 1, 1), p[2], p[1], p[0]))
        number = {p: v for v, p in enumerate(grid)}
        self.where = [tuple(UNIT * c for c in p) for p in grid]
        self.tetrahedra: list[tuple] = []
        for corner in itertools.product(range(SIDE - 1), repeat=3):
            for order in itertools.permutations(range(3)):
                path = [corner]
                for axis in order:
                    path.append(tuple(c + (a == axis) for a, c in enumerate(path[-1])))
                tet = [number[p] for p in path]
                even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
                self.tetrahedra.append(tuple(tet if even else [tet[0], tet[2], tet[1], tet[3]]))
        faces = [face for a, b, c, d in self.tetrahedra for face in ((a, c, b), (a, b, d), (b, c, d), (a, d, c))]
        once = {tuple(sorted(face)) for face in faces if sum(sorted(face) == sorted(other) for other in faces) == 1}
        self.triangles = [face for face in faces if tuple(sorted(face)) in once]
        self.fixed = SIDE * SIDE                            # the lowest ones


BLOCK = Block()


def body_bytes(**changed) -> bytes:
    """The elements of a body; what is changed takes the place of what is right."""
    constants = {"mass_damping": 1.0, "stiffness_damping": 0.002, "gravity": (0.0, 0.0, 0.0), "coupling": 200.0, "friction": 0.5,
                 "materials": [(20000.0, 0.3, 1000.0)], "tetrahedra": BLOCK.tetrahedra, "lengths": b"", "runs": [(0, BLOCK.fixed - 1)],
                 "inner": BLOCK.where[-1:], **changed}
    out = struct.pack("<7d", *(constants[c] for c in ("mass_damping", "stiffness_damping")), *constants["gravity"],
                      constants["coupling"], constants["friction"])
    out += bytes([len(constants["materials"])]) + b"".join(struct.pack("<3d", *m) for m in constants["materials"])
    out += varint(len(constants["inner"])) + varint(len(constants["tetrahedra"]))
    out += points(constants["inner"]) + chained(constants["tetrahedra"]) + constants["lengths"]
    return out + varint(len(constants["runs"])) + b"".join(varint(gap) + varint(more) for gap, more in constants["runs"])


def declaration(bodies: bytes, frame_period: int = 256 * TICKS, layered: int = 0) -> bytes:
    body = struct.pack("<IBBBBHBB", 1000, 22, 17, 19, 12, 2000, 1, 0)
    outside = BLOCK.where[:-1]
    body += varint(1) + bytes([1, 1]) + b"b" + bytes([2]) + struct.pack("<IBHB", frame_period, layered, 0, 1)
    body += varint(len(outside)) + varint(len(BLOCK.triangles)) + points(outside) + chained(BLOCK.triangles) + bytes([0])
    data = MAGIC + struct.pack("<BBHI", VERSION, 0, 33, len(body + bodies)) + body + bodies
    return data + struct.pack("<I", zlib.crc32(data))


def scene_with(**changed) -> Declaration:
    return read_declaration(declaration(b"\x01" + body_bytes(**changed)))[0]


class RulesTest(unittest.TestCase):
    def assert_refused(self, rule: str, data: bytes, errc: str = "invalid", limits: Limits = Limits()) -> None:
        with self.assertRaises(StreamError) as caught:
            read_declaration(data, limits)
        self.assertEqual((caught.exception.errc, caught.exception.rule), (errc, rule))

    def test_the_object(self) -> None:
        self.assert_refused("R-ELA-1", declaration(b"\x04"), "malformed")
        self.assert_refused("R-ELA-1", declaration(b"\x00"))
        self.assert_refused("R-ELA-1", declaration(b"\x01", frame_period=257))
        self.assert_refused("R-ELA-1", declaration(b"\x01", layered=1))
        self.assert_refused("R-ELA-1", declaration(b"\x01", frame_period=(1 << 18) + 256))
        self.assertEqual(read_declaration(declaration(b"\x01" + body_bytes(), 1 << 18))[0].deformables[0].frame_period, 1 << 18)
        self.assert_refused("R-STR-5", declaration(b"\x01" + body_bytes()[:-1]), "truncated")

    def test_constants(self) -> None:
        for changed in ({"mass_damping": -1.0}, {"stiffness_damping": math.nan}, {"gravity": (0, 0, 2e15)}, {"coupling": 0.0},
                     {"friction": math.inf}, {"materials": []}, {"materials": [(1.0, 0.49991, 1.0)]}, {"materials": [(1.0, -1.0, 1.0)]},
                     {"materials": [(0.0, 0.3, 1.0)]}, {"materials": [(1.0, 0.3, 2e15)]}):
            self.assert_refused("R-ELA-2", declaration(b"\x01" + body_bytes(**changed)))

    def test_methods(self) -> None:
        self.assertEqual(read_declaration(declaration(b"\x02" + body_bytes()))[0].deformables[0].body.method, 2)
        for sub_steps, rule in ((0, "R-ELA-5"), (1, "R-ELA-5"), (60, "")):
            data = declaration(bytes([3, sub_steps]) + body_bytes())
            if rule:
                self.assert_refused(rule, data)
            else:
                self.assertEqual(read_declaration(data)[0].deformables[0].body.sub_steps, sub_steps)

    def test_shape(self) -> None:
        two = [(20000.0, 0.3, 1000.0)] * 2
        count = len(BLOCK.tetrahedra)
        for rule, changed in (("R-ELA-3", {"tetrahedra": []}), ("R-ELA-3", {"tetrahedra": [(0, 1, 2, 2)]}),
                           ("R-ELA-3", {"tetrahedra": [(0, 1, 2, 27)]}), ("R-ELA-3", {"runs": [(0, 27)]}),
                           ("R-ELA-3", {"runs": [(0, 1), (0, 1)]}), ("R-ELA-4", {"runs": [(0, 26)]}),
                           ("R-ELA-4", {"tetrahedra": [BLOCK.tetrahedra[0][1::-1] + BLOCK.tetrahedra[0][2:], *BLOCK.tetrahedra[1:]]}),
                           ("R-ELA-4", {"inner": BLOCK.where[-1:] + [(0, 0, 0)]}),
                           ("R-ELA-3", {"materials": two, "lengths": varint(0) + b"\0"}),
                           ("R-ELA-3", {"materials": two, "lengths": varint(count + 1) + b"\0"}),
                           ("R-ELA-3", {"materials": two, "lengths": varint(count) + b"\2"})):
            self.assert_refused(rule, declaration(b"\x01" + body_bytes(**changed)))

    def test_work(self) -> None:
        data = declaration(b"\x01" + body_bytes())
        work = read_declaration(data)[0].deformables[0].body.work
        read_declaration(data, Limits(body_work=work))
        self.assert_refused("R-STR-24", data, "limit_exceeded", Limits(body_work=work - 1))

    def test_materials(self) -> None:
        half = len(BLOCK.tetrahedra) // 2
        two = [(20000.0, 0.3, 1000.0), (20000.0, 0.3, 3000.0)]
        scene = scene_with(materials=two, lengths=varint(half) + b"\0" + varint(half) + b"\1")
        mass = math.fsum(Stepper(scene.deformables[0].body, TICKS, 1000).mass)
        self.assertAlmostEqual(mass, 2000.0 * (2 * UNIT * 2.0 ** -22) ** 3, 9)


class StepTest(unittest.TestCase):
    def setUp(self) -> None:
        self.scene = scene_with()
        self.body = self.scene.deformables[0].body
        self.stepper = Stepper(self.body, TICKS, 1000)
        self.rng = random.Random(55)

    def test_solve(self) -> None:
        matrix = self.stepper.matrix
        n = len(matrix.rows)
        dense = [[0.0] * n for _ in range(n)]
        for i, (first, row) in enumerate(zip(matrix.first, matrix.rows)):
            for j, a in enumerate(row, start=first):
                dense[i][j] = dense[j][i] = a
        b = [self.rng.uniform(-1, 1) for _ in range(n)]
        x = matrix.solve(b)
        self.assertLess(max(abs(math.fsum(a * c for a, c in zip(row, x)) - e) for row, e in zip(dense, b)), 1e-12)
        self.assertTrue(all(d > 0 for d in matrix.diagonal))

    def test_the_matrix_is_what_forces_gain_at_rest(self) -> None:
        stepper, still = self.stepper, self.stepper.still
        stepper.forces(still, 1.0)
        p = list(still)
        for v in stepper.free:
            p[3 * v:3 * v + 3] = [self.rng.uniform(-1, 1) for _ in range(3)]
        k = stepper.forces(p, 0.0)
        r = list(still)
        for v in stepper.free:
            for i in range(3 * v, 3 * v + 3):
                r[i] = stepper.heavy * stepper.mass[v] * p[i] + stepper.stiff * k[i]
        unturned = {v: (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0) for v in stepper.free}
        self.assertLess(max(abs(a - b) for a, b in zip(stepper.conditioned(unturned, r), p)), 1e-12)

    def test_turned_bodies_have_no_stress(self) -> None:
        c, s = math.cos(1.0), math.sin(1.0)
        p = [a - b for x, y, z in self.body.rest for a, b in zip((c * x - s * y, s * x + c * y, z), (x, y, z))]
        self.assertLess(max(map(abs, self.stepper.forces(p, 1.0))), 1e-10)

    def test_turn_finds_the_rotation(self) -> None:
        c, s = math.cos(0.7), math.sin(0.7)
        found = turn((2 * c, -s, 0.0, 2 * s, c, 0.0, 0.0, 0.0, 1.5), 8)
        self.assertLess(max(abs(a - b) for a, b in zip(found, (c, -s, 0, s, c, 0, 0, 0, 1))), 1e-12)

    def test_mirrored_elements_have_proper_rotations(self) -> None:
        c, s = math.cos(0.7), math.sin(0.7)
        for a, b, z in ((1.2, 0.9, -0.3), (1.2, 0.9, 0.01), (2.5, 1.0, -0.9)):
            found = rotation((a * c, -b * s, 0.0, a * s, b * c, 0.0, 0.0, 0.0, z))
            self.assertLess(max(abs(p - q) for p, q in zip(found, (c, -s, 0, s, c, 0, 0, 0, 1))), 1e-6)

    def test_methods_agree(self) -> None:
        ends = []
        for method, sub_steps in ((1, 1), (2, 1), (3, 60)):
            stepper = Stepper(dataclasses.replace(self.body, method=method, sub_steps=sub_steps), TICKS, 1000)
            u = w = k = stepper.still
            load = stepper.load([])
            load[3 * BLOCK.where.index((UNIT, UNIT, 2 * UNIT)) + 2] = -0.3
            for _ in range(4):
                u, w, k = stepper.step(u, w, k, load)
            ends.append(u)
        size = max(map(abs, ends[2]))
        euler, implicit = (max(abs(a - b) for a, b in zip(end, ends[2])) / size for end in ends[:2])
        self.assertLess(implicit, 0.08)
        self.assertLess(euler, 0.3)

    def test_division_by_nothing(self) -> None:
        self.assertEqual([quotient(1.0, 0.0), quotient(1.0, -0.0), quotient(-1.0, 0.0)], [math.inf, -math.inf, -math.inf])
        self.assertTrue(math.isnan(quotient(0.0, 0.0)))


class ShapesTest(unittest.TestCase):
    """The device is where `at` has it, in metres."""

    def shapes(self, **changed) -> Shapes:
        self.scene = scene_with(**changed)
        path = DevicePath(device_scene(self.scene))
        self.numbers = itertools.count(1)
        return Shapes(self.scene, self.scene.deformables[0], path)

    def at(self, shapes: Shapes, tick: int, point: tuple) -> None:
        position = tuple(round(c * shapes.scale) for c in point)
        shapes.path.add(next(self.numbers), State(tick, position, (1 << 30, 0, 0, 0)))

    def top(self, shapes: Shapes, n: int) -> Optional[list]:
        v = BLOCK.where.index((UNIT, UNIT, 2 * UNIT))
        return shapes.grid(n)[3 * v:3 * v + 3]

    def test_nothing_moves_without_a_push(self) -> None:
        shapes = self.shapes()
        self.assertIsNone(shapes.shape(0))
        shapes.path.begin(0, 0)
        self.at(shapes, 0, (0.015, 0.015, 0.05))            # above
        self.assertFalse(any(shapes.grid(20)))
        self.assertFalse(shapes.shape(20).moves)

    def test_a_push_dents_and_the_dent_goes(self) -> None:
        shapes = self.shapes()
        shapes.path.begin(0, 0)
        self.at(shapes, 0, (0.0156, 0.0156, 0.04))
        self.at(shapes, 50, (0.0156, 0.0156, 0.026))        # 5 mm below the surface
        self.at(shapes, 250, (0.0156, 0.0156, 0.04))
        x, y, z = self.top(shapes, 49)
        self.assertFalse(any(shapes.grid(10)))
        self.assertLess(z, -2000)
        self.assertGreater(z, -0.0055 * shapes.scale)
        self.assertLess(abs(x) + abs(y), -z)
        self.assertLess(max(map(abs, self.top(shapes, 200))), 60)
        self.assertFalse(any(shapes.grid(600)))

    def test_what_was_held_still_moves_once_it_is_let_go(self) -> None:
        shapes = self.shapes(mass_damping=200.0)
        shapes.path.begin(0, 0)
        self.at(shapes, 0, (0.0156, 0.0156, 0.04))
        self.at(shapes, 50, (0.0156, 0.0156, 0.026))
        self.at(shapes, 600, (0.0156, 0.0156, 0.04))
        held, rest = shapes.shape(119), shapes.shape(120)
        self.assertLess(self.top(shapes, 120)[2], -2000)
        self.assertLess(max(map(abs, rest.w)), STILL)
        self.assertEqual(shapes.grid(119), shapes.grid(120))
        self.assertTrue(held.moves and rest.moves)
        self.assertGreater(self.top(shapes, 122)[2], self.top(shapes, 120)[2] + 100)
        self.assertFalse(any(shapes.grid(300)))
        self.assertFalse(shapes.shape(300).moves)

    def test_friction_drags(self) -> None:
        along = []
        for friction in (0.0, 5.0):
            shapes = self.shapes(friction=friction)
            shapes.path.begin(0, 0)
            self.at(shapes, 0, (0.0156, 0.0156, 0.04))
            for tick in range(50, 150):
                self.at(shapes, tick, (0.0156 + 0.00003 * (tick - 50), 0.0156, 0.028))
            along.append(self.top(shapes, 32)[0])
        self.assertGreater(along[1], along[0] + 2000)

    def test_a_body_sags_and_rests(self) -> None:
        shapes = self.shapes(gravity=(0.0, 0.0, -9.81))
        shapes.path.begin(7, 0)                             # in frame 1
        self.assertFalse(any(shapes.grid(0)) or any(shapes.grid(1)))
        self.assertLess(self.top(shapes, 100)[2], -100)
        self.assertTrue(shapes.shape(4).moves)
        self.assertEqual(shapes.grid(2000), shapes.grid(2010))
        self.assertFalse(shapes.shape(2000).moves)

    def test_what_a_packet_left_fades_or_stays(self) -> None:
        shapes = self.shapes()
        shapes.path.begin(0, 0)
        self.at(shapes, 0, (0.0156, 0.0156, 0.04))
        self.at(shapes, 50, (0.0156, 0.0156, 0.026))
        then, now = shapes.grid(12), shapes.grid(20)
        off = [(-1) ** i * 10 * i for i in range(len(then))]
        state = MainState(12 * TICKS, [a + b for a, b in zip(then, off)], [], following=KEPT)
        self.assertEqual(shapes.shown(state, 20 * TICKS + 4), [a + b for a, b in zip(now, off)])
        faded = shapes.shown(state._replace(following=FADING), 20 * TICKS + 4)
        self.assertEqual([abs(a - b) for a, b in zip(faded, now)], [abs(c) * 22518 >> 16 for c in off])
        self.assertEqual(shapes.shown(state._replace(following=FADING), 120 * TICKS), shapes.grid(120))

    def test_a_body_that_flies_away_ends(self) -> None:
        shapes = self.shapes(gravity=(0.0, 0.0, 1e15))
        shapes.path.begin(0, 0)
        self.assertIsNone(shapes.grid(5))
        self.assertIsNotNone(shapes.grid(0))


class TouchTest(unittest.TestCase):
    def test_feet(self) -> None:
        surface = Surface([(0, 1, 2)], [[0], [0], [0]], [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
        for p, weights in (((-1, -1, 1), (1, 0, 0)), ((3, 0, 1), (0, 1, 0)), ((0, 3, 1), (0, 0, 1)), ((0.5, -1, 1), (0.5, 0.5, 0)),
                           ((-1, 0.5, 1), (0.5, 0, 0.5)), ((1, 1, 1), (0, 0.5, 0.5)), ((0.25, 0.25, 1), (0.5, 0.25, 0.25))):
            self.assertEqual(surface.foot(p, 0).weights, weights)

    def test_a_foot_slides_over_edges(self) -> None:
        s = [(float(x), float(y), 0.0) for x in range(6) for y in (0, 1)]
        triangles = [t for i in range(0, 10, 2) for t in ((i, i + 2, i + 1), (i + 1, i + 2, i + 3))]
        triangles_of = [[t for t, corners in enumerate(triangles) if v in corners] for v in range(len(s))]
        surface = Surface(triangles, triangles_of, s)
        q = surface.descend((4.75, 0.5, -0.1), 0)
        self.assertEqual(q.triangle, 9)
        proxy, push = surface.touch((4.75, 0.5, -0.1), Proxy(), True, 100.0, 0.0)
        self.assertEqual(proxy.triangle, 9)
        self.assertAlmostEqual(push.force[2], -10.0)

    def test_a_device_that_goes_through_a_thin_body_stays_on_its_side(self) -> None:
        s = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -0.1), (1.0, 0.0, -0.1), (0.0, 1.0, -0.1)]
        surface = Surface([(0, 1, 2), (3, 5, 4)], [[0], [0], [0], [1], [1], [1]], s)
        above, _ = surface.touch((0.25, 0.25, 0.1), Proxy(), True, 100.0, 0.0)
        self.assertEqual((above.triangle, above.touches), (0, False))
        for first_tick in (False, True):
            proxy, push = surface.touch((0.25, 0.25, -0.08), above, first_tick, 100.0, 0.0)
            self.assertEqual((proxy.triangle, proxy.touches), (0, True))
            self.assertAlmostEqual(push.force[2], -8.0)
        below = Proxy(False, 1, (0.5, 0.25, 0.25))
        self.assertEqual(surface.touch((0.25, 0.25, 0.1), below, False, 100.0, 0.0)[0].triangle, 1)

    def test_nearest_looks_again_in_the_first_tick_only(self) -> None:
        s = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (5.0, 0.0, 0.0), (6.0, 0.0, 0.0), (5.0, 1.0, 0.0)]
        surface = Surface([(0, 1, 2), (3, 4, 5)], [[0], [0], [0], [1], [1], [1]], s)
        before = Proxy(False, 0, (1.0, 0.0, 0.0))
        self.assertEqual(surface.touch((5.2, 0.2, 0.1), before, False, 100.0, 0.0)[0].triangle, 0)
        self.assertEqual(surface.touch((5.2, 0.2, 0.1), before, True, 100.0, 0.0)[0].triangle, 1)
        self.assertTrue(surface.touch((0.2, 0.2, -0.1), before, True, 100.0, 0.0)[0].touches)

    def test_what_is_no_number_gives_way(self) -> None:
        s = [(math.nan,) * 3, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (5.0, 0.0, 0.0), (6.0, 0.0, 0.0), (5.0, 1.0, 0.0)]
        surface = Surface([(0, 1, 2), (3, 4, 5), (0, 2, 1)], [[0, 2], [0, 2], [0, 2], [1], [1], [1]], s)
        self.assertEqual(surface.nearest((0.2, 0.2, 0.1)), 1)


if __name__ == "__main__":
    unittest.main()
