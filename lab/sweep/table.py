# SPDX-License-Identifier: Apache-2.0
"""Tables and figures of a sweep from the points that are there.

points.csv: a row per point; times.csv: what differs from run to run; table.csv: repetitions together, with their spread, and formulas;
context.json: of what; a figure per [[plot]] as .svg, .png and .pdf. All are in the plan's order and written anew each time.
"""
import json
import math
import os
import statistics

from common import figure, program
from common.arguments import Refusal
from common.table import csv_text, write_whole
from .formula import leading_number
from .plan import HOST, SECONDS

SCHEMA = "tactus.sweep/4"


class Group:
    """One combination of parameters with all of its repetitions."""

    def __init__(self, texts):
        self.texts, self.numbers, self.hosts = texts, {}, set()  # texts: of the first repetition; {column: [number of each]}

    def add(self, plan, row):
        numbers = {column: leading_number(text) for column, text in row.items()}
        numbers |= {column: formula.value(numbers) for column, formula in plan.derived.items()}
        for column, number in numbers.items():
            self.numbers.setdefault(column, []).append(number)
        self.hosts.add(row[HOST])

    def spread(self, column):
        """Least, middle and largest of those that are finite; NaN: there is none."""
        finite = sorted(number for number in self.numbers[column] if math.isfinite(number))
        return (finite[0], statistics.median(finite), finite[-1]) if finite else (math.nan,) * 3


def groups_of(plan, rows):
    """In the plan's order. In   rows   {column: text}, in the plan's order"""
    out = {}
    for row in rows:
        key = tuple(row[name] for name in plan.values if name != plan.repeat)
        out.setdefault(key, Group(row)).add(plan, row)
    return list(out.values())


def cell(value):
    return f"{value:.9g}" if math.isfinite(value) else ""


def spread_table(plan, groups):
    """Head and rows of table.csv."""
    columns = [*plan.measures, *(column for column in plan.derived if column not in plan.timed())]
    head = [name for name in plan.values if name != plan.repeat]
    if not plan.repeat:
        rows = [[group.texts[name] for name in head] + [middle(group, column) for column in columns] for group in groups]
        return head + columns, rows
    rows = []
    for group in groups:
        row = [group.texts[name] for name in head] + [str(len(next(iter(group.numbers.values()))))]
        for column in columns:
            low, _, high = group.spread(column)
            row += [cell(low), middle(group, column), cell(high)]
        rows.append(row)
    return [*head, "repetitions", *(column + part for column in columns for part in ("_min", "_median", "_max"))], rows


def middle(group, column):
    median = group.spread(column)[1]
    return cell(median) if math.isfinite(median) else group.texts.get(column, "")


def write(plan, folder, rows, digests):
    """All tables.   out  files, notes about figures that are not there"""
    points = [*plan.values, *plan.measures]
    times = [*plan.values, HOST, SECONDS, *plan.times]
    context = {"schema": SCHEMA, "program": program.version_and_commit(), "compiler": program.version()["compiler"],
               "cores": os.cpu_count(), "inputs": dict(sorted(digests.items())), "plan": plan.text}
    texts = {"points.csv": csv_text([points, *([row[c] for c in points] for row in rows)]),
             "times.csv": csv_text([times, *([row[c] for c in times] for row in rows)]),
             "context.json": json.dumps(context, indent=2, ensure_ascii=False) + "\n"}
    groups = groups_of(plan, rows)
    if plan.repeat or plan.derived:
        head, cells = spread_table(plan, groups)
        texts["table.csv"] = csv_text([head, *cells])
    for name, text in texts.items():
        write_whole(f"{folder}/{name}", text.encode())
    files, notes = [f"{folder}/{name}" for name in texts], []
    try:
        for plot in plan.plots:
            drawn, note = draw(plan, plot, groups, folder)
            files += drawn
            notes += note
    except Refusal as refused:
        if refused.fields.get("missing") != "matplotlib":
            raise
        notes.append(f"{refused.text}: there are no figures ({refused.remedy.removesuffix('.')})")
    return files, notes


def draw(plan, plot, groups, folder):
    """One figure.   out  files, notes"""
    shown = [group for group in groups if all(group.texts.get(column) == value for column, value in plot.where.items())]
    hosts = sorted(set().union(*(group.hosts for group in shown)))
    if plan.timed() & {plot.x, *plot.y} and len(hosts) > 1:
        return [], [f"{plot.name}: not drawn, because it would compare times of different machines: {', '.join(hosts)}"]
    lines = {}
    for group in shown:
        lines.setdefault(group.texts[plot.series] if plot.series else "", []).append(group)
    fig, axes = figure.panels(len(plot.y))
    for panel, (ax, y) in enumerate(zip(axes, plot.y)):
        for number, (value, members) in enumerate(lines.items()):
            label = plot.names.get(value, value or "none") if plot.series and len(lines) > 1 else None
            points = [(group.spread(plot.x)[1], *group.spread(y)) for group in members]
            points = sorted(point for point in points if math.isfinite(point[0]) and math.isfinite(point[2]))
            if points:
                x, low, middle_y, high = zip(*points)
                spread = {"low": low, "high": high} if plan.repeat else {}
                figure.line(ax, x, middle_y, number, label if panel == 0 else None, **spread)
        figure.scale(ax, plot.log in ("x", "xy"), plot.log in ("y", "xy"))
        ax.set_ylabel(plot.y_label[panel], wrap=True)
    axes[-1].set_xlabel(plot.x_label)
    figure.title(fig, plot.title)
    figure.legend(fig, axes, plot.series_label)
    return figure.save_all(fig, f"{folder}/{plot.name}"), []
