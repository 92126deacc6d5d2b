# SPDX-License-Identifier: Apache-2.0
"""Truth in, packets out; packets in, a replica out; stream files."""
from __future__ import annotations

import ctypes
import dataclasses
import os
import pathlib
from typing import Any, Sequence, overload

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import PACKET_TICK, Handle, answer, bytes_of, call, core, described, handle_of, path_of, read_bytes
from .options import ReceiverOptions, SenderOptions
from .scene import Scene

END = (1 << 63) - 1  # no packet comes after it
KINDS = ("rigid", "deformable", "load")
LAYERS = ("haptic", "visual", "all")
REASONS = ("request", "heartbeat", "visual", "haptic")

CONTACT = np.dtype(_abi.tactus_contact)  #: kind, object, point (3) [m] object frame, normal (3), device (3) [m] world, stiffness [N/m]


@dataclasses.dataclass(frozen=True)
class Packet:
    """A packet that was sent or decoded.

    data       its bytes; empty for one that was decoded
    size       [bytes]
    number     which is not in its bytes: above 0; of a Sender, and mostly of a file, those of each substream count from 1
    kind       "rigid", "deformable" or "load"
    key        it builds on the initial state
    reason     of rigid objects: the strongest among the updates
    layer      of deformable objects
    updates    objects named, or vertices with a residual of their own
    substream  0: rigid objects; i + 1: mesh i; the next: loads
    offset     in the file that it was played from
    """
    data: bytes
    size: int
    tick: int
    number: int
    kind: str
    key: bool
    reason: str
    layer: str
    updates: int
    substream: int
    offset: int

    @classmethod
    def _of(cls, info: Any, data: bytes = b"", offset: int = 0) -> Packet:
        return cls(data, info.bytes, info.tick, info.number, KINDS[info.kind], bool(info.key), REASONS[info.reason],
                   LAYERS[info.layer], info.updates, info.substream, offset)

    @classmethod
    def _sent(cls, packet: Any) -> Packet:
        return cls._of(packet, ctypes.string_at(packet.data, packet.bytes))


def _number(number: int) -> int:
    """ctypes would take 2^64 + 1 as 1; what the library refuses in 64 bits is left to it."""
    if not 0 <= number < 1 << 64:
        raise ValueError(f"a packet's number is above 0 and below 2^62, not {number}")
    return number


def _data_of(packet: Packet) -> bytes:
    if len(packet.data) != packet.size:
        raise ValueError("this packet has no bytes: give one that a Sender coded, or replace its data")
    return packet.data


PARTS = ("object", "contact", "shape", "touch", "load")


@dataclasses.dataclass(frozen=True)
class Held:
    """A part of the truth that breaks a rule. It does not stop the others: what it was before is coded, at rest, until it breaks none.

    part    "object", "contact", "shape", "touch" or "load"
    index   of the object, or of the contact
    name    of the object; empty: of a contact
    since   tick
    rule    that it breaks, such as "R-API-1"
    text    what is wrong;  remedy  how to fix it
    """
    part: str
    index: int
    name: str
    since: int
    rule: str
    text: str
    remedy: str


@dataclasses.dataclass(frozen=True, eq=False)
class Shape:
    """A mesh at one tick.

    displacements  (V, 3) float32 [m] from rest, world; None: no new shape
    triangle       that is touched, None: none;  force [N] and stiffness [N/m] of the touch
    """
    displacements: npt.NDArray[np.float32] | None
    triangle: int | None = None
    force: float = 0
    stiffness: float = 500


def _array(values: npt.ArrayLike | None, columns: int, what: str) -> npt.NDArray[np.float64]:
    out = np.ascontiguousarray(values if values is not None else np.empty((0, columns)), np.float64)
    if out.ndim != 2 or out.shape[1] != columns:
        raise ValueError(f"{what} have shape {out.shape}, not (objects, {columns}): a row is x y z [m], w x y z, velocity [m/s] and angular "
                         "velocity [rad/s]. Where your source has none: the change since the tick before times tick_rate")
    return out


