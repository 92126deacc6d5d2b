// SPDX-License-Identifier: Apache-2.0
/// What a client shows that looks at every tick 100 ticks later, when packets are missing.
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();

RawHeader of(std::vector<RawObject> objects, std::uint8_t span = 64) {
  RawHeader header{.objects = std::move(objects)};
  header.baseline_span = span;
  return header;
}

Update pushed(std::int32_t i, std::uint32_t object = 0) {
  return {object,
          Reason::visual,
          0,
          {{{900 + i, -500, 40 * i}, {3000 - 700 * i, 20 * i, -700}, {9000, -3000 * i, 800}, {300 * i, -90, 70 * i}}}};
}

/// Packets of one object at these ticks. A negative tick: the packet is lost, and the next one builds on the one before it.
Bytes with_losses(const RawHeader& header, std::initializer_list<std::int64_t> ticks) {
  Stream stream(header);
  std::int32_t i = 0;
  std::uint32_t lost = 0;
  for (const std::int64_t tick : ticks) {
    const Step step{
        .tick = tick, .updates = {pushed(i)}, .key = i == 0, .baseline = 1 + lost, .sequence = static_cast<std::uint16_t>(7 + i)};
    if (tick >= 0) stream.add(step);
    lost = tick >= 0 ? 0 : lost + 1;
    ++i;
  }
  return stream.finish().bytes();
}

/// From the initial state to `first` at tick 5, then over a lost packet to `second` at tick 45.
Bytes one_gap(const RawHeader& header, const Residual& first, const Residual& second) {
  Stream stream(header);
  const auto update = [](const Residual& residual) { return std::vector<Update>{{0, Reason::visual, 0, residual.of}}; };
  stream.add({.tick = 5, .updates = update(first), .key = true});
  stream.add({.tick = 45, .updates = update(second), .baseline = 2, .sequence = std::uint16_t{2}});
  stream.add({.tick = 90, .updates = update({})});
  return stream.finish().bytes();
}

/// Packet 0 leaves everything as it is; 1 and 3 build on it, and 2 between them is lost.
Bytes apart(const RawHeader& header, const Update& first, const Update& second) {
  Stream stream(header);
  stream.add({.tick = 5, .updates = {{0, Reason::visual, 0, {}}}, .key = true});
  stream.add({.tick = 5, .updates = {first}});
  stream.add({.tick = 45, .updates = {second}, .baseline = 3, .sequence = std::uint16_t{3}});
  return stream.finish().bytes();
}

Update pose(unsigned level, const Vec3i& position, const Vec3i& velocity, const Vec3i& rotation, const Vec3i& angular_velocity) {
  return {0, Reason::visual, static_cast<std::uint8_t>(level), {{position, velocity, rotation, angular_velocity}}};
}

/// Near the largest angular velocity for 290 ms.
Bytes fast_spins() {
  Stream stream(of({{"a"}}));
  const auto update = [](const Residual& residual) { return std::vector<Update>{{0, Reason::visual, 0, residual.of}}; };
  stream.add({.tick = 5, .updates = update({{{{}, {}, {}, {33000000, 0, -33000000}}}}), .key = true});
  stream.add({.tick = 295,
              .updates = update({{{{}, {}, {500000, -5000, 99}, {-66000000, 777, 66000000}}}}),
              .baseline = 2,
              .sequence = std::uint16_t{2}});
  return stream.finish().bytes();
}

/// Every object is named by every third packet, every fifth packet is lost.
Bytes several_objects() {
  Stream stream(
      of({{"a"}, {"b", Dof::x | Dof::y}, {"wall", Dof::none}, {"c", Dof::rz}, {"d", Dof::all, {1, 2, 3}, {0, kOne30, 0, 0}}}));
  Random random(540);
  std::int64_t tick = 0;
  for (std::uint32_t i = 0; i < 150; ++i) {
    Step step{
        .tick = tick, .updates = {}, .key = i == 0, .baseline = i % 5 == 4 ? 2u : 1u, .sequence = static_cast<std::uint16_t>(i)};
    for (const std::uint32_t object : {0u, 1u, 3u, 4u})
      if (random.below(3) == 0) step.updates.push_back(random_update(random, stream.header(), object));
    if (step.updates.empty()) step.updates.push_back(random_update(random, stream.header(), 3));
    if (i % 5 != 3) stream.add(step);
    tick += random.below(30) == 0 ? 301 : random.below(25);
  }
  return stream.finish().bytes();
}

