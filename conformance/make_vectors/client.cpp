// SPDX-License-Identifier: Apache-2.0
/// What a client shows. Every tick from 0 to the last packet's is looked at.
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
constexpr std::int32_t kSmallest = std::numeric_limits<std::int32_t>::min();

RawHeader cube(std::uint32_t tick_rate = 1000) {
  RawHeader header;
  header.tick_rate = tick_rate;
  return header;
}

Bytes still_object() {
  Stream stream(cube());
  stream.add({.tick = 0, .updates = {{0, Reason::visual, 2, {{{70, 80, 90}}}}}, .key = true});
  for (std::int64_t tick = 1000; tick <= 3000; tick += 1000)
    stream.add({.tick = tick, .updates = {{0, Reason::heartbeat, 0, {}}}});
  return stream.finish().bytes();
}

Bytes wide_rotations() {
  Stream stream(cube());
  const auto turn = [](Vec3i residual) { return std::vector<Update>{{0, Reason::visual, 0, {{{}, {}, residual, {}}}}}; };
  stream.add({.tick = 0, .updates = turn({kHalfCircle, 0, 0}), .key = true});
  std::int64_t tick = 0;
  for (const Vec3i& half : {Vec3i{0, kHalfCircle, 0}, Vec3i{kHalfCircle - 1, 0, 0}, Vec3i{0, 0, -kHalfCircle},
                            Vec3i{605395, 605395, -605395}, Vec3i{1, 0, 0}, Vec3i{}}) {
    stream.add({.tick = tick += 60, .updates = turn(half)});
  }
  stream.add({.tick = tick + 60, .updates = turn({})});
  return stream.finish().bytes();
}

Bytes ends_of_the_grid() {
  RawHeader header;
  header.objects = {{"p", Dof::translation, {kSmallest, kLargest, 0}}};
  Stream stream(header);
  const auto to = [](Vec3i position) { return std::vector<Update>{{0, Reason::visual, 0, {{position}}}}; };
  stream.add({.tick = 0, .updates = to({0, 0, 0}), .key = true});
  stream.add({.tick = 40, .updates = to({kLargest, -kLargest, kLargest})});
  stream.add({.tick = 80, .updates = {{0, Reason::visual, 1, {{{kLargest, -kLargest, 0}}}}}});
  stream.add({.tick = 160, .updates = to({0, 0, 0})});
  return stream.finish().bytes();
}

/// Neither the key packet nor the older baselines name object b: its decoded state goes back, its shown one does not.
Bytes unnamed_objects() {
  RawHeader header;
  header.baseline_span = 4;
  header.objects = {{"a"}, {"wall", Dof::none}, {"b", Dof::all, {4000, 0, 0}}};
  Stream stream(header);
  Random random(508);
  const auto update = [&](std::uint32_t object) { return random_update(random, stream.header(), object); };
  stream.add({.tick = 0, .updates = {update(0), update(2)}, .key = true});
  stream.add({.tick = 20, .updates = {update(2)}});
  stream.add({.tick = 50, .updates = {update(0)}, .key = true});
  stream.add({.tick = 80, .updates = {update(0)}, .baseline = 2});
  stream.add({.tick = 90, .updates = {update(2)}, .baseline = 4});
  stream.add({.tick = 130, .updates = {update(0), update(2)}, .baseline = 2});
  stream.add({.tick = 200, .updates = {update(0)}});
  return stream.finish().bytes();
}

Bytes several_objects(std::uint64_t seed) {
  RawHeader header;
  header.max_extrapolation = 100;
  header.objects = {
      {"a"}, {"b", Dof::x | Dof::y}, {"wall", Dof::none}, {"c", Dof::rz}, {"d", Dof::all, {1, 2, 3}, {0, kOne30, 0, 0}}};
  Stream stream(header);
  Random random(seed);
  std::int64_t tick = 0;
  for (int i = 0; i < 120; ++i) {
    Step step{.tick = tick, .updates = {}, .key = i == 0};
    for (const std::uint32_t object : {0u, 1u, 3u, 4u}) {
      if (random.below(3) == 0) step.updates.push_back(random_update(random, stream.header(), object));
    }
    if (step.updates.empty()) step.updates.push_back(random_update(random, stream.header(), 3));
    stream.add(step);
    tick += random.below(8) == 0 ? 150 : random.below(40);
  }
  return stream.finish().bytes();
}

/// Two updates at the given ticks, the second one far away; then a third one `shown` ticks later.
Bytes far_step(std::uint32_t tick_rate, std::int64_t gap, std::int64_t shown) {
  RawHeader header = cube(tick_rate);
  header.objects = {{"p", Dof::translation}};
  Stream stream(header);
  stream.add({.tick = 0, .key = true});
  stream.add({.tick = gap, .updates = {{0, Reason::visual, 0, {{{1 << 30, -(1 << 29), 77777}, {3000, 0, -20}}}}}});
  stream.add({.tick = gap + shown});
  return stream.finish().bytes();
}

/// From the longest rotation there is by half a circle about no axis of the grid.
Bytes longest_half_circle() {
  RawHeader header = cube();
  header.objects[0].rotation = {kOne30, 0, 1 << 20, -(1 << 20)};
  Stream stream(header);
  stream.add({.tick = 0, .key = true});
  stream.add({.tick = 40, .updates = {{0, Reason::visual, 0, {{{}, {}, {605395, 605395, 605395}, {}}}}}});
  stream.add({.tick = 80});
  return stream.finish().bytes();
}

