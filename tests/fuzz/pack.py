#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fuzz inputs, a folder of files as one file.

  pack.py pack FOLDER FILE.pack     the folder's files, in the order of their names
  pack.py unpack FILE.pack FOLDER   beside what is there already
  pack.py check FILE.pack...        each is what `pack` makes of what `unpack` makes of it

A pack is a row of records: length of the name, name, size, bytes; both numbers are 32 bits, little-endian. The name of most inputs is the
SHA-1 of their bytes, as libFuzzer calls them: it is left out.
"""
import hashlib
import pathlib
import struct
import sys
import tempfile


def pack(folder):
    out = bytearray()
    for path in sorted(folder.iterdir(), key=lambda p: p.name.encode()):
        data, name = path.read_bytes(), path.name.encode()
        if hashlib.sha1(data).hexdigest().encode() == name:
            name = b""
        out += struct.pack("<I", len(name)) + name + struct.pack("<I", len(data)) + data
    return bytes(out)


def records(packed):
    at = 0

    def take(size):
        nonlocal at
        if at + size > len(packed):
            raise ValueError(f"a record is cut off at byte {at}")
        at += size
        return packed[at - size:at]

    while at < len(packed):
        name = take(struct.unpack("<I", take(4))[0]).decode()
        data = take(struct.unpack("<I", take(4))[0])
        yield name or hashlib.sha1(data).hexdigest(), data


def unpack(packed, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in records(packed):
        if pathlib.PurePath(name).name != name:
            raise ValueError(f"{name}: not the name of a file")
        (folder / name).write_bytes(data)


def check(path):
    with tempfile.TemporaryDirectory() as scratch:
        unpack(path.read_bytes(), pathlib.Path(scratch))
        if pack(pathlib.Path(scratch)) != path.read_bytes():
            raise ValueError("it is not sorted by name, or a name stands there twice or needlessly")


def main(args):
    command, paths = (args or [""])[0], [pathlib.Path(a) for a in args[1:]]
    if command == "pack" and len(paths) == 2:
        paths[1].write_bytes(pack(paths[0]))
    elif command == "unpack" and len(paths) == 2:
        unpack(paths[0].read_bytes(), paths[1])
    elif command == "check" and paths:
        for path in paths:
            try:
                check(path)
            except (OSError, ValueError) as error:
                return f"{path}: {error}"
    else:
        return __doc__
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
