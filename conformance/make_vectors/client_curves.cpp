// SPDX-License-Identifier: Apache-2.0
/// What a client shows that smooths on cubics. Every tick from 0 to the last packet's is looked at.
#include <array>
#include <limits>
#include <string>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

using Residual = std::array<Vec3i, kQuantities>;

constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();

/// An update at tick 0 and one after `gap` ticks, whose curve is shown for `shown` ticks.
Bytes one_curve(const RawHeader& header, std::int64_t gap, const Residual& first, const Residual& second, std::int64_t shown) {
  Stream stream(header);
  stream.add({.tick = 0, .updates = {{0, Reason::visual, 0, first}}, .key = true});
  stream.add({.tick = gap, .updates = {{0, Reason::visual, 0, second}}});
  stream.add({.tick = gap + shown});
  return stream.finish().bytes();
}

Bytes several_objects() {
  RawHeader header;
  header.max_extrapolation = 100;
  header.objects = {
      {"a"}, {"b", Dof::x | Dof::y}, {"wall", Dof::none}, {"c", Dof::rz}, {"d", Dof::all, {1, 2, 3}, {0, kOne30, 0, 0}}};
  Stream stream(header);
  Random random(560);
  std::int64_t tick = 0;
  for (int i = 0; i < 120; ++i) {
    Step step{.tick = tick, .updates = {}, .key = i == 0};
    for (const std::uint32_t object : {0u, 1u, 3u, 4u})
      if (random.below(3) == 0) step.updates.push_back(random_update(random, stream.header(), object));
    if (step.updates.empty()) step.updates.push_back(random_update(random, stream.header(), 3));
    stream.add(step);
    tick += random.below(8) == 0 ? 150 : random.below(40);
  }
  return stream.finish().bytes();
}

}  // namespace

void add_client_curves(Catalogue& c) {
  const auto both = [&](const std::string& name, const std::string& what, const Bytes& bytes) {
    c.valid("hermite-" + name, what + " Hermite curves.", bytes, {}, "hermite");
    c.valid("blending-" + name, what + " Projective velocity blending.", bytes, {}, "blending");
  };
  c.section(section::kShownPose);
  both("curves", "From motion to motion.", updated_at({}, {3, 40, 90, 150, 260}));
  both("aborted", "Updates during an interpolation end it and are applied at once.",
       updated_at({}, {0, 100, 130, 140, 300, 374, 520, 600}));
  RawHeader short_extrapolation;
  short_extrapolation.max_extrapolation = 40;
  both("from-rest", "Updates when dead reckoning has just ended, and one tick before: the old velocity is 0, or it is not.",
       updated_at(short_extrapolation, {3, 43, 83, 122, 162, 201, 300}));
  both("same-tick", "Two updates at one tick: a gap of 0.", updated_at({}, {7, 7, 60, 60, 200}));
  both("several-objects", "120 packets for four objects, some beyond the extrapolation limit.", several_objects());
  both("ends-of-the-grid", "From one end of 32 bits to the other, and from the largest velocity to the smallest.",
       one_curve({}, 40, {{{-kLargest, kLargest, 0}, {-kLargest, kLargest, 0}}},
                 {{{kLargest, -kLargest, 1}, {kLargest, -kLargest, kLargest}}}, 60));
  RawHeader fastest;
  fastest.tick_rate = 1000000;
  fastest.grid = {22, 10, 20, 12};
  both("largest-change", "At 10^6 ticks per second 750 ticks of the largest difference of velocities.",
       one_curve(fastest, 1000, {{{}, {-kLargest, kLargest, 0}}}, {{{}, {kLargest, -kLargest, kLargest}}}, 6000));
  both("fast-spins", "Near the largest angular velocities, of opposite signs.",
       one_curve({}, 40, {{{}, {}, {}, {33000000, 0, -33000000}}}, {{{}, {}, {500000, -5000, 99}, {-66000000, 777, 66000000}}},
                 60));
}

}  // namespace tactus::conformance
