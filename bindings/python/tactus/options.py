# SPDX-License-Identifier: Apache-2.0
"""Options and bounds: the structs of tactus.h and tactus_encoder.h, with their defaults. Fields are keyword arguments, SI units."""
from __future__ import annotations

import ctypes
from typing import Any

from . import _abi, _library


def init(options: Any, function: Any = None) -> Any:
    """A struct with its defaults, which it returns."""
    name = next(base.__name__ for base in type(options).__mro__ if base.__module__ == _abi.__name__)
    kind = getattr(_abi, name.upper())
    (function or _library.core().tactus_init)(kind, ctypes.byref(options), ctypes.sizeof(options))
    return options


def _fill(self: Any, fields: dict[str, Any]) -> None:
    init(self)
    known = {name for name, *_ in self._fields_ if name not in ("size", "reserved")}
    for name, value in fields.items():
        if name not in known:
            raise TypeError(f"{type(self).__name__} has no field {name!r}; it has {', '.join(sorted(known))}")
        setattr(self, name, value)
        if isinstance(value, int) and getattr(self, name) != value:
            raise OverflowError(f"{name}: {value} is out of range")


def _text(self: Any) -> str:
    fields = [f"{name}={getattr(self, name)!r}" for name, *_ in type(self).__mro__[1]._fields_ if name not in ("size", "reserved")]
    return f"{type(self).__name__}({', '.join(fields)})"


class RigidBounds(_abi.tactus_rigid_bounds):
    """Errors of rigid objects that call for an update.

    haptic            HAPTIC_OFF, _ISOTROPIC (default), _CONE, _FIXED or _PERCEPTUAL
    heartbeat         [s] 1
    visual_position   [m] 3e-4
    visual_rotation   [rad] 2 deg
    weber_fraction    p of the normal force, 0.04
    perceptual_fraction, cone_angle [rad], fixed_position [m], fixed_rotation [rad], force_floor [N]   see tactus.h
    """

    def __init__(self, **fields: float) -> None:
        super().__init__()
        _fill(self, fields)

    __repr__ = _text


class DeformableBounds(_abi.tactus_deformable_bounds):
    """Errors of deformable objects that call for an update.

    visual          v of every vertex [m], 3e-4
    haptic          1; 0: no haptic threshold
    weber_fraction  p of h = p f / k_c around a touch, 0.04
    depth_floor     [m] lower limit of f / k_c, 2e-4
    """

    def __init__(self, **fields: float) -> None:
        super().__init__()
        _fill(self, fields)

    __repr__ = _text


class SceneOptions(_abi.tactus_scene_options):
    """tick_rate [1/s], the four ..._exp of the grids, baselines, rigid_profile (PROFILE_MAIN or _THESIS), extrapolation [s], gravity
    [m/s^2], friction; world_size [m]: how far from the origin positions get, 512 m without it; limits: a Limits, of the receivers, for
    more than 4096 objects: see tactus_encoder.h."""

    def __init__(self, limits: Limits | None = None, **fields: Any) -> None:
        super().__init__()
        if "gravity" in fields:
            fields["gravity"] = (ctypes.c_double * 3)(*fields["gravity"])
        _fill(self, fields)
        self._kept = limits  # the struct only points to it
        self.limits = ctypes.addressof(limits) if limits is not None else None


class SenderOptions(_abi.tactus_sender_options):
    """reduction, baseline, key_interval [s], visual_fraction, haptic_fraction; rigid and deformable: bounds."""

    def __init__(self, rigid: RigidBounds | None = None, deformable: DeformableBounds | None = None, **fields: Any) -> None:
        super().__init__()
        _fill(self, fields)
        self._kept = (rigid, deformable)  # the struct only points to them
        self.rigid = ctypes.addressof(rigid) if rigid is not None else None
        self.deformable = ctypes.addressof(deformable) if deformable is not None else None


class Limits(_abi.tactus_limits):
    """What a decoder accepts: objects, header_bytes, packet_bytes, vertices, triangles, state_bytes, basis_work."""

    def __init__(self, **fields: int) -> None:
        super().__init__()
        _fill(self, fields)


class ReceiverOptions(_abi.tactus_receiver_options):
    """interpolation: INTERPOLATION_NONE (default), _LINEAR, _HERMITE, _BLENDING, _PLAYOUT; fraction, shortest [s], longest [s]; limits."""

    def __init__(self, limits: Limits | None = None, **fields: Any) -> None:
        super().__init__()
        _fill(self, fields)
        self._kept = limits  # the struct only points to it
        self.limits = ctypes.addressof(limits) if limits is not None else None
