#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Run the command-line cases beside this file against a `tactus` program.

  run.py [--without PARTS] PROGRAM [CASE...]   run all cases or those named; PARTS that the program lacks: fem,observe,seal,study,surface,view
                                               ends with 77 when all of them are skipped
  run.py --self-test                           check that each kind of difference is found

A case is a folder NNN-name:
  cmd                          shell script (sh -eu), run in an empty folder; `tactus` is the program, $CASE the case's folder
  stdout.exact | stdout.glob   what must be printed; in a glob `*` stands for any text and nothing else is special
  stderr.exact | stderr.glob   the same for messages; without a file the stream must be empty
  exit                         exit status, 0 without the file
  needs                        parts of the program without which there is nothing to see, one a line: the case is skipped
A case that ends with 77 is skipped too, for the reason that it prints: the machine lacks what it needs.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

FAILED, SKIPPED = 1, 77
TIMEOUT_S = 300  # against cases that hang: with sanitizers on a busy machine the longest takes two minutes


def stream_difference(case, stream, text):
    exact, glob = case / f"{stream}.exact", case / f"{stream}.glob"
    if glob.is_file():
        wanted = glob.read_text(encoding="utf-8")
        same = re.fullmatch(".*".join(re.escape(part) for part in wanted.split("*")), text, re.S) is not None
    else:
        wanted = exact.read_text(encoding="utf-8") if exact.is_file() else ""
        same = text == wanted
    return None if same else f"{stream} is\n{text}--- expected\n{wanted}---"


def run_case(program, case):
    """Differences between what the case says and what happened."""
    with tempfile.TemporaryDirectory() as scratch:
        bin_dir, work = pathlib.Path(scratch, "bin"), pathlib.Path(scratch, "work")
        bin_dir.mkdir()
        work.mkdir()
        (bin_dir / "tactus").symlink_to(program.resolve())
        env = {"PATH": f"{bin_dir}:{os.environ['PATH']}", "HOME": str(work), "LC_ALL": "C.UTF-8", "CASE": str(case.resolve())}
        try:
            done = subprocess.run(["sh", "-eu", str(case.resolve() / "cmd")], cwd=work, env=env, capture_output=True, text=True,
                                  stdin=subprocess.DEVNULL, timeout=TIMEOUT_S, check=False)
        except subprocess.TimeoutExpired:
            return [f"still running after {TIMEOUT_S} s"]
    if done.returncode == SKIPPED:
        return [f"skipped: {done.stdout.strip()}"]
    status = case / "exit"
    wanted = int(status.read_text()) if status.is_file() else 0
    differences = [] if done.returncode == wanted else [f"exit status is {done.returncode}, expected {wanted}"]
    differences += [stream_difference(case, "stdout", done.stdout), stream_difference(case, "stderr", done.stderr)]
    return [d for d in differences if d]


def lacks(case, without):
    needs = case / "needs"
    return needs.is_file() and not without.isdisjoint(needs.read_text(encoding="utf-8").split())


def run_cases(program, cases, without):
    failed = skipped = 0
    for case in cases:
        if lacks(case, without):
            skipped += 1
            print(f"skipped {case.name}")
            continue
        differences = run_case(program, case)
        if differences and differences[0].startswith("skipped: "):
            skipped += 1
            print(case.name, *differences)
            continue
        failed += bool(differences)
        print(f"{'FAILED' if differences else 'ok':7}{case.name}", *differences, sep="\n       " if differences else "")
    print(f"{len(cases)} cases, {failed} failed, {skipped} skipped")
    return FAILED if failed else SKIPPED if skipped == len(cases) else 0


def self_test():
    base = {"cmd": "tactus", "stdout.exact": "out 12\n", "stderr.glob": "warning: * [x]\n", "exit": "3"}
    changes = [({}, True), ({"stdout.exact": "out 1\n"}, False), ({"stdout.exact": None}, False), ({"stderr.glob": "*error*"}, False),
               ({"stderr.glob": "warning: * [y]\n"}, False), ({"exit": None}, False), ({"cmd": "echo more; tactus"}, False),
               ({"cmd": "echo no; exit 77"}, False), ({"stdout.exact": None, "stdout.glob": "out *\n"}, True), ({"cmd": "not-a-program"}, False)]
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        program = pathlib.Path(scratch, "program")
        program.write_text("#!/bin/sh\necho out 12\necho 'warning: deep water [x]' >&2\nexit 3\n", encoding="utf-8")
        program.chmod(0o755)
        for number, (change, passes) in enumerate(changes):
            case = pathlib.Path(scratch, f"{number:03}-case")
            case.mkdir()
            for name, text in {**base, **change}.items():
                if text is not None:
                    (case / name).write_text(text, encoding="utf-8")
            if (run_case(program, case) == []) != passes:
                print(f"self-test: {change}: expected to {'pass' if passes else 'fail'}")
                wrong += 1
            if number == 0:
                (case / "needs").write_text("fem\nsurface\n", encoding="utf-8")
                wrong += [lacks(case, set(parts)) for parts in ([], ["mesh"], ["fem"], ["mesh", "surface"])] != [False, False, True, True]
    print(f"self-test: {len(changes)} cases, {wrong} wrong")
    return wrong == 0


def main(args):
    if args == ["--self-test"]:
        return 0 if self_test() else 1
    without = set()
    if args[:1] == ["--without"] and len(args) > 1:
        without = set(args[1].split(","))
        args = args[2:]
    if not args or args[0].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    here = pathlib.Path(__file__).resolve().parent
    cases = [here / name for name in args[1:]] or sorted(p.parent for p in here.glob("[0-9]*/cmd"))
    return run_cases(pathlib.Path(args[0]), cases, without)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
