# SPDX-License-Identifier: Apache-2.0
"""`tactus bench delay [SCENE...]`: force and picture of each user behind a round trip, by kind of client.

They are held against those without delay.
"""
import argparse
import shlex

from common import arguments, figure, program
from common.arguments import USAGE, Refusal
from studies import report

SCENES = ["push-cube", "rotate-6dof", "rotate-push-lift", "jenga-press", "jenga-together", "jenga-against", "msd-1d"]
ROUND_TRIPS = "25ms,50ms,75ms,100ms,150ms,200ms,300ms"
# Key of the point, name in CSV and JSON, title in tables, scale, digits in tables.
QUANTITIES = [
    ("mean_force_over", "mean_force_over_percent", "mean force [%]", 100, 0),
    ("peak_force_over", "peak_force_over_percent", "peak [%]", 100, 0),
    ("outside_10_percent", "outside_10_percent_of_force_percent", "outside 10 % [%]", 100, 0),
    ("least_energy_J", "least_energy_mj", "energy [mJ]", 1e3, 0),
    ("force_error", "same_motion_force_error_percent", "force error [%]", 100, 1),
    ("seen_away_rms_m", "same_motion_seen_away_rms_mm", "seen away [mm]", 1e3, 2),
    ("seen_away_95_m", "same_motion_seen_away_95_mm", "95 % of it", 1e3, 2),
    ("users_apart_95_m", "same_motion_users_apart_95_mm", "users apart [mm]", 1e3, 2),
]
CLIENTS = {"none": "nothing", "stiffness": "softer rendering", "stiffness-thesis": "softer, as printed", "simulation": "own simulation",
           "simulation, 10 % off": "the same, 10 % off"}


def parser(what):
    made = arguments.parser("bench delay", what, "Example:\n  tactus bench delay push-cube --round-trip 50ms,100ms,200ms -o "
                                                 "delay")
    made.add_argument("scenes", metavar="SCENE", nargs="*", help="Scenes of one or two users [those that come with Tactus]")
    made.add_argument("--round-trip", default=ROUND_TRIPS, type=round_trips, metavar="TIME,..", help=f"Round trips "
                                                                                                     f"[{ROUND_TRIPS}]")
    made.add_argument("--seeds", default=3, type=arguments.whole(1, 1000), metavar="N", help="Hands and networks: so many seeds "
                                                                                             "[3]")
    made.add_argument("--first-seed", default=1, type=arguments.whole(0, 1_000_000), metavar="N", help="The first of them [1]")
    made.add_argument("--duration", default=8.0, type=duration, metavar="TIME", help="At most so much of each scene, 100ms to "
                                                                                     "3600s [8s]")
    arguments.add_report_options(made, output_help="Folder for report.md, CSV and figure", force=True)
    arguments.add_jobs(made)
    return made


def seconds(typed):
    """"50ms" as 0.05."""
    for unit, scale in (("ms", 1e-3), ("us", 1e-6), ("min", 60.0), ("s", 1.0)):
        if typed.endswith(unit):
            try:
                return float(typed[:-len(unit)]) * scale
            except ValueError:
                break
    raise argparse.ArgumentTypeError(f"{typed!r}: a time needs its unit: s, ms, us or min, such as 50ms")


def round_trips(typed):
    out = [seconds(word) for word in typed.split(",")]
    for time in out:
        if not 1e-3 <= time <= 1:
            raise argparse.ArgumentTypeError(f"{time:g} s: give times of 1ms to 1s")
    return [round(1e6 * time) for time in out]


def duration(typed):
    if not 0.1 <= seconds(typed) <= 3600:
        raise argparse.ArgumentTypeError(f"{typed}: give a time from 100ms to 3600s")
    return seconds(typed)


