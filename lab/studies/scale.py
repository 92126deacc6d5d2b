# SPDX-License-Identifier: Apache-2.0
"""`tactus bench scale`: what a server of many clients and objects costs in each tick, in memory and when a client joins."""
import json
import re
import shutil
import subprocess

from common import arguments, program
from common.arguments import Refusal
from studies import report

CASES = [  # clients, objects, moving, and what else
    (1, 10, 10, {}), (64, 10, 10, {}), (1024, 10, 10, {}), (1024, 10, 10, {"loss": 0.1}),
    (64, 1000, 10, {}), (64, 1000, 10, {"loss": 0.1}), (64, 1000, 10, {"participants": True}), (64, 1000, 100, {}),
    (64, 1000, 0, {}), (16, 10_000, 10, {}), (16, 10_000, 10, {"names_moved": True}),
    (4, 100_000, 100, {"names_moved": True}),
]
SHORT = [(8, 100, 10, {}), (8, 100, 0, {})]
HEAD = ["clients", "objects", "moving", "loss", "participants", "tells_moved", "live", "instructions_per_tick", "tick_mean_s",
        "tick_median_s", "tick_worst_s", "join_median_s", "join_worst_s",
        "join_elsewhere_worst_s", "bytes_per_client_both_ends", "bytes_per_client_server",
        "datagrams_per_client_and_tick", "bytes_down_per_client_and_tick"]
COLUMNS = ["clients", "objects", "moving", "", "instructions", "median [us]", "mean [us]", "worst [us]", "join [us]",
           "elsewhere [us]", "memory, server [B]", "both ends [B]", "down [kbit/s]"]


def parser(what):
    made = arguments.parser("bench scale", what, "Example:\n  tactus bench scale --instructions -o scale")
    made.add_argument("--case", action="append", default=[], metavar="CLIENTS,OBJECTS,MOVING",
                      help="Such a case instead of those of the table; may be repeated")
    made.add_argument("--instructions", action="store_true", help="Also count instructions, with valgrind: 50 times as slow")
    made.add_argument("--ticks", type=arguments.whole(1, 1_000_000), default=500, metavar="N", help="Ticks that are measured [500]")
    made.add_argument("--seed", default=1, type=arguments.whole(0, 2**64 - 1), metavar="N", help="Seed of motions and losses [1]")
    made.add_argument("--short", action="store_true", help="Run two small cases")
    arguments.add_report_options(made, output_help="Folder for report.md and CSV", force=True)
    return made


def cases(options):
    if not options.case:
        return SHORT if options.short else CASES
    out = []
    for typed in options.case:
        if not re.fullmatch(r"\d+,\d+,\d+", typed):
            raise Refusal(f"--case {typed}: not three whole numbers", "Give clients, objects and how many move, as in 64,1000,10.",
                          arguments.USAGE)
        out.append((*map(int, typed.split(",")), {}))
    return out


def work(options):
    if options.instructions and shutil.which("valgrind") is None:
        raise Refusal("valgrind is missing", "Install it (apt install valgrind), or leave --instructions out.")
    folder = report.Folder(options.output, ("report.md", "scale.csv"), options.force)
    asked = [{"clients": clients, "objects": objects, "moving": moving, "ticks": options.ticks, "seed": options.seed} | more
             for clients, objects, moving, more in cases(options)]
    progress = program.Progress("bench scale", len(asked), not (options.quiet or options.no_progress))
    rows = []
    for request in asked:  # one at a time: others would take its caches
        row = request | program.point("scale", **request)
        row["instructions"] = instructions(request) if options.instructions else None
        rows.append(row)
        progress.step()
    if options.output:
        folder.write_csv("scale.csv", HEAD, [csv_row(row) for row in rows])
        folder.write("report.md", markdown(rows, options))
    if options.json:
        report.print_json({"schema": "tactus.scale/1", "context": report.context(), "rows": rows})
    elif not options.quiet:
        report.show(COLUMNS, [cells(row) for row in rows])


def instructions(request):
    """Of a tick of the server, mean."""
    few = request | {"ticks": min(request["ticks"], 100)}
    done = subprocess.run(["valgrind", "--tool=callgrind", "--toggle-collect=tactus_scale_tick", "--callgrind-out-file=/dev/null",
                           program.study(), "scale", json.dumps(few)], capture_output=True, text=True, check=False)
    counted = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode != 0 or not counted:
        raise Refusal("valgrind could not run tactus-study", done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "")
    return int(counted.group(1)) / few["ticks"]


def csv_row(row):
    tick, join, memory, down = row["tick_s"], row["join_s"], row["bytes_per_client"], row["down_per_client_and_tick"]
    numbers = [tick["mean"], tick["median"], tick["worst"], join["median"], join["worst"],
               row["join_elsewhere_s"]["worst"], memory["both_ends"], memory["server"],
               down["datagrams"], down["bytes"]]
    return [row["clients"], row["objects"], row["moving"], row["loss"], int(row.get("participants", False)),
            int(row.get("names_moved", False)), row["live"],
            "" if row["instructions"] is None else f"{row['instructions']:.0f}", *(f"{value:.6g}" for value in numbers)]


def remarks(row):
    parts = [f"{100 * row['loss']:.0f} % loss"] if row["loss"] else []
    parts += ["participants"] if row.get("participants") else []
    return ", ".join(parts + (["what moved is named"] if row.get("names_moved") else []))


def cells(row):
    tick, memory = row["tick_s"], row["bytes_per_client"]
    each = row["objects"]
    return [row["clients"], each, row["moving"], remarks(row),
            "-" if row["instructions"] is None else f"{row['instructions']:.0f}",
            *(f"{1e6 * tick[key]:.1f}" for key in ("median", "mean", "worst")), f"{1e6 * row['join_s']['worst']:.0f}",
            f"{1e6 * row['join_elsewhere_s']['worst']:.0f}",
            f"{memory['server'] / each:.0f}", f"{memory['both_ends'] / each:.0f}",
            f"{8 * row['down_per_client_and_tick']['bytes']:.1f}"]


def markdown(rows, options):
    context = report.context()
    return (f"# What a server of many clients and objects costs\n\n`tactus bench scale` on {context['machine']} "
            f"({context['compiler']}, {context['build']} build), {options.ticks} ticks after two seconds. CPU of one thread in a tick of "
            "1 ms: all datagrams that came, submit(), all that go. *Join*: the slowest call that takes a join or brings a client live; *elsewhere*: what another thread "
            "makes meanwhile. "
            "*Memory*: resident, per client and object. *Down*: datagrams without UDP and IP.\n\n" +
            report.markdown(COLUMNS, [cells(row) for row in rows], left=0))
