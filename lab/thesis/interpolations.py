# SPDX-License-Identifier: Apache-2.0
"""Figure 3.8 asks people which interpolation they prefer. In its place: what each one does to force and object.

One run per seed, whose hand feels the client without interpolation; clients of all interpolations are sent the same packets. A second run per
seed, whose hand feels a smoothed client (spec 60-client 8), has packets of its own.
"""
import math

from common import figure, table

from .made import DEGREE, Made, lines, mean, points

SCENES, DEADBANDS = ("push-1dof", "rotate-6dof", "rotate-push-lift"), (0.04, 0.25)  # the second is the thesis's (3.2.3.2)
INTERPOLATIONS = ("none", "linear", "hermite", "blending")
HEAD = ["scene", "p", "packets/s", "interpolation", "out of the rule", "worst", "force step p50", "p99", "max", "acceleration p90 [m/s2]", "p99"]
LEGEND = """
out of the rule  fraction of the ticks in contact in which the normal force at what is shown is off by more than the rule permits
worst            largest error as a multiple of what is permitted
force step       change of the normal force's error in the tick of an update, over the force (above the floor)
acceleration     of the shown object in contact, between updates; a step of the grid in 1 ms is 0.24 m/s2""".split("\n")


def quantile(ordered, fraction):
    return ordered[math.floor(fraction * (len(ordered) - 1) + 0.5)] if ordered else 0


def interpolations(options):
    requests = [request for scene in SCENES for p in DEADBANDS for seed in range(1, options.seeds + 1)
                for request in requests_of(options, scene, p, seed)]
    found = iter(points(options, "reproduce", "interpolations", requests))
    rows, drawn = [], None
    for scene in SCENES:
        for p in DEADBANDS:
            runs = [(next(found), next(found)) for _ in range(options.seeds)]
            if scene == SCENES[0] and p == DEADBANDS[-1]:
                drawn = runs[0][0]["curves"]
            rows.append({"scene": scene, "deadband": p, "packets_per_s": [same["packets_per_s"] for same, _ in runs],
                         "smoothed_packets_per_s": [smoothed["packets_per_s"] for _, smoothed in runs],
                         "interpolations": [effect(name, [same["interpolations"][i] for same, _ in runs]) for i, name in enumerate(INTERPOLATIONS)]
                         + [effect("smoothed", [smoothed["interpolations"][0] for _, smoothed in runs])]})
    report = {"schema": "tactus.reproduce_interpolations/1", "figure": "fig3.8", "seeds": options.seeds, "grip": options.grip, "rows": rows}
    return Made(report, text_of(options, rows), lambda: draw(drawn), {"fig3.8": curves_table(drawn)})


def requests_of(options, scene, p, seed):
    """Clients of all interpolations; a smoothed client, which is that of profile main without interpolation."""
    common = {"scene": scene, "deadband": p, "visual_position_m": 0.01 * options.length_unit, "visual_rotation_rad": 4 * DEGREE,
              "grip": options.grip, "seed": seed}  # bounds: table 3.3, with interpolation
    has_curves = scene == SCENES[0] and p == DEADBANDS[-1] and seed == 1
    return (common | {"profile": "thesis", "interpolations": INTERPOLATIONS, "curves": has_curves},
            common | {"profile": "main", "interpolations": ["none"]})


def effect(name, runs):
    """Of all seeds."""
    steps, accelerations = (sorted(value for run in runs for value in run[of]) for of in ("force_steps", "accelerations_m_per_s2"))
    return {"interpolation": name, "ticks_in_contact": sum(run["ticks_in_contact"] for run in runs),
            "ticks_over": sum(run["ticks_over"] for run in runs), "worst_ratio": max(run["worst_ratio"] for run in runs),
            "force_step": [quantile(steps, fraction) for fraction in (0.5, 0.99, 1)],
            "acceleration_m_per_s2": [quantile(accelerations, fraction) for fraction in (0.9, 0.99)]}


def text_of(options, rows):
    percent = lambda fraction: f"{100 * fraction:.2f} %"
    cells = []
    for row in rows:
        for i, of in enumerate(row["interpolations"]):
            rate = {0: "packets_per_s", len(INTERPOLATIONS): "smoothed_packets_per_s"}.get(i)
            cells.append([row["scene"] if i == 0 else "", f"{100 * row['deadband']:.0f} %" if i == 0 else "",
                          f"{mean(row[rate]):.1f}" if rate else "", of["interpolation"], percent(of["ticks_over"] / max(of["ticks_in_contact"], 1)),
                          f"{of['worst_ratio']:.2f}", *map(percent, of["force_step"]),
                          *[f"{a:.2f}" for a in of["acceleration_m_per_s2"]]])
    return lines(f"Thesis figure 3.8, the part that needs no people: kinds of interpolation, seeds 1 to {options.seeds}. All but the last are "
                 "sent the same packets,", "and the hand feels the client without interpolation. The last is that of profile main: the hand "
                 "feels it.", "", table.aligned(HEAD, cells), LEGEND)


def curves_table(curves):
    return ["time_s", "server_N", *[f"{name}_N" for name in INTERPOLATIONS]], [[f"{1e-3 * i:.3f}", *[f"{v:.6g}" for v in row]]
                                                                  for i, row in enumerate(curves)]


def draw(curves):
    """Seed 1 of the push at the thesis's deadband: a piece of the contact, and all of it."""
    fig, panels = figure.panels(2, shared=False)
    touched = [i for i, row in enumerate(curves) if row[0]]
    middle = touched[len(touched) // 3]
    for axes, (begin, end) in zip(panels, ((touched[0], touched[-1] + 1), (middle, min(middle + 300, touched[-1])))):
        t = [1e-3 * i for i in range(begin, end)]
        axes.plot(t, [row[0] for row in curves[begin:end]], color="0.7", linewidth=3, label="at the server")
        for number, name in enumerate(INTERPOLATIONS):
            axes.plot(t, [row[1 + number] for row in curves[begin:end]], label={"none": "no interpolation"}.get(name, name),
                      **figure.style_of(number, marked=False) | {"linewidth": 1.0})
        axes.set(xlabel="time [s]", ylabel="normal force [N]")
    panels[0].set_title("push-1dof, p = 25 %, seed 1: the contact, and a piece of it")
    figure.legend(fig, panels)
    return fig
