# SPDX-License-Identifier: Apache-2.0
"""Small inputs that ask for much: memory, time, disk, depth, a shell, a terminal. Each is made when it is needed.

A bomb is a function of a folder that yields commands (lists of words behind `tactus`) and the exit statuses that are right.
"""
import lzma
import os
import pathlib
import struct
import sys
import zlib

from mutate import ATTACHMENT, CHANNEL, MESSAGE, METADATA, SCHEMA, chunk, mcap, record, text, to_varint, unpacked_mcap, zstd

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "conformance"))
from range_encoder import RangeEncoder  # noqa: E402  (the second decoder's)
from start_models import Models  # noqa: E402

INPUTS = pathlib.Path(__file__).parent / "inputs"
REFUSED = {1}
ENDS = {0, 1}  # legal, or refused: but soon


def rle_zstd(byte, blocks):
    """One zstd frame of so many blocks of 128 KiB, four bytes each (RFC 8878)."""
    size = blocks << 17
    body = b"".join(struct.pack("<I", (1 << 17) << 3 | 2 | (i == blocks - 1))[:3] + byte for i in range(blocks))
    return b"\x28\xb5\x2f\xfd\xc0\x38" + struct.pack("<Q", size) + body, size


def one_large_chunk(folder):
    packed, size = rle_zstd(b"\xff", 2040)
    (folder / "b.mcap").write_bytes(mcap([chunk(packed, size, "zstd")]))
    yield ["info", "b.mcap"], REFUSED


def many_chunks(folder):
    packed, size = rle_zstd(b"\xff", 2040)
    (folder / "b.mcap").write_bytes(mcap([chunk(packed, size, "zstd")] * 200))
    yield ["info", "b.mcap"], REFUSED


def empty_records(folder):
    """Nine bytes each, of an opcode that nobody knows."""
    packed = zstd(["-19", "--long=27"], (b"\xf0" + bytes(8)) * (128 << 17))
    (folder / "b.mcap").write_bytes(mcap([chunk(packed, 9 * 128 << 17, "zstd")] * 8))
    yield ["info", "b.mcap"], REFUSED


def lines_of_a_table(folder):
    packed, _ = rle_zstd(b"\n", 4000)
    (folder / "b.csv.zst").write_bytes(packed * 60)
    yield ["import", "csv", "b.csv.zst", "-o", "o.mcap", "--map", "position=a,b,b"], REFUSED


def columns_of_a_table(folder):
    names = ["tick", "time_s"] + [f"/objects/{i}/dof" for i in range(45000)]
    (folder / "b.csv").write_text(",".join(names) + "\n")
    yield ["import", "csv", "b.csv", "-o", "o.mcap", "--preset", "tactus"], REFUSED
    (folder / "c.csv").write_text("," * (1 << 20) + "\n" + "," * (1 << 20) + "\n")
    yield ["import", "csv", "c.csv", "-o", "o.mcap", "--map", "position=a,b,c"], REFUSED


def one_topic_of_many(folder):
    """Thousands of objects, of which one moves."""
    schema = record(SCHEMA, struct.pack("<H", 1) + text("geometry_msgs/msg/PoseStamped") + text("ros2msg") + text(""))
    head = b"".join(record(CHANNEL, struct.pack("<HH", i, 1) + text(f"/o{i}/pose") + text("cdr") + text("")) for i in range(4000))
    cdr = b"\0\1\0\0" + bytes(8) + text("world\0") + bytes(-(8 + 4 + 6) % 8) + struct.pack("<7d", 0, 0, 0, 0, 0, 0, 1)

    def message(channel, time):
        return record(MESSAGE, struct.pack("<HIQQ", channel, 0, time, time) + cdr)

    body = b"".join(message(i, i) for i in range(4000)) + b"".join(message(0, 10 ** 6 * i) for i in range(1, 20000))
    packed = zstd(["-3"], body)
    (folder / "b.mcap").write_bytes(mcap([schema + head, chunk(packed, len(body), "zstd")]))
    yield ["info", "b.mcap"], REFUSED
    yield ["export", "csv", "b.mcap", "-o", "o.csv"], REFUSED


def many_declarations(folder):
    """All channels that a recording can have, each another one; then, in the second file of a bag, others under the same numbers."""
    def recording(prefix):
        schemas = b"".join(record(SCHEMA, struct.pack("<H", i) + text(f"{prefix}{i}") + text("ros2msg") + text("")) for i in range(1, 32000))
        channels = b"".join(record(CHANNEL, struct.pack("<HH", i, 1) + text(f"/{prefix}{i}") + text("cdr") + text("")) for i in range(32000))
        return mcap([schemas + channels])

    (folder / "many").mkdir()
    (folder / "many" / "a_0.mcap").write_bytes(recording("a"))
    (folder / "many" / "a_1.mcap").write_bytes(recording("b"))
    yield ["info", "many/a_0.mcap"], REFUSED
    yield ["info", "many"], REFUSED
    yield ["recover", "many", "-o", "o.mcap"], ENDS


