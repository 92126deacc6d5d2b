# SPDX-License-Identifier: Apache-2.0
"""Captures as tshark reads them with the dissector, and capture files of datagrams that a test makes up."""
from __future__ import annotations

import functools
import pathlib
import shutil
import struct
import subprocess
import sys
from typing import Iterable, NamedTuple

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DISSECTOR = ROOT / "tools" / "wireshark" / "tactus.lua"
SKIPPED = 77
SERVER, CLIENT = ("192.0.2.1", 7447), ("198.51.100.1", 49152)  # as `tactus export pcap` has them

FIELDS = (
    "frame.number", "frame.time_relative", "frame.protocols", "udp.payload", "_ws.col.Info", "tactus.direction", "tactus.form",
    "tactus.kind", "tactus.number", "tactus.check.status", "tactus.epoch", "tactus.rule", "tactus.nonce", "tactus.size", "tactus.hash",
    "tactus.start", "tactus.reason", "tactus.part.type", "tactus.ack.newest", "tactus.ack.number", "tactus.ack.frame",
    "tactus.ack.held_us", "tactus.ack.missing_count", "tactus.ack.sample", "tactus.clock.time", "tactus.piece.received",
    "tactus.state.live", "tactus.hash.number", "tactus.packet", "tactus.packet.number", "tactus.packet.substream", "tactus.packet.key",
    "tactus.packet.baseline", "tactus.packet.tick", "tactus.fragment.index",
    "_ws.expert.message")  # the last one tells of errors of the dissector itself


class Row(dict):
    """The fields of a datagram: lists of text, in the order of the datagram."""

    def texts(self, name: str) -> list[str]:
        return self[name].split(",") if self[name] else []

    def numbers(self, name: str) -> list[int]:
        return [int(v, 0) for v in self.texts(name)]

    def number(self, name: str) -> int | None:
        values = self.numbers(name)
        return values[0] if values else None

    @property
    def bytes(self) -> bytes:
        return bytes.fromhex(self["udp.payload"])


def skip(why: str) -> None:
    print(f"skipped: {why}")
    sys.exit(SKIPPED)


def need_tshark() -> None:
    if not shutil.which("tshark"):
        skip("tshark is not installed (Debian: apt install --no-install-recommends tshark)")


@functools.cache
def other_guessers() -> tuple[str, ...]:
    """Options that switch off the dissectors which would take some damaged datagrams for their own."""
    lines = subprocess.run(["tshark", "-G", "heuristic-decodes"], capture_output=True, text=True, check=True).stdout.splitlines()
    names = [line.split("\t")[1] for line in lines if line.startswith("udp\t") and line.endswith("\tT")]
    return tuple(word for name in names if name != "dtls" for word in ("--disable-protocol", name))


def run_tshark(path, *words: str) -> str:
    """What it prints. Fails when the dissector does."""
    first = ("-o", "udp.try_heuristic_first:TRUE")  # a port that the system picks may be that of another protocol: 44818 is one
    done = subprocess.run(["tshark", "-X", f"lua_script:{DISSECTOR}", *first, *other_guessers(), "-r", str(path), *words], capture_output=True,
                          text=True, errors="replace", check=False,
                          env={"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/nonexistent", "LC_ALL": "C.UTF-8"})
    assert done.returncode == 0, done.stderr
    for text in (done.stdout, done.stderr):
        assert "Lua" not in text, [line for line in text.splitlines() if "Lua" in line][:5]
    return done.stdout


def rows_of(path, *words: str) -> list[Row]:
    printed = run_tshark(path, *words, "-T", "fields", "-E", "separator=/t", "-E", "occurrence=a", "-E", "aggregator=,",
                         *(w for name in FIELDS for w in ("-e", name)))
    return [Row(zip(FIELDS, line.split("\t"))) for line in printed.splitlines()]


def datagram_ip(source: tuple, target: tuple, payload: bytes) -> bytes:
    """An IPv4 packet without checksums."""
    udp = struct.pack(">HHHH", source[1], target[1], 8 + len(payload), 0) + payload
    address = [bytes(int(part) for part in end[0].split(".")) for end in (source, target)]
    return struct.pack(">BBHHHBBH", 0x45, 0, 20 + len(udp), 0, 0, 64, 17, 0) + address[0] + address[1] + udp


class Sent(NamedTuple):
    source: tuple
    target: tuple
    payload: bytes
    captured: int | None = None  # only so many bytes of the IP packet are in the file


def write_capture(path, datagrams: Iterable[Sent]) -> None:
    with open(path, "wb") as file:
        file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 101))
        for i, d in enumerate(datagrams):
            packet = datagram_ip(d.source, d.target, d.payload)
            kept = packet if d.captured is None else packet[:d.captured]
            file.write(struct.pack("<IIII", 1 + i // 1000, i % 1000 * 1000, len(kept), len(packet)) + kept)
