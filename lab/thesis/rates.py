# SPDX-License-Identifier: Apache-2.0
"""Figures 3.6, 3.10 and 3.14: packets per second."""
import os
import tempfile

from common import figure, program, table

from .made import DEGREE, Made, about_faster_hand, deviation, lines, mean, plus_minus, points, with_spread

MEASURES = "packets_per_s", "packets_per_s_in_contact", "force_error_rms_N"


def states(options, scene, deadband, interpolation, seed):
    """A request: the client renders what it receives of the object."""
    return {"scene": scene, "sent": "states", "deadband": deadband, "visual_position_m": 0.01 * options.length_unit,
            "visual_rotation_rad": 4 * DEGREE, "interpolation": interpolation, "grip": options.grip, "seed": seed}  # bounds: 3.2.4.1


def over_seeds(options, requests):
    """By request, which lacks its seed: each measure's values of all seeds."""
    seeds = range(1, options.seeds + 1)
    found = iter(points(options, "reproduce", "rates", [request | {"seed": seed} for request in requests for seed in seeds]))
    by_request = [[next(found) for _ in seeds] for _ in requests]
    return [{measure: [run[measure] for run in runs] for measure in MEASURES} for runs in by_request]


def summary(values):
    return {measure: with_spread(of) for measure, of in values.items()}


def head(options, name):
    return {"schema": "tactus.reproduce_rates/1", "figure": name, "seeds": options.seeds, "length_unit_m": options.length_unit,
            "grip": options.grip}


def architectures(options):
    """Figure 3.6: packets per second to a client that is sent object states, and to one that is sent forces."""
    deadbands, scene = (0.01, 0.02, 0.05, 0.08, 0.12, 0.18, 0.25, 0.35, 0.5), "push-1dof"
    requests = []
    for p in deadbands:
        forces = {"scene": scene, "sent": "forces", "deadband": p, "grip": options.grip}
        requests += [states(options, scene, p, "none", 1), forces | {"predictor": "hold"}, forces | {"predictor": "linear"}]
    found = over_seeds(options, requests)
    rows = [(p, *found[3 * i:3 * i + 3]) for i, p in enumerate(deadbands)]
    rate = lambda of: mean(of["packets_per_s"])
    fewer = all(rate(sent) < min(rate(held), rate(linear)) for _, sent, held, linear in rows)
    report = head(options, "fig3.6") | {"scene": scene, "rows": [
        {"deadband": p, "states": summary(sent), "forces_held": summary(held), "forces_linear": summary(linear)}
        for p, sent, held, linear in rows], "states_need_fewer_packets": fewer}
    cells = [[f"{100 * p:.0f} %"] + [plus_minus(of["packets_per_s"]) for of in (sent, linear, held)]
             + [plus_minus(of["force_error_rms_N"], 3) for of in (sent, linear, held)] for p, sent, held, linear in rows]
    text = lines(f"Thesis figure 3.6: packets per second to a client that is sent object states (CS-State) or forces (CS-Force), {scene}, "
                 f"seeds 1 to {options.seeds}", "One user here, two in the thesis, whose figure has no numbers.", "",
                 table.aligned(["p", "CS-State", "CS-Force, linear", "CS-Force, hold", "force error, state [N]", "linear [N]", "hold [N]"],
                               cells), "",
                 f"CS-State needs fewer packets than CS-Force at every p: {'holds' if fewer else 'does not hold'}")
    return Made(report, text, lambda: draw_architectures(rows), {"fig3.6": rates_table(rows)})


def rates_table(rows):
    names = ("states", "forces_held", "forces_linear")
    return (["deadband"] + [f"{name}_{what}" for name in names for what in ("packets_per_s", "standard_deviation")],
            [[p] + [f"{f(of['packets_per_s']):.6g}" for of in found for f in (mean, deviation)] for p, *found in rows])


def draw_architectures(rows):
    fig, (axes,) = figure.panels()
    for number, name in enumerate(("object states", "forces, last value held", "forces, extrapolated linearly")):
        found = [row[1 + number]["packets_per_s"] for row in rows]
        figure.line(axes, [100 * row[0] for row in rows], list(map(mean, found)), number, name, list(map(min, found)), list(map(max, found)))
    axes.set(xscale="log", yscale="log", xlabel="deadband p [%]", ylabel="packets per second")
    ticks = [100 * row[0] for row in rows]
    axes.set_xticks(ticks, [f"{t:g}" for t in ticks])
    axes.set_xticks([], minor=True)
    axes.set_yticks((10, 20, 50, 100, 200, 500), ("10", "20", "50", "100", "200", "500"))
    axes.set_yticks([], minor=True)
    axes.legend(title="the client is sent")
    return fig


