# SPDX-License-Identifier: Apache-2.0
"""Measure the vectors: run them against mutants of the second decoder and list which mutants no vector catches (README.md).

A mutant differs from decoder.py and its modules in one place. It is caught by a vector whose answer changes, or at which it crashes
or hangs. Exit status: 0 done, 1 the score asked for is missed or the list of equivalent mutants is wrong, 2 wrong use.
Python's standard library only; POSIX.
"""
from __future__ import annotations

import argparse
import hashlib
import importlib.abc
import importlib.util
import json
import os
import resource
import signal
import sys
import time
from pathlib import Path
from typing import Callable, NamedTuple, Optional, TextIO

from mutants import KINDS, MODULES, Module, Mutant, all_mutants
from run import Case, Mismatch, answer_lines, load_cases, read_input

MEMORY = 2 << 30                                            # bytes; a mutant that asks for more crashes
SLOWEST = 2.0                                               # seconds for a vector, besides ten times what decoder.py takes
HERE = Path(__file__).resolve().parent
EQUIVALENT = HERE / "equivalent-mutants.txt"


class Vector(NamedTuple):
    case: Case
    data: bytes
    lines: list[str]
    cost: float = 0                                         # seconds that decoder.py takes
    calls: set[tuple] = set()                               # functions that it calls, by module and first line

    def mode(self) -> Optional[str]:
        return self.case.args[1] if self.case.args else None


class Outcome(NamedTuple):
    """`by` is the vector that caught the mutant, empty if none did; `how` is differs, crash or hang."""
    by: str
    how: str


