# SPDX-License-Identifier: Apache-2.0
"""Compare a decoder, the testee, with decoder.py on damaged vectors, or both ends of a session with session_script.py (README.md).

Damage is seeded: the same seed and number give the same file. Check values are repaired after most of it, so that it reaches the code
behind them. Exit status: 0 no difference, 1 a difference, 2 wrong use. Python's standard library only; POSIX.
"""
from __future__ import annotations

import argparse
import json
import random
import shlex
import struct
import sys
import zlib
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Optional

import decoder
import session_script
from conventions import StreamError
from file import File
from interpolation import MODES
from run import Crash, difference, load_cases, run_testee
from scene import Limits
from session_damage import Scripts, make_script

FIXED = 12                                                  # bytes of the declaration before its body
LATEST_TICK = 5000                                          # a client looks at every tick up to the last packet's
BORDERS = [0, 1, 0x7f, 0x80, 0xff, 0x7fff, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff]


def varint(value: int) -> bytes:
    out = bytearray()
    while value >= 0x80:
        out.append(value & 0x7f | 0x80)
        value >>= 7
    return bytes(out) + bytes([value])


def sections(data: bytes) -> list[tuple[int, int, int]]:
    """Beginning, payload and its end of the declaration and of each record, as far as lengths lead; a check value follows each."""
    found, at = [], 0
    while True:
        payload = at + (FIXED if at == 0 else 1)
        if len(data) < payload:
            return found
        if at == 0:
            size = struct.unpack_from("<I", data, 8)[0]
        else:
            size, shift = 0, 0
            while True:
                if payload >= len(data) or shift > 63:
                    return found
                size |= (data[payload] & 0x7f) << shift
                shift, payload = shift + 7, payload + 1
                if data[payload - 1] < 0x80:
                    break
        if payload + size + 4 > len(data):
            return found
        found.append((at, payload, payload + size))
        at = payload + size + 4


def repaired(data: bytes) -> bytes:
    out = bytearray(data)
    for begin, _, end in sections(data):
        struct.pack_into("<I", out, end, zlib.crc32(out[begin:end]))
    return bytes(out)


def damaged_bytes(data: bytes, other: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(data) + 1)
    length = min(rng.choice([1, 1, 2, 4, 8, 30]), len(data) - at)
    kind = rng.randrange(7)
    if kind == 0 and data:
        at = rng.randrange(len(data))
        return data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1:]
    if kind == 1:
        return data[:at] + data[at + length:]
    if kind == 2:
        return data[:at] + data[at:at + length] + data[at:]
    if kind == 3:
        return data[:at] + rng.randbytes(length) + data[at + length:]
    if kind == 4:
        value = rng.choice(BORDERS)
        new = varint(value) if rng.randrange(2) else struct.pack("<I", value)
        return data[:at] + new + data[at + len(new):]
    if kind == 5:
        start = rng.randrange(len(other) + 1)
        return data[:at] + other[start:start + length] + data[at + length:]
    return data[:at]


def damaged_section(data: bytes, other: bytes, rng: random.Random) -> bytes:
    """One payload is damaged, and the length in front of it is right again."""
    found = sections(data)
    if not found:
        return damaged_bytes(data, other, rng)
    begin, payload, end = rng.choice(found)
    new = damaged_bytes(data[payload:end], other, rng)
    length = struct.pack("<I", len(new)) if begin == 0 else varint(len(new))
    head = data[begin:8] if begin == 0 else data[begin:begin + 1]
    return data[:begin] + head + length + new + data[end:]


class Vectors:
    """Files to damage. Those with a fault are the smaller part: most damage hides behind it."""

    def __init__(self, root: Path, only: str):
        cases, faults = load_cases(root)
        if faults:
            raise ValueError(f"{faults[0].id}: {faults[0].detail}")
        streams = [case for case in cases if "session" not in case.traits and fnmatchcase(case.id, only)]
        self.every = [case.input.read() for case in streams]
        self.valid = [case.input.read() for case in streams if not case.error]

    def choose(self, rng: random.Random) -> bytes:
        return rng.choice(self.valid if rng.randrange(4) else self.every)


def make_case(vectors: Vectors, seed: int, number: int) -> tuple[bytes, Optional[str]]:
    """A damaged file, and what client looks at it, if any."""
    rng = random.Random(f"{seed} {number}")
    data = vectors.choose(rng)
    for _ in range(rng.choice([1, 1, 1, 1, 2, 4])):
        other = vectors.choose(rng)
        data = damaged_section(data, other, rng) if rng.randrange(4) else damaged_bytes(data, other, rng)
    if rng.randrange(8):
        data = repaired(data)
    mode = rng.choice([None, None, "none", "device", "linear", "hermite", "blending", "playout"])
    return data, mode if last_tick(data) <= LATEST_TICK else None