ADJUSTED = (("push-1dof", "none", 0.074, 13), ("push-1dof", "linear", 0.187, 7.5), ("rotate-6dof", "none", 0.01, 230),
            ("rotate-6dof", "linear", 0.037, 96))  # scene, interpolation, p, the thesis's packets/s


def adjusted(options):
    """Figure 3.10: updates per second in contact, at the deadbands that the subjects chose."""
    requests = []
    for scene, interpolation, p, _ in ADJUSTED:
        slow = states(options, scene, p, interpolation, 1)
        requests += [slow, slow | {"duration_scale": options.duration_scale, "tremor_m": options.tremor}]
    found = over_seeds(options, requests)
    rows = [(setting, found[2 * i], found[2 * i + 1]) for i, setting in enumerate(ADJUSTED)]
    report = head(options, "fig3.10") | {"faster_hand": {"duration_scale": options.duration_scale, "tremor_m": options.tremor}, "rows": [
        {"scene": scene, "interpolation": with_or_without(interpolation), "deadband": p, "thesis_packets_per_s": thesis,
         "states": summary(slow), "states_faster_hand": summary(fast)} for (scene, interpolation, p, thesis), slow, fast in rows]}
    cells = [[scene, with_or_without(interpolation), f"{100 * p:.1f} %"] + [plus_minus(of["packets_per_s_in_contact"]) for of in (slow, fast)]
             + [f"{thesis:g}"] + [f"{mean(of['packets_per_s_in_contact']) / thesis:.2f}" for of in (slow, fast)]
             for (scene, interpolation, p, thesis), slow, fast in rows]
    text = lines("Thesis figure 3.10: updates per second in contact, at the deadbands that its subjects chose, "
                 f"seeds 1 to {options.seeds}", about_faster_hand(options), "", table.aligned(
                     ["experiment", "interpolation", "p", "updates/s in contact", "faster hand", "thesis", "over thesis", "faster hand"],
                     cells))
    return Made(report, text, lambda: draw_adjusted(rows), {})


def with_or_without(interpolation):
    return "without" if interpolation == "none" else "with"


def draw_adjusted(rows):
    names = [f"{scene}, p = {100 * p:g} %\n{with_or_without(interpolation)} interpolation" for (scene, interpolation, p, _), *_ in rows]
    groups = [(label, [of["packets_per_s_in_contact"] for of in column])
              for label, column in (("the scene's hand", [r[1] for r in rows]), ("a faster hand", [r[2] for r in rows]))]
    fig, axes = bars(names, groups, [setting[3] for setting, *_ in rows])
    axes.set(yscale="log", ylabel="updates per second in contact", ylim=(5, 500))
    axes.yaxis.set_major_formatter("{x:g}")
    return fig


def bars(names, groups, thesis):
    """Bars by name and group with the spread of their seeds, and the thesis's numbers, some of which may be None."""
    fig, (axes,) = figure.panels()
    for g, (label, values) in enumerate(groups):
        at = [i + (g - 0.5) * 0.38 for i in range(len(names))]
        axes.bar(at, list(map(mean, values)), 0.36, yerr=list(map(deviation, values)), capsize=2, label=label, edgecolor="black",
                 linewidth=0.6, color=figure.COLOURS[g], hatch=("", "///")[g], alpha=0.75, error_kw={"elinewidth": 0.8})
    known = [(i, rate) for i, rate in enumerate(thesis) if rate is not None]
    axes.plot([i for i, _ in known], [rate for _, rate in known], linestyle="none", marker="D", markersize=6, color="black",
              markerfacecolor="white", label="thesis")
    axes.set_xticks(range(len(names)), names)
    axes.grid(False, axis="x")
    axes.legend(loc="upper left", ncol=3, title="bars: mean and standard deviation of the seeds")
    return fig, axes


def setting(rule, deadband, interpolates, thesis=None, approximate=False, options=()):
    return {"rule": rule, "deadband": deadband, "interpolates": interpolates, "thesis": thesis, "approximate": approximate,
            "options": list(options)}


# Table 3.3, with the packets/s that the text of 3.2.5.2 gives: figure 3.14 itself has no numbers.
SETTINGS = {
    "S_R7": setting("off", 0.08, False, 1000, options=["--tune", "reduction=none"]), "S_R1": setting("off", 0.08, False),
    "S4_NI": setting("isotropic", 0.04, False, 42.6), "S8_NI": setting("isotropic", 0.08, False),
    "S18_NI": setting("isotropic", 0.18, False), "S30_NI": setting("isotropic", 0.30, False, 25, approximate=True),
    "S4_WI": setting("isotropic", 0.04, True, 28.6), "S8_WI": setting("isotropic", 0.08, True),
    "S18_WI": setting("isotropic", 0.18, True), "S30_WI": setting("isotropic", 0.30, True, 12.3),
    "S_NIso": setting("cone", 0.18, True, 18.2, options=["--tune", "alpha=2.1deg"]), "S_DR": setting("fixed", 0.08, True, 33.6),
}
FIXED_LENGTH = 0.0015  # [virtual length units] of S_DR


