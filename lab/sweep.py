#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`tactus sweep PLAN`: run a command over a grid of parameters into tables and figures. sweep/ has its parts."""
import argparse
import json
import os
import statistics
import sys
import time

from common import arguments, program, table
from common.arguments import Refusal
from sweep import points as of_points
from sweep import plan as of_plan
from sweep import table as of_tables

INSIDE = "TACTUS_INSIDE_SWEEP"  # variable of the environment that a sweep's commands see
NOTES = """\
A stopped sweep or shard resumes when it is started again; finished points are kept.
A plan is a program: its commands may write any file. Check a plan that you did not write with --list first.
examples:
  tactus sweep reports/plans/deadband.toml
  tactus sweep reports/plans/deadband.toml -o results/deadband -j 1
  tactus sweep reports/plans/deadband.toml --inputs my-recordings
  parallel tactus sweep reports/plans/deadband.toml -j 1 --shard {}/8 ::: $(seq 8)
  tactus sweep reports/plans/deadband.toml --merge"""


def shard(typed):
    index, _, count = typed.partition("/")
    if not (index.isdecimal() and count.isdecimal() and 1 <= int(index) <= int(count)):
        raise argparse.ArgumentTypeError(f"{typed}: give I/N, I from 1 to N: 3/8")
    return int(index), int(count)


def command_line():
    parser = arguments.parser("sweep", "Run a command over a grid of parameters into a table and figures", NOTES)
    parser.add_argument("plan", metavar="PLAN", help="TOML file: command, parameters, measures and figures")
    arguments.add_jobs(parser)
    parser.add_argument("--inputs", action="append", default=[], metavar="DIR|NAME=FILE",
                        help="Inputs that are there already: a folder with files of the plan, or NAME=FILE; may be repeated")
    either = parser.add_mutually_exclusive_group()
    either.add_argument("--shard", type=shard, metavar="I/N", help="Compute the I-th of N parts of the points, from 1: one per machine")
    either.add_argument("--merge", action="store_true",
                        help="Compute nothing: write the tables and figures of what is there, once all is there")
    parser.add_argument("--list", action="store_true", help="Print the commands without running them")
    arguments.add_report_options(parser, output_help="Folder of the results; an existing one is resumed [out/NAME]")
    return parser


def is_of(number, part):
    """Turned by one from block to block: where the last parameter has as many values as there are shards, each gets all of them."""
    index, count = part
    return (number + number // count) % count == index - 1


def print_commands(plan, inputs, mine):
    for words in [*inputs.commands(plan, mine), *(plan.words(point, inputs.path_of) for point in mine)]:
        print(arguments.printable(program.as_typed(words)))


def refuse_missing(folder, everything, missing):
    first = ", ".join(missing[0].values())
    raise Refusal(f"{folder}: {len(missing)} of {len(everything)} points are missing, the first one is {first}",
                  "Run the shards that were stopped again, or leave --merge out: the missing points are then computed here.")


def show(summary, options):
    if options.json:
        print(json.dumps({"schema": "tactus.sweep-summary/3"} | summary, indent=2, ensure_ascii=False))
    elif not options.quiet:
        rows = [["points of the shard" if options.shard else "points of the plan", summary["points"]],
                ["there before", summary["points"] - summary["computed"] - summary["failed"]],
                ["computed now", summary["computed"]], ["failed", summary["failed"]], ["time [s]", f"{summary['time_s']:.1f}"],
                ["time of a point, median [s]", f"{summary['point_p50_s']:.2f}"]]
        if summary["points_left"]:
            rows += [["points of the plan that are missing here", summary["points_left"]],
                     ["time of these on one core, estimated [s]", f"{summary['work_left_s']:.0f}"]]
        table.show(["sweep " + summary["plan"], "number"], [["  " + name, value] for name, value in rows])
        for file in summary["files"]:
            print("  " + arguments.printable(file))


def work(options):
    if INSIDE in os.environ:
        raise Refusal("a sweep cannot run within a sweep", "Use other commands than sweep in the plan.")
    start = time.monotonic()
    plan = of_plan.load(options.plan)
    folder = options.output or f"out/{plan.name}"
    inputs = of_points.Inputs(plan, folder, options.inputs)
    everything = list(plan.points())
    mine = [point for number, point in enumerate(everything) if not options.shard or is_of(number, options.shard)]
    if options.list:
        return print_commands(plan, inputs, mine)
    os.environ[INSIDE] = "1"
    shown = not (options.quiet or options.no_progress)
    points = of_points.Points(plan, folder, inputs)
    inputs.make(plan, mine, points.build, options.jobs, shown)
    missing = [point for point in mine if points.row(point) is None]
    if options.merge and missing:
        refuse_missing(folder, everything, missing)
    points.compute(missing, options.jobs, shown)
    finish(options, plan, points, everything, mine, missing, start)
    if points.failures:
        first = points.failures[min(points.failures)]
        raise Refusal(f"{len(points.failures)} of {len(mine)} points failed, the first one:\n       {first.text}",
                      first.remedy or "Correct the cause and run the sweep again; finished points are kept.")
    return None


def finish(options, plan, points, everything, mine, missing, start):
    """Tables and figures, once every point of the plan is there; a summary in any case."""
    folder, files = points.folder, []
    known = [row for row in map(points.row, everything) if row is not None]
    if len(known) == len(everything):
        files, notes = of_tables.write(plan, folder, known, points.inputs.read | points.inputs.digests)
        for note in notes:
            print("note: " + arguments.printable(note), file=sys.stderr)
    seconds = [float(row["seconds"]) for row in known]
    middle, left = statistics.median(seconds) if seconds else 0.0, len(everything) - len(known)
    show({"plan": plan.name, "points": len(mine), "computed": len(missing) - len(points.failures), "failed": len(points.failures),
          "time_s": round(time.monotonic() - start, 3), "point_p50_s": middle, "points_left": left, "work_left_s": round(middle * left, 3),
          "files": files}, options)


if __name__ == "__main__":
    arguments.run(command_line(), work)
