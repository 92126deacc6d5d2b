# SPDX-License-Identifier: Apache-2.0
"""What both ends know before the first packet."""
from __future__ import annotations

import ctypes
import dataclasses
from typing import Any, Sequence

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import Handle, answer, bytes_of, call, core, read_bytes, text_of
from .options import DeformableBounds, Limits, RigidBounds, SceneOptions, init


@dataclasses.dataclass(frozen=True)
class Driven:
    """What a participant's device needs to know of a rigid object that it pushes or holds, in a session.

    mass       [kg];  inertia  (3,) [kg m^2] about the axes of the object's frame
    stiffness  [N/m] of the coupling between device and proxy
    hold       [N/m] of that to an object that it holds; 0: it holds none
    friction   of the proxy on the object;  damping  [1/s] rate at which its velocities die away
    """
    mass: float
    inertia: Sequence[float]
    stiffness: float
    hold: float = 0
    friction: float = 0
    damping: float = 0


@dataclasses.dataclass(frozen=True)
class RigidObject:
    """A rigid object at rest.

    position  (3,) [m] world;  rotation  (4,) unit quaternion w x y z, object to world
    dof       bits of the axes it may move along (1 2 4) and turn about (8 16 32); 0: static, never sent
    driven    declare how a device drives it; None: do not. Not read back from a scene
    """
    name: str
    position: Sequence[float] = (0, 0, 0)
    rotation: Sequence[float] = (1, 0, 0, 0)
    dof: int = _abi.TACTUS_DOF_ALL
    driven: Driven | None = None


_METHODS = {"backward-euler": _abi.TACTUS_METHOD_BACKWARD_EULER, "tr-bdf2": _abi.TACTUS_METHOD_TR_BDF2,
            "velocity-verlet": _abi.TACTUS_METHOD_VELOCITY_VERLET}


@dataclasses.dataclass(frozen=True, eq=False)
class Elastic:
    """What a mesh is made of, for a participant whose device deforms it in a session. Vertices are those of the mesh, then the inner ones.

    tets        (T, 4) uint32 corners a b c d, (b - a) x (c - a) . (d - a) > 0
    materials   (M, 3) Young's modulus [N/m^2], Poisson's ratio, density [kg/m^3]
    coupling    [N/m] between device and proxy
    inner       (I, 3) [m] world, at rest
    material    (T,) of each tetrahedron; None: the first of all
    fixed       vertices that do not move, ascending
    mass_damping [1/s], stiffness_damping [s], gravity (3,) [m/s^2], friction of the proxy
    method      of a step, that of the server if it has one: "backward-euler", "tr-bdf2", "velocity-verlet"
    sub_steps   of velocity Verlet, 1 to 255, which is stable with them
    """
    tets: npt.NDArray[np.uint32]
    materials: Sequence[Sequence[float]]
    coupling: float
    inner: npt.ArrayLike = ()
    material: npt.NDArray[np.uint8] | None = None
    fixed: Sequence[int] = ()
    mass_damping: float = 0
    stiffness_damping: float = 0
    gravity: Sequence[float] = (0, 0, 0)
    friction: float = 0
    method: str = "backward-euler"
    sub_steps: int = 1


@dataclasses.dataclass(frozen=True, eq=False)
class Mesh:
    """A deformable object at rest.

    vertices      (V, 3) float64 [m] world
    triangles     (F, 3) uint32, counter-clockwise seen from outside
    frame_period  [ticks] from shape to shape
    modes         of its vibration basis, which both ends compute; 0: none
    rings         around a touched triangle: the area of interest, where the haptic bound holds
    clusters      (V,) uint8: of vertices that move alike, its basis in place of modes; None: none
    blend         rounds in which clusters are blended where they meet, 0 to 32
    elastic       declare what it is made of; None: do not. Not read back from a scene
    """
    name: str
    vertices: npt.NDArray[np.float64]
    triangles: npt.NDArray[np.uint32]
    frame_period: float = 1
    modes: int = 0
    rings: int = 3
    clusters: npt.NDArray[np.uint8] | None = None
    blend: int = 0
    elastic: Elastic | None = None


