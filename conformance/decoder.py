# SPDX-License-Identifier: Apache-2.0
"""Tactus decoder that follows the specification line by line: stream, rigid packets, replica.

Written from spec/ alone and meant to be read beside it: functions carry the names of the specification, and each
part names its chapter and section; conventions.py is chapter 10, range_decoder.py chapter 30. As a program it is
a testee (README.md): python3 decoder.py [--replica none|linear] < stream.tct
"""
from __future__ import annotations

import argparse
import csv
import functools
import json
import struct
import sys
import zlib
from collections import deque
from dataclasses import dataclass, field
from math import isqrt
from pathlib import Path
from typing import Iterator, NamedTuple, Optional

from conventions import (FNV_START, ONE, Cursor, StreamError, asin30, axis_turn, clamp, conj, fnv1a, mul, renorm,
                         require, round_div, round_shift, sat32)
from range_decoder import RangeDecoder


class Limits(NamedTuple):
    """What this decoder accepts at most (R-STR-14, R-FIL-4, R-PKT-1)."""
    objects: int = 4096
    body_size: int = 1 << 20
    packet_size: int = 1 << 20


# ---- Chapter 20, section 3: header ----------------------------------------------------------------------------------
MAGIC = b"\x89TCT"
SMALLEST_OBJECT = 32


class State(NamedTuple):                                    # chapter 40, section 1
    tick: int
    position: tuple
    rotation: tuple
    velocity: tuple = (0, 0, 0)
    spin: tuple = (0, 0, 0)


class Object(NamedTuple):
    name: str
    dof: int
    initial: State


@dataclass
class Header:
    version: int
    profile: int
    tick_rate: int
    position_exp: int
    velocity_exp: int
    rotation_exp: int
    spin_exp: int
    max_extrapolation: int
    baseline_span: int
    objects: list[Object] = field(default_factory=list)

    def moving(self) -> list[int]:
        """Chapter 40, section 2: the moving objects M, as indices into `objects`."""
        return [i for i, item in enumerate(self.objects) if item.dof != 0]


STR_5 = ("truncated", "R-STR-5")
STR_5_VARINT = ("malformed", "R-STR-5")
STR_16 = ("malformed", "R-STR-16")


def read_header(data: bytes, limits: Limits = Limits()) -> tuple[Header, int]:
    """Returns the header and its size in bytes."""
    require(len(data) >= 4, "truncated", "R-STR-1")
    require(data[:4] == MAGIC, "malformed", "R-STR-1")
    require(len(data) >= 12, *STR_5)
    version, profile, flags, body_size = struct.unpack_from("<BBHI", data, 4)
    require(version == 1, "unsupported", "R-STR-2")
    require(profile <= 1, "malformed", "R-STR-3")
    require(profile == 0, "unsupported", "R-STR-3")
    require(flags == 0, "malformed", "R-STR-4")
    require(body_size <= limits.body_size, "limit_exceeded", "R-STR-14")
    end = 12 + body_size
    require(len(data) >= end + 4, *STR_5)
    require(zlib.crc32(data[:end]) == struct.unpack_from("<I", data, end)[0], "checksum", "R-STR-15")

    body = Cursor(data, 12, end)
    header = Header(version, profile, *struct.unpack("<IBBBBHB", body.take(11, STR_5)))
    object_count = body.varint(STR_5, STR_5_VARINT)
    check_numbers(header)
    require(object_count <= limits.objects, "limit_exceeded", "R-STR-14")
    require(object_count * SMALLEST_OBJECT <= body.left(), *STR_5)
    header.objects = [read_object(body) for _ in range(object_count)]
    while body.left() > 0:
        body.varint(STR_16, STR_16)
        body.take(body.varint(STR_16, STR_16), STR_16)
    names = [item.name for item in header.objects]
    require(len(set(names)) == len(names), "invalid", "R-STR-11")
    return header, end + 4


def check_numbers(h: Header) -> None:
    require(1 <= h.tick_rate <= 1000000, "invalid", "R-STR-6")
    require(8 <= h.position_exp <= 30 and h.velocity_exp <= h.position_exp <= h.velocity_exp + 12
            and 8 <= h.rotation_exp <= 28 and h.spin_exp <= 20
            and h.spin_exp <= h.rotation_exp <= h.spin_exp + 12, "invalid", "R-STR-7")
    require(h.max_extrapolation >= 1, "invalid", "R-STR-8")
    require(1 <= h.baseline_span <= 64, "invalid", "R-STR-9")


