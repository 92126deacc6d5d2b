# SPDX-License-Identifier: Apache-2.0
"""What `tactus bench world` reckons with: unit costs, fitted to sessions of tactus-study with interest and to a scene of the simulator.

COSTS are those of reports/world/measured.csv (a test fits them again); `tactus bench world --measure` measures them where it runs.
"""
import csv
import math
import os
import sys
import tempfile

from common import program
from common.arguments import Refusal, how_to_install

try:
    import numpy
except ImportError:
    numpy = None  # who needs it asks needs_numpy()

LODS, OUT, HYSTERESIS = 7, 7, 1.15  # levels of detail 0 to 6, out of interest: spec/44-interest.md sections 1 and 3
# CPU [us] per tick of 1 ms; bits with those of the session and without UDP and IPv4; from full interest to the widest bounds.
COSTS = {
    "session_us": 0.48, "truth_us": 0.044, "truth_of_1000_us": 0.00099, "look_us": 0.0022, "tell_us": 0.15, "packet_us": 26.0,
    "packet_of_1000_us": 0.89, "physics_us": 2.9, "memory_byte": 800.0, "idle_bit_per_s": 1800.0, "idle_datagrams_per_s": 10.0,
    "change_bit": 87.0, "head_byte": 28.0, "bit_per_s": [1000.0, 890.0, 610.0, 500.0, 320.0, 220.0, 220.0], "updates_per_s": [8.8, 4.7, 3.9,
    3.6, 3.1, 3.0, 3.0],
}
WHAT = {
    "session_us": "per client and tick",
    "truth_us": "per object that moves and tick, once for all clients",
    "truth_of_1000_us": "the same, per 1000 declared objects",
    "look_us": "per client, tick and object that moves, near or far",
    "tell_us": "per client, tick and object in its interest that moves, nothing shared between clients",
    "packet_us": "per packet",
    "packet_of_1000_us": "per packet and 1000 declared objects",
    "physics_us": "per body that moves and tick",
    "memory_byte": "per client and declared object at the server",
    "idle_bit_per_s": "per client",
    "idle_datagrams_per_s": "per client",
    "change_bit": "per change of a level of detail",
    "head_byte": "per datagram: UDP and IPv4",
    "bit_per_s": "per object that moves, at lod 0, 1, ...; 6 not measured, as 5",
    "updates_per_s": "per object that moves, at lod 0, 1, ...",
}

# clients, objects, moving, reach [m], ticks: all with a full interest of 1 m; without reach all are sent all
POINTS = [(16, 10_000, 10_000, reach, 200) for reach in (1, 2, 4, 8, 16, 32)] + [
    (4, 10_000, 10_000, 1, 200), (64, 10_000, 1000, 1, 200), (64, 10_000, 10, 1, 600), (64, 10_000, 1000, 8, 600),
    (16, 10_000, 0, 8, 1000), (16, 10_000, 0, 32, 1000), (64, 10_000, 0, 8, 1000), (64, 1000, 1000, 8, 600), (4, 100_000, 0, 8, 600),
    (4, 100_000, 10_000, 1, 200), (4, 100_000, 10_000, 8, 200), (1000, 10, 10, 1, 300), (64, 1000, 100, 0, 600)]
COST_HEAD = ["cost", "amount", "what"]
PILES = 64  # bodies of the scene of the simulator
HEAD = ["what", "clients", "objects", "moving", "reach_m", "tick_s", "bytes_per_client_server", "down_bytes_per_tick", "down_datagrams_per_tick",
        *(f"moving_in_lod{level}" for level in range(LODS)), "lod_changes_per_tick"]


def needs_numpy():
    if numpy is None:
        raise Refusal(f"this study needs NumPy, which {sys.executable} does not find", how_to_install("numpy"))


