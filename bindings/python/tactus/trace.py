# SPDX-License-Identifier: Apache-2.0
"""Traces: what truly happened, tick by tick."""
from __future__ import annotations

import ctypes
import dataclasses
import os
import pathlib
import tempfile
from typing import Any, Iterator

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import Error, Handle, answer, bytes_of, call, path_of, read_bytes, text_of, traces
from .arrays import write_arrays
from .codec import Shape
from .options import DeformableBounds, RigidBounds, init
from .scene import Mesh, Scene

#: One user at one tick: device (position (3) [m], orientation (4), velocity (3) [m/s], buttons, time [ns]); contact as CONTACT;
#: force (3) [N] as rendered to the hand and server_force (3) [N] of the true state: see TraceReader.recorded_forces; touches_mesh, mesh, triangle,
#: weights (3), proxy (3) [m], mesh_normal (3), mesh_stiffness [N/m]. World frame.
USER = np.dtype(_abi.tactus_user_sample)


@dataclasses.dataclass(frozen=True, eq=False)
class Frame:
    """The truth of one tick.

    objects  (N, 13) float64, one row per rigid object: position 3 [m], rotation 4 (w x y z), velocity 3 [m/s], angular velocity 3
             [rad/s]; world frame
    users    (U,) of dtype USER
    shapes   one per mesh
    """
    tick: int
    objects: npt.NDArray[np.float64]
    users: npt.NDArray[np.void]
    shapes: list[Shape]

    @property
    def contacts(self) -> npt.NDArray[np.void]:
        """(C,) of dtype CONTACT: of users who touch a rigid object, as Sender.encode takes them."""
        contacts = self.users["contact"]
        return contacts[contacts["kind"] != _abi.TACTUS_CONTACT_NONE]


def _names_of_forces(bits: int) -> frozenset[str]:
    return frozenset(name for name, bit in (("rendered", _abi.TACTUS_FORCE_RENDERED), ("server", _abi.TACTUS_FORCE_SERVER)) if bits & bit)


def _copied(address: int | None, rows: int, kind: Any, dtype: Any) -> npt.NDArray[Any]:
    """Rows of three that the library holds."""
    if not rows:
        return np.empty((0, 3), dtype)
    return np.ctypeslib.as_array(ctypes.cast(address, ctypes.POINTER(kind)), (rows, 3)).copy()


