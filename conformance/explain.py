#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Decode one packet of a stream file and explain every step as Markdown tables; or its scene declaration, or what losses do to it."""
import argparse
import sys
from pathlib import Path

import deformable_main
import load
import rigid
import thesis_mesh
from conventions import Cursor, StreamError, clamp, round_shift, zigzag
from declaration_syntax import Taken, elements_of_body
from decoder import File, SceneDecoder
from deformable_motion import FARTHEST, combine, lim
from packet import Receiver
from range_coder import RangeDecoder
from run import load_cases, read_input
from start_models import Models

NAMES: dict = {}                                            # by identity of a model: the model, its name
ELEMENTS = {                                                # models, and the element of the specification that they code
    "KEY": "key", "BASELINE": "baseline_delta", "TICK": "tick_delta", "COUNT": "count", "GAP": "gap", "REASON": "reason",
    "LEVEL": "level", "LOD": "lod less that of the baseline", "SMOOTHING_EXP": "smoothing_exp", "RETAINED": "retained", "PREDICTOR": "predictor", "CONTACT": "component of contact", "LAYER": "layer", "SAME_FRAME": "same_frame",
    "LATE": "late",
    "TOUCHED": "touched", "SAME_TRIANGLE": "same triangle", "NEAR_TRIANGLE": "near triangle", "NEAR_INDEX": "entry of near",
    "HAPTIC": "haptic_change", "SAME_VISUAL": "same_visual", "VISUAL": "visual", "DENSITY": "density", "WEIGHT_SET": "weight_set", "DRIVEN": "driven", "FADES": "fades",
    "CHANGED": "changed", "STEP": "step", "COEFFICIENT": "coefficient", "SIGNIFICANT": "significant", "COMPONENT": "component of r", "ERROR": "symbol",
}


def name_models(tree: str, models: list) -> None:
    for node, model in enumerate(models[1:], start=1):
        NAMES[id(model)] = (model, f"{tree}[{node}]")


def name_of(models: list) -> str:
    return NAMES[id(models[1])][1].rpartition("[")[0]


class NamedModels(Models):
    """The models of a packet, each of which knows its name in the specification."""

    def __missing__(self, name):
        models = super().__missing__(name)
        name_models(name, models)
        return models


class NamedInitialModels(load.InitialModels):
    def __missing__(self, name):
        models = super().__missing__(name)
        name_models(name, models)
        return models


class NamedThesisModels(thesis_mesh.ThesisModels):
    def copy(self):
        copied = super().copy()
        name_models("GAP", copied.list)
        name_models("ERROR", copied.errors)
        return copied


class Narrator(RangeDecoder):
    """A range decoder that writes down what it does: `steps` bit by bit, `symbols` symbol by symbol."""
    steps: list = []
    symbols: list = []
    bits: list = []                                         # of the symbol at hand
    inside = 0                                              # calls that are parts of one symbol

    def bit(self, m):
        zero, before = m[0], (self.range, self.code)
        name = NAMES[id(m)][1]
        value = super().bit(m)
        self.steps.append(f"| bit({name}) | {before[0]:08x} | {before[1]:08x} | {zero} | {(before[0] >> 15) * zero:08x} | "
                          f"**{value}** | {self.position} |")
        self.bits.append(f"{value}")
        return value if self.inside else self.symbol("bit", name.rpartition("[")[0], value)

    def raw(self, n):
        before = (self.range, self.code)
        value = super().raw(n)
        self.steps.append(f"| raw({n}) | {before[0]:08x} | {before[1]:08x} |  | {before[0] >> n:08x} | **{value}** | "
                          f"{self.position} |")
        self.bits.append(f"raw {value}")
        return value if self.inside else self.symbol("raw", f"{n}", value)

    def tree(self, models, n):
        return self.whole("tree", models, super().tree, n)

    def magnitude(self, models):
        return self.whole("magnitude", models, super().magnitude)

    def signed(self, models):
        return self.whole("signed", models, super().signed)

    def signed_like(self, models, model, like):
        return self.whole("signed_like", models, super().signed_like, model, like)

    def nonzero_like(self, models, model, like):
        return self.whole("nonzero_like", models, super().nonzero_like, model, like)

    def whole(self, function, models, decode, *arguments):
        self.inside += 1
        value = decode(models, *arguments)
        self.inside -= 1
        return value if self.inside else self.symbol(function, name_of(models), value)

    def symbol(self, function, name, value):
        element = ELEMENTS.get(name.split("[")[0], "part of the triangle's number")
        if function == "raw" and self.symbols and self.symbols[-1].startswith("| predictor"):
            element = "held"
        kind, *indices = name.replace("]", "").split("[")
        if kind in ("POSE", "MOTION"):
            element = f"component of r[{2 * int(indices[0]) + (kind == 'MOTION')}]"
        self.symbols.append(f"| {element} | {function}({name}) | {' '.join(self.bits)} | **{value}** |")
        self.bits.clear()
        return value