class Scene(Handle):
    """Immutable. From bytes (a declaration, as in the head of a stream), by build_scene(), or of a trace or player."""

    _destroy = "tactus_scene_destroy"

    def __init__(self, declaration: bytes | None = None, limits: Limits | None = None) -> None:
        super().__init__()
        if declaration is not None:
            data = bytes_of(declaration)
            call(core().tactus_scene_parse, data, len(data), limits, ctypes.byref(self._handle), None)

    @classmethod
    def _borrowed(cls, handle: int, owner: object) -> Scene:
        """A scene that belongs to a receiver, as one of its own."""
        del owner  # alive as long as the call
        return cls(read_bytes(core().tactus_scene_write, handle))

    def to_bytes(self) -> bytes:
        """The declaration. Equal scenes give equal bytes."""
        return read_bytes(core().tactus_scene_write, self.handle)

    @property
    def info(self) -> _abi.tactus_scene_info:
        """tick_rate [1/s], rigid, deformables, substreams (counts), position_exp, extrapolation [ticks], baselines, smoothed, .."""
        info = answer(_abi.tactus_scene_info)
        call(core().tactus_scene_get, self.handle, info)
        return info

    @property
    def tick_rate(self) -> int:
        """Ticks per second."""
        return self.info.tick_rate

    @property
    def objects(self) -> list[RigidObject]:
        """Rigid objects, in wire order."""
        out = []
        for i in range(self.info.rigid):
            info = answer(_abi.tactus_rigid_info)
            call(core().tactus_scene_get_rigid, self.handle, i, info)
            out.append(RigidObject(info.name.decode(), tuple(info.initial.position), tuple(info.initial.rotation), info.dof))
        return out

    @property
    def meshes(self) -> list[Mesh]:
        """Deformable objects, in wire order."""
        return [self._mesh(i) for i in range(self.info.deformables)]

    def _mesh(self, index: int) -> Mesh:
        info = answer(_abi.tactus_deformable_info)
        call(core().tactus_scene_get_deformable, self.handle, index, info)
        rest = np.empty((info.vertices, 3), np.float32)
        triangles = np.empty((info.triangles, 3), np.uint32)
        clusters = np.empty(info.vertices, np.uint8) if info.clusters else None
        arrays = answer(_abi.tactus_mesh_arrays)
        arrays.vertices, arrays.rest, arrays.triangles, arrays.corners = len(rest), rest.ctypes.data, len(triangles), triangles.ctypes.data
        arrays.clusters = None if clusters is None else clusters.ctypes.data
        call(core().tactus_scene_get_mesh, self.handle, index, arrays)
        modes = 0 if info.clusters else info.modes
        return Mesh(info.name.decode(), rest.astype(np.float64), triangles, info.frame_period, modes, info.rings, clusters, info.blend)

    @property
    def rigid_bounds(self) -> RigidBounds | None:
        """That the sender guarantees for rigid objects; None: not declared."""
        bounds = RigidBounds()
        return bounds if call(core().tactus_scene_get_bounds, self.handle, bounds, 0, None, None) else None

    def deformable_bounds(self, mesh: int = 0) -> DeformableBounds | None:
        """That the sender guarantees for a mesh; None: not declared."""
        bounds = DeformableBounds()
        return bounds if call(core().tactus_scene_get_bounds, self.handle, None, mesh, bounds, None) else None


def _arrays(of: Mesh) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.uint32]]:
    """Vertices and triangles as C takes them."""
    vertices = np.ascontiguousarray(of.vertices, np.float64)
    triangles = np.ascontiguousarray(of.triangles, np.uint32)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or triangles.ndim != 2 or triangles.shape[1] != 3:
        raise ValueError(f"{of.name}: vertices have shape {vertices.shape} and triangles {triangles.shape}, not (V, 3) and (F, 3)")
    if not np.array_equal(triangles, of.triangles):
        raise ValueError(f"{of.name}: triangles are whole numbers from 0")
    return vertices, triangles


def _whole(name: str, what: str, values: npt.ArrayLike, dtype: type, width: int = 0) -> npt.NDArray:
    """Whole numbers as C takes them, in rows of `width`; 0: in none."""
    given = np.asarray(values).reshape((-1, width) if width else -1)
    out = np.ascontiguousarray(given, dtype)
    if not np.array_equal(out, given):
        raise ValueError(f"{name}: {what} are whole numbers from 0 to {np.iinfo(dtype).max}")
    return out


def find_clusters(mesh: Mesh, shapes: npt.ArrayLike, most: int) -> Mesh:
    """The mesh with at most so many clusters of vertices that move alike.

    shapes  (S, V, 3) [m] displacements from rest, of a recording: 40 are enough, if they are spread over it
    raises  Error
    """
    vertices, triangles = _arrays(mesh)
    given = np.ascontiguousarray(shapes, np.float32)
    if given.ndim != 3 or given.shape[1:] != vertices.shape:
        raise ValueError(f"{mesh.name}: shapes have shape {given.shape}, not (S, {len(vertices)}, 3)")
    clusters, count, blend = np.empty(len(vertices), np.uint8), ctypes.c_uint32(), ctypes.c_uint32()
    call(core().tactus_find_clusters, vertices.ctypes.data, len(vertices), triangles.ctypes.data, len(triangles), given.ctypes.data,
         len(given), most, clusters.ctypes.data, ctypes.addressof(count), ctypes.addressof(blend), subject=mesh.name)
    return dataclasses.replace(mesh, clusters=clusters, blend=blend.value)