def stream_record(kind, payload):
    data = bytes([kind, len(payload)]) + payload
    return data + zlib.crc32(data).to_bytes(4, "little")


def rigid_key_packet(tick):
    """One object at its initial state."""
    models, encoder = Models("rigid-start-models.csv"), RangeEncoder()
    encoder.bit(models["KEY"][1], 1)
    encoder.magnitude(models["TICK"], tick)
    encoder.tree(models["REASON"], 2, 0)
    encoder.tree(models["LEVEL"], 4, 0)
    for k in range(2):
        for kind, later in (("POSE", 4), ("MOTION", 5)):
            for axis in range(3):
                encoder.signed(models[f"{kind}[{k}][{later if axis else 0}]"], 0)
    return encoder.finish()


def far_tick(folder):
    """Some 130 lawful bytes that make a replica of 2^32 ticks."""
    header = bytes.fromhex(
        "89544354020000002c000000e80300001611140cd0070101013f016f00000000000000000000000000000040000000000000000000000000f954c828")
    near = stream_record(1, b"\x01" + rigid_key_packet(1))
    far = stream_record(1, b"\xef\xff\xff\xff\x0f" + rigid_key_packet(0xfffffff0))
    index = stream_record(2, b"\x02\x01\x3c\xef\xff\xff\xff\x0f" + bytes([len(near)]))
    end = stream_record(3, (len(header) + len(near) + len(far)).to_bytes(8, "little"))
    (folder / "b.tct").write_bytes(header + near + far + index + end)
    yield ["decode", "b.tct", "-o", "o.mcap"], REFUSED
    yield ["decode", "b.tct", "-o", "p.mcap", "--ticks", "20"], {0}


def stored(name):
    def bomb(folder):
        (folder / "b.tct").write_bytes(lzma.decompress((INPUTS / f"{name}.tct.xz").read_bytes()))
        yield ["info", "b.tct"], ENDS
    return bomb


def deep_toml(folder):
    for name, content in (("h", "[" + ".".join(["a"] * 31000) + "]"), ("k", ".".join(["a"] * 31000) + " = 1"),
                          ("i", "k = " + "{a=" * 31000 + "1" + "}" * 31000), ("l", "k = " + "[" * 31000 + "]" * 31000),
                          ("q", 's = {k = """a"""", ' + ".".join(["b"] * 31000) + " = 1}")):
        (folder / f"{name}.toml").write_text(content)
        yield ["info", f"{name}.toml"], REFUSED
        yield ["sweep", f"{name}.toml"], REFUSED
        yield ["sim", f"{name}.toml", "-o", "o.mcap"], REFUSED


def large_toml(folder):
    (folder / "n.toml").write_text("a = [" + "1," * 8000000 + "1]")
    (folder / "m.toml").write_text("a = [" + "[]," * 1300000 + "1]")
    (folder / "t.toml").write_text("[[a]]\n" * 690000)
    for name in ("n", "m", "t"):
        yield ["info", f"{name}.toml"], REFUSED
        yield ["sweep", f"{name}.toml"], REFUSED


def endless_files(folder):
    for name in ("z.tct", "z.toml", "z.csv", "z.obj", "z.msh", "z.mcap"):
        os.symlink("/dev/zero", folder / name)
    yield ["info", "z.tct"], REFUSED
    yield ["info", "z.toml"], REFUSED
    yield ["sim", "z.toml", "-o", "o.mcap"], REFUSED
    yield ["sweep", "z.toml"], REFUSED
    yield ["decode", "z.tct", "-o", "o.mcap"], REFUSED
    yield ["encode", "z.mcap", "-o", "o.tct"], REFUSED
    yield ["import", "csv", "z.csv", "-o", "o.mcap", "--map", "position=a,b,c"], REFUSED
    yield ["mesh", "z.obj", "-o", "o.node"], REFUSED
    yield ["mesh", "z.msh", "-o", "o.node"], REFUSED


def names_of_files(folder):
    os.symlink("b", folder / "a")
    os.symlink("a", folder / "b")
    for name in ("a" * 5000, "a", "x\x1b[2J\u202e\n", "."):
        yield ["info", name], REFUSED
        yield ["decode", name, "-o", "o.mcap"], REFUSED
        yield ["sweep", name], REFUSED
        yield ["mesh", name, "-o", "o.node"], REFUSED
    yield ["sim", "push-1dof", "--duration", "5ms", "-o", os.fsdecode(b"b\xff.mcap"), "--json"], {0}


def plan(folder, extra="", vary='d = ["1%", "2%"]', measure='b = "/traffic/payload/bit_per_s"', command='"-p", "{d}"'):
    (folder / "p.toml").write_text(
        'name = "p"\ncommand = ["encode", "one.mcap", "-o", "/dev/null", ' + command + ']\n[[input]]\nname = "one"\nfile = "one.mcap"\n'
        'command = ["sim", "push-1dof", "--duration", "20ms", "-o", "{file}"]\n[vary]\n' + vary + "\n[measure]\n" + measure + "\n" + extra,
        encoding="utf-8")
    return ["sweep", "p.toml", "-o", "od", "-j", "1"]


