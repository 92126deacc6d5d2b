# SPDX-License-Identifier: Apache-2.0
"""A table whose column `source` says where each number is from.

    mean{driven/points.csv | scene=push-1dof | loss=0% | packets_per_s} / 1000    a formula over cells of other tables (in reports/)
    sum{rigid/points.csv | seed=1..8 | coder!=-p 4% | force_over}                 a whole number from 1 to 8; another text
    least{elastic/points.csv | told=0.9 or 1.1 | packets_per_s}                   one of two texts
    {../lab/study/wall.cpp ~ kMass =} * 1000                                      the number that follows a text in any file
    defined: 714 * 3 * 32                                                         arithmetic alone
    machine: ./go bench                                                           not to be had here: a machine, another program,
    quoted: VegaFEM 3.1, its paper                                                a recording that is not shipped; why stands behind it

A cell in braces names a table, conditions on its columns, and a formula over the columns of the rows that meet them. Without a word before
the brace there is one such row; mean, least, largest, farthest (from 0), amount (of the farthest, without its sign),
sum and rows take any number.

    largest over v p: {a.csv | coder=main | bits} / {a.csv | coder=thesis | bits}     of the formula for each v and p that the first cell has
"""
import csv
import math
import pathlib
import re

from common.arguments import Refusal
from sweep.formula import Formula, NotAFormula, leading_number

