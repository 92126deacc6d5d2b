# SPDX-License-Identifier: Apache-2.0
"""Damaged scripts of sessions, for differential.py: lines of the vectors removed, doubled, swapped and mixed, their bytes changed, and
datagrams that no vector has. Check values are repaired after most of it. The same seed and number give the same script.
"""
from __future__ import annotations

import itertools
import json
import random
from pathlib import Path
from typing import Optional

from datagram import DOWN, FORMS, HANDSHAKE, KINDS, PACKET, PARTS, UP, WELCOME, head, is_of_epoch, part, sealed, varint
from run import load_cases
from session_script import split_mix

LONGEST = 60_000                                            # bytes of a script: larger ones are slow and show nothing more
STEPS = {DOWN: [16_011] * 12 + [150_000, 700_000, 3_000_000, 11_000_000, 121_000_000], UP: [300_017] * 12 + [30_017, 900_000, 11_000_000, 121_000_000]}  # us
DRAWN = 4                                                   # epochs
BORDERS = [0, 1, 2, 3, 6, 7, 63, 64, 127, 128, 255, 1023, 1024, 4095, 4096, 1 << 14, (1 << 32) - 1, (1 << 53), (1 << 64) - 1]


class Scripts:
    """Those of the vectors, as lines of JSON."""

    def __init__(self, root: Path):
        cases, faults = load_cases(root)
        if faults:
            raise ValueError(f"{faults[0].id}: {faults[0].detail}")
        texts = [case.input.read().decode("ascii") for case in cases if "session" in case.traits]
        self.all = [[json.loads(line) for line in text.splitlines()] for text in texts if len(text) <= LONGEST]

    def of(self, direction: int) -> list[list[dict]]:
        return [lines for lines in self.all if ("join" in lines[0]) == (direction == DOWN)]


def known_epochs(lines: list[dict]) -> list[int]:
    """What the script names or a server draws; 0 for what has none."""
    found = {0}
    if "entropy" in lines[0]:
        found.update(itertools.islice(split_mix(int(lines[0]["entropy"], 16)), DRAWN))
    for line in lines:
        if "epoch" in line:
            found.add(int(line["epoch"], 16))
        data = bytes.fromhex(line.get("heard", ""))
        if data[:2] == head(HANDSHAKE, WELCOME) and len(data) > 30:
            at = 10
            while data[at] & 0x80 and at < 20:
                at += 1
            found.add(int.from_bytes(data[at + 1:at + 9], "little"))
    return sorted(found)


def random_varint(rng: random.Random) -> bytes:
    return varint(rng.choice(BORDERS) if rng.randrange(4) else rng.getrandbits(rng.randrange(1, 65)))


def random_part(rng: random.Random) -> bytes:
    kind = rng.randrange(10) if rng.randrange(8) else rng.choice([63, 64, 255])
    data = {1: lambda: rng.randbytes(4) + random_varint(rng), 2: lambda: random_varint(rng), 3: lambda: rng.choice([rng.randbytes(8), bytes(8)]),
            5: lambda: rng.choice([b"\0", b"\1", b"\2"]), 6: lambda: rng.choice([rng.randbytes(7), b"\0", b"\1"]),
            7: lambda: b"".join(random_varint(rng) if rng.randrange(2) else bytes([rng.randrange(4)]) for _ in range(4)) + rng.randbytes(
                rng.choice([0, 1, 5, 1150, 1151]))}.get(kind, lambda: rng.randbytes(rng.randrange(12)))()
    return part(kind, data)


def random_datagram(direction: int, epochs: list[int], rng: random.Random) -> bytes:
    """One that no vector has: any form, kind and number, sound or not."""
    form = rng.randrange(FORMS)
    if form == HANDSHAKE:
        value = rng.randrange(KINDS + 1)
        body = head(form, value) + (bytes([rng.randrange(8)]) if value == KINDS - 1 else rng.randbytes(rng.randrange(50)))
    else:
        body = head(form, rng.randrange(1, 20) if rng.randrange(4) else rng.randrange(1 << 14))
        body += b"".join(random_part(rng) for _ in range(rng.randrange(4))) if form == PARTS else rng.randbytes(rng.randrange(20))
    before = form == HANDSHAKE and body[0] >> 2 < KINDS - 1
    return sealed(body, 0 if before and rng.randrange(8) else rng.choice(epochs), direction)


