# SPDX-License-Identifier: Apache-2.0
"""`tactus bench precision -o DIR`: error against run time of methods, solvers and steps; the error of meshes.

time.csv and space.csv in the folder grow by a row per finished point, and context.json says what they are of: a stopped run
goes on there. Points are timed one after the other.
"""
import csv
import io
import json
import math
import os
import tempfile

from common import arguments, program, table
from common.arguments import Refusal
from studies import precision_report, report

SCENES, RIGID = ["membrane", "membrane-stiff", "cantilever"], "rigid"
EFFORTS = [(parts, iterations) for parts in (1, 2, 4, 8) for iterations in (25, 100, 400)]  # of rigid objects
RIGID_COLUMNS = ["motion", "parts", "iterations", "error", "seconds_per_tick", "runs"]
TOO_SLOW, ALWAYS = 2, 1e-3 * (1 - 1e-9)  # steps below 1 ms of a method so many times slower than real time are left out
TIME_COLUMNS = ["scene", "method", "steps_per_sample", "step_s", "displacement_end_error", "displacement_error", "velocity_error",
                "force_error", "energy_error", "weight_error", "push_error", "seconds_per_second", "setup_s", "runs",
                "newton_per_step",
                "solver_per_step", "unconverged_steps", "taken", "remark"]
SPACE_COLUMNS = ["scene", "poisson", "refinement", "vertices", "tets", "deflection_m_per_n", "solve_s", "quadratic_m_per_n",
                 "step_s",
                 "seconds_per_second", "transient_m"]
WHOLE = {"steps_per_sample", "runs", "unconverged_steps", "refinement", "vertices", "tets", "parts", "iterations"}
TEXT = {"scene", "method", "taken", "remark", "motion"}


def parser(what):
    made = arguments.parser("bench precision", what, "Example:\n  tactus bench precision --scene membrane -o out/precision")
    made.add_argument("--scene", action="append", choices=[*SCENES, RIGID], metavar="SCENE",
                      help="membrane, membrane-stiff, cantilever or rigid (motions of rigid objects); may be repeated [all]")
    made.add_argument("--short", action="store_true",
                      help="Coarse meshes and few steps: about 30 s of CPU time with --runs 1 instead of half an hour")
    made.add_argument("--runs", default=5, type=arguments.whole(1, 1000), metavar="N", help="Runs per measured time; the median "
                                                                                            "is reported [5]")
    arguments.add_report_options(made, output_help="Folder for report, tables and figures; a stopped run is resumed", force=True)
    return made


def work(options):
    if not options.output:
        raise Refusal("-o: the folder for the report is missing", "Give one: -o DIR.", arguments.USAGE)
    context = report.context() | {"extent": "short" if options.short else "full", "runs": str(options.runs)}
    take_up(options.output, dict(sorted(context.items())), options.force)
    study = Study(options)
    study.run()
    made = {"context": study.context, "times": study.times, "spaces": study.spaces, "rigid": study.rigid}
    folder = report.Folder(options.output, (), True)
    folder.write("precision.json", report.json_text(precision_report.as_json(made)))
    folder.write("report.md", precision_report.markdown(made))
    for name, make in precision_report.figures(made):
        if not folder.draw(name, make):
            break
    if options.json:
        report.print_json(precision_report.as_json(made))
    elif not options.quiet:
        precision_report.show(made)


def take_up(folder, context, replace):
    """Results of the same context are kept, others refused or, with -f, removed."""
    report.make_folder(folder)
    file = os.path.join(folder, "context.json")
    if replace:
        for name in ("time.csv", "space.csv", "rigid.csv", "context.json"):
            if os.path.lexists(os.path.join(folder, name)):
                os.remove(os.path.join(folder, name))
    if not os.path.exists(file):
        table.write_whole(file, report.json_text(context).encode())
        return
    with open(file, encoding="utf8") as found:
        try:
            same = json.load(found) == context
        except ValueError:
            same = False
    if not same:
        raise Refusal(f"{file}: this folder holds results of another machine, build or extent",
                      "Give another folder, or -f to replace the results in this one.")


