// SPDX-License-Identifier: Apache-2.0
/// Valid rigid packets.
#include <algorithm>
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
constexpr std::int32_t kSmallest = std::numeric_limits<std::int32_t>::min();

RawHeader with_objects(std::vector<RawObject> objects) {
  RawHeader header;
  header.objects = std::move(objects);
  return header;
}

/// One object that every packet names, with random residuals at random intervals.
Bytes walk(const RawHeader& header, std::uint64_t seed, int packets) {
  Stream stream(header);
  Random random(seed);
  std::int64_t tick = 0;
  for (int i = 0; i < packets; ++i) {
    stream.add({.tick = tick, .updates = {random_update(random, stream.header(), 0)}, .key = i == 0});
    tick += random.below(60);
  }
  return stream.finish().bytes();
}

Bytes single_axes(std::uint64_t seed) {
  RawHeader header = with_objects({{"still", Dof::none, {5, 6, 7}},
                                   {"x", Dof::x},
                                   {"y", Dof::y},
                                   {"wall", Dof::none},
                                   {"z", Dof::z},
                                   {"rx", Dof::rx},
                                   {"ry", Dof::ry, {}, {0, kOne30, 0, 0}},
                                   {"rz", Dof::rz},
                                   {"door", Dof::x | Dof::z | Dof::ry}});
  Stream stream(header);
  Random random(seed);
  for (std::int64_t tick = 0; tick < 200; tick += 5) {
    Step step{.tick = tick, .updates = {}, .key = tick == 0};
    for (const std::uint32_t object : {1u, 2u, 4u, 5u, 6u, 7u, 8u}) {
      if (tick == 0 || random.below(2) == 0) step.updates.push_back(random_update(random, stream.header(), object));
    }
    if (!step.updates.empty()) stream.add(step);
  }
  return stream.finish().bytes();
}

Bytes gaps() {
  RawHeader header;
  header.objects.clear();
  for (int i = 0; i < 300; ++i) header.objects.push_back({std::to_string(i), i % 3 == 0 ? Dof::none : Dof::x});
  Stream stream(header);
  const auto naming = [](std::initializer_list<std::uint32_t> objects) {
    std::vector<Update> updates;
    for (const std::uint32_t object : objects)
      updates.push_back({object, Reason::heartbeat, 0, {{{static_cast<std::int32_t>(object), 0, 0}}}});
    return updates;
  };
  stream.add({.tick = 1, .updates = naming({1, 2, 4, 299}), .key = true});
  stream.add({.tick = 2, .updates = naming({298})});
  stream.add({.tick = 3, .updates = naming({1, 149, 151, 152, 298, 299})});
  return stream.finish().bytes();
}

Bytes reasons_and_levels() {
  Stream stream(with_objects({{"cube"}}));
  std::int64_t tick = 0;
  for (int reason = 0; reason < 4; ++reason) {
    for (std::uint8_t level = 0; level < 16; ++level) {
      const Update update{0, static_cast<Reason>(reason), level, {{{3, -2, 1}, {-9, 8, -1}, {4, 0, -5}, {1, 1, -2}}}};
      stream.add({.tick = tick, .updates = {update}, .key = tick == 0});
      tick += 11;
    }
  }
  return stream.finish().bytes();
}

Bytes key_packets() {
  Stream stream(with_objects({{"a", Dof::all, {1000, 2000, 3000}}, {"b", Dof::all, {-1, -2, -3}}}));
  Random random(405);
  const auto update = [&](std::uint32_t object) { return random_update(random, stream.header(), object); };
  stream.add({.tick = 0, .updates = {update(0), update(1)}, .key = true});
  stream.add({.tick = 10, .updates = {update(1)}});
  stream.add({.tick = 20, .updates = {update(0)}, .key = true});
  stream.add({.tick = 30, .updates = {update(0)}});
  stream.add({.tick = 30, .updates = {update(1)}, .key = true});
  stream.add({.tick = 31, .updates = {update(0), update(1)}});
  return stream.finish().bytes();
}

