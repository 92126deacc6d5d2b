# SPDX-License-Identifier: Apache-2.0
"""Reads the files of tests/data/foreign, each the essence of a public report of a fault: what comes out must be what is right.

  foreign.py PROGRAM DATA   in an empty folder

The motion of most of them is x = 0.1 sin(i/100), y = 0.05 cos(i/100), z = 0.02, turned by i/500 about z in sample i.
"""
import csv
import io
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys

PROGRAM, DATA = sys.argv[1], pathlib.Path(sys.argv[2])
XYZ, TURN = ["--map", "position=x,y,z"], ["--map", "rotation=qw,qx,qy,qz"]


def tactus(*words):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def moved(i):
    return 0.1 * math.sin(i / 100), 0.05 * math.cos(i / 100), 0.02, math.cos(i / 1000), 0, 0, math.sin(i / 1000)


class Table:
    """A trace, and what its reader said."""

    def __init__(self, path, *how):
        source = path
        if how:
            status, _, self.notes = tactus("import", *how[:1], path, *how[1:], "-o", "trace.mcap", "-q", "-f")
            assert status == 0, self.notes
            source = "trace.mcap"
        status, out, notes = tactus("export", "csv", source)
        assert status == 0, notes
        self.notes = notes if not how else self.notes
        self.rows = list(csv.DictReader(io.StringIO(out)))
        self.rate = round(1 / float(self.rows[1]["time_s"])) if len(self.rows) > 1 else 0

    def pose(self, name, row):
        names = [k for k in self.rows[0] if re.fullmatch(rf"/objects/{re.escape(name)}/(x|y|z|qw|qx|qy|qz)", k)] if name else list(self.rows[0])[3:10]
        return [float(self.rows[row][k]) for k in names]

    def speed(self, name):
        return max(math.hypot(*(float(r[f"/objects/{name}/{v}"]) for v in ("vx", "vy", "vz"))) for r in self.rows)

    def force(self, row):
        return [float(v) for k, v in self.rows[row].items() if re.search(r"/(fx|fy|fz)$", k)]


def near(found, wanted, within=1e-6):
    assert all(abs(a - b) <= within for a, b in zip(found, wanted)), f"{found} instead of {wanted}"


def is_motion(table, rate, rows, first=0, name="", within=1e-6, numbers=7, step=1):
    """In row k is sample first + k step of the motion."""
    assert (table.rate, len(table.rows)) == (rate, rows), f"{table.rate} Hz, {len(table.rows)} rows"
    for k in range(rows):
        near(table.pose(name, k)[:numbers], moved(first + k * step)[:numbers], within)


def says(text, *wanted):
    for part in wanted:
        assert part in text, f"'{part}' is not in: {text}"


def refused(words, *wanted):
    status, _, err = tactus(*words)
    assert status == 1, f"status {status}"
    says(err, *wanted)


# ==== recordings ====

def two_arm_bases(path):
    t = Table(path)
    near(t.pose("left", -1)[:3], (0.3, 0.5, 0))
    near(t.pose("right", -1)[:3], (0.3, -0.5, 0))


def two_robots(path):
    t = Table(path)
    for name, x in (("r1.base_link", 0), ("r2.base_link", 1)):
        near(t.pose(name, 3)[:3], (x, 0, 0))
        assert t.speed(name) == 0


def bursts(path):
    t = Table(path)
    is_motion(t, 1000, 300)
    assert t.speed("tool") < 1.01, t.speed("tool")
    says(t.notes, "bursts of 10")


def crossing(path):
    t = Table(path)
    is_motion(t, 1000, 200)
    says(t.notes, "cross in time by up to 0.003 s")


def late_wrench(path):
    t = Table(path)  # samples come every 2^20 ns
    assert t.rate == 954, t.rate
    near(t.force(4000), (0, 0, 0))
    near(t.force(-1), (0, 0, 1))
    says(t.notes, "/tool/wrench: begins at 4.320 s")


def another_parent(path):
    t = Table(path)
    is_motion(t, 1000, 60, name="hand")
    near(t.pose("cup", 29)[:3], (0.1, 0, 0))
    x, y, z, w, _, _, sine = moved(59)
    near(t.pose("cup", 59)[:3], (x + 0.1 * (w * w - sine * sine), y + 0.2 * w * sine, z))
    says(t.notes, "frame cup of /tf: hangs on another frame: hand, before on world")


def no_number(path):
    t = Table(path)
    is_motion(t, 1000, 60, name="tool")
    says(t.notes, "/tool/wrench: a sample is missing: a number is NaN or infinite (5 times, the first at 0.000 s)")


def two_channels(path):
    t = Table(path)
    is_motion(t, 1000, 60)
    says(t.notes, "comes on 2 channels; taken as one")


