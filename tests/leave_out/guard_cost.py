#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Looking after the steps of a deformable object takes at most 5 % of the instructions that its forces take (callgrind).

  guard_cost.py PROGRAM [CMAKE_ARGUMENT...]

The guard is what a step takes beside the integrator's part of it. Exits with 77 (skipped) where valgrind is missing, and in builds
that are instrumented or not optimised.
"""
import shutil
import sys

import callgrind

STEPS = 200
MOST = 0.05
PARTS = {"step": "tactus::sim::CheckedIntegrator::step*", "integrator": "tactus::sim::VelocityVerlet::advance*", "forces": "tactus::sim::FemModel::internal_forces*"}


def main(arguments):
    if not arguments:
        print(__doc__, file=sys.stderr)
        return 2
    if shutil.which("valgrind") is None:
        print("skipped: valgrind not found")
        return 77
    if any("-fsanitize" in a or a == "-DCMAKE_BUILD_TYPE=Debug" for a in arguments):
        print("skipped: instructions of such a build tell nothing")
        return 77
    count = {part: callgrind.instructions("/dev/null", function, arguments[0], STEPS)[0] for part, function in PARTS.items()}
    fraction = (count["step"] - count["integrator"]) / count["forces"] if count["forces"] else 1
    print(*(f"{part}: {n / STEPS:.0f} instructions per step" for part, n in count.items()), sep="\n")
    print(f"guard: {100 * fraction:.1f} % of the forces, at most {100 * MOST:.0f} %")
    return 0 if 0 < fraction <= MOST else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