class Sender(Handle):
    """Decides at every tick which states must be sent, and codes them. Options: keyword arguments of SenderOptions."""

    _destroy = "tactus_sender_destroy"

    def __init__(self, scene: Scene, **options: Any) -> None:
        super().__init__()
        self._options = SenderOptions(**options)
        #: parts of the last tick's truth that break a rule and are held, mostly none
        self.held: list[Held] = []
        call(core().tactus_sender_create, handle_of(scene, Scene), self._options, ctypes.byref(self._handle))

    def encode(self, tick: int, objects: npt.ArrayLike | None = None, contacts: npt.NDArray[np.void] | None = None,
               shapes: Sequence[Shape] = (), moved: npt.ArrayLike | None = None, number: int | None = None) -> list[Packet]:
        """Evaluate a tick and code the packets it needs, mostly none.

        tick      rising
        objects   (N, 13) float64, one row per rigid object of the scene: position 3 [m], rotation 4 (w x y z), velocity 3 [m/s],
                  angular velocity 3 [rad/s]; world frame
        contacts  (C,) of dtype CONTACT, of rigid objects, any number
        shapes    one per mesh of the scene, or none
        moved     indices of the objects whose row is not that of the tick before: what rests then costs the encoder nothing. None: all rows are
                  compared. An object that moves and is not named is not sent
        number    of the packets of this tick, above that of any packet before, as a transport numbers what it sends; a second packet of a
                  mesh has number + 1. None: each substream counts on, from 1
        raises    Error: a wrong count or tick. One bad row is no error: see held
        """
        states = _array(objects, 13, "objects")
        touched = np.ascontiguousarray(contacts if contacts is not None else np.empty(0, CONTACT), CONTACT)
        if touched.ndim != 1:
            raise ValueError(f"contacts have shape {touched.shape}, not (C,)")
        forms = (_abi.tactus_shape * len(shapes))()
        kept = [_fill_shape(form, shape) for form, shape in zip(forms, shapes)]
        truth = answer(_abi.tactus_truth)
        truth.objects, truth.object_count = states.ctypes.data, len(states)
        truth.contacts, truth.contact_count = touched.ctypes.data, len(touched)
        truth.shapes, truth.shape_count = ctypes.addressof(forms), len(forms)
        named = np.ascontiguousarray(moved if moved is not None else (), np.uint32)
        if named.ndim != 1:
            raise ValueError(f"moved has shape {named.shape}, not (M,)")
        if moved is not None:
            truth.moved, truth.moved_count = named.ctypes.data, len(named)
        if number is not None:
            if number == 0:
                raise ValueError("a packet's number is above 0")  # which C takes as: counted
            truth.number = _number(number)
        encoded = answer(_abi.tactus_encoded)
        self.held = []
        call(core().tactus_sender_encode, self.handle, tick, truth, encoded)
        del kept
        if encoded.held_count:
            self.held = [_held(part) for part in _items(_abi.tactus_held, encoded.held, encoded.held_count)]
        if not encoded.packet_count:
            return []
        return [Packet._sent(packet) for packet in _items(_abi.tactus_packet, encoded.packets, encoded.packet_count)]

    def request_key(self) -> None:
        """A receiver asks for a key packet."""
        call(core().tactus_sender_request_key, self.handle)

    def acknowledge(self, packet: Packet) -> None:
        """A receiver has decoded this packet."""
        call(core().tactus_sender_acknowledge, self.handle, packet.substream, packet.number)

    def set_link(self, answer_ticks: int, loss: float) -> None:
        """The link to the receiver: ticks until a packet is acknowledged (0: not known), and the fraction that is lost."""
        call(core().tactus_sender_set_link, self.handle, answer_ticks, loss)


def _items(structure: Any, address: int, count: int) -> Any:
    """Structs that the library holds."""
    return (structure * count).from_address(address)


