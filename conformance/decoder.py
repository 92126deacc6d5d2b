# SPDX-License-Identifier: Apache-2.0
"""Tactus decoder that follows the specification line by line: the whole of it, put together.

Written from spec/ alone and meant to be read beside it: functions carry the names of the specification, and each
file names its chapter, each part its section. As a program it is a testee (README.md):
python3 decoder.py [--replica none|linear] < stream.tct
"""
from __future__ import annotations

import argparse
import json
import struct
import sys
from typing import Iterator, Optional, Union

from conventions import FNV_START, StreamError, fnv1a, require
from mesh_decoder import MeshDecoder, MeshPacket
from replica import Replica
from rigid_decoder import Packet, RigidDecoder
from stream import File, Header, Limits


class SceneDecoder:
    """Chapter 60, section 1: the decoders of the parts of a scene, by number."""

    def __init__(self, header: Header, limits: Limits = Limits()):
        self.parts: dict[int, Union[RigidDecoder, MeshDecoder]] = {}
        if header.moving() or not header.meshes:
            self.parts[0] = RigidDecoder(header, limits)
        for number, mesh in enumerate(header.meshes, start=1):
            self.parts[number] = MeshDecoder(header, mesh, limits)

    def split(self, data: bytes) -> tuple[int, bytes]:
        """The part of a packet, and the packet without the part's number."""
        if len(self.parts) == 1:
            return next(iter(self.parts)), data
        require(len(data) >= 1, "truncated", "R-PKT-6")
        require(data[0] in self.parts, "invalid", "R-PKT-6")
        return data[0], data[1:]


# ---- Testee (README.md) ---------------------------------------------------------------------------------------------
def describe_header(h: Header) -> dict:
    said = {"version": h.version, "profile": h.profile, "tick_rate": h.tick_rate,
            "grid": [h.position_exp, h.velocity_exp, h.rotation_exp, h.spin_exp],
            "max_extrapolation": h.max_extrapolation, "baseline_span": h.baseline_span,
            "objects": [{"name": item.name, "dof": item.dof} for item in h.objects]}
    if h.meshes:
        said["meshes"] = [{"name": m.name, "profile": m.profile, "vertices": len(m.rest), "triangles": len(m.triangles),
                           "modes": len(m.modes)} for m in h.meshes]
    if h.bounds:
        said["bounds"] = {**({"rigid": h.bounds.rigid} if h.bounds.rigid else {}), "meshes": h.bounds.meshes}
    return said


def describe_packet(packet: Union[Packet, MeshPacket]) -> dict:
    said = {"sequence": packet.sequence, "key": bool(packet.key), "tick": packet.tick}
    said.update({"vertices": len(packet.vertices)} if isinstance(packet, MeshPacket) else {"updates": packet.updates})
    return {**said, "range": f"{packet.range:08x}", "code": f"{packet.code:08x}"}


def lines(data: bytes, mode: Optional[str]) -> Iterator[dict]:
    """The reply to a stream file, line by line; raises StreamError where the input is rejected."""
    file = File(data)
    scene = SceneDecoder(file.header)
    viewer = Viewer(file.header, scene, mode) if mode else None
    several = len(scene.parts) > 1
    yield {"header": describe_header(file.header)}
    number = 0
    for tick, record in file.packets():
        if viewer:
            viewer.look_until(tick)
        part, data_of_packet = scene.split(record)
        decoder = scene.parts[part]
        packet = decoder.decode(data_of_packet, tick)
        line = {"packet": number, **({"part": part} if several else {}), **describe_packet(packet),
                "state": f"{decoder.state_hash():016x}"}
        if viewer:
            viewer.apply(packet, tick)
            line["shown"] = f"{viewer.shown_at(tick):016x}"
        yield line
        number += 1
    states = [f"{decoder.state_hash():016x}" for decoder in scene.parts.values()]
    end = {"complete": file.complete, "packets": number, "state": states if several else states[0]}
    if viewer:
        viewer.look_until(viewer.tick + 1)
        end["shown"] = f"{viewer.all:016x}"
    yield {"end": end}


class Viewer:
    """A client that applies every packet at its tick and looks at every tick."""

    def __init__(self, header: Header, scene: SceneDecoder, mode: str):
        self.replica = Replica(header, mode)
        self.meshes = [scene.parts[i + 1] for i in range(len(header.meshes))]
        self.tick, self.all = 0, FNV_START

    def apply(self, packet: Union[Packet, MeshPacket], tick: int) -> None:
        if isinstance(packet, Packet):
            self.replica.apply(packet, tick)

    def look_until(self, tick: int) -> None:
        while self.tick < tick:
            self.all = fnv1a(struct.pack("<Q", self.shown_at(self.tick)), self.all)
            self.tick += 1

    def shown_at(self, tick: int) -> int:
        shown = self.replica.pose_hash(tick)
        if not self.meshes:
            return shown
        displacements = [c for mesh in self.meshes for c in mesh.shown(tick)]
        return fnv1a(struct.pack(f"<Q{len(displacements)}i", shown, *displacements))


def main() -> int:
    parser = argparse.ArgumentParser(description="Decode a Tactus stream file from standard input to JSON lines.")
    parser.add_argument("--replica", choices=("none", "linear"), help="also show what a client shows")
    mode = parser.parse_args().replica
    try:
        for line in lines(sys.stdin.buffer.read(), mode):
            print(json.dumps(line, separators=(",", ":")))
    except StreamError as error:
        print(json.dumps({"error": {"errc": error.errc, "rule": error.rule}}, separators=(",", ":")))
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
