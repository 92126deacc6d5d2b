# SPDX-License-Identifier: Apache-2.0
"""Figures of a report from the tables beside them, without running anything again."""
import argparse
import csv
import pathlib
import sys

from common import figure
from studies import delay, precision, precision_report, session
from sweep import plan as of_plan
from sweep import table as of_tables

figure.ENDINGS = (".svg",)  # what pages show


def rows_of(path):
    with open(path, encoding="utf8", newline="") as file:
        return list(csv.DictReader(file))


def sweep(folder, plan, out):
    """The figures of a plan; those of times need times.csv."""
    plan = of_plan.load(plan)
    rows = rows_of(folder / "points.csv")
    if (folder / "times.csv").exists():
        rows = [row | times for row, times in zip(rows, rows_of(folder / "times.csv"), strict=True)]
    there = set(rows[0])
    rows = [{of_plan.HOST: "", of_plan.SECONDS: ""} | dict.fromkeys(plan.times, "") | row for row in rows]
    groups = of_tables.groups_of(plan, rows)
    for plot in plan.plots:
        used = {plot.x, *plot.y}
        used |= {name for column in used & set(plan.derived) for name in plan.derived[column].names}
        if used & set(plan.times) <= there:
            of_tables.draw(plan, plot, groups, str(out))


def lossy_sessions(folder, out):
    """Loss is the first number of the case."""
    rows = [row for row in rows_of(folder / "session.csv") if row["motion"] == "three swinging bodies"]
    results = [{"group": row["group"], "loss": float(row["case"].split()[0]) / 100, "ticks": int(row["ticks"]),
                "ticks_over": {"any": int(row["over"])}} for row in rows if row["case"].endswith(" %")]
    figure.save_all(session.draw({"results": results}), str(out / "session-loss"))


def delays(folder, out):
    settings = {}
    for row in rows_of(folder / "delay.csv"):
        key = (row["scene"], row["user"], float(row["round_trip_ms"]), row["network"], row["clients"])
        numbers = {q[0]: None if row[q[1]] == "nan" else float(row[q[1]]) / q[3] for q in delay.QUANTITIES}
        settings.setdefault(key, []).append(numbers)
    names = ("scene", "user", "round_trip_ms", "network", "clients")
    figure.save_all(delay.draw([dict(zip(names, key)) | {"seeds": seeds} for key, seeds in settings.items()]), str(out / "delay"))


def errors(folder, out):
    """Error against run time: a study that has all of its points computes none."""
    options = argparse.Namespace(output=str(folder), scene=None, short=False, runs=5, quiet=True, no_progress=True)
    study = precision.Study(options)
    study.run()
    for name, make in precision_report.figures({"context": study.context, "times": study.times, "spaces": study.spaces,
                                                  "rigid": study.rigid}):
        figure.save_all(make(), str(out / name))


def animations(folder, out):
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests/bench/peers"))
    import animations as of_animations
    of_animations.draw_all(rows_of(folder / "points.csv"), out)