def _held(part: Any) -> Held:
    error = described(_abi.TACTUS_INVALID_ARGUMENT, part.rule)
    return Held(PARTS[part.part], part.index, part.name.decode(), part.since, part.rule.decode(), error.text.decode(), error.remedy.decode())


def _fill_shape(form: Any, shape: Shape) -> npt.NDArray[np.float32] | None:
    """Fill the struct; what is returned must live as long as it is used."""
    if shape.triangle is not None:
        form.touched, form.triangle, form.force, form.stiffness = 1, shape.triangle, shape.force, shape.stiffness
    if shape.displacements is None:
        return None
    values = np.ascontiguousarray(shape.displacements, np.float32)
    if values.ndim != 2 or values.shape[1] != 3:
        raise ValueError(f"displacements have shape {values.shape}, not (V, 3)")
    form.displacements, form.vertices = values.ctypes.data, len(values)
    return values


class _Shown:
    """What a client shows."""

    def _receiver(self) -> Any:
        raise NotImplementedError

    @property
    def scene(self) -> Scene:
        """A copy of its own."""
        return Scene._borrowed(core().tactus_receiver_scene(self._receiver()), self)

    def _count_of(self) -> _abi.tactus_scene_info:
        info = answer(_abi.tactus_scene_info)
        call(core().tactus_scene_get, core().tactus_receiver_scene(self._receiver()), info)
        return info

    def poses(self, tick: int) -> npt.NDArray[np.float64]:
        """(N, 7) float64 at this tick, one row per rigid object: position 3 [m], rotation 4 (w x y z); world frame."""
        out = np.empty((self._rigid, 7))
        call(core().tactus_receiver_poses, self._receiver(), tick, 0, len(out), out.ctypes.data, None)
        return out

    def displacements(self, mesh: int, tick: int) -> npt.NDArray[np.float32]:
        """(V, 3) float32 [m] from rest at this tick, world frame."""
        if not 0 <= mesh < len(self._vertices):
            raise IndexError(f"there are {len(self._vertices)} meshes")
        out = np.empty((self._vertices[mesh], 3), np.float32)
        call(core().tactus_receiver_displacements, self._receiver(), mesh, tick, out.ctypes.data, out.size)
        return out

    def state_hash(self, substream: int = 0) -> int:
        """Hash of the newest state of a substream; equals that of the sender."""
        out = ctypes.c_uint64()
        call(core().tactus_receiver_hash, self._receiver(), substream, ctypes.byref(out), 0, None)
        return out.value

    def pose_hash(self, tick: int) -> int:
        """Hash of every pose as shown at a tick."""
        out = ctypes.c_uint64()
        call(core().tactus_receiver_hash, self._receiver(), 0, None, tick, ctypes.byref(out))
        return out.value

    def _count(self) -> None:
        info = self._count_of()
        self._rigid: int = info.rigid
        self._vertices: list[int] = []
        for i in range(info.deformables):
            mesh = answer(_abi.tactus_deformable_info)
            call(core().tactus_scene_get_deformable, core().tactus_receiver_scene(self._receiver()), i, mesh)
            self._vertices.append(mesh.vertices)


