#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tactus reproduce FIGURE: run an experiment of the thesis, and put its numbers beside those of the thesis.

What comes out is deterministic. A figure is one function of thesis/, which returns a report, text, tables and how it is drawn.
"""
import argparse
import json
import math
import os
import re
import sys
import typing

from common import arguments, figure, program, table
from thesis import delay, interpolations, limits, numbers, rates, signals, touch


class Figure(typing.NamedTuple):
    make: typing.Callable
    title: str
    remark: str = ""
    needs_fem: bool = False  # shown on the membrane


FIGURES = {
    "fig3.3": Figure(signals.traffic, "why updates are sent while a cube is pushed"),
    "fig3.6": Figure(rates.architectures, "object states or forces"),
    "fig3.8": Figure(interpolations.interpolations, "kinds of interpolation",
                     "The figure shows preferences, which need people: they liked linear best."),
    "fig3.10": Figure(rates.adjusted, "updates at the deadbands that the subjects chose",
                      "The deadbands are those of the thesis's subjects; the rates are ours."),
    "fig3.11": Figure(signals.interpolation, "the force with and without interpolation"),
    "fig3.14": Figure(rates.settings, "the traffic settings of table 3.3",
                      "The thesis's people are replaced by virtual hands: the scene's, which is slower and steadier, and a faster one. "
                      "The ratings need people."),
    "fig4.1": Figure(touch.touch("fig4.1"), "two users push a block: what delay does"),
    "fig4.2": Figure(touch.touch("fig4.2"), "a user presses a membrane: what delay does", needs_fem=True),
    "fig4.6": Figure(touch.constant_push, "a push at constant speed"),
    "fig4.7": Figure(delay.rigid_impedance, "impedance of a rigid object at a client"),
    "fig4.8": Figure(touch.touch("fig4.8"), "a cube is pushed forth and back",
                     "The figure shows ratings, which need people. This is their task; in their place, the fraction of the time outside of "
                     "the area of perceived transparency, +-10 %."),
    "fig4.10": Figure(touch.touch("fig4.10"), "two users push a block side by side"),
    "fig4.11": Figure(touch.touch("fig4.11"), "one user pushes a block, another presses on it"),
    "fig4.12": Figure(touch.touch("fig4.12"), "one user pushes a block, another stops it"),
    "fig4.13a": Figure(limits.varying_delay, "the delay that varies", "Tables 4.1 and 4.2 and figure 4.26 are what people said of it."),
    "fig4.16": Figure(limits.jury, "the critical stiffness at the server"),
    "fig4.17": Figure(limits.client, "grip, damping and object stiffness at a client"),
    "fig4.18": Figure(delay.two_users_delayed, "two users at one object: what delay does"),
    "fig4.20": Figure(delay.without_compensation, "impedance of a deformable object at a client"),
    "fig4.21": Figure(delay.one_press, "one press"),
    "fig4.22": Figure(delay.with_compensation, "the same impedance with compensation"),
    "fig4.23": Figure(limits.stiffness, "the stiffness of the membrane", needs_fem=True),
    "fig4.24": Figure(delay.two_users, "two users at one object, with compensation"),
    "fig4.25": Figure(touch.touch("fig4.25"), "two hands at a one-dimensional object"),
    "fig4.27": Figure(touch.touch("fig4.27"), "a hand on the membrane", needs_fem=True),
}
SAME = {"table3.3": "fig3.14"}
USUAL = {"seeds": 5, "grip": "normal", "duration_scale": 0.5, "tremor": 0.4e-3, "length_unit": 0.05}

HEADING = """# The thesis, figure by figure

Made by `{} -o DIR`, each section by the command in it: what comes out here beside the numbers of the thesis, where it gives any. \
Everything is deterministic. Differences are stated where they are: [rates](../README.md), [delay](../delay/README.md).

