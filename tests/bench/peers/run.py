#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Our mesh profiles beside other codecs, in one table per recording and number of vertices.

    cmake --preset release && cmake --build --preset release --target peers_bench tactus
    tests/bench/peers/run.py build/release [--csv FILE] [INPUT...]

Without INPUT (a .mcap trace, or a .md3 model as FILE or FILE:SURFACE): a membrane recording made on the spot, and four animated torsos
and legs of Debian's package openarena-data if it is installed or --openarena names its unpacked folder.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile
import zipfile

ARCHIVE = pathlib.Path("usr/share/games/openarena/baseoa/pak0.pk3")
PLAYERS = "sorceress", "sarge"
PARTS = ("upper", "u_torso"), ("lower", "l_legs")


def models(root, folder):
    """The models, taken out of the game's archive, or nothing and a word on how to get them."""
    archive = root / ARCHIVE
    if not archive.exists():
        print(f"no animated models: {archive} is not there (apt-get install openarena-data, or --openarena FOLDER)", file=sys.stderr)
        return []
    found = []
    with zipfile.ZipFile(archive) as pk3:
        for player in PLAYERS:
            for part, surface in PARTS:
                file = pathlib.Path(folder) / f"{player}-{part}.md3"
                file.write_bytes(pk3.read(f"models/players/{player}/{part}.md3"))
                found.append(f"{file}:{surface}")
    return found



def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, help="build folder")
    parser.add_argument("inputs", nargs="*", metavar="INPUT")
    parser.add_argument("--csv", help="file for all settings, not only the best")
    parser.add_argument("--openarena", type=pathlib.Path, default=pathlib.Path("/"), help="folder with usr/share/games/openarena")
    parser.add_argument("--frames", default="600", help="at most so many of each recording [600]")
    args = parser.parse_args()
    for program in ("cli/tactus", "tests/bench/peers/peers_bench"):
        if not (args.build / program).is_file():
            parser.error(f"{args.build / program}: no such program; build it as said above")
    with tempfile.TemporaryDirectory() as folder:
        inputs = args.inputs
        if not inputs:
            trace = str(pathlib.Path(folder) / "membrane.mcap")
            subprocess.run([args.build / "cli/tactus", "sim", "membrane", "--seed", "1", "-o", trace, "-q"], check=True)
            inputs = [trace, *models(args.openarena, folder)]
        command = [args.build / "tests/bench/peers/peers_bench", "--frames", args.frames]
        if args.csv:
            command += ["--csv", args.csv]
        return subprocess.run([*command, *inputs], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
