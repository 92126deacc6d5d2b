#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reports: each documented number is made again, and compared, by its command.

reports/made.toml lists the folders: their commands, the tables and figures that these leave, columns that are times of a machine.
Tables with a column `source` (lab/reports/cells.py) take each number from cells of those tables.
"""
import argparse
import csv
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile
import tomllib

from common import arguments, program
from common.arguments import Refusal
from common.table import csv_text, write_whole
from reports import cells

ROOT = pathlib.Path(__file__).resolve().parents[1]
REPORTS = ROOT / "reports"
DRAWN = {"sweep", "lossy_sessions", "delays", "errors", "animations"}
NOTES = """\
list: what there is. cells: numbers against the cells that their rows name; nothing is run. make: run the commands of folders and compare what
comes out. draw: figures from the tables that are there. Exit status 3: a number differs.
examples:
  python3 lab/report.py cells                      # all tables, in seconds
  python3 lab/report.py make session -o out/again  # 20 minutes; keeps what was made
  python3 lab/report.py make tolerable --write     # and puts it in place of what the report has
The program is the variable TACTUS of the environment, or on PATH; studies need TACTUS_STUDY. Recordings that are not shipped are taken from --data."""


def made():
    with open(REPORTS / "made.toml", "rb") as file:
        return tomllib.load(file)


def chosen(names, known):
    for name in names:
        if name not in known:
            raise Refusal(f"{name}: not among {', '.join(known)}", "`list` lists them.", arguments.USAGE)
    return names or list(known)


def sourced():
    """Tables of which each row has a number and its source."""
    out = []
    for path in sorted(REPORTS.rglob("*.csv")):
        with open(path, encoding="utf8", newline="") as file:
            if {"value", "source"} <= set(next(csv.reader(file), [])):
                out.append(str(path.relative_to(REPORTS)))
    return out


def check_cells(options):
    tables, status = cells.Tables(REPORTS), arguments.OK
    for name in chosen(options.names, sourced()):
        agree, elsewhere, wrong = cells.check(tables, name)
        print(f"{name}: {agree} numbers agree with their cells, {len(wrong)} do not, {elsewhere} are not to be had here")
        for line, row, again in wrong:
            print(f"  line {line}: {row['value']}, made again: {again if isinstance(again, str) else format(again, '.6g')}  ({row['source']})")
        if wrong and options.write:
            renew(tables, name, wrong)
        elif wrong:
            status = arguments.BROKEN
    return status


def renew(tables, name, wrong):
    for _, row, again in wrong:
        if isinstance(again, str):
            raise Refusal(f"{name}: {again}", "Correct the source of this row.")
        row["value"] = cells.written(again, row["value"])
    rows = tables.rows(name)
    write_whole(str(REPORTS / name), csv_text([list(rows[0]), *(row.values() for row in rows)]).encode())


def run(folder, one, data):
    """The commands of a folder, in it."""
    environment = os.environ | {name: os.path.abspath(os.environ[name]) for name in ("TACTUS", "TACTUS_STUDY") if name in os.environ}
    for file in one.get("needs", []):
        if not data or not (data / file).exists():
            raise Refusal(f"{file} is not part of this project, and not in the folder of --data", "Its page says where it is from.")
        if not os.path.lexists(folder / file):
            (folder / file).symlink_to((data / file).resolve())
    for command in one["commands"]:
        words = as_run(command)
        done = subprocess.run(words, cwd=folder, env=environment, check=False, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        if done.returncode not in (arguments.OK, arguments.BROKEN):
            raise Refusal(f"{command}\n{program.in_words(done.stderr.decode(errors='replace'))}")


def as_run(command):
    """tactus is the program; its commands that are scripts, and other scripts, are run from here, not from where it is installed."""
    first, *rest = shlex.split(command.replace("{reports}", str(REPORTS)).replace("{root}", str(ROOT)))
    if first == "tactus" and rest[0] in ("sweep", "bench", "reproduce"):
        return [sys.executable, str(ROOT / "lab" / (rest[0] + ".py")), *rest[1:]]
    if first == "tactus":
        return [os.path.abspath(program.tactus()), *rest]
    return [sys.executable, first, *(os.path.abspath(program.tactus()) if word == "tactus" else word for word in rest)]


def differences(before, after, machine, tolerance=1e-6):
    """[(line, column, before, after)] of two tables of the same rows; columns of times are left out."""
    def read(path):
        with open(path, encoding="utf8", newline="") as file:
            head, *rows = csv.reader(file)
        compared = [i for i, column in enumerate(head) if column not in machine]
        return [[row[i] for i in compared] for row in (head, *rows)]
    old, new = read(before), read(after)
    if old[0] != new[0] or len(old) != len(new):
        return [(1, "", f"{len(old)} rows of {', '.join(old[0])}", f"{len(new)} rows of {', '.join(new[0])}")]
    return [(line, column, a, b) for line, (left, right) in enumerate(zip(old, new), 1) for column, a, b in zip(old[0], left, right)
            if not same(a, b, tolerance)]


def same(a, b, tolerance):
    try:
        return a == b or abs(float(a) - float(b)) <= tolerance * max(abs(float(a)), abs(float(b))) + 1e-9  # what is 0 but for rounding
    except ValueError:
        return False


def make(options):
    known, status = made(), arguments.OK
    for name in chosen(options.names, known):
        one = known[name]
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(options.output or scratch) / name
            folder.mkdir(parents=True, exist_ok=True)
            run(folder, one, options.data)
            status = max(status, compare(name, one, folder, options.write))
    return status


def compare(name, one, folder, is_written):
    """Each table that was made against the one that the report has; figures have no numbers and are only taken over."""
    status = arguments.OK
    for target, file in one["files"].items():
        new, old = folder / file, REPORTS / target
        found = [] if not file.endswith(".csv") else differences(old, new, one.get("machine", [])) if old.exists() else [(0, "", "-", "new")]
        if file.endswith(".csv"):
            print(f"{name}: {target}: " + (f"{len(found)} cells differ" if found else "equal"))
        for line, column, a, b in found[:20]:
            print(f"  line {line}, {column}: {a}, made again: {b}")
        if found and not is_written:
            status = arguments.BROKEN
        if is_written and new.exists() and (found or not file.endswith(".csv")):
            shutil.copyfile(new, old)
    return status


def draw(options):
    from reports import draw as by
    known = {name: one for name, one in made().items() if "draw" in one}
    for name in chosen(options.names, known):
        how, *more = known[name]["draw"].split()
        figures = [REPORTS / target for target in known[name]["files"] if target.endswith(".svg")]
        with tempfile.TemporaryDirectory() as scratch:
            getattr(by, how)(figures[0].parent, *(REPORTS / word for word in more), pathlib.Path(scratch))
            for path in figures:
                if (pathlib.Path(scratch) / path.name).exists():
                    shutil.copyfile(pathlib.Path(scratch) / path.name, path)
                    print(path.relative_to(REPORTS))
                else:
                    print(f"{path.relative_to(REPORTS)}: not drawn: its numbers are not in the tables; `make {name} --write` measures them")


def show(options):
    for name, one in made().items():
        print(f"{name}: {', '.join(one['files'])}")
        for command in one["commands"]:
            print(f"    {command}")
    print("numbers from cells: " + ", ".join(sourced()))


def set_up():
    parser = arguments.parser("report", "Make the numbers and figures of reports/ again, and compare", NOTES)
    parser.prog = "report.py"
    parser.add_argument("what", choices=("list", "cells", "make", "draw"), help="See below")
    parser.add_argument("names", nargs="*", metavar="NAME", help="Tables (cells) or entries of reports/made.toml [all]")
    parser.add_argument("--write", action="store_true", help="Put what differs in place of what the report has")
    parser.add_argument("--data", type=pathlib.Path, metavar="DIR", help="Folder of recordings that are not shipped")
    parser.add_argument("-o", "--output", metavar="DIR", help="Keep what was made here; a stopped sweep is resumed")
    parser.add_argument("--json", action="store_true", help=argparse.SUPPRESS)
    return parser


if __name__ == "__main__":
    arguments.run(set_up(), lambda options: {"list": show, "cells": check_cells, "make": make, "draw": draw}[options.what](options))