def _physics_of(name: str, of: Elastic) -> _abi.tactus_elastic_physics:
    """As C takes it; its arrays live as long."""
    tets = _whole(name, "tets", of.tets, np.uint32, 4)
    inner = np.ascontiguousarray(of.inner, np.float64).reshape(-1, 3)
    materials = np.ascontiguousarray(of.materials, np.float64).reshape(-1, 3)
    fixed = _whole(name, "fixed", of.fixed, np.uint32)
    material = None if of.material is None else _whole(name, "material", of.material, np.uint8)
    if material is not None and len(material) != len(tets):
        raise ValueError(f"{name}: {len(material)} numbers of materials for {len(tets)} tetrahedra")
    physics = init(_abi.tactus_elastic_physics())
    physics._kept = (tets, inner, materials, fixed, material)  # the struct only points to them
    physics.materials, physics.material_count = materials.ctypes.data, len(materials)
    physics.inner, physics.inner_count = inner.ctypes.data, len(inner)
    physics.tets, physics.tet_count = tets.ctypes.data, len(tets)
    physics.fixed, physics.fixed_count = fixed.ctypes.data, len(fixed)
    physics.material = None if material is None else material.ctypes.data
    physics.gravity = (ctypes.c_double * 3)(*of.gravity)
    if of.method not in _METHODS:
        raise ValueError(f"{name}: method {of.method!r} is none of {', '.join(_METHODS)}")
    physics.method = _METHODS[of.method]
    for part in ("mass_damping", "stiffness_damping", "coupling", "friction", "sub_steps"):
        setattr(physics, part, getattr(of, part))
    return physics


class _Builder(Handle):
    _destroy = "tactus_scene_builder_destroy"

    def __init__(self, options: SceneOptions) -> None:
        super().__init__()
        call(core().tactus_scene_builder_create, options, ctypes.byref(self._handle))

    def add_rigid(self, of: RigidObject) -> None:
        pose = _abi.tactus_pose((ctypes.c_double * 3)(*of.position), (ctypes.c_double * 4)(*of.rotation))
        options = init(_abi.tactus_rigid_options())
        options.initial, options.dof = pose, of.dof
        physics = init(_abi.tactus_driven_physics())
        if of.driven is not None:
            for field in dataclasses.fields(of.driven):
                value = getattr(of.driven, field.name)
                setattr(physics, field.name, (ctypes.c_double * 3)(*value) if field.name == "inertia" else value)
            options.driven = ctypes.addressof(physics)
        call(core().tactus_scene_builder_rigid, self.handle, text_of(of.name.encode()), options, subject=of.name)

    def add_mesh(self, of: Mesh) -> None:
        vertices, triangles = _arrays(of)
        options = init(_abi.tactus_deformable_options())
        options.frame_period, options.spring_modes, options.rings = of.frame_period, of.modes, of.rings
        clusters = np.ascontiguousarray(of.clusters if of.clusters is not None else [], np.uint8)
        if clusters.size:
            if clusters.shape != (len(vertices),) or not np.array_equal(clusters, of.clusters):
                raise ValueError(f"{of.name}: clusters are (V,) whole numbers from 0 to 63")
            options.clusters, options.cluster_count, options.blend = clusters.ctypes.data, int(clusters.max()) + 1, of.blend
        physics = None if of.elastic is None else _physics_of(of.name, of.elastic)
        options.elastic = None if physics is None else ctypes.addressof(physics)
        call(core().tactus_scene_builder_deformable, self.handle, text_of(of.name.encode()), vertices.ctypes.data, len(vertices),
             triangles.ctypes.data, len(triangles), options, subject=of.name)

    def build(self) -> Scene:
        scene = Scene()
        call(core().tactus_scene_builder_build, self.handle, ctypes.byref(scene._handle))
        return scene


def build_scene(objects: Sequence[RigidObject] = (), meshes: Sequence[Mesh] = (), rigid_bounds: RigidBounds | None = None,
                deformable_bounds: DeformableBounds | None = None, **options: Any) -> Scene:
    """Make a scene.

    rigid_bounds, deformable_bounds   that the sender will keep: given either, the scene declares both. Give the sender the same
    options                           fields of SceneOptions
    raises  Error
    """
    with _Builder(SceneOptions(**options)) as builder:
        for rigid in objects:
            builder.add_rigid(rigid)
        for mesh in meshes:
            builder.add_mesh(mesh)
        if rigid_bounds is not None or deformable_bounds is not None:
            call(core().tactus_scene_builder_declare_bounds, builder.handle, rigid_bounds, deformable_bounds, None)
        return builder.build()
