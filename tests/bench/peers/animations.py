#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rate against error of meshes that move freely, with and without clusters, beside MPEG-4 FAMC.

    tests/bench/peers/animations.py TACTUS FOLDER... [-o OUT]
    tests/bench/peers/animations.py --points OUT/points.csv [-o OUT]    # figures and fractions of what was measured before

A FOLDER holds one OBJ file per frame and is named after its clip. It is read by `tactus import mesh` so that the diagonal of the box
of all frames is 1024 mm: a unit, its 1024th part, is 1 mm. Writes points.csv, beside-famc.csv and a figure for each clip to OUT, for
which it needs matplotlib.
beside-famc.csv: the fractions of FAMC's bits at which ours has the same KG error. famc.csv holds what FAMC's reference software made of four clips.
"""
import argparse
import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "lab"))
from common import figure  # noqa: E402

BOUNDS = "0.125", "0.25", "0.5", "1", "2", "4", "8"          # largest error [units]
SETTINGS = {"no basis": [], "24 clusters": ["--tune", "clusters=24"], "40 clusters": ["--tune", "clusters=40"], "64 clusters": ["--tune", "clusters=64"]}
COLUMNS = ("clip", "vertices", "frames", "setting", "bound_units", "bits_per_vertex", "basis_bytes", "kg_percent", "largest_units", "over",
           "encode_us", "decode_us")
FAMC = pathlib.Path(__file__).with_name("famc.csv")


def frames_of(folder):
    number = lambda path: int(re.findall(r"\d+", path.stem)[-1])
    for path in sorted(folder.glob("*.obj"), key=number):
        with path.open() as lines:
            yield [tuple(map(float, line.split()[1:4])) for line in lines if line.startswith("v ")]


def measure_clip(folder):
    """Vertices, frames, diagonal of the box of all frames, and the spread of the vertices about the mean of each frame, both in file units."""
    low, high, spread, count, frames = [math.inf] * 3, [-math.inf] * 3, 0.0, 0, 0
    for points in frames_of(folder):
        frames, count = frames + 1, len(points)
        for axis, values in enumerate(zip(*points)):
            low[axis], high[axis] = min(low[axis], *values), max(high[axis], *values)
            mean = sum(values) / count
            spread += sum((x - mean) ** 2 for x in values)
    return count, frames, math.dist(low, high), math.sqrt(spread / (count * frames))


def encode(tactus, trace, stream, bound, options):
    command = [tactus, "encode", trace, "-o", stream, "-f", "--json", "--haptic", "off", "--tune", "key_interval=0",
               "--deformable-visual", bound + "mm", *options]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def points_of(tactus, folder, scratch):
    vertices, frames, diagonal, spread = measure_clip(folder)
    unit = 1.024 / diagonal                                              # [m] per unit of the files
    trace, stream = scratch / "clip.mcap", scratch / "clip.tct"
    subprocess.run([tactus, "import", "mesh", folder, "--rate", "30", "--length-unit", f"{unit:.9g}m", "-o", trace, "-f", "-q"], check=True)
    headers = {}
    for setting, options in SETTINGS.items():
        for bound in BOUNDS:
            report = encode(tactus, trace, stream, bound, options)
            headers.setdefault(setting, report["stream"]["header_bytes"])
            basis = headers[setting] - headers["no basis"]               # the rest shape is known to both sides, its clusters are not
            mesh = report["deformables"][0]
            error = mesh["error"]["position_m"]
            yield dict(zip(COLUMNS, (
                folder.name, vertices, frames, setting, bound,
                f"{8 * (mesh['traffic']['bytes'] + basis) / vertices / (frames - 1):.4f}", basis,
                f"{100 * error['rms'] / (spread * unit):.4f}", f"{1000 * error['max']:.4f}", error["over"],
                *(f"{1e6 * mesh['time'][end]['p50_s']:.0f}" for end in ("encode", "decode")))))


def rate_at(points, kg):
    """Between two points, on straight lines of the logarithms; none beyond the first and the last."""
    curve = sorted((math.log(float(p["kg_percent"])), math.log(float(p["bits_per_vertex"]))) for p in points)
    for (x, y), (right, above) in zip(curve, curve[1:]):
        if x <= math.log(kg) <= right:
            return math.exp(y + (above - y) * (math.log(kg) - x) / (right - x))
    return None


def draw(clip, points, famc, out):
    """Beside points of ours, lines, those of FAMC."""
    of = lambda rows: ([float(p["kg_percent"]) for p in rows], [float(p["bits_per_vertex"]) for p in rows])
    fig, (axes,) = figure.panels()
    for i, name in enumerate(("40 clusters", "no basis")):
        figure.line(axes, *of([p for p in points if p["setting"] == name]), i, label=name)
    for i, (name, is_whole) in enumerate({"FAMC, the whole clip known": True, "FAMC, 8 to 57 frames known": False}.items(), 2):
        rows = [p for p in famc if (p["segment"] == "whole") == is_whole]
        if rows:
            axes.plot(*of(rows), label=name, **figure.style_of(i) | {"linestyle": "none"})
    figure.logarithmic(axes)
    axes.set(xlabel="root mean square error, KG [%]", ylabel="bits per vertex and frame [bit]")
    axes.legend(loc="upper right")
    figure.title(fig, f"{clip}: {points[0]['vertices']} vertices, {points[0]['frames']} frames")
    figure.save(fig, out / f"{clip}.svg")


def beside(points, famc, least=0.4, largest=1.1):
    """Rows of beside-famc.csv: least and largest fraction of FAMC's bits at the same KG error, of its points from 0.4 to 1.1 %."""
    rows = []
    for clip in dict.fromkeys(p["clip"] for p in famc):
        for is_whole in (True, False):
            others = [p for p in famc if p["clip"] == clip and (p["segment"] == "whole") == is_whole]
            others = [p for p in others if least <= float(p["kg_percent"]) <= largest]
            for setting in ("no basis", "40 clusters"):
                ours = [p for p in points if p["clip"] == clip and p["setting"] == setting]
                fractions = [rate / float(p["bits_per_vertex"]) for p in others if (rate := rate_at(ours, float(p["kg_percent"])))]
                if fractions:
                    rows.append([clip, "whole clip" if is_whole else "8 to 57 frames", setting.replace("no basis", "none"),
                                 f"{min(fractions):.2f}", f"{max(fractions):.2f}"])
    return rows


