// SPDX-License-Identifier: Apache-2.0
/// An engine with 60 ticks per second, a left-handed world with y up, and objects that come and go. The scene declares slots, all parked at one
/// position; what a slot shows is the engine's own affair. A body that leaves the world or breaks (NaN) is held where it was last, and the others go
/// on.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include <tactus/tactus.h>

#include "coordinates.h"

namespace {

constexpr int kSlots = 8, kTicks = 600;  // 10 s
const EnginePose kParked{{0, -100, 0}, {0, 0, 0, 1}};

struct Body {  // as an engine has it
  int slot = -1;
  EnginePose pose;
  Float3 velocity{}, angular_velocity{};  // units per second, rad/s
};

/// A ball rolls along x for 8 s; from 2 s to 6 s there is another one, which breaks at 5 s.
std::vector<Body> bodies_at(int tick) {
  const float t = static_cast<float>(tick) / 60;
  std::vector<Body> bodies;
  if (tick < 480) bodies.push_back({0, {{t, 0.5f, 0}, {0, 0, 0, 1}}, {1, 0, 0}, {}});
  if (tick >= 120 && tick < 360) {
    const float height = tick < 300 ? 3 - 0.5f * (t - 2) : std::numeric_limits<float>::quiet_NaN();
    bodies.push_back({3, {{0, height, 2}, {0, std::sin(t / 2), 0, std::cos(t / 2)}}, {0, -0.5f, 0}, {0, 1, 0}});
  }
  return bodies;
}

}  // namespace

int main() {
  tactus::SceneBuilder builder(60);  // ticks per second
  for (int i = 0; i < kSlots; ++i) builder.rigid("slot " + std::to_string(i), pose_from_engine(kUnity, kParked));
  const auto scene = builder.build();
  if (!scene) return std::printf("%s: %s\n", scene.error().object.c_str(), describe(scene.error())), 1;
  tactus::SenderOptions options;
  options.triggers.visual_position = 0.005;  // [m]
  auto sender = tactus::Sender::create(*scene, options);
  auto receiver = tactus::Receiver::create(*scene);
  if (!sender || !receiver) return 1;

  const tactus::RigidSample parked{pose_from_engine(kUnity, kParked), {}, {}};
  std::vector<tactus::RigidSample> truth(kSlots, parked), wanted = truth;
  int packets = 0, held = 0;
  std::size_t bytes = 0;
  double worst = 0;  // [m]
  for (int tick = 0; tick < kTicks; ++tick) {
    std::vector<bool> is_used(kSlots);
    for (const Body& body : bodies_at(tick)) {
      const auto slot = static_cast<std::size_t>(body.slot);
      is_used[slot] = true;
      truth[slot] = {pose_from_engine(kUnity, body.pose), from_engine(kUnity, body.velocity),
                     angular_from_engine(kUnity, body.angular_velocity)};
    }
    for (std::size_t i = 0; i < kSlots; ++i)
      if (!is_used[i]) truth[i] = parked;  // rests there, and costs nothing

    const auto sent = sender->encode(tick, {.objects = truth});
    if (!sent) return std::printf("tick %d: %s\n", tick, describe(sent.error())), 1;
    for (const tactus::HeldPart& part : sender->held()) {  // mostly none
      ++held;
      if (part.since == tick) std::printf("tick %d: %s is held: %s\n", tick, name_of(**scene, part).data(), describe(part));
    }
    for (const tactus::Packet& packet : *sent) {
      ++packets, bytes += packet.bytes.size();
      if (!receiver->push(packet.number, packet.bytes)) return 1;
    }
    for (std::size_t i = 0; i < kSlots; ++i)
      if (tactus::is_finite(truth[i].pose.position)) wanted[i] = truth[i];
    for (std::uint32_t i = 0; i < kSlots; ++i) {
      const EnginePose shown = pose_to_engine(kUnity, receiver->pose(i, tick));  // to the engine's object of this slot
      worst = std::max(worst, tactus::norm(pose_from_engine(kUnity, shown).position - wanted[i].pose.position));
    }
  }
  std::printf("%d packets, %zu bytes in 10 s; held for %d ticks; at most %.2f mm off\n", packets, bytes, held, 1e3 * worst);

  // What an engine turns is turned here: a quarter turn about its up axis, clockwise as seen from above in a left-handed world.
  const float s = std::sqrt(0.5f);
  for (const EngineAxes& e : {kUnity, kUnreal, kGodot}) {
    const Float3 up = to_engine(e, {0, 0, 1}), ahead = to_engine(e, {0, 1, 0});
    const Float3 position{1, 2, 3};
    const auto unit = [&](float v) { return static_cast<float>(e.metres) * v; };
    const EnginePose turned{position, {s * unit(up[0]), s * unit(up[1]), s * unit(up[2]), s}};
    const tactus::Vec3 face = tactus::rotate(pose_from_engine(e, turned).rotation, {0, 1, 0});
    const EnginePose again = pose_to_engine(e, pose_from_engine(e, turned));
    double off = std::abs(face.x + e.hand) + std::abs(face.y) + std::abs(face.z);  // to the right if left-handed
    for (std::size_t i = 0; i < 3; ++i)
      off += std::abs(again.position[i] - position[i]) + std::abs(again.rotation[i] - turned.rotation[i]);
    if (off > 1e-5 || std::abs(tactus::norm(from_engine(e, ahead)) - 1) > 1e-6) return std::printf("axes: %g off\n", off), 1;
  }
  std::printf("poses of three engines come back as they were\n");
  return worst <= 0.0051 ? 0 : 1;
}