Reproduced elsewhere: figure 2.2 and eqs. 4.37 and 4.38 ([stability](../stability/report.md)), figures 3.18 and 3.20 \
([deformable objects](../deformable/README.md)). What needs people is not reproduced: the ratings of chapter 3 and of figures 4.8 and \
4.26, and tables 4.1 and 4.2.
"""
UNITS = {"m": 1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6}


def length(typed):
    """A type of argparse: a length above zero [m]."""
    found = re.fullmatch(r"\s*([0-9.eE+-]+?)\s*(m|cm|mm|um)\s*", typed)
    try:
        # through the shortest decimal, as the program reads it: 0.4mm is 0.0004, and not 0.4 times 0.001
        value = float(f"{float(found[1]) * UNITS[found[2]]:.12g}") if found else math.nan
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0):
        raise argparse.ArgumentTypeError(f"{typed!r}: a length needs its unit: m, cm, mm or um")
    return value


def factor(typed):
    """A type of argparse: a number above zero."""
    try:
        value = float(typed)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0):
        raise argparse.ArgumentTypeError(f"{typed}: give a number above zero")
    return value


def set_up():
    listed = "\n".join(f"  {name:<10}{one.title}" for name, one in FIGURES.items())
    made = arguments.parser("reproduce", "Run an experiment of the thesis and compare the figures.",
                            f"figures:\n{listed}\n  table3.3  as fig3.14\n  all       every figure in one report, DIR/report.md\n\n"
                            "Examples:\n  tactus reproduce fig3.14 --seeds 5\n  tactus reproduce fig3.3 -o figures\n"
                            "  tactus reproduce fig4.24 -o figures\n  tactus reproduce all -o thesis")
    made.add_argument("figure", metavar="FIGURE", choices=["all", *FIGURES, *SAME], help="fig3.3 to fig4.27 as listed below, or all")
    made.add_argument("--seeds", type=arguments.whole(1, 1000), default=USUAL["seeds"], metavar="N", help="runs per setting [5]")
    made.add_argument("--length-unit", type=length, default=USUAL["length_unit"], metavar="LENGTH",
                      help="metres per virtual length unit of the thesis [0.05m]")
    made.add_argument("--grip", choices=("loose", "normal", "firm"), default=USUAL["grip"], help="of the hand on the device [normal]")
    made.add_argument("--duration-scale", type=factor, default=USUAL["duration_scale"], metavar="FACTOR",
                      help="time of each movement, times the scene's, of the faster hand of fig3.10 and fig3.14 [0.5]")
    made.add_argument("--tremor", type=length, default=USUAL["tremor"], metavar="LENGTH", help="of the same hand, RMS per axis [0.4mm]")
    arguments.add_report_options(made, output_help="folder for figures (SVG, PNG and PDF) and tables (CSV)", force=True)
    arguments.add_jobs(made, "runs at a time")
    return made


def typed(name, options):
    """The command of a figure, with the options that are not as usual."""
    lengths = ("tremor", "length_unit")
    more = [[f"--{key.replace('_', '-')}", f"{getattr(options, key):.12g}{'m' if key in lengths else ''}"
             if key != "grip" else options.grip] for key, usual in USUAL.items() if getattr(options, key) != usual]
    return program.as_typed(["reproduce", name, *[word for pair in more for word in pair]])


def files_of(name, folder):
    return [os.path.join(folder, name + ending) for ending in figure.ENDINGS]


def check_free(path, options):
    """Before the work."""
    if os.path.lexists(path) and not options.force:
        raise arguments.Refusal(f"{path}: the file already exists", "Choose another name, or replace it with -f.")


def write(name, made, options):
    for stem, (head, rows) in made.tables.items():
        table.write_csv(os.path.join(options.output, stem + ".csv"), head, rows, options.force)
    figure.save_all(made.draw(), os.path.join(options.output, name), options.force)


def prepare(names, options):
    """The folder, and no file in the way, before anything is computed."""
    figure.pyplot()
    os.makedirs(options.output, exist_ok=True)
    for name in names:
        for path in files_of(name, options.output):
            check_free(path, options)


def one(options):
    name = SAME.get(options.figure, options.figure)
    if options.output:
        prepare([name], options)
    made = FIGURES[name].make(options)
    if options.json:
        print(json.dumps(made.report, indent=2, ensure_ascii=False))
    elif not options.quiet:
        print(made.text)
    if options.output:
        write(name, made, options)


def section(name, made, options):
    chosen = FIGURES[name]
    return "".join([f"\n## Figure {name[3:]}: {chosen.title}\n\n`{typed(name, options)}`\n", f"\n{chosen.remark}\n" if chosen.remark else "",
                    f"\n```\n{made.text}\n```\n", f"\n![{chosen.title}]({name}.svg)\n"])


def every(options):
    if not options.output:
        raise arguments.Refusal("all: --output is missing", "Give a folder for the report: -o thesis.", arguments.USAGE)
    if options.json:
        raise arguments.Refusal("all: no --json", "Ask each figure for its JSON.", arguments.USAGE)
    names = [name for name, one in FIGURES.items() if can_make(name, one)]
    report = os.path.join(options.output, "report.md")
    check_free(report, options)
    check_free(os.path.join(options.output, "figures.csv"), options)
    prepare(names, options)
    bar = program.Progress("reproduce all", len(names), not options.quiet and not options.no_progress)
    inner = argparse.Namespace(**vars(options) | {"no_progress": True})
    text, rows = HEADING.format(typed("all", options)), []
    for name in names:
        made = FIGURES[name].make(inner)
        rows += numbers.rows(name, made.report)
        write(name, made, options)
        text += section(name, made, options)
        bar.step()
    bar.clear()
    table.write_whole(report, text.encode(), options.force)
    table.write_csv(os.path.join(options.output, "figures.csv"), numbers.HEAD, rows, options.force)
    if not options.quiet:
        print(f"{report}: {len(names)} figures")


def can_make(name, one):
    if not one.needs_fem or "fem" in program.version()["components"]:
        return True
    print(f"note: {name}: left out, as this program was built without finite elements", file=sys.stderr)
    return False


def work(options):
    return every(options) if options.figure == "all" else one(options)


if __name__ == "__main__":
    arguments.run(set_up(), work)
