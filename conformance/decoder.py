# SPDX-License-Identifier: Apache-2.0
"""Tactus decoder that follows the specification line by line: the whole of it, put together.

Written from spec/ alone and meant to be read beside it: functions carry the names of the specification, and each
file names its chapter. As a program it is a testee (README.md):
python3 decoder.py [--replica none|device|linear|hermite|blending|playout] [--without thesis] < stream.tct
"""
from __future__ import annotations

import argparse
import json
import struct
import sys
from typing import Iterator, Optional, Union

import session_script
from conventions import FNV_START, StreamError, fnv1a
from device_path import DevicePath
from deformable_decoder import DeformablePacket
from elastic import Shapes
from file import File
from interpolation import MODES, InterpolatedReplica
from load import LoadPacket
from playout import Playout
from replica import Replica
from rigid import Packet
from scene import Declaration, Limits
from scene_decoder import SceneDecoder


PLAYOUT_DELAY = 100                                         # ticks


def describe_declaration(scene: Declaration) -> dict:
    out = {"version": scene.version, "profile": scene.profile, "tick_rate": scene.tick_rate,
            "grid": [scene.position_exp, scene.velocity_exp, scene.rotation_exp, scene.angular_exp],
            "max_extrapolation": scene.max_extrapolation, "baseline_span": scene.baseline_span,
            "objects": [{"name": item.name, "dof": item.dof} for item in scene.objects]}
    if scene.deformables:
        out["meshes"] = [{"name": d.name, "profile": d.profile, "vertices": len(d.rest), "triangles": len(d.triangles),
                           "modes": len(d.modes), **({} if d.stiffness is None else {"stiffness": f"{fnv1a(d.stiffness):016x}"})}
                          for d in scene.deformables]
    if scene.loads:
        out["loads"] = list(scene.loads)
    if scene.motion:
        out["motion"] = [*scene.motion.gravity, scene.motion.slide_deceleration]
    if scene.driven:
        out["driven"] = [[d.coupling, d.hold, *d.inertia, d.friction, d.damping] for d in scene.driven.values()]
    if any(d.body for d in scene.deformables):
        bodies = [(i, d.body) for i, d in enumerate(scene.deformables) if d.body]
        out["elastic"] = [[i, len(b.rest), len(b.tetrahedra), len(b.materials), len(b.fixed), b.work] for i, b in bodies]
    if scene.interest:
        out["interest"] = list(scene.interest)
    if scene.bounds:
        out["bounds"] = {**({"rigid": scene.bounds.rigid} if scene.bounds.rigid else {}), "meshes": scene.bounds.deformables,
                          **({"loads": scene.bounds.loads} if scene.bounds.loads else {})}
    return out


def describe_packet(packet: Union[Packet, DeformablePacket, LoadPacket]) -> dict:
    out = {"number": packet.number, "key": bool(packet.key), "tick": packet.tick}
    if isinstance(packet, LoadPacket):
        out["loads"] = packet.loads
    else:
        out.update({"vertices": len(packet.vertices)} if isinstance(packet, DeformablePacket) else {"updates": packet.updates})
    return {**out, "range": f"{packet.range:08x}", "code": f"{packet.code:08x}"}


def lines(data: bytes, mode: Optional[str], limits: Limits = Limits()) -> Iterator[dict]:
    """The reply to a stream file, line by line; raises StreamError where the input is rejected."""
    file = File(data, limits)
    decoders = SceneDecoder(file.declaration, limits)
    viewer = Viewer(file.declaration, decoders, mode) if mode else None
    several = len(decoders.substreams) > 1
    yield {"header": describe_declaration(file.declaration)}
    count = 0
    for tick, number, data in file.packets():
        if viewer:
            viewer.look_until(tick)
        substream, packet_bytes = decoders.split(data)
        decoder = decoders.substreams[substream]
        packet = decoder.decode(number, packet_bytes, tick)
        line = {"packet": count, **({"part": substream} if several else {}), **describe_packet(packet),
                "state": f"{decoder.state_hash():016x}"}
        if viewer:
            viewer.apply(packet, tick)
            line["shown"] = f"{viewer.shown_at(tick):016x}"
        yield line
        count += 1
    states = [f"{decoder.state_hash():016x}" for decoder in decoders.substreams.values()]
    end = {"complete": file.complete, "packets": count, "state": states if several else states[0]}
    if viewer:
        viewer.look_until(viewer.tick + 1 + viewer.delay)
        end["shown"] = f"{viewer.all:016x}"
    yield {"end": end}


class Viewer:
    """A client that applies every packet at its tick and looks at every tick, or in playout at the tick `delay` before.

    In the mode device it shows as in none, and the first moving object is its device, in this scene and in the ticks of the server.
    """

    def __init__(self, scene: Declaration, decoders: SceneDecoder, mode: str):
        self.playout = mode == "playout"
        self.delay = PLAYOUT_DELAY if self.playout else 0
        self.path = DevicePath(scene) if mode == "device" else None
        if self.path:
            self.path.begin(0, 0)
        interpolates = mode in MODES and not scene.smoothed               # 60, section 1
        self.replica = Playout(scene) if self.playout else InterpolatedReplica(scene, mode) if interpolates else Replica(scene, self.path)
        self.deformables = [decoders.substreams[i + 1] for i in range(len(scene.deformables))]
        self.shapes = [Shapes(scene, item, self.path) if self.path and item.body else None for item in scene.deformables]
        self.tick, self.all = 0, FNV_START

    def apply(self, packet: Union[Packet, DeformablePacket, LoadPacket], tick: int) -> None:
        if not isinstance(packet, Packet):
            return
        if self.path and any(update.object == self.replica.moving[0] for update in packet.updates):
            self.path.add(packet.number, packet.moment.states[self.replica.moving[0]])
        self.replica.apply(packet, tick)

    def look_until(self, tick: int) -> None:
        while self.tick < tick:
            self.all = fnv1a(struct.pack("<Q", self.shown_at(self.tick)), self.all)
            self.tick += 1

    def shown_at(self, tick: int) -> int:
        tick -= self.delay
        shown = self.replica.pose_hash(tick)
        if not self.deformables:
            return shown
        for shapes in filter(None, self.shapes):
            shapes.reach(tick)                              # while the path remembers
        displacements = [c for item, shapes in zip(self.deformables, self.shapes) for c in item.shown(tick, self.playout, shapes)]
        return fnv1a(struct.pack(f"<Q{len(displacements)}i", shown, *displacements))


def main(arguments: Optional[list[str]] = None) -> int:
    parser = argparse.ArgumentParser(description="Decode a Tactus stream file from standard input to JSON lines.")
    parser.add_argument("--replica", choices=("none", "device", *MODES, "playout"),
                        help="also show what a client shows")
    parser.add_argument("--session", action="store_true", help="read a script for the client's end of a session instead")
    parser.add_argument("--without", choices=("thesis",), help="decode as one that lacks component thesis")
    options = parser.parse_args(arguments)
    limits = Limits(thesis=options.without != "thesis")
    if options.replica in MODES and not limits.thesis:
        parser.error(f"--replica {options.replica} needs component thesis")
    try:
        for line in session_script.lines(sys.stdin.read(), limits) if options.session else lines(sys.stdin.buffer.read(), options.replica, limits):
            print(json.dumps(line, separators=(",", ":")))
    except StreamError as error:
        print(json.dumps({"error": {"errc": error.errc, "rule": error.rule}}, separators=(",", ":")))
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
