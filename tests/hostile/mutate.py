# SPDX-License-Identifier: Apache-2.0
"""Seeded damage to files, and check values that are repaired behind it, so that the damage reaches the code behind the check."""
import struct
import subprocess
import zlib

NUMBERS = [b"nan", b"-inf", b"1e400", b"-1e400", b"4.9e-324", b"-0", b"0x1p3", b"9" * 400, b"1" + b"0" * 30, b"-1", b"", b"1e", b"\xd9\xa1"]
TEXTS = [b"\r\n", b"\xef\xbb\xbf", b"\x00", "ab".encode("utf-16"), b"\xc2\x9b31m", "\u202e".encode(), b"\x1b]0;title\x07", b"\xff\xfe",
         b"\"", b"'", b"`touch PWNED`", b"$(touch PWNED)", b"%s%n", b"../../x", b"\\u001b[2J", b"#", b"=", b"[", b"{", b","]


def flip(data, rng):
    out = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 3, 16))):
        if out:
            out[rng.randrange(len(out))] ^= 1 << rng.randrange(8)
    return bytes(out)


def cut(data, rng):
    return data[:rng.randrange(len(data) + 1)]


def block(data, rng):
    """A block left out, doubled, moved or set to one value."""
    a = rng.randrange(len(data) + 1)
    b = min(len(data), a + rng.choice((1, 2, 8, 64, 1000)))
    at = rng.randrange(len(data) + 1)
    return rng.choice((data[:a] + data[b:], data[:b] + data[a:], data[:at] + data[a:b] + data[at:],
                       data[:a] + rng.choice((b"\x00", b"\xff")) * (b - a) + data[b:]))


def border(data, rng):
    """An integer at a border of powers of two, in one of all widths."""
    width = rng.choice((1, 2, 4, 8))
    if len(data) < width:
        return data
    value = (1 << rng.randrange(8 * width + 1)) + rng.choice((-1, 0, 1))
    at = rng.randrange(len(data) - width + 1)
    return data[:at] + (value % (1 << 8 * width)).to_bytes(width, rng.choice(("little", "little", "big"))) + data[at + width:]


def floating(data, rng):
    form, width = rng.choice((("<f", 4), ("<d", 8)))
    value = rng.choice((float("nan"), float("inf"), -float("inf"), 5e-324 if width == 8 else 1e-45, 1e38, -0.0))
    at = rng.randrange(max(1, len(data) - width + 1))
    return data[:at] + struct.pack(form, value) + data[at + width:]


def words(data, rng):
    """A word of a text file becomes another number."""
    parts = data.split(b" ") if b" " in data else data.split(b",")
    parts[rng.randrange(len(parts))] = rng.choice(NUMBERS)
    return (b" " if b" " in data else b",").join(parts)


def insert(data, rng):
    at = rng.randrange(len(data) + 1)
    return data[:at] + rng.choice(TEXTS) * rng.choice((1, 1, 1, 70)) + data[at:]


def lines(data, rng):
    """Lines out of order, ended otherwise, or far too long."""
    rows = data.split(b"\n")
    a, b = rng.randrange(len(rows)), rng.randrange(len(rows))
    how = rng.randrange(4)
    if how == 0:
        rows[a], rows[b] = rows[b], rows[a]
    elif how == 1:
        rows[a] = rows[a] + b"x" * rng.choice((300, 70000, 1 << 20))
    elif how == 2:
        return b"\r\n".join(rows)
    else:
        rows[a] = rng.choice((b"[" * 2000, b"{" * 2000, b"[" + b"a." * 40000 + b"a]", b"a" + b".a" * 40000 + b" = 1", b"((" * 999))
    return b"\n".join(rows)


BINARY = (flip, cut, block, border, floating)
TEXT = (flip, cut, block, words, words, insert, insert, lines)


def mutated(data, rng, how):
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        data = rng.choice(how)(data, rng)
    return data


# ---- Stream files: spec/20-scene.md ----------------------------------------------------------------------------------

def varint(data, at):
    value = shift = 0
    while at < len(data) and shift < 70:
        value |= (data[at] & 127) << shift
        at, shift = at + 1, shift + 7
        if data[at - 1] < 128:
            break
    return value, at


def to_varint(value):
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes(out) + bytes([value])


