# SPDX-License-Identifier: Apache-2.0
"""Whole recordings: encode, decode, compare; tables of sweeps."""
from __future__ import annotations

import csv
import ctypes
import dataclasses
import os
import pathlib
import warnings
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import Handle, answer, call, traces
from .codec import Packet, Player, Sender, StreamWriter
from .options import DeformableBounds, RigidBounds, init
from .scene import Scene
from .trace import TraceReader


class Stream(bytes):
    """The bytes of a stream file."""

    def save(self, path: str | os.PathLike[str] | bytes) -> None:
        """Write the file."""
        pathlib.Path(os.fsdecode(path)).write_bytes(self)

    def decode(self, ticks: npt.ArrayLike | None = None, shapes: bool = False, **options: Any) -> Replica:  # type: ignore[override]
        """As tactus.decode()."""
        return decode(bytes(self), ticks, shapes, **options)

    def to_arrays(self, ticks: npt.ArrayLike | None = None, **options: Any) -> dict[str, npt.NDArray[np.float64]]:
        """What a client shows: "time" (T,) [s], and per rigid object, by its name, (T, 7) position 3 [m] and rotation 4 (w x y z)."""
        shown = self.decode(ticks, **options)
        with Player(bytes(self)) as player:
            names = [of.name for of in player.scene.objects]
        return {"time": shown.time, **{name: shown.poses[:, i] for i, name in enumerate(names)}}

    def __repr__(self) -> str:
        return f"Stream({len(self)} bytes)"


def encode(trace: str | os.PathLike[str] | bytes, rigid_bounds: RigidBounds | None = None, deformable_bounds: DeformableBounds | None = None,
           profile: str = "main", modes: int = 0, clusters: int = 0, world_size: float = 0, **options: Any) -> Stream:
    """Encode a trace, a path or the bytes of a file, as `tactus encode` does; returns the bytes of a stream file, which declares the bounds.

    profile   "main": look-ahead velocities, and clients smooth the errors of updates; "thesis": linear dead reckoning; and the
              profile of meshes
    modes     vibration modes that both ends compute from each mesh, its basis; 0: none
    clusters  of vertices that move alike, of each mesh at most, found on the trace: the basis of bodies that turn and walk; 0: none
    world_size  [m] how far from the origin positions get, along any axis; 0: 512 m
    options   of the sender: see SenderOptions
    raises    Error
    warns     RuntimeWarning: an object is held where it was last, as it breaks a rule; once for each
    """
    profiles = {"main": _abi.TACTUS_PROFILE_MAIN, "thesis": _abi.TACTUS_PROFILE_THESIS}
    if profile not in profiles:
        raise ValueError(f"there is no profile {profile!r}, but main and thesis")
    if modes and clusters:
        raise ValueError("a mesh has one basis: modes or clusters")
    is_reduced = options.get("reduction") != _abi.TACTUS_REDUCTION_NONE  # what goes out at every tick needs no smoothing
    coding = {"rigid_profile": profiles[profile if is_reduced else "thesis"], "deformable_profile": profiles[profile],
              "spring_modes": modes, "clusters": clusters, "world_size": world_size}
    with TraceReader(trace) as reader, reader.scene(rigid_bounds, deformable_bounds, **coding) as scene:
        with Sender(scene, rigid=rigid_bounds, deformable=deformable_bounds, **options) as sender, StreamWriter(scene) as writer:
            for frame in reader:
                for packet in sender.encode(frame.tick, frame.objects, frame.contacts, frame.shapes):
                    writer.add(packet)
                for part in sender.held:
                    if part.since == frame.tick:
                        warnings.warn(f"{part.name or 'a contact'}, tick {part.since}: {part.text} ({part.rule}): held where it was last. "
                                      f"{part.remedy}", RuntimeWarning, stacklevel=2)
            return Stream(writer.finish())


