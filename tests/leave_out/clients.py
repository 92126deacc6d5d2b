#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What rests costs a server of many clients nothing.

  clients.py TACTUS_STUDY FOLDER

Instructions of the server in a tick (callgrind) with 16 clients who look at objects that rest: 2000 of them against 20. Where the program
says what has moved the count is the same; where it does not, each object is compared once, whatever the number of clients.
Exits with 77 (skipped) where valgrind is missing.
"""
import json
import sys

import callgrind

TICKS = 100
ROWS = [  # what else is asked for, clients, instructions that one more object may take in a tick
    ({"names_moved": True}, 16, 0.1),
    ({}, 16, 80),
    ({}, 64, 80),
]


def instructions(program, folder, objects, clients, more):
    request = {"clients": clients, "objects": objects, "moving": 0, "ticks": TICKS} | more
    counted, printed = callgrind.instructions(folder / "counts", "tactus_scale_tick", program, "scale", json.dumps(request))
    live = json.loads(printed)["live"]
    if live != clients:
        sys.exit(f"FAILED  {live} of {clients} clients are live")
    return counted / TICKS


def main(arguments):
    found = callgrind.program_and_folder(arguments, __doc__)
    if isinstance(found, int):
        return found
    failed = False
    for more, clients, most in ROWS:
        few, many = (instructions(*found, objects, clients, more) for objects in (20, 2000))
        each = (many - few) / 1980
        failed |= each > most
        print(f"{'FAILED' if each > most else 'ok    '}  {clients} clients{', what moved is named' if more else ''}: "
              f"{few:.0f} and {many:.0f} a tick, {each:.3f} for each object (at most {most:g})")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
