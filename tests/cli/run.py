#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Run the command-line cases beside this file against a `tactus` program.

  run.py [--without PARTS] PROGRAM [CASE...]   run all cases or those named; PARTS that the program lacks: fem,monitor,observe,seal,study,surface,view
                                               ends with 77 when all of them are skipped
  run.py --self-test                           check that each kind of difference is found

A case is a file NNN-name: a shell script, then sections, each below a line of its own:
  (no line)                           the script (sh -eu), run in an empty folder; `tactus` is the program, $TESTS this folder, $ROOT the sources
  ---- file NAME                      a file that lies in that folder
  ---- stdout exact | stdout glob     what must be printed; in a glob `*` stands for any text and nothing else is special
  ---- stderr exact | stderr glob     the same for messages; without the section the stream must be empty
  ---- exit STATUS                    exit status, 0 without the line
  ---- needs PART...                  parts of the program without which there is nothing to see: the case is skipped
A case that ends with 77 is skipped too, for the reason that it prints: the machine lacks what it needs.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
FAILED, SKIPPED = 1, 77
TIMEOUT_S = 300  # against cases that hang: with sanitizers on a busy machine the longest takes two minutes


SECTION = re.compile(r"^---- (file \S+|(?:stdout|stderr) (?:exact|glob)|exit \d+|needs [a-z ]+)\n", re.M)


class Case:
    def __init__(self, path):
        self.name = path.name
        self.script, *rest = SECTION.split(path.read_text(encoding="utf-8"))
        self.files, self.streams, self.status, self.needs = {}, {}, 0, set()
        for title, text in zip(rest[::2], rest[1::2]):
            kind, *words = title.split()
            if kind == "file":
                self.files[words[0]] = text
            elif kind in ("stdout", "stderr"):
                self.streams[kind] = (words[0], text)
            elif kind == "exit":
                self.status = int(words[0])
            else:
                self.needs = set(words)

    def difference(self, stream, text):
        kind, wanted = self.streams.get(stream, ("exact", ""))
        if kind == "glob":
            wanted = wanted[:-1] if wanted.endswith("*\n") else wanted  # the last `*` stands for the end of the line too
            same = re.fullmatch(".*".join(re.escape(part) for part in wanted.split("*")), text, re.S) is not None
        else:
            same = text == wanted
        return None if same else f"{stream} is\n{text}--- expected\n{wanted}---"


def run_case(program, case):
    """Differences between what the case says and what happened."""
    with tempfile.TemporaryDirectory() as scratch:
        bin_dir, work = pathlib.Path(scratch, "bin"), pathlib.Path(scratch, "work")
        bin_dir.mkdir()
        work.mkdir()
        (bin_dir / "tactus").symlink_to(program.resolve())
        script = pathlib.Path(scratch, "script")
        script.write_text(case.script, encoding="utf-8")
        for name, text in case.files.items():
            (work / name).write_text(text, encoding="utf-8")
        env = {"PATH": f"{bin_dir}:{os.environ['PATH']}", "HOME": str(work), "LC_ALL": "C.UTF-8", "TESTS": str(HERE), "ROOT": str(HERE.parents[1])}
        try:
            done = subprocess.run(["sh", "-eu", str(script)], cwd=work, env=env, capture_output=True, text=True,
                                  stdin=subprocess.DEVNULL, timeout=TIMEOUT_S, check=False)
        except subprocess.TimeoutExpired:
            return [f"still running after {TIMEOUT_S} s"]
    if done.returncode == SKIPPED:
        return [f"skipped: {done.stdout.strip()}"]
    differences = [] if done.returncode == case.status else [f"exit status is {done.returncode}, expected {case.status}"]
    differences += [case.difference("stdout", done.stdout), case.difference("stderr", done.stderr)]
    return [d for d in differences if d]


def run_cases(program, cases, without):
    failed = skipped = 0
    for case in cases:
        if case.needs & without:
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
    base = {"script": "tactus", "stdout exact": "out 12\n", "stderr glob": "warning: * [x]\n", "exit 3": ""}
    changes = [({}, True), ({"stdout exact": "out 1\n"}, False), ({"stdout exact": None}, False), ({"stderr glob": "*error*\n"}, False),
               ({"stderr glob": "warning: * [y]\n"}, False), ({"stderr glob": "warning: *\n"}, True), ({"exit 3": None}, False),
               ({"script": "echo more; tactus"}, False), ({"script": "echo no; exit 77"}, False), ({"script": "not-a-program"}, False),
               ({"stdout exact": None, "stdout glob": "out *\n"}, True),
               ({"script": "cat a.txt; tactus", "file a.txt": "a\n", "stdout exact": "a\nout 12\n"}, True)]
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        program, path = pathlib.Path(scratch, "program"), pathlib.Path(scratch, "001-case")
        program.write_text("#!/bin/sh\necho out 12\necho 'warning: deep water [x]' >&2\nexit 3\n", encoding="utf-8")
        program.chmod(0o755)
        for change, passes in changes:
            sections = {title: text for title, text in {**base, **change}.items() if text is not None}
            script = sections.pop("script")
            path.write_text(script + "\n" + "".join(f"---- {title}\n{text}" for title, text in sections.items()), encoding="utf-8")
            if (run_case(program, Case(path)) == []) != passes:
                print(f"self-test: {change}: expected to {'pass' if passes else 'fail'}")
                wrong += 1
        path.write_text("tactus\n---- needs fem surface\n", encoding="utf-8")
        wrong += Case(path).needs != {"fem", "surface"}
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
    paths = [HERE / name for name in args[1:]] or sorted(HERE.glob("[0-9]*"))
    return run_cases(pathlib.Path(args[0]), [Case(path) for path in paths], without)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
