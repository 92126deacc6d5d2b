#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What rests or cannot move costs nothing while a scene runs.

  rest.py REST_SCENE FOLDER

Instructions per tick (callgrind, ticks 100 to 300, trace included) of small scenes with and without something that rests, written
into FOLDER. Each row of ROWS says how many more the one may take than the other. A scene of one cube that rests takes 12 000,
one that moves 170 000.
Exits with 77 (skipped) where valgrind is missing.
"""
import sys

import callgrind

TICKS = 200
HEAD = """name = "{name}"
duration = 3.0
gravity = [0.0, 0.0, {gravity}]
floor = 0.0
[touch]
stiffness = 100.0
friction = 0.4
lift_stiffness = 50.0
"""
USER = """[[user]]
name = "hand"
object = "cube"
start = [-0.1, 0.0, 0.02]
[[user.path]]
name = "stay"
to = [-0.1, 0.0, 0.02]
duration = 3.0
"""
CORNERS = 'fixed = "corners"\n'
ALL = "[[deformable.fixed]]\nlow = [-1.0, -1.0, -1.0]\nhigh = [1.0, 1.0, 1.0]\n"


def box(name, x, y, dof=""):
    return (f'[[object]]\nname = "{name}"\nsize = [0.04, 0.04, 0.04]\nmass = 0.15\nfriction = 0.5\n'
            f"position = [{x:g}, {y:g}, 0.02]\n{dof}")


def membrane(name, x, fixed=CORNERS, rate=1):
    return (f'[[deformable]]\nname = "{name}"\ncells = [16, 20, 1]\ncell = 0.01\nposition = [{x:g}, 10.0, 1.0]\nyoung = 1.0e4\n'
            f"poisson = 0.45\ndensity = 1.0e4\nmass_damping = 1.0\nrate = {rate}\n{fixed}")


def apart(count, dof=""):
    return "".join(box(f"box{i}", 1 + 0.1 * i, 5, dof) for i in range(count))


CUBE = box("cube", 0, 0)
SCENES = {  # name: gravity, text
    "still": (0.0, CUBE + USER),
    "still-no-user": (0.0, CUBE),
    "weight": (-9.81, CUBE + USER),
    "membrane": (0.0, CUBE + membrane("a", 10) + USER),
    "membrane-no-user": (0.0, CUBE + membrane("a", 10)),
    "membrane-all-fixed": (-9.81, CUBE + membrane("a", 10, ALL) + USER),
    "membrane-rate-17": (0.0, CUBE + membrane("a", 10, rate=17) + USER),
    "four-membranes": (0.0, CUBE + "".join(membrane(n, 10 + i) for i, n in enumerate("abcd")) + USER),
    "static-300": (-9.81, CUBE + apart(300, "dof = []\n") + USER),
    "free-100": (-9.81, CUBE + apart(100) + USER),
}
ROWS = [  # scene, the same without, how many more at most
    ("membrane", "still", 2000),
    ("membrane-no-user", "still-no-user", 2000),
    ("membrane-all-fixed", "weight", 2000),
    ("membrane-rate-17", "still", 2000),
    ("four-membranes", "still", 8000),
    ("static-300", "weight", 1200),
    ("free-100", "weight", 5000),
]


def instructions(program, scene, folder):
    return callgrind.instructions(folder / "counts", "counted_ticks", program, scene)[0] / TICKS


def main(arguments):
    ready = callgrind.program_and_folder(arguments, __doc__)
    if isinstance(ready, int):
        return ready
    program, folder = ready
    counts = {}
    for name, (gravity, text) in SCENES.items():
        scene = folder / f"{name}.toml"
        scene.write_text(HEAD.format(name=name, gravity=gravity) + text)
        counts[name] = instructions(program, scene, folder)
    failed = False
    for name, base, limit in ROWS:
        more = counts[name] - counts[base]
        failed |= not more <= limit
        print(f"{'ok    ' if more <= limit else 'FAILED'}  {name}: {more:.0f} instructions a tick more than {base} "
              f"({counts[base]:.0f}), at most {limit}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