class Receiver(Handle, _Shown):
    """Packets in, a replica out. Options: keyword arguments of ReceiverOptions."""

    _destroy = "tactus_receiver_destroy"

    def __init__(self, scene: Scene, **options: Any) -> None:
        super().__init__()
        call(core().tactus_receiver_create, handle_of(scene, Scene), ReceiverOptions(**options), ctypes.byref(self._handle))
        self._count()

    def _receiver(self) -> Any:
        return self.handle

    @overload
    def push(self, packet: Packet, /, *, now: int | None = None) -> Packet: ...

    @overload
    def push(self, number: int, data: bytes, /, now: int | None = None) -> Packet: ...

    def push(self, packet: Packet | int, data: bytes | None = None, /, now: int | None = None) -> Packet:
        """Decode a packet: push(packet) of a Sender in this program, push(number, data) from a network.

        packet  as the Sender made it, or its number: above 0, below 2^62. It is not in the bytes: send both. A sender that restarts counts
                anew, so its packets go to a new Receiver
        now     [ticks] of the client, when the replica applies it; None: the packet's own tick
        raises  Error, whose `advice` says how to react; the receiver is then unchanged.   ValueError  a packet that was decoded
        """
        number = packet
        if isinstance(packet, Packet):
            if data is not None:
                raise TypeError("a Packet has its bytes: push(packet), or push(packet.number, data)")
            number, data = packet.number, _data_of(packet)
        elif data is None:
            raise TypeError("push(packet) takes a Packet of a Sender; bytes come with their number: push(number, data)")
        info, given = answer(_abi.tactus_packet_info), bytes_of(data)
        call(core().tactus_receiver_push, self.handle, _number(number), given, len(given), PACKET_TICK if now is None else now, info)
        return Packet._of(info)

    def skip_number(self, number: int) -> None:
        """This number came, and no packet of rigid objects has it: with INTERPOLATION_PLAYOUT the replica need not interpolate over it."""
        call(core().tactus_receiver_push, self.handle, _number(number), None, 0, PACKET_TICK, None)


class Player(Handle, _Shown):
    """A stream file, tick by tick. Options: keyword arguments of ReceiverOptions.

    file  a path, or the bytes of a file
    """

    _destroy = "tactus_player_destroy"

    def __init__(self, file: str | os.PathLike[str] | bytes, **options: Any) -> None:
        super().__init__()
        path = path_of(file)
        self._subject = path or ""
        self._bytes = bytes_of(file) if path is None else pathlib.Path(path).read_bytes()  # the player reads it in place
        call(core().tactus_player_open, self._bytes, len(self._bytes), ReceiverOptions(**options), ctypes.byref(self._handle),
             subject=self._subject)
        self._count()

    def _receiver(self) -> Any:
        return core().tactus_player_receiver(self.handle)

    def play(self, tick: int) -> list[Packet]:
        """Apply all packets that are due at this tick.   raises  Error"""
        out = []
        info = answer(_abi.tactus_packet_info)
        while call(core().tactus_player_play, self.handle, tick, info, subject=self._subject):
            out.append(Packet._of(info, offset=info.offset))
        return out

    def _info(self) -> _abi.tactus_player_info:
        info = answer(_abi.tactus_player_info)
        call(core().tactus_player_get, self.handle, info, subject=self._subject)
        return info

    def next_tick(self) -> int | None:
        """Tick of the next packet; None at the end.   raises  Error"""
        tick = self._info().next_tick
        return None if tick == END else tick

    @property
    def header_bytes(self) -> int:
        """[bytes] of the scene declaration."""
        return self._info().header_bytes

    @property
    def complete(self) -> bool:
        """The file has its end. Valid after the last packet."""
        return bool(self._info().complete)


class StreamWriter(Handle):
    """Packets into the bytes of a stream file."""

    _destroy = "tactus_writer_destroy"

    def __init__(self, scene: Scene) -> None:
        super().__init__()
        call(core().tactus_writer_create, handle_of(scene, Scene), ctypes.byref(self._handle))

    def add(self, packet: Packet) -> None:
        """Ticks must not fall, and no packet may be left out: a file does not hold numbers, but counts.

        raises  Error.   ValueError  a packet that was decoded, which has no bytes
        """
        data = _data_of(packet)
        call(core().tactus_writer_add, self.handle, packet.tick, packet.number, data, len(data), packet.key)

    def take(self) -> bytes:
        """What was written since the last call."""
        return read_bytes(core().tactus_writer_take, self.handle)

    def finish(self) -> bytes:
        """Add the index and the end of the file; returns what was not taken yet."""
        call(core().tactus_writer_finish, self.handle)
        return self.take()