def work(options):
    folder = report.Folder(options.output, ("report.md", "delay.csv", "delay.svg"), options.force)
    scenes = options.scenes or default_scenes()
    rows = run(options, scenes)
    if options.output:
        drawn = folder.draw("delay", lambda: draw(rows))
        head = ["scene", "user", "round_trip_ms", "network", "clients", "seed", *(name for _, name, *_ in QUANTITIES)]
        folder.write_csv("delay.csv", head, csv_rows(rows, options.first_seed))
        folder.write("report.md", markdown(rows, options, scenes, drawn))
    if options.json:
        report.print_json({"schema": "tactus.delay/1", "context": report.context(), "rows": [as_json(row) for row in rows]})
    elif not options.quiet:
        for first, same in tables(rows):
            report.show(heading(first), [cells(row) for row in same])


def default_scenes():
    return SCENES + (["membrane"] if "fem" in program.version()["components"] else [])


def run(options, scenes):
    """A row for each user, network, round trip and kind of client, with the numbers of every seed."""
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    points = [(scene, varies, time, seed) for scene in scenes for varies in (False, True) for time in options.round_trip
              for seed in seeds]

    def compute(point):
        scene, varies, time, seed = point
        return program.point("delay", scene=scene, varies=varies, round_trip_us=time, seed=seed, duration_s=options.duration)

    progress = program.Progress("bench delay", len(points), not (options.quiet or options.no_progress))
    rows = {}  # in the order of tables: scene, user, network, round trip, clients
    made = program.side_by_side(compute, points, options.jobs, progress)
    for (scene, varies, time, _), result in zip(points, made):
        for user in result["users"]:
            for numbers in user["clients"]:
                key = (scenes.index(scene), user["user"], varies, time, numbers["clients"])
                row = {"scene": result["scene"], "user": user["user"], "round_trip_ms": 1e-3 * time,
                       "network": "gamma" if varies else "constant", "clients": numbers["clients"], "seeds": []}
                rows.setdefault(key, row)["seeds"].append(numbers)
    users = {}
    for key in rows:
        users.setdefault(key[:2], len(users))
    return [row for _, row in sorted(rows.items(), key=lambda item: (users[item[0][:2]], item[0][2]))]


def spread(row, key, scale):
    """Mean over the seeds, and the one farthest from zero.   out  None, None: there is nothing to measure"""
    values = [scale * numbers[key] for numbers in row["seeds"] if numbers[key] is not None]
    if not values:
        return None, None
    worst = 0.0
    for value in values:
        worst = value if abs(value) >= abs(worst) else worst
    return sum(values) / len(values), worst


def cell(row, key, scale, digits):
    mean, worst = spread(row, key, scale)
    if mean is None:
        return "-"
    number = lambda value: f"{0 if abs(value) < 0.5 * 10 ** -digits else value:.{digits}f}"
    return f"{number(mean)} ({number(worst)})" if len(row["seeds"]) > 1 else number(mean)


def heading(row):
    return [f"{row['scene']}, {row['user']}, {row['network']}", "clients", *(title for _, _, title, _, _ in QUANTITIES)]


def cells(row):
    return [f"{row['round_trip_ms']:g} ms", row["clients"], *(cell(row, key, scale, digits) for key, _, _, scale,
                                                              digits in QUANTITIES)]


def tables(rows):
    """Pairs of a row and all of its table: one for each scene, user and network."""
    out = []
    for row in rows:
        if not out or heading(out[-1][0])[0] != heading(row)[0]:
            out.append((row, []))
        out[-1][1].append(row)
    return out


def csv_rows(rows, first_seed):
    number = lambda value, scale: "nan" if value is None else f"{scale * value:.5g}"
    return [[row["scene"], row["user"], f"{row['round_trip_ms']:g}", row["network"], row["clients"], first_seed + i,
             *(number(numbers[key], scale) for key, _, _, scale, _ in QUANTITIES)]
            for row in rows for i, numbers in enumerate(row["seeds"])]


def as_json(row):
    out = {key: row[key] for key in ("scene", "user", "round_trip_ms", "network", "clients")}
    for key, name, _, scale, _ in QUANTITIES:
        mean, worst = spread(row, key, scale)
        if mean is not None:
            out[name] = {"mean": mean, "worst": worst}
    return out