Bytes overtaken() {
  Stream stream(of({{"a"}, {"b"}}));
  stream.add({.tick = 5, .updates = {pushed(0, 0), pushed(1, 1)}, .key = true});
  stream.add({.tick = 30, .updates = {pushed(6, 0), pushed(7, 1)}});
  stream.add({.tick = 45, .updates = {pushed(2, 0)}, .baseline = 2, .sequence = std::uint16_t{3}});
  stream.add({.tick = 45, .updates = {pushed(3, 0), pushed(4, 1)}, .baseline = 1, .sequence = std::uint16_t{2}});
  stream.add({.tick = 120, .updates = {pushed(5, 1)}, .baseline = 1, .sequence = std::uint16_t{4}});
  return stream.finish().bytes();
}

/// At one tick, so that a file can hold it: the packet before comes last.
Bytes gap_closed() {
  Stream stream(of({{"a"}, {"b"}}));
  stream.add({.tick = 5, .updates = {pushed(0, 0), pushed(1, 1)}, .key = true});
  stream.add({.tick = 45, .updates = {pushed(2, 0)}, .baseline = 2, .sequence = std::uint16_t{2}});
  stream.add({.tick = 45, .updates = {pushed(3, 1)}, .baseline = 1, .sequence = std::uint16_t{1}});
  stream.add({.tick = 80, .updates = {pushed(4, 0), pushed(5, 1)}, .baseline = 1, .sequence = std::uint16_t{3}});
  return stream.finish().bytes();
}

/// An update at every tick, of which a client holds 64; the first of them are gone before they are shown.
Bytes more_than_it_holds() {
  Stream stream(of({{"a"}}, 1));
  for (std::int32_t i = 0; i < 150; ++i) stream.add({.tick = i, .updates = {pushed(i % 7)}, .key = i == 0});
  return stream.finish().bytes();
}

/// A key packet 40000 ahead: what was known before counts no more.
Bytes restarted() {
  Stream stream(of({{"a"}, {"b"}}));
  stream.add({.tick = 5, .updates = {pushed(0, 0), pushed(1, 1)}, .key = true});
  stream.add({.tick = 25, .updates = {pushed(2, 0)}});
  stream.add({.tick = 60, .updates = {pushed(3, 0)}, .key = true, .sequence = std::uint16_t{40001}});
  stream.add({.tick = 75, .updates = {pushed(4, 1)}, .baseline = 1});
  return stream.finish().bytes();
}

/// Between two updates of one object lie as many packets of another, all of one tick.
Bytes many_between(int packets) {
  Stream stream(of({{"a"}, {"b"}}, 1));
  stream.add({.tick = 5, .updates = {pushed(0, 0), pushed(1, 1)}, .key = true});
  for (int i = 0; i < packets; ++i) stream.add({.tick = 30, .updates = {{1, Reason::visual, 0, {}}}});
  stream.add({.tick = 60, .updates = {pushed(3, 0)}});
  return stream.finish().bytes();
}

Bytes shapes() {
  DeformableStream stream(only({.shape = sheet(4, 3)}, 8));
  Random random(541);
  for (std::int64_t i = 0; i < 14; ++i) {
    const bool lost = i % 5 == 3, after_loss = i % 5 == 4;
    const MainStep step{.at = {.tick = 17 * i + 3, .key = i == 0, .baseline = after_loss ? 2u : 1u},
                        .residuals = random_residuals(random, 5, 60)};
    if (lost) stream.lose(step);
    else stream.add(step);
  }
  return stream.finished();
}

}  // namespace