class Growing:
    """A CSV file that grows by a row per finished point. A row is on the disk before add() returns; one that was cut off is
    dropped. Rows are kept as they are read back, so that a report made now and one made later from the file are the same."""

    def __init__(self, path, columns):
        self.path, self.columns, self.rows = path, columns, []
        if not os.path.exists(path):
            table.write_csv(path, columns, [])
            return
        with open(path, encoding="utf8", newline="") as file:
            text = file.read()
        whole = text[:text.rfind("\n") + 1]
        if whole != text:
            table.write_whole(path, whole.encode())
        lines = list(csv.reader(io.StringIO(whole)))
        if not lines or lines[0] != columns:
            raise Refusal(f"{path}: other columns than those of this study", "Give another folder, or -f to replace the results "
                                                                             "in this one.")
        for number, cells in enumerate(lines[1:], 2):
            try:
                self.rows.append(self.read(cells))
            except ValueError:
                raise Refusal(f"{path}: row {number} makes no sense", "Give another folder, or -f to replace the results in "
                                                                      "this one.") from None

    def read(self, cells):
        if len(cells) != len(self.columns):
            raise ValueError(cells)
        row = {}
        for column, cell in zip(self.columns, cells):
            if column == "transient_m":
                row[column] = [float(value) for value in cell.split()]
            else:
                row[column] = cell if column in TEXT else int(cell) if column in WHOLE else float(cell) if cell else None
        return row

    def add(self, row):
        cells = [self.cell(row[column]) for column in self.columns]
        with open(self.path, "a", encoding="utf8", newline="") as file:
            file.write(table.csv_text([cells]))
            file.flush()
            os.fsync(file.fileno())
        self.rows.append(self.read(cells))
        return self.rows[-1]

    @staticmethod
    def cell(value):
        if isinstance(value, list):
            return " ".join(f"{one:.7g}" for one in value)
        return "" if value is None else f"{value:.7g}" if isinstance(value, float) else str(value)

    def find(self, **wanted):
        return next((row for row in self.rows if all(row[key] == value for key, value in wanted.items())), None)


