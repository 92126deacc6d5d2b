#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Does `make.py check` find what it says that it looks for? One fault at a time in a copy of the specification."""
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SPEC = Path(__file__).resolve().parent.parent
FAULTS = [  # file, text, what it becomes, a word of the finding
    ("40-rigid.md", "(10, section 7)", "(10, section 77)", "10, section 77"),
    ("50-deformable.md", "(section 4.1)", "(section 4.9)", "section 4.9"),
    ("40-rigid.md", "R-RNG-2; R-RNG-3", "R-RNG-2; R-RNG-9", "R-RNG-9"),
    ("40-rigid.md", "| R-RIG-4 |", "| R-RIG-5 |", "R-RIG-5 is not in rules.csv"),
    ("40-rigid.md", "| R-RIG-4 | `gap`", "| R-RIG-3 | `gap`", "defined twice"),
    ("40-rigid.md", "`gap` names an object of M. | invalid |", "`gap` names an object of M. | state |", "R-RIG-4"),
    ("rules.csv", "R-API-3,invalid_argument", "R-API-3,wrong", "not registered"),
    ("rules.csv", "R-RIG-4,", "R-RIG-14,", "R-RIG-14 is defined in no table"),
    ("rules.csv", "R-RIG-4,invalid,40", "R-RIG-4,invalid,50", "names chapter 50"),
    ("rules.csv", "R-RIG-3,invalid", "R-RIG-3,state", "rigid.py: R-RIG-3 is never invalid"),
    ("rules.csv", '"this is not a Tactus stream"', '""', "the fault of R-STR-1"),
    ("rules.csv", ",drop", ",throw", "lacks an action"),
    ("00-overview.md", "(40-rigid.md)", "(41-rigid.md)", "no file 41-rigid.md"),
    ("99-changes.md", "Informative.", "[x](registry.md#9-nothing)", "no heading"),
    ("91-worked-examples.md", "**-1326**", "**-1327**", "make.py examples"),
    ("90-test-vectors.md", "| R-RIG-4 |", "| R-RIG-3 |", "R-RIG-4 has no vector"),
    ("tables/rigid-start-models.csv", "BASELINE[1],16384", "BASELINE[1],16383", "SHA-256"),
]


def check(spec: Path):
    run = subprocess.run([sys.executable, spec / "make.py", "check"], capture_output=True, text=True, check=False)
    return run.returncode, run.stdout + run.stderr


def main() -> int:
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        (Path(scratch) / "conformance").symlink_to(SPEC.parent / "conformance")
        spec = Path(scratch) / "spec"
        shutil.copytree(SPEC, spec)
        status, told = check(spec)
        if status != 0:
            print(f"the specification itself: {told}")
            wrong += 1
        for name, text, fault, word in FAULTS:
            path = spec / name
            good = path.read_text(encoding="utf-8")
            path.write_text(good.replace(text, fault, 1), encoding="utf-8")
            status, told = check(spec)
            if text not in good or status != 1 or (word or fault) not in told:
                print(f"{name}, {fault!r}: {status}, {told}")
                wrong += 1
            path.write_text(good, encoding="utf-8")
    print(f"{len(FAULTS)} faults, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