void add_client_playout(Catalogue& c) {
  const auto playout = [&](const char* name, const char* what, const Bytes& bytes) { c.valid(name, what, bytes, {}, "playout"); };
  c.section(section::kClient);
  c.valid("overtaken", "A packet that was overtaken: of two objects that it names, one has a newer update.", overtaken(), {},
          "linear");
  c.valid("overtaken-none", "The same without interpolation.", overtaken(), {}, "none");
  c.section(section::kPlayout);
  playout("playout-empty", "No packet: the initial state.", Stream(of({{"a"}})).bytes());
  playout("playout-nothing-missing", "Every packet is there: dead reckoning between the updates.",
          with_losses(of({{"a"}}), {3, 40, 90, 150, 151, 500}));
  playout("playout-gaps", "Packets are missing: curves from update to update.",
          with_losses(of({{"a"}}), {3, -1, 40, -1, -1, 90, 150, -1, 151, -1, 152, -1, 300}));
  playout("playout-longest-gap", "Gaps of 300 ticks, over which a curve goes, and of 301, over which none does.",
          with_losses(of({{"a"}}), {3, -1, 303, -1, 604, -1, 904}));
  RawHeader short_extrapolation = of({{"a"}});
  short_extrapolation.max_extrapolation = 50;
  playout("playout-short-extrapolation", "Gaps of max_extrapolation, 50 ticks, and of one more.",
          with_losses(short_extrapolation, {3, -1, 53, -1, 104, -1, 154}));
  RawHeader slow = of({{"a"}});
  slow.tick_rate = 5;
  playout("playout-slow-clock", "At 5 ticks per second 300 ms are 1.5 ticks, rounded up to 2.",
          with_losses(slow, {3, -1, 4, -1, 6, -1, 9, 11}));
  playout("playout-at-rest", "Between updates without velocities: straight lines at constant rate.",
          one_gap(of({{"a"}}), {{{{5000, 0, 3}, {}, {90000, 0, 0}}}}, {{{{-70001, 900, 3}, {}, {1, 400000, -3}}}}));
  playout("playout-same-place", "A gap between two updates of the same state.", one_gap(of({{"a"}}), {}, {}));
  playout("playout-ends-of-the-grid", "From one end of 32 bits to the other.",
          one_gap(of({{"a", Dof::all, {-kLargest, kLargest, 0}}}), {},
                  {{{{kLargest, -kLargest, 1}, {kLargest, -kLargest, kLargest}}}}));
  playout("playout-half-circle", "Half a circle about no axis of the grid.",
          one_gap(of({{"a"}}), {{{{}, {}, {}, {40, 0, 0}}}}, {{{{}, {}, {605395, 605395, -605395}, {-9000, 100, 3}}}}));
  playout("playout-fast-spins", "Several turns between the updates.", fast_spins());
  playout("playout-gap-closed", "The missing packet comes after the one that overtook it.", gap_closed());
  playout("playout-more-than-64", "100 updates are newer than the tick that is shown; a client holds 64.", more_than_it_holds());
  playout("playout-restart", "A restart brings every object back to its initial state.", restarted());
  playout("playout-several-objects", "150 packets for four objects, every fifth lost.", several_objects());
  playout("playout-heard", "Between the updates of one object lie 1023 packets of another, all heard.", many_between(1023));
  playout("playout-forgotten", "The same of 1024: the first of them is 1024 back and counts as missing.", many_between(1024));
  RawHeader fast = of({{"a"}});
  fast.tick_rate = 5000;
  playout("playout-fast-clock", "At 5000 ticks per second a gap of 1500 ticks, and one of 1501.",
          with_losses(fast, {3, -1, 1503, -1, 3004, -1, 3010}));
  playout("playout-stops", "An object that moved and turned has no velocity after the gap.",
          apart(of({{"a"}}), pose(0, {}, {70000, -3, 0}, {}, {0, 0, 90000}), pose(0, {900, 0, 0}, {}, {0, 500, 0}, {})));
  playout("playout-largest-differences", "From one end of 32 bits to the other, and from the largest velocity to the smallest.",
          apart(of({{"a"}}), pose(1, {-kLargest, kLargest, 0}, {-kLargest, kLargest, 0}, {}, {}),
                pose(1, {kLargest, -kLargest, 0}, {kLargest, -kLargest, 0}, {}, {})));
  RawHeader fastest = of({{"a"}});
  fastest.tick_rate = 1000000;
  fastest.grid = {20, 20, 20, 18};
  playout("playout-largest-velocities", "Velocities that differ by more than 32 bits, at 10^6 ticks per second.",
          apart(fastest, pose(1, {}, {-kLargest, kLargest, 0}, {}, {}), pose(1, {}, {kLargest, -kLargest, 0}, {}, {})));
  playout("playout-over-the-end", "A curve that would leave 32 bits.",
          apart(of({{"a"}}), pose(1, {kLargest, -kLargest, 5}, {kLargest, -kLargest, 0}, {}, {}),
                pose(1, {kLargest, -kLargest, 5}, {-kLargest, kLargest, 0}, {}, {})));
  playout("playout-long-way", "The updates are 340 degrees apart: the curve takes the short way.",
          apart(of({{"a"}}), pose(0, {}, {}, {961000, 0, 0}, {}), pose(0, {}, {}, {-961000, 0, 0}, {})));
  playout("playout-half-circle-about-x", "Half a circle: w of the difference is 0.",
          apart(of({{"a"}}), pose(0, {}, {}, {}, {}), pose(0, {}, {}, {kHalfCircle, 0, 0}, {})));
  RawHeader fine = of({{"a"}});
  fine.grid = {22, 17, 28, 20};
  playout("playout-beyond-half-circle", "The way round is chosen by the sign of w, which is -2^-30.",
          apart(fine, pose(0, {}, {}, {(1 << 28) - 2, 0, 0}, {2, 0, 0}), pose(0, {}, {}, {5, 0, 0}, {})));
  RawHeader longer = of({{"a"}});
  longer.objects[0].rotation = {kOne30, 0, 1 << 20, -(1 << 20)};
  playout("playout-longest-half-circle", "Half a circle from a rotation longer than 1: the sine of half the angle is above 1.",
          apart(longer, pose(0, {}, {}, {}, {}), pose(0, {}, {}, {605395, 605395, 605395}, {})));
  playout("playout-shapes", "A deformable object, two packets lost: the newest state kept that is not later.", shapes());
}

}  // namespace tactus::conformance