class TraceReader(Handle):
    """Reads a trace file frame by frame, in little memory: `for frame in reader`, once. A path, "-" for standard input, or the bytes of a
    file."""

    _destroy = "tactus_trace_destroy"
    _library = staticmethod(traces)

    def __init__(self, file: str | os.PathLike[str] | bytes) -> None:
        super().__init__()
        path = path_of(file)
        if path is None:
            self._subject, self._bytes = "", bytes_of(file)  # the trace reads them in place
            call(traces().tactus_trace_open, None, self._bytes, len(self._bytes), ctypes.byref(self._handle), says_all=True)
        else:
            self._subject = path
            call(traces().tactus_trace_open, text_of(os.fsencode(path)), None, 0, ctypes.byref(self._handle), subject=self._subject,
                 says_all=True)
        info = self._info()
        self.tick_rate: int = info.tick_rate  #: ticks per second
        self.source: str = info.source.decode()  #: "sim push-1dof seed 1"
        self.frames: int | None = info.frames if info.has_frames else None  #: how many, if the file states it
        objects = self._entries(traces().tactus_trace_get_object, _abi.tactus_trace_object, info.objects)
        users = self._entries(traces().tactus_trace_get_user, _abi.tactus_trace_user, info.users)
        self.dofs: list[int] = [entry.dof for entry in objects]  #: axes that each object can move along and about
        self.senses: list[int] = [entry.senses for entry in users]  #: of each device, beside its position: 1 orientation, 2 velocity, 4 buttons, 8 time
        self.objects: list[str] = [entry.name.decode() for entry in objects]
        self.users: list[str] = [entry.name.decode() for entry in users]
        #: per user: "rendered", if the force rendered to the hand is known, else `force` is the server's; "server", if the server's force is
        #: known, else `server_force` is 0. A server does not receive the one, a client not the other
        self.recorded_forces: list[frozenset[str]] = [_names_of_forces(entry.forces) for entry in users]
        self.meshes: list[Mesh] = [self._mesh(i) for i in range(info.meshes)]

    def _info(self) -> _abi.tactus_trace_info:
        info = answer(_abi.tactus_trace_info)
        call(traces().tactus_trace_get, self.handle, info)
        return info

    def _entries(self, function: Any, structure: Any, count: int) -> list[Any]:
        out = [answer(structure) for _ in range(count)]
        for i, info in enumerate(out):
            call(function, self.handle, i, info)
        return out

    def _mesh(self, index: int) -> Mesh:
        info = answer(_abi.tactus_trace_mesh)
        call(traces().tactus_trace_get_mesh, self.handle, index, info)
        rest = _copied(info.rest, info.vertices, ctypes.c_double, np.float64)
        triangles = _copied(info.corners, info.triangles, ctypes.c_uint32, np.uint32)
        return Mesh(info.name.decode(), rest, triangles, info.period)

    def scene(self, rigid_bounds: RigidBounds | None = None, deformable_bounds: DeformableBounds | None = None, **coding: float) -> Scene:
        """The scene of the trace, before the first frame is read.

        rigid_bounds, deformable_bounds   that the scene declares
        coding                            rigid_profile and deformable_profile (PROFILE_MAIN or _THESIS), baselines, spring_modes, clusters,
                                          world_size [m]
        """
        options = init(_abi.tactus_trace_coding(), traces().tactus_trace_init)
        for name, value in coding.items():
            if name not in ("rigid_profile", "deformable_profile", "baselines", "spring_modes", "clusters", "world_size"):
                raise TypeError(f"scene() has no argument {name!r}")
            setattr(options, name, value)
        rigid, deformable = rigid_bounds or RigidBounds(), deformable_bounds or DeformableBounds()
        options.rigid, options.deformable = ctypes.addressof(rigid), ctypes.addressof(deformable)
        return Scene(read_bytes(traces().tactus_trace_scene, self.handle, options, subject=self._subject))

    def __iter__(self) -> Iterator[Frame]:
        tick = ctypes.c_int64()
        next_frame = traces().tactus_trace_next
        while True:
            objects, users = np.empty((len(self.objects), 13)), np.empty(len(self.users), USER)
            if not call(next_frame, self.handle, ctypes.byref(tick), objects.ctypes.data, len(objects), users.ctypes.data, len(users),
                        subject=self._subject, says_all=True):
                return
            yield Frame(tick.value, objects, users, [self._shape(i) for i in range(len(self.meshes))])

    def _shape(self, index: int) -> Shape:
        shape = _abi.tactus_shape()
        call(traces().tactus_trace_shape, self.handle, index, ctypes.byref(shape))
        displacements = None
        if shape.displacements:
            values = ctypes.cast(shape.displacements, ctypes.POINTER(ctypes.c_float))
            displacements = np.ctypeslib.as_array(values, (shape.vertices, 3)).copy()
        return Shape(displacements, shape.triangle if shape.touched else None, shape.force, shape.stiffness)

    @property
    def cut_short(self) -> bool:
        """The file ends early. Valid after the last frame."""
        return bool(self._info().cut_short)


