#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Decode one packet of a stream file and tell every step of the range decoder, as a Markdown table.

    python3 explain.py stream.tct [NUMBER]        NUMBER counts packets from 0
"""
import sys
from pathlib import Path

import decoder as tactus
from range_decoder import RangeDecoder


class NamedModels(tactus.Models):
    """The models of a packet, each of which knows its name in the specification."""
    names: dict = {}

    def __missing__(self, name):
        models = super().__missing__(name)
        for node, model in enumerate(models[1:], start=1):
            self.names[id(model)] = (model, f"{name}[{node}]")
        return models


class Narrator(RangeDecoder):
    """A range decoder that writes down what it does."""
    steps: list = []

    def bit(self, m):
        zero, before = m[0], (self.range, self.code)
        value = super().bit(m)
        self.note(f"bit({NamedModels.names[id(m)][1]})", f"{zero}", f"{(before[0] >> 15) * zero:08x}", before, value)
        return value

    def raw(self, n):
        before = (self.range, self.code)
        value = super().raw(n)
        self.note(f"raw({n})", "", f"{before[0] >> n:08x}", before, value)
        return value

    def note(self, symbol, zero, bound, before, value):
        self.steps.append(f"| {symbol} | {before[0]:08x} | {before[1]:08x} | {zero} | {bound} | **{value}** | {self.position} |")


def explain(path, number):
    file = tactus.File(Path(path).read_bytes())
    rigid = tactus.RigidDecoder(file.header)
    tactus.Models, tactus.RangeDecoder = NamedModels, Narrator
    for count, (tick, data) in enumerate(file.packets()):
        Narrator.steps.clear()
        NamedModels.names.clear()
        packet = rigid.decode(data, tick)
        if count == number:
            break
    else:
        sys.exit(f"{path}: there is no packet {number}")
    print(f"Packet: `{data.hex(' ')}`: sequence {packet.sequence}, payload `{data[2:].hex(' ')}`.\n")
    print("| symbol | range | code | zero | bound or step | value | bytes taken |\n|---|---|---|---|---|---|---|")
    print("\n".join(Narrator.steps))
    print(f"\nFinal state: range {packet.range:08x}, code {packet.code:08x}. Tick {packet.scene.tick}, key {packet.key}.\n")
    for update in packet.updates:
        state = packet.scene.states[update.object]
        print(f"Object {update.object}, reason {update.reason}, level {update.level}:")
        print(f"position {list(state.position)}, rotation {list(state.rotation)}, velocity {list(state.velocity)}, "
              f"spin {list(state.spin)}.")
    print(f"\nState hash: {rigid.state_hash():016x}.")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    explain(sys.argv[1], int(sys.argv[2]) if len(sys.argv) == 3 else 0)
