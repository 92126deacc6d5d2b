# SPDX-License-Identifier: Apache-2.0
"""Plans of sweeps: a command of the program, run once for every combination of parameters. reports/plans/README.md lists every key.

A wrong plan is refused with all that is wrong in it: file, line, key, what is wrong, a remedy.
"""
import itertools
import math
import re
import tomllib
from dataclasses import dataclass, field

from common.arguments import Refusal
from .formula import LEADING, Formula, NotAFormula

MOST_POINTS, MOST_IN_RANGE, MOST_ENTRIES = 1_000_000, 1000, 256
LONGEST_WORD = 65536  # [bytes] of a command with its values: Linux passes twice as much
LONGEST_PATH = 4096
DEEP = re.compile(r"(?:[\w-]+ *\. *){64}")  # a dotted key of so many parts
MOST_BYTES = 1 << 20
MOST_FINDINGS, LONGEST_FINDING = 20, 200  # findings; characters of a part of one
SIMPLE = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9_.-]*\Z")
POINTER = re.compile(r"(?:/(?:[^~/]|~[01])*)+\Z")
OWN_FILES = {"points.csv", "times.csv", "table.csv", "context.json", "points"}
SIMPLE_REMEDY = "use letters, digits, '-', '_' and '.' only, and no '.' at the start"
HOST, SECONDS = "host", "seconds"  # columns of times.csv: where a point's command ran, and how long


@dataclass
class Input:
    """A file that is made before the points that use it; {parameter} stands for its value, {file} for the path to write."""
    name: str
    file: str
    command: list  # empty: the user gives the file


@dataclass
class Plot:
    """One figure: every y over x in a panel of its own; one line for each value of a series, if there is one."""
    name: str
    title: str
    x: str
    y: list
    series: str
    x_label: str
    y_label: list
    series_label: str
    log: str
    where: dict
    names: dict


@dataclass
class Plan:
    name: str = ""
    text: str = ""
    command: list = field(default_factory=list)
    inputs: dict = field(default_factory=dict)
    axes: list = field(default_factory=list)  # each a list of {parameter: value}; the last one varies fastest
    values: dict = field(default_factory=dict)  # parameter -> all of its values
    measures: dict = field(default_factory=dict)  # column -> JSON pointer
    times: dict = field(default_factory=dict)
    derived: dict = field(default_factory=dict)  # column -> Formula
    plots: list = field(default_factory=list)
    repeat: str = ""  # the parameter that only repeats: tables and figures show the spread over its values

    def points(self):
        """All combinations, each {parameter: value}."""
        for parts in itertools.product(*self.axes):
            yield {name: value for part in parts for name, value in part.items()}

    def count(self):
        return math.prod(map(len, self.axes))

    def timed(self):
        """Columns that differ from run to run."""
        own = {SECONDS, *self.times}
        return own | {column for column, formula in self.derived.items() if own & set(formula.names)}

    def columns(self):
        return [*self.values, *self.measures, HOST, SECONDS, *self.times, *self.derived]

    def files_of(self, point):
        """{file: input} of what the point uses."""
        return {filled(self.inputs[value].file, point): self.inputs[value] for value in point.values() if value in self.inputs}

    def words(self, point, path_of):
        """The point's command. A value that names an input stands for path_of(its file); a parameter that is a word of its own may
        be several words, or none."""
        stands = {name: path_of(filled(self.inputs[value].file, point)) if value in self.inputs else value
                  for name, value in point.items()}
        out = []
        for word in self.command:
            name = word[1:-1] if word[:1] == "{" and word[-1:] == "}" else None
            if name in point and point[name] not in self.inputs:
                out += point[name].split()
            else:
                out.append(filled(word, stands))
        return out


def filled(word, values):
    """The word with its value for each {NAME}. What was inserted is not searched again."""
    return re.sub(r"\{([^}]*)\}", lambda found: values[found[1]], word)