def changed_bytes(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(max(1, len(data)))
    kind = rng.randrange(5)
    if kind == 0:
        return data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1:]
    if kind == 1:
        return data[:at]
    if kind == 2:
        return data + rng.randbytes(rng.randrange(1, 5))
    if kind == 3:
        return data[:at] + bytes([rng.choice([0, 1, 2, 127, 128, 255])]) + data[at + 1:]
    return data[:2] + b"".join(random_part(rng) for _ in range(2)) + data[2:]


def damaged_datagram(data: bytes, direction: int, epochs: list[int], rng: random.Random) -> bytes:
    """With a check that holds for its epoch, or now and then for another one, or for none."""
    if len(data) < 7:
        return data
    own = next((e for e in epochs if is_of_epoch(data, e, direction)), 0)
    body = changed_bytes(data[:-4], rng)
    if rng.randrange(20) == 0:
        return body + data[-4:]
    return sealed(body, own if rng.randrange(8) else rng.choice(epochs), direction)


def wanted_by_program(direction: int, lines: list[dict], rng: random.Random) -> dict:
    if direction == DOWN:
        return {"leave": 1}
    kind = rng.randrange(3)
    if kind == 0:
        return {"scene": lines[0]["serve"]}
    return {"closes": rng.randrange(lines[0]["clients"]), "reason": rng.randrange(7)} if kind == 1 else {"waits": 1}


def burst(direction: int, epochs: list[int], rng: random.Random) -> list[dict]:
    """As many datagrams of one kind, with rising numbers, as make an acknowledgement due, or break rules too often."""
    body = rng.choice([part(64, b""), part(1, b"\xff\xff\0\0\0"), part(2, b"\0"), part(5, b"\0"), part(9, b"")])
    first, epoch = rng.randrange(1, 200), rng.choice(epochs)
    address = {} if direction == DOWN else {"from": 1}
    return [{**address, "heard": sealed(head(PARTS, first + i) + body, epoch, direction).hex()} for i in range(rng.choice([33, 70, 110]))]


def damage(lines: list[dict], others: list[list[dict]], direction: int, rng: random.Random) -> None:
    epochs = known_epochs(lines)
    at = rng.randrange(1, len(lines) + 1)
    here = lines[min(at, len(lines) - 1)]
    kind = rng.randrange(28)
    if kind == 27:
        lines[at:at] = burst(direction, epochs, rng)
        return
    kind //= 3
    if kind == 0 and at < len(lines):
        del lines[at]
    elif kind == 1 and len(lines) > 1:
        lines.insert(at, rng.choice(lines[1:]))
    elif kind == 2 and 1 < at < len(lines):
        other = rng.randrange(1, len(lines))
        lines[at], lines[other] = lines[other], lines[at]
    elif kind == 3:
        lines.insert(at, {**({} if direction == DOWN else {"from": rng.randrange(1, 4)}), "heard": random_datagram(direction, epochs, rng).hex()})
    elif kind == 4:
        lines.insert(at, wanted_by_program(direction, lines, rng))
    elif kind == 5 and direction == UP and "from" in here:
        lines[min(at, len(lines) - 1)] = {**here, "from": rng.randrange(1, 4)}
    elif kind == 6:
        lines.insert(at, rng.choice(rng.choice(others)[1:]))
    elif "heard" in here:
        lines[min(at, len(lines) - 1)] = {**here, "heard": damaged_datagram(bytes.fromhex(here["heard"]), direction, epochs, rng).hex()}


def make_script(scripts: Scripts, seed: int, number: int) -> str:
    rng = random.Random(f"session {seed} {number}")
    direction = rng.choice([DOWN, UP])                      # of what the end hears
    others = scripts.of(direction)
    lines = list(rng.choice(others))
    for _ in range(rng.choice([1, 1, 2, 3, 5])):
        damage(lines, others, direction, rng)
    usual: Optional[int] = None if rng.randrange(4) == 0 else STEPS[direction][0]
    at, out = 5_000_000, []
    for line in lines:
        out.append(json.dumps({**line, "at": at}, separators=(",", ":")))
        at += usual or rng.choice(STEPS[direction])
    return "\n".join(out) + "\n"
