#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Decode one packet of a stream file and tell every step of the range decoder, as a Markdown table."""
import argparse
import sys
from pathlib import Path

import deformable_main
import deformable_thesis
import rigid
from conventions import StreamError
from decoder import File, SceneDecoder
from range_coder import RangeDecoder
from start_models import Models

NAMES: dict = {}                                            # by identity of a model: the model, its name


def name_models(tree: str, models: list) -> None:
    for node, model in enumerate(models[1:], start=1):
        NAMES[id(model)] = (model, f"{tree}[{node}]")


class NamedModels(Models):
    """The models of a packet, each of which knows its name in the specification."""

    def __missing__(self, name):
        models = super().__missing__(name)
        name_models(name, models)
        return models


class NamedThesisModels(deformable_thesis.ThesisModels):
    def copy(self):
        copied = super().copy()
        name_models("list", copied.list)
        name_models("errors", copied.errors)
        return copied


class Narrator(RangeDecoder):
    """A range decoder that writes down what it does."""
    steps: list = []

    def bit(self, m):
        zero, before = m[0], (self.range, self.code)
        value = super().bit(m)
        self.note(f"bit({NAMES[id(m)][1]})", f"{zero}", f"{(before[0] >> 15) * zero:08x}", before, value)
        return value

    def raw(self, n):
        before = (self.range, self.code)
        value = super().raw(n)
        self.note(f"raw({n})", "", f"{before[0] >> n:08x}", before, value)
        return value

    def note(self, symbol, zero, bound, before, value):
        self.steps.append(f"| {symbol} | {before[0]:08x} | {before[1]:08x} | {zero} | {bound} | **{value}** | {self.position} |")


def narrate():
    """From now on decoders tell what they do."""
    rigid.Models = deformable_main.Models = NamedModels
    deformable_thesis.ThesisModels = NamedThesisModels
    rigid.RangeDecoder = deformable_main.RangeDecoder = deformable_thesis.RangeDecoder = Narrator


def tell_rigid(packet):
    for update in packet.updates:
        state = packet.moment.states[update.object]
        print(f"Object {update.object}, reason {update.reason}, level {update.level}:")
        print(f"position {list(state.position)}, rotation {list(state.rotation)}, velocity {list(state.velocity)}, "
              f"angular velocity {list(state.angular_velocity)}.")


def tell_deformable(packet):
    state = packet.state
    if isinstance(state, deformable_main.MainState):
        touch = f"triangle {state.triangle}, haptic index {state.haptic_index}" if state.touched else "no touch"
        print(f"Visual bound {state.visual}, {touch}, density {state.density}.")
        for k, motion in enumerate(state.motion):
            print(f"Mode {k}: increment {motion.last}, before it {motion.before}.")
    for v in packet.vertices:
        print(f"Vertex {v}: displacement {state.u[3 * v:3 * v + 3]}.")


def explain(path, number):
    narrate()
    file = File(Path(path).read_bytes())
    scene = SceneDecoder(file.declaration)
    for count, (tick, record) in enumerate(file.packets()):
        Narrator.steps.clear()
        NAMES.clear()
        substream, data = scene.split(record)
        packet = scene.substreams[substream].decode(data, tick)
        if count == number:
            break
    else:
        sys.exit(f"{path}: there is no packet {number}")
    where = f" of substream {substream}" if len(scene.substreams) > 1 else ""
    print(f"Packet{where}: `{data.hex(' ')}`: sequence {packet.sequence}, payload `{data[2:].hex(' ')}`.\n")
    print("| symbol | range | code | zero | bound or step | value | bytes taken |\n|---|---|---|---|---|---|---|")
    print("\n".join(Narrator.steps))
    print(f"\nFinal state: range {packet.range:08x}, code {packet.code:08x}. Tick {packet.tick}, key {packet.key}.\n")
    if isinstance(packet, rigid.Packet):
        tell_rigid(packet)
    else:
        tell_deformable(packet)
    print(f"\nState hash: {scene.substreams[substream].state_hash():016x}.")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("stream", metavar="STREAM", help="stream file (.tct)")
    parser.add_argument("number", metavar="NUMBER", type=int, nargs="?", default=0, help="of the packet, from 0 [0]")
    arguments = parser.parse_args()
    try:
        explain(arguments.stream, arguments.number)
    except OSError as error:
        sys.exit(f"{arguments.stream}: {error.strerror}")
    except StreamError as error:
        sys.exit(f"{arguments.stream}: {error}")
