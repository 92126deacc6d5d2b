# SPDX-License-Identifier: Apache-2.0
"""`tactus bench session [TRACE...]`: what a client shows over networks that lose, delay and reorder, and its cost."""
import argparse
import os

from common import arguments, figure, program
from studies import report
from studies.report import per

TICKS, FEW_TICKS = 120_000, 10_000  # of the bodies that swing
MADE = ("boxes", "knocks", "billiard", "juggling", "sheet")  # motions of many objects
COLUMNS = ["over a bound", "longest [ms]", "mean [ms]", "shown behind [ms]", "payload [kbit/s]", "x chain", "session", "UDP/IPv4",
           "all down", "all up"]
HEAD = ["motion", "group", "case", "ticks", "over", "over_position", "over_rotation", "over_force", "over_shape", "longest_s",
        "mean_s",
        "behind_s", "down_payload_bit_per_s", "chain_payload_bit_per_s", "down_session_bit_per_s", "down_udp_ipv4_bit_per_s",
        "up_bit_per_s", "recovery_s", "bounds_widest", "bounds_widened_s", "wrong_states", "error_median_bounds",
        "error_p95_bounds", "error_worst_bounds"]
# Options of `tactus encode`, handed on as they are typed.
VALUES = ["-p/--deadband", "--visual", "--haptic", "--deformable-visual", "--basis", "--profile", "--tune"]
LOSSES = [("loss", "each for itself"), ("loss, jitter up to 30 ms", "with jitter up to 30 ms"),
          ("loss in bursts of 5", "in bursts of 5 on average")]


class AsTyped(argparse.Action):
    """Option and value, appended to `encoder`."""

    def __call__(self, parser, options, value, option=None):
        options.encoder = [*options.encoder, option, value]


def parser(what):
    made = arguments.parser("bench session", what, "Example:\n  tactus bench session truth.mcap -p 4% --visual 0.3mm,2deg -o "
                                                   "session")
    made.add_argument("traces", metavar="TRACE", nargs="*", help="Also study these recordings, at the bounds given by options")
    made.add_argument("--made", choices=MADE, action="append", default=[], metavar="NAME",
                      help="Also study 10 s of a motion of many objects: boxes (12 that tumble), knocks (100 objects), billiard "
                           "(16 balls), juggling (9 clubs), sheet (5041 vertices); may be repeated")
    made.add_argument("--short", action="store_true", help="Run two cases over 10 s")
    made.add_argument("--seed", default=1, type=arguments.whole(0, 2**64 - 1), metavar="N", help="Seed of the networks [1]")
    arguments.add_report_options(made, output_help="Folder for report.md, CSV and figure", force=True)
    arguments.add_jobs(made, "Networks simulated in parallel")
    encoder = made.add_argument_group("options of the encoder, for the recordings", "`tactus encode --help` and `tactus encode --help-tune` describe them.")
    for names in VALUES:
        encoder.add_argument(*names.split("/"), action=AsTyped, dest="encoder", metavar="VALUE", default=[])
    return made


def work(options):
    folder = report.Folder(options.output, ("report.md", "session.csv"), options.force)
    motions = run(options)
    if options.output:
        drawn = not options.short and folder.draw("session-loss", lambda: draw(motions[0]))
        folder.write_csv("session.csv", HEAD, csv_rows(motions))
        folder.write("report.md", markdown(motions, options, drawn))
    if options.json:
        report.print_json(as_json(motions))
    elif not options.quiet:
        for motion in motions:
            for group, cases in groups(motion):
                report.show([f"{motion['name']}: {group}", *COLUMNS],
                            [[f"  {case['case']}{remarks(case)}", *cells(motion, case)] for case in cases])
            print()


def run(options):
    """The motions, each with the results of its cases."""
    common = {"short": options.short, "seed": options.seed}
    asked = [common | {"ticks": FEW_TICKS if options.short else TICKS}]
    asked += [common | {"ticks": FEW_TICKS, "made": name} for name in options.made]
    asked += [common | {"trace": trace, "encoder": options.encoder} for trace in options.traces]
    motions = program.side_by_side(lambda one: program.point("session", point="motion", **one), asked, options.jobs)
    points = [(motion, request, case["index"]) for motion, request in zip(motions, asked) for case in motion["cases"]]
    progress = program.Progress("bench session", len(points), not (options.quiet or options.no_progress))

    def compute(point):
        return program.point("session", point="case", index=point[2], **point[1])

    for motion in motions:
        motion["results"] = []
    for (motion, _, _), result in zip(points, program.side_by_side(compute, points, options.jobs, progress)):
        motion["results"].append(result)
    return motions


def groups(motion):
    """Pairs of a group and its cases, in their order."""
    out = []
    for case in motion["results"]:
        if not out or out[-1][0] != case["group"]:
            out.append((case["group"], []))
        out[-1][1].append(case)
    return out


def over(case):
    return per(case["ticks_over"]["any"], case["ticks"])


