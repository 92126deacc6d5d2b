# SPDX-License-Identifier: Apache-2.0
"""Rules in source code: every name is in rules.csv, with a class that the rule has, and every rule is reported somewhere."""
import re
from pathlib import Path

LIBRARIES = ("codec", "session", "io", "metrics", "sim", "device", "bindings", "cli")  # what reports rules; the compiler knows their names from the same table
NAME = re.compile(r'"(R-[A-Z]+-\d+)"')
ELEMENTS = {"R-VAR-1"}                                      # reported by the rule of the element that is broken
DEFECT = "internal"                                         # a rule that the library's own output would break
CLASS = re.compile(r'(?:Errc::|")(\w+)"?,\s*(?:RuleName\()?"(R-[A-Z]+-\d+)"')


def sources(root: Path):
    """(path, text) of what names rules: the libraries, and the conformance suite with its own decoder."""
    for folder in (*LIBRARIES, "conformance"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".h", ".cpp", ".py"):
                yield path.relative_to(root), path.read_text(encoding="utf-8")


def findings(root: Path, rules: dict, classes: set):
    """In a copy of the specification alone there is nothing to look at."""
    reported = set()
    for path, text in sources(root):
        names = set(NAME.findall(text))
        yield from (f"{path}: {name} is not in rules.csv" for name in sorted(names - rules.keys()))
        if path.parts[0] in LIBRARIES:
            reported |= names
        for code, name in CLASS.findall(text):
            if code in classes - {DEFECT} and name in rules and code not in rules[name]["class"].split("|"):
                yield f"{path}: {name} is never {code}, says rules.csv"
    if reported:
        yield from (f"rules.csv: nothing reports {name}" for name in sorted(rules.keys() - reported - ELEMENTS))
