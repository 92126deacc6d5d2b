#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measure the simulation, sessions and signals: `tactus bench STUDY ...`, each study a module of lab/studies.

The points are computed by the program tactus-study (lab/study), which only a build tree with TACTUS_WITH_STUDY has; `world` needs NumPy alone.
"""
import importlib
import sys

from common import arguments

STUDIES = {
    "precision": "Error against run time: methods, solvers and step sizes",
    "delay": "What delay does to force and picture, and what clients can do about it",
    "stability": "Stability limits of each part beside theory",
    "session": "How sessions tolerate networks that lose, delay and reorder",
    "scale": "What a server of many clients and objects costs",
    "join": "How long a client takes to join over a line",
    "world": "A large world on several servers, on paper: load, hand-overs, traffic",
    "signals": "What the devices and forces of recordings cost on their way",
}


def main(words):
    if words and words[0] in STUDIES:
        study = importlib.import_module("studies." + words[0])
        return arguments.run(study.parser(STUDIES[words[0]]), study.work, words[1:])
    listed = "\n".join(f"  {name:<11}{what}" for name, what in STUDIES.items())
    parser = arguments.parser("bench", "Measure the simulation, sessions and signals", f"studies:\n{listed}\n\nExample:\n"
                              "  tactus bench stability --help")
    parser.add_argument("study", metavar="STUDY", choices=STUDIES, help="One of those below")
    return arguments.run(parser, lambda options: None, words)


if __name__ == "__main__":
    main(sys.argv[1:])