@dataclasses.dataclass(frozen=True, eq=False)
class Trace:
    """A whole trace as arrays; T ticks, N rigid objects, U users, V vertices.

    tick_rate     ticks per second
    ticks         (T,) int64, rising
    objects       (T, N, 13) float64, as Frame.objects
    users         (T, U) of dtype USER
    shapes        per mesh: ticks (F,) int64 at which its shape is new, and displacements (F, V, 3) float32 [m] from rest
    recorded_forces  per user, as TraceReader.recorded_forces
    notes         what was decided where arrays left it open: missing samples, times off the grid
    dofs, senses  as TraceReader.dofs, .senses; None: all axes, no senses
    """
    source: str
    tick_rate: int
    object_names: list[str]
    user_names: list[str]
    meshes: list[Mesh]
    ticks: npt.NDArray[np.int64]
    objects: npt.NDArray[np.float64]
    users: npt.NDArray[np.void]
    shapes: list[tuple[npt.NDArray[np.int64], npt.NDArray[np.float32]]]
    recorded_forces: list[frozenset[str]]
    notes: list[str] = dataclasses.field(default_factory=list)
    dofs: list[int] | None = None
    senses: list[int] | None = None

    @classmethod
    def from_arrays(cls, time: Any = None, poses: Any = None, wrenches: Any = None, devices: Any = None, *, contacts: Any = None,
                    order: str = "wxyz", time_unit: str | None = None, tick_rate: int | None = None, gap: float = 0.1,
                    source: str = "arrays") -> Trace:
        """A trace of samples that are in memory.

        time       (T,) seconds (floats), datetime64 (or a column or index of times of pandas), or whole nanoseconds; time_unit "s", "ms", "us" or "ns" says otherwise. None: evenly
                   spaced at tick_rate
        poses      name -> (T, 3) positions [m], (T, 7) positions and quaternions, a tuple of (T, 3) and (T, 4), or a data frame with columns
                   x, y, z and qw, qx, qy, qz; without a name "object". World frame, right-handed
        wrenches   name -> (T, 3) force on the user [N], (T, 6) with the torque, which is left out, or columns fx, fy, fz; else "user"
        devices    name -> positions of the devices [m], with or without rotations, as poses
        contacts   user -> (object, stiffness [N/m]) or (object, stiffness, "plane" or "spring"): what the user touched. It gives the
                   recorded forces a bound: each stretches a spring between the device, or the object's origin if the user has none, and the
                   object; what lies along the force counts, or ("spring", as of a grip) the whole vector
        order      of quaternions in arrays: "wxyz" or "xyzw"
        tick_rate  [1/s]; None: found from the times
        gap        [s] missing samples (NaN, a rotation of length 0) are interpolated over so much; else the last one is held
        raises     Error, with the array and the row
        """
        data, notes = write_arrays(time, poses, wrenches, devices, contacts, order, time_unit, tick_rate, gap, source)
        return dataclasses.replace(read_trace(data), notes=notes)

    def save(self, path: str | os.PathLike[str] | bytes) -> None:
        """Write a trace file (MCAP).   raises  Error"""
        with _Writer(path, self) as writer:
            try:
                writer.write(self)
            except Error:
                writer.close()
                pathlib.Path(os.fsdecode(path)).unlink(missing_ok=True)
                raise

    def to_bytes(self) -> bytes:
        """The bytes of a trace file."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "trace.mcap")
            self.save(path)
            return path.read_bytes()

    def encode(self, rigid_bounds: RigidBounds | None = None, deformable_bounds: DeformableBounds | None = None, **options: Any) -> Any:
        """As tactus.encode(); returns a Stream."""
        from .run import encode

        return encode(self.to_bytes(), rigid_bounds, deformable_bounds, **options)

    def __repr__(self) -> str:
        return (f"Trace({len(self.ticks)} ticks at {self.tick_rate} Hz, objects {self.object_names}, users {self.user_names}, "
                f"{len(self.meshes)} meshes, {len(self.notes)} notes)")

    @property
    def time(self) -> npt.NDArray[np.float64]:
        """(T,) [s]"""
        return self.ticks / self.tick_rate

    @property
    def position(self) -> npt.NDArray[np.float64]:
        """(T, N, 3) [m] world"""
        return self.objects[..., 0:3]

    @property
    def rotation(self) -> npt.NDArray[np.float64]:
        """(T, N, 4) unit quaternions w x y z, object to world"""
        return self.objects[..., 3:7]

    @property
    def velocity(self) -> npt.NDArray[np.float64]:
        """(T, N, 3) [m/s] world"""
        return self.objects[..., 7:10]

    @property
    def angular_velocity(self) -> npt.NDArray[np.float64]:
        """(T, N, 3) [rad/s] world"""
        return self.objects[..., 10:13]

    @property
    def force(self) -> npt.NDArray[np.float64]:
        """(T, U, 3) [N] rendered to the hands, world; the server's of users without "rendered" in recorded_forces"""
        return self.users["force"]

    @property
    def device(self) -> npt.NDArray[np.float64]:
        """(T, U, 3) [m] positions of the devices, world"""
        return self.users["device"]["position"]


