# SPDX-License-Identifier: Apache-2.0
"""`tactus bench world`: a plan on paper for a large world on several servers, reckoned in virtual time from measured unit costs.

world_model has the world, world_costs what each thing costs and how that was measured.
"""
import argparse

from common import arguments, figure, program
from studies import report, world_costs

CASES = [  # servers, objects, what else
    (1, 100_000, {}), (4, 100_000, {}), (8, 100_000, {}), (16, 100_000, {}), (8, 100_000, {"stirred": 2}), (8, 100_000, {"reach": 8.0}),
    (8, 100_000, {"reach": 32.0}), (8, 100_000, {"physics": 0.5}), (8, 100_000, {"physics": 2.0}), (8, 100_000, {"sessions": 2.0}),
    (8, 100_000, {"declared": 0.0})]
SHORT = [(1, 5000, {"users": 50, "side": 100.0}), (4, 5000, {"users": 50, "side": 100.0})]
SHORT_SECONDS = 3
NAMES = {"declared": "declared objects"}
FIGURE = 3  # the row whose seed is drawn: 16 servers
FACTORS = {"physics": ["physics_us"],
           "sessions": ["session_us", "truth_us", "truth_of_1000_us", "look_us", "tell_us", "packet_us", "packet_of_1000_us"],
           "declared": ["truth_of_1000_us", "packet_of_1000_us"]}  # objects that are declared and have nothing to send
QUANTITIES = [  # key, heading, scale, unit in CSV
    ("moving", "move", 1, ""), ("members", "in interest", 1, ""), ("told", "of them move", 1, ""), ("changes_per_s", "lod changes/s", 1, ""),
    ("down", "down [kbit/s]", 1e-3, "_bit_per_s"), ("down_most", "most [kbit/s]", 1e-3, "_bit_per_s"),
    ("cpu_mean", "CPU mean [ms]", 1e3, "_s"), ("cpu_fullest", "fullest [ms]", 1e3, "_s"), ("cpu_worst", "worst [ms]", 1e3, "_s"),
    ("physics", "physics [ms]", 1e3, "_s"), ("hand_over_users", "users/s", 1, "_per_s"), ("hand_over_objects", "objects/s", 1, "_per_s"),
    ("splits", "splits", 1, ""), ("split_objects", "objects a split", 1, ""), ("ghosts", "ghosts", 1, ""),
    ("between", "between [Mbit/s]", 1e-6, "_bit_per_s"), ("memory", "memory [GB]", 1e-9, "_byte")]


def parser(what):
    made = arguments.parser("bench world", what, "Examples:\n  tactus bench world -o world\n  tactus bench world --case 4,200,20000 --seeds 1\n"
                            "  tactus bench world --measure -o costs && tactus bench world --costs costs/costs.csv")
    made.add_argument("--case", action="append", default=[], type=case, metavar="SERVERS,USERS,OBJECTS[,REACH]",
                      help="Such a case instead of those of the table, reach in metres [16]; may be repeated")
    made.add_argument("--seconds", type=arguments.whole(1, 3600), metavar="N", help="Of virtual time, after five [10]")
    made.add_argument("--seeds", default=3, type=arguments.whole(1, 1000), metavar="N", help="Worlds of each case [3]")
    made.add_argument("--first-seed", default=1, type=arguments.whole(0, 2**32 - 1), metavar="N", help="Seed of the first [1]")
    made.add_argument("--costs", metavar="FILE", help="Unit costs, a costs.csv of --measure [those of reports/world]")
    made.add_argument("--measure", action="store_true", help="Measure unit costs here, and nothing else: 10 minutes, with tactus-study")
    made.add_argument("--short", action="store_true", help="Run two small cases")
    arguments.add_report_options(made, output_help="Folder for report.md, CSV and figures", force=True)
    return made


def case(typed):
    try:
        servers, users, objects, *reach = (int(word) for word in typed.split(","))
        if not (1 <= servers <= 256 and 1 <= users <= 10_000 and servers <= objects <= 2_000_000 and len(reach) < 2):
            raise ValueError
        return servers, objects, {"users": users} | ({"reach": float(reach[0])} if reach and 1 <= reach[0] <= 64 else {})
    except ValueError:
        raise argparse.ArgumentTypeError(f"{typed}: give 1 to 256 servers, 1 to 10000 users, up to 2000000 objects, and a reach of 1 to "
                                         "64 m, as in 8,1000,100000,16") from None


def work(options):
    world_costs.needs_numpy()
    if options.measure:
        return measure(options)
    from studies import world_model
    folder = report.Folder(options.output, ("report.md", "world.csv", "costs.csv"), options.force)
    costs = world_costs.read(options.costs) if options.costs else world_costs.COSTS
    asked = options.case or (SHORT if options.short else CASES)
    seconds = options.seconds or (SHORT_SECONDS if options.short else 10)
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    progress = program.Progress("bench world", len(asked) * len(seeds), not (options.quiet or options.no_progress))
    rows, drawn = [], None
    for number, (servers, objects, more) in enumerate(asked):
        rows.append({"servers": servers, "objects": objects, "more": more, "seeds": []})
        for seed in seeds:
            setting = world_model.Setting(objects, servers=servers, seed=seed, seconds=seconds,
                                          **{key: value for key, value in more.items() if key not in FACTORS})
            steps, splits = world_model.run(setting, scaled(costs, more))
            rows[-1]["users"], rows[-1]["reach"] = setting.users, setting.reach
            rows[-1]["seeds"].append({"seed": seed} | world_model.summary(setting, costs, steps, splits))
            if seed == seeds[0] and number == min(FIGURE, len(asked) - 1):
                drawn = steps, splits
            progress.step()
    progress.clear()
    write(folder, options, rows, costs, seconds, drawn)