class Found:
    """What the packet at hand builds on."""
    base = None
    delta = 0
    coefficients: list = []


def narrate():
    """From now on decoders record what they do."""
    rigid.Models = deformable_main.Models = NamedModels
    load.InitialModels = NamedInitialModels
    thesis_mesh.ThesisModels = NamedThesisModels
    load.RangeDecoder = rigid.RangeDecoder = deformable_main.RangeDecoder = thesis_mesh.RangeDecoder = Narrator
    baseline = Receiver.baseline

    def find(receiver, number, key, baseline_delta):
        Found.delta = 0 if key else baseline_delta
        Found.base = baseline(receiver, number, key, baseline_delta)
        return Found.base

    read = deformable_main.MainCodec.read_coefficients

    def keep(codec, decoder, models):
        Found.coefficients = read(codec, decoder, models)
        return Found.coefficients

    Receiver.baseline, deformable_main.MainCodec.read_coefficients = find, keep


# ---- A packet -------------------------------------------------------------------------------------------------------
def table(head: str, rows: list) -> None:
    columns = head.count("|") + 1
    print(f"| {head} |\n|{'---|' * columns}")
    print("\n".join(rows) + "\n")


def vector(v) -> str:
    return ", ".join(str(c) for c in v)


def explain_rigid(packet, scene):
    for update in packet.updates:
        base, state = Found.base.states[update.object], packet.moment.states[update.object]
        position, rotation = rigid.predict(scene, base, packet.tick)
        rows = [f"| predicted from the baseline, of tick {base.tick} | {vector(position)} | {vector(rotation)} | | |",
                f"| decoded | {vector(state.position)} | {vector(state.rotation)} | {vector(state.velocity)} | "
                f"{vector(state.angular_velocity)} |"]
        predictor = f", predictor {state.predictor}" if scene.motion or scene.driven else ""
        smoothing = f", smoothing_exp {state.smoothing_exp}, retained {state.retained}" if scene.smoothed else ""
        lod = f", lod {state.lod}" if scene.interest else ""
        print(f"Object {update.object}, reason {update.reason}, level {update.level}{lod}{predictor}{smoothing}:\n")
        table("| position | rotation | velocity | angular velocity", rows)
        if state.predictor == rigid.DRIVEN:
            held, point, normal, drag = state.contact
            table("held | point | normal | drag", [f"| {held} | {vector(point)} | {vector(normal)} | {drag} |"])


def explain_load(packet, scene):
    for i, (before, after) in enumerate(zip(Found.base.vectors, packet.state.vectors)):
        names = ["external", "hold", *(f"push {j}" for j in range(scene.loads.users))]
        print(f"Object {scene.moving()[i]}, x 2^-{scene.loads.force_exp} N:\n")
        table("vector | in the baseline | decoded", [f"| {n} | {vector(b)} | {vector(a)} |" for n, b, a in zip(names, before, after)])


def explain_main(packet, codec):
    state, base = packet.state, Found.base
    h = deformable_main.haptic_bound(state.haptic_index)
    touch = f"triangle {state.triangle}, haptic index {state.haptic_index}: h = {h}" if state.touched else "no touch"
    print(f"Visual bound {state.visual}, {touch}. Density {state.density}.\n")
    if state.motion:
        table("mode | last | before", [f"| {k} | {m.last} | {m.before} |" for k, m in enumerate(state.motion)])
    if codec.item.layered:
        table("vertex | u", [f"| {v} | {vector(state.u[3 * v:3 * v + 3])} |" for v in packet.vertices])
    else:
        explain_vertices(packet, codec, state, base)