class _Writer(Handle):
    _destroy = "tactus_trace_writer_destroy"
    _library = staticmethod(traces)

    def __init__(self, path: str | os.PathLike[str] | bytes, of: Trace) -> None:
        super().__init__()
        self._subject = os.fsdecode(path)
        library = traces()
        call(library.tactus_trace_writer_create, text_of(os.fsencode(path)), of.tick_rate, text_of(of.source.encode()), ctypes.byref(self._handle))
        for name, dof in zip(of.object_names, of.dofs or [63] * len(of.object_names)):
            entry = answer(_abi.tactus_trace_object)
            entry.name, entry.dof = text_of(name.encode()), dof
            call(library.tactus_trace_writer_declare, self.handle, entry, None, None, subject=name)
        for name, senses, known in zip(of.user_names, of.senses or [0] * len(of.user_names), of.recorded_forces):
            user = answer(_abi.tactus_trace_user)
            user.name, user.senses = text_of(name.encode()), senses
            user.forces = (_abi.TACTUS_FORCE_RENDERED if "rendered" in known else 0) | (_abi.TACTUS_FORCE_SERVER if "server" in known else 0)
            call(library.tactus_trace_writer_declare, self.handle, None, user, None, subject=name)
        for mesh in of.meshes:
            rest, triangles = np.ascontiguousarray(mesh.vertices, np.float64), np.ascontiguousarray(mesh.triangles, np.uint32)
            surface = answer(_abi.tactus_trace_mesh)
            surface.name, surface.period = text_of(mesh.name.encode()), mesh.frame_period
            surface.rest, surface.vertices, surface.corners, surface.triangles = rest.ctypes.data, len(rest), triangles.ctypes.data, len(triangles)
            call(library.tactus_trace_writer_declare, self.handle, None, None, surface, subject=mesh.name)

    def write(self, of: Trace) -> None:
        objects, users = np.ascontiguousarray(of.objects, np.float64), np.ascontiguousarray(of.users, USER)
        news = [dict(zip(at.tolist(), shapes)) for at, shapes in of.shapes]
        for i, tick in enumerate(of.ticks.tolist()):
            forms = (_abi.tactus_shape * len(news))()
            kept = [np.ascontiguousarray(new[tick], np.float32) if tick in new else None for new in news]
            for form, shape in zip(forms, kept):
                if shape is not None:
                    form.displacements, form.vertices = shape.ctypes.data, len(shape)
            call(traces().tactus_trace_writer_add, self.handle, tick, objects[i].ctypes.data, objects.shape[1], users[i].ctypes.data,
                 users.shape[1], ctypes.addressof(forms), len(forms), subject=f"{self._subject}, tick {tick}")
        call(traces().tactus_trace_writer_finish, self.handle, subject=self._subject)


def read_trace(file: str | os.PathLike[str] | bytes) -> Trace:
    """Read a whole trace, a path or the bytes of a file.   raises  Error: R-TRC"""
    with TraceReader(file) as reader:
        ticks, objects, users = [], [], []
        shapes: list[tuple[list[int], list[Any]]] = [([], []) for _ in reader.meshes]
        for frame in reader:
            ticks.append(frame.tick)
            objects.append(frame.objects)
            users.append(frame.users)
            for (at, kept), shape in zip(shapes, frame.shapes):
                if shape.displacements is not None:
                    at.append(frame.tick)
                    kept.append(shape.displacements)
        return Trace(reader.source, reader.tick_rate, reader.objects, reader.users, reader.meshes, np.array(ticks, np.int64),
                     np.array(objects).reshape(len(ticks), len(reader.objects), 13),
                     np.array(users, USER).reshape(len(ticks), len(reader.users)),
                     [(np.array(at, np.int64), np.array(kept, np.float32).reshape(len(at), len(mesh.vertices), 3))
                      for (at, kept), mesh in zip(shapes, reader.meshes)],
                     reader.recorded_forces, [], reader.dofs, reader.senses)