def stream_pieces(data):
    """Header and records, each without its check value; what follows a broken length is one piece."""
    size = struct.unpack_from("<I", data, 8)[0]
    pieces, at = [data[:12 + size]], 16 + size
    while at < len(data):
        length, payload = varint(data, at + 1)
        end = payload + length
        pieces.append(data[at:end])
        at = end + 4
    return pieces


def mutated_stream(data, rng):
    """Damage within one header or payload, with lengths and check values repaired."""
    pieces = stream_pieces(data)
    i = rng.randrange(len(pieces))
    if i == 0:
        body = mutated(pieces[0][12:], rng, BINARY)
        pieces[0] = pieces[0][:8] + struct.pack("<I", len(body)) + body
    else:
        _, start = varint(pieces[i], 1)
        payload = mutated(pieces[i][start:], rng, BINARY)
        pieces[i] = pieces[i][:1] + to_varint(len(payload)) + payload
    if rng.randrange(8) == 0 and len(pieces) > 2:  # a record out of place, or twice
        pieces.insert(rng.randrange(1, len(pieces)), pieces[rng.randrange(1, len(pieces))])
    return b"".join(piece + struct.pack("<I", zlib.crc32(piece)) for piece in pieces)


# ---- MCAP -------------------------------------------------------------------------------------------------------------

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, ATTACHMENT, METADATA, DATA_END = 1, 2, 3, 4, 5, 6, 9, 12, 15


def record(opcode, content):
    return bytes([opcode]) + struct.pack("<Q", len(content)) + content


def text(value):
    value = value.encode() if isinstance(value, str) else value
    return struct.pack("<I", len(value)) + value


def chunk(records, size=None, compression=""):
    """in  size  what it claims to unpack to"""
    size = len(records) if size is None else size
    return record(CHUNK, struct.pack("<QQQI", 0, 0, size, 0) + text(compression) + struct.pack("<Q", len(records)) + records)


def mcap(data_records):
    """A whole file without summary; check values of 0 say "not computed"."""
    return (MAGIC + record(HEADER, text("") + text("")) + b"".join(data_records) + record(DATA_END, bytes(4)) +
            record(FOOTER, bytes(20)) + MAGIC)


def records_of(data):
    at = 0
    while at + 9 <= len(data):
        size = struct.unpack_from("<Q", data, at + 1)[0]
        yield data[at], data[at + 9:at + 9 + size]
        at += 9 + size


def zstd(arguments, data):
    return subprocess.run(["zstd", "-q", "-c", *arguments], input=data, stdout=subprocess.PIPE, check=True).stdout


def unpacked_mcap(data):
    """The data section as records, chunks as lists of records."""
    out = []
    for opcode, content in records_of(data[8:]):
        if opcode == DATA_END:
            break
        if opcode in (SCHEMA, CHANNEL, METADATA, ATTACHMENT):
            out.append((opcode, content))
        if opcode == CHUNK:
            start = 32 + struct.unpack_from("<I", content, 28)[0]
            stored = content[start + 8:]
            out.append((CHUNK, list(records_of(zstd(["-d"], stored) if content[32:start] == b"zstd" else stored))))
    return out


def mutated_mcap(parts, rng):
    """Damage within one record, with lengths and check values repaired, some chunks compressed anew."""
    parts = [(op, list(content) if op == CHUNK else content) for op, content in parts]
    target = rng.choice([p[1] for p in parts if p[0] == CHUNK and p[1]] + [parts])
    i = rng.randrange(len(target))
    opcode, content = target[i]
    if opcode != CHUNK:
        target[i] = (rng.choice((opcode,) * 9 + (rng.randrange(256),)), mutated(content, rng, BINARY + (insert,)))
    if rng.randrange(6) == 0:
        target.insert(rng.randrange(len(target) + 1), target[rng.randrange(len(target))])
    out = []
    for opcode, content in parts:
        if isinstance(content, bytes):  # also of an opcode that became that of a chunk
            out.append(record(opcode, content[:-4] + bytes(4) if opcode == ATTACHMENT else content))
            continue
        records = b"".join(record(op, c) for op, c in content if isinstance(c, bytes))
        packed = rng.randrange(4) == 0
        out.append(chunk(zstd(["-1"], records) if packed else records, len(records) + rng.choice((0,) * 30 + (1, -1, 1 << 32)),
                         "zstd" if packed else ""))
    return mcap(out)
