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
import threading
from fnmatch import fnmatchcase
from pathlib import Path
from typing import NamedTuple

TIMEOUT = 10.0                                              # seconds; per case, each case is a process of its own
LARGEST_OUTPUT = 64 << 20                                   # bytes; a testee that writes more is stopped


class Crash(Exception):
    """The testee did neither accept nor reject the input."""


class Mismatch(Exception):
    """The testee's reply, or the suite itself, is not as it should be."""


class Result(NamedTuple):
    id: str
    result: str                                             # pass, fail, skip
    detail: str


def run_testee(command: list[str], input_file: Path) -> tuple[int, list[str]]:
    """Returns the exit status, 0 or 1, and the lines of JSON on standard output."""
    with open(input_file, "rb") as data:
        process = subprocess.Popen(command, stdin=data, stdout=subprocess.PIPE, start_new_session=True)
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


def kill(process: subprocess.Popen) -> None:
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


def expected_lines(case: dict, folder: Path) -> list[str]:
    """The lines of a valid case, or those of an invalid one before its error."""
    lines = (folder / case["expect"]["output"]).read_text("ascii").splitlines()
    if case["expect"]["class"] == "invalid" and lines and "error" in json.loads(lines[-1]):
        lines.pop()
    return lines


def check_reply(case: dict, folder: Path, status: int, lines: list[str]) -> None:
    expect = case["expect"]
    if expect["class"] == "invalid":
        wanted = {"errc": expect["errc"], "rule": expect["rule"]}
        if status != 1:
            raise Mismatch(f"accepted; must be rejected with {wanted['errc']} {wanted['rule']}")
        error = json.loads(lines.pop()).get("error") if lines else None
        if error != wanted:
            raise Mismatch(f"rejected with {error}; must be {wanted}")
    elif status != 0:
        raise Mismatch(f"rejected with {lines[-1] if lines else 'no line'}; must be accepted")
    expected = expected_lines(case, folder)
    for number, (line, wanted) in enumerate(zip(lines, expected), 1):
        if line != wanted:
            raise Mismatch(f"line {number}:\n  is      {line}\n  must be {wanted}")
    if len(lines) != len(expected):
        raise Mismatch(f"{len(lines)} lines; must be {len(expected)}")


def run_case(case: dict, folder: Path, command: list[str]) -> None:
    input_file = folder / case["input"]
    if hashlib.sha256(input_file.read_bytes()).hexdigest() != case["sha256"]:
        raise Mismatch(f"{input_file} is not the published file: its SHA-256 differs")
    check_reply(case, folder, *run_testee(command + case["args"], input_file))


def load_case(root: Path, path: str, unlisted: set[Path]) -> dict:
    """Reads a case and takes its files off the list of files that no case names."""
    file = root / path
    case = json.loads(file.read_text("utf-8"))
    if case["expect"]["class"] not in ("valid", "invalid"):
        raise ValueError("expect.class is neither valid nor invalid")
    if path != f"vectors/{case['id']}.json":
        raise ValueError(f"its id {case['id']} is not its place")
    own = [file, file.parent / case["input"], file.parent / case["expect"]["output"]]
    unlisted.difference_update(own)
    for part in own:
        if not part.is_file():
            raise FileNotFoundError(f"{part} is missing")
    return case


def load_cases(root: Path) -> tuple[list[dict], list[Result]]:
    """The cases of the manifest and the faults of the suite itself, which count as failures."""
    cases, faults = [], []
    unlisted = {path for path in (root / "vectors").rglob("*") if path.is_file()}
    try:
        paths = json.loads((root / "manifest.json").read_text("utf-8"))["cases"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        return [], [Result("manifest.json", "fail", f"cannot be read: {error!r}")]
    for path in paths:
        try:
            cases.append(load_case(root, path, unlisted))
        except (OSError, ValueError, KeyError, TypeError) as error:
            faults.append(Result(str(path), "fail", f"cannot be read: {error!r}"))
    ids = [case["id"] for case in cases]
    faults += [Result(i, "fail", "listed twice") for i in sorted(set(ids)) if ids.count(i) > 1]
    faults += [Result(str(path.relative_to(root)), "fail", "in no case of the manifest") for path in sorted(unlisted)]
    if not cases:
        faults.append(Result("manifest.json", "fail", "no case"))
    return cases, faults


def known_failures(root: Path) -> set[str]:
    file = root / "known-failures.txt"
    lines = file.read_text("utf-8").splitlines() if file.exists() else []
    return {line.strip() for line in lines if line.strip() and not line.startswith("#")}


def judge(case: dict, folder: Path, command: list[str], known: bool) -> Result:
    """A failure that is known is skipped, one that is known and does not happen is a failure."""
    try:
        run_case(case, folder, command)
    except (Crash, Mismatch) as error:
        kind = "crash: " if isinstance(error, Crash) else ""
        return Result(case["id"], "skip" if known else "fail", kind + str(error))
    return Result(case["id"], "fail", "passes; take it off known-failures.txt") if known else \
        Result(case["id"], "pass", "")


def run_suite(root: Path, command: list[str], only: str) -> list[Result]:
    cases, results = load_cases(root)
    known = known_failures(root)
    unknown = known - {case["id"] for case in cases}
    results += [Result(i, "fail", "in known-failures.txt, but no case") for i in sorted(unknown)]
    chosen = [case for case in cases if fnmatchcase(case["id"], only)]
    if cases and not chosen:
        results.append(Result(only, "fail", "matches no case"))
    for case in chosen:
        folder = (root / "vectors" / case["id"]).parent
        results.append(judge(case, folder, command, case["id"] in known))
    return results


def main(arguments: list[str], root: Path) -> int:
    parser = argparse.ArgumentParser(description="Run the Tactus conformance vectors against a decoder.")
    parser.add_argument("--testee", metavar="CMD", help="command line of the decoder (default: decoder.py, beside this file)")
    parser.add_argument("--only", metavar="GLOB", default="*", help="run the cases whose id matches, as 'rigid/*'")
    parser.add_argument("--json", action="store_true", help="print the results as one JSON object, the counts on standard error")
    options = parser.parse_args(arguments)
    here = Path(__file__).resolve().parent
    try:
        command = shlex.split(options.testee) if options.testee else [sys.executable, str(here / "decoder.py")]
        results = run_suite(root, command, options.only)
    except (OSError, ValueError) as error:
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