def explain_vertices(packet, codec, state, base):
    """Every step of section 7, computed again from the states before and after a packet without layers."""
    item, tree = codec.item, codec.hierarchy
    expected = codec.expect(base, state.tick)
    codec.fade(base, state.tick, deformable_main.Known(deformable_main.ALL, set(), {}), expected)
    combine(item.modes, [lim(c * deformable_main.mode_unit(mode.step, state)) for mode, c in zip(item.modes, Found.coefficients)], expected)
    area = deformable_main.area_of_interest(item, codec.triangles_of, state.triangle) if state.touched else set()
    correction, rows = {}, []
    for v in tree.order:
        axes = range(3 * v, 3 * v + 3)
        parents = list(zip(tree.parents[state.weight_set][v], tree.weights[state.weight_set][v]))
        predicted = [lim(expected[i] + round_shift(sum(w * correction[p][i % 3] for p, w in parents), 15)) for i in axes]
        bound = min(state.visual, deformable_main.haptic_bound(state.haptic_index)) if v in area else state.visual
        step = deformable_main.step(bound)
        r = [(state.u[i] - p) // step if abs(state.u[i]) < FARTHEST else "to the limit" for i, p in zip(axes, predicted)]
        correction[v] = [state.u[i] - expected[i] for i in axes]
        rows.append(f"| {v} | {vector(expected[i] for i in axes)} | {vector(predicted)} | {bound} | {step} | {vector(r)} | "
                    f"{vector(state.u[i] for i in axes)} | {vector(correction[v])} |")
    table("vertex | expected | predicted | bound | step | r | u | correction", rows)


def explain_thesis(packet, data, span):
    rest = Cursor(data, 0, len(data))
    rows = [f"| key | `{data[:1].hex()}` | {rest.take(1, ('', ''))[0]} |"]
    baseline = ["baseline_delta"] if not data[0] and span > 1 else []
    for name in (*baseline, "tick_delta", "count", "list_bytes", "lowest", "range"):
        start = rest.position
        value = rest.varint(("", ""), ("", ""))
        rows.append(f"| {name} | `{data[start:rest.position].hex(' ')}` | {zigzag(value) if name == 'lowest' else value} |")
        if name == "list_bytes":
            list_bytes = value
    rows.append(f"| list | `{rest.take(list_bytes, ('', '')).hex(' ')}` | |")
    rows.append(f"| errors | `{rest.take(rest.left(), ('', '')).hex(' ')}` | |")
    table("element | bytes | value", rows)


def explain_packet(packet, data, decoder, scene, every_bit):
    thesis = not isinstance(packet, (rigid.Packet, load.LoadPacket)) and not isinstance(packet.state, deformable_main.MainState)
    if thesis:
        explain_thesis(packet, data, scene.baseline_span)
    if every_bit:
        table("symbol | range | code | zero | bound or step | value | bytes taken", Narrator.steps)
    table("element | decoded by | bits | value", Narrator.symbols)
    print(f"Final state: range {packet.range:08x}, code {packet.code:08x}. Tick {packet.tick}, key {packet.key}.\n")
    if isinstance(packet, rigid.Packet):
        explain_rigid(packet, scene)
    elif isinstance(packet, load.LoadPacket):
        explain_load(packet, scene)
    elif thesis:
        table("vertex | u", [f"| {v} | {vector(packet.state.u[3 * v:3 * v + 3])} |" for v in packet.vertices])
    else:
        explain_main(packet, decoder.codec)


def explain(file, number, every_bit):
    narrate()
    decoders = SceneDecoder(file.declaration)
    for count, (tick, own, record) in enumerate(file.packets()):
        Narrator.steps.clear()
        Narrator.symbols.clear()
        NAMES.clear()
        substream, data = decoders.split(record)
        packet = decoders.substreams[substream].decode(own, data, tick)
        if count == number:
            break
    else:
        sys.exit(f"there is no packet {number}")
    where = f" of substream {substream}" if len(decoders.substreams) > 1 else ""
    print(f"Packet{where}: `{data.hex(' ')}`: number {packet.number}.\n")
    explain_packet(packet, data, decoders.substreams[substream], file.declaration, every_bit)
    print(f"State hash: {decoders.substreams[substream].state_hash():016x}.")


# ---- A stream with losses -------------------------------------------------------------------------------------------
def play(file, lost):
    """Every packet in turn, without those that are lost."""
    narrate()
    decoders = SceneDecoder(file.declaration)
    rows = []
    for count, (tick, number, record) in enumerate(file.packets()):
        substream, data = decoders.split(record)
        decoder = decoders.substreams[substream]
        if count in lost:
            rows.append(f"| {count} | {number} | | lost | | |")
            continue
        Found.delta = 0
        try:
            packet = decoder.decode(number, data, tick)
            builds_on = "initial state" if packet.key else f"{number - Found.delta}"
            result = f"tick {packet.tick}"
        except StreamError as error:
            builds_on, result = f"{number - Found.delta}" if Found.delta else "", f"refused: {error.rule}"
        kept = ", ".join(map(str, sorted(decoder.receiver.kept)))
        rows.append(f"| {count} | {number} | {builds_on} | {result} | {kept} | `{decoder.state_hash():016x}` |")
    table("packet | number | baseline | result | kept numbers | state hash", rows)


# ---- The scene declaration ------------------------------------------------------------------------------------------
class Explained(Taken):
    """The elements of a declaration as rows of a table. The components of a vector are one row."""
    COMPONENTS = {"position": 3, "rotation": 4, "gravity": 3, "inertia": 3, "rest": 3, "corners": 3, "entries": 3, "inner": 3, "tetrahedra": 4}

    def __init__(self, data, deformables):
        super().__init__(data)
        self.rows, self.seen, self.vector = [], 0, []
        self.deformables, self.values = iter(deformables), {}

    def add(self, name, value):
        if name == "profile":                               # a deformable object begins
            item = next(self.deformables)
            self.values = {"rest": iter(item.rest), "corners": iter(item.triangles)}
        self.vector.append(value)
        if len(self.vector) == self.COMPONENTS.get(name, 1):
            text = vector(self.vector)
            self.row(name, f"differences {text}: {vector(next(self.values[name]))}" if name in self.values else text)
        return value

    def row(self, name, value):
        self.rows.append(f"| {name} | `{self.cursor.data[self.seen:self.cursor.position].hex(' ')}` | {value} |")
        self.seen, self.vector = self.cursor.position, []

    def extension(self, walk):
        self.plain_varint()
        self.bytes(self.plain_varint())
        self.row("extension record", "")


def explain_declaration(file, data):
    f = Explained(data[:file.first_record], file.declaration.deformables)
    f.bytes(4)
    f.row("magic", "")
    f.number("version", "B")
    f.row("profile", f.bytes(1)[0])
    flags, size = f.number("flags", "H"), f.number("body_size", "I")
    end, f.cursor.end = f.cursor.end, f.cursor.position + size
    elements_of_body(f, flags)
    f.cursor.end = end
    f.number("crc", "I")
    table("element | bytes | value", f.rows)
    for item in file.declaration.deformables:
        tree = deformable_main.Hierarchy(item)
        rows = [f"| {v} | {tree.depth[v]} | {vector(tree.parents[0][v])} | {vector(tree.weights[0][v])} |" for v in tree.order]
        print("Coding order, parents and weights:\n")
        table("vertex | depth | parents | weights", rows)


def content_of(name: str) -> bytes:
    """A file, or the input of a vector."""
    if not Path(name).exists():
        for case in load_cases(Path(__file__).resolve().parent)[0]:
            if case.id == name:
                return read_input(case)
    return Path(name).read_bytes()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("stream", metavar="STREAM", help="stream file (.tct), or the id of a vector, as rigid/001-one-axis")
    parser.add_argument("number", metavar="NUMBER", type=int, nargs="?", default=0, help="of the packet, from 0 [0]")
    parser.add_argument("--symbols", action="store_true", help="leave out the table of single bits")
    parser.add_argument("--declaration", action="store_true", help="the scene declaration instead of a packet")
    parser.add_argument("--lose", metavar="N", type=int, nargs="+", help="play all packets but these, and list what is refused")
    arguments = parser.parse_args()
    try:
        content = content_of(arguments.stream)
        stream = File(content)
        if arguments.declaration:
            explain_declaration(stream, content)
        elif arguments.lose:
            play(stream, set(arguments.lose))
        else:
            explain(stream, arguments.number, not arguments.symbols)
    except OSError as error:
        sys.exit(f"{arguments.stream}: {error.strerror}")
    except StreamError as error:
        sys.exit(f"{arguments.stream}: {error}")
