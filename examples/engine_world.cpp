// SPDX-License-Identifier: Apache-2.0
/// An engine's loop at 60 Hz, with a left-handed world, y up, and bodies that come and go. The scene declares slots, all parked at one position; which
/// body a slot shows is the engine's own affair. A body that leaves the world or breaks (NaN) is shown where it was last until it is good again, and
/// the others go on.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include <tactus/tactus.h>

#include "coordinates.h"

namespace {

constexpr std::size_t kSlots = 8;
constexpr int kTicks = 600;  // 10 s
const EnginePose kParked{{0, -100, 0}, {0, 0, 0, 1}};

struct Body {  // as an engine has it
  std::string name{};
  EnginePose pose{};
  Float3 velocity{}, angular_velocity{};  // units per second, rad/s
};

/// A ball rolls along x for 8 s. From 2 s to 6 s there is a drone, which breaks at 5 s for half a second: meanwhile the ball hits a wall and rolls
/// back. A crate comes at 7 s.
std::vector<Body> bodies_at(int tick) {
  const float t = static_cast<float>(tick) / 60;
  std::vector<Body> bodies;
  const bool comes_back = tick >= 312;
  if (tick < 480)
    bodies.push_back({"ball", {{comes_back ? 10.4f - t : t, 0.5f, 0}, {0, 0, 0, 1}}, {comes_back ? -1.0f : 1.0f, 0, 0}, {}});
  if (tick >= 120 && tick < 360) {
    const bool breaks = tick >= 300 && tick < 330;
    const float height = breaks ? std::numeric_limits<float>::quiet_NaN() : 3 - 0.5f * (t - 2);
    bodies.push_back({"drone", {{0, height, 2}, {0, std::sin(t / 2), 0, std::cos(t / 2)}}, {0, -0.5f, 0}, {0, 1, 0}});
  }
  if (tick >= 420) bodies.push_back({"crate", {{2, 0.5f, 2}, {0, 0, 0, 1}}, {}, {}});
  return bodies;
}

/// Which body each slot shows; "": none.
struct Slots {
  std::vector<std::string> names = std::vector<std::string>(kSlots);

  std::size_t of(const std::string& body) const {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), body) - names.begin());
  }
  /// Bodies that are new take the first free slot, and those that are gone leave theirs.
  void update(int tick, const std::vector<Body>& bodies) {
    for (std::size_t i = 0; i < kSlots; ++i) {
      const auto is_here = [&](const Body& body) { return body.name == names[i]; };
      if (names[i].empty() || std::any_of(bodies.begin(), bodies.end(), is_here)) continue;
      std::printf("tick %d: %s leaves slot %zu\n", tick, names[i].c_str(), i);
      names[i].clear();
    }
    for (const Body& body : bodies) {
      if (of(body.name) != kSlots) continue;
      const std::size_t i = of("");  // an engine asks whether there is one
      names[i] = body.name;
      std::printf("tick %d: %s takes slot %zu\n", tick, body.name.c_str(), i);
    }
  }
};

}  // namespace

int main() {
  tactus::SceneBuilder builder(60);  // ticks per second
  for (std::size_t i = 0; i < kSlots; ++i) builder.rigid("slot " + std::to_string(i), pose_from_engine(kUnity, kParked));
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
  Slots slots;
  bool was_held = false;
  for (int tick = 0; tick < kTicks; ++tick) {
    const std::vector<Body> bodies = bodies_at(tick);
    slots.update(tick, bodies);
    for (const Body& body : bodies)
      truth[slots.of(body.name)] = {pose_from_engine(kUnity, body.pose), from_engine(kUnity, body.velocity),
                                    angular_from_engine(kUnity, body.angular_velocity)};
    for (std::size_t i = 0; i < kSlots; ++i)
      if (slots.names[i].empty()) truth[i] = parked;  // rests there, and costs nothing

    const auto sent = sender->encode(tick, {.objects = truth});
    if (!sent) return std::printf("tick %d: %s\n", tick, describe(sent.error())), 1;
    for (const tactus::HeldPart& part : sender->held()) {  // mostly none
      const std::string& body = slots.names[part.index];
      held += body == "drone";
      if (part.since == tick) std::printf("tick %d: %s is held: %s\n", tick, body.c_str(), describe(part));
    }
    if (was_held && sender->held().empty()) std::printf("tick %d: all bodies are good again\n", tick);
    was_held = !sender->held().empty();
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
  std::printf("%d packets, %zu bytes in 10 s; the drone is held for %d ticks; at most %.2f mm off\n", packets, bytes, held,
              1e3 * worst);

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
  return worst <= 0.0051 && held == 30 ? 0 : 1;  // the ball turned round while the drone was held
}
