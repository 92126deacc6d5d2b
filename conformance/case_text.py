# SPDX-License-Identifier: Apache-2.0
"""The text of cases (README.md, "The text of a case"): elements as names and values, runs of them, and the blocks of a case.

An element is (name, value); a value is an int, or a str as it stands in the text (a name in quotes, hexadecimal digits, a float).
"""
from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Iterable, Iterator, Optional, Union

Value = Union[int, str]
Element = tuple[str, Value]
TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|\(|\)\*\d+|[^\s()]+')
NUMBER = re.compile(r"-?\d+(\*\d+)?$")
NAME = re.compile(r"[a-z][a-z_]*$")
DIGITS = re.compile(r"((?:[0-9a-f]{2})*)(?:\*(\d+))?$")
RUN = re.compile(rb"(.)\1{31,}", re.S)                       # bytes that are worth a repetition
WIDTH, LONGEST_PERIOD = 158, 40


class CaseError(Exception):
    """A text that says nothing that can be written."""


# ---- Elements as text -----------------------------------------------------------------------------------------------
def repeated(elements: list, at: int) -> tuple[int, int]:
    """The period and number of the best repetition that begins there; (1, 1) if there is none."""
    best, most = (1, 1), 0
    for period in range(1, min(LONGEST_PERIOD, (len(elements) - at) // 2) + 1):
        if elements[at] != elements[at + period]:
            continue
        end = at + period
        while end < len(elements) and elements[end] == elements[end - period]:
            end += 1
        times = (end - at) // period
        saved = (times - 1) * period
        if saved > most and saved >= 3 + (period > 1) and (times > 2 or period > 5):
            best, most = (period, times), saved
    return best


def words(elements: list[Element]) -> Iterator[str]:
    name, at = "", 0
    while at < len(elements):
        period, times = repeated(elements, at)
        group = elements[at:at + period]
        if period > 1:
            yield "("
        for key, value in group:
            if key != name:
                yield key
            name = key
            yield f"{value}*{times}" if period == 1 and times > 1 and isinstance(value, int) else str(value)
        if period > 1:
            yield f")*{times}"
        at += period * times if period > 1 or isinstance(group[0][1], int) else 1


def wrapped(text: Iterable[str], first: str, more: str) -> str:
    lines, line = [], first
    for word in text:
        if len(line) + 1 + len(word) > WIDTH and line.strip():
            lines.append(line)
            line = more + word
        else:
            line += (" " if line and not line.endswith(" ") else "") + word
    return "\n".join([*lines, line]) + "\n"


def parse(text: str) -> list[Element]:
    stack: list[list[Element]] = [[]]
    name = ""
    for word in TOKEN.findall(text):
        if word == "(":
            stack.append([])
        elif word.startswith(")*"):
            group = stack.pop()
            stack[-1] += group * int(word[2:])
        elif NUMBER.match(word):
            value, _, times = word.partition("*")
            stack[-1] += [(name, int(value))] * int(times or 1)
        elif NAME.match(word):
            name = word
        else:
            stack[-1].append((name, word))
    if len(stack) != 1:
        raise CaseError("a parenthesis is not closed")
    return stack[0]


def digits(data: bytes) -> str:
    """Bytes as one value: # and their digits, runs of a byte as #00*1000, parts joined by +."""
    parts, at = [], 0
    for run in RUN.finditer(data):
        parts += [data[at:run.start()].hex()] if run.start() > at else []
        parts.append(f"{run.group(1).hex()}*{len(run.group())}")
        at = run.end()
    return "#" + "+".join([*parts, *([data[at:].hex()] if at < len(data) else [])])


def bytes_of(value: Value) -> bytes:
    data = b""
    for part in str(value).removeprefix("#").split("+"):
        match = DIGITS.match(part)
        if not match or not str(value).startswith("#"):
            raise CaseError(f"{value} is not # and hexadecimal digits")
        data += bytes.fromhex(match.group(1)) * int(match.group(2) or 1)
    return data


class Elements:
    """Elements that are taken one by one. Some names stand apart: what they override is taken by name, wherever it stands."""

    def __init__(self, elements: list[Element], apart: tuple = ()):
        self.apart = {name: value for name, value in elements if name in apart}
        self.left = [e for e in elements if e[0] not in apart] if self.apart else elements
        self.at = 0

    def next_name(self) -> Optional[str]:
        return self.left[self.at][0] if self.at < len(self.left) else None

    def take(self, name: str) -> Value:
        if self.next_name() != name:
            raise CaseError(f"element {self.at}: is {self.next_name() or 'missing'}, must be {name}")
        self.at += 1
        return self.left[self.at - 1][1]


# ---- Cases ----------------------------------------------------------------------------------------------------------
@dataclass
class Block:
    """A line of a case and the lines that go on from it: its first word, and the rest."""
    kind: str
    text: str


@dataclass
class Case:
    name: str
    what: str
    fields: dict = field(default_factory=dict)              # members of the stem's list
    blocks: list[Block] = field(default_factory=list)
    line: int = 0


def read_cases(file: Path) -> tuple[str, list[Case]]:
    """What the stem is about, and its cases."""
    cases: list[Case] = []
    what = ""
    for number, line in enumerate(file.read_text("utf-8").splitlines(), 1):
        if line.startswith("# What: "):
            what = line[len("# What: "):]
        if not line.strip() or line.startswith("#"):
            continue
        if not line.startswith(" "):
            name, _, sentence = line.partition(": ")
            cases.append(Case(name, sentence, {}, [], number))
        elif not line.startswith("    "):
            if not cases[-1].fields:
                cases[-1].fields = parse_fields(line)
            else:
                kind, _, text = line.strip().partition(" ")
                cases[-1].blocks.append(Block(kind, text))
        else:
            block = cases[-1].blocks[-1]
            block.text += ("\n" if block.kind == "script" else " ") + line.strip()
    return what, cases


def parse_fields(line: str) -> dict:
    fields: dict = {"profile": [], "flags": []}
    verdict, *members = [part.strip() for part in line.split(";")]
    if verdict == "valid":
        fields["result"] = "valid"
    else:
        errc, rule = verdict.split()
        fields.update(result="invalid", errc=errc, rule=rule, rules=[rule])
    for member in members:
        key, _, value = member.partition(" ")
        fields[key] = value if key == "section" else value.split()
    if "repeat" in fields:
        at, pattern, times = fields["repeat"]
        fields["repeat"] = {"at": int(at), "bytes": pattern, "times": int(times)}
    return fields


def write_fields(fields: dict) -> str:
    members = [fields["result"] if fields["result"] == "valid" else f"{fields['errc']} {fields['rule']}"]
    for key in ("section", "rules", "profile", "flags", "args"):
        value = fields.get(key)
        if value and not (key == "rules" and value == [fields.get("rule")]):
            members.append(f"{key} {value if isinstance(value, str) else ' '.join(value)}")
    if "repeat" in fields:
        members.append("repeat {at} {bytes} {times}".format(**fields["repeat"]))
    return "  " + "; ".join(members) + "\n"


def text_of_block(block: Block) -> str:
    """Its lines, of at most 160 columns unless a word is longer."""
    if block.kind == "script":
        return "  script\n" + "".join(f"    {line}\n" for line in block.text.splitlines())
    if block.kind == "expect":
        return f"  expect {block.text}\n"
    return wrapped(re.findall(r'"(?:[^"\\]|\\.)*"|\S+', block.text), f"  {block.kind}", "    ")
