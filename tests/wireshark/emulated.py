#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The dissector over captures of simulated sessions: what it shows is what the program reports and what a second reader of the
specification (conformance/) finds in the same bytes.

  emulated.py TACTUS SCENE...        ends with 77 where tshark is missing
"""
import collections
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

import captures
from captures import ROOT, Row, rows_of

sys.path.insert(0, str(ROOT / "conformance"))
from conventions import Cursor, StreamError  # noqa: E402
from scene_decoder import SceneDecoder  # noqa: E402
from scene import read_declaration  # noqa: E402
import datagram  # noqa: E402
import session  # noqa: E402

UP, DOWN = datagram.UP, datagram.DOWN
WORDS = {"membrane": ["--deformable-visual", "0.001mm", "-p", "0.1%"]}  # shapes so exact that packets come in fragments
NETWORK = "delay=20ms,jitter=4ms,loss=4%,duplicates=3%,late=2%/15ms"


def varint(e: Cursor) -> int:
    return e.varint(datagram.CUT, datagram.SPARE)


def device_scene(scene) -> object:
    """65, section 2."""
    object_ = struct.pack("<BBB", 1, 0x3F, 6) + b"device" + struct.pack("<7i", 0, 0, 0, 1 << 30, 0, 0, 0)
    body = struct.pack("<IBBBBHB", scene.tick_rate, scene.position_exp, scene.velocity_exp, scene.rotation_exp, scene.angular_exp,
                       (scene.tick_rate + 5) // 10, 64) + varint_bytes(1) + object_
    text = b"\x89TCT" + struct.pack("<BBHI", 2, 0, 0, len(body)) + body
    return read_declaration(text + struct.pack("<I", zlib.crc32(text)))[0]


varint_bytes = datagram.varint


class Reference:
    """Decodes every packet of both directions in the order of the capture."""

    def __init__(self, welcome: Row):
        self.epoch = session.Epoch(welcome.number("tactus.epoch"), 0, 0, welcome.number("tactus.size"), welcome.number("tactus.hash"), 0)
        self.of_direction = {DOWN: self.epoch, UP: session.Epoch(0, 0, 0, 0, 0, 0)}
        self.found: list[tuple] = []

    def decode(self, epoch: session.Epoch, number: int, packet: bytes) -> bool:
        if not epoch.decoders:
            return False
        substream, payload = epoch.decoders.split(packet)
        try:
            decoded = epoch.decoders.substreams[substream].decode(number, payload)
        except StreamError as error:  # a packet of a deformable object that was sent again and is there already, or comes too late
            assert substream > 0 and number < epoch.newest and error.rule in ("R-PKT-4", "R-PKT-5"), (number, substream, error)
            self.found.append((number, substream, 0, 0))
            return False
        self.found.append((number, substream, int(decoded.key), decoded.tick))
        return True

    def take(self, row: Row) -> list[tuple]:
        """(number, substream, key, tick) of the packets that this datagram completes."""
        self.found = []
        direction = row.number("tactus.direction")
        epoch = self.of_direction[direction]
        epoch.decode = lambda _, number, packet: self.decode(epoch, number, packet)
        body = row.bytes[:-4]
        number = epoch.extend(struct.unpack("<H", body[:2])[0] >> 2)
        epoch.received.add(number)
        epoch.newest = max(epoch.newest, number)
        assert number == row.number("tactus.number"), row
        for kind, e in parts_of(body):
            if kind in (datagram.FRAGMENT, datagram.PACKET_PART) or kind == datagram.PIECE and direction == DOWN:
                epoch.take_part(0, number, kind, datagram.elements_of(kind, direction, e))
        self.epoch.begin()
        if self.epoch.scene and not self.of_direction[UP].decoders:
            self.of_direction[UP].decoders = SceneDecoder(device_scene(self.epoch.scene))
        return self.found


def parts_of(body: bytes) -> list[tuple[int, Cursor]]:
    """Type and elements, of either direction."""
    if body[0] & 3 == datagram.PACKET:
        return [(datagram.PACKET_PART, Cursor(b"\0" + body[2:], 0, len(body) - 1))]
    cursor, out = Cursor(body, 2, len(body)), []
    while cursor.left():
        kind, size = cursor.number(1, datagram.CUT), varint(cursor)
        out.append((kind, Cursor(cursor.take(size, datagram.CUT), 0, size)))
    return out


def is_new(row: Row) -> bool:
    return "R-SES-4" not in row.texts("tactus.rule")


def check_datagrams(rows: list[Row]) -> Reference:
    """Every datagram for itself, and packet by packet against the reference."""
    welcome = next(r for r in rows if r.number("tactus.kind") == datagram.WELCOME)
    epoch = int.from_bytes(welcome.bytes[2 + 8 + 1:][:8], "little")  # serial is 0: one byte
    welcome["tactus.epoch"] = str(epoch)
    reference = Reference(welcome)
    seen, shown_packets = set(), 0
    for row in rows:
        direction, form = row.number("tactus.direction"), row.number("tactus.form")
        assert row["frame.protocols"].endswith(":tactus"), row
        assert direction == (DOWN if row["source"] == captures.SERVER[0] else UP), row
        of_epoch = form != datagram.HANDSHAKE or row.number("tactus.kind") == datagram.LEAVE
        body, check = row.bytes[:-4], struct.unpack("<I", row.bytes[-4:])[0]
        assert check == datagram.check_of(body, epoch if of_epoch else 0, direction) and row.number("tactus.check.status") == 1, row
        if form == datagram.HANDSHAKE:
            continue
        again = (direction, body) in seen
        seen.add((direction, body))
        assert set(row.texts("tactus.rule")) == ({"R-SES-4"} if again else set()), row
        if again:
            continue
        parts = parts_of(body)
        if form == datagram.PARTS:
            assert row.numbers("tactus.part.type") == [kind for kind, _ in parts], row
        found = reference.take(row)
        if datagram.FRAGMENT in [kind for kind, _ in parts]:
            continue  # the packet is complete here, and shown in pieces
        assert row.numbers("tactus.packet.number") == [number for number, _, _, _ in found], (row, found)
        rigid = [f for f in found if f[1] == 0]
        assert row.numbers("tactus.packet.key") == [key for _, _, key, _ in rigid], (row, found)
        assert row.numbers("tactus.packet.tick") == [tick for _, _, _, tick in rigid], (row, found)
        shown_packets += len(found)
    assert shown_packets > 50 and len(seen) < len(rows), "nothing to look at, or no datagram came twice"
    return reference


def check_acknowledgements(rows: list[Row]) -> dict:
    """Acknowledgements point to datagrams that were seen before.
    out  the round trip as a client measures it: 70, section 7, over samples at its network interface. `least`: the session is short."""
    by_frame = {r.number("frame.number"): r for r in rows}
    smoothed = variation = least = None
    for row in filter(is_new, rows):
        if datagram.ACK not in row.numbers("tactus.part.type"):
            continue
        acknowledged = by_frame[row.number("tactus.ack.frame")]
        assert acknowledged.number("tactus.number") == row.number("tactus.ack.number"), (row, acknowledged)
        assert acknowledged.number("tactus.direction") != row.number("tactus.direction"), (row, acknowledged)
        assert acknowledged.number("frame.number") < row.number("frame.number"), (row, acknowledged)
        assert row.number("tactus.ack.number") % (1 << 16) == row.number("tactus.ack.newest")
        sample = row.number("tactus.ack.sample")
        if sample is None or row.number("tactus.direction") == UP:
            continue
        if smoothed is None:
            smoothed, variation = sample, sample // 2
        else:
            away = abs(smoothed - sample) - variation
            variation += abs(away) // 4 * (1 if away > 0 else -1)
            step = sample - smoothed
            smoothed += abs(step) // 8 * (1 if step > 0 else -1)
        least = sample if least is None else min(least, sample)
    return {"smoothed_us": smoothed, "variation_us": variation, "least_us": least}


def check_counts(rows: list[Row], client: dict) -> list[Row]:
    """What the program counted.   out  the datagrams until the client left"""
    count = collections.Counter((r.number("tactus.direction"), r.number("tactus.form") == datagram.HANDSHAKE) for r in rows)
    captured, traffic = client["captured"], client["traffic"]
    assert count[UP, True] + count[UP, False] == captured["up"]["datagrams"], (count, client)
    assert count[DOWN, True] + count[DOWN, False] == captured["down"]["datagrams"], (count, client)
    for name, direction in (("up", UP), ("down", DOWN)):
        assert captured[name]["bytes"] == sum(len(r.bytes) for r in rows if r.number("tactus.direction") == direction)
    assert count[UP, False] == traffic["sent"]["datagrams"], (count, traffic)
    leaves = [r for r in rows if r.number("tactus.kind") == datagram.LEAVE and r.number("tactus.direction") == UP]
    assert [r.number("tactus.reason") for r in leaves] == [0, 0, 0], leaves
    heard = rows[:rows.index(leaves[0])]  # who has left hears no more
    new = [r for r in heard if r.number("tactus.direction") == DOWN and r.number("tactus.form") != datagram.HANDSHAKE and is_new(r)]
    assert len(new) == traffic["heard"]["datagrams"], (len(new), traffic)
    pieces = [r for r in new if datagram.PIECE in r.numbers("tactus.part.type")]
    assert max(r.number("tactus.piece.received") for r in pieces) == client["declaration_bytes"], client
    return heard


def look(tactus: str, scene: str, work: pathlib.Path) -> str:
    trace, capture, other = (work / f"{scene}.{end}" for end in ("mcap", "pcap", "other.pcap"))
    subprocess.run([tactus, "sim", scene, "-o", trace, "--duration", "4s", "-q"], check=True)
    words = ["--link", NETWORK, "-q", "--json", *WORDS.get(scene, [])]
    done = subprocess.run([tactus, "export", "pcap", trace, "-o", capture, *words], check=True, capture_output=True, text=True)
    report = json.loads(done.stdout)
    subprocess.run([tactus, "export", "pcap", trace, "-o", other, *words], check=True, capture_output=True)
    assert capture.read_bytes() == other.read_bytes(), "the same seed, other bytes"

    rows = rows_of(capture)
    assert rows == rows_of(capture, "-2"), "a second look at the same datagrams shows something else"
    sources, targets = (captures.run_tshark(capture, "-T", "fields", "-e", name).split() for name in ("ip.src", "ip.dst"))
    for row, source in zip(rows, sources, strict=True):
        row["source"] = source
    damaged = captures.run_tshark(capture, "-o", "ip.check_checksum:TRUE", "-o", "udp.check_checksum:TRUE", "-Y",
                                  "ip.checksum.status != 1 || udp.checksum.status != 1")
    assert damaged == "", damaged
    for client in report["clients"]:
        address = client["address"].split(":")[0]
        own = [r for r, target in zip(rows, targets, strict=True) if address in (r["source"], target)]
        reference = check_datagrams(own)
        assert reference.epoch.scene is not None
        heard = check_counts(own, client)
        assert check_acknowledgements(heard) == client["round_trip"], (check_acknowledgements(heard), client)
    packets, fragments = (sum(len(r.texts(name)) for r in rows) for name in ("tactus.packet", "tactus.fragment.index"))
    assert fragments > 0 or scene not in WORDS, "no packet was cut"
    return f"{scene}: {len(report['clients'])} clients, {len(rows)} datagrams, {packets} packets, {fragments} fragments"


def main(args: list[str]) -> None:
    captures.need_tshark()
    with tempfile.TemporaryDirectory() as work:
        for scene in args[1:]:
            print(look(args[0], scene, pathlib.Path(work)))


if __name__ == "__main__":
    main(sys.argv[1:])
