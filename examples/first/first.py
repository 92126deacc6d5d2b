# SPDX-License-Identifier: Apache-2.0
"""The first program: a cube slides and comes to rest, one second at 1 kHz. It prints what the other programs of this folder print, and
writes first.tct, the stream file that first.mjs plays."""
import tactus

scene = tactus.build_scene([tactus.RigidObject("cube")])  # both ends declare the same
sender = tactus.Sender(scene)
receiver = tactus.Receiver(scene)
writer = tactus.StreamWriter(scene)

count = size = 0
for tick in range(1000):
    t = min(tick, 500) / 1000  # s; at rest from 0.5 s on
    x = 0.2 * t - 0.2 * t * t  # m
    v = 0.2 - 0.4 * t          # m/s
    cube = [x, 0, 0, 1, 0, 0, 0, v, 0, 0, 0, 0, 0]  # position, rotation w x y z, velocity, angular velocity
    for packet in sender.encode(tick, [cube]):      # mostly none: the receiver predicts
        print(f"tick {tick}: {packet.size} bytes")
        count, size = count + 1, size + packet.size
        receiver.push(packet)                       # a network would be here
        writer.add(packet)

x, y, z = receiver.poses(999)[0, :3]
print(f"{count} packets, {size} bytes; shown at tick 999: x {x:.4f} m, y {y:.4f} m, z {z:.4f} m")
with open("first.tct", "wb") as file:
    file.write(writer.finish())