/// The residual rotates by -48 x 2^-30, the angular velocity by 49 until the interpolation ends.
Bytes smallest_rotation() {
  RawHeader header = cube();
  header.grid = {22, 17, 28, 20};
  Stream stream(header);
  stream.add({.tick = 0, .key = true});
  stream.add({.tick = 40, .updates = {{0, Reason::visual, 0, {{{}, {}, {-6, 0, 0}, {3, 0, 0}}}}}});
  stream.add({.tick = 80});
  return stream.finish().bytes();
}

/// A line from a rotation longer than 1 to the same one.
Bytes line_without_rotation() {
  RawHeader header = cube();
  header.objects[0].rotation = {kOne30, 0, 1 << 20, -(1 << 20)};
  Stream stream(header);
  stream.add({.tick = 0, .key = true});
  stream.add({.tick = 40, .updates = {{0, Reason::visual, 0, {{{9000, 0, -70}}}}}});
  stream.add({.tick = 80});
  return stream.finish().bytes();
}

/// A little less than half a circle, and an angular velocity that goes on until the difference has w = -2^-30.
Bytes beyond_half_circle() {
  RawHeader header = cube();
  header.grid = {22, 17, 28, 20};
  Stream stream(header);
  stream.add({.tick = 0, .key = true});
  stream.add({.tick = 40, .updates = {{0, Reason::visual, 0, {{{}, {}, {(1 << 28) - 12, 0, 0}, {3, 0, 0}}}}}});
  stream.add({.tick = 80});
  return stream.finish().bytes();
}

}  // namespace

void add_client(Catalogue& c) {
  const auto linear = [&](const char* name, const char* what, const Bytes& bytes) { c.valid(name, what, bytes, {}, "linear"); };
  const auto none = [&](const char* name, const char* what, const Bytes& bytes) { c.valid(name, what, bytes, {}, "none"); };
  c.section(section::kClient);
  none("empty", "No packet: the initial state is shown at tick 0.", Stream(cube()).bytes());
  none("none", "Updates are applied at once.", updated_at(cube(), {3, 40, 90, 150, 151}));
  linear("linear", "Straight lines and slerps towards the predicted state.", updated_at(cube(), {3, 40, 90, 150, 260}));
  linear("first-update", "One update: no gap is known, it is applied at once.", updated_at(cube(), {25}));
  linear("second-update", "Two updates: one gap is known.", updated_at(cube(), {25, 65, 65 + 200}));
  linear("aborted", "Updates during an interpolation end it and are applied at once.",
         updated_at(cube(), {0, 100, 130, 140, 300, 374, 520, 600}));
  linear("at-the-end", "Updates one tick before an interpolation ends, and at the tick where one ends.",
         updated_at(cube(), {0, 40, 40 + 29, 200, 250, 400}));
  linear("shortest", "Gaps of a tick: t_N is 5 ms.", updated_at(cube(), {0, 1, 2, 9, 10, 20}));
  linear("longest", "Gaps of a second: t_N is 100 ms.", updated_at(cube(), {0, 1000, 2000, 2099, 3000, 3100, 3500}));
  linear("more-than-five-gaps", "Only the newest five gaps count.",
         updated_at(cube(), {0, 400, 800, 850, 900, 950, 1000, 1050, 1100, 1180, 1300}));
  linear("same-tick", "Two updates at one tick: a gap of 0.", updated_at(cube(), {7, 7, 60, 60, 200}));
  linear("same-tick-60-hz", "Gaps of 0 where the shortest t_N rounds to 0 ticks.", updated_at(cube(60), {1, 1, 1, 3, 20}));
  linear("rounded-limits", "At 100 ticks per second the shortest t_N, half a tick, rounds up to 1: a gap of 0, then more.",
         updated_at(cube(100), {1, 1, 2, 3, 30, 90}));
  linear("heartbeat-only", "An object at rest that is only confirmed.", still_object());
  none("heartbeat-only-none", "The same without interpolation.", still_object());
  c.section(section::kShownPose);
  linear("wide-rotations", "Rotations by half a circle and by next to nothing; quaternions of both signs.", wide_rotations());
  linear("ends-of-the-grid", "A line from one end of 32 bits to the other.", ends_of_the_grid());
  c.section(section::kClient);
  linear("unnamed-objects", "Packets on older baselines: what they do not name is shown as before.", unnamed_objects());
  none("unnamed-objects-none", "The same without interpolation.", unnamed_objects());
  linear("several-objects", "120 packets for four objects, some beyond the extrapolation limit.", several_objects(520));
  none("several-objects-none", "The same without interpolation.", several_objects(520));
  linear("longest-rounded", "At 1005 ticks per second the longest t_N, 100.5 ticks, rounds up to 101.", far_step(1005, 400, 110));
  linear("share-by-a-long-gap", "A gap of 16387 ticks, of which 75 % are 12290.25.", far_step(125000, 16387, 200));
  c.section(section::kShownPose);
  linear("longest-half-circle", "Half a circle from a rotation longer than 1: the sine of half the angle is above 1.",
         longest_half_circle());
  linear("line-without-rotation", "A line without a rotation: one that is not of length 1 stays as it is.",
         line_without_rotation());
  linear("beyond-half-circle", "The way round is chosen by the sign of w, which is -2^-30.", beyond_half_circle());
  linear("smallest-rotation", "An interpolated rotation whose sine is 2^-30.", smallest_rotation());
  c.section(section::kClient);
  linear("shortest-of-fast-clock", "At 100000 ticks per second the shortest t_N is 500 ticks.", far_step(100000, 3, 510));
  linear("longest-of-fast-clock", "At 6000 ticks per second the longest t_N is 600 ticks.", far_step(6000, 2000, 620));
}

}  // namespace tactus::conformance
