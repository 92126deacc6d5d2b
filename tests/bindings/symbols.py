#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Check what a shared library shows:  symbols.py LIBRARY SONAME PART...

It exports the functions of these parts of bindings/names.txt, no other symbol, and has this SONAME.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bindings"))
from generate import names_of  # noqa: E402


def main(library, soname, *parts):
    listed = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    exported = {line.split()[-1].split("@")[0] for line in listed.splitlines()} - {"TACTUS_0"}
    expected = set(names_of(parts))
    for name in sorted(exported ^ expected):
        print(f"{name}: {'exported, and not in names.txt' if name in exported else 'in names.txt, and not exported'}")
    head = subprocess.run(["readelf", "-d", library], capture_output=True, text=True, check=True).stdout
    found = re.search(r"SONAME.*\[(.*)\]", head)
    if not found or found[1] != soname:
        print(f"SONAME is {found[1] if found else 'missing'}, not {soname}")
        return 1
    print(f"{len(exported)} functions")
    return 1 if exported != expected else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
