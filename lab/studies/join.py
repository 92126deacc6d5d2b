# SPDX-License-Identifier: Apache-2.0
"""`tactus bench join`: how long a client takes to join over a line, and what another client on that line waits for it."""
from common import arguments, program
from studies import report

ROUND_TRIPS, RATES, LOSSES, QUEUES = (2, 40, 100, 200, 300), (1, 10, 100), (0, 0.01, 0.1), (20, 100)  # [ms], [Mbit/s], 1, [ms]
COLUMNS = ["round trip [ms]", "line [Mbit/s]", "loss", "queue [ms]", "line alone [s]", "live after [s]", "datagrams per piece",
           "others wait, 99 % [ms]", "worst [ms]", "others' dropped"]
HEAD = ["round_trip_s", "rate_bit_per_s", "loss", "queue_s", "sealed", "declaration_bytes", "live_s", "datagrams_per_piece",
        "longest_without_progress_s", "wait_99_s", "wait_worst_s", "dropped"]


def parser(what):
    made = arguments.parser("bench join", what, "Example:\n  tactus bench join -o join")
    made.add_argument("--sealed", action="store_true", help="As with the seal, but for its handshake: addresses are validated, 29 bytes more")
    made.add_argument("--side", default=316, type=arguments.whole(2, 1000), metavar="N",
                      help="Vertices along the side of the sheet that is declared [316: 1.3 MB]")
    made.add_argument("--seed", default=1, type=arguments.whole(0, 2**64 - 1), metavar="N", help="Seed of the losses [1]")
    made.add_argument("--short", action="store_true", help="Run two cases")
    arguments.add_report_options(made, output_help="Folder for report.md and CSV", force=True)
    arguments.add_jobs(made, "Lines simulated in parallel")
    return made


def work(options):
    folder = report.Folder(options.output, ("report.md", "join.csv"), options.force)
    cases = [(queue, rate, trip, loss) for queue in QUEUES for rate in RATES for trip in ROUND_TRIPS for loss in LOSSES]
    asked = [{"side": options.side, "round_trip_us": 1000 * trip, "rate_bit_per_s": 1e6 * rate, "loss": loss, "queue_us": 1000 * queue,
              "sealed": options.sealed, "seed": options.seed}
             for queue, rate, trip, loss in ([(100, 10, 40, 0), (100, 10, 200, 0)] if options.short else cases)]
    progress = program.Progress("bench join", len(asked), not (options.quiet or options.no_progress))

    def run(request):
        row = request | program.point("join", **request)
        progress.step()
        return row

    rows = program.side_by_side(run, asked, options.jobs)
    if options.output:
        folder.write_csv("join.csv", HEAD, [csv_row(row) for row in rows])
        folder.write("report.md", f"# How long a client takes to join\n\n`tactus bench join`, in virtual time, seed {options.seed}: "
                     f"a declaration of {rows[0]['declaration_bytes']} bytes, while another client on the line looks at ten bodies.\n\n" +
                     report.markdown(COLUMNS, [cells(row) for row in rows], left=0))
    if options.json:
        report.print_json({"schema": "tactus.join/1", "context": report.context(), "rows": rows})
    elif not options.quiet:
        report.show(COLUMNS, [cells(row) for row in rows])


def csv_row(row):
    other = row["live_client"]
    return [1e-6 * row["round_trip_us"], row["rate_bit_per_s"], row["loss"], 1e-6 * row["queue_us"], int(row["sealed"]),
            row["declaration_bytes"], *(f"{value:.6g}" for value in (
                row["live_s"], row["datagrams_per_piece"], row["longest_without_progress_s"], other["wait_99_s"],
                other["wait_worst_s"], other["dropped"]))]


def cells(row):
    other = row["live_client"]
    return [row["round_trip_us"] // 1000, f"{1e-6 * row['rate_bit_per_s']:g}", f"{100 * row['loss']:g} %", row["queue_us"] // 1000,
            f"{8 * row['declaration_bytes'] / row['rate_bit_per_s']:.2f}", f"{row['live_s']:.2f}",
            f"{row['datagrams_per_piece']:.2f}", f"{1e3 * other['wait_99_s']:.0f}", f"{1e3 * other['wait_worst_s']:.0f}",
            f"{100 * other['dropped']:.2f} %"]