def measure(progress):
    """out  rows of measured.csv, as text"""
    rows = []
    for clients, objects, moving, reach, ticks in POINTS:
        point = program.point("scale", clients=clients, objects=objects, moving=moving, reach=reach, ticks=ticks, names_moved=True,
                              spread=reach > 0)
        lods, changes = near(clients, objects, moving, reach, ticks)
        down = point["down_per_client_and_tick"]
        rows.append(["session", clients, objects, moving, reach, *(f"{number:.6g}" for number in (
            point["tick_s"]["mean"], point["bytes_per_client"]["server"], down["bytes"], down["datagrams"], *lods, changes))])
        progress.step()
    with tempfile.TemporaryDirectory() as folder:
        scene = os.path.join(folder, "piles.toml")
        with open(scene, "w", encoding="utf8") as file:
            file.write(piles(PILES))
        time = program.report(["sim", scene, "-o", os.path.join(folder, "piles.mcap")])["time"]["simulate"]
    rows.append(["physics", 0, PILES, PILES, 0, f"{time['cpu_total_s'] / time['count']:.6g}", *[0] * (len(HEAD) - 6)])
    progress.step()
    return [[str(cell) for cell in row] for row in rows]


def near(clients, objects, moving, reach, ticks):
    """Of the world of tactus-study: per client, objects that move at each level of detail, and changes of levels in a tick."""
    number = numpy.arange(objects)
    home = numpy.stack([number % 100, number // 100 % 100, number // 10_000], axis=1).astype(float)
    moves = numpy.zeros(objects, bool)
    moves[numpy.arange(moving) * max(1, objects // max(1, moving) if reach else 1)] = True
    if not reach:
        return [moving] + [0] * (LODS - 1), 0
    limits = level_limits(1, reach)
    levels = numpy.full((clients, objects), LODS)
    lods, changes, steps = numpy.zeros(LODS), 0, 0
    for step in range((2000 + ticks) // 200):  # 2 s of warm-up
        for client in range(clients):
            turn = 1.4 / 5 * 0.2 * step + client
            centre = numpy.array([7.0 * (client % 13), 11.0 * (client // 13 % 9), 1.6])
            away = home - (centre + 5 * numpy.array([math.cos(turn), math.sin(turn), 0]))
            now = levels_at(limits, numpy.sqrt((away * away).sum(axis=1)), levels[client])
            if step >= 10:
                changes += int((now != levels[client]).sum())
                lods += numpy.bincount(now[moves], minlength=LODS + 1)[:LODS]
            levels[client] = now
        steps += step >= 10
    return lods / steps / clients, changes / steps / clients / 200


def level_limits(full, reach):
    """[m] up to which the levels go.   spec/44-interest.md section 3"""
    limits = numpy.minimum(full * 2.0 ** numpy.arange(LODS), reach)
    limits[-1] = reach
    return limits


def levels_at(limits, distances, before):
    """Levels of detail with their hysteresis, 7 beyond reach."""
    wanted = numpy.searchsorted(limits, distances)
    return numpy.where(wanted <= before, wanted, numpy.maximum(before, numpy.searchsorted(limits, distances / HYSTERESIS)))


def piles(bodies):
    """A scene: cubes that fall onto each other, eight in a pile, and come to rest within its second."""
    out = ['name = "piles"\nduration = 1.0\ngravity = [0.0, 0.0, -9.81]\nfloor = 0.0\n']
    for i in range(bodies):
        pile, k = divmod(i, 8)
        position = [0.6 * (pile % 8) + 0.051 * (k % 2), 0.6 * (pile // 8) + 0.051 * (k // 2 % 2), 0.06 + 0.09 * (k // 4) + 0.02 * k]
        turn = [0.9, 0.3, 0.2, 0.1 + 0.02 * (i % 9)]
        length = math.hypot(*turn)
        out.append(f'[[object]]\nname = "b{i}"\nsize = [0.05, 0.05, 0.05]\nmass = 0.15\nfriction = 0.3\n'
                   f"position = {position}\nrotation = {[part / length for part in turn]}\n")
    return "\n".join(out)


def fit(rows):
    """COSTS from rows of measured.csv, two digits each: least squares of relative errors.   in  rows  {column: text}"""
    sessions = [{key: float(cell) for key, cell in row.items() if key != "what"} for row in rows if row["what"] == "session"]
    (physics,) = (row for row in rows if row["what"] == "physics")
    column = {key: numpy.array([row[key] for row in sessions]) for key in HEAD[1:]}
    clients, objects, moving, changes = (column[key] for key in ("clients", "objects", "moving", "lod_changes_per_tick"))
    lods = numpy.stack([column[f"moving_in_lod{level}"] for level in range(LODS - 1)], axis=1)
    interest, all_move, rest = column["reach_m"] > 0, (moving == objects) & (objects == 10_000), moving == 0
    idle = (column["reach_m"] == 1) & (objects >= 10_000)

    packets = column["down_datagrams_per_tick"] - column["down_datagrams_per_tick"][idle].mean()
    terms = [clients, moving, moving * objects / 1000, clients * moving, clients * lods.sum(axis=1), clients * packets,
             clients * packets * objects / 1000]
    time = solve(numpy.stack(terms, axis=1)[interest], 1e6 * column["tick_s"][interest])

    bits, updates = 8000 * column["down_bytes_per_tick"], -1000 * numpy.log(1 - column["down_datagrams_per_tick"])
    idle_bits, idle_datagrams = bits[idle].mean(), updates[idle].mean()
    change_bit = ((bits[rest] - idle_bits) / (1000 * changes[rest])).mean()
    sent = (all_move & ~idle) | ~interest
    bit_per_s = solve(lods[sent], bits[sent] - idle_bits - 1000 * change_bit * changes[sent])
    updates_per_s = solve(lods[sent], updates[sent] - idle_datagrams - 1000 * changes[sent])
    big = objects >= 10_000
    out = dict(zip(("session_us", "truth_us", "truth_of_1000_us", "look_us", "tell_us", "packet_us", "packet_of_1000_us"), time))
    out |= {"physics_us": 1e6 * float(physics["tick_s"]) / float(physics["moving"]),
            "memory_byte": (column["bytes_per_client_server"] / objects)[big].mean(), "idle_bit_per_s": idle_bits,
            "idle_datagrams_per_s": idle_datagrams, "change_bit": change_bit, "head_byte": 28}
    return {name: two(cost) for name, cost in out.items()} | {
        name: [two(one) for one in (*cost, cost[-1])] for name, cost in (("bit_per_s", bit_per_s), ("updates_per_s", updates_per_s))}


def solve(terms, values):
    return numpy.linalg.lstsq(terms / values[:, None], numpy.ones(len(values)), rcond=None)[0]


def two(number):
    return float(f"{number:.2g}")


def digits(number):
    """Its text with three digits, without an exponent."""
    return f"{float(f'{number:.3g}'):.10f}".rstrip("0").rstrip(".")


def as_rows(costs):
    """A row for each number: bit_per_s[0], ..."""
    out = []
    for name, cost in costs.items():
        many = isinstance(cost, list)
        out += [[f"{name}[{i}]" if many else name, digits(one), WHAT[name]] for i, one in enumerate(cost if many else [cost])]
    return out


def read(path):
    """COSTS from such rows.   raises Refusal"""
    out = {}
    with open(path, encoding="utf8", newline="") as file:
        for line, row in enumerate(csv.DictReader(file), 2):
            name, _, index = (row.get("cost") or "").partition("[")
            try:
                amount = float(row["amount"])
                if name not in COSTS or not 0 <= amount < math.inf or bool(index) != isinstance(COSTS[name], list):
                    raise ValueError
            except (KeyError, TypeError, ValueError):
                raise Refusal(f"{path}: line {line} is no unit cost", "Give the costs.csv of `tactus bench world --measure`.") from None
            if index:
                out.setdefault(name, []).append(amount)
            else:
                out[name] = amount
    missing = [name for name, cost in COSTS.items() if name not in out or (isinstance(cost, list) and len(out[name]) != len(cost))]
    if missing:
        raise Refusal(f"{path}: lacks {', '.join(missing)}", "Give the costs.csv of `tactus bench world --measure`.")
    return out
