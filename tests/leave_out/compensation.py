#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A scene that does not ask for it pays nothing for making up for delay: nothing of it runs, over a network that delays.

  compensation.py TACTUS FOLDER

Runs the same scene with each kind of client and looks which functions were entered (callgrind). Without [compensation] these are none of
loads, of softer rendering and of clients that simulate; with it they are those of the kind that was asked for, or nothing was compared.
Exits with 77 (skipped) where valgrind is missing, and with instrumented programs.
"""
import sys

import callgrind

KINDS = {
    "loads": r"tactus::(LoadEncoder|LoadDecoder)::|tactus::sim::.*store_loads",
    "stiffness": r"tactus::StiffnessReduction::|tactus::sim::Compensation::",
    "simulation": r"tactus::sim::(Prediction|PastShapes)::",
}
WANTED = {"none": set(), "stiffness": {"loads", "stiffness"}, "simulation": {"loads", "simulation"}}


def main(arguments):
    ready = callgrind.program_and_folder(arguments, __doc__)
    if isinstance(ready, int):
        return ready
    tactus, folder = ready
    kept = True
    for clients, wanted in WANTED.items():
        command = (tactus, "sim", "push-cube", "--duration", "800ms", "--link", "delay=20ms", "--compensation", clients, "-o",
                   folder / f"{clients}.mcap", "-f", "-q")
        kept &= callgrind.is_wanted(clients, callgrind.entered(folder / f"{clients}.counts", KINDS, *command), wanted)
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
