# SPDX-License-Identifier: Apache-2.0
"""`tactus bench stability`: limits of stability of each part of the simulation, measured and from theory."""
from common import arguments, figure, program
from studies import report, stability_figures

CASES = ["jury", "wall", "client", "rigid", "fem"]
HEAD = ["study", "subject", "parameters", "verdict", "quantity", "measured", "analytic", "unit", "deviation", "remark"]


def parser(what):
    made = arguments.parser("bench stability", what, "Example:\n  tactus bench stability --short -o stability")
    made.add_argument("--case", action="append", choices=CASES, metavar="CASE",
                      help="Only this: jury, wall, client, rigid or, with finite elements, fem; may be repeated [all]")
    made.add_argument("--short", action="store_true", help="Run a selection: about 10 s of CPU time instead of 10 minutes")
    arguments.add_report_options(made, output_help="Folder for report.md, CSV, JSON and figures", force=True)
    arguments.add_jobs(made, "Cases computed in parallel")
    return made


def work(options):
    folder = report.Folder(options.output, ("report.md", "stability.csv", "stability.json"), options.force)
    there = CASES if "fem" in program.version()["components"] else CASES[:-1]
    asked = [case for case in there if not options.case or case in options.case]
    progress = program.Progress("bench stability", len(asked), not (options.quiet or options.no_progress))
    studies = program.side_by_side(lambda case: program.point("stability", case=case, short=options.short), asked, options.jobs,
                                   progress)
    if options.output:
        figures = []
        for name, caption, make in stability_figures.of(studies):
            if folder.draw(name, make):
                figures.append((name, caption))
        folder.write_csv("stability.csv", HEAD, csv_rows(studies))
        folder.write("stability.json", report.json_text(as_json(studies, options.short)))
        folder.write("report.md", markdown(studies, figures, options.short))
    if options.json:
        report.print_json(as_json(studies, options.short))
    elif not options.quiet:
        show(studies)


def value(number, unit):
    return "-" if number is None else f"{number:.5g}" + (f" {unit}" if unit else "")


def deviation(row):
    if row["deviation"] is None:
        return "-"
    text = f"{100 * row['deviation']:+.2f} %"
    return "0.00 %" if text in ("-0.00 %", "+0.00 %") else text


def parameters(row, between):
    return between.join(f"{p['name']} {p['value']:.4g}{' ' if p['unit'] else ''}{p['unit']}" for p in row["parameters"])


def cells(row):
    return [row["subject"], parameters(row, ", "), row["quantity"], value(row["measured"], row["unit"]), value(row["analytic"],
        row["unit"]),
            deviation(row), row["verdict"], row["remark"]]


def show(studies):
    for study in studies:
        report.show([study["title"], "with", "measured", "", "theory", "off by", "verdict", "remark"],
                    [["  " + row[0], *row[1:]] for row in map(cells, summed(study))])
    for study in studies:
        if study["matrix"]["rows"]:
            print()
            report.show([f"{study['title']}, {study['matrix']['corner']}", *study["matrix"]["columns"]],
                        [["  " + row["label"], *row["cells"]] for row in study["matrix"]["rows"]])


def summed(study):
    """Without the rows that are for files only."""
    return [row for row in study["rows"] if not row["detail"]]


def csv_rows(studies):
    exact = lambda number: "" if number is None else f"{number:.9g}"
    return [[study["study"], row["subject"], parameters(row, "; "), row["verdict"], row["quantity"], exact(row["measured"]),
             exact(row["analytic"]), row["unit"], exact(row["deviation"]), row["remark"]] for study in studies
             for row in study["rows"]]


def as_json(studies, is_short):
    def of_row(row):
        out = {"subject": row["subject"], "parameters": {p["name"]: {"value": p["value"], "unit": p["unit"]}
                                                         for p in row["parameters"]}}
        return out | {key: row[key] for key in ("verdict", "quantity", "unit", "measured", "analytic", "deviation", "remark")}

    def of(study):
        verdicts = {verdict: sum(row["verdict"] == verdict for row in study["rows"]) for verdict in ("stable", "limit",
            "diverges")}
        return {"study": study["study"], "title": study["title"], "text": study["text"]} | verdicts | {"rows": [of_row(row) for row in study["rows"]]}

    return {"schema": "tactus.stability/1", "extent": "short" if is_short else "full", "context": report.context(),
            "studies": [of(study) for study in studies]}


def markdown(studies, figures, is_short):
    context = report.context()
    out = ("# Where the simulation stops being stable\n\n"
           f"`tactus bench stability{' --short' if is_short else ''}` on {context['machine']} ({context['compiler']}, "
           f"{context['build']} "
           "build). Every study is deterministic; no figure here is a time.\n\n"
           "*stable*: what was disturbed comes to rest, or stays within what the disturbance explains. *limit*: a limit was "
           "measured, or the "
           "motion goes on within bounds. *diverges*: the motion grows without bound, or a step was refused with an error and "
           "the state "
           "before it was kept. The same rows are in `stability.csv` and `stability.json`.\n")
    for study in studies:
        out += f"\n## {study['title']}\n\n{study['text']}\n"
        for name, caption in figures:
            if name.startswith(study["study"] + "-"):
                out += f"\n![{caption}]({name}.svg)\n\n*{caption}*\n"
        matrix = study["matrix"]
        if matrix["rows"]:
            out += "\n" + report.markdown([matrix["corner"], *matrix["columns"]], [[row["label"], *row["cells"]]
                                                                                   for row in matrix["rows"]],
                                          left=1 + len(matrix["columns"]))
        out += ("\n| what | with | quantity | measured | theory | off by | verdict | remark |\n"
                "|---|---|---|---:|---:|---:|---|---|\n")
        out += "".join(f"| {' | '.join(cells(row))} |\n" for row in summed(study))
    return out
