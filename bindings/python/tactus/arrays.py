# SPDX-License-Identifier: Apache-2.0
"""Arrays of one's own as a trace: checks of their shapes; libtactus-trace does the rest."""
from __future__ import annotations

import ctypes
import os
import pathlib
import tempfile
from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import Error, Handle, call, refusal, refusal_for, text_of, traces

NO_TIME = -(1 << 63)
_UNITS = {"s": 1e9, "ms": 1e6, "us": 1e3, "ns": 1.0}
_POSITION = (("x", "y", "z"), ("position_x", "position_y", "position_z"), ("px", "py", "pz"))
_ROTATION = (("qw", "qx", "qy", "qz"), ("rotation_w", "rotation_x", "rotation_y", "rotation_z"),
             ("orientation_w", "orientation_x", "orientation_y", "orientation_z"))
_FORCE = (("fx", "fy", "fz"), ("force_x", "force_y", "force_z"))


def _without_zone(time: Any) -> Any:
    """Times of pandas that have a zone, in UTC; others as they are."""
    of = getattr(time, "dt", time)  # of a column; an index has none
    return of.tz_convert(None) if getattr(of, "tz", None) is not None else time


def nanoseconds(time: Any, unit: str | None) -> npt.NDArray[np.int64]:
    """Seconds (floats), datetime64, timedelta64, or whole numbers of nanoseconds, unless a unit is given.   raises  Error"""
    values = np.asarray(_without_zone(time))
    if values.ndim != 1 or values.dtype.kind not in "fiuMm":
        raise refusal("R-CSV-8", f"time has shape {values.shape} and type {values.dtype}: a row of seconds, nanoseconds or datetime64 is wanted")
    if unit is not None and unit not in _UNITS:
        raise refusal("R-CSV-8", f"time_unit {unit!r} is none of {', '.join(_UNITS)}")
    if values.dtype.kind in "Mm":
        return np.ascontiguousarray(values.astype(f"{values.dtype.kind}8[ns]").view(np.int64))  # NaT is NO_TIME
    if values.dtype.kind in "iu" and (unit or "ns") == "ns":
        return np.ascontiguousarray(values, np.int64)
    finite = np.isfinite(values)
    start = values[finite][0] if finite.any() else 0
    out = np.full(len(values), NO_TIME, np.int64)  # from the first one on: floats of an epoch have no digits to lose
    out[finite] = np.round((values[finite] - start) * _UNITS[unit or "s"]).astype(np.int64)
    return out


def _named(value: Any, names: tuple[tuple[str, ...], ...]) -> npt.NDArray[np.float64] | None:
    """These columns of a data frame."""
    columns = {str(column): column for column in value.columns}
    for wanted in names:
        if all(name in columns for name in wanted):
            return np.stack([np.asarray(value[columns[name]], np.float64) for name in wanted], axis=1)
    return None


def _is_frame(value: Any) -> bool:
    return hasattr(value, "columns") and hasattr(value, "__getitem__")


def _table(value: Any, where: str, widths: tuple[int, ...], rows: int) -> npt.NDArray[np.float64]:
    try:
        out = np.ascontiguousarray(value, np.float64)
    except (TypeError, ValueError) as why:
        raise refusal("R-CSV-4", f"{where}: {why}") from None
    if out.ndim != 2 or out.shape[1] not in widths or len(out) != rows:
        wanted = " or ".join(f"({rows}, {width})" for width in widths)
        raise refusal("R-CSV-8", f"{where} has shape {out.shape}, not {wanted}")
    return out


def _pose(value: Any, where: str, order: str, rows: int) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64] | None]:
    """Position and rotation w x y z."""
    if _is_frame(value):
        position, rotation = _named(value, _POSITION), _named(value, _ROTATION)
        if position is None:
            raise refusal("R-CSV-2", f"{where} has no columns x, y, z, but {', '.join(map(str, value.columns))}")
        return _table(position, where, (3,), rows), None if rotation is None else _table(rotation, where, (4,), rows)
    if isinstance(value, tuple) and len(value) == 2:
        return _table(value[0], f"{where}, positions", (3,), rows), _ordered(_table(value[1], f"{where}, rotations", (4,), rows), order)
    table = _table(value, where, (3, 7), rows)
    if table.shape[1] == 3:
        return table, None
    return np.ascontiguousarray(table[:, :3]), _ordered(table[:, 3:], order)


def _ordered(rotation: npt.NDArray[np.float64], order: str) -> npt.NDArray[np.float64]:
    return np.ascontiguousarray(rotation if order == "wxyz" else rotation[:, [3, 0, 1, 2]])


def _vectors(value: Any, where: str, names: tuple[tuple[str, ...], ...], widths: tuple[int, ...], rows: int) -> npt.NDArray[np.float64]:
    if _is_frame(value):
        found = _named(value, names)
        if found is None:
            raise refusal("R-CSV-2", f"{where} has no columns {', '.join(names[0])}, but {', '.join(map(str, value.columns))}")
        value = found
    return np.ascontiguousarray(_table(value, where, widths, rows)[:, :3])


