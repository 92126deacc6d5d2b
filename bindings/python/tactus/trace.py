# SPDX-License-Identifier: Apache-2.0
"""Traces: what truly happened, tick by tick."""
from __future__ import annotations

import ctypes
import dataclasses
import os
from typing import Any, Iterator

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import Handle, answer, bytes_of, call, read_bytes, text_of, traces
from .codec import Shape
from .options import DeformableBounds, RigidBounds
from .scene import Mesh, Scene

#: One user at one tick: device (position (3) [m], orientation (4), velocity (3) [m/s], buttons, time [ns]); contact as CONTACT;
#: force (3) [N] as felt and server_force (3) [N] of the true state: see TraceReader.known_forces; touches_mesh, mesh, triangle,
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
    return frozenset(name for name, bit in (("felt", _abi.TACTUS_FORCE_FELT), ("server", _abi.TACTUS_FORCE_SERVER)) if bits & bit)


class TraceReader(Handle):
    """Reads a trace file frame by frame, in little memory: `for frame in reader`, once. A path, "-" for standard input, or the bytes of a
    file."""

    _destroy = "tactus_trace_destroy"
    _library = staticmethod(traces)

    def __init__(self, file: str | os.PathLike[str] | bytes) -> None:
        super().__init__()
        if isinstance(file, (bytes, bytearray, memoryview)):
            self._subject, self._bytes = "", bytes_of(file)  # the trace reads them in place
            call(traces().tactus_trace_open_memory, self._bytes, len(self._bytes), ctypes.byref(self._handle))
        else:
            self._subject = os.fspath(file)
            call(traces().tactus_trace_open, text_of(os.fsencode(file)), ctypes.byref(self._handle), subject=self._subject)
        info = answer(_abi.tactus_trace_info)
        call(traces().tactus_trace_get, self.handle, info)
        self.tick_rate: int = info.tick_rate  #: ticks per second
        self.source: str = info.source.decode()  #: "sim push-1dof seed 1"
        self.frames: int | None = info.frames if info.has_frames else None  #: how many, if the file tells
        objects = self._told(traces().tactus_trace_get_object, _abi.tactus_trace_object, info.objects)
        users = self._told(traces().tactus_trace_get_user, _abi.tactus_trace_user, info.users)
        self.objects: list[str] = [told.name.decode() for told in objects]
        self.users: list[str] = [told.name.decode() for told in users]
        #: per user: "felt", if it is known what the hand felt, else `force` is the server's; "server", if the server's force is
        #: known, else `server_force` is 0. A server is not told the one, a client not the other
        self.known_forces: list[frozenset[str]] = [_names_of_forces(told.forces) for told in users]
        self.meshes: list[Mesh] = [self._mesh(i) for i in range(info.meshes)]

    def _told(self, function: Any, structure: Any, count: int) -> list[Any]:
        out = [answer(structure) for _ in range(count)]
        for i, info in enumerate(out):
            call(function, self.handle, i, info)
        return out

    def _mesh(self, index: int) -> Mesh:
        info = answer(_abi.tactus_trace_mesh)
        call(traces().tactus_trace_get_mesh, self.handle, index, info)
        rest, triangles = np.empty((info.vertices, 3)), np.empty((info.triangles, 3), np.uint32)
        call(traces().tactus_trace_get_rest, self.handle, index, rest.ctypes.data, rest.size)
        call(traces().tactus_trace_get_triangles, self.handle, index, triangles.ctypes.data, triangles.size)
        return Mesh(info.name.decode(), rest, triangles, info.period)

    def scene(self, rigid_bounds: RigidBounds | None = None, deformable_bounds: DeformableBounds | None = None, **coding: int) -> Scene:
        """The scene of the trace, before the first frame is read.

        rigid_bounds, deformable_bounds   that the scene declares
        coding                            rigid_profile and deformable_profile (PROFILE_MAIN or _THESIS), baselines, spring_modes, clusters
        """
        options = _abi.tactus_trace_coding()
        traces().tactus_trace_coding_init(options, ctypes.sizeof(options))
        for name, value in coding.items():
            if name not in ("rigid_profile", "deformable_profile", "baselines", "spring_modes", "clusters"):
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
                        subject=self._subject):
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
        return bool(traces().tactus_trace_cut_short(self.handle))


@dataclasses.dataclass(frozen=True, eq=False)
class Trace:
    """A whole trace as arrays; T ticks, N rigid objects, U users, V vertices.

    tick_rate     ticks per second
    ticks         (T,) int64, rising
    objects       (T, N, 13) float64, as Frame.objects
    users         (T, U) of dtype USER
    shapes        per mesh: ticks (F,) int64 at which its shape is new, and displacements (F, V, 3) float32 [m] from rest
    known_forces  per user, as TraceReader.known_forces
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
    known_forces: list[frozenset[str]]

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
        """(T, U, 3) [N] as the hands felt it, world; the server's of users without "felt" in known_forces"""
        return self.users["force"]

    @property
    def device(self) -> npt.NDArray[np.float64]:
        """(T, U, 3) [m] places of the devices, world"""
        return self.users["device"]["position"]


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
                     reader.known_forces)
