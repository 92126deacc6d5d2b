// SPDX-License-Identifier: Apache-2.0
/// The hot paths allocate nothing after set-up: every operator new is counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <new>
#include <string>

#include "tests/property/allocated.h"
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

/// Bytes that `action` allocates.
std::uint64_t count_of(auto&& action) {
  const std::uint64_t before = testing::allocated_bytes();
  action();
  return testing::allocated_bytes() - before;
}

TEST(Allocation, TheCounterCounts) {
  EXPECT_EQ(count_of([] { ::operator delete(::operator new(1000)); }), 1000u);  // a new expression may be optimised away
  EXPECT_EQ(count_of([] { ::operator delete(::operator new(1000, std::nothrow)); }), 1000u);
}

TEST(Allocation, EncodeDecodeAndShowAllocateNothing) {
  constexpr std::size_t kObjects = 20;
  for (const Interpolation interpolation : {Interpolation::linear, Interpolation::none, Interpolation::playout}) {
    SceneSpec spec = testing::spec_of(kObjects);
    spec.is_smoothed = interpolation != Interpolation::linear;
    spec.motion = {{0, 0, -1285816}, 321454};
    const SharedScene scene = testing::shared(spec);
    auto sender = Sender::create(scene, {.policy = {.key_interval = 0.2}}).value();
    auto receiver =
        Receiver::create(scene, {.replica = {.interpolation = interpolation}, .limits = testing::kWithThesis}).value();
    std::vector<testing::Motion> motions;
    for (std::size_t i = 0; i < kObjects; ++i) motions.emplace_back(i);
    std::vector<RigidSample> samples(kObjects);
    std::vector<Contact> contacts(2);
    std::uint64_t packets = 0, hash = 0;
    const std::uint64_t counted = count_of([&] {
      for (std::int64_t tick = 0; tick < 1000; ++tick) {
        for (std::size_t i = 0; i < kObjects; ++i) samples[i] = motions[i].step(1e-3);
        contacts[0] = testing::touch(3, samples[3].pose, 0.001);
        contacts[1] = testing::touch(7, samples[7].pose, 0.002);
        if (tick % 97 == 0) sender.request_key();
        const auto sent = sender.encode(tick, {samples, contacts});
        if (!sent) return;
        for (const Packet& packet : *sent) {
          if (!receiver.push(packet.number, packet.bytes, tick)) return;
          ++packets;
        }
        hash ^= receiver.replica().pose_hash(tick);
      }
    });
    EXPECT_EQ(counted, 0u);
    EXPECT_GT(packets, 100u);
    EXPECT_NE(hash, 0u);
  }
}

/// Every substream at once, with acknowledgements, forgotten packets, wrong calls and damaged packets.
TEST(Allocation, ASceneOfSeveralSubstreamsAllocatesNothing) {
  const TriMesh mesh = testing::sheet(6, 6);
  const SharedScene scene = SceneBuilder(60)
                                .rigid("cube")
                                .deformable("waves", mesh, {.basis = testing::wave_basis(mesh, 6, 3)})
                                .deformable("thesis", mesh, {.profile = DeformableProfile::thesis, .models_kept = true})
                                .baselines(4)
                                .build(testing::kWithThesis)
                                .value();
  for (const Baseline baseline : {Baseline::previous, Baseline::acknowledged}) {
    auto sender = Sender::create(scene, {.triggers = {}, .deformable = {}, .policy = {.baseline = baseline}}).value();
    sender.set_link({.ack_timeout = 5, .loss = 0.1});
    const Interpolation interpolation = baseline == Baseline::previous ? Interpolation::none : Interpolation::playout;
    auto receiver = Receiver::create(scene, {.replica = {.interpolation = interpolation}, .limits = {}}).value();
    testing::Motion motion(1);
    testing::DentedSheet sheet(mesh, 6);
    std::vector<testing::SheetFrame> frames;
    for (std::int64_t tick = 0; tick < 300; ++tick) frames.push_back(sheet.frame(tick));
    std::vector<std::uint8_t> damaged(4000);
    std::array<DeformableTruth, 2> shapes;
    std::uint64_t decoded = 0;
    const std::uint64_t counted = count_of([&] {
      for (std::int64_t tick = 0; tick < 300; ++tick) {
        const RigidSample sample = motion.step(1.0 / 60);
        shapes.fill(frames[static_cast<std::size_t>(tick)].truth());
        if (sender.encode(tick - 1, {{&sample, 1}, {}, shapes})) return;
        const auto sent = sender.encode(tick, {{&sample, 1}, {}, shapes});
        if (!sent) return;
        for (const Packet& packet : *sent) {
          std::ranges::copy(packet.bytes, damaged.begin());
          (void)receiver.push(packet.number, std::span(damaged).first(packet.bytes.size() + 9), tick);
          if (tick % 7 == 3) {
            sender.forget_last(packet.substream);
          } else if (receiver.push(packet.number, packet.bytes, tick)) {
            sender.acknowledge(packet.substream, packet.number);
            ++decoded;
          }
        }
        (void)receiver.replica().displacements(0, tick - 10);
        (void)receiver.replica().pose(0, tick - 10);
      }
    });
    EXPECT_EQ(counted, 0u);
    EXPECT_GT(decoded, 300u);
  }
}

