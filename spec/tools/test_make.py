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
    # What stands in several places
    ("registry.md", "| R-ELA | 55 |", "| | |", "R-ELA is of None, by rules.csv of 55"),
    ("registry.md", "20 (1 to 18, 22), 42", "20 (1 to 17, 22), 42", "R-STR is of 20 (1 to 17, 22)"),
    ("registry.md", "surface files (1 to 7)", "surface files (1 to 6)", "R-SRF is"),
    ("registry.md", "| R-TGN | filling", "| R-TGO | filling", "R-TGO is no rule"),
    ("20-scene.md", "| 6 | has **interest** |", "| 7 | has **interest** |", "20, section 4: flags are bits"),
    ("20-scene.md", "if bit 6 of flags is set: 44", "if interest is declared: 44", "20, section 8: the order of checks has"),
    ("44-interest.md", "Bit 6 of `flags`", "Bit 5 of `flags`", "44, section 2: does not say that bit 6"),
    ("00-overview.md", "(42-driven.md) | 4 |", "(42-driven.md) | 3 |", "00, section 5: [42 Driven objects](42-driven.md) has bit 3"),
    ("50-deformable.md", "| work of the bases | 2^22 |", "| work of the bases | 2^23 |", "a testee's limits"),
    ("20-scene.md", "| bytes of states | 2^28 |", "| bytes of states | 2^29 |", "a testee's limits"),
    ("70-session.md", "| 5 | state | up |", "| 5 | status | up |", "registry, section 4: part `type` up"),
    ("70-session.md", "2 refusal (down), 3 leave (both)", "2 refusal (down), 3 bye (both)", "kind of a handshake"),
    ("70-session.md", "| 4 | silence | nothing", "| 7 | silence | nothing", "registry, section 4: `reason` 3"),
    ("70-session.md", "| seat | the seat from now on | the same |\n", "", "70, section 3.1: nothing says what the part seat does"),
    ("70-session.md", "| buttons | hold unless", "| knobs | hold unless", "70, section 3.2: nothing says what the part buttons does"),
    ("70-session.md", "| leave | R-SES-1 | R-SES-1 | closed", "| bye | R-SES-1 | R-SES-1 | closed", "70, section 3.1: nothing says what the handshake leave does"),
    ("95-security.md", "R-DEF-8 to 14", "R-DEF-8 to 13", "95, section 5: R-DEF-14 has the action None"),
    ("95-security.md", "R-ELA-n, R-SES-10", "R-ELA-n", "95, section 5: R-SES-10 has"),
    ("00-overview.md", "| [55 Elastic bodies](55-elastic.md) |", "| Elastic bodies |", "00, section 5: lists"),
    ("00-overview.md", "44, 45, 50; of 55", "44, 50; of 55", "no class implements chapter 45"),
    ("00-overview.md", "some 10 000 words", "some 14 000 words", "00, section 1: the core has"),
    ("90-test-vectors.md", "| `session` | both ends", "| `sessions` | both ends", "90, section 1: stems"),
    ("../conformance/README.md", "| `line` `clients` `left` `error`", "| `line` `error` `clients` `left`", "line of a server's end has the members"),
    ("../conformance/README.md", "`elastic` `interest` `bounds` |", "`elastic` `bounds` |", "header has the members"),
    ("../conformance/README.md", "2^28\nbytes of states", "2^27\nbytes of states", "a testee's limits"),
    ("../conformance/README.md", "| `datagram.py`, `session.py`", "| `session.py`", "does not name datagram.py"),
    # References from the rest of the tree
    ("../conformance/README.md", "(20, section 6)", "(20, section 66)", "conformance/README.md: no section 66"),
    ("../conformance/cases/rigid.txt", "section 40 Prediction", "section 40 Guesses", "rigid.txt: no section 40 Guesses"),
    ("../codec/reference.h", "and 5.2", "and 5.9", "codec/reference.h: no section 5.9"),
    ("../codec/reference.h", "rigid.md sections 3", "rigid.md sections 33", "no section 33"),
    ("../codec/reference.h", "40-rigid.md", "41-rigid.md", "no chapter spec/41-rigid.md"),
    ("../codec/reference.h", "45-load 4", "45-load 44", "no section 44"),
    ("../codec/reference.h", "42, section 4", "42, section 7", "no section 7"),
    ("../codec/reference.h", "of chapter 30", "of chapter 31", "no chapter section 2 of chapter 31"),
    ("../docs/reference.md", "#2-packet", "#2-packets", "no heading ../spec/40-rigid.md#2-packets"),
    ("../docs/reference.md", "section 3", "section 39", "no section 39"),
    ("../docs/reference.md", "80-file.md", "80-files.md", "no file ../spec/80-files.md"),
]


REFERENCES = {  # files that refer to the specification
    "codec/reference.h": "// Every form: spec/40-rigid.md sections 3\n// and 5.2; 42, section 4; section 2 of chapter 30.\n/// spec 45-load 4\n",
    "docs/reference.md": "[Packets](../spec/40-rigid.md#2-packet), section 3; [files](../spec/80-file.md).\n",
}


def check(spec: Path):
    run = subprocess.run([sys.executable, spec / "make.py", "check"], capture_output=True, text=True, check=False)
    return run.returncode, run.stdout + run.stderr


def main() -> int:
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        suite = Path(scratch) / "conformance"
        suite.mkdir()
        for path in (SPEC.parent / "conformance").iterdir():
            if path.name == "README.md":
                shutil.copy(path, suite)
            elif path.name == "cases":
                shutil.copytree(path, suite / path.name)
            else:
                (suite / path.name).symlink_to(path)
        for name, text in REFERENCES.items():
            (Path(scratch) / name).parent.mkdir(exist_ok=True)
            (Path(scratch) / name).write_text(text, encoding="utf-8")
        spec = Path(scratch) / "spec"
        shutil.copytree(SPEC, spec)
        status, printed = check(spec)
        if status != 0:
            print(f"the specification itself: {printed}")
            wrong += 1
        for name, text, fault, word in FAULTS:
            path = spec / name
            good = path.read_text(encoding="utf-8")
            path.write_text(good.replace(text, fault, 1), encoding="utf-8")
            status, printed = check(spec)
            if text not in good or status != 1 or (word or fault) not in printed:
                print(f"{name}, {fault!r}: {status}, {printed}")
                wrong += 1
            path.write_text(good, encoding="utf-8")
    print(f"{len(FAULTS)} faults, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
