#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Time the calls of bindings_bench.cpp in Python: median and fastest of many, CPU time of one call.

  bindings_bench.py FOLDER    writes into FOLDER the streams that it pushes, rigid.tct and mesh.tct, for bindings_bench.mjs

PYTHONPATH names the package of a build: bindings/README.md has the command.
"""
import math
import pathlib
import statistics
import sys
import time

import numpy as np

import tactus

OBJECTS, COLUMNS, ROWS = 10, 20, 33  # as in bindings_bench.cpp: 714 vertices
PACKETS = 256
EDGE = 0.004  # m, of a square of the sheet


def rigid_scene():
    return tactus.build_scene([tactus.RigidObject(f"object {i}") for i in range(OBJECTS)])


def sheet():
    j, i = np.mgrid[0:ROWS + 1, 0:COLUMNS + 1]
    vertices = np.stack([EDGE * i, EDGE * j, 0.0 * i], axis=-1).reshape(-1, 3)
    corner = (np.arange(ROWS)[:, None] * (COLUMNS + 1) + np.arange(COLUMNS)).ravel()
    across = corner + COLUMNS + 2
    triangles = np.concatenate([np.stack([corner, corner + 1, across], axis=1), np.stack([corner, across, across - 1], axis=1)])
    return tactus.Mesh("sheet", vertices, triangles.astype(np.uint32))


def moving(tick, size):
    """(OBJECTS, 13): each sways by so many metres at its own pace."""
    out = np.zeros((OBJECTS, 13))
    rate = 1 + np.arange(OBJECTS)
    phase = 1e-3 * rate * tick
    out[:, 0], out[:, 7] = size * np.sin(phase), size * rate * np.cos(phase)
    out[:, 3] = 1
    return out


def dented(mesh, tick):
    """A dent of 15 mm that walks over the sheet, rises and falls."""
    t, width = tick / 60, COLUMNS * EDGE
    at = width * np.array([0.5 + 0.35 * math.cos(1.9 * t), 0.5 + 0.35 * math.sin(1.4 * t)])
    distance = ((mesh.vertices[:, :2] - at) ** 2).sum(axis=1) / width ** 2
    out = np.zeros((len(mesh.vertices), 3), np.float32)
    out[:, 2] = -max(0.015 * math.sin(2.7 * t), 0) * np.exp(-8 * distance)
    return out


def packets_of(scene, truth_at):
    """The first packets of a scene with their numbers, and a stream file that holds them."""
    out, tick = [], 0
    with tactus.Sender(scene) as sender, tactus.StreamWriter(scene) as writer:
        while len(out) < PACKETS:
            for packet in sender.encode(tick, **truth_at(tick)):
                writer.add(packet)
                out.append((packet.number, packet.data))
            tick += 1
        return out, writer.finish()


def times(call, arguments, rounds=9):
    """CPU time of a call [us]: median and least of the rounds, each the mean over all arguments. `call` begins anew with round 0."""
    found = []
    for _ in range(rounds):
        run = call()
        begin = time.process_time()
        for argument in arguments:
            run(argument)
        found.append(1e6 * (time.process_time() - begin) / len(arguments))
    return statistics.median(found), min(found)


def decoder_rows(kind, scene, packets):
    decoder = tactus.Receiver(scene)
    for packet in packets:
        decoder.push(*packet)

    def pushes():
        push = tactus.Receiver(scene).push
        return lambda packet: push(*packet)

    yield f"push_{kind}", times(pushes, packets)
    if kind == "mesh":
        yield "show_mesh", times(lambda: lambda tick: decoder.displacements(0, tick), range(2000, 6000))
    else:
        yield "show_poses", times(lambda: decoder.poses, range(2000, 6000))


def encoder_rows(scene):
    for name, reduction in (("encode_nothing", tactus.REDUCTION_DEAD_RECKONING), ("encode_packet", tactus.REDUCTION_NONE)):
        truth = [moving(tick, 0.002) for tick in range(PACKETS)]

        def begin(how=reduction, truth=truth):
            sender = tactus.Sender(scene, rigid=tactus.RigidBounds(heartbeat=0), reduction=how, key_interval=0)
            return lambda tick: sender.encode(tick, truth[tick])

        yield name, times(begin, range(PACKETS))


def main(folder):
    mesh = sheet()
    rigid, soft = rigid_scene(), tactus.build_scene(meshes=[mesh], tick_rate=60)
    streams = {"rigid": (rigid, *packets_of(rigid, lambda tick: {"objects": moving(tick, 0.1)})),
               "mesh": (soft, *packets_of(soft, lambda tick: {"shapes": [tactus.Shape(dented(mesh, tick))]}))}
    folder.mkdir(parents=True, exist_ok=True)
    print(f"{'call':24}{'median [us]':>14}{'least [us]':>14}")
    for kind, (scene, packets, stream) in streams.items():
        (folder / f"{kind}.tct").write_bytes(stream)
        for name, (median, least) in decoder_rows(kind, scene, packets):
            print(f"{name:24}{median:14.2f}{least:14.2f}")
    for name, (median, least) in encoder_rows(rigid):
        print(f"{name:24}{median:14.2f}{least:14.2f}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]))
