// SPDX-License-Identifier: Apache-2.0
/// A cube and a table, from server to client. Prints what is sent, why, and the error at the client.
#include <algorithm>
#include <cstdio>

#include <tactus/tactus.h>

int main() {
  const auto scene =
      tactus::SceneBuilder().rigid("table", {}, {.dof = tactus::Dof::none}).rigid("cube", {{0, 0, 0.05}, {}}).build();
  if (!scene) return 1;
  auto sender = tactus::Sender::create(*scene);
  auto receiver = tactus::Receiver::create(*scene);
  if (!sender || !receiver) return 1;
  double worst = 0;  // [m]
  for (int tick = 0; tick < 3000; ++tick) {
    const double v = tick < 1000 ? 0.1 : tick < 2000 ? 0 : -0.2;  // [m/s] it slides, rests, and comes back twice as fast
    const double x = tick < 1000 ? 1e-4 * tick : tick < 2000 ? 0.1 : 0.1 - 2e-4 * (tick - 2000);
    const tactus::RigidSample truth[] = {{}, {{{x, 0, 0.05}, {}}, {v, 0, 0}, {}}};
    const auto packets = sender->encode(tick, {.objects = truth});
    if (!packets) return 1;
    for (const tactus::Packet& packet : *packets) {
      std::printf("tick %4d: %zu bytes, reason %d\n", tick, packet.bytes.size(), static_cast<int>(packet.reason));
      if (!receiver->push(packet.number, packet.bytes)) return 1;
    }
    const tactus::Pose shown = receiver->pose(1, tick);
    worst = std::max(worst, tactus::norm(shown.position - truth[1].pose.position));
  }
  std::printf("at most %.3f mm off, 0.3 mm are allowed\n", 1e3 * worst);
  return worst <= 3e-4 ? 0 : 1;
}