def read_object(body: Cursor) -> Object:
    kind = body.take(1, STR_5)[0]
    require(kind == 1, "unsupported", "R-STR-10")
    dof, name_size = body.take(2, STR_5)
    name_bytes = body.take(name_size, STR_5)
    pose = struct.unpack("<7i", body.take(28, STR_5))
    name = text(name_bytes)
    require(dof < 64 and (dof >> 3) in (0, 1, 2, 4, 7), "invalid", "R-STR-12")
    position, rotation = pose[:3], pose[3:]
    require(all(-ONE <= c <= ONE for c in rotation)
            and abs(sum(c * c for c in rotation) - (1 << 60)) <= 1 << 41, "invalid", "R-STR-13")
    return Object(name, dof, State(0, position, rotation))


def text(data: bytes) -> str:
    try:
        name = data.decode("utf-8")
    except UnicodeDecodeError:
        raise StreamError("invalid", "R-STR-11") from None
    require(name != "" and all(ord(c) >= 32 and ord(c) != 127 for c in name), "invalid", "R-STR-11")
    return name


# ---- Chapter 20, section 4: file ------------------------------------------------------------------------------------
PACKET, INDEX, TRAILER, FIRST_EXTENSION = 1, 2, 3, 128
LARGEST_TICK = (1 << 32) - 2
FIL_2 = ("truncated", "R-FIL-2")
FIL_6 = ("malformed", "R-FIL-6")


class File:
    """A header and the packets of the records after it; index and extension records are skipped."""

    def __init__(self, data: bytes, limits: Limits = Limits()):
        self.data, self.limits = data, limits
        self.header, self.first_record = read_header(data, limits)
        self.complete = False

    def packets(self) -> Iterator[tuple[int, bytes]]:
        """Yields the tick of each packet record and the packet; sets `complete` when the trailer was read."""
        tick = 0
        rest = Cursor(self.data, self.first_record, len(self.data))
        while rest.left() > 0:
            require(not self.complete, "malformed", "R-FIL-8")
            kind, payload = self.record(rest)
            self.complete = kind == TRAILER
            if kind == PACKET:
                content = Cursor(payload, 0, len(payload))
                tick += content.varint(FIL_6, FIL_6)
                require(tick <= LARGEST_TICK, *FIL_6)
                yield tick, payload[content.position:]

    def record(self, rest: Cursor) -> tuple[int, bytes]:
        start = rest.position
        kind = rest.take(1, FIL_2)[0]
        size = rest.varint(FIL_2, FIL_6)
        require(kind in (PACKET, INDEX, TRAILER) or kind >= FIRST_EXTENSION, "unsupported", "R-FIL-3")
        require(kind != PACKET or size <= self.limits.packet_size + 5, "limit_exceeded", "R-FIL-4")
        require(kind != TRAILER or size == 8, *FIL_6)
        require(size + 4 <= rest.left(), *FIL_2)
        payload = rest.take(size, FIL_2)
        expected = zlib.crc32(self.data[start:rest.position])
        require(struct.unpack("<I", rest.take(4, FIL_2))[0] == expected, "checksum", "R-FIL-5")
        return kind, payload


# ---- Chapter 40, section 8: start models ----------------------------------------------------------------------------
@functools.lru_cache(maxsize=None)
def start_models() -> dict[str, list]:
    """Table 2, by name without the node: {"TICK": [None, (zero, rate), ...], "RESIDUAL[0][3]": ...}."""
    here = Path(__file__).resolve().parent
    tables = here / "tables" if (here / "tables").is_dir() else here.parent / "spec" / "tables"
    trees: dict[str, list] = {}
    with open(tables / "rigid-start-models.csv", encoding="ascii", newline="") as table:
        for row in csv.DictReader(table):
            name, _, node = row["model"].rpartition("[")
            models = trees.setdefault(name, [None])
            if node != f"{len(models)}]":
                raise ValueError(f"{table.name}: {row['model']} is out of order; take the file as published")
            models.append((int(row["zero"]), int(row["rate"])))
    return trees


class Models(dict):
    """The models of one packet: each tree starts from table 2 when it is first used."""

    def __missing__(self, name: str) -> list:
        self[name] = [None] + [list(m) for m in start_models()[name][1:]]
        return self[name]