/// Objects, contacts, shapes and touches that come and go as held ones.
TEST(Allocation, WhatIsHeldAllocatesNothing) {
  constexpr std::size_t kObjects = 20;
  const TriMesh mesh = testing::sheet(6, 6);
  SceneBuilder builder(60);
  for (std::size_t i = 0; i < kObjects; ++i) builder.rigid("o" + std::to_string(i));
  const SharedScene scene = builder.deformable("sheet", mesh).build().value();
  auto sender = Sender::create(scene).value();
  testing::DentedSheet sheet(mesh, 6);
  std::vector<testing::SheetFrame> frames;
  for (std::int64_t tick = 0; tick < 200; ++tick) frames.push_back(sheet.frame(tick));
  std::vector<testing::Motion> motions;
  for (std::size_t i = 0; i < kObjects; ++i) motions.emplace_back(i);
  std::vector<RigidSample> samples(kObjects);
  std::vector<Contact> contacts(40);
  std::size_t held = 0;
  const std::uint64_t counted = count_of([&] {
    for (std::int64_t tick = 0; tick < 200; ++tick) {
      const auto t = static_cast<std::size_t>(tick);
      for (std::size_t i = 0; i < kObjects; ++i) {
        samples[i] = motions[i].step(1.0 / 60);
        if ((t / 10 + i) % 3 == 0) samples[i].pose.position.x = 1e9;
      }
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        contacts[i] = testing::touch(static_cast<std::uint32_t>(i % kObjects), samples[i % kObjects].pose, 0.001);
        if ((t + i) % 2 == 0) contacts[i].stiffness = 0;
      }
      if (t % 4 == 1) frames[t].displacements[3] = 1e9F;
      DeformableTruth shape = frames[t].truth();
      if (t % 4 == 2) shape.touch = SurfaceTouch{0, -1, 500};
      if (!sender.encode(tick, {samples, contacts, {&shape, 1}})) return;
      held += sender.held().size();
    }
  });
  EXPECT_EQ(counted, 0u);
  EXPECT_GT(held, 4000u);
}

TEST(Allocation, RefusedInputAllocatesNothing) {
  auto receiver = Receiver::create(testing::scene_of(8)).value();
  std::vector<std::uint8_t> noise(300);
  std::mt19937 random(9);
  std::uint64_t refused = 0;
  const std::uint64_t counted = count_of([&] {
    for (std::uint64_t number = 1; number <= 2000; ++number) {
      for (auto& b : noise) b = static_cast<std::uint8_t>(random());
      refused += receiver.push(number, noise) ? 0u : 1u;
    }
  });
  EXPECT_EQ(counted, 0u);
  EXPECT_GT(refused, 1000u);
}

}  // namespace
}  // namespace tactus
