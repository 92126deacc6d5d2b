# SPDX-License-Identifier: Apache-2.0
"""Chapter 20 of the specification: scene declaration, the header of a stream."""
from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass, field
from typing import NamedTuple, Optional

import deformable_basis
import deformable_clusters
import thesis_mesh
from conventions import ONE, STR_5, STR_5_VARINT, Cursor, require, text
from deformable_header import THESIS, DeformableObject, read_deformable_objects
from elastic_header import read_elastic_bodies
from elastic_step import is_stable


class Limits(NamedTuple):
    """What this decoder accepts (R-STR-14, R-STR-18, R-STR-21, R-STR-24, R-FIL-4, R-PKT-1)."""
    objects: int = 4096
    body_size: int = 1 << 20
    packet_size: int = 1 << 20
    vertices: int = 1 << 20                                 # of all deformable objects
    triangles: int = 1 << 21                                # the same
    state_bytes: int = 1 << 28                              # R-STR-18
    basis_work: int = 1 << 22                               # R-STR-21
    body_work: int = 1 << 30                                # R-STR-24
    thesis: bool = True                                     # component thesis (chapter 85)


MAGIC = b"\x89TCT"
VERSION = 2                                                 # of the format
SMALLEST_OBJECT = 32
HAS_DEFORMABLES, HAS_LOADS, IS_SMOOTHED, HAS_MOTION, IS_DRIVEN, HAS_BODIES, HAS_INTEREST = FLAGS = [1 << bit for bit in range(7)]
PARTS = {                                                   # elements of a flag: name, form, count; of IS_DRIVEN of each moving object
    HAS_LOADS: (("force_exp", "B", 1), ("load_users", "B", 1)),
    HAS_MOTION: (("gravity", "i", 3), ("slide_deceleration", "i", 1)),
    IS_DRIVEN: (("coupling", "I", 1), ("hold", "I", 1), ("inertia", "I", 3), ("friction", "H", 1), ("damping", "H", 1)),
    HAS_INTEREST: (("full", "I", 1), ("reach", "I", 1)),
}


class Contact(NamedTuple):                                  # chapter 42, section 3
    held: int = 0
    point: tuple = (0, 0, 0)                                # x 2^-13 m, object's frame
    normal: tuple = (0, 0, 0)                               # x 2^-10
    drag: int = 0                                           # x 2^-4 m/s^2


class State(NamedTuple):                                    # chapter 40
    tick: int
    position: tuple
    rotation: tuple
    velocity: tuple = (0, 0, 0)
    angular_velocity: tuple = (0, 0, 0)
    predictor: int = 0
    smoothing_exp: int = 0
    retained: int = 0
    contact: Contact = Contact()
    lod: int = 0                                            # 44, section 1


class Object(NamedTuple):
    name: str
    dof: int
    initial: State


class LoadDeclaration(NamedTuple):                          # chapter 45
    force_exp: int
    users: int


class MotionConstants(NamedTuple):                          # chapter 40, x 2^-velocity_exp m/s^2
    gravity: tuple
    slide_deceleration: int


class DrivenConstants(NamedTuple):                          # chapter 42, section 2; all 0: the object is never driven
    coupling: int                                           # x 2^-8 s^-2
    hold: int
    inertia: tuple                                          # x 2^-30 m^2
    friction: int                                           # x 2^-8
    damping: int                                            # x 2^-20


OUT_OF_INTEREST = 7


class Interest(NamedTuple):                                 # chapter 44, section 2, x 2^-position_exp m
    full: int
    reach: int


class Bounds(NamedTuple):
    """Elements of the bounds record in the order in which they are read, f64 as the hexadecimal digits of their bits."""
    rigid: Optional[list]
    deformables: list[list]
    loads: Optional[list]


@dataclass
class Declaration:
    version: int
    profile: int
    tick_rate: int
    position_exp: int
    velocity_exp: int
    rotation_exp: int
    angular_exp: int
    max_extrapolation: int
    baseline_span: int
    smoothed: bool = False
    objects: list[Object] = field(default_factory=list)
    deformables: list[DeformableObject] = field(default_factory=list)
    loads: Optional[LoadDeclaration] = None
    motion: Optional[MotionConstants] = None
    driven: dict[int, DrivenConstants] = field(default_factory=dict)         # of all moving objects, if the scene is driven
    interest: Optional[Interest] = None
    bounds: Optional[Bounds] = None

    def moving(self) -> list[int]:
        """The moving objects M, as indices into `objects`."""
        return [i for i, item in enumerate(self.objects) if item.dof != 0]

    def substreams(self) -> list[int]:
        """Their numbers (25, section 1)."""
        count = len(self.deformables)
        rigid = [0] if self.moving() or count == 0 else []
        return [*rigid, *range(1, count + 1), *([count + 1] if self.loads else [])]

    def follows_devices(self) -> bool:
        """Whether both ends know the paths of devices (65, section 4)."""
        return bool(self.driven) or any(item.body for item in self.deformables)


