// SPDX-License-Identifier: Apache-2.0
/// The hot paths allocate nothing after set-up: every operator new is counted.
#include <gtest/gtest.h>

#include "tests/property/allocated.h"
#include "tests/unit/rigid_fixture.h"

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
}

TEST(Allocation, EncodeDecodeAndShowAllocateNothing) {
  constexpr std::size_t kObjects = 20;
  const StreamHeader header = testing::scene_of(kObjects);
  RigidEncoderOptions options;
  options.key_interval = 0.2;
  auto encoder = RigidEncoder::create(header, options).value();
  auto decoder = RigidDecoder::create(header).value();
  ReplicaOptions smooth;
  smooth.interpolation = Interpolation::linear;
  auto replica = Replica::create(header, smooth).value();
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
      if (tick % 97 == 0) encoder.request_key();
      const auto packet = encoder.encode(tick, samples, contacts);
      if (!packet) return;
      if (!packet->bytes.empty()) {
        const auto decoded = decoder.decode(packet->bytes);
        if (!decoded) return;
        replica.apply(*decoded, decoder.objects(), tick);
        ++packets;
      }
      hash ^= replica.pose_hash(tick);
    }
  });
  EXPECT_EQ(counted, 0u);
  EXPECT_GT(packets, 100u);
  EXPECT_NE(hash, 0u);
}

TEST(Allocation, RefusedInputAllocatesNothing) {
  auto decoder = RigidDecoder::create(testing::scene_of(8)).value();
  std::vector<std::uint8_t> noise(300);
  std::mt19937 random(9);
  std::uint64_t refused = 0;
  const std::uint64_t counted = count_of([&] {
    for (int run = 0; run < 2000; ++run) {
      for (auto& b : noise) b = static_cast<std::uint8_t>(random());
      refused += decoder.decode(noise) ? 0u : 1u;
    }
  });
  EXPECT_EQ(counted, 0u);
  EXPECT_GT(refused, 1000u);
}

}  // namespace
}  // namespace tactus
