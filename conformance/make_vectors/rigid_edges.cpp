// SPDX-License-Identifier: Apache-2.0
/// Edges of the arithmetic of rigid packets, and every row of its start models that a packet can use.
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
constexpr std::int32_t kUnit = 1 << 20;  // (2^30, 0, 2^20, -2^20) is as long as a rotation may be

Bytes longest_rotations_multiplied() {
  RawHeader header;
  header.objects = {{"a", Dof::all, {}, {kOne30, 0, kUnit, -kUnit}}, {"b", Dof::all, {}, {-kOne30, 0, kUnit, -kUnit}}};
  Stream stream(header);
  const auto turn = [](std::uint32_t object, const Vec3i& by) { return Update{object, Reason::visual, 0, {{{}, {}, by, {}}}}; };
  stream.add({.tick = 1, .updates = {turn(0, {425, -512, 512}), turn(1, {425, 512, -512})}, .key = true});
  return stream.finish().bytes();
}

/// 1/32 of a step of angle in ten ticks.
Bytes slowest_rotation() {
  RawHeader header;
  header.grid.angular_velocity = 20;
  header.objects[0].rotation = {kOne30, 0, kUnit, -kUnit};
  Stream stream(header);
  stream.add({.tick = 0, .updates = {{0, Reason::visual, 0, {{{}, {}, {}, {1, 0, 0}}}}}, .key = true});
  stream.add({.tick = 10, .updates = {{0, Reason::heartbeat, 0, {}}}});
  return stream.finish().bytes();
}

/// A rotation by most of a half circle in a millionth of a second, and a residual of the angular velocity that takes back what 32
/// bits hold of it.
Bytes saturated_angular_velocity() {
  RawHeader header;
  header.tick_rate = 1000000;
  Stream stream(header);
  stream.add({.tick = 0, .key = true});
  stream.add(
      {.tick = 1, .updates = {{0, Reason::haptic, 0, {{{}, {}, {700000, -700000, 0}, {-kLargest + 5, kLargest - 7, 0}}}}}});
  return stream.finish().bytes();
}

/// In 401 ticks the object rotates by 2^32 binary angle units of half its angle, which is none.
Bytes full_circles() {
  RawHeader header;
  header.grid = {22, 17, 28, 20};
  header.objects[0].rotation = {kOne30, 0, kUnit, -kUnit};
  Stream stream(header);
  stream.add({.tick = 0, .updates = {{0, Reason::visual, 0, {{{}, {}, {}, {32859837, 0, 0}}}}}, .key = true});
  stream.add({.tick = 401, .updates = {{0, Reason::heartbeat, 0, {}}}});
  return stream.finish().bytes();
}

/// A position residual of 45 bits in a haptic update, so long after the one before that it changes the velocity by little.
Bytes haptic_residual_of_45_bits() {
  RawHeader header;
  header.tick_rate = 1;
  header.grid = {30, 18, kRotationExp, 12};
  Stream stream(header);
  stream.add({.tick = 0, .key = true});
  stream.add({.tick = 1 << 16, .updates = {{0, Reason::haptic, 14, {{{kLargest, -kLargest, 1}}}}}});
  return stream.finish().bytes();
}

/// Bits of 1 alone: in groups of raw bits the last interval, where no bit of the range is lost.
constexpr std::int32_t of_width(int width) { return (1 << width) - 1; }

/// Every context of a residual, every width.
Bytes every_residual() {
  RawHeader header;
  header.grid = {22, 17, 28, 20};
  Stream stream(header);
  std::int64_t tick = 0;
  const auto add = [&](Reason reason, const Vec3i& pose, const Vec3i& motion) {
    stream.add({.tick = tick, .updates = {{0, reason, 0, {pose, motion, pose, motion}}}, .key = tick == 0});
    ++tick;
  };
  for (int width = 0; width <= 15; ++width) {
    const std::int32_t value = of_width(width);
    for (int reason = 0; reason < 4; ++reason) add(static_cast<Reason>(reason), {value, 0, 0}, {value, 0, 0});
    for (int before = 0; before <= 7; ++before) add(Reason::visual, {of_width(before), -value, 0}, {});
    for (const std::int32_t near : {0, 1, 3, -15, -63}) {
      add(Reason::visual, {near, 0, 0}, {value, 0, 0});
      for (const std::int32_t before : {0, 2, 30, 63}) add(Reason::haptic, {0, near, 0}, {before, -value, 0});
    }
  }
  return stream.finish().bytes();
}

/// Counts of 1, 8 to 31 and 128 to 521; gaps of 0 to 69, 128 and 512 to 523.
Bytes wide_counts_and_gaps() {
  RawHeader header;
  header.objects.clear();
  for (int i = 0; i < 524; ++i) header.objects.push_back({std::to_string(i), Dof::x});
  Stream stream(header);
  const auto named = [](std::uint32_t first, std::uint32_t count) {
    std::vector<Update> updates;
    for (std::uint32_t i = 0; i < count; ++i) updates.push_back({first + i, Reason::request, 0, {{{-1, 0, 0}}}});
    return updates;
  };
  stream.add({.tick = 0, .updates = named(2, 512), .key = true});
  stream.add({.tick = 1, .updates = named(8, 8)});
  stream.add({.tick = 2, .updates = named(128, 128)});
  for (std::uint32_t i = 0; i < 24; ++i) stream.add({.tick = 3 + i, .updates = named(8 + i, 1)});
  for (std::uint32_t i = 0; i < 12; ++i) stream.add({.tick = 40 + i, .updates = named(512 + i, 1)});
  for (std::uint32_t i = 0; i < 4; ++i) stream.add({.tick = 54 + i, .updates = named(i, 129 + 90 * i)});
  stream.add({.tick = 58, .updates = named(1, 513)});
  stream.add({.tick = 59, .updates = named(0, 521)});
  for (std::uint32_t i = 0; i < 24; ++i) stream.add({.tick = 60 + i, .updates = named(3 * i, 8 + i)});
  return stream.finish().bytes();
}

}  // namespace

void add_rigid_edges(Catalogue& c) {
  c.section(section::kPose);
  c.valid("longest-rotations-multiplied", "Products of the longest rotations there are: a component is beyond +-1.",
          longest_rotations_multiplied());
  c.section(section::kPrediction);
  c.valid("slowest-rotation",
          "An angular velocity so low that its angle is 0: a rotation that is not of length 1 stays as it is.",
          slowest_rotation());
  c.valid("full-circles", "Rotation by a number of full circles: one that is not of length 1 stays as it is.", full_circles());
  c.section(section::kMotion);
  c.valid("haptic-residual-of-45-bits", "A residual beyond 32 bits counts as one of 32 bits where it predicts motion.",
          haptic_residual_of_45_bits());
  c.valid("saturated-angular-velocity",
          "A haptic update predicts an angular velocity beyond 32 bits, and its residual is as large the other way.",
          saturated_angular_velocity());
  c.section(section::kStartModels);
  c.valid("every-residual", "Residuals in every context, of every width up to 15: all rows of their start models.",
          every_residual());
  c.valid("wide-counts-and-gaps", "Packets of 1 to 521 of 524 objects; gaps of 0 to 523.", wide_counts_and_gaps());
}

}  // namespace tactus::conformance