def cells(motion, case):
    down = case["down_bit_per_s"]
    payload, session, headers = (1e-3 * down[key] for key in ("payload", "session", "udp_ipv4"))
    return [f"{100 * over(case):.3f} %", f"{1e3 * case['longest_run_s']:.1f}", f"{1e3 * case['mean_run_s']:.1f}",
            f"{1e3 * case['shown_behind_s']:.1f}", f"{payload:.2f}",
            f"{per(down['payload'], motion['chain_payload_bit_per_s']):.2f}",
            f"{session:.2f}", f"{headers:.2f}", f"{payload + session + headers:.2f}", f"{1e-3 * case['up_bit_per_s']:.2f}"]


def remarks(case):
    """What else there is to say of a case."""
    out = f"; recovered {1e3 * case['recovery_s']:.0f} ms after it" if case.get("recovery_s") else ""
    scaling = case["bound_scale"]
    if scaling["for_s"] > 0:
        fraction = 100 * per(scaling["for_s"], case["seconds"])
        out += f"; bounds up to {scaling['largest']:.1f} times as wide for {fraction:.0f} % of the time"
    return out


def csv_rows(motions):
    def row(motion, case):
        broken, down, scaling = case["ticks_over"], case["down_bit_per_s"], case["bound_scale"]
        rates = [down["payload"], motion["chain_payload_bit_per_s"], down["session"], down["udp_ipv4"], case["up_bit_per_s"]]
        times = [case["longest_run_s"], case["mean_run_s"], case["shown_behind_s"]]
        return [motion["name"], case["group"], case["case"], case["ticks"],
                *(broken[key] for key in ("any", "position", "rotation", "force", "shape")), *(f"{value:.6g}"
                    for value in times + rates),
                f"{case.get('recovery_s', 0):.6g}", f"{scaling['largest']:.4g}", f"{scaling['for_s']:.6g}", case["wrong_states"],
                *(f"{case['error_bounds'][key]:.4g}" for key in ("median", "p95", "worst"))]
    return [row(motion, case) for motion in motions for case in motion["results"]]


def as_json(motions):
    def of(case):
        return {key: value for key, value in case.items() if key not in ("loss", "seconds")}
    return {"schema": "tactus.session/1", "context": report.context(), "motions": [
        {"name": motion["name"], "seconds": motion["seconds"], "chain_payload_bit_per_s": motion["chain_payload_bit_per_s"],
         "cases": [of(case) for case in motion["results"]]} for motion in motions]}


def markdown(motions, options, drawn):
    context = report.context()
    wrong = sum(case["wrong_states"] for motion in motions for case in motion["results"])
    out = ("# Sessions over networks that delay, lose and reorder\n\n"
           f"`tactus bench session{' --short' if options.short else ''}` on {context['machine']} ({context['compiler']}, "
           f"{context['build']} "
           f"build), seed {options.seed}. All but the times is deterministic.\n\n"
           "A client looks on over the network of each row: round trip 40 ms and 5 % duplicates unless said, the same network "
           "up and down. "
           "What it shows is judged against the truth of the tick that it shows. *Over a bound*: fraction of the ticks in which a "
           "position, "
           "rotation, contact force or vertex is off by more than its bound as given, however wide it was at the time (of "
           "deformable "
           "objects without rigid ones, fraction of the ticks with a new shape); *longest*, *mean*: runs of such ticks; *shown "
           "behind*: how "
           "far the tick shown lies behind the server's, delay of the network included. *x chain*: the payload as a multiple of "
           "that of "
           "packets that build on the one before over a network that loses nothing. The same rows are in `session.csv`. Of the "
           "hashes of "
           f"states that the clients reported, {wrong} were not those of the server.\n")
    if drawn:
        out += "\n![fraction of ticks over a bound, over loss](session-loss.svg)\n"
    for motion in motions:
        coding = max((case["coding_cpu_s"] for case in motion["results"]), default=0)
        out += (f"\n## {motion['name']}\n\n{motion['ticks']} ticks at {motion['tick_rate_hz']:g} Hz; chain "
                f"{1e-3 * motion['chain_payload_bit_per_s']:.2f} kbit/s. Coding a tick and its datagrams takes "
                f"{report.duration(coding)} "
                "(median, CPU).\n")
        for group, cases in groups(motion):
            out += "\n" + report.markdown([group, *COLUMNS], [[case["case"] + remarks(case), *cells(motion, case)]
                                                              for case in cases])
    return out


def draw(motion):
    """Fraction of the ticks over a bound, over the loss, a line for each kind of loss."""
    fig, (axes,) = figure.panels()
    for number, (group, label) in enumerate(LOSSES):
        points = [(100 * case["loss"], 100 * over(case)) for case in motion["results"] if case["group"] == group]
        figure.line(axes, [x for x, _ in points], [y for _, y in points], number, label)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("datagrams lost, each way [%]")
    axes.set_ylabel("ticks with a bound broken [%]")
    axes.legend(loc="best")
    return fig
