// SPDX-License-Identifier: Apache-2.0
#include "cli/observe/observed_stream.h"

#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "tests/property/allocated.h"

namespace tactus::cli {
namespace {

TraceFrame make_frame(std::int64_t tick = 0) {
  TraceFrame frame;
  frame.tick = tick;
  frame.objects.resize(2);
  frame.objects[1].pose.position.x = static_cast<double>(tick);
  frame.users.resize(1);
  frame.users[0].force = {0, 0, static_cast<double>(tick)};
  frame.meshes.push_back({false, std::vector<float>(300, static_cast<float>(tick))});
  return frame;
}

TEST(TickQueue, NothingIsKeptWhileNobodyWatches) {
  TickQueue queue(make_frame(), 0, 0);
  queue.offer(make_frame(1), {});
  EXPECT_EQ(queue.front(), nullptr);
  EXPECT_EQ(queue.left_out(), 0u);
}

TEST(TickQueue, TicksComeInOrderWithWhatIsTrue) {
  TickQueue queue(make_frame(), 0, 0);
  queue.begin_watch();
  for (std::int64_t tick = 1; tick <= 3; ++tick) queue.offer(make_frame(tick), {});
  for (std::int64_t tick = 1; tick <= 3; ++tick) {
    ASSERT_NE(queue.front(), nullptr);
    const TraceFrame& frame = queue.front()->frame;
    EXPECT_EQ(frame.tick, tick);
    EXPECT_EQ(frame.objects[1].pose.position.x, static_cast<double>(tick));
    EXPECT_EQ(frame.users[0].force.z, static_cast<double>(tick));
    EXPECT_EQ(frame.meshes[0].updated, tick == 1);  // the first has all shapes
    if (tick == 1) {
      EXPECT_EQ(frame.meshes[0].displacements[299], 1.0f);
    }
    queue.pop();
  }
  EXPECT_EQ(queue.front(), nullptr);
}

TEST(TickQueue, AShapeThatWasLeftOutComesWithTheNextTick) {
  TickQueue queue(make_frame(), 0, 0);
  queue.begin_watch();
  std::int64_t tick = 1;
  for (std::size_t i = 0; i < queue.room(); ++i) queue.offer(make_frame(tick++), {});
  TraceFrame shape = make_frame(tick++);
  shape.meshes[0].updated = true;
  queue.offer(shape, {});  // no room
  EXPECT_EQ(queue.left_out(), 1u);
  queue.pop();
  queue.offer(make_frame(tick), {});
  while (queue.front()->frame.tick != tick) queue.pop();
  EXPECT_TRUE(queue.front()->frame.meshes[0].updated);
  EXPECT_EQ(queue.front()->frame.meshes[0].displacements[0], static_cast<float>(tick));
}

TEST(TickQueue, AnotherWatchBeginsWithAllShapes) {
  TickQueue queue(make_frame(), 0, 0);
  for (int watch = 0; watch < 2; ++watch) {
    queue.begin_watch();
    queue.offer(make_frame(1), {});
    queue.offer(make_frame(2), {});
    EXPECT_TRUE(queue.front()->frame.meshes[0].updated) << watch;
    queue.end_watch();
    queue.offer(make_frame(3), {});
  }
  queue.begin_watch();
  EXPECT_EQ(queue.front(), nullptr);  // what was left of the watch before is gone
}

TEST(TickQueue, LoadsAreCopiedWithTheirPushes) {
  std::vector<Vec3> pushes{{1, 0, 0}, {0, 2, 0}};
  const std::array loads{ObjectLoad{.external = {0, 0, -1}, .hold = {}, .pushes = pushes}};
  TickQueue queue(make_frame(), 1, 2);
  queue.begin_watch();
  queue.offer(make_frame(1), loads);
  pushes.assign(2, {});
  EXPECT_EQ(queue.front()->loads[0].external.z, -1);
  ASSERT_EQ(queue.front()->loads[0].pushes.size(), 2u);
  EXPECT_EQ(queue.front()->loads[0].pushes[1].y, 2);
}

TEST(TickQueue, OfferAllocatesNothing) {
  TickQueue queue(make_frame(), 0, 0);
  queue.begin_watch();
  TraceFrame frame = make_frame(1);
  frame.meshes[0].updated = true;
  frame.changed = std::vector<std::uint32_t>{0};
  const std::uint64_t before = testing::allocated_bytes();
  for (std::size_t i = 0; i <= queue.room(); ++i) queue.offer(frame, {});
  EXPECT_EQ(testing::allocated_bytes(), before);
  EXPECT_EQ(queue.left_out(), 1u);
}

TEST(TickQueue, TwoThreadsLoseAndMixNothing) {
  TickQueue queue(make_frame(), 0, 0);
  queue.begin_watch();
  constexpr std::int64_t kTicks = 20000;
  std::thread server([&queue] {
    for (std::int64_t tick = 1; tick <= kTicks; ++tick) {
      TraceFrame frame = make_frame(tick);
      frame.meshes[0].updated = true;
      queue.offer(frame, {});
    }
  });
  std::uint64_t seen = 0;
  std::int64_t last = 0;
  bool is_whole = true, rises = true;
  const auto take = [&] {
    while (const ObservedTick* tick = queue.front()) {
      rises = rises && tick->frame.tick > last;
      last = tick->frame.tick;
      for (const float u : tick->frame.meshes[0].displacements) is_whole = is_whole && u == static_cast<float>(last);
      ++seen;
      queue.pop();
    }
  };
  while (seen + queue.left_out() < kTicks) take();
  server.join();
  take();
  EXPECT_TRUE(rises);
  EXPECT_TRUE(is_whole);
  EXPECT_EQ(seen + queue.left_out(), static_cast<std::uint64_t>(kTicks));
}

}  // namespace
}  // namespace tactus::cli