def bounds(options, of):
    """Options of `tactus sim` and `tactus compare`."""
    length, angle = (0.010, 4) if of["interpolates"] else (0.006, 2)
    words = ["--haptic", of["rule"], "--visual", f"{length * options.length_unit!r}m,{angle}deg"]
    words += ["-p", repr(of["deadband"])] if of["rule"] != "off" else []
    if of["rule"] == "fixed":
        words += ["--tune", f"fixed={FIXED_LENGTH * options.length_unit!r}m,2deg"]
    return words if of["rule"] == "off" else [*words, *of["options"]]


def measure(options, scene, of, hand, seed):
    """One run; where the client interpolates, the predicted state is what a second client shows that doesn't."""
    words = ["sim", scene, "--seed", str(seed), "--grip", options.grip, "--profile", "thesis", *bounds(options, of), *hand]
    words += of["options"] if of["rule"] == "off" else []  # of the encoder alone
    if not of["interpolates"]:
        shown = predicted = program.report([*words, "-o", "/dev/null", "-f"])
    else:
        with tempfile.TemporaryDirectory() as folder:
            truth, stream, replica = (os.path.join(folder, name) for name in ("truth.mcap", "sent.tct", "replica.mcap"))
            shown = program.report([*words, "--interpolate", "-o", truth, "--stream", stream])
            program.run(["decode", stream, "-o", replica, "--like", truth, "-q"])
            predicted = program.report(["compare", truth, replica, *bounds(options, of)])
    return measured(shown, predicted["error"])


def measured(shown, predicted):
    error, traffic = shown["error"], shown["traffic"]
    contact = error.get("contact_force_N", {"samples": error["contact_force_perception_N"]["samples"]})
    return {"seconds": shown["seconds"], "packets_per_s": traffic["packets_per_s"], "payload_bit_per_s": traffic["payload"]["bit_per_s"],
            "bytes_per_update": traffic["payload"]["bytes_per_update"],
            "visual_violations": predicted["position_m"]["over"] + predicted["rotation_rad"]["over"],
            "fraction_over_jnd": error["rendered_force_perception_N"]["over"] / shown["ticks"],
            "fraction_in_contact": contact["samples"] / shown["ticks"],
            "haptic_violations": predicted.get("contact_force_N", {"over": 0})["over"],
            "fraction_shown_over": contact.get("fraction_over"), "worst_shown_ratio": contact.get("worst_ratio")}


def summarise(of, runs):
    """Means; violations are sums, the worst ratio the largest."""
    column = lambda name: [run[name] for run in runs]
    out = {"packets_per_s": mean(column("packets_per_s")), "standard_deviation": deviation(column("packets_per_s"))}
    for name in ("payload_bit_per_s", "bytes_per_update"):
        out[name] = mean(column(name))
    out["visual_violations"] = sum(column("visual_violations"))
    for name in ("fraction_over_jnd", "fraction_in_contact"):
        out[name] = mean(column(name))
    if of["rule"] != "off":
        out |= {"haptic_violations": sum(column("haptic_violations")), "fraction_shown_over": mean(column("fraction_shown_over")),
                "worst_shown_ratio": max(column("worst_shown_ratio"))}
    return out


WITHOUT, WITH = ("S4_NI", "S8_NI", "S18_NI", "S30_NI"), ("S4_WI", "S8_WI", "S18_WI", "S30_WI")


def is_ordered(rows, names):
    """Does a larger deadband cost fewer packets?"""
    rates = [rows[name]["packets_per_s"] for name in names]
    return all(a > b for a, b in zip(rates, rates[1:]))


def order_of(rows, names):
    """The same with the spread of the runs in mind."""
    if is_ordered(rows, names):
        return "holds"
    ends = [(rows[n]["packets_per_s"] - rows[n]["standard_deviation"], rows[n]["packets_per_s"] + rows[n]["standard_deviation"])
            for n in names]
    if any(a[1] < b[0] for a, b in zip(ends, ends[1:])):
        return "does not hold"
    return "holds within the spread of the runs" if rows[names[0]]["standard_deviation"] > 0 else \
        "does not hold; the spread needs more than one seed"