def load(path):
    """The plan in a file.   raises Refusal with all that is wrong"""
    try:
        with open(path, "rb") as file:
            raw = file.read(MOST_BYTES + 1)
    except OSError as refused:
        raise Refusal(f"{path}: cannot be read: {refused.strerror}", "Check that the path is right.", file=str(path)) from None
    if len(raw) > MOST_BYTES:
        raise Refusal(f"{path}: has more than {MOST_BYTES} bytes", "Give a plan, not a table.", file=str(path))
    try:
        text = raw.decode()
        if DEEP.search(text):
            raise RecursionError  # found at once: the parser takes a time that grows with the square of the depth
        root = tomllib.loads(text)
    except (UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError) as wrong:
        raise Refusal(f"{path}: is no TOML: {wrong or 'nested too deep'}", "Correct it: reports/plans/README.md lists the keys.",
                      file=str(path)) from None
    reader = _Reader(path, text)
    plan = reader.read(root)
    reader.refuse()
    return plan


class _Reader:
    def __init__(self, path, text):
        self.path, self.text, self.findings, self.first_line = path, text, [], 0

    def invalid(self, key, what, remedy):
        line = self.line_of(key)
        at = f":{line}" if line else ""
        finding = (f"{self.path}{at}: {key[:LONGEST_FINDING]}: {what[:LONGEST_FINDING]}", (remedy[0].upper() + remedy[1:])[:LONGEST_FINDING] + ".")
        if finding not in self.findings:
            self.findings.append(finding)
            self.first_line = self.first_line or line

    def refuse(self):
        if not self.findings:
            return
        shown, more = self.findings[:MOST_FINDINGS], len(self.findings) - MOST_FINDINGS
        if more > 0:
            shown.append((f"{self.path}: {more} more", "Correct these first."))
        location = {"location": f"line {self.first_line}"} if self.first_line else {}
        raise Refusal(*shown[0], findings=shown, file=str(self.path), **location)

    def line_of(self, key):
        """The first line that begins with the last name of a key, behind the header of its table."""
        *tables, name = re.sub(r"\[\d+\]", "", key).split(".", 1) if "." in key else [key]
        lines, start = self.text.splitlines(), 0
        number = re.search(r"\[(\d+)\]", key)
        if tables:
            heads = [i for i, line in enumerate(lines) if re.match(rf"\s*\[+\s*{re.escape(tables[0])}\s*\]+", line)]
            if not heads:
                return 0
            start = heads[min(int(number[1]), len(heads) - 1)] if number else heads[0]
        for i in range(start, len(lines)):
            if re.match(rf"\s*\[*\s*[\"']?{re.escape(name.split('.')[0])}[\"']?\s*[\]=]", lines[i]):
                return i + 1
        return start + 1 if tables else 0

    # values of one kind each; where one is wrong, it is noted and something harmless goes on

    def text_of(self, table, path, key, otherwise=None):
        value = table.get(key, otherwise)
        location = f"{path}.{key}" if path else key
        if value is None:
            self.invalid(location, "is missing", f'add {key} = "..."')
            return ""
        if not isinstance(value, str):
            self.invalid(location, "is no text", f'write a string: "{value}"')
            return ""
        return value

    def name_of(self, table, path, key):
        value = self.text_of(table, path, key)
        if value and not SIMPLE.match(value):
            self.invalid(f"{path}.{key}" if path else key, f"{value!r} is no name", SIMPLE_REMEDY)
        return value

    def strings(self, value, location):
        if not isinstance(value, list) or not value or len(value) > MOST_POINTS:
            self.invalid(location, "is missing" if value is None else "is no array of texts", "write an array of strings, at least one")
            return []
        if not all(isinstance(one, str) for one in value):
            self.invalid(location, "holds what is no text", 'write strings, as on a command line: "2.5%"')
            return []
        return value

    def table_of(self, root, key, is_needed=False):
        value = root.get(key)
        if value is None and is_needed:
            self.invalid(key, "is missing", f"add a table [{key}]")
        elif value is not None and not isinstance(value, dict):
            self.invalid(key, "is no table", f"write [{key}] and its keys below")
        return dict(sorted(value.items())) if isinstance(value, dict) else {}  # tables have their columns by name

    def tables_of(self, root, key):
        value = root.get(key, [])
        if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
            self.invalid(key, "is no array of tables", f"write [[{key}]] in front of each")
            return []
        self.check_size(key, value)
        return value

    def check_size(self, key, entries):
        if len(entries) > MOST_ENTRIES:
            self.invalid(key, f"has {len(entries)} entries", f"give at most {MOST_ENTRIES}")

    def allow(self, table, path, keys):
        for key in table:
            if key not in keys:
                self.invalid(f"{path}.{key}" if path else key, "is no key of a plan", "leave it out, or use one of " + ", ".join(keys))

    # the plan from top to bottom

    def read(self, root):
        plan = Plan(text=self.text)
        self.allow(root, "", ["name", "command", "input", "vary", "zip", "repeat", "measure", "time", "derive", "plot"])
        plan.name = self.name_of(root, "", "name")
        plan.command = self.strings(root.get("command"), "command")
        self.check_size("command", plan.command)
        self.read_parameters(root, plan)
        plan.measures = self.pointers(self.table_of(root, "measure", is_needed=True), "measure")
        plan.times = self.pointers(self.table_of(root, "time"), "time")
        self.read_formulas(self.table_of(root, "derive"), plan)
        self.read_inputs(self.tables_of(root, "input"), plan)
        for i, table in enumerate(self.tables_of(root, "plot")):
            plan.plots.append(self.plot(table, f"plot[{i}]", plan))
        if not self.findings:  # what follows compares everything with everything
            self.check_placeholders("command", plan.command, self.lengths_of(plan))
            self.check_uses(plan)
            self.check_files(plan)
        return plan

    def read_parameters(self, root, plan):
        for name, spec in self.table_of(root, "vary").items():
            plan.axes.append([{name: value} for value in self.parameter(f"vary.{name}", name, spec, plan)])
        for i, group in enumerate(self.tables_of(root, "zip")):
            columns = {name: self.parameter(f"zip[{i}].{name}", name, spec, plan) for name, spec in sorted(group.items())}
            if len({len(values) for values in columns.values()}) > 1:
                self.invalid(f"zip[{i}].{list(columns)[-1]}", "has not as many values as the others of its group",
                             "give the parameters of one [[zip]] equally many values")
            if columns:
                plan.axes.append([dict(zip(columns, row)) for row in zip(*columns.values())])
        repeat = self.table_of(root, "repeat")
        if not plan.axes:
            self.invalid("vary", "is missing", "add a table [vary]")
        if "repeat" in root and len(repeat) != 1:
            self.invalid("repeat", f"has {len(repeat)} parameters", "give one parameter, such as a seed")
        for name, spec in repeat.items():
            plan.repeat = name
            plan.axes.append([{name: value} for value in self.parameter(f"repeat.{name}", name, spec, plan)])
        self.check_size("vary", plan.values)
        if plan.axes and plan.count() > MOST_POINTS:
            self.invalid("vary", f"makes {plan.count()} combinations", f"stay at or below {MOST_POINTS}")

    def parameter(self, location, name, spec, plan):
        if not SIMPLE.match(name):
            self.invalid(location, "is no name", SIMPLE_REMEDY)
        if name in plan.values:
            self.invalid(location, "varies twice", "give every parameter a name of its own")
        plan.values[name] = self.range_of(spec, location) if isinstance(spec, dict) else self.strings(spec, location)
        return plan.values[name]

    def end_of_range(self, table, location, key):
        text = self.text_of(table, location, key)
        found = LEADING.match(text)
        if not found or not math.isfinite(float(found[0])):
            self.invalid(f"{location}.{key}", f"{text!r} begins with no number", 'write a number and its unit: "0.1mm"')
            return 1.0, ""
        return float(found[0]), text[found.end():]

    def range_of(self, table, location):
        """`count` values from one number to another, by equal steps or equal ratios."""
        self.allow(table, location, ["from", "to", "count", "scale"])
        (low, unit), (high, unit_of_high) = self.end_of_range(table, location, "from"), self.end_of_range(table, location, "to")
        count, scale = table.get("count"), table.get("scale", "linear")
        if not isinstance(count, int) or isinstance(count, bool) or not 2 <= count <= MOST_IN_RANGE:
            self.invalid(f"{location}.count", f"is {count}", f"give a whole number from 2 to {MOST_IN_RANGE}")
            count = 2
        if scale not in ("linear", "log"):
            self.invalid(f"{location}.scale", f"is {scale!r}", 'write "linear" or "log"')
        if unit != unit_of_high:
            self.invalid(location, f"goes from {unit or 'no unit'} to {unit_of_high or 'no unit'}", "give both ends of a range in one unit")
        if scale == "log" and not (low > 0 and high > 0):
            self.invalid(location, "is logarithmic and has an end that is not above 0", "give a logarithmic range ends above 0")
            return ["1", "2"]
        parts = [i / (count - 1.0) for i in range(count)]
        return [f"{low * math.pow(high / low, part) if scale == 'log' else low + (high - low) * part:.6g}{unit}" for part in parts]

    def pointers(self, table, path):
        self.check_size(path, table)
        out = {column: self.text_of(table, path, column) for column in table}
        for column, pointer in out.items():
            if pointer and not POINTER.match(pointer):
                self.invalid(f"{path}.{column}", f"{pointer!r} is no JSON pointer", "write one, such as /traffic/payload/bit_per_s")
        return out

    def read_formulas(self, table, plan):
        self.check_size("derive", table)
        known = {*plan.values, *plan.measures, HOST, SECONDS, *plan.times}
        for column in table:
            try:
                plan.derived[column] = Formula(self.text_of(table, "derive", column))
            except (NotAFormula, RecursionError) as wrong:
                self.invalid(f"derive.{column}", f"is no formula: {wrong}", "use numbers, columns, + - * / and parentheses")
                continue
            for name in plan.derived[column].names:
                if name not in known:
                    self.invalid(f"derive.{column}", f"{name} is no column", "use parameters, measures and times")
        seen = set()
        for column in plan.columns():
            if column in seen:
                self.invalid(column, "is the name of two columns", "give every column a name of its own")
            seen.add(column)

    def read_inputs(self, tables, plan):
        for i, table in enumerate(tables):
            location = f"input[{i}]"
            self.allow(table, location, ["name", "file", "command"])
            made = Input(self.name_of(table, location, "name"), self.text_of(table, location, "file"), [])
            if "command" in table:
                made.command = self.strings(table["command"], f"{location}.command")
            if made.name in plan.inputs:
                self.invalid(f"{location}.name", f"{made.name} is the name of another input", "give every input a name of its own")
            plan.inputs[made.name] = made
        lengths = self.lengths_of(plan)
        for i, made in enumerate(plan.inputs.values()):
            self.check_placeholders(f"input[{i}].file", [made.file], lengths)
            self.check_placeholders(f"input[{i}].command", made.command, lengths | {"file": LONGEST_PATH})
            for name in plan.values:
                if any(f"{{{name}}}" in word for word in made.command) and f"{{{name}}}" not in made.file:
                    self.invalid(f"input[{i}].file", f"does not name {{{name}}}, which its command depends on",
                                 f"write {{{name}}} into the name of the file, too")

    def column(self, table, location, key, plan, value=None):
        value = self.text_of(table, location, key) if value is None else value
        if value and value not in plan.columns():
            self.invalid(f"{location}.{key}", f"{value} is no column", "name a parameter, a measure, a time or a formula of this plan")
        if value and value == plan.repeat:
            self.invalid(f"{location}.{key}", f"{value} only repeats", "name another parameter: figures show the spread over this one")
        return value

    def texts(self, table, location, key, otherwise):
        value = table.get(key, otherwise)
        return self.strings(value, f"{location}.{key}") if isinstance(value, list) else [self.text_of(table, location, key)]

    def plot(self, table, location, plan):
        self.allow(table, location, ["name", "title", "x", "y", "series", "x_label", "y_label", "series_label", "names", "log", "where"])
        name, x = self.name_of(table, location, "name"), self.column(table, location, "x", plan)
        y = [self.column(table, location, "y", plan, one) for one in self.texts(table, location, "y", None)]
        series = self.column(table, location, "series", plan) if "series" in table else ""
        labels = self.texts(table, location, "y_label", y)
        if len(labels) != len(y):
            self.invalid(f"{location}.y_label", f"has {len(labels)} texts for {len(y)} panels", "give one for each y")
        log = self.text_of(table, location, "log", "none")
        if log not in ("none", "x", "y", "xy"):
            self.invalid(f"{location}.log", f"is {log!r}", 'write "x", "y" or "xy"')
        where, names = self.table_of(table, "where"), self.table_of(table, "names")
        for column, value in where.items():
            self.column(table, location, "where", plan, column)
            if column in plan.values and value not in plan.values[column]:
                self.invalid(f"{location}.where.{column}", f"{value!r} is no value of it", "give one of the values of this parameter")
        if not all(isinstance(text, str) for text in names.values()):
            self.invalid(f"{location}.names", "holds what is no text", "write strings")
        return Plot(name, self.text_of(table, location, "title", name), x, y, series, self.text_of(table, location, "x_label", x), labels,
                    self.text_of(table, location, "series_label", series), log, where, names)

    def lengths_of(self, plan):
        """[bytes] of what stands for each {name} at most."""
        return {name: max((LONGEST_PATH if value in plan.inputs else len(value.encode()) for value in values), default=0)
                for name, values in plan.values.items()}

    def check_placeholders(self, location, words, lengths):
        """Each {name} in a command stands for something, and no word grows too long."""
        for word in words:
            length = len(word.encode())
            for found in re.finditer(r"\{([^}]*)(\}?)", word):
                if not found[2]:
                    self.invalid(location, f"{{{found[1]} is not closed", f"close {{{found[1]} with a }}")
                elif found[1] not in lengths:
                    self.invalid(location, f"nothing here has the name {{{found[1]}}}", "use a parameter, or leave it out")
                length += lengths.get(found[1], 0)
            if length > LONGEST_WORD:
                self.invalid(location, "has a word that is too long",
                             f"shorten it: with its values it may have at most {LONGEST_WORD} bytes, files counted as {LONGEST_PATH}")

    def check_uses(self, plan):
        """Every parameter is used, in the command or for its inputs."""
        for name in plan.values:
            texts = [*plan.command, *(made.file for made in plan.inputs.values())]
            if not any(f"{{{name}}}" in text for text in texts):
                table = "repeat" if name == plan.repeat else "vary"
                self.invalid(f"{table}.{name}", "is used nowhere", f"use {{{name}}} in command, or leave the parameter out")

    def check_files(self, plan):
        """Names in the sweep's folder: its own, those of inputs and of figures."""
        files = {made.file: made for made in plan.inputs.values() if "{" not in made.file}
        if any("{" in made.file for made in plan.inputs.values()):
            for point in plan.points():
                for file, made in plan.files_of(point).items():
                    if files.setdefault(file, made) is not made:
                        self.invalid("input", f"{file} is made by two inputs", "give every input files of its own")
                        return
        figures = [plot.name + ending for plot in plan.plots for ending in (".svg", ".png", ".pdf")]
        for name in [*files, *figures]:
            if not SIMPLE.match(name):
                self.invalid("input", f"{name!r} is no name of a file", SIMPLE_REMEDY)
            if name in OWN_FILES or (name in files and name in figures):
                self.invalid("input", f"{name} is a file of the sweep's own", "give every input a file of its own")
        if len(set(figures)) < len(figures):
            self.invalid("plot.name", "is the name of two figures", "give every figure a name of its own")
