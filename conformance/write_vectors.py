#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write the vectors from the text of their cases (README.md), with the range encoder and the decoder of this folder, not with the library.

  write_vectors.py               cases/*.txt -> vectors/, manifest.json and the table of rules in spec/90-test-vectors.md
  write_vectors.py --check       write nothing; exit 1 and name what is not what the cases say
  write_vectors.py --only STEM   this stem alone (may be repeated)
  write_vectors.py --text FILE   a stream file as the lines of a case
"""
from __future__ import annotations

import argparse
import hashlib
import json
import re
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import decoder
import session_script
from case_coder import install
from case_stream import Earlier, blocks_of, stream_of
from case_text import Case, CaseError, read_cases, text_of_block
from conventions import StreamError
from packs import FORMAT, Entry, is_script, list_json, manifest_json, without_repeat
from range_coder import RangeDecoder

HERE = Path(__file__).resolve().parent
SPEC = HERE.parent / "spec" / "90-test-vectors.md"
STEMS = ("scene", "file", "packet", "range", "rigid", "load", "client", "session", "deformable", "thesis")
LARGEST = 65536                                             # bytes of an input
FLAGS = {
    "order": "breaks two rules; the one that is read first counts",
    "key": "a key packet after the first packet of a substream",
    "loss": "packets are missing, reordered or come twice: their numbers do not follow each other",
    "numbered": "packet records have numbers (type 4)",
    "baselines": "baseline_span is greater than 1",
    "substreams": "packets begin with a substream byte",
    "bounds": "the scene declaration has a bounds record",
    "loads": "the scene has loads",
    "smoothed": "the scene is smoothed",
    "motion": "the scene has motion constants",
    "driven": "the scene is driven",
    "elastic": "a deformable object has an elastic body",
    "interest": "the scene has interest",
    "basis": "a deformable object has modes that are declared",
    "computed_basis": "a deformable object has modes that both ends compute",
    "layered": "a deformable object has haptic and visual layers",
    "fade": "corrections outside a deformable object's basis fade",
    "weight_sets": "a deformable object has several sets of weights",
    "models_kept": "entropy models are part of a deformable object's state",
    "client": "runs a client: the testee is called with --replica",
    "session": "runs an end of a session: the testee is called with --session and reads a .script file",
    "large": "the input has bytes that are not in the .tct file but in the member repeat",
}


class Stem(NamedTuple):
    name: str
    entries: list[Entry]
    pack: bytes
    answers: bytes
    list: str


# ---- One case -------------------------------------------------------------------------------------------------------
def input_of(case: Case, earlier: Earlier) -> bytes:
    script = [block.text.strip() for block in case.blocks if block.kind == "script"]
    if script:
        return (script[0] + "\n").encode("ascii")
    return stream_of([block for block in case.blocks if block.kind != "expect"], case.name, earlier)


def answer_of(case: Case, data: bytes) -> str:
    """What the second decoder says."""
    install(RangeDecoder)
    args = case.fields.get("args", [])
    lines: list[dict] = []
    try:
        if is_script(case.fields):
            lines.extend(session_script.lines(data.decode("ascii")))
        else:
            for line in decoder.lines(data, args[1] if args else None):
                lines.append(line)
    except StreamError as error:
        lines.append({"error": {"errc": error.errc, "rule": error.rule}})
    return "".join(json.dumps(line, separators=(",", ":")) + "\n" for line in lines)


def check_answer(case: Case, answer: str) -> None:
    """The decoder says what the case expects: the error, or the last line."""
    last = answer.splitlines()[-1] if answer else ""
    expected = [block.text.strip() for block in case.blocks if block.kind == "expect"]
    error = json.loads(last).get("error") if last and not is_script(case.fields) else None
    wanted = {"errc": case.fields["errc"], "rule": case.fields["rule"]} if case.fields["result"] == "invalid" else None
    if error != wanted:
        raise CaseError(f"the decoder answers {last}; the case expects {wanted or 'no error'}")
    if expected and expected[0] != last:
        raise CaseError(f"the decoder answers {last}; the case expects {expected[0]}")


def check_fields(case: Case, before: int) -> None:
    """Numbers rise. One that is missing belonged to a case that is now of another stem; it is not given again."""
    unknown = set(case.fields["flags"]) - set(FLAGS)
    if unknown:
        raise CaseError(f"there is no flag {' '.join(sorted(unknown))}")
    if not re.fullmatch(r"\d{3}-[a-z0-9-]+", case.name) or int(case.name[:3]) <= before:
        raise CaseError(f"its name does not begin with a number above {before:03d}")


def entry_of(case: Case, earlier: Earlier, before: int) -> Entry:
    try:
        check_fields(case, before)
        data = input_of(case, earlier)
        answer = answer_of(case, data)
        check_answer(case, answer)
    except (CaseError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise CaseError(f"line {case.line}, {case.name}: {error or type(error).__name__}") from None
    stored = without_repeat(data, case.fields.get("repeat"))
    if len(stored) > LARGEST:
        raise CaseError(f"line {case.line}, {case.name}: {len(stored)} bytes, at most {LARGEST}")
    fields = {"name": case.name, **case.fields, "sha256": hashlib.sha256(data).hexdigest(), "what": case.what}
    return Entry(fields, stored, answer.encode("ascii"))


def make_stem(name: str) -> Stem:
    file = HERE / "cases" / f"{name}.txt"
    earlier = Earlier({}, {})
    try:
        what, cases = read_cases(file)
        entries = [entry_of(case, earlier, int(last.name[:3]) if last else 0) for last, case in zip([None, *cases], cases)]
    except CaseError as error:
        raise CaseError(f"cases/{file.name}: {error}") from None
    return Stem(name, entries, b"".join(e.input for e in entries), b"".join(e.answer for e in entries),
                list_json(name, what, entries, FORMAT))


# ---- The index of rules ---------------------------------------------------------------------------------------------
BEGIN, END = "<!-- vectors: written by write_vectors.py -->\n", "<!-- end of vectors -->\n"


def numbers(names: list[str]) -> str:
    """The numbers of cases, runs of them as `first-last`."""
    out: list[list[int]] = []
    for number in (int(name[:3]) for name in names):
        if out and number == out[-1][1] + 1:
            out[-1][1] = number
        else:
            out.append([number, number])
    return ", ".join(f"{a:03d}" if a == b else f"{a:03d}-{b:03d}" for a, b in out)


def index_by_rule(lists: dict[str, list[dict]]) -> str:
    """A line for each rule: the cases that break it or keep it at a limit, by stem."""
    of: dict[str, dict[str, list[str]]] = {}
    for stem, cases in lists.items():
        for fields in cases:
            for rule in fields.get("rules", []):
                of.setdefault(rule, {}).setdefault(stem, []).append(fields["name"])

    def order(rule: str) -> tuple:
        _, group, number = rule.split("-")
        return group, int(number)

    rows = (f"| {rule} | {'; '.join(f'{stem} {numbers(names)}' for stem, names in of[rule].items())} |\n" for rule in sorted(of, key=order))
    return "| rule | vectors |\n|---|---|\n" + "".join(rows)


def with_index(text: str, lists: dict[str, list[dict]]) -> str:
    begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
    return text[:begin] + index_by_rule(lists) + text[end:]


# ---- All ------------------------------------------------------------------------------------------------------------
def files_of(stems: list[Stem]) -> dict[Path, bytes]:
    """What the files must hold. With some stems alone, those of the others, the manifest and the index stay."""
    files = {}
    for stem in stems:
        base = HERE / "vectors" / stem.name
        files[base.with_suffix(".pack")] = stem.pack
        files[base.with_suffix(".answers")] = stem.answers
        files[base.with_suffix(".json")] = stem.list.encode("utf-8")
    if len(stems) == len(STEMS):
        files[HERE / "manifest.json"] = manifest_json([(s.name, len(s.entries), s.list) for s in stems], FLAGS, FORMAT).encode("utf-8")
        if SPEC.exists():
            lists = {stem.name: [entry.fields for entry in stem.entries] for stem in stems}
            files[SPEC] = with_index(SPEC.read_text("utf-8"), lists).encode("utf-8")
    return files


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing, exit 1 if a file is not what the cases say")
    parser.add_argument("--only", metavar="STEM", choices=STEMS, action="append", help="this stem alone")
    parser.add_argument("--text", metavar="FILE", type=Path, help="print a stream file as the lines of a case")
    parser.add_argument("--jobs", metavar="N", type=int, default=2, help="processes at a time (default: 2)")
    options = parser.parse_args()
    try:
        if options.text:
            blocks, _ = blocks_of(options.text.read_bytes(), "", Earlier({}, {}))
            print("".join(map(text_of_block, blocks)), end="")
            return 0
        wanted = sorted(options.only or STEMS, key=STEMS.index)
        with ProcessPoolExecutor(options.jobs) as pool:
            longest_first = sorted(wanted, key=lambda stem: stem not in ("deformable", "client"))
            made = dict(zip(longest_first, pool.map(make_stem, longest_first)))
        stems = [made[name] for name in wanted]
    except (OSError, CaseError) as error:
        print(f"write_vectors.py: {error}", file=sys.stderr)
        return 1
    files = files_of(stems)
    differing = [path for path, data in files.items() if not path.exists() or path.read_bytes() != data]
    for path in differing:
        if not options.check:
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(files[path])
        print(f"{'differs' if options.check else 'written'}: {path.relative_to(HERE.parent)}")
    print(f"{sum(len(stem.entries) for stem in stems)} cases, {len(differing)} files {'differ' if options.check else 'written'}")
    return 1 if options.check and differing else 0


if __name__ == "__main__":
    sys.exit(main())