def draw_all(points, out):
    with FAMC.open() as file:
        famc = list(csv.DictReader(file))
    for clip in dict.fromkeys(p["clip"] for p in points):
        draw(clip, [p for p in points if p["clip"] == clip], [p for p in famc if p["clip"] == clip], out)
    with (out / "beside-famc.csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["clip", "famc_knows", "basis", "least_ratio_of_bits", "largest_ratio_of_bits"])
        table.writerows(beside(points, famc))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tactus", nargs="?", type=pathlib.Path, metavar="TACTUS", help="the program")
    parser.add_argument("folders", type=pathlib.Path, nargs="*", metavar="FOLDER")
    parser.add_argument("--points", type=pathlib.Path, metavar="CSV", help="of an earlier run: nothing is measured")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("out/animation"), metavar="OUT", help="[out/animation]")
    args = parser.parse_args()
    if bool(args.folders) == bool(args.points):
        parser.error("give the program and folders, or --points")
    for folder in args.folders:
        if not re.fullmatch(r"[A-Za-z0-9_-]+", folder.name) or not any(folder.glob("*.obj")):
            parser.error(f"{folder}: must be a folder of OBJ files with a name of letters, digits, _ and -")
    args.output.mkdir(parents=True, exist_ok=True)
    if args.points:
        with args.points.open() as file:
            draw_all(list(csv.DictReader(file)), args.output)
        return 0
    points = []
    for folder in args.folders:
        with tempfile.TemporaryDirectory() as scratch:
            points += points_of(args.tactus, folder, pathlib.Path(scratch))
    with (args.output / "points.csv").open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(points)
    draw_all(points, args.output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