def nearly_unit(path):
    t = Table(path)
    is_motion(t, 1000, 60, numbers=3)
    for row, wanted in ((0, (1, 0, 0, 0)), (59, (0.985, 0, 0, 0.0591))):  # in the file, 0.985 and 0.987 long
        near(t.pose("", row)[3:], [c / math.hypot(*wanted) for c in wanted])
    assert tactus("encode", path, "-o", "o.tct", "-f", "--haptic", "off", "--visual", "1mm,2deg")[0] == 0


def without_rotation(path):
    refused(["encode", path, "-o", "o.tct", "-f", "--haptic", "off", "--visual", "1mm,2deg"], "/tool/pose, at 0.000 s: the rotation is 0, 0, 0, 0")


def lz4(path):
    t = Table(path)
    is_motion(t, 1000, len(t.rows))


def ros1(path):
    refused(["info", path], "(ros1")


# ==== tables ====

def milliseconds(path):
    t = Table(path, "csv", "--time", "time_ms", *XYZ)
    is_motion(t, 1000, 39, numbers=3)
    says(t.notes, "in ms, as its name says")
    refused(["import", "csv", path, "--time", "time_ms", "--time-unit", "s", *XYZ, "-o", "o.mcap"], "R-CSV-10")


def epoch(path):
    t = Table(path, "csv", "--time", "timestamp [ns]", "--map", "position=p_x [m],p_y [m],p_z [m]", "--map", "rotation=q_w [],q_x [],q_y [],q_z []")
    is_motion(t, 200, 29)
    says(t.notes, "2014-06-24 19:02:59 UTC")


def tum(path):
    is_motion(Table(path, "csv", "--time", "timestamp", "--map", "position=tx,ty,tz", "--map", "rotation=qx,qy,qz,qw"), 1000, 39)


def no_names(path):
    is_motion(Table(path, "csv", "--time", "#1", "--map", "position=#2,#3,#4", "--map", "rotation=#5,#6,#7,#8"), 1000, 30)


def jitter(path):
    t = Table(path, "csv", "--time", "t", *XYZ, *TURN)
    is_motion(t, 1000, 39, within=1e-3)
    says(t.notes, "times lie on no grid: resampled at 1000 Hz", "a sample is interpolated, over at most", "(38 times)")


def twice(path):
    t = Table(path, "csv", "--time", "t", *XYZ, *TURN)
    if t.rate == 1000:  # spread over the time to the next
        return is_motion(t, 1000, 29)
    assert (t.rate, len(t.rows)) == (500, 15), f"{t.rate} Hz, {len(t.rows)} rows"
    for k in range(15):
        near(t.pose("", k), moved(min(2 * k + 1, 28)))
    return says(t.notes, "14; the last of each counts")


def dropout(path):
    t = Table(path, "csv", "--time", "t", *XYZ, *TURN)
    is_motion(t, 1000, 40, first=89, within=1.6e-4)  # a chord over 11 samples
    says(t.notes, "a sample is missing: a rotation of length 0 (10 times, the first line 13", "a sample is interpolated, over at most", "(10 times)")
    refused(["import", "csv", path, "--time", "t", *XYZ, *TURN, "--strict", "-o", "o.mcap"], "line 13", "R-CSV-4")


def cut_number(path):
    t = Table(path, "csv", "--time", "t", *XYZ)
    near([len(t.rows), *t.pose("", -1)[:3]], (2, 0.101, 0.2, 12.3))
    says(t.notes, "the last line has no end", "(line 4)")


def mocap(path):
    turn = ["--map", "rotation=Rotation X,Rotation Y,Rotation Z,Rotation W"]
    is_motion(Table(path, "csv", "--time", "Time (Seconds)", "--map", "position=Position X,Position Y,Position Z", *turn), 120, 24)


def utf16(path):
    t = Table(path, "csv", "--time", "t", *XYZ)
    near([t.rate, len(t.rows), *t.pose("", -1)[:3]], (1000, 5, 0.1, 0.2, 0.3))


def plus(path):
    t = Table(path, "csv", "--time", "t", *XYZ)
    near([t.rate, len(t.rows), *t.pose("", -1)[:3]], (1000, 2, 0.1, 0.2, 0.3))


def commas(path):
    names = '"Position, x","Position, y","Position, z"'
    is_motion(Table(path, "csv", "--time", "t", "--map", "position=" + names), 1000, 11, numbers=3, within=5.1e-5)


def quoted(path):
    t = Table(path, "csv", "--time", "t", *XYZ)
    is_motion(t, 1000, 19, numbers=3, within=5.1e-5)
    says(t.notes, "a number in quotes has a comma, which is taken for the decimal point (76 times)")


# ==== surfaces that move ====

def frames(path, ticks, first_x, *notes, options=()):
    """The first vertex's x in each frame, and its tick."""
    status, out, err = tactus("import", "mesh", path, "--rate", 30, *options, "-o", "mesh.mcap", "-f", "-q")
    assert status == 0, err
    says(err, *notes)
    shutil.rmtree("shapes", ignore_errors=True)
    assert tactus("export", "mesh", "mesh.mcap", "-o", "shapes", "-q")[0] == 0
    found = [float(re.search(r"^v (\S+)", p.read_text(), re.M)[1]) for p in sorted(pathlib.Path("shapes").iterdir())]
    near([len(found), *found], [len(first_x), *first_x], 1e-7)
    last = json.loads(tactus("info", "mesh.mcap", "--json")[1])
    assert re.search(rf'"last_tick": {ticks[-1]}\b', json.dumps(last)), last


