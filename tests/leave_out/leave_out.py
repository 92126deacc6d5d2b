#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A scene without deformable objects pays nothing for them.

  leave_out.py RIGID_SCENE SOURCE_DIR BUILD_DIR [CMAKE_ARGUMENT...]

RIGID_SCENE was built with the component FEM and the CMAKE_ARGUMENTs. It is built again in BUILD_DIR without FEM, and both must
  - yield the same hash for rigid scenes and need the same number of instructions for them, within 0.1 % (callgrind);
the one without must load no library that the other does not, hold no symbol of the finite elements (the other must, or nothing was
compared), and refuse a membrane.
Exits with 77 (skipped) where valgrind, nm or ldd are missing, and in instrumented builds.
"""
import pathlib
import re
import shutil
import subprocess
import sys

import callgrind

SCENES = {"push-1dof": 300, "rotate-push-lift": 300}  # ticks
TOLERANCE = 1e-3
FEM_SYMBOL = re.compile(r"Eigen::|tactus::sim::(FemModel|Integrator|DeformableBody|ErrorEstimate)\b")


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def build_without(source, build, arguments):
    components = {"FEM": "OFF", "SIM": "ON", "CLI": "OFF", "CONFORMANCE": "OFF", "BENCH": "OFF", "TESTS": "ON"}
    output("cmake", "-S", str(source), "-B", str(build), *arguments, *(f"-DTACTUS_WITH_{k}={v}" for k, v in components.items()))
    output("cmake", "--build", str(build), "--target", "rigid_scene")
    return build / "tests" / "leave_out" / "rigid_scene"


def libraries(program):
    return {line.split()[0] for line in output("ldd", str(program)).splitlines()}


def fem_symbols(program):
    return [line for line in output("nm", "-C", str(program)).splitlines() if FEM_SYMBOL.search(line)]


def compare(with_fem, without_fem, scenes, scratch):
    problems = []
    for name, ticks in SCENES.items():
        (a, hash_a), (b, hash_b) = (callgrind.instructions(scratch, "run_scene", p, scenes / f"{name}.toml", ticks) for p in (with_fem, without_fem))
        print(f"{name}, {ticks} ticks: {a} instructions with FEM, {b} without, difference {100 * (a - b) / b:+.5f} %")
        if abs(a - b) > TOLERANCE * b:
            problems.append(f"{name}: {a} and {b} instructions")
        if hash_a != hash_b:
            problems.append(f"{name}: results differ")
    loaded = libraries(with_fem), libraries(without_fem)
    print(f"loaded because of finite elements: {' '.join(sorted(loaded[0] - loaded[1])) or 'nothing'}")
    if loaded[1] - loaded[0]:
        problems.append(f"other libraries are loaded: {loaded[0]} and {loaded[1]}")
    counts = len(fem_symbols(with_fem)), len(fem_symbols(without_fem))
    print(f"symbols of finite elements: {counts[0]} with FEM, {counts[1]} without")
    if counts[0] == 0 or counts[1] > 0:
        problems.append("finite elements are where they must not be, or not where they must")
    refused = subprocess.run([str(without_fem), str(scenes / "membrane.toml"), "1"], capture_output=True, text=True, check=False)
    print(f"membrane without FEM: exit status {refused.returncode}, {refused.stderr.strip()}")
    if refused.returncode != 1 or refused.stderr.strip() != "R-SIM-2":
        problems.append("a membrane without FEM must be refused by R-SIM-2")
    return problems


def main(arguments):
    if len(arguments) < 3:
        print(__doc__, file=sys.stderr)
        return 2
    for tool in ("valgrind", "nm", "ldd"):
        if shutil.which(tool) is None:
            print(f"skipped: {tool} not found")
            return 77
    if any("-fsanitize" in argument for argument in arguments):
        print("skipped: callgrind cannot run instrumented programs")
        return 77
    program, source, build = map(pathlib.Path, arguments[:3])
    try:
        without = build_without(source, build, arguments[3:])
        problems = compare(program, without, source / "sim" / "scenes", build / "callgrind.out")
    except subprocess.CalledProcessError as error:
        problems = [f"{' '.join(map(str, error.cmd))}\n{error.stdout}{error.stderr}"]
    print(*(f"FAILED  {p}" for p in problems), sep="\n")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