# ---- Chapter 40, sections 3 to 5: residual, prediction, reconstruction ----------------------------------------------
HAPTIC = 3
LARGEST_SPIN = 1 << 25
HALF_RADIAN = 341782638                                     # 2^32 / (4 pi), in turns


def included(dof: int, q: int) -> list[int]:
    """The axes of vector q (position, velocity, rotation, spin) that `dof` does not exclude."""
    return [a for a in range(3) if dof >> (a if q < 2 else 3 + a) & 1]


def residual(decoder: RangeDecoder, models: Models, dof: int, reason: int) -> list[list[int]]:
    r = [[0, 0, 0] for _ in range(4)]
    hint = reason
    for q in range(4):
        if q == 2 and included(dof, 2):
            hint = reason
        largest = 0
        for a in included(dof, q):
            r[q][a] = decoder.signed(models[f"RESIDUAL[{q}][{hint}]"])
            largest = max(largest, abs(r[q][a]))
            w = largest.bit_length()
            hint = 4 if w == 0 else 5 if w <= 2 else 6 if w <= 5 else 7
    return r


def predict(h: Header, state: State, t: int) -> tuple[tuple, tuple]:
    dt = min(t - state.tick, h.max_extrapolation)
    if dt == 0:
        return state.position, state.rotation
    shift = h.position_exp - h.velocity_exp
    x = tuple(sat32(p + round_div((v * dt) << shift, h.tick_rate)) for p, v in zip(state.position, state.velocity))
    speed = isqrt(sum(c * c for c in state.spin) << 10)
    if speed == 0:
        return x, state.rotation
    angle = round_div(speed * dt, h.tick_rate)
    half = (((angle * HALF_RADIAN + (1 << (h.spin_exp + 4))) % (1 << 64)) >> (h.spin_exp + 5)) % (1 << 32)
    if half == 0:
        return x, state.rotation
    u = tuple(round_div(c << 35, speed) for c in state.spin)
    return x, renorm(mul(axis_turn(u, half), state.rotation))


def reconstruct_pose(h: Header, base: State, t: int, r: list[list[int]], s: int) -> tuple[tuple, tuple]:
    """Section 5.1."""
    p, q = predict(h, base, t)
    position = tuple(sat32(p[a] + (r[0][a] << s)) for a in range(3))
    m = [c << s for c in r[2]]
    n = sum(c * c for c in m)
    length = 1 << h.rotation_exp
    require(all(abs(c) <= length for c in m) and n <= length * length, "invalid", "R-RIG-6")
    if n == 0:
        return position, q
    k = min(30, 60 - 2 * h.rotation_exp)
    d = (length * length + n) >> (30 - k)
    w = round_div((length * length - n) << k, d)
    v = [round_div((2 * length * c) << k, d) for c in m]
    return position, renorm(mul(tuple(clamp(c, -ONE, ONE) for c in (w, *v)), q))


def reconstruct_motion(h: Header, base: State, t: int, r: list[list[int]], s: int, reason: int) -> tuple[tuple, tuple]:
    """Section 5.2."""
    v, o, dt = list(base.velocity), list(base.spin), t - base.tick
    if reason == HAPTIC and dt > 0:
        for a in range(3):
            e, f = sat32(r[0][a] << s), sat32(r[2][a] << s)
            if e != 0:
                v[a] = sat32(v[a] + round_div(3 * e * h.tick_rate, (2 * dt) << (h.position_exp - h.velocity_exp)))
            if f != 0:
                o[a] = sat32(o[a] + round_div(6 * f * h.tick_rate, dt << (h.rotation_exp - h.spin_exp)))
    velocity = tuple(sat32((round_shift(v[a], s) + r[1][a]) << s) for a in range(3))
    spin = tuple(clamp((round_shift(o[a], s) + r[3][a]) << s, -LARGEST_SPIN, LARGEST_SPIN) for a in range(3))
    return velocity, spin


# ---- Chapter 40, sections 1, 2 and 6: packets -----------------------------------------------------------------------
class Scene(NamedTuple):
    tick: int
    states: list[State]


class Update(NamedTuple):
    object: int                                             # index in the header
    reason: int
    level: int


class Packet(NamedTuple):
    sequence: int
    key: int
    updates: list[Update]
    scene: Scene
    range: int                                              # final state of the range decoder
    code: int