def negative(path):
    frames(path, range(6), [-0.03, -0.02, -0.01, 0, 0.01, 0.02])


def gap(path):
    frames(path, [0, 1, 2, 5, 6, 7], [0, 0.01, 0.02, 0.05, 0.06, 0.07], "frames 0 to 7, 3, 4 missing: the time goes on")


def two_bodies(path):
    refused(["import", "mesh", path, "-o", "o.mcap"], "left_*.obj and right_*.obj: R-SEQ-5", "--series 'left_*.obj'")
    frames(path, range(3), [0, 0.01, 0.02], options=["--series", "left_*.obj"])


def appledouble(path):
    frames(path, range(2), [0, 0.01], "a file is left out as hidden or a copy (._f_0.obj)")


# ==== surfaces and tetrahedra ====

def filled(path, vertices, volume, low, high, *notes, options=()):
    status, out, err = tactus("mesh", path, *options, "-o", "o.node", "-f", "--json")
    assert status == 0, err
    says(err, *notes)
    report = json.loads(out)
    near([report["vertices"], *report["box_m"][0], *report["box_m"][1]], [vertices, *low, *high])
    assert abs(report["volume_m3"] / volume - 1) < 1e-6, report["volume_m3"]


def cube(*notes):
    return lambda path: filled(path, 8, 1, (0, 0, 0), (1, 1, 1), *notes)


def degenerate(path):
    refused(["mesh", path, "-o", "o.node", "-f"], "surface-degenerate-face.obj:21: face 12: vertices 1 1 2: R-SRF-10", "--drop-degenerate")
    filled(path, 8, 1, (0, 0, 0), (1, 1, 1), options=["--drop-degenerate"])


def far(path):
    filled(path, 8, 1e-6, (500000.1234, 0, 0), (500000.1334, 0.01, 0.01))
    pathlib.Path("one").mkdir(exist_ok=True)
    shutil.copy(path, "one")
    frames("one", [0], [500000.1234])


def two_tets(path):
    filled(path, 5, 0.5, (0, 0, 0), (1, 1, 1))


RIGHT = {
    "ros-poses-in-two-arm-bases.mcap": two_arm_bases, "ros-two-robots-with-own-tf.mcap": two_robots, "ros-bursts-of-ten.mcap": bursts,
    "ros-log-times-cross-between-topics.mcap": crossing, "ros-wrench-begins-after-4s.mcap": late_wrench,
    "ros-cup-hangs-on-the-hand-later.mcap": another_parent, "ros-first-wrenches-not-a-number.mcap": no_number,
    "ros-two-channels-of-one-topic.mcap": two_channels, "ros-rotation-of-length-0985.mcap": nearly_unit,
    "ros-pose-without-rotation.mcap": without_rotation, "ros-lz4.mcap": lz4, "ros1-in-mcap.mcap": ros1,
    "csv-time-in-ms.csv": milliseconds, "csv-euroc-epoch-ns.csv": epoch, "csv-tum-trajectory.txt": tum, "csv-no-names.csv": no_names,
    "csv-jitter-under-a-tick.csv": jitter, "csv-times-twice.csv": twice, "csv-rotation-zero-in-dropout.csv": dropout,
    "csv-cut-within-the-last-number.csv": cut_number, "csv-mocap-several-header-lines.csv": mocap, "csv-utf16.csv": utf16,
    "csv-names-with-commas.csv": commas, "csv-quoted-decimal-comma.csv": quoted, "csv-leading-plus.csv": plus,
    "frames-negative-numbers": negative, "frames-gap": gap, "frames-two-bodies": two_bodies, "frames-appledouble": appledouble,
    "surface-bom-shifts-vertices.obj": cube(), "surface-modelnet-header.off": cube(), "surface-coff.off": cube(), "surface-int-count.ply": cube(),
    "surface-face-texcoord.ply": cube(), "surface-nan-normals.ply": cube(), "surface-bytes-behind.stl": cube("3 bytes behind the last facet"),
    "surface-degenerate-face.obj": degenerate, "surface-far-from-origin.obj": far,
    "tets-msh-version-2.msh": two_tets, "tets-msh-binary-2.2.msh": two_tets}


def main():
    wrong = sorted({p.name for p in DATA.iterdir()} ^ RIGHT.keys())
    for name in wrong:
        print(f"{name}: no file, or nothing says what is right")
    for name, check in RIGHT.items():
        try:
            check(DATA / name)
        except AssertionError as error:
            wrong.append(name)
            print(f"{name}: {error}")
    print(f"{len(RIGHT) - len(wrong)} of {len(RIGHT)} right")


if __name__ == "__main__":
    main()
