# SPDX-License-Identifier: Apache-2.0
"""Play two streams of one scene side by side: packets, hash of the last state, and how far apart the first object is shown. In Python;
compare_streams.c and compare_streams.mjs are the same program.   usage: compare_streams.py A.tct B.tct"""
import sys

import numpy as np

import tactus


def main(paths):
    packets, farthest, tick = [[], []], 0.0, 0
    with tactus.Player(paths[0]) as a, tactus.Player(paths[1]) as b:
        for path, player in zip(paths, (a, b)):
            if not player.scene.objects:
                sys.exit(f"{path}: no rigid object")
        while True:
            for player, played in zip((a, b), packets):
                played += player.play(tick)
            farthest = max(farthest, np.linalg.norm(a.poses(tick)[0, :3] - b.poses(tick)[0, :3]))
            if a.next_tick() is None and b.next_tick() is None:
                break
            tick += 1
        for path, player, played in zip(paths, (a, b), packets):
            print(f"{path}: {len(played)} packets, {sum(p.size for p in played)} bytes, state {player.state_hash():016x}")
    print(f"at most {1e3 * farthest:.3f} mm apart")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        main(sys.argv[1:])
    except tactus.Error as error:
        sys.exit(str(error))
