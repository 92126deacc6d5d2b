#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Decode one packet of a stream file and explain every step as Markdown tables; or its scene declaration, or what losses do to it."""
import argparse
import struct
import sys
from pathlib import Path

import deformable_main
import load
import rigid
import thesis_mesh
from conventions import Cursor, StreamError, clamp, round_shift, zigzag
from decoder import File, SceneDecoder
from deformable_header import CLUSTERS, COMPUTED, MAIN, NO_BASIS
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
class Fields:
    """Walks over a declaration that is known to be valid."""

    def __init__(self, data):
        self.cursor, self.rows = Cursor(data, 0, len(data)), []

    def add(self, name, start, value):
        self.rows.append(f"| {name} | `{self.cursor.data[start:self.cursor.position].hex(' ')}` | {value} |")
        return value

    def number(self, name, form):
        start = self.cursor.position
        values = struct.unpack("<" + form, self.cursor.take(struct.calcsize("<" + form), ("", "")))
        return self.add(name, start, values[0] if len(values) == 1 else vector(values))

    def take(self, name, size, text=False):
        start = self.cursor.position
        data = self.cursor.take(size, ("", ""))
        return self.add(name, start, f'"{data.decode()}"' if text else "")

    def varint(self, name):
        start = self.cursor.position
        return self.add(name, start, self.cursor.varint(("", ""), ("", "")))

    def differences(self, name, count, value=None):
        start = self.cursor.position
        differences = [zigzag(self.cursor.varint(("", ""), ("", ""))) for _ in range(count)]
        self.add(name, start, f"differences {vector(differences)}" + (f": {vector(value)}" if value else ""))

    def three(self, name, value):
        self.differences(name, 3, value)


def explain_declaration(file, data):
    f, end = Fields(data), file.first_record
    f.take("magic", 4)
    for name, form in (("version", "B"), ("profile", "B"), ("flags", "H"), ("body_size", "I"), ("tick_rate", "I"),
                       ("position_exp", "B"), ("velocity_exp", "B"), ("rotation_exp", "B"), ("angular_exp", "B"),
                       ("max_extrapolation", "H"), ("baseline_span", "B")):
        f.number(name, form)
    for _ in range(f.varint("object_count")):
        f.number("kind", "B")
        f.number("dof", "B")
        f.take("name", f.number("name_size", "B"), True)
        f.number("position", "3i")
        f.number("rotation", "4i")
    if file.declaration.deformables:
        f.varint("deformable_count")
        for item in file.declaration.deformables:
            explain_deformable(f, item)
    if file.declaration.loads:
        f.number("force_exp", "B")
        f.number("load_users", "B")
    if file.declaration.motion:
        f.number("gravity", "3i")
        f.number("slide_deceleration", "i")
    for i in file.declaration.driven:
        for name, form in (("coupling", "I"), ("hold", "I"), ("inertia", "3I"), ("friction", "H"), ("damping", "H")):
            f.number(f"{name} of object {i}", form)
    if any(item.body for item in file.declaration.deformables):
        for item in file.declaration.deformables:
            if f.number("method", "B"):
                explain_elastic(f, item)
    if file.declaration.interest:
        f.number("full", "I")
        f.number("reach", "I")
    if f.cursor.position < end - 4:
        f.take("extension records", end - 4 - f.cursor.position)
    f.number("crc", "I")
    table("element | bytes | value", f.rows)
    for item in file.declaration.deformables:
        tree = deformable_main.Hierarchy(item)
        rows = [f"| {v} | {tree.depth[v]} | {vector(tree.parents[0][v])} | {vector(tree.weights[0][v])} |" for v in tree.order]
        print("Coding order, parents and weights:\n")
        table("vertex | depth | parents | weights", rows)


def explain_deformable(f, item):
    f.number("profile", "B")
    f.take("name", f.number("name_size", "B"), True)
    f.number("rings", "B")
    main = item.profile == MAIN
    for name, form in (("frame_period", "I"), ("layered", "B"), ("fade", "H"), ("weight_sets", "B")) if main else (("quant_bits", "B"), ("models_kept", "B")):
        f.number(name, form)
    f.varint("vertex_count")
    f.varint("triangle_count")
    for v, rest in enumerate(item.rest):
        f.three(f"rest[{v}]", rest)
    for t, corners in enumerate(item.triangles):
        f.three(f"corners of triangle {t}", corners)
    basis = f.number("basis", "B") if main else NO_BASIS
    if basis == NO_BASIS:
        return
    if basis == CLUSTERS:
        f.varint("cluster_count")
        f.number("blend", "B")
        for i in range(f.varint("surprise_count")):
            f.varint(f"gap[{i}]")
            f.varint(f"cluster[{i}]")
        return
    f.varint("mode_count")
    if basis == COMPUTED:
        for run in range(f.varint("run_count")):
            f.varint(f"gap[{run}]")
            f.varint(f"more[{run}]")
        return
    for k in range(item.mode_count):
        f.number(f"mode_step[{k}]", "H")
        f.take(f"entries of mode {k}", sum(1 if -64 <= e < 64 else 2 for e in item.modes[k].entries))


def explain_elastic(f, item):
    for name, form in (("mass_damping", "d"), ("stiffness_damping", "d"), ("gravity", "3d"), ("coupling", "d"), ("friction", "d")):
        f.number(name, form)
    for i in range(f.number("material_count", "B")):
        for name in ("young", "poisson", "density"):
            f.number(f"{name}[{i}]", "d")
    inner_count, tet_count = f.varint("inner_count"), f.varint("tet_count")
    for i in range(inner_count):
        f.differences(f"inner[{i}]", 3)
    for i in range(tet_count):
        f.differences(f"corners of tetrahedron {i}", 4, item.body.tetrahedra[i])
    left = tet_count if len(item.body.materials) > 1 else 0
    while left > 0:
        left -= f.varint("length")
        f.number("material", "B")
    for run in range(f.varint("run_count")):
        f.varint(f"gap[{run}]")
        f.varint(f"more[{run}]")


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