def _by_name(given: Any, name: str) -> dict[str, Any]:
    if given is None:
        return {}
    return dict(given) if isinstance(given, Mapping) else {name: given}


class _Arrays(Handle):
    _destroy = "tactus_arrays_destroy"
    _library = staticmethod(traces)

    def __init__(self, time: npt.NDArray[np.int64], tick_rate: int, gap: float, source: str) -> None:
        super().__init__()
        self._kept: list[Any] = [time]
        call(traces().tactus_arrays_create, time.ctypes.data, len(time), tick_rate, gap, text_of(source.encode()), ctypes.byref(self._handle))

    def _address(self, values: npt.NDArray[np.float64] | None) -> int | None:
        self._kept.append(values)
        return None if values is None else values.ctypes.data

    def add(self, function: Any, name: str, *arrays: npt.NDArray[np.float64] | None) -> None:
        call(function, self.handle, text_of(name.encode()), *map(self._address, arrays), subject=name)

    def write(self, path: str) -> list[str]:
        notes, error = ctypes.c_char_p(b""), _abi.tactus_error()
        if traces().tactus_arrays_write(self.handle, os.fsencode(path), ctypes.byref(notes), error):
            raise refusal_for(error, error.detail.decode()) if error.detail else Error(error)
        return (notes.value or b"").decode().splitlines()


def _touched(contact: Any, where: str) -> tuple[str, float, int]:
    """Object, stiffness and kind."""
    kinds = {"plane": _abi.TACTUS_CONTACT_SURFACE, "spring": _abi.TACTUS_CONTACT_SPRING}
    if not isinstance(contact, (tuple, list)) or len(contact) not in (2, 3) or not isinstance(contact[0], str):
        raise refusal("R-CSV-8", f"{where} is {contact!r}, not (object, stiffness) or (object, stiffness, 'spring')")
    kind = contact[2] if len(contact) == 3 else "plane"
    if kind not in kinds:
        raise refusal("R-CSV-8", f"{where}: {kind!r} is neither 'plane' nor 'spring'")
    return contact[0], float(contact[1]), kinds[kind]


def write_arrays(time: Any, poses: Any, wrenches: Any, devices: Any, contacts: Any, order: str, time_unit: str | None, tick_rate: int | None,
                 gap: float, source: str) -> tuple[bytes, list[str]]:
    """The bytes of a trace, and notes; arguments as Trace.from_arrays."""
    objects, forces, hands = _by_name(poses, "object"), _by_name(wrenches, "user"), _by_name(devices, "user")
    if order not in ("wxyz", "xyzw"):
        raise refusal("R-CSV-8", f"order {order!r} is neither 'wxyz' nor 'xyzw'")
    left_out: list[str] = []
    if _is_frame(poses):
        objects = {"object": poses}
    if time is None:
        if not tick_rate:
            raise refusal("R-CSV-7", "neither time nor tick_rate is given")
        first = next(iter([*objects.values(), *hands.values(), *forces.values()]), ())
        count = len(first[0] if isinstance(first, tuple) else first)
        stamps = np.round(np.arange(count) * (1e9 / tick_rate)).astype(np.int64)
    else:
        stamps = nanoseconds(time, time_unit)
    rows = len(stamps)
    with _Arrays(stamps, tick_rate or 0, gap, source) as arrays:
        for name, value in objects.items():
            arrays.add(traces().tactus_arrays_object, name, *_pose(value, f"poses[{name!r}]", order, rows), None, None)
        for name in [*hands, *(name for name in forces if name not in hands)]:
            device, turned = (None, None) if name not in hands else _pose(hands[name], f"devices[{name!r}]", order, rows)
            force = None if name not in forces else _vectors(forces[name], f"wrenches[{name!r}]", _FORCE, (3, 6), rows)
            if name in forces and not _is_frame(forces[name]) and np.shape(forces[name])[1] == 6:
                left_out.append(f"{name}: torques are left out")
            arrays.add(traces().tactus_arrays_user, name, device, turned, force)
        for name, contact in _by_name(contacts, "user").items():
            touched, stiffness, kind = _touched(contact, f"contacts[{name!r}]")
            for what, wanted, there in (("user", name, {**hands, **forces}), ("object", touched, objects)):
                if wanted not in there:
                    raise refusal("R-API-5", f"contacts[{name!r}]: there is no {what} {wanted!r}, but {', '.join(map(repr, there)) or 'none'}")
            call(traces().tactus_arrays_contact, arrays.handle, text_of(name.encode()), text_of(touched.encode()), stiffness, kind,
                 int(name not in hands), subject=name)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "trace.mcap")
            left_out += arrays.write(path)
            return pathlib.Path(path).read_bytes(), left_out