@dataclasses.dataclass(frozen=True, eq=False)
class Replica:
    """What a client shows; T ticks, N rigid objects, V vertices.

    ticks          (T,) int64
    poses          (T, N, 7) float64: position 3 [m], rotation 4 (w x y z); world frame
    displacements  per mesh (T, V, 3) float32 [m] from rest, if asked for
    packets        all packets, in order
    """
    tick_rate: int
    ticks: npt.NDArray[np.int64]
    poses: npt.NDArray[np.float64]
    displacements: list[npt.NDArray[np.float32]]
    packets: list[Packet]

    def __repr__(self) -> str:
        return (f"Replica({len(self.ticks)} ticks at {self.tick_rate} Hz, {self.poses.shape[1]} rigid objects, "
                f"{len(self.packets)} packets of {sum(packet.size for packet in self.packets)} bytes)")

    @property
    def time(self) -> npt.NDArray[np.float64]:
        """(T,) [s]"""
        return self.ticks / self.tick_rate

    @property
    def position(self) -> npt.NDArray[np.float64]:
        """(T, N, 3) [m] world"""
        return self.poses[..., 0:3]

    @property
    def rotation(self) -> npt.NDArray[np.float64]:
        """(T, N, 4) unit quaternions w x y z"""
        return self.poses[..., 3:7]


def decode(stream: str | os.PathLike[str] | bytes, ticks: npt.ArrayLike | None = None, shapes: bool = False, **options: Any) -> Replica:
    """Play a stream, a path or the bytes of a file.

    ticks    rising, at which it is shown; None: every tick up to that of the last packet, unless it is implausibly far for their bytes
    shapes   keep the displacements of meshes, too (T x V x 12 bytes)
    options  of the receiver: see ReceiverOptions
    raises   Error
    """
    with Player(stream, **options) as player:
        shown = _all_ticks(stream) if ticks is None else np.asarray(ticks, np.int64)
        scene = player.scene
        poses = np.empty((len(shown), len(scene.objects), 7))
        displacements = [np.empty((len(shown), len(mesh.vertices), 3), np.float32) for mesh in scene.meshes if shapes]
        packets: list[Packet] = []
        for i, tick in enumerate(shown.tolist()):
            packets += player.play(tick)
            poses[i] = player.poses(tick)
            for mesh, kept in enumerate(displacements):
                kept[i] = player.displacements(mesh, tick)
        return Replica(scene.tick_rate, shown, poses, displacements, packets)


def _all_ticks(stream: str | os.PathLike[str] | bytes) -> npt.NDArray[np.int64]:
    last, size = 0, 0
    with Player(stream) as player:
        while (tick := player.next_tick()) is not None:
            size += sum(packet.size for packet in player.play(tick))
            last = tick
    if last > 600_000 + 512 * size:  # as `tactus decode`: a few bytes must not ask for gigabytes
        raise ValueError(f"the last packet is at tick {last}, implausibly far for packets of {size} bytes in all; give the ticks")
    return np.arange(last + 1, dtype=np.int64)


@dataclasses.dataclass(frozen=True)
class ErrorSummary:
    """One kind of error over all ticks.

    ticks, ticks_over, longest_run  with a sample; with one over its bound; longest run of these
    rms, max                        in the unit of the quantity
    """
    ticks: int
    ticks_over: int
    longest_run: int
    rms: float
    max: float


@dataclasses.dataclass(frozen=True)
class MeshErrors:
    """Errors of a mesh: frames and vertices compared, those over their bound, rms and max [m], largest error over its bound."""
    frames: int
    vertices: int
    violations: int
    rms: float
    max: float
    worst_ratio: float


@dataclasses.dataclass(frozen=True)
class Comparison:
    """A replica against the truth.

    position [m], rotation [rad], force [N] of the contact itself against the haptic rule, perceived [N]: the same errors against
    what people notice; worst_haptic_ratio: largest error of a force over the permitted one; meshes: one per mesh
    """
    position: ErrorSummary
    rotation: ErrorSummary
    force: ErrorSummary
    perceived: ErrorSummary
    worst_haptic_ratio: float
    meshes: list[MeshErrors]

    @property
    def holds(self) -> bool:
        """All bounds hold at every tick."""
        return not (self.position.ticks_over or self.rotation.ticks_over or self.force.ticks_over or
                    any(mesh.violations for mesh in self.meshes))