Bytes extrapolation_limit() {
  RawHeader header = with_objects({{"cube"}});
  header.max_extrapolation = 50;
  Stream stream(header);
  std::int64_t tick = 0;
  for (const int dt : {0, 1, 49, 50, 51, 5000, 3}) {
    tick += dt;
    const Update update{
        0, dt % 2 == 0 ? Reason::visual : Reason::haptic, 1, {{{1, -1, 2}, {4000, -3000, 900}, {2, 3, -4}, {500, 2000, -900}}}};
    stream.add({.tick = tick, .updates = {update}, .key = tick == 0});
  }
  return stream.finish().bytes();
}

Bytes saturated_position() {
  Stream stream(with_objects({{"p", Dof::translation, {kLargest, kSmallest, 0}}}));
  const auto by = [](Vec3i position, Vec3i velocity, std::uint8_t level) {
    return std::vector<Update>{{0, Reason::visual, level, {{position, velocity}}}};
  };
  stream.add({.tick = 0, .updates = by({1, -1, 0}, {kLargest, -kLargest, 100}, 0), .key = true});
  stream.add({.tick = 2000, .updates = by({0, 0, kLargest}, {0, 0, 0}, 14)});
  stream.add({.tick = 2001, .updates = by({-kLargest, kLargest, -kLargest}, {0, 0, 0}, 0)});
  stream.add({.tick = 2002, .updates = by({-kLargest, kLargest, -kLargest}, {0, 0, 0}, 0)});
  return stream.finish().bytes();
}

Bytes saturated_motion() {
  RawHeader header = with_objects({{"cube"}});
  header.tick_rate = 1000000;
  Stream stream(header);
  const auto add = [&](std::int64_t tick, Reason reason, std::uint8_t level, const std::array<Vec3i, kQuantities>& residual) {
    stream.add({.tick = tick, .updates = {{0, reason, level, residual}}, .key = tick == 0});
  };
  add(0, Reason::visual, 14, {{{0, 0, 0}, {kLargest, -kLargest, 131072}, {0, 0, 0}, {kLargest, -kLargest, 2049}}});
  add(0 + 1, Reason::haptic, 14, {{{kLargest, -kLargest, 3}, {0, 0, 0}, {16, 0, -3}, {0, 0, 0}}});
  add(2, Reason::haptic, 0, {{{1, -1, 0}, {-1, 1, 0}, {1, -1, 0}, {1, -1, 1}}});
  add(3, Reason::visual, 4, {{{0, 0, 0}, {-kLargest, kLargest, 1}, {0, 0, 0}, {-kLargest, kLargest, 1}}});
  add(3, Reason::haptic, 1, {{{5, 0, 0}, {1, 2, 3}, {0, 5, 0}, {1, 2, 3}}});
  return stream.finish().bytes();
}

Bytes half_circles() {
  Stream stream(with_objects({{"cube", Dof::all, {}, {759250125, 0, 759250125, 0}}}));
  const auto turn = [](Vec3i residual, std::uint8_t level) {
    return std::vector<Update>{{0, Reason::visual, level, {{{}, {}, residual, {}}}}};
  };
  stream.add({.tick = 0, .updates = turn({kHalfCircle, 0, 0}, 0), .key = true});
  stream.add({.tick = 1, .updates = turn({0, -kHalfCircle, 0}, 0)});
  stream.add({.tick = 2, .updates = turn({0, 0, kHalfCircle >> 6}, 6)});
  stream.add({.tick = 3, .updates = turn({kHalfCircle - 1, 1447, 0}, 0)});
  stream.add({.tick = 4, .updates = turn({605395, -605395, 605395}, 0)});
  stream.add({.tick = 5, .updates = turn({-(kHalfCircle >> 14), 0, 0}, 14)});
  stream.add({.tick = 6, .updates = turn({1, 0, 0}, 0)});
  return stream.finish().bytes();
}