def command_of(options, scenes):
    words = ["tactus", "bench", "delay", *(scenes if options.scenes else [])]
    usual = parser("").parse_args([])
    if options.round_trip != usual.round_trip:
        words += ["--round-trip", ",".join(f"{1e-3 * time:g}ms" for time in options.round_trip)]
    for name in ("seeds", "first_seed"):
        if getattr(options, name) != getattr(usual, name):
            words += ["--" + name.replace("_", "-"), str(getattr(options, name))]
    if options.duration != usual.duration:
        words += ["--duration", f"{options.duration:g}s"]
    return shlex.join(words)


def markdown(rows, options, scenes, drawn):
    context = report.context()
    out = (f"# Delay, and what clients do about it\n\n`{command_of(options, scenes)} -o DIR` ({context['compiler']}, "
           f"{context['build']} build). "
           "All of it is deterministic.\n\n"
           "Each user is behind a network of their own, *constant* or *gamma* (half of the round trip gamma distributed, a new "
           "value each "
           "0.5 s, behind adaptive playout); every state and device sample is sent, so that only the delay differs. Clients: "
           "*none* show the "
           "past as it comes; *stiffness* render it softer (thesis 4.2.3, 4.3.3), *stiffness-thesis* what is rigid by the thesis's "
           "algorithm 1 as printed; *simulation* simulate the scene themselves, "
           "and the server "
           "corrects them; *10 % off* do so with a mass, friction, stiffness and Young's modulus 10 % too high.\n\n"
           "Mean over the seeds and, in parentheses, the seed farthest from zero. Hands that feel the force, against the same "
           "hands without "
           "delay: *mean* and *peak* (99 %) *force* over that without delay, time *outside* of +-10 % of it, least *energy* "
           "that the device "
           "has put in. The same motion, that of the hands without delay: RMS of the *force error* over RMS of the force; how "
           "far *away* "
           "from its position without delay the touched point is *seen* (RMS, 95th percentile); how far *apart* two users see the "
           "object (95th "
           "percentile). The same rows, seed by seed, are in `delay.csv`.\n")
    if drawn:
        out += "\n![error of the force and of what is seen, over the round trip](delay.svg)\n"
    for first, same in tables(rows):
        out += "\n" + report.markdown(heading(first), [cells(row) for row in same], left=2)
    return out


def draw(rows):
    """Of the first user of each scene, constant delay: error of the force, and how far away what is touched is seen."""
    rows = [row for row in rows if row["network"] == "constant"]
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    first_users = {scene: next(row["user"] for row in rows if row["scene"] == scene) for scene in scenes}
    pyplot = figure.pyplot()
    fig, grid = pyplot.subplots(len(scenes), 2, squeeze=False, sharex=True, figsize=(figure.WIDTH, 0.9 + 1.7 * len(scenes)))
    panels = [("same_motion_force_error_percent", "force error [%]", 0.05), ("same_motion_seen_away_95_mm", "seen away, 95 % "
                                                                                                            "[mm]", 0.002)]
    for scene, axes in zip(scenes, grid):
        for panel, (name, label, least) in zip(axes, panels):
            key, _, _, scale, _ = next(q for q in QUANTITIES if q[1] == name)
            for number, (clients, title) in enumerate(CLIENTS.items()):
                same = [row for row in rows if (row["scene"], row["user"], row["clients"]) == (scene, first_users[scene],
                    clients)]
                points = [(row["round_trip_ms"], [scale * n[key] for n in row["seeds"] if n[key] is not None]) for row in same]
                points = [(x, [max(abs(v), least) for v in values]) for x, values in points if values]
                means = [sum(values) / len(values) for _, values in points]
                figure.line(panel, [x for x, _ in points], means, number, title, [min(v) for _, v in points], [max(v) for _,
                    v in points])
            figure.logarithmic(panel, "y")
            panel.set_ylim(bottom=least)
            panel.set_ylabel(label)
        axes[0].set_title(scene, loc="left")
    for panel in grid[-1]:
        panel.set_xlabel("round trip [ms]")
    fig.suptitle(" \n \n ")  # room for the legend
    fig.legend(*grid[0][0].get_legend_handles_labels(), loc="upper center", ncol=3, title="what clients do; bars: least and "
                                                                                          "largest seed")
    return fig
