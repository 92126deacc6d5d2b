# SPDX-License-Identifier: Apache-2.0
"""Run the conformance vectors against a decoder, the testee (README.md).

Exit status: 0 all passed, 1 something failed, 2 wrong use. Python's standard library only; POSIX.
"""
from __future__ import annotations

import argparse
import hashlib
import json
import os
import shlex
import signal
import subprocess
import sys
import tempfile
import threading
import traceback
from fnmatch import fnmatchcase
from pathlib import Path
from typing import IO, Callable, NamedTuple, NoReturn, Optional, Union

from packs import Part, unpack, with_repeat

TIMEOUT = 10.0                                              # seconds; per case, each case is a process of its own
SHOWN = 160                                                 # characters of a wrong line, about the first that differs
LARGEST_OUTPUT = 64 << 20                                   # bytes; a testee that writes more is stopped


class Component(NamedTuple):
    """What a decoder may lack (README.md, "Without a component")."""
    modes: set[str]                                         # of --replica, that belong to it
    lacking: dict                                           # how a decoder without it answers a scene that needs it
    part_of: str                                            # profile without which it is not asked


COMPONENTS = {"thesis": Component({"linear", "hermite", "blending"}, {"errc": "unsupported", "rule": "R-DEF-2"}, "main")}


class Crash(Exception):
    """The testee did neither accept nor reject the input."""


class Mismatch(Exception):
    """The testee's reply, or the suite itself, is not as it should be."""


class Case(NamedTuple):
    """What a stem's list says of a case, and where its input and answer are."""
    id: str
    input: Part
    answer: Part
    sha256: str
    repeat: Optional[dict]                                  # bytes of the input that are not in the pack
    args: list[str]
    error: Optional[dict]                                   # class and rule; None: the input is valid
    traits: set[str]                                        # profiles and flags


class Result(NamedTuple):
    id: str
    result: str                                             # pass, fail, skip
    detail: str


# ---- Testee ---------------------------------------------------------------------------------------------------------
class Fork:
    """A decoder's main() in a process of its own that is a copy of this one: starting Python anew takes longer than most cases."""

    def __init__(self, main: Callable[[list[str]], int], arguments: list[str], stdin: IO[bytes]):
        reading, writing = os.pipe()
        self.pid = os.fork()
        if self.pid == 0:
            self.run(main, arguments, stdin.fileno(), writing)
        os.close(writing)
        self.stdout = open(reading, "rb")

    @staticmethod
    def run(main: Callable[[list[str]], int], arguments: list[str], reading: int, writing: int) -> NoReturn:
        status = 1
        try:
            os.setsid()
            os.dup2(reading, 0)
            os.dup2(writing, 1)
            sys.stdin, sys.stdout = open(0), open(1, "w")
            status = main(arguments)
            sys.stdout.flush()
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(status)

    def wait(self) -> int:
        return os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])


def run_testee(command: list[str], data: bytes) -> tuple[int, list[str]]:
    """Returns the exit status, 0 or 1, and the lines of JSON on standard output."""
    return reply_of(lambda stdin: subprocess.Popen(command, stdin=stdin, stdout=subprocess.PIPE, start_new_session=True), data)


def reply_of(start: Callable[[IO[bytes]], Union[subprocess.Popen, Fork]], data: bytes) -> tuple[int, list[str]]:
    with tempfile.TemporaryFile() as stdin:
        stdin.write(data)
        stdin.seek(0)
        process = start(stdin)
    late = threading.Event()

    def stop() -> None:
        late.set()
        kill(process)

    timer = threading.Timer(TIMEOUT, stop)
    timer.start()
    try:
        with process.stdout as pipe:
            output = pipe.read(LARGEST_OUTPUT + 1)
        if len(output) > LARGEST_OUTPUT:
            kill(process)
        status = process.wait()
    finally:
        timer.cancel()
        kill(process)
    if late.is_set():
        raise Crash(f"no end within {TIMEOUT:g} s")
    if len(output) > LARGEST_OUTPUT:
        raise Crash(f"more than {LARGEST_OUTPUT} bytes of output")
    if status not in (0, 1):
        raise Crash(f"signal {-status}" if status < 0 else f"exit status {status}")
    return status, json_lines(output)