class RigidDecoder:
    """Keeps the initial state and the scene states after the newest `baseline_span` packets."""

    def __init__(self, header: Header, limits: Limits = Limits()):
        self.header, self.limits = header, limits
        self.moving = header.moving()
        self.initial = Scene(0, [item.initial for item in header.objects])
        self.kept: deque[tuple[int, Scene]] = deque(maxlen=header.baseline_span)

    def current(self) -> Scene:
        return self.kept[-1][1] if self.kept else self.initial

    def decode(self, data: bytes, record_tick: Optional[int] = None) -> Packet:
        """Decodes one packet, from a record at `record_tick` if from a file; an error leaves the decoder unchanged."""
        require(len(data) <= self.limits.packet_size, "limit_exceeded", "R-PKT-1")
        require(len(data) >= 2, "truncated", "R-PKT-2")
        sequence = data[0] | data[1] << 8
        if self.kept:
            require(1 <= (sequence - self.kept[-1][0]) % (1 << 16) <= 32767, "state", "R-PKT-5")
        decoder, models = RangeDecoder(data[2:]), Models()
        several = len(self.moving) > 1

        key = decoder.bit(models["KEY"][1])
        named = not key and self.header.baseline_span > 1
        baseline_delta = decoder.magnitude(models["BASELINE"]) if named else 1
        tick_delta = decoder.magnitude(models["TICK"])
        count = decoder.magnitude(models["COUNT"]) if several else 1
        require(1 <= baseline_delta <= self.header.baseline_span, "invalid", "R-PKT-3")
        baseline = self.initial if key else self.held((sequence - baseline_delta) % (1 << 16))
        tick = baseline.tick + tick_delta
        require(self.current().tick <= tick <= LARGEST_TICK, "invalid", "R-RIG-1")
        require(1 <= count <= len(self.moving), "invalid", "R-RIG-3")

        scene = Scene(tick, list(baseline.states))
        updates = []
        place = -1
        for _ in range(count):
            place += 1 + (decoder.magnitude(models["GAP"]) if several else 0)
            require(place < len(self.moving), "invalid", "R-RIG-4")
            updates.append(self.update(decoder, models, scene, self.moving[place]))
        decoder.check_end()
        require(record_tick in (None, tick), "invalid", "R-FIL-7")
        self.kept.append((sequence, scene))
        return Packet(sequence, key, updates, scene, decoder.range, decoder.code)

    def held(self, sequence: int) -> Scene:
        for kept_sequence, scene in reversed(self.kept):
            if kept_sequence == sequence:
                return scene
        raise StreamError("state", "R-PKT-4")

    def update(self, decoder: RangeDecoder, models: Models, scene: Scene, index: int) -> Update:
        """Replaces the baseline's state of an object in `scene` by its new state."""
        reason = decoder.tree(models["REASON"], 2)
        level = decoder.tree(models["LEVEL"], 3)
        r = residual(decoder, models, self.header.objects[index].dof, reason)
        base, s = scene.states[index], 2 * level
        position, rotation = reconstruct_pose(self.header, base, scene.tick, r, s)
        velocity, spin = reconstruct_motion(self.header, base, scene.tick, r, s, reason)
        scene.states[index] = State(scene.tick, position, rotation, velocity, spin)
        return Update(index, reason, level)

    def state_hash(self) -> int:
        states = self.current().states
        h = FNV_START
        for i in self.moving:
            tick, *vectors = states[i]
            h = fnv1a(struct.pack("<Q13i", tick, *(c for vector in vectors for c in vector)), h)
        return h


# ---- Chapter 50: client replica -------------------------------------------------------------------------------------
SHARE = 49152                                               # P = 75 %, x 2^-16
AVERAGED_GAPS = 5                                           # M
LONGEST_GAP = (1 << 31) - 1


class ReplicaObject:
    def __init__(self, state: State):
        self.state = state
        self.begin = self.end = 0
        self.arrival: Optional[int] = None
        self.gaps: deque[int] = deque(maxlen=AVERAGED_GAPS)
        self.start = self.target = (state.position, state.rotation)    # `from` and `to` of the specification
        self.half, self.u = 0, (0, 0, 0)


