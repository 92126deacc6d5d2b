#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The dissector over datagrams that are damaged, made up, cut or foreign: it never fails, names a bad check as one, and says of resealed
ones which rule of the syntax they break, as a second reader of the specification does.

  hostile.py TACTUS [COUNT]        COUNT mutants of each kind [6000]; ends with 77 where tshark is missing
"""
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

import captures
from captures import CLIENT, ROOT, SERVER, Row, Sent, rows_of, write_capture

sys.path.insert(0, str(ROOT / "conformance"))
from conventions import Cursor, StreamError, require  # noqa: E402
import session  # noqa: E402
from datagram import END_OF_TICKS, FARTHEST_OFFSET, LARGEST_DATAGRAM, check_of  # noqa: E402
from session import CUT, SPARE  # noqa: E402

UP, DOWN = session.UP, session.DOWN
SYNTAX = ("R-SES-1", "R-SES-2", "R-SES-3", "R-SES-5", "R-SES-9")
ORDER = ("malformed", "R-SES-5")
ONLY = {session.CLOCK: DOWN}
REASONS = 7


# ---- 70, sections 2 to 5: syntax of one datagram of either direction -------------------------------------------------
def read_part(kind: int, direction: int, e: Cursor) -> None:
    if kind == session.STATE and e.left() == 1:
        require(e.number(1, CUT) < 2 or direction == DOWN, *SPARE)
        return
    if kind == session.REPORT and direction == UP or kind == session.BASELINES and direction == DOWN:
        if kind == session.REPORT:
            e.varint(CUT, SPARE)
        require(e.number(1, CUT) < 2 and e.left() == 0, *SPARE)
        return
    if kind == session.CLOCK:
        require(e.varint(CUT, SPARE) < session.END_OF_TIME and e.left() == 0, *SPARE)
        return
    if kind == session.TICK_MAPPING and direction == DOWN:
        begin, offset = e.varint(CUT, SPARE), e.varint(CUT, SPARE)
        require(begin < END_OF_TICKS and offset <= 2 * FARTHEST_OFFSET and e.left() == 0, *SPARE)
        return
    sizes = {session.ACK: (2, 2), session.BUTTONS: (4, 4), session.STATE: (1,), session.HASH: (1, 2, 4)}
    varints = {session.ACK: 1, session.CLOCK: 1, session.PIECE: 1, session.FRAGMENT: 4, session.PACKET_PART: 1}
    for size in sizes.get(kind, ()):
        e.number(size, CUT)
    for _ in range(varints.get(kind, 0)):
        e.varint(CUT, SPARE)
    if kind in (session.PIECE, session.FRAGMENT, session.PACKET_PART):
        e.take(e.left(), CUT)
    require(e.left() == 0, *SPARE)


def read_numbered(body: bytes, direction: int) -> None:
    if body[0] & 3 == session.PACKET:
        return
    cursor, last, kinds, fragment, back = Cursor(body, 2, len(body)), 0, [], False, None
    while cursor.left():
        kind, size = cursor.number(1, CUT), cursor.varint(CUT, SPARE)
        data = cursor.take(size, CUT)
        require(0 < kind and last <= kind and not 8 < kind < 64 and ONLY.get(kind, direction) == direction, *ORDER)
        require(not (fragment and kind in (session.FRAGMENT, session.PACKET_PART)), *ORDER)
        last, fragment = kind, fragment or kind == session.FRAGMENT
        if kind < 64:
            read_part(kind, direction, Cursor(data, 0, size))
        kinds.append(kind)
        back = Cursor(data, 0, size).varint(CUT, SPARE) if kind == session.PACKET_PART else None
    require(kinds not in ([], [session.PACKET_PART]) or (kinds != [] and back != 0), *ORDER)


def read_handshake(body: bytes, kind: int, direction: int) -> None:
    require(kind == session.LEAVE or (kind <= session.REFUSAL and (kind == session.JOIN) == (direction == UP)), "invalid", "R-SES-2")
    e = Cursor(body, 2, len(body))
    if kind == session.JOIN:
        magic, version, role = e.take(4, CUT), e.number(1, CUT), e.number(1, CUT)
        e.number(8, CUT)
        require(magic == b"TCTS" and (version != 1 or role < 2), "unsupported", "R-SES-9")
        if version != 1 and len(body) >= 76:
            return
        e.number(8, CUT), e.number(1, CUT)
        e.varint(CUT, SPARE), e.varint(CUT, SPARE)
        require(len(body) >= 76, *CUT)
        require(not any(e.take(e.left(), CUT)), *SPARE)
    elif kind == session.WELCOME:
        for size in (8, 0, 8, 2, 0, 8):
            e.number(size, CUT) if size else e.varint(CUT, SPARE)
        require(e.varint(CUT, SPARE) < session.END_OF_TIME, *SPARE)
        e.number(8, CUT)
    else:
        if kind == session.REFUSAL:
            e.number(8, CUT)
        require(e.number(1, CUT) < REASONS, *SPARE)
    require(e.left() == 0, *SPARE)


def rule_broken(datagram: bytes, direction: int) -> str:
    """Of the syntax; empty: none."""
    try:
        require(6 <= len(datagram) <= LARGEST_DATAGRAM, "checksum", "R-SES-1")
        head = struct.unpack("<H", datagram[:2])[0]
        require(head & 3 != 3, "invalid", "R-SES-2")
        if head & 3 == session.HANDSHAKE:
            read_handshake(datagram[:-4], head >> 2, direction)
        else:
            read_numbered(datagram[:-4], direction)
    except StreamError as error:
        return error.rule
    return ""


# ---- Mutants ---------------------------------------------------------------------------------------------------------
def mutate(body: bytes, rng: random.Random) -> bytes:
    data = bytearray(body)
    for _ in range(rng.choice((0, 1, 1, 1, 2, 5))):
        at = rng.randrange(len(data)) if data else 0
        what = rng.randrange(8)
        if what == 0 and data:
            data[at] ^= 1 << rng.randrange(8)
        elif what == 1 and data:
            data[at] = rng.choice((0, 1, 2, 7, 8, 9, 63, 64, 127, 128, 255))
        elif what == 2:
            del data[at:]
        elif what == 3:
            del data[at:at + rng.randrange(1, 4)]
        elif what == 4:
            data[at:at] = rng.choice((b"\xff" * 9 + b"\x01", b"\xff" * 10, b"\x80\x00", b"\x00", rng.randbytes(rng.randrange(1, 30))))
        elif what == 5:
            data += rng.randbytes(rng.randrange(1, 1200))
        elif what == 6 and len(data) > 4:
            begin = rng.randrange(2, len(data))
            data[begin:begin] = data[begin:begin + rng.randrange(1, 40)]
        elif what == 7:
            data = bytearray(rng.randbytes(rng.randrange(0, 60)))
    return bytes(data)


def sealed(body: bytes, epoch: int, direction: int) -> bytes:
    without = len(body) >= 2 and struct.unpack("<H", body[:2])[0] in (4 * session.JOIN, 4 * session.WELCOME, 4 * session.REFUSAL)
    return session.sealed(body, 0 if without else epoch, direction)


def ends_of(direction: int, client: tuple = CLIENT) -> tuple:
    return (client, SERVER) if direction == UP else (SERVER, client)


def bases(rows: list[Row], rng: random.Random) -> list[list[tuple[int, bytes]]]:
    """Direction and bytes before the check of datagrams, those of a kind together: what the session sent, and what it had no reason to."""
    kinds: dict[tuple, list] = {}
    for row in rows:
        kind = (row.number("tactus.direction"), row.number("tactus.form"), row["tactus.kind"], row["tactus.part.type"])
        kinds.setdefault(kind, []).append((row.number("tactus.direction"), row.bytes[:-4]))
    part, parts = session.part, session.head(session.PARTS, 700)
    ack = part(session.ACK, b"\x05\x00\x00\x00\x03")
    join = next(row.bytes[:-4] for row in rows if row.number("tactus.kind") == session.JOIN)
    kinds["join"] = [(UP, join[:at] + byte + join[at + 1:]) for at, byte in ((2, b"t"), (6, b"\2"), (7, b"\2"))]  # magic, version, role
    kinds["refusal"] = [(DOWN, session.head(session.HANDSHAKE, session.REFUSAL) + rng.randbytes(8) + b"\x02")]
    kinds["received"] = [(UP, parts + ack + part(session.BUTTONS, bytes(8)) + part(session.STATE, b"\1") + part(session.HASH, bytes(7)))]
    mappings = part(session.TICK_MAPPING, b"\x07\x03") + part(session.TICK_MAPPING, b"\xff\xff\xff\xff\x0f\xff\xff\xff\xff\x3f")
    kinds["tick mappings"] = [(DOWN, parts + ack + part(session.CLOCK, b"\x05") + mappings + part(session.PACKET_PART, b"\1abc"))]
    kinds["fragment"] = [(d, parts + ack + part(session.FRAGMENT, b"\x01\x00\x02\x03" + bytes(n))) for d in (UP, DOWN) for n in (5, 1150)]
    kinds["skipped"] = [(DOWN, parts + part(session.PACKET_PART, b"\0abc") + part(64, b"later") + part(255, b""))]
    return list(kinds.values())


def is_handshake(datagram: bytes) -> bool:
    return len(datagram) < 2 or datagram[0] & 3 == session.HANDSHAKE


def comes_wrong(datagram: bytes, direction: int) -> bool:
    """A join that comes down, a welcome or refusal that goes up."""
    kind = struct.unpack("<H", datagram[:2])[0] >> 2 if len(datagram) >= 2 else session.LEAVE
    return kind < session.LEAVE and (kind == session.JOIN) != (direction == UP)


def shown_rules(row: Row) -> set:
    return set(row.texts("tactus.rule"))


def check_syntax(path: pathlib.Path, rows: list[Row], count: int, rng: random.Random) -> str:
    """Resealed mutants: their checks hold, so that all depends on the syntax."""
    start = [Sent(*ends_of(r.number("tactus.direction")), r.bytes) for r in rows[:8]]
    epoch = rows[1].number("tactus.own_epoch")
    mutants, groups = [], bases(rows, rng)
    while len(mutants) < count:
        direction, base = rng.choice(rng.choice(groups))
        direction ^= rng.randrange(10) == 0
        mutant = sealed(mutate(base, rng), epoch, direction)
        if len(mutant) < 1400:
            mutants.append((direction, mutant))
    # Welcomes would change the conversation: handshakes in their own direction get conversations of their own, where they say who is who.
    sent = list(start)
    for i, (direction, mutant) in enumerate(mutants):
        own = is_handshake(mutant) and not comes_wrong(mutant, direction)
        sent.append(Sent(*ends_of(direction, (f"198.51.{100 + i // 40000}.7", 20000 + i % 40000) if own else CLIENT), mutant))
    write_capture(path, sent)
    broken = 0
    for (direction, mutant), row in zip(mutants, rows_of(path)[len(start):], strict=True):
        wanted = rule_broken(mutant, direction)
        found = shown_rules(row) & set(SYNTAX)
        assert (wanted in found) if wanted else not found, (mutant.hex(), direction, wanted, row)
        broken += wanted != ""
        if not is_handshake(mutant) and 6 <= len(mutant) <= LARGEST_DATAGRAM:
            assert row.number("tactus.check.status") == 1, (mutant.hex(), row)
    assert count // 10 < broken < count, (broken, count)
    return f"{count} resealed mutants, {broken} break the syntax"


def check_damage(path: pathlib.Path, rows: list[Row], count: int, rng: random.Random) -> str:
    """Damaged on the way: the check does not hold. Some are cut by the capture, too."""
    start = [Sent(*ends_of(r.number("tactus.direction")), r.bytes) for r in rows[:8]]
    sent, bad = list(start), 0
    while len(sent) < count:
        base = rng.choice(rows)
        mutant = mutate(base.bytes, rng)
        captured = rng.randrange(28, 60) if rng.randrange(8) == 0 else None
        sent.append(Sent(*ends_of(base.number("tactus.direction")), mutant, captured))
    write_capture(path, sent)
    epoch, known = rows[1].number("tactus.own_epoch"), {r.bytes for r in rows}
    for mutant, row in zip(sent[len(start):], rows_of(path, "-2")[len(start):], strict=True):
        cut = mutant.captured is not None and mutant.captured < 28 + len(mutant.payload)
        if cut or not 6 <= len(mutant.payload) <= LARGEST_DATAGRAM or mutant.payload in known:
            continue
        body, check = mutant.payload[:-4], struct.unpack("<I", mutant.payload[-4:])[0]
        holds = any(check == check_of(body, e, d) for e in (0, epoch) for d in (UP, DOWN))
        assert holds or (row.number("tactus.check.status") == 0 and "R-SES-1" in shown_rules(row)), row
        bad += not holds
    assert bad > count // 2, bad
    return f"{bad} damaged datagrams have a bad check"


def numbered(number: int, *parts: bytes) -> bytes:
    return session.head(session.PARTS, number) + b"".join(parts)


def check_values(path: pathlib.Path, rng: random.Random) -> str:
    """Datagrams of good syntax whose elements are wrong for their session, and others that come close."""
    text = rng.randbytes(1500)
    pieces = [session.part(session.PIECE, bytes([i]) + text[1024 * i:1024 * (i + 1)]) for i in range(2)]
    fragment = lambda back, index, count, size: numbered(9, session.part(  # noqa: E731
        session.FRAGMENT, session.varint(back) + b"\0" + session.varint(index) + session.varint(count) + bytes(size)))
    ack = lambda newest: numbered(5, session.part(session.ACK, struct.pack("<HHB", newest % 65536, 0, 0)))  # noqa: E731
    state = numbered(1, session.part(session.STATE, b"\1"))
    cases = [  # what was sent before; what is looked at; the rule that it breaks
        ([], (DOWN, numbered(1, pieces[0])), ""), ([], (DOWN, numbered(1, pieces[1])), ""),
        ([], (DOWN, numbered(1, session.part(session.PIECE, b"\2" + bytes(10)))), "R-SES-8"),
        ([], (DOWN, numbered(1, pieces[0][:-1].replace(b"\x81\x08", b"\x80\x08", 1))), "R-SES-8"),
        ([(DOWN, numbered(1, pieces[1]))], (DOWN, numbered(2, pieces[0])), ""),
        ([(DOWN, numbered(1, pieces[1]))], (DOWN, numbered(2, pieces[0][:-1] + b"?")), "R-SES-10"),
        ([], (DOWN, fragment(8, 0, 2, 1150)), ""), ([], (UP, fragment(8, 1, 2, 7)), ""), ([], (UP, fragment(8, 1023, 1024, 1150)), ""),
        ([], (DOWN, fragment(9, 0, 2, 1150)), "R-SES-7"), ([], (DOWN, fragment(8, 0, 2, 1149)), "R-SES-7"),
        ([], (DOWN, fragment(8, 2, 2, 5)), "R-SES-7"), ([], (DOWN, fragment(8, 0, 1, 5)), "R-SES-7"),
        ([], (DOWN, fragment(8, 1, 2, 0)), "R-SES-7"), ([], (DOWN, fragment(8, 1024, 1025, 5)), "R-SES-7"),
        ([(UP, state)], (DOWN, ack(1)), ""), ([(UP, state)], (DOWN, ack(2)), "R-SES-6"), ([(UP, state)], (DOWN, ack(0)), "R-SES-6"),
        ([], (DOWN, ack(1)), "R-SES-6"), ([(DOWN, ack(1))], (DOWN, ack(1)), "R-SES-4"), ([(UP, state)], (UP, state), "R-SES-4"),
        ([], (UP, b"\x16\xfe\xfd" + bytes(20)), "R-SES-4"),  # looks like a record of DTLS, but this session is not sealed
        ([(UP, numbered(3000, pieces[0][:0], session.part(session.STATE, b"\1")))], (UP, state), "R-SES-4"),
    ]
    sent, wanted = [], {}
    for i, (before, (direction, body), rule) in enumerate(cases):
        client, epoch = ("198.51.100.3", 30000 + i), rng.randrange(1, 1 << 64)
        welcome = session.head(session.HANDSHAKE, session.WELCOME) + bytes(8) + b"\0" + struct.pack("<QH", epoch, 0)
        welcome += session.varint(len(text)) + struct.pack("<Q", session.fnv1a(text)) + b"\0" + bytes(8)
        sent += [Sent(*ends_of(d, client), sealed(b, epoch, d)) for d, b in [(DOWN, welcome), *before, (direction, body)]]
        wanted[len(sent)] = rule
    write_capture(path, sent)
    for number, row in enumerate(rows_of(path), start=1):
        if number in wanted:
            assert shown_rules(row) == ({wanted[number]} if wanted[number] else set()), (wanted[number], row)
    return f"{len(cases)} sessions with wrong and right values"


def check_sealed() -> str:
    """A join and a welcome in records of DTLS 1.2, with their secrets in the file: `openssl s_client` and `s_server` with the cipher
    PSK-AES128-GCM-SHA256 between files of one datagram each, caught by dumpcap; `editcap -F pcap`, then `--inject-secrets`."""
    rows = rows_of(pathlib.Path(__file__).parent / "sealed.pcapng")
    inside = [r for r in rows if r["frame.protocols"].endswith("dtls:tactus")]
    assert [(r.number("tactus.kind"), r.number("tactus.direction"), r.number("tactus.check.status")) for r in inside] == [
        (session.JOIN, UP, 1), (session.WELCOME, DOWN, 1)], inside
    assert all(r in inside or r["tactus.form"] == "" for r in rows) and len(rows) > 8, "a record of DTLS was taken for a session's datagram"
    return f"{len(rows)} records of a sealed session"


def check_middle(path: pathlib.Path, rows: list[Row]) -> str:
    """A capture that begins after the join: everything is recognised by port, and no check is shown as good or bad."""
    late = [r for r in rows if r.number("tactus.form") != session.HANDSHAKE][10:]
    write_capture(path, [Sent(*ends_of(r.number("tactus.direction")), r.bytes) for r in late])
    for before, row in zip(late, rows_of(path), strict=True):
        assert row.number("tactus.check.status") == 2 and row["tactus.number"] == "" and not shown_rules(row), row
        for name in ("tactus.direction", "tactus.part.type", "tactus.ack.newest", "tactus.packet"):
            assert row[name] == before[name], (name, row, before)
    write_capture(path, [Sent(s, t, r.bytes) for r in late for s, t in [ends_of(r.number("tactus.direction"), ("198.51.100.9", 9))]])
    other = rows_of(path, "-o", "tactus.port:9999")
    assert all("tactus" not in row["frame.protocols"] for row in other), "foreign datagrams were taken for a session's"
    return f"{len(late)} datagrams of a session that began before"


def main(args: list[str]) -> None:
    captures.need_tshark()
    count = int(args[1]) if len(args) > 1 else 6000
    rng = random.Random(1)
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        trace, capture = work / "t.mcap", work / "t.pcap"
        subprocess.run([args[0], "sim", "rotate-push-lift", "-o", trace, "--duration", "3s", "-q"], check=True)
        subprocess.run([args[0], "export", "pcap", trace, "-o", capture, "--link", "delay=10ms,jitter=2ms,loss=1%", "-q"], check=True)
        rows = rows_of(capture)
        rows[1]["tactus.own_epoch"] = str(int.from_bytes(rows[1].bytes[11:19], "little"))
        kinds = {kind for row in rows for kind in row.numbers("tactus.part.type")}
        assert len(rows) > 100 and {session.ACK, session.PIECE, session.STATE} <= kinds, kinds
        print(check_syntax(work / "syntax.pcap", rows, count, rng))
        print(check_damage(work / "damage.pcap", rows, count, rng))
        print(check_values(work / "values.pcap", rng))
        print(check_sealed())
        print(check_middle(work / "middle.pcap", rows))


if __name__ == "__main__":
    main(sys.argv[1:])