# ---- In the child: one mutant ---------------------------------------------------------------------------------------
class Loader(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports the mutant in place of its module."""

    def __init__(self, name: str, code):
        self.name, self.code = name, code

    def find_spec(self, name, path, target=None):
        return importlib.util.spec_from_loader(name, self) if name == self.name else None

    def exec_module(self, module) -> None:
        module.__file__ = str(HERE / f"{self.name}.py")
        exec(self.code, module.__dict__)


def answer(vector: Vector) -> list[str]:
    """What the decoder says, a line at a time; ends at the first line that is not the one wanted."""
    import decoder
    import session_script
    from conventions import StreamError
    printed: list[str] = []

    def say(line: dict) -> bool:
        printed.append(json.dumps(line, separators=(",", ":")))
        return len(printed) <= len(vector.lines) and printed[-1] == vector.lines[len(printed) - 1]

    try:
        is_script = "session" in vector.case.traits
        for line in session_script.lines(vector.data.decode("ascii")) if is_script else decoder.lines(vector.data, vector.mode()):
            if not say(line):
                break
    except StreamError as error:
        say({"error": {"errc": error.errc, "rule": error.rule}})
    return printed


def try_mutant(module: Module, mutant: Mutant, vectors: list[Vector], pipe: TextIO) -> None:
    """Runs the vectors until one fails, and writes its number and how; a line before each shows a hang."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    sys.meta_path.insert(0, Loader(module.name, module.code_of(mutant)))
    for number, vector in enumerate(vectors):
        print(f"{number} hang", file=pipe, flush=True)
        signal.setitimer(signal.ITIMER_PROF, SLOWEST + 10 * vector.cost)
        try:
            if answer(vector) != vector.lines:
                print(f"{number} differs", file=pipe, flush=True)
                return
        except BaseException:                               # of whatever kind: a decoder does not end so
            print(f"{number} crash", file=pipe, flush=True)
            return
    print("-1 none", file=pipe, flush=True)


def try_original(vectors: list[Vector], pipe: TextIO) -> None:
    """Writes for every vector how long decoder.py takes under this trace [s], and which functions it calls, by module and first line."""
    modules = {str(HERE / f"{name}.py"): name for name in MODULES}
    called: set = set()

    def note(frame, event, argument) -> None:               # of calls only, as it returns None
        called.add(frame.f_code)

    for vector in vectors:
        called.clear()
        begin = time.process_time()
        sys.settrace(note)
        right = answer(vector) == vector.lines
        sys.settrace(None)
        cost = time.process_time() - begin
        functions = sorted({(modules[c.co_filename], c.co_firstlineno) for c in called if c.co_filename in modules})
        print(json.dumps([right, cost, functions]), file=pipe)


# ---- In the parent --------------------------------------------------------------------------------------------------
class Child:
    """A process that runs `work(..., pipe)`; what it writes to the pipe is read at its end."""

    def __init__(self, work: Callable, *arguments):
        self.pipe, write = os.pipe()
        self.pid = os.fork()
        if self.pid == 0:
            os.close(self.pipe)
            sys.stdout = sys.stderr = open(os.devnull, "w")
            try:
                with open(write, "w", encoding="ascii") as pipe:
                    work(*arguments, pipe)
            finally:
                os._exit(0)
        os.close(write)

    def lines(self) -> list[str]:
        with open(self.pipe, encoding="ascii") as pipe:
            printed = pipe.read().splitlines()
        os.waitpid(self.pid, 0)
        return printed


class Trial:
    """A mutant at work."""

    def __init__(self, module: Module, mutant: Mutant, vectors: list[Vector]):
        self.mutant, self.vectors = mutant, vectors
        self.child = Child(try_mutant, module, mutant, vectors)

    def outcome(self) -> Outcome:
        """The last line shows it; a child that was stopped leaves that of a hang."""
        printed = self.child.lines()
        number, how = printed[-1].split() if printed else ("0", "crash")
        return Outcome("", "") if how == "none" else Outcome(self.vectors[int(number)].case.id, how)


class Suite:
    """The vectors of at most `largest` bytes, and in which order they are run against the mutants of a module."""

    def __init__(self, root: Path, largest: Optional[int]):
        cases, faults = load_cases(root)
        if faults:
            raise ValueError(f"{faults[0].id}: {faults[0].detail}")
        everything = (Vector(case, read_input(case), answer_lines(case)) for case in cases)
        self.vectors = [vector for vector in everything if largest is None or len(vector.data) <= largest]
        self.digests = {case.id: case.sha256[:12] for case in cases}
        self.caught: dict[str, dict[str, int]] = {}         # by function: how many mutants a vector has caught there

    def measure(self) -> None:
        """Runs decoder.py itself."""
        printed = [json.loads(line) for line in Child(try_original, self.vectors).lines()]
        failing = [v.case.id for v, (right, _, _) in zip(self.vectors, printed) if not right]
        if failing or len(printed) < len(self.vectors):
            raise ValueError(f"decoder.py itself fails at {failing[:1]}; see run.py")
        self.vectors = [v._replace(cost=cost, calls={tuple(f) for f in functions})
                        for v, (_, cost, functions) in zip(self.vectors, printed)]

    def order(self, module: Module, mutant: Mutant) -> list[Vector]:
        """Vectors that reach the mutated function: those that caught others there, those of the module's stems, others."""
        function = module.function_of(mutant)
        able = [v for v in self.vectors if function is None or module.name == "start_models" or (module.name, function) in v.calls]
        here = self.caught.get(f"{mutant.module}.{mutant.mutation.where}", {})
        return sorted(able, key=lambda v: (-here.get(v.case.id, 0), v.case.id.split("/")[0] not in MODULES[module.name], v.cost))

    def note(self, mutant: Mutant, outcome: Outcome) -> None:
        if outcome.by:
            here = self.caught.setdefault(f"{mutant.module}.{mutant.mutation.where}", {})
            here[outcome.by] = here.get(outcome.by, 0) + 1


class Results:
    """Outcomes by mutant, kept in a file: those stand whose decoder and vectors are the same."""

    def __init__(self, file: Optional[Path], suite: Suite):
        sources = b"".join((HERE / f"{name}.py").read_bytes() for name in MODULES)
        self.sources = hashlib.sha256(sources).hexdigest()[:12]
        self.vectors = hashlib.sha256("".join(v.case.sha256 for v in suite.vectors).encode()).hexdigest()[:12]
        self.suite, self.file = suite, file
        self.known: dict[str, Outcome] = {}
        if file and file.exists():
            for line in file.read_text("utf-8").splitlines():
                self.take(json.loads(line))

    def take(self, entry: dict) -> None:
        seen = self.suite.digests.get(entry["by"]) if entry["by"] else self.vectors
        if entry["sources"] == self.sources and entry["vectors"] == seen:
            self.known[entry["id"]] = Outcome(entry["by"], entry["how"])

    def add(self, mutant: Mutant, outcome: Outcome) -> None:
        self.known[mutant.id] = outcome
        if self.file:
            seen = self.suite.digests[outcome.by] if outcome.by else self.vectors
            with open(self.file, "a", encoding="utf-8") as out:
                out.write(json.dumps({"id": mutant.id, **outcome._asdict(), "sources": self.sources, "vectors": seen}) + "\n")


def run_mutants(modules: dict[str, Module], chosen: list[Mutant], suite: Suite, results: Results, jobs: int) -> None:
    waiting = [m for m in chosen if m.id not in results.known]
    for mutant in chosen:
        if mutant.id in results.known:
            suite.note(mutant, results.known[mutant.id])
    trials: list[Trial] = []
    begin, done = time.monotonic(), 0
    while waiting or trials:
        while waiting and len(trials) < jobs:
            mutant = waiting.pop(0)
            trials.append(Trial(modules[mutant.module], mutant, suite.order(modules[mutant.module], mutant)))
        trial = trials.pop(0)
        outcome = trial.outcome()
        suite.note(trial.mutant, outcome)
        results.add(trial.mutant, outcome)
        done += 1
        if done % 100 == 0 or not (waiting or trials):
            print(f"{done} mutants, {len(waiting)} to go, {time.monotonic() - begin:.0f} s", file=sys.stderr)


# ---- Report ---------------------------------------------------------------------------------------------------------
def read_equivalent(file: Path) -> dict[str, str]:
    """Mutant and reason; a line is `mutant | reason`."""
    lines = [line for line in file.read_text("utf-8").splitlines() if line.strip() and not line.startswith("#")]
    return dict(line.rsplit(" | ", 1) for line in lines)


def score(mutants: list[Mutant], known: dict[str, Outcome]) -> dict:
    caught = sum(bool(known[m.id].by) for m in mutants)
    return {"mutants": len(mutants), "caught": caught, "percent": round(100 * caught / len(mutants), 1) if mutants else 100.0}


def make_report(chosen: list[Mutant], everything: list[Mutant], known: dict[str, Outcome], equivalent: dict[str, str]) -> dict:
    counted = [m for m in chosen if m.id not in equivalent]
    groups = {"kinds": {k: [m for m in counted if m.mutation.kind == k] for k in KINDS},
              "modules": {name: [m for m in counted if m.module == name] for name in MODULES}}
    ids = {m.id for m in everything}
    return {
        "format": 1, **score(counted, known), "equivalent": len(chosen) - len(counted),
        **{title: {name: score(of, known) for name, of in group.items() if of} for title, group in groups.items()},
        "survivors": [{"location": m.location(), "kind": m.mutation.kind, "id": m.id} for m in counted if not known[m.id].by],
        "not_equivalent": [m.id for m in chosen if m.id in equivalent and known[m.id].by],
        "unknown": sorted(set(equivalent) - ids)}


def print_report(report: dict) -> None:
    for survivor in report["survivors"]:
        print(f"{survivor['location']}: {survivor['kind']}: {survivor['id']}")
    for title in ("kinds", "modules"):
        print(f"\n| {title[:-1]} | mutants | caught | |\n|---|---|---|---|")
        for name, part in report[title].items():
            print(f"| {name} | {part['mutants']} | {part['caught']} | {part['percent']} % |")
    for wrong in report["not_equivalent"]:
        print(f"equivalent-mutants.txt: caught after all: {wrong}")
    for wrong in report["unknown"]:
        print(f"equivalent-mutants.txt: no such mutant: {wrong}")
    print(f"\n{report['mutants']} mutants, {report['caught']} caught: {report['percent']} %; "
          f"{report['equivalent']} equivalent ones not counted")


def choose(everything: list[Mutant], options: argparse.Namespace) -> list[Mutant]:
    chosen = [m for m in everything if options.only in (None, m.module)]
    if not chosen:
        raise ValueError(f"no mutant of {options.only}")
    if options.sample and options.sample < len(chosen):
        def rank(mutant: Mutant) -> bytes:                 # does not depend on which other mutants there are
            return hashlib.sha256(f"{options.seed} {mutant.id}".encode()).digest()
        picked = set(sorted(map(rank, chosen))[:options.sample])
        chosen = [m for m in chosen if rank(m) in picked]
    return chosen


def main(arguments: list[str], root: Path) -> int:
    parser = argparse.ArgumentParser(description="Run the vectors against mutants of the second decoder.")
    parser.add_argument("--only", metavar="MODULE", help="mutants of this module, as 'rigid'")
    parser.add_argument("--sample", metavar="N", type=int, help="as many of them, chosen by --seed")
    parser.add_argument("--seed", type=int, default=1, help="of the sample (default: 1)")
    parser.add_argument("--largest", metavar="BYTES", type=int, help="only vectors of at most so many bytes")
    parser.add_argument("--jobs", metavar="N", type=int, default=1, help="processes at a time (default: 1)")
    parser.add_argument("--results", metavar="FILE", type=Path, help="keep outcomes there and go on from them")
    parser.add_argument("--least", metavar="PERCENT", type=float, default=0, help="exit with 1 if fewer are caught")
    parser.add_argument("--list", action="store_true", help="print the mutants and run none")
    parser.add_argument("--json", action="store_true", help="print the report as JSON")
    options = parser.parse_args(arguments)
    try:
        modules = all_mutants(HERE)
        everything = [m for module in modules.values() for m in module.mutants]
        chosen = choose(everything, options)
        if options.list:
            print("\n".join(f"{m.location()}: {m.mutation.kind}: {m.id}" for m in chosen))
            return 0
        suite = Suite(root, options.largest)
        results = Results(options.results, suite)
        suite.measure()
        run_mutants(modules, chosen, suite, results, max(1, options.jobs))
        report = make_report(chosen, everything, results.known, read_equivalent(EQUIVALENT))
    except (OSError, ValueError, Mismatch) as error:
        print(f"mutate.py: {error}", file=sys.stderr)
        return 2
    if options.json:
        print(json.dumps(report, indent=1))
    else:
        print_report(report)
    return 1 if report["percent"] < options.least or report["not_equivalent"] or report["unknown"] else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:], HERE))
