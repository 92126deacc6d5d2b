# SPDX-License-Identifier: Apache-2.0
"""Tactus: haptic scenes as packets. Traces, streams and tables as NumPy arrays, over the C library libtactus.

    stream = tactus.encode("truth.mcap", tactus.RigidBounds(weber_fraction=0.04, visual_position=3e-4))
    replica = tactus.decode(stream)                       # replica.position: (ticks, objects, 3) [m]
    assert tactus.compare("truth.mcap", stream).holds     # all bounds, at every tick

    own = tactus.Trace.from_arrays(seconds, poses={"cup": (positions, quaternions)}, wrenches={"hand": forces})
    tactus.plot(own, own.encode(), "figure.pdf")

encode, decode, compare and read_trace take whole recordings; Sender, Receiver, Player and TraceReader go tick by tick. SI units,
right-handed world frame, quaternions w x y z; time in ticks, of which a scene has tick_rate per second. What goes wrong is an Error with the
rule that was broken. An object is used by one thread at a time; scenes may be shared.
"""
from . import _abi
from ._library import Error
from .codec import CONTACT, Held, Packet, Player, Receiver, Sender, Shape, StreamWriter
from .options import DeformableBounds, Limits, ReceiverOptions, RigidBounds, SceneOptions, SenderOptions
from .figure import plot
from .run import Comparison, ErrorSummary, MeshErrors, Replica, Stream, compare, decode, encode, read_table
from .scene import Driven, Elastic, Mesh, RigidObject, Scene, build_scene, find_clusters
from .trace import USER, Frame, Trace, TraceReader, read_trace

__version__ = f"{_abi.TACTUS_VERSION >> 16}.{_abi.TACTUS_VERSION >> 8 & 255}.{_abi.TACTUS_VERSION & 255}"

HAPTIC_OFF, HAPTIC_ISOTROPIC, HAPTIC_CONE = _abi.TACTUS_HAPTIC_OFF, _abi.TACTUS_HAPTIC_ISOTROPIC, _abi.TACTUS_HAPTIC_CONE
HAPTIC_FIXED, HAPTIC_PERCEPTUAL = _abi.TACTUS_HAPTIC_FIXED, _abi.TACTUS_HAPTIC_PERCEPTUAL
REDUCTION_NONE, REDUCTION_DEAD_RECKONING = _abi.TACTUS_REDUCTION_NONE, _abi.TACTUS_REDUCTION_DEAD_RECKONING
PROFILE_THESIS, PROFILE_MAIN = _abi.TACTUS_PROFILE_THESIS, _abi.TACTUS_PROFILE_MAIN
BASELINE_PREVIOUS, BASELINE_ACKNOWLEDGED = _abi.TACTUS_BASELINE_PREVIOUS, _abi.TACTUS_BASELINE_ACKNOWLEDGED
INTERPOLATION_NONE, INTERPOLATION_LINEAR = _abi.TACTUS_INTERPOLATION_NONE, _abi.TACTUS_INTERPOLATION_LINEAR
INTERPOLATION_HERMITE, INTERPOLATION_BLENDING = _abi.TACTUS_INTERPOLATION_HERMITE, _abi.TACTUS_INTERPOLATION_BLENDING
INTERPOLATION_PLAYOUT = _abi.TACTUS_INTERPOLATION_PLAYOUT

__all__ = [
    "BASELINE_ACKNOWLEDGED", "BASELINE_PREVIOUS", "CONTACT", "Comparison", "DeformableBounds", "Driven", "Elastic", "Error",
    "ErrorSummary", "Frame", "HAPTIC_CONE", "HAPTIC_FIXED", "HAPTIC_ISOTROPIC", "HAPTIC_OFF", "HAPTIC_PERCEPTUAL",
    "Held", "INTERPOLATION_BLENDING", "INTERPOLATION_HERMITE", "INTERPOLATION_LINEAR", "INTERPOLATION_NONE", "INTERPOLATION_PLAYOUT",
    "Limits", "Mesh", "MeshErrors", "PROFILE_MAIN", "PROFILE_THESIS", "Packet", "Player", "REDUCTION_DEAD_RECKONING",
    "REDUCTION_NONE", "Receiver", "ReceiverOptions", "Replica", "RigidBounds", "RigidObject", "Scene", "SceneOptions", "Sender",
    "SenderOptions", "Shape", "Stream", "StreamWriter", "Trace", "TraceReader", "USER", "build_scene", "compare", "decode", "encode",
    "find_clusters", "plot", "read_table", "read_trace",
]
