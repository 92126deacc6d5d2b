# SPDX-License-Identifier: Apache-2.0
"""What a figure of the thesis is made of: a report, the same as text, tables, and a drawing that is made only when it is asked for."""
import dataclasses
import math
import typing

from common import program, table

WEBER = 0.1  # c of chapter 4
DEGREE = math.pi / 180


@dataclasses.dataclass
class Made:
    report: dict
    text: str
    draw: typing.Callable | None = None  # () -> a figure of matplotlib
    tables: dict = dataclasses.field(default_factory=dict)  # name of the file without .csv -> (head, rows)


def points(options, label, name, requests):
    """Many points side by side, in the order of the requests."""
    bar = program.Progress(label, len(requests), not options.quiet and not options.no_progress)
    return program.side_by_side(lambda request: program.point(name, **request), requests, options.jobs, bar)


def added(values):
    """In their order and without compensation for rounding, as opposed to sum() of later Pythons."""
    out = 0.0
    for value in values:
        out += value
    return out


def mean(values):
    return added(value / len(values) for value in values)


def deviation(values):
    middle = mean(values)
    return math.sqrt(added((v - middle) * (v - middle) for v in values) / (len(values) - 1)) if len(values) > 1 else 0.0


def plus_minus(values, digits=1):
    return f"{mean(values):.{digits}f} +- {deviation(values):.{digits}f}"


def with_spread(values):
    return {"mean": mean(values), "standard_deviation": deviation(values)}


def percent_over(value, reference):
    return 100 * (value / reference - 1)


def lines(*parts):
    """Text of a report: parts are lines, or lists of lines."""
    return "\n".join(line for part in parts for line in ([part] if isinstance(part, str) else part))


def six(value):
    """Six digits, for tables."""
    return f"{value:.6g}"


def about_faster_hand(options):
    return [f"The faster hand takes {options.duration_scale:g} of the time for each movement and has a tremor of {1e3 * options.tremor:g} mm. "
            "The usual 0.5 and 0.4 mm are a fit to three",
            "rates of figure 3.14, no evidence of how the thesis's people moved."]


class Numbers:
    """The table of a figure of chapter 4: what comes out here, beside the thesis's number where it gives one, or by setting."""

    def __init__(self, figure, title, columns=("here", "thesis")):
        self.figure, self.title, self.columns, self.rows = figure, title, list(columns), []

    def add(self, name, unit, *values):
        """None: there is no such value."""
        self.rows.append((name, unit, list(values) + [None] * (len(self.columns) - len(values))))

    def value(self, name, column):
        return next(values for known, _, values in self.rows if known == name)[self.columns.index(column)]

    def report(self):
        return {"schema": "tactus.reproduce_delay/1", "figure": self.figure, "quantities": [
            {"name": name, "unit": unit, "values": {c: v for c, v in zip(self.columns, values) if v is not None}}
            for name, unit, values in self.rows]}

    def text(self):
        cells = [[f"{name} [{unit}]", *map(_rounded, values)] for name, unit, values in self.rows]
        return lines(f"Thesis figure {self.figure[3:]}: {self.title}", "", table.aligned(["", *self.columns], cells))

    def made(self, draw, tables):
        return Made(self.report(), self.text(), draw, tables)


def _rounded(value):
    """Three digits, without those that say nothing."""
    if value is None:
        return "-"
    step = 0.01 if abs(value) < 10 else 0.1
    steps = math.copysign(math.floor(abs(value) / step + 0.5), value)  # halves away from zero
    return f"{0 if abs(value) < step / 2 else steps * step:g}"
