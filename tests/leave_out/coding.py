#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A stream that does not ask for a tool of the rigid codec runs nothing of it.

  coding.py TACTUS FOLDER

Encodes the same recording with each set of tools and looks which functions were entered (callgrind).
Exits with 77 (skipped) where valgrind is missing, and with instrumented programs.
"""
import subprocess
import sys

import callgrind

KINDS = {
    "look-ahead": r"tactus::look_ahead_velocity\(",
    "smoothing": r"tactus::(longest_smoothing_exp|kept_offset)\(",
    "predictors": r"tactus::PredictorChoice::",
}
WANTED = {
    ("--profile", "thesis"): set(),
    ("--profile", "main"): {"look-ahead", "smoothing"},
    ("--profile", "main", "--tune", "reduction=none"): set(),
    ("--profile", "thesis", "--tune", "gravity=9.81,friction=0.3"): {"predictors"},
}


def main(arguments):
    ready = callgrind.program_and_folder(arguments, __doc__)
    if isinstance(ready, int):
        return ready
    tactus, folder = ready
    trace, stream = folder / "trace.mcap", folder / "stream.tct"
    subprocess.run([tactus, "sim", "push-1dof", "--duration", "2s", "-o", trace, "-f", "-q"], check=True)
    kept = True
    for options, wanted in WANTED.items():
        command = (tactus, "encode", trace, "-p", "4%", "--visual", "0.3mm,2deg", *options, "-o", stream, "-f", "-q")
        kept &= callgrind.is_wanted(" ".join(options), callgrind.entered(folder / "counts", KINDS, *command), wanted)
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
