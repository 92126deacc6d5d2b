#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Softer rendering on objects, hands and delays that lambda was not chosen on, as the test PressedObject.CompensationHelpsElsewhere has them:
a table of the RMS error of the force with it, over that without, while a hand presses and holds.   elsewhere.py FILE.csv
"""
import itertools
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from common import program, table  # noqa: E402

OBJECTS = [(350, 2, 0.1), (50, 1, 0.02), (200, 5, 0.5)]  # k_o [N/m], b_o [N s/m], m_o [kg]
LAMBDA = 0.1  # of eq. 4.56, as StiffnessReduction has it for what yields
HEAD = ["k_o_N_per_m", "b_o_Ns_per_m", "m_o_kg", "k_N_per_m", "frequency_Hz", "round_trip_ms", "rms_over_that_without"]


def forces(point, **more):
    (k_o, b_o, m_o), stiffness, frequency, round_trip = point
    asked = {"msd": {"stiffness_N_per_m": k_o, "damping_Ns_per_m": b_o, "mass_kg": m_o}, "stiffness_N_per_m": stiffness,
             "client_damping_Ns_per_m": 5, "duration_s": 1.8, "frequency_Hz": frequency}
    users = [{"round_trip_ms": round_trip, "presses": [[0.2, 1.2, 1.8, 0.02]]}]
    return program.point("press", **asked, **more, users=users)["users"][0]


def rms(force, reference):
    return math.sqrt(sum((a - b) ** 2 for a, b in zip(force, reference, strict=True)) / len(force))


def ratio(point):
    reference = forces((*point[:3], 0))["server_N"]
    with_, without = (rms(forces(point, **more)["client_N"], reference) for more in ({"compensation": LAMBDA}, {}))
    return [*point[0], *point[1:], f"{with_ / without:.6g}"]


points = itertools.product(OBJECTS, (250, 700), (0.3, 1, 2), (40, 120))
table.write_csv(sys.argv[1], HEAD, program.side_by_side(ratio, points, 2))
