// SPDX-License-Identifier: Apache-2.0
/// The first program: a cube slides and comes to rest, one second at 1 kHz. It prints what the other programs of this folder print.
#include <algorithm>
#include <cstdio>

#include <tactus/tactus.h>

int main() {
  const auto scene = tactus::SceneBuilder().rigid("cube").build();  // both ends declare the same
  if (!scene) return std::printf("%s\n", describe(scene.error())), 1;
  auto sender = tactus::Sender::create(*scene);
  auto receiver = tactus::Receiver::create(*scene);
  if (!sender || !receiver) return 1;

  std::size_t count = 0, bytes = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    const double t = std::min(tick, 500) / 1000.0;  // s; at rest from 0.5 s on
    const double x = 0.2 * t - 0.2 * t * t;         // m
    const double v = 0.2 - 0.4 * t;                 // m/s
    const tactus::RigidSample cube{.pose = {{x, 0, 0}, {}}, .velocity = {v, 0, 0}, .angular_velocity = {}};
    const auto packets = sender->encode(tick, {.objects = {&cube, 1}});
    if (!packets) return std::printf("%s\n", describe(packets.error())), 1;
    for (const tactus::Packet& packet : *packets) {  // mostly none: the receiver predicts
      std::printf("tick %d: %zu bytes\n", tick, packet.bytes.size());
      count += 1, bytes += packet.bytes.size();
      if (!receiver->push(packet.number, packet.bytes)) return 1;  // a network would be here
    }
  }

  const auto [x, y, z] = receiver->pose(0, 999).position;
  std::printf("%zu packets, %zu bytes; shown at tick 999: x %.4f m, y %.4f m, z %.4f m\n", count, bytes, x, y, z);
}