DEFINED = "defined:"
NOT_HERE = ("machine:", "quoted:", "recording:")
CELL = re.compile(r"(?P<join>[a-z]*)\{(?P<what>[^{}]*)\}")
OVER = re.compile(r"(?P<join>[a-z]+) over (?P<columns>[\w ]+):")
EITHER = " or "
SPAN = re.compile(r"(\d+)\.\.(\d+)")
NUMBER = re.compile(r"\s*[-+]?(?:\d[\d']*\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
JOINS = {"mean": lambda all: sum(all) / len(all), "least": min, "largest": max, "farthest": lambda all: max(all, key=abs),
         "amount": lambda all: max(map(abs, all)), "sum": math.fsum, "rows": len}


class Tables:
    """Tables of reports/ by name, each read once."""

    def __init__(self, folder):
        self.folder, self.read = pathlib.Path(folder), {}

    def rows(self, name):
        if name not in self.read:
            with open(self.folder / name, encoding="utf8", newline="") as file:
                self.read[name] = list(csv.DictReader(file))
        return self.read[name]

    def text(self, name):
        """With one blank for each space between words."""
        return " ".join((self.folder / name).read_text(encoding="utf8").split())


def column_formula(text, row):
    """A formula over columns whose names may hold anything but blanks and signs; a name of a column alone is that column."""
    if text in row:
        return leading_number(row[text])
    return Formula(text).value({name: leading_number(cell or "") for name, cell in row.items()})


def is_met(row, conditions):
    return all(is_one_of(row[column], value) != is_other for column, is_other, value in conditions)


def is_one_of(cell, value):
    """1..8 stands for whole numbers from 1 to 8, 'a or b' for either."""
    found = SPAN.fullmatch(value)
    return cell in value.split(EITHER) or bool(found and cell.isdecimal() and int(found[1]) <= int(cell) <= int(found[2]))


def parts(tables, what):
    """out  name, conditions (column, whether it must differ, value), formula"""
    name, *conditions, formula = (part.strip() for part in what.split(" | "))
    wanted = []
    for condition in conditions:
        column, _, value = condition.partition("=")
        wanted.append((column.removesuffix("!").strip(), column.endswith("!"), value.strip()))
    for column, _, _ in wanted:
        if column not in tables.rows(name)[0]:
            raise Refusal(f"{name}: has no column {column}")
    return name, wanted, formula


def after_text(tables, name, text):
    """The number that stands behind a text which is there once."""
    parts = tables.text(name).split(text)
    found = NUMBER.match(parts[1]) if len(parts) == 2 else None
    if not found:
        raise Refusal(f"{name}: the text '{text}' stands there {len(parts) - 1} times, or no number follows it")
    return float(found[0].replace("'", ""))


def cell(tables, join, what, fixed):
    """in   fixed  {column: value} that holds where the cell names no value of the column"""
    if "~" in what:
        name, _, text = what.partition("~")
        return after_text(tables, name.strip(), text.strip())
    name, wanted, formula = parts(tables, what)
    named = {column for column, is_other, value in wanted if not is_other and EITHER not in value}
    columns = tables.rows(name)[0]
    wanted = wanted + [(column, False, value) for column, value in fixed.items() if column in columns and column not in named]
    met = [row for row in tables.rows(name) if is_met(row, wanted)]
    if not met or (not join and len(met) > 1):
        raise Refusal(f"{name}: {len(met)} rows meet {' | '.join(f'{column}={value}' for column, _, value in wanted)}")
    numbers = [number for number in (column_formula(formula, row) for row in met) if math.isfinite(number)]
    if not numbers:
        raise Refusal(f"{name}: no number in {formula}")
    return JOINS[join or "mean"](numbers)


def value(tables, source):
    """raises Refusal, NotAFormula"""
    found = OVER.match(source)
    if not found:
        return one_value(tables, source, {})
    first = CELL.search(source)
    if not first or found["join"] not in JOINS:
        raise Refusal("names no cell of a table, or none of " + ", ".join(JOINS))
    name, wanted, _ = parts(tables, first["what"])
    columns = found["columns"].split()
    fixed = dict.fromkeys(tuple(row[column] for column in columns) for row in tables.rows(name) if is_met(row, wanted))
    return JOINS[found["join"]]([one_value(tables, source[found.end():], dict(zip(columns, values))) for values in fixed])


def one_value(tables, source, fixed):
    if source.startswith(DEFINED):
        return Formula(source.removeprefix(DEFINED).strip()).value({})
    numbers = {}

    def named(found):
        if found["join"] and found["join"] not in JOINS:
            raise Refusal(f"{found['join']} is none of {', '.join(JOINS)}")
        numbers[f"c{len(numbers)}"] = cell(tables, found["join"], found["what"], fixed)
        return f" c{len(numbers) - 1} "

    formula = CELL.sub(named, source)
    if not numbers:
        raise Refusal("names no cell of a table")
    return Formula(formula.strip()).value(numbers)


def decimals(text):
    """Where the last digit of a written number stands: 2 for 0.26, 6 for 8.5e-5."""
    mantissa, _, exponent = text.lower().partition("e")
    return len(mantissa.partition(".")[2]) - int(exponent or 0)


def written(number, text):
    """The number with as many digits as `text` has."""
    places = decimals(text)
    if "e" in text.lower():
        mantissa, exponent = f"{number:.{len(text.lower().partition('e')[0].partition('.')[2])}e}".split("e")
        return f"{mantissa}e{int(exponent)}"
    out = f"{number:.{max(places, 0)}f}"
    return "0" + out[2:] if out.startswith("-0") and float(out) == 0 else out


def agrees(number, text):
    typed = text.replace(" ", "").replace("\N{MINUS SIGN}", "-")
    return abs(number - float(typed)) <= 0.5000001 * 10.0 ** -decimals(typed)


def check(tables, name):
    """out  (rows that agree, rows that are not to be had here, [(line, what is stated, value, number or error)])"""
    agree, elsewhere, wrong = 0, 0, []
    for line, row in enumerate(tables.rows(name), 2):
        source = row["source"]
        if source.startswith(NOT_HERE):
            elsewhere += 1
            continue
        try:
            number = value(tables, source)
            if agrees(number, row["value"]):
                agree += 1
                continue
            again = number
        except (Refusal, NotAFormula, OSError, KeyError, ValueError) as refused:
            again = getattr(refused, "text", str(refused) or repr(refused))
        wrong.append((line, row, again))
    return agree, elsewhere, wrong