def kill(process: Union[subprocess.Popen, Fork]) -> None:
    """Ends the testee and all that it started."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except (ProcessLookupError, PermissionError):
        pass


def json_lines(output: bytes) -> list[str]:
    try:
        lines = output.decode("ascii").split("\n")
        if lines.pop() != "":
            raise ValueError("the last line does not end")
        for line in lines:
            if not isinstance(json.loads(line), dict):
                raise ValueError("a line is not an object")
    except (ValueError, RecursionError) as error:
        raise Crash(f"output is not JSON lines in ASCII: {error}") from None
    return lines


# ---- Cases ----------------------------------------------------------------------------------------------------------
def read_input(case: Case) -> bytes:
    data = with_repeat(case.input.read(), case.repeat)
    if hashlib.sha256(data).hexdigest() != case.sha256:
        raise Mismatch(f"{case.input.file.name} is not the published file: the SHA-256 of the input differs")
    return data


def answer_lines(case: Case) -> list[str]:
    return case.answer.read().decode("ascii").splitlines()


def expected_lines(case: Case) -> list[str]:
    """The lines of a valid case, or those of an invalid one before its error."""
    lines = answer_lines(case)
    if case.error and lines and "error" in json.loads(lines[-1]):
        lines.pop()
    return lines


def difference(number: int, one: str, other: str, names: tuple[str, str] = ("is     ", "must be")) -> str:
    """Two lines about their first different character, short enough for a terminal."""
    at = next((i for i, (a, b) in enumerate(zip(one, other)) if a != b), min(len(one), len(other)))
    begin, end = (0, SHOWN) if at < SHOWN // 2 else (at - SHOWN // 2, at + SHOWN // 2)
    text = f"line {number}, character {at + 1}:"
    for name, line in zip(names, (one, other)):
        text += f"\n  {name} " + "..." * (begin > 0) + line[begin:end] + "..." * (end < len(line))
    return text


def check_reply(case: Case, status: int, lines: list[str]) -> None:
    if case.error:
        if status != 1:
            raise Mismatch(f"accepted; must be rejected with {case.error['errc']} {case.error['rule']}")
        error = json.loads(lines.pop()).get("error") if lines else None
        if error != case.error:
            raise Mismatch(f"rejected with {error}; must be {case.error}")
    elif status != 0:
        raise Mismatch(f"rejected with {lines[-1] if lines else 'exit status 1 and no line of JSON'}; must be accepted")
    expected = expected_lines(case)
    for number, (line, wanted) in enumerate(zip(lines, expected), 1):
        if line != wanted:
            raise Mismatch(difference(number, line, wanted))
    if len(lines) != len(expected):
        raise Mismatch(f"{len(lines)} lines; must be {len(expected)}")


def make_case(root: Path, stem: str, fields: dict) -> Case:
    if fields["result"] not in ("valid", "invalid"):
        raise ValueError("result is neither valid nor invalid")
    base = root / "vectors" / stem
    error = {"errc": fields["errc"], "rule": fields["rule"]} if fields["result"] == "invalid" else None
    case = Case(f"{stem}/{fields['name']}", Part(base.with_suffix(".pack"), *fields["input"]), Part(base.with_suffix(".answers"), *fields["answer"]),
                fields["sha256"], fields.get("repeat"), fields.get("args", []), error, {*fields["profile"], *fields["flags"]})
    for part in (case.input, case.answer):
        if part.offset < 0 or part.size < 0 or part.file.stat().st_size < part.offset + part.size:
            raise ValueError(f"{part.file.name} has no bytes {part.offset} to {part.offset + part.size}")
    return case


def gaps(cases: list[Case], stem: str) -> list[Result]:
    """Bytes of a stem's pack or answers that belong to no case, or to two."""
    faults = []
    for parts in ([case.input for case in cases], [case.answer for case in cases]):
        at = 0
        for part in parts:
            if part.offset != at:
                faults.append(Result(f"{stem}", "fail", f"{part.file.name}: a case begins at byte {part.offset}; must be {at}"))
            at = part.offset + part.size
        if parts and parts[0].file.stat().st_size != at:
            faults.append(Result(f"{stem}", "fail", f"{parts[0].file.name}: bytes from {at} on belong to no case"))
    return faults


def load_stem(root: Path, stem: str, manifest: dict) -> tuple[list[Case], list[Result]]:
    content = (root / "vectors" / f"{stem}.json").read_bytes()
    if hashlib.sha256(content).hexdigest() != manifest["sha256"]:
        raise ValueError("its SHA-256 is not that of the manifest")
    listed = json.loads(content)["cases"]
    if len(listed) != manifest["cases"]:
        raise ValueError(f"{len(listed)} cases; the manifest says {manifest['cases']}")
    cases, faults = [], []
    for fields in listed:
        try:
            cases.append(make_case(root, stem, fields))
        except (OSError, ValueError, KeyError, TypeError) as error:
            faults.append(Result(f"{stem}/{fields.get('name')}", "fail", f"cannot be read: {error!r}"))
    return cases, faults or gaps(cases, stem)