/// A fast rotation, seen again after many intervals: every quadrant of the sine, angles beyond a full circle.
Bytes fast_rotation() {
  RawHeader header = with_objects({{"top", Dof::all, {}, {0, 0, -kOne30, 0}}});
  header.max_extrapolation = 65535;
  Stream stream(header);
  stream.add({.tick = 0, .updates = {{0, Reason::visual, 0, {{{}, {}, {}, {9000, -70000, 120001}}}}}, .key = true});
  std::int64_t tick = 0;
  for (int i = 0; i < 40; ++i)
    stream.add({.tick = tick += 1 + i * i * 7, .updates = {{0, Reason::request, 0, {{{}, {}, {}, {1, -1, 7 * i}}}}}});
  stream.add({.tick = tick += 65535, .updates = {{0, Reason::visual, 7, {{{}, {}, {}, {1 << 12, -(1 << 12), 1 << 12}}}}}});
  stream.add({.tick = tick + 65535, .updates = {{0, Reason::visual, 0, {{{1, 1, 1}}}}}});
  return stream.finish().bytes();
}

RawHeader with_grid(const GridExponents& grid, std::uint32_t tick_rate) {
  RawHeader header;
  header.grid = grid;
  header.tick_rate = tick_rate;
  return header;
}

}  // namespace

void add_rigid(Catalogue& c) {
  c.section(section::kRigidPacket);
  c.valid("one-axis", "An object that slides along x.", walk(with_objects({{"slider", Dof::x}}), 401, 40));
  c.valid("free-object", "An object with all degrees of freedom.", walk(RawHeader{}, 402, 60));
  c.valid("single-axes", "Objects with one axis each among static ones, which no packet names.", single_axes(403));
  c.valid("gaps", "300 objects, a third of them static: gaps from 0 to 198.", gaps(), {"R-RIG-4"});
  c.valid("reasons-and-levels", "Every reason with every level.", reasons_and_levels());
  c.valid("key-packets", "Key packets in the middle: what they do not name returns to its initial state.", key_packets(),
          {"R-PKT-4"});
  c.section(section::kPrediction);
  c.valid("extrapolation-limit", "Predictions up to, at and beyond max_extrapolation.", extrapolation_limit());
  c.section(section::kPose);
  c.valid("saturated-position", "Positions at both ends of 32 bits, by prediction and by residual.", saturated_position());
  c.section(section::kMotion);
  c.valid("saturated-motion",
          "Velocity at both ends of 32 bits, angular velocity at +-2^25; motion predicted from haptic residuals.",
          saturated_motion());
  c.section(section::kPose);
  c.valid("half-circles", "Rotation residuals of length 1 and just below.", half_circles(), {"R-RIG-6"});
  c.section(section::kPrediction);
  c.valid("fast-rotation",
          "Rotation through many full circles, up to the largest angular velocity times the longest extrapolation.",
          fast_rotation());
  c.section(section::kPose);
  c.valid("coarsest-grid", "Every grid exponent at its lower limit.", walk(with_grid({8, 0, 8, 0}, 1000), 415, 40), {"R-STR-7"});
  c.valid("finest-grid", "Every grid exponent at its upper limit.", walk(with_grid({30, 30, 28, 20}, 1000), 416, 40),
          {"R-STR-7"});
  c.valid("widest-grid-steps",
          "Velocity and angular velocity twelve binary orders coarser than position and rotation, 60 ticks per second.",
          walk(with_grid({30, 18, 28, 16}, 60), 417, 40), {"R-STR-7"});
  c.valid("slowest-clock", "One tick per second.", walk(with_grid({22, 17, kRotationExp, 12}, 1), 418, 20), {"R-STR-6"});
  c.valid("fastest-clock", "A million ticks per second.", walk(with_grid({22, 17, kRotationExp, 12}, 1000000), 419, 20),
          {"R-STR-6"});
}

}  // namespace tactus::conformance
