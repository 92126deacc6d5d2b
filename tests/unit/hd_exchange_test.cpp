// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/openhaptics/hd_runtime.h>

#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include <tactus/device/real_time.h>

namespace tactus::device::openhaptics {
namespace {

RawSample sample_of_number(std::uint64_t number) {
  RawSample out;
  out.position.fill(static_cast<double>(number));
  out.velocity.fill(static_cast<double>(number));
  out.transform.fill(static_cast<double>(number));
  out.buttons = static_cast<std::uint32_t>(number);
  out.taken = static_cast<Time>(number);
  return out;
}

Time soon() { return monotonic_clock().now() + kAnswerTime; }

TEST(SampleRing, HandsEachOutOnceAndInOrder) {
  SampleRing ring;
  for (std::uint64_t i = 0; i < SampleRing::kSlots; ++i) ring.put(sample_of_number(i));
  for (std::uint64_t i = 0; i < SampleRing::kSlots; ++i) {
    const auto taken = ring.take(soon());
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->sample.taken, static_cast<Time>(i));
    EXPECT_EQ(taken->sample.transform[15], static_cast<double>(i));
    EXPECT_EQ(taken->lost, 0U);
  }
  EXPECT_FALSE(ring.take(monotonic_clock().now() + kMillisecond));
}

TEST(SampleRing, TheOldestAreLostAndCounted) {
  SampleRing ring;
  for (std::uint64_t i = 0; i < SampleRing::kSlots + 5; ++i) ring.put(sample_of_number(i));
  const auto taken = ring.take(soon());
  EXPECT_EQ(taken->sample.taken, 5);
  EXPECT_EQ(taken->lost, 5U);
  EXPECT_EQ(ring.take(soon())->lost, 0U);
}

TEST(SampleRing, NothingIsTornWhileAnotherThreadWrites) {
  constexpr std::uint64_t kSamples = 300'000;
  SampleRing ring;
  std::thread writer([&] {
    for (std::uint64_t i = 0; i < kSamples; ++i) ring.put(sample_of_number(i));
    ring.end();
  });
  std::uint64_t taken = 0, lost = 0;
  Time last = -1;
  while (const auto one = ring.take(soon())) {
    ++taken;
    lost += one->lost;
    EXPECT_GT(one->sample.taken, last);
    last = one->sample.taken;
    const auto number = static_cast<double>(last);
    EXPECT_TRUE(one->sample.position[0] == number && one->sample.velocity[1] == number && one->sample.transform[15] == number &&
                one->sample.buttons == static_cast<std::uint32_t>(last));
  }
  writer.join();
  EXPECT_EQ(taken + lost, kSamples);
}

TEST(ForceBox, AForceFadesWhenNoNewOneComes) {
  ForceBox box;
  EXPECT_EQ(box.get(kMillisecond), Vec3{});
  box.put({0, 0, 2}, 0);
  for (Time age = 0; age <= 30 * kMillisecond; age += kMillisecond) {
    const double left =
        age <= 10 * kMillisecond ? 2 : std::max(0.0, 2 * (1 - static_cast<double>(age - 10 * kMillisecond) / 1e7));
    EXPECT_NEAR(box.get(age).z, left, 1e-12) << age;
  }
}

TEST(ForceBox, AHaltLastsUntilTheNextForce) {
  ForceBox box;
  box.put({1, 2, 3}, 0);
  box.halt();
  EXPECT_EQ(box.get(0), Vec3{});
  box.put({1, 2, 3}, 0);
  EXPECT_EQ(box.get(0), (Vec3{1, 2, 3}));
}

TEST(ForceBox, NothingIsTornWhileAnotherThreadWrites) {
  ForceBox box;
  std::atomic<bool> ends{false};
  std::thread writer([&] {
    for (int i = 1; i < 300'000; ++i) box.put({1.0 * i, 2.0 * i, 3.0 * i}, 0);
    ends = true;
  });
  while (!ends) {
    const Vec3 force = box.get(0);
    EXPECT_TRUE(force.y == 2 * force.x && force.z == 3 * force.x);
  }
  writer.join();
}

}  // namespace
}  // namespace tactus::device::openhaptics
