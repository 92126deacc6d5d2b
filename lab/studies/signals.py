# SPDX-License-Identifier: Apache-2.0
"""`tactus bench signals TRACE...`: packets, payload and errors of each device and force of recordings, with several codings."""
import os

from common import arguments, program
from studies import report
from studies.report import per, significant

TITLES = {"device": "position within", "contact": "force in contact and position within", "force": "force within"}
HEAD = ("recording,user,signal,within,samples,seconds,packets,payload_bytes,"
        "largest_error,rms_error,fraction_of_permitted,samples_over")


def parser(what):
    made = arguments.parser("bench signals", what, "Examples:\n  tactus bench signals truth.mcap\n"
                            "  tactus import csv pen.csv --time t --map device=x,y,0 -o pen.mcap && tactus bench signals "
                            "pen.mcap -o signals")
    made.add_argument("traces", metavar="TRACE", nargs="+", help="Recordings with users")
    arguments.add_report_options(made, output_help="Folder for report.md and CSV", force=True)
    arguments.add_jobs(made, "Recordings studied in parallel")
    return made


def work(options):
    folder = report.Folder(options.output, ("report.md", "signals.csv", "times.csv"), options.force)
    progress = program.Progress("bench signals", len(options.traces), not (options.quiet or options.no_progress))
    made = program.side_by_side(lambda trace: program.point("signals", trace=trace), options.traces, options.jobs, progress)
    recordings = [{"name": os.path.basename(trace)} | one for trace, one in zip(options.traces, made)]
    if options.output:
        folder.write_csv("signals.csv", HEAD.split(","), csv_rows(recordings))
        folder.write_csv("times.csv", ["recording", "user", "signal", "within", "median_microseconds_per_sample"],
                         [[recording["name"], *(signal[key] for key in ("user", "signal", "within")),
                           f"{1e6 * signal['time_per_sample_s']:.2f}"] for recording in recordings for signal in recording["signals"]])
        folder.write("report.md", markdown(recordings))
    if options.json:
        report.print_json(as_json(recordings))
    elif not options.quiet:
        for recording in recordings:
            for first, rows in tables(recording):
                head = columns(first)
                report.show([f"{recording['name']}: {first['user']}, {head[0]}", *head[1:]], [["  " + row[0], *row[1:]]
                    for row in rows])
                print()


def columns(signal):
    unit = "N" if signal["signal"] == "force" else "mm"
    return [TITLES[signal["signal"]], "packets/s", "payload [kbit/s]", f"largest error [{unit}]", f"RMS [{unit}]",
            "of the permitted",
            "samples over", "time per sample"]


def cells(recording, signal):
    scale, seconds = 1 if signal["signal"] == "force" else 1e3, recording["seconds"]
    return [signal["within"], f"{per(signal['packets'], seconds):.1f}", f"{8e-3 * per(signal['bytes'], seconds):.2f}",
            significant(scale * signal["largest_error"]), significant(scale * signal["rms_error"]),
            f"{signal['fraction_of_permitted']:.3f}",
            str(signal["samples_over"]), report.duration(signal["time_per_sample_s"])]


def tables(recording):
    """Pairs of a signal and the rows of its table: one for each user and signal."""
    out = []
    for signal in recording["signals"]:
        if not out or any(out[-1][0][key] != signal[key] for key in ("user", "signal")):
            out.append((signal, []))
        out[-1][1].append(cells(recording, signal))
    return out


def csv_rows(recordings):
    return [[r["name"], s["user"], s["signal"], s["within"], s["samples"], f"{r['seconds']:.6g}", s["packets"], s["bytes"],
             f"{s['largest_error']:.6g}", f"{s['rms_error']:.6g}", f"{s['fraction_of_permitted']:.6g}", s["samples_over"]]
            for r in recordings for s in r["signals"]]


def as_json(recordings):
    def row(recording, signal):
        seconds = recording["seconds"]
        return {key: signal[key] for key in ("user", "signal", "within", "samples")} | {
            "packets_per_s": per(signal["packets"], seconds), "payload_bit_per_s": 8 * per(signal["bytes"], seconds)} | {
            key: signal[key] for key in ("largest_error", "rms_error", "fraction_of_permitted", "samples_over", "time_per_sample_s")}
    return {"schema": "tactus.signals/1", "context": report.context(), "recordings": [
        {"name": r["name"], "tick_rate_hz": r["tick_rate_hz"], "seconds": r["seconds"], "rows": [row(r, s) for s in r["signals"]]}
        for r in recordings]}


def markdown(recordings):
    context = report.context()
    out = (f"# Devices and forces on their way\n\n"
           f"`tactus bench signals` on {context['machine']} ({context['compiler']}, {context['build']} build). All but the "
           f"times is "
           f"deterministic.\n\nEach sample goes through the coders of [spec/65](../../spec/65-signal.md), over a network that "
           f"loses nothing; "
           f"devices are acknowledged {1e3 * recordings[0]['round_trip_s']:.0f} ms later. What the other end shows is compared "
           f"with the "
           "sample at once. *Of the permitted*: the largest error as a fraction of what is permitted at that sample; *samples "
           "over*: those off "
           "by more; *every sample*: each is sent, and the grid is what is permitted; *time per sample*: at the sender, median. "
           "The same "
           "rows are in `signals.csv`, in SI units.\n")
    for r in recordings:
        out += f"\n## {r['name']}\n\n{r['samples']} samples at {r['tick_rate_hz']:g} Hz, {r['seconds']:.1f} s.\n"
        for first, rows in tables(r):
            head = columns(first)
            out += "\n" + report.markdown([f"{first['user']}: {head[0]}", *head[1:]], rows)
    return out