class _Errors(Handle):
    _destroy = "tactus_errors_destroy"
    _library = staticmethod(traces)

    def __init__(self, truth: TraceReader, rigid: RigidBounds, deformable: DeformableBounds, scene: Scene) -> None:
        super().__init__()
        options = init(_abi.tactus_errors_options(), traces().tactus_trace_init)
        options.rigid, options.deformable = ctypes.addressof(rigid), ctypes.addressof(deformable)
        options.position_exp = scene.info.position_exp
        options.rings = scene.meshes[0].rings if truth.meshes else options.rings
        call(traces().tactus_errors_create, truth.handle, options, ctypes.byref(self._handle))

    def add(self, truth: TraceReader, player: Player, tick: int) -> None:
        poses = player.poses(tick)
        shown = [player.displacements(mesh, tick) for mesh in range(len(truth.meshes))]
        shapes = (_abi.tactus_shape * len(shown))()
        for shape, displacements in zip(shapes, shown):
            shape.displacements, shape.vertices = displacements.ctypes.data, len(displacements)
        call(traces().tactus_errors_add, self.handle, truth.handle, poses.ctypes.data, len(poses), ctypes.addressof(shapes), len(shapes))

    def summary(self, quantity: int, mesh: int = 0) -> Any:
        out = answer(_abi.tactus_error_summary)
        call(traces().tactus_errors_get, self.handle, quantity, mesh, out)
        return out

    def mesh(self, index: int) -> MeshErrors:
        out = self.summary(_abi.TACTUS_ERROR_SHAPE, index)
        return MeshErrors(out.ticks, out.vertices, out.violations, out.rms, out.max, out.worst_ratio)


def compare(trace: str | os.PathLike[str] | bytes, stream: str | os.PathLike[str] | bytes, rigid_bounds: RigidBounds | None = None,
            deformable_bounds: DeformableBounds | None = None, **options: Any) -> Comparison:
    """Play a stream and hold what is shown at each tick of a trace against it.

    rigid_bounds, deformable_bounds   None: those that the stream declares, else the defaults
    options                           of the receiver: see ReceiverOptions
    raises                            Error
    """
    with TraceReader(trace) as truth, Player(stream, **options) as player, player.scene as scene:
        rigid = rigid_bounds or scene.rigid_bounds or RigidBounds()
        deformable = deformable_bounds or (scene.deformable_bounds() if truth.meshes else None) or DeformableBounds()
        with _Errors(truth, rigid, deformable, scene) as errors:
            for frame in truth:
                player.play(frame.tick)
                errors.add(truth, player, frame.tick)
            found = [errors.summary(i) for i in range(4)]
            series = [ErrorSummary(s.ticks, s.ticks_over, s.longest_run, s.rms, s.max) for s in found]
            return Comparison(*series, found[_abi.TACTUS_ERROR_FORCE].worst_ratio, [errors.mesh(i) for i in range(len(truth.meshes))])


def read_table(path: str | os.PathLike[str] | bytes) -> dict[str, npt.NDArray[Any]]:
    """A table that `tactus sweep` or `tactus bench` wrote (points.csv), by columns.

    Columns of numbers become float64, with percentages such as "2.5%" as fractions (0.025) and empty cells as NaN; others stay text.
    """
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: _column([row[name] or "" for row in rows]) for name in (rows[0] if rows else {})}


def _column(cells: list[str]) -> npt.NDArray[Any]:
    try:
        return np.array([float("nan") if not c else float(c[:-1]) / 100 if c.endswith("%") else float(c) for c in cells])
    except ValueError:
        return np.array(cells)