def load_cases(root: Path) -> tuple[list[Case], list[Result]]:
    """The cases of all stems and the faults of the suite itself, which count as failures."""
    cases, faults = [], []
    unlisted = {path for path in (root / "vectors").rglob("*") if path.is_file()}
    try:
        stems = dict(json.loads((root / "manifest.json").read_text("utf-8"))["stems"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        return [], [Result("manifest.json", "fail", f"cannot be read: {error!r}")]
    for stem, manifest in stems.items():
        unlisted.difference_update(root / "vectors" / f"{stem}{suffix}" for suffix in (".json", ".pack", ".answers"))
        try:
            more, bad = load_stem(root, stem, manifest)
            cases += more
            faults += bad
        except (OSError, ValueError, KeyError, TypeError) as error:
            faults.append(Result(f"vectors/{stem}.json", "fail", f"cannot be read: {error!r}"))
    ids = [case.id for case in cases]
    faults += [Result(i, "fail", "listed twice") for i in sorted(set(ids)) if ids.count(i) > 1]
    faults += [Result(str(path.relative_to(root)), "fail", "belongs to no stem") for path in sorted(unlisted)]
    if not cases:
        faults.append(Result("manifest.json", "fail", "no case"))
    return cases, faults


def known_failures(root: Path) -> set[str]:
    file = root / "known-failures.txt"
    lines = file.read_text("utf-8").splitlines() if file.exists() else []
    return {line.strip() for line in lines if line.strip() and not line.startswith("#")}


Testee = Callable[[list[str], bytes], tuple[int, list[str]]]  # of a case's arguments and input


def make_testee(command: Optional[str], without: set[str]) -> Testee:
    """Without a command the second decoder, which lacks the components that are left out."""
    if command:
        return lambda arguments, data: run_testee(shlex.split(command) + arguments, data)
    import decoder                                          # beside this file
    lacks = [word for name in sorted(COMPONENTS.keys() & without) for word in ("--without", name)]
    return lambda arguments, data: reply_of(lambda stdin: Fork(decoder.main, arguments + lacks, stdin), data)


def judge(case: Case, testee: Testee, known: bool) -> Result:
    """A failure that is known is skipped, one that is known and does not happen is a failure."""
    try:
        check_reply(case, *testee(case.args, read_input(case)))
    except (Crash, Mismatch) as error:
        kind = "crash: " if isinstance(error, Crash) else ""
        return Result(case.id, "skip" if known else "fail", kind + str(error))
    return Result(case.id, "fail", "passes; take it off known-failures.txt") if known else Result(case.id, "pass", "")


def needed(case: Case) -> set[str]:
    """Profiles, flags and components that the case needs."""
    return case.traits | {name for name, c in COMPONENTS.items() if case.id.startswith(f"{name}/") or c.modes & set(case.args)}


def lacking(case: Case, without: set[str]) -> Optional[Case]:
    """Where a decoder lacks a component and nothing else that the case needs: what it must answer to a valid scene of this component."""
    names = needed(case) & without
    component = COMPONENTS.get(next(iter(names))) if len(names) == 1 else None
    if component is None or case.error or component.part_of in without or component.modes & set(case.args) or not names <= case.traits:
        return None
    return case._replace(answer=case.answer._replace(size=0), error=component.lacking)


def run_suite(root: Path, testee: Testee, only: str, without: set[str]) -> list[Result]:
    cases, results = load_cases(root)
    known = known_failures(root)
    results += [Result(i, "fail", "in known-failures.txt, but no case") for i in sorted(known - {case.id for case in cases})]
    traits = {trait for case in cases for trait in needed(case)}
    results += [Result(trait, "fail", "is no profile or flag of any case") for trait in sorted(without - traits)]
    chosen = []
    for case in cases:
        asked = case if not needed(case) & without else lacking(case, without)
        if asked and fnmatchcase(case.id, only):
            chosen.append(asked)
    if cases and not chosen:
        results.append(Result(only, "fail", "matches no case"))
    return results + [judge(case, testee, case.id in known) for case in chosen]


def main(arguments: list[str], root: Path) -> int:
    parser = argparse.ArgumentParser(description="Run the Tactus conformance vectors against a decoder.")
    parser.add_argument("--testee", metavar="CMD", help="command line of the decoder (default: decoder.py, beside this file)")
    parser.add_argument("--only", metavar="GLOB", default="*", help="run the cases whose id matches, as 'rigid/*'")
    parser.add_argument("--without", metavar="NAME", action="append", default=[],
                        help="leave out the cases with this flag, profile or component, as 'layered' (may be repeated)")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object, the counts on standard error")
    parser.add_argument("--unpack", metavar="DIR", type=Path, help="write every input and answer as a file of its own, and run nothing")
    options = parser.parse_args(arguments)
    try:
        if options.unpack:
            print(f"{unpack(root, options.unpack)} cases written to {options.unpack}")
            return 0
        results = run_suite(root, make_testee(options.testee, set(options.without)), options.only, set(options.without))
    except (OSError, ValueError, KeyError) as error:
        print(f"run.py: {error}", file=sys.stderr)
        return 2
    number = {kind: sum(r.result == kind for r in results) for kind in ("pass", "fail", "skip")}
    counts = f"{number['pass']} passed, {number['fail']} failed, {number['skip']} skipped"
    if options.json:
        print(json.dumps({"format": 1, "passed": number["pass"], "failed": number["fail"], "skipped": number["skip"],
                          "cases": [r._asdict() for r in results]}, indent=1))
        print(counts, file=sys.stderr)
    else:
        for r in results:
            if r.result != "pass":
                print(f"{r.result.upper()} {r.id}: {r.detail}")
        print(counts)
    return 1 if number["fail"] else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:], Path(__file__).resolve().parent))