PLOT = '[[plot]]\nname = "r"\nx = "b"\ny = "b"\nseries = "d"\n'


def plans(folder):
    yield plan(folder, measure='b = "/time/99999999999999999999999"'), REFUSED
    yield plan(folder, measure='b = "/time/01"'), REFUSED
    yield plan(folder, PLOT + 'where = { nosuch = "x" }'), REFUSED
    yield plan(folder, PLOT + 'where = { d = "7%" }'), REFUSED
    (folder / "rec.toml").write_text('name = "rec"\ncommand = ["sweep", "rec.toml", "-o", "rec-{d}", "-j", "1"]\n[vary]\nd = ["1"]\n'
                                     '[measure]\na = "/points"\n')
    yield ["sweep", "rec.toml", "-o", "rec-0"], REFUSED
    big = "".join(f'p{i} = ["{{x}}"]\n' for i in range(50000))
    yield plan(folder, vary=big), REFUSED


def escapes(folder):
    """Text that a terminal would obey, in every place where text of others is printed."""
    evil = "\x1b]0;t\x07\r\u009b2J\u202e" + "x" * 3000
    toml = evil.encode("unicode_escape").decode().replace("\\x", "\\u00")
    (folder / "e.toml").write_text(f'name = "a"\n"{toml}" = 2\n')
    (folder / "e.csv").write_text(f"a,b\n{evil.replace(chr(13), '')},1\n")
    (folder / "e.obj").write_text(f"v {evil} 1 1\nf 1 2 3\n")
    (folder / "e.off").write_text(f"OFF {evil}\n")
    (folder / "e.msh").write_text(f"$MeshFormat\n{evil}\n")
    (folder / "e.node").write_text(f"{evil}\n")
    (folder / "e.ele").write_text(f"{evil}\n")
    yield ["info", "e.toml"], REFUSED
    yield ["import", "csv", "e.csv", "-o", "o.mcap", "--map", "position=a,b,b", "--tick-rate", "10"], REFUSED
    yield ["import", "csv", "e.csv", "-o", "o.mcap", "--map", f"position={evil},b,b", "--tick-rate", "10"], REFUSED
    for name in ("obj", "off", "msh", "node"):
        yield ["mesh", f"e.{name}", "-o", "o.msh"], REFUSED


def escapes_of_traces(folder, trace):
    """The words of a trace: topics, types, source."""
    evil = b"\x1b]0;t\x07\r\xc2\x9b2J\xe2\x80\xae" + b"x" * 3000
    parts = unpacked_mcap(trace)
    schemas = record(SCHEMA, struct.pack("<H", 999) + text(evil) + text("ros2msg") + text(""))
    channels = record(CHANNEL, struct.pack("<HH", 999, 999) + text(b"/" + evil) + text("cdr") + text(""))
    out = [schemas, channels]
    for opcode, content in parts:
        if isinstance(content, list):
            out.append(chunk(b"".join(record(op, c) for op, c in content)))
        elif opcode == METADATA and b"source" in content:
            at = content.index(text("source")) + len(text("source"))
            size = struct.unpack_from("<I", content, at)[0]
            entries = content[len(text("tactus")) + 4:at] + text(evil) + content[at + 4 + size:]
            out.append(record(opcode, text("tactus") + struct.pack("<I", len(entries)) + entries))
        else:
            out.append(record(opcode, content[:-4] + bytes(4) if opcode == ATTACHMENT else content))
    (folder / "e.mcap").write_bytes(mcap(out))
    yield ["info", "e.mcap"], {0}


def many_polygons(folder):
    corners = " ".join(str(i + 1) for i in range(1000))
    (folder / "f.obj").write_text("".join(f"v {i} {i * i % 7} 0\n" for i in range(1000)) + f"f {corners}\n" * 2000)
    yield ["mesh", "f.obj", "-o", "o.node"], REFUSED


def long_header(folder):
    """A stream header that says it is 64 MiB, and one that is."""
    head = b"\x89TCT\x02\0\0\0"
    (folder / "a.tct").write_bytes(head + struct.pack("<I", 1 << 26))
    body = bytes(1 << 20)
    (folder / "b.tct").write_bytes(head + struct.pack("<I", len(body)) + body + struct.pack("<I", zlib.crc32(head + struct.pack("<I", len(body)) + body)))
    (folder / "c.tct").write_bytes(head + to_varint(2 ** 70))
    for name in ("a", "b", "c"):
        yield ["info", f"{name}.tct"], REFUSED


SMALL = (far_tick, deep_toml, names_of_files, plans, escapes, long_header, one_large_chunk, columns_of_a_table,
         many_declarations, stored("models-of-many-meshes"))
LARGE = (many_chunks, empty_records, lines_of_a_table, one_topic_of_many, large_toml, endless_files, many_polygons,
         stored("baselines-of-a-large-mesh"))
OF_TRACES = (escapes_of_traces,)