class Replica:
    """What a client shows that applies packets; mode is "none" or "linear"."""

    def __init__(self, header: Header, mode: str):
        self.header, self.mode = header, mode
        self.shortest = round_div(5 * header.tick_rate, 1000)
        self.longest = round_div(100 * header.tick_rate, 1000)
        self.objects = [ReplicaObject(item.initial) for item in header.objects]
        self.moving = header.moving()

    def apply(self, packet: Packet, now: int) -> None:
        """Section 3."""
        for update in packet.updates:
            self.apply_state(self.objects[update.object], packet.scene.states[update.object], now)

    def apply_state(self, o: ReplicaObject, state: State, now: int) -> None:
        shown = self.pose(o, now)
        running = now < o.end
        if o.arrival is not None:
            o.gaps.append(min(now - o.arrival, LONGEST_GAP))
        o.arrival, o.state = now, state
        o.begin = o.end = now
        if self.mode == "none" or running or not o.gaps:
            return
        o.end = now + clamp(round_div(sum(o.gaps) * SHARE, len(o.gaps) << 16), self.shortest, self.longest)
        if o.end == now:
            return
        o.start, o.target = shown, predict(self.header, state, o.end)
        d = mul(o.target[1], conj(o.start[1]))
        if d[0] < 0:
            d = tuple(-c for c in d)
        s = isqrt(sum(c * c for c in d[1:]))
        o.half = asin30(min(s, ONE)) if s != 0 else 0
        o.u = tuple(round_div(c << 30, s) for c in d[1:]) if s != 0 else (0, 0, 0)

    def pose(self, o: ReplicaObject, now: int) -> tuple[tuple, tuple]:
        """Section 4."""
        if now >= o.end:
            return predict(self.header, o.state, now)
        part, whole = now - o.begin, o.end - o.begin
        position = tuple(sat32(a + round_div((b - a) * part, whole)) for a, b in zip(o.start[0], o.target[0]))
        h = round_div(o.half * part, whole)
        rotation = o.start[1] if h == 0 else renorm(mul(axis_turn(o.u, h), o.start[1]))
        return position, rotation

    def pose_hash(self, now: int) -> int:
        """Section 5."""
        h = FNV_START
        for i in self.moving:
            position, rotation = self.pose(self.objects[i], now)
            h = fnv1a(struct.pack("<7i", *position, *rotation), h)
        return h


# ---- Testee (README.md) ---------------------------------------------------------------------------------------------
def describe_header(h: Header) -> dict:
    return {"version": h.version, "profile": h.profile, "tick_rate": h.tick_rate,
            "grid": [h.position_exp, h.velocity_exp, h.rotation_exp, h.spin_exp],
            "max_extrapolation": h.max_extrapolation, "baseline_span": h.baseline_span,
            "objects": [{"name": item.name, "dof": item.dof} for item in h.objects]}


def lines(data: bytes, mode: Optional[str]) -> Iterator[dict]:
    """The reply to a stream file, line by line; raises StreamError where the input is rejected."""
    file = File(data)
    yield {"header": describe_header(file.header)}
    decoder = RigidDecoder(file.header)
    replica = Replica(file.header, mode) if mode else None
    number = last_tick = shown_ticks = 0
    shown = FNV_START
    for tick, data_of_packet in file.packets():
        packet = decoder.decode(data_of_packet, tick)
        line = {"packet": number, "sequence": packet.sequence, "key": bool(packet.key), "tick": tick,
                "updates": packet.updates, "range": f"{packet.range:08x}", "code": f"{packet.code:08x}",
                "state": f"{decoder.state_hash():016x}"}
        if replica:
            shown = hash_of_ticks(replica, range(shown_ticks, tick), shown)
            shown_ticks = tick
            replica.apply(packet, tick)
            line["shown"] = f"{replica.pose_hash(tick):016x}"
        yield line
        number += 1
        last_tick = tick
    end = {"complete": file.complete, "packets": number, "state": f"{decoder.state_hash():016x}"}
    if replica:
        end["shown"] = f"{hash_of_ticks(replica, range(shown_ticks, last_tick + 1), shown):016x}"
    yield {"end": end}


def hash_of_ticks(replica: Replica, ticks: range, h: int) -> int:
    for tick in ticks:
        h = fnv1a(struct.pack("<Q", replica.pose_hash(tick)), h)
    return h


def main() -> int:
    parser = argparse.ArgumentParser(description="Decode a Tactus stream file from standard input to JSON lines.")
    parser.add_argument("--replica", choices=("none", "linear"), help="also show what a client shows")
    mode = parser.parse_args().replica
    try:
        for line in lines(sys.stdin.buffer.read(), mode):
            print(json.dumps(line, separators=(",", ":")))
    except StreamError as error:
        print(json.dumps({"error": {"errc": error.errc, "rule": error.rule}}, separators=(",", ":")))
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