def write(folder, options, rows, costs, seconds, drawn):
    if options.output:
        has_figure = folder.draw("world", lambda: draw(*drawn))
        folder.write_csv("costs.csv", world_costs.COST_HEAD, world_costs.as_rows(costs))
        folder.write_csv("world.csv", ["servers", "users", "objects", "reach_m", "what", "seed", *(key + unit for key, _, _, unit in QUANTITIES)],
                         csv_rows(rows))
        folder.write("report.md", markdown(rows, options, seconds, costs, has_figure))
    if options.json:
        report.print_json({"schema": "tactus.world/1", "costs": costs, "seconds": seconds, "rows": [as_json(row) for row in rows]})
    elif not options.quiet:
        report.show(columns(), [cells(row) for row in rows])


def measure(options):
    folder = report.Folder(options.output, ("measured.csv", "costs.csv"), options.force)
    progress = program.Progress("bench world", len(world_costs.POINTS) + 1, not (options.quiet or options.no_progress))
    rows = world_costs.measure(progress)
    progress.clear()
    costs = world_costs.fit([dict(zip(world_costs.HEAD, row)) for row in rows])
    if options.output:
        folder.write_csv("measured.csv", world_costs.HEAD, rows)
        folder.write_csv("costs.csv", world_costs.COST_HEAD, world_costs.as_rows(costs))
    if options.json:
        report.print_json({"schema": "tactus.world/1", "context": report.context(), "costs": costs})
    elif not options.quiet:
        report.show(world_costs.COST_HEAD, world_costs.as_rows(costs))


def scaled(costs, more):
    """Unit costs times the factor of a case."""
    return costs | {name: costs[name] * more[group] for group, names in FACTORS.items() if group in more for name in names}


def remarks(row):
    parts = [f"{row['more'][group]:g} x cost of {NAMES.get(group, group)}" for group in FACTORS if group in row["more"]]
    return ", ".join(parts + [f"{key} {value:g}" for key, value in row["more"].items() if key == "stirred"])


def columns():
    return ["servers", "users", "objects", "reach [m]", "", *(heading for _, heading, _, _ in QUANTITIES)]


def cells(row):
    """Means over the seeds, and from the least to the largest where they differ in two digits."""
    return [row["servers"], row["users"], row["objects"], f"{row['reach']:g}", remarks(row),
            *(spread([one[key] * scale for one in row["seeds"]]) for key, _, scale, _ in QUANTITIES)]


def spread(values):
    mean, low, high = (world_costs.digits(value) for value in (sum(values) / len(values), min(values), max(values)))
    return mean if low == high else f"{mean} ({low} to {high})"


def csv_rows(rows):
    return [[row["servers"], row["users"], row["objects"], f"{row['reach']:g}", remarks(row), one["seed"],
             *(f"{one[key]:.6g}" for key, *_ in QUANTITIES)] for row in rows for one in row["seeds"]]


def as_json(row):
    return {"servers": row["servers"], "users": row["users"], "objects": row["objects"], "reach_m": row["reach"]} | {
        f"cost_of_{group}": row["more"].get(group, 1) for group in FACTORS} | {"seeds": [
            {"seed": one["seed"]} | {key + unit: one[key] for key, _, _, unit in QUANTITIES} for one in row["seeds"]]}


def markdown(rows, options, seconds, costs, has_figure):
    first = options.first_seed
    return ("# A large world on several servers, on paper\n\n"
            f"`tactus bench world`: {seconds} s of virtual time, seeds {first} to {first + options.seeds - 1}; means, and from the least to the "
            "largest of the seeds. Nothing here ran on a network: users, objects and regions are simulated, costs are those of the second "
            "table. *CPU*: of one server in a tick of 1 ms: mean of all, the fullest at a time, the worst step of 200 ms; *physics* is the "
            "part of the mean that the simulation takes. *Users/s*, *objects/s*: hand-overs across borders. *Ghosts*: moving objects of "
            "others that servers know of. *Memory*: of the server with the most users, if it declares all objects.\n\n" +
            report.markdown(columns(), [cells(row) for row in rows], left=0) +
            ("\n![load of the servers, hand-overs](world.svg)\n" if has_figure else "") +
            "\n## Unit costs\n\n" + report.markdown(world_costs.COST_HEAD, world_costs.as_rows(costs)))


def draw(steps, splits):
    """Load of each server and hand-overs over time."""
    from studies.world_model import STEP
    time = [STEP * (i + 1) for i in range(len(steps))]
    fig, (load, over) = figure.panels(2)
    for server in range(steps[0]["load"].shape[1]):
        load.plot(time, [1e-3 * step["load"][:, server].sum() for step in steps], color=figure.COLOURS[0], linewidth=0.7)
    load.set_ylabel("CPU of each server\nin a tick [ms]")
    for number, (key, label) in enumerate((("hand_over_users", "users"), ("hand_over_objects", "objects"))):
        sums = [sum(step[key] for step in steps[:i + 1]) for i in range(len(steps))]
        figure.line(over, time, sums, number, label, marked=False)
    for when, *_ in splits:
        for axes in (load, over):
            axes.axvline(when, color="#888888", linestyle="--", linewidth=0.8)
    over.set_ylabel("hand-overs across\nborders, sum")
    over.set_xlabel("time [s]; dashed: regions are split anew")
    load.set_ylim(bottom=0)
    over.legend(loc="upper left")
    return fig