class Study:
    """All points; those that the folder has already are not computed again."""

    def __init__(self, options):
        self.options = options
        with open(os.path.join(options.output, "context.json"), encoding="utf8") as file:
            self.context = json.load(file)
        self.time_table = Growing(os.path.join(options.output, "time.csv"), TIME_COLUMNS)
        self.space_table = Growing(os.path.join(options.output, "space.csv"), SPACE_COLUMNS)
        self.times, self.spaces, self.rigid = [], [], []
        self.references, self.reference_scene = None, ""

    def point(self, kind, **request):
        return program.point("precision", point=kind, **request)

    def run(self):
        scenes = self.options.scene or [*SCENES, RIGID]
        plans = [self.point("plan", scene=scene, short=self.options.short) for scene in scenes if scene != RIGID]
        motions = self.point("motions")["motions"] if RIGID in scenes else []
        total = sum(1 + len(plan["methods"]) * len(plan["steps_per_sample"]) + len(plan["space"]) for plan in plans)
        total += len(motions) * len(EFFORTS)
        self.progress = program.Progress("bench precision", total, not (self.options.quiet or self.options.no_progress))
        with tempfile.TemporaryDirectory() as self.references:
            for plan in plans:
                self.time_study(plan)
                self.space_study(plan)
        self.rigid_study(motions)
        self.progress.clear()

    def rigid_study(self, motions):
        if not motions:
            return
        found = Growing(os.path.join(self.options.output, "rigid.csv"), RIGID_COLUMNS)
        for motion in motions:
            points = []
            for parts, iterations in EFFORTS:
                known = found.find(motion=motion["name"], parts=parts, iterations=iterations)
                points.append(known or found.add(self.point("rigid", motion=motion["name"], parts=parts, iterations=iterations,
                                                            runs=self.options.runs)))
                self.progress.step()
            self.rigid.append(motion | {"points": points})

    def time_study(self, plan):
        points = []
        for method in plan["methods"]:
            cost = 0
            for steps, step in zip(plan["steps_per_sample"], plan["step_s"]):
                self.progress.step()
                if cost > TOO_SLOW and step < ALWAYS:
                    continue
                points.append(self.time_point(plan, method["name"], steps))
                cost = points[-1]["seconds_per_second"]
        reference = self.time_table.find(scene=plan["scene"], method="reference",
                                         steps_per_sample=plan["reference_steps_per_sample"])
        self.times.append({"plan": plan, "reference": reference, "points": points})
        self.progress.step()

    def time_point(self, plan, method, steps):
        known = self.time_table.find(scene=plan["scene"], method=method, steps_per_sample=steps)
        if known:
            return known
        if self.reference_scene != plan["scene"]:
            self.make_reference(plan)
        row = self.point("method", scene=plan["scene"], short=self.options.short, method=method, steps_per_sample=steps,
                         runs=self.options.runs, reference=self.reference_file(plan))
        return self.time_table.add(row | {"scene": plan["scene"], "solver_per_step": row["solver_iterations_per_step"]})

    def reference_file(self, plan):
        return os.path.join(self.references, plan["scene"] + ".json")

    def make_reference(self, plan):
        made = self.point("reference", scene=plan["scene"], short=self.options.short)
        with open(self.reference_file(plan), "w", encoding="utf8") as file:
            json.dump(made, file)
        self.reference_scene = plan["scene"]
        if not self.time_table.find(scene=plan["scene"], method="reference", steps_per_sample=made["steps_per_sample"]):
            self.time_table.add(made | {"scene": plan["scene"], "method": "reference", "setup_s": 0, "runs": 1,
                                        "newton_per_step": 0,
                                        "solver_per_step": 0, "unconverged_steps": 0, "taken": "",
                                        "remark": f"observed order {made['observed_order']:.2f}"})

    def space_study(self, plan):
        for job in plan["space"]:
            row = self.space_table.find(scene=plan["scene"], refinement=job["refinement"], poisson=job["poisson"])
            row = row or self.space_table.add({"scene": plan["scene"]} | self.point("space", scene=plan["scene"], **job))
            if job["refinement"] == 1:
                self.spaces.append({"scene": plan["scene"], "points": []})
            self.spaces[-1]["points"].append(row)
            self.progress.step()
        for space in self.spaces:
            if space["scene"] == plan["scene"]:
                space.update(space_errors(space["points"]))


def extrapolate(coarse, middle, fine):
    """Limit (Aitken) of a value at refinements r, 2r and 4r, its observed order, and how far the limit moves
    when the order is taken as 2."""
    first, second = middle - coarse, fine - middle
    limit = fine + second * second / (first - second)
    return limit, math.log2(first / second), abs(limit - (fine + second / 3))


def space_errors(points):
    """The meshes of one material against their common limit; in time, against the finest of them."""
    quadratic = {point["refinement"]: point["quadratic_m_per_n"] for point in points}
    limit, order, uncertainty = extrapolate(quadratic[1], quadratic[2], quadratic[4])
    finest = points[-1]["transient_m"]
    norm = lambda values: math.sqrt(sum(value * value for value in values))

    def in_time(point):
        if point is points[-1] or not point["transient_m"] or not finest:
            return None
        return norm([a - b for a, b in zip(point["transient_m"], finest)]) / norm(finest)

    return {"limit": limit, "order": order, "uncertainty": uncertainty,
            "static_error": [abs(point["deflection_m_per_n"] / limit - 1) for point in points],
            "quadratic_error": [abs(point["quadratic_m_per_n"] / limit - 1) if point["quadratic_m_per_n"] > 0 else None
                                for point in points],
            "transient_error": [in_time(point) for point in points]}
