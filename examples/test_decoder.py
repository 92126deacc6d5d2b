# SPDX-License-Identifier: Apache-2.0
"""Runs decoder.py over the conformance vectors that have no deformable objects:  python3 test_decoder.py [FILE.tct]

With a file it compares the output of decoder.py with that of the second decoder (conformance/).
"""
import json
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import decoder

HERE = Path(__file__).resolve().parent
CONFORMANCE = HERE.parent / "conformance"
sys.path.insert(0, str(CONFORMANCE))
from conventions import fnv1a  # noqa: E402  (the second decoder's)
from run import answer_lines, load_cases, read_input  # noqa: E402

LEFT_OUT = {"R-STR-11", "R-STR-14", "R-STR-16", "R-STR-17", "R-STR-20", "R-FIL-4", "R-PKT-1"}   # rules about names, limits, extensions


def state_hash(one: decoder.Decoder) -> str:
    """40, section 6."""
    data = b""
    for i in one.scene.moving:
        tick, *vectors, (smoothing_exp, retained) = one.states[i]
        data += struct.pack("<Q13i", tick, *(c for vector in vectors for c in vector))
        data += struct.pack("<I", smoothing_exp + 8 * retained) if one.scene.smoothed else b""
    return f"{fnv1a(data):016x}"


def answer(data: bytes) -> list:
    """For each packet its tick, the objects that it updates and the state after it; then the rule that the file breaks, if any."""
    found: list = []
    try:
        for one, named in decoder.updates(data):
            found.append([one.tick, named, state_hash(one)])
    except decoder.Refused as refused:
        found.append(str(refused))
    return found


def expected(lines: list) -> list:
    found: list = [[p["tick"], [update[0] for update in p["updates"]], p["state"]] for p in lines if "packet" in p]
    return found + [line["error"]["rule"] for line in lines if "error" in line]


def lines_of(text: str) -> list:
    return [json.loads(line) for line in text.splitlines()]


def check_vectors() -> None:
    cases, faults = load_cases(CONFORMANCE)
    assert not faults, faults
    for case in cases:
        if "session" in case.traits:
            continue                                        # no stream
        data = read_input(case)
        found = answer(data)
        if found and "are left out" in found[-1]:
            assert found[1:] == [] and data[6] & 123, case.id  # bits 0, 1 and 3 to 6 of flags
        elif not case.error or case.error["rule"] not in LEFT_OUT:
            want = expected(list(map(json.loads, answer_lines(case))))
            assert found == want, f"{case.id}: {found[-1:]}; must be {want[-1:]}"


def check_file(file: Path) -> None:
    second = subprocess.run([sys.executable, CONFORMANCE / "decoder.py"], stdin=file.open("rb"), capture_output=True, check=True)
    found = answer(file.read_bytes())
    assert len(found) > 1 and found == expected(lines_of(second.stdout.decode("ascii")))


def check_program() -> None:
    """Units are SI, and a refusal names the rule."""
    inputs = {case.id: read_input(case) for case in load_cases(CONFORMANCE)[0]}

    def run(name: str) -> subprocess.CompletedProcess:
        with tempfile.NamedTemporaryFile(suffix=".tct") as file:
            file.write(inputs[name])
            file.flush()
            return subprocess.run([sys.executable, HERE / "decoder.py", file.name], capture_output=True, text=True, check=False)

    first = lines_of(run("rigid/001-one-axis").stdout)[0]  # 91: residual -1326, level 5, position_exp 22
    assert first["object"] == "slider" and first["position"] == [-1326 * 2 ** 5 / 2 ** 22, 0, 0], first
    refused = run("deformable/060-one-triangle")
    assert refused.returncode == 1 and "are left out" in refused.stderr, refused


if __name__ == "__main__":
    check_program()
    check_vectors()
    for name in sys.argv[1:]:
        check_file(Path(name))