STR_16 = ("malformed", "R-STR-16")
BOUNDS, STIFFNESS = 2, 3                                                  # types of extension records


def read_declaration(data: bytes, limits: Limits = Limits()) -> tuple[Declaration, int]:
    """Returns the declaration and its size in bytes."""
    require(len(data) >= 4, "truncated", "R-STR-1")
    require(data[:4] == MAGIC, "malformed", "R-STR-1")
    require(len(data) >= 12, *STR_5)
    version, profile, flags, body_size = struct.unpack_from("<BBHI", data, 4)
    require(version == VERSION, "unsupported", "R-STR-2")
    require(profile <= 1, "malformed", "R-STR-3")
    require(profile == 0, "unsupported", "R-STR-3")
    require(flags <= sum(FLAGS), "malformed", "R-STR-4")
    require(body_size <= limits.body_size, "limit_exceeded", "R-STR-14")
    end = 12 + body_size
    require(len(data) >= end + 4, *STR_5)
    require(zlib.crc32(data[:end]) == int.from_bytes(data[end:end + 4], "little"), "checksum", "R-STR-15")

    body = Cursor(data, 12, end)
    scene = Declaration(version, profile, *struct.unpack("<IBBBBHB", body.take(11, STR_5)), bool(flags & IS_SMOOTHED))
    object_count = body.varint(STR_5, STR_5_VARINT)
    check_numbers(scene)
    require(object_count <= limits.objects, "limit_exceeded", "R-STR-14")
    require(object_count * SMALLEST_OBJECT <= body.left(), *STR_5)
    scene.objects = [read_object(body) for _ in range(object_count)]
    if flags & HAS_DEFORMABLES:
        scene.deformables = read_deformable_objects(body, limits.objects - object_count, limits.vertices, limits.triangles,
                                                   limits.thesis)
    if flags & HAS_LOADS:
        scene.loads = LoadDeclaration(*read_part(body, HAS_LOADS))
        require(scene.moving() and scene.loads.force_exp <= 20 and scene.loads.users <= 64, "invalid", "R-STR-19")
    if flags & HAS_MOTION:
        scene.motion = read_motion(body)
        require(scene.moving(), "invalid", "R-STR-22")
    if flags & IS_DRIVEN:
        scene.driven = {i: DrivenConstants(*read_part(body, IS_DRIVEN)) for i in scene.moving()}
        sound = all(is_sound(item) for item in scene.driven.values())
        require(sound and any(item.coupling for item in scene.driven.values()), "invalid", "R-STR-23")
    if flags & HAS_BODIES:
        read_elastic_bodies(body, scene.deformables, scene.position_exp)
    if flags & HAS_INTEREST:
        scene.interest = Interest(*read_part(body, HAS_INTEREST))
        require(scene.moving() and 1 <= scene.interest.full <= scene.interest.reach < 1 << 31, "invalid", "R-STR-25")
        scene.objects = [o._replace(initial=o.initial._replace(lod=OUT_OF_INTEREST)) for o in scene.objects]
    while body.left() > 0:
        kind = body.varint(STR_16, STR_16)
        content = body.take(body.varint(STR_16, STR_16), STR_16)
        if kind == BOUNDS:
            require(scene.bounds is None, "invalid", "R-STR-17")
            scene.bounds = read_bounds(Cursor(content, 0, len(content)), scene)
        if kind == STIFFNESS:
            read_stiffness(content, scene.deformables)
    names = [item.name for item in (*scene.objects, *scene.deformables)]
    require(len(set(names)) == len(names), "invalid", "R-STR-11")
    require(state_bytes(scene) <= limits.state_bytes, "limit_exceeded", "R-STR-18")
    work = sum(deformable_basis.work(item) + deformable_clusters.work(item) for item in scene.deformables)
    require(work <= limits.basis_work, "limit_exceeded", "R-STR-21")
    work = sum(item.body.work for item in scene.deformables if item.body)
    require(work <= limits.body_work, "limit_exceeded", "R-STR-24")
    for item in scene.deformables:
        if item.body:
            require(is_stable(item.body, item.frame_period // 256, scene.tick_rate), "invalid", "R-ELA-5")
    for item in scene.deformables:
        if item.fixed is not None:
            item.modes = deformable_basis.computed_modes(item)
        if item.clusters is not None:
            item.modes = deformable_clusters.cluster_modes(item)
    return scene, end + 4


def check_numbers(scene: Declaration) -> None:
    require(1 <= scene.tick_rate <= 1000000, "invalid", "R-STR-6")
    require(8 <= scene.position_exp <= 30 and scene.velocity_exp <= scene.position_exp <= scene.velocity_exp + 12
            and 8 <= scene.rotation_exp <= 28 and scene.angular_exp <= 20
            and scene.angular_exp <= scene.rotation_exp <= scene.angular_exp + 12, "invalid", "R-STR-7")
    require(scene.max_extrapolation >= 1, "invalid", "R-STR-8")
    require(1 <= scene.baseline_span <= 64, "invalid", "R-STR-9")


def state_bytes(scene: Declaration) -> int:
    """What all states take, as the chapter counts it."""
    states = scene.baseline_span + 2
    load = 12 * (2 + scene.loads.users) if scene.loads else 0
    total = (64 + load) * states * len(scene.objects)
    for item in scene.deformables:
        per_vertex = 12 + (12 if item.layered else 0) + (12 if item.fade > 0 else 0)
        total += states * (per_vertex * len(item.rest) + 48 * item.mode_count)
        if item.profile == THESIS:
            total += thesis_mesh.models_bytes(item, states)
    return total


def read_object(body: Cursor) -> Object:
    kind = body.number(1, STR_5)
    require(kind == 1, "unsupported", "R-STR-10")
    dof, name_size = body.take(2, STR_5)
    name_bytes = body.take(name_size, STR_5)
    pose = struct.unpack("<7i", body.take(28, STR_5))
    name = text(name_bytes)
    require(dof >> 3 in (0, 1, 2, 4, 7), "invalid", "R-STR-12")
    position, rotation = pose[:3], pose[3:]
    require(all(-ONE <= c <= ONE for c in rotation)
            and abs(sum(c * c for c in rotation) - (1 << 60)) <= 1 << 41, "invalid", "R-STR-13")
    return Object(name, dof, State(0, position, rotation))


def read_part(body: Cursor, flag: int) -> list:
    """A vector is a tuple."""
    def element(form: str, count: int):
        values = struct.unpack(f"<{count}{form}", body.take(count * struct.calcsize(form), STR_5))
        return values if count > 1 else values[0]

    return [element(form, count) for _, form, count in PARTS[flag]]


def read_motion(body: Cursor) -> MotionConstants:
    motion = MotionConstants(*read_part(body, HAS_MOTION))
    most = 1 << 28
    require(all(-most <= c <= most for c in motion.gravity) and 0 <= motion.slide_deceleration <= most
            and (any(motion.gravity) or motion.slide_deceleration), "invalid", "R-STR-22")
    return motion


def is_sound(item: DrivenConstants) -> bool:
    most = 1 << 30
    if item == DrivenConstants(0, 0, (0, 0, 0), 0, 0):
        return True
    return all(1 <= c <= most for c in (item.coupling, *item.inertia)) and item.hold <= most


def read_bounds(data: Cursor, scene: Declaration) -> Bounds:
    def f64s(count: int) -> list[str]:
        return [f64() for _ in range(count)]

    def f64() -> str:
        bits = data.number(8, ("truncated", "R-STR-17"))
        require(bits < 0x7FF0000000000000, "invalid", "R-STR-17")
        return f"{bits:016x}"

    def choice(most: int) -> int:
        value = data.number(1, ("truncated", "R-STR-17"))
        require(value <= most, "invalid", "R-STR-17")
        return value

    rigid = None
    if scene.moving():
        rigid = f64s(3)
        haptic = choice(4)
        rigid += [haptic, *f64s({0: 0, 1: 2, 2: 3, 3: 2, 4: 2}[haptic])]
    deformables = []
    for _ in scene.deformables:
        bound_flags = choice(3)
        deformables.append([bound_flags, *f64s(3 if bound_flags & 2 else 1)])
    return Bounds(rigid, deformables, f64s(2) if scene.loads else None)


def read_stiffness(data: bytes, deformables: list[DeformableObject]) -> None:
    require(len(data) >= 1, "truncated", "R-STR-20")
    require(data[0] < len(deformables) and deformables[data[0]].stiffness is None, "invalid", "R-STR-20")
    of = deformables[data[0]]
    require(len(data) > len(of.rest), "truncated", "R-STR-20")
    of.stiffness = data[1:1 + len(of.rest)]