def last_tick(data: bytes) -> int:
    tick = 0
    try:
        for packet in File(data).packets():
            tick = packet.tick
    except StreamError:
        pass
    return tick


def expected(data: bytes, mode: Optional[str], limits: Limits = Limits()) -> tuple[int, list[str]]:
    """Exit status and lines of decoder.py, without a process for each case."""
    lines = []
    try:
        for line in decoder.lines(data, mode, limits):
            lines.append(json.dumps(line, separators=(",", ":")))
    except StreamError as error:
        return 1, lines + [json.dumps({"error": {"errc": error.errc, "rule": error.rule}}, separators=(",", ":"))]
    return 0, lines


def first_difference(command: list[str], data: bytes, wanted: tuple[int, list[str]]) -> str:
    """What the testee says that decoder.py does not; empty if they agree."""
    try:
        got = run_testee(command, data)
    except Crash as crash:
        return f"crash: {crash}"
    if got == wanted:
        return ""
    for number, (line, right) in enumerate(zip(got[1], wanted[1]), 1):
        if line != right:
            return difference(number, line, right, ("testee    ", "decoder.py"))
    return f"testee: exit status {got[0]}, {len(got[1])} lines; decoder.py: {wanted[0]}, {len(wanted[1])}"


def compare(options: argparse.Namespace, vectors: Vectors) -> int:
    command, limits = shlex.split(options.testee), Limits(thesis=options.without != "thesis")
    accepted, rules, differences = 0, set(), 0
    for number in range(options.first, options.first + options.cases):
        data, mode = make_case(vectors, options.seed, number)
        if mode in MODES and not limits.thesis:
            mode = "none"
        wanted = expected(data, mode, limits)
        accepted += wanted[0] == 0
        if wanted[0] == 1:
            rules.add(json.loads(wanted[1][-1])["error"]["rule"])
        found = first_difference(command + (["--replica", mode] if mode else []), data, wanted)
        if found:
            differences += 1
            print(f"case {number} of seed {options.seed}: {found}")
            if options.keep:
                (Path(options.keep) / f"{options.seed}-{number}.tct").write_bytes(data)
    print(f"{options.cases} cases, {accepted} accepted, {len(rules)} rules broken, {differences} differences")
    return 1 if differences else 0


def compare_sessions(options: argparse.Namespace, scripts: Scripts) -> int:
    command, limits = shlex.split(options.testee) + ["--session"], Limits(thesis=options.without != "thesis")
    rules, differences = set(), 0
    for number in range(options.first, options.first + options.cases):
        text = make_script(scripts, options.seed, number)
        try:
            lines = list(session_script.lines(text, limits))
        except Exception as error:                          # a defect of ours, not of the script
            found = f"session_script.py: {error!r}"
            lines = []
        else:
            found = first_difference(command, text.encode("ascii"), (0, [json.dumps(line, separators=(",", ":")) for line in lines]))
        rules |= {line["error"]["rule"] for line in lines if "error" in line}
        if found:
            differences += 1
            print(f"script {number} of seed {options.seed}: {found}")
            if options.keep:
                (Path(options.keep) / f"{options.seed}-{number}.script").write_text(text, encoding="ascii")
    print(f"{options.cases} scripts, {len(rules)} rules broken, {differences} differences")
    return 1 if differences else 0


def main(arguments: list[str], root: Path) -> int:
    parser = argparse.ArgumentParser(description="Compare a decoder with decoder.py on damaged vectors.")
    parser.add_argument("--sessions", action="store_true", help="damaged scripts of sessions instead, for both ends")
    parser.add_argument("--testee", metavar="CMD", required=True, help="command line of the decoder")
    parser.add_argument("--only", metavar="GLOB", default="*", help="damage the vectors whose id matches, as 'rigid/*' (default: all; not with --sessions)")
    parser.add_argument("--without", choices=("thesis",), help="the testee lacks this component")
    parser.add_argument("--cases", type=int, default=1000, help="how many files (default: 1000)")
    parser.add_argument("--first", type=int, default=0, help="number of the first one (default: 0)")
    parser.add_argument("--seed", type=int, default=1, help="another seed damages otherwise (default: 1)")
    parser.add_argument("--keep", metavar="DIR", help="write files with differences there")
    options = parser.parse_args(arguments)
    try:
        if options.sessions:
            return compare_sessions(options, Scripts(root))
        vectors = Vectors(root, options.only)
        if not vectors.valid or options.cases < 1:
            raise ValueError("no cases" if vectors.valid else f"{options.only}: matches no valid case")
        return compare(options, vectors)
    except (OSError, ValueError, KeyError) as error:
        print(f"differential.py: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:], Path(__file__).resolve().parent))
