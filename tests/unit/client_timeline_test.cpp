// SPDX-License-Identifier: Apache-2.0
#include <tactus/client/replica.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <span>
#include <vector>

namespace tactus {
namespace {

Timeline::Update update(std::int64_t tick, std::uint64_t number) {
  Timeline::Update out{number, {}};
  out.state.tick = tick;
  return out;
}

TEST(Timeline, BeginsWithTheInitialState) {
  Timeline timeline;
  RigidState initial;
  initial.position = {1, 2, 3};
  timeline.reset(initial);
  for (const std::int64_t tick : {-5, 0, 1000}) {
    EXPECT_EQ(timeline.around(tick).before.state, initial);
    EXPECT_EQ(timeline.around(tick).before.number, 0u);
    EXPECT_EQ(timeline.around(tick).after, nullptr);
  }
}

TEST(Timeline, OrderOfArrivalDoesNotMatter) {
  std::vector<Timeline::Update> updates{update(0, 0)};
  for (std::uint64_t i = 1; i <= 200; ++i) updates.push_back(update(static_cast<std::int64_t>(i / 3 * 7), i));
  std::mt19937_64 random(1);
  for (int round = 0; round < 20; ++round) {
    Timeline timeline;
    timeline.reset({});
    std::vector<Timeline::Update> shuffled(updates.begin() + 1, updates.end());
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    for (const Timeline::Update& u : shuffled) timeline.add(u);
    const std::span held = std::span(updates).last(Timeline::kMost);
    for (std::int64_t tick = -1; tick < 480; ++tick) {
      const auto after = std::ranges::find_if(held, [&](const auto& u) { return u.state.tick > tick; });
      const auto [before, next] = timeline.around(tick);
      EXPECT_EQ(before.number, after == held.begin() ? held.front().number : (after - 1)->number) << tick;
      const auto following = after == held.begin() ? after + 1 : after;  // before all: the first is shown, at its own tick
      EXPECT_EQ(next == nullptr ? 0 : next->number, following == held.end() ? 0 : following->number) << tick;
    }
  }
}

TEST(HeardPackets, KnowsTheNewestThousand) {
  HeardPackets heard;
  for (std::uint64_t number = 70000; number < 73000; ++number)
    if (number % 500 != 7) heard.add(number);
  EXPECT_TRUE(heard.all_between(72508, 72999));
  EXPECT_TRUE(heard.all_between(72507, 72999)) << "the ends do not count";
  EXPECT_FALSE(heard.all_between(72506, 72999));
  EXPECT_TRUE(heard.all_between(72500, 72501)) << "nothing is between";
  EXPECT_FALSE(heard.all_between(72500, 72508));
  heard.add(72507);
  EXPECT_TRUE(heard.all_between(72500, 72999)) << "an overtaken packet";
  heard.add(72007);
  EXPECT_TRUE(heard.all_between(71975, 72999)) << "the oldest heard is 1023 back";
  EXPECT_FALSE(heard.all_between(71974, 72999));
  heard.add(71000);
  EXPECT_FALSE(heard.all_between(70999, 71001)) << "too long ago";
  heard.add(100000);
  EXPECT_FALSE(heard.all_between(99990, 100000));
  heard.reset();
  EXPECT_FALSE(heard.all_between(99999, 100001));
}

}  // namespace
}  // namespace tactus