def settings(options):
    """Table 3.3 and figure 3.14: traffic control settings, by a slow and a fast hand."""
    scene = "rotate-push-lift"
    hands = {"scene_hand": [], "faster_hand": ["--tune", f"duration_scale={options.duration_scale!r},tremor={options.tremor!r}m"]}
    jobs = [(name, hand, seed) for hand in hands for name in SETTINGS for seed in range(1, options.seeds + 1)]
    bar = program.Progress("reproduce", len(jobs), not options.quiet and not options.no_progress)
    runs = dict(zip(jobs, program.side_by_side(lambda job: measure(options, scene, SETTINGS[job[0]], hands[job[1]], job[2]), jobs,
                                               options.jobs, bar)))
    rows = {hand: {name: summarise(of, [runs[name, hand, seed] for seed in range(1, options.seeds + 1)])
                   for name, of in SETTINGS.items()} for hand in hands}
    report = {"schema": "tactus.reproduce/3", "figure": "fig3.14", "scene": scene, "seconds": runs[jobs[0]]["seconds"], "seeds": options.seeds,
              "length_unit_m": options.length_unit, "grip": options.grip,
              "faster_hand": {"duration_scale": options.duration_scale, "tremor_m": options.tremor}, "settings": []}
    for name, of in SETTINGS.items():
        row = {"setting": name} | {hand: rows[hand][name] for hand in hands}
        if of["thesis"]:
            row["thesis"] = {"packets_per_s": of["thesis"], "is_approximate": of["approximate"]}
        report["settings"].append(row)
    report["ordered_without_interpolation"] = is_ordered(rows["scene_hand"], WITHOUT)
    report["ordered_with_interpolation"] = is_ordered(rows["scene_hand"], WITH)
    return Made(report, settings_text(options, report, rows), lambda: draw_settings(options, runs), {})


def percent(value):
    return "0 %" if value == 0 else f"{100 * value:.2f} %"


SETTINGS_HEAD = ["setting", "packets/s", "+-", "faster hand", "+-", "thesis", "bit/s", "bytes/update", "rule broken", "visual broken",
                 "shown over", "shown worst", "force over JND"]
SETTINGS_LEGEND = """
rule broken     ticks in which the predicted state breaks the setting's haptic rule, all seeds and both hands together
visual broken   ticks in which its position, and in which its rotation, breaks the visual threshold, the same
The other columns are those of the scene's hand:
shown over      fraction of the ticks in contact in which the shown state, smoothed or not, breaks the haptic rule
shown worst     largest error in these ticks, as a multiple of the permitted error
force over JND  fraction of ticks in which the error of the rendered force is perceptible (more than 10 to 22 %)""".split("\n")


def settings_text(options, report, rows):
    cells = []
    for name, of in SETTINGS.items():
        slow, fast = rows["scene_hand"][name], rows["faster_hand"][name]
        has_rule = of["rule"] != "off"
        thesis = "-" if of["thesis"] is None else f"{'~' if of['approximate'] else ''}{of['thesis']:g}"
        cells.append([name, f"{slow['packets_per_s']:.1f}", f"{slow['standard_deviation']:.1f}", f"{fast['packets_per_s']:.1f}",
                      f"{fast['standard_deviation']:.1f}", thesis, f"{slow['payload_bit_per_s']:.0f}", f"{slow['bytes_per_update']:.2f}",
                      slow["haptic_violations"] + fast["haptic_violations"] if has_rule else "-",
                      slow["visual_violations"] + fast["visual_violations"], percent(slow["fraction_shown_over"]) if has_rule else "-",
                      f"{slow['worst_shown_ratio']:.2f}" if has_rule else "-", percent(slow["fraction_over_jnd"])])
    orders = [f"S4 > S8 > S18 > S30 {what} interpolation, {hand}: {order_of(of, names)}" for hand, of in
              (("the scene's hand", rows["scene_hand"]), ("the faster hand", rows["faster_hand"]))
              for what, names in (("without", WITHOUT), ("with", WITH))]
    return lines(f"Thesis table 3.3 and figure 3.14: traffic control settings on {report['scene']}, closed loop, {report['seconds']:.1f} s, "
                 f"seeds 1 to {options.seeds}",
                 f"Chosen here: 1 virtual length unit = {options.length_unit:g} m, grip {options.grip}, the scene's hand and path.",
                 about_faster_hand(options), "", table.aligned(SETTINGS_HEAD, cells), SETTINGS_LEGEND,
                 f"contact         {100 * rows['scene_hand']['S_R7']['fraction_in_contact']:.0f} % of the ticks", "", orders)


def draw_settings(options, runs):
    """All settings but the reference, whose 1000 packets/s would flatten the rest."""
    names = [name for name in SETTINGS if name != "S_R7"]
    groups = [(label, [[runs[name, hand, seed]["packets_per_s"] for seed in range(1, options.seeds + 1)] for name in names])
              for label, hand in (("the scene's hand", "scene_hand"), ("a faster hand", "faster_hand"))]
    fig, axes = bars(names, groups, [SETTINGS[name]["thesis"] for name in names])
    axes.set(xlabel="setting of table 3.3", ylabel="packets per second", ylim=(0, 70))
    return fig
