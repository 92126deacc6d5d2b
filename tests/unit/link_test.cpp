// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/link/link.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "tests/property/allocated.h"

namespace tactus::sim {
namespace {

constexpr Microseconds kMillisecond = 1000, kSecond = 1'000'000;

struct Seen {
  std::uint32_t number = 0;
  Microseconds sent = 0, arrived = 0;
};

/// Datagrams of `size` bytes, one per period, until all that arrives has arrived.
struct Passage {
  std::vector<Seen> seen;  // in the order of arrival
  LinkCounters counters;

  std::vector<bool> arrivals(std::size_t count) const {
    std::vector<bool> out(count);
    for (const Seen& s : seen) out[s.number] = true;
    return out;
  }
};

Passage run(const LinkOptions& options, std::size_t count, Microseconds period = kMillisecond, std::size_t size = 40) {
  Link link = Link::create(options).value();
  Passage out;
  std::vector<std::uint8_t> bytes(size);
  const auto drain = [&](Microseconds now) {
    while (const auto arrival = link.poll(now)) {
      std::uint32_t number = 0;
      for (int i = 3; i >= 0; --i) number = number << 8 | arrival->bytes[static_cast<std::size_t>(i)];
      EXPECT_EQ(arrival->bytes.size(), size);
      out.seen.push_back({number, number * period, arrival->time});
    }
  };
  for (std::size_t i = 0; i < count; ++i) {
    for (unsigned k = 0; k < 4; ++k) bytes[k] = static_cast<std::uint8_t>(i >> 8 * k);
    const auto now = static_cast<Microseconds>(i) * period;
    drain(now);
    link.send(now, bytes);
  }
  while (const auto next = link.next()) drain(*next);
  out.counters = link.counters();
  EXPECT_TRUE(std::ranges::is_sorted(out.seen, {}, &Seen::arrived));
  EXPECT_EQ(out.counters.arrived, out.seen.size());
  EXPECT_EQ(out.counters.sent + out.counters.duplicated,
            out.counters.arrived + out.counters.lost + out.counters.cut + out.counters.overflowed);
  return out;
}

std::vector<Microseconds> delays(const Passage& run) {
  std::vector<Microseconds> out;
  for (const Seen& s : run.seen) out.push_back(s.arrived - s.sent);
  return out;
}

/// Largest distance between the empirical and the wanted distribution (Kolmogorov and Smirnov), times the root of the number.
double distance(std::vector<double> values, const std::function<double(double)>& wanted) {
  std::ranges::sort(values);
  double worst = 0;
  const auto n = static_cast<double>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double f = wanted(values[i]);
    worst = std::max({worst, std::abs(f - static_cast<double>(i) / n), std::abs(f - static_cast<double>(i + 1) / n)});
  }
  return worst * std::sqrt(n);
}
constexpr double kOneInTenThousand = 2.23;  // a right sample is farther apart with this chance only

TEST(Link, WithoutOptionsNothingHappens) {
  const Passage got = run({}, 1000);
  ASSERT_EQ(got.seen.size(), 1000u);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(got.seen[i].number, i);
    EXPECT_EQ(got.seen[i].arrived, got.seen[i].sent);
  }
}

TEST(Link, ConstantDelay) {
  Link link = Link::create({.delay = 20 * kMillisecond}).value();
  EXPECT_FALSE(link.next());
  link.send(7, std::vector<std::uint8_t>{1, 2});
  link.send(7, std::vector<std::uint8_t>{3});
  EXPECT_EQ(link.next(), 20'007);
  EXPECT_FALSE(link.poll(20'006));
  EXPECT_EQ(link.poll(30'000)->bytes.size(), 2u);
  const auto second = link.poll(30'000);
  EXPECT_EQ(second->time, 20'007);
  EXPECT_EQ(second->bytes[0], 3);
  EXPECT_FALSE(link.poll(1 << 30));
}

TEST(Link, JitterIsUniformAndReorders) {
  const Passage got = run({.delay = kMillisecond, .jitter = 10 * kMillisecond}, 100'000);
  std::vector<double> values;
  for (const Microseconds d : delays(got)) values.push_back(static_cast<double>(d - kMillisecond));
  EXPECT_LT(distance(values, [](double x) { return x / 10'000; }), kOneInTenThousand);
  EXPECT_GT(got.counters.reordered, 50'000u);
}

/// Mean 20 ms and deviation 10 ms: shape 4, scale 5 ms.
TEST(Link, GammaDelayHoldsForAPieceAndReordersNothingWithin) {
  const Passage got =
      run({.gamma_mean = 20 * kMillisecond, .gamma_deviation = 10 * kMillisecond, .gamma_piece = 10 * kMillisecond}, 500'000);
  std::vector<double> pieces;
  std::vector<Microseconds> of_number(500'000);
  for (const Seen& s : got.seen) of_number[s.number] = s.arrived - s.sent;
  for (std::size_t i = 0; i < of_number.size(); i += 10) {
    for (std::size_t k = 1; k < 10; ++k) ASSERT_EQ(of_number[i + k], of_number[i]);
    pieces.push_back(static_cast<double>(of_number[i]));
  }
  const auto gamma4 = [](double x) {
    const double y = x / 5000;
    return 1 - std::exp(-y) * (1 + y + y * y / 2 + y * y * y / 6);
  };
  EXPECT_LT(distance(pieces, gamma4), kOneInTenThousand);
}

TEST(Link, AShapeBelowOneKeepsMeanAndDeviation) {
  const Passage got =
      run({.gamma_mean = 2 * kMillisecond, .gamma_deviation = 4 * kMillisecond, .gamma_piece = kMillisecond}, 200'000);
  double mean = 0, square = 0;
  for (const Microseconds d : delays(got))
    mean += static_cast<double>(d) / 200'000, square += static_cast<double>(d * d) / 200'000;
  EXPECT_NEAR(mean, 2000, 60);
  EXPECT_NEAR(std::sqrt(square - mean * mean), 4000, 150);
}

TEST(Link, LossesAreIndependentOrInBursts) {
  for (const double burst : {1.0, 5.0}) {
    for (const double loss : {0.01, 0.1, 0.3}) {
      constexpr std::size_t kCount = 400'000;
      const std::vector<bool> arrived = run({.seed = 3, .loss = loss, .burst = burst}, kCount).arrivals(kCount);
      std::size_t lost = 0, runs = 0;
      for (std::size_t i = 0; i < kCount; ++i) {
        if (arrived[i]) continue;
        ++lost;
        if (i == 0 || arrived[i - 1]) ++runs;
      }
      const double deviation = std::sqrt(loss * kCount * (2 * burst - 1));
      EXPECT_NEAR(static_cast<double>(lost), loss * kCount, 4 * deviation) << burst << ' ' << loss;
      const double row = burst > 1 ? burst : 1 / (1 - loss);
      EXPECT_NEAR(static_cast<double>(lost) / static_cast<double>(runs), row, 0.08 * row) << burst << ' ' << loss;
    }
  }
}

TEST(Link, ALossOfAllIsOne) {
  for (const double burst : {1.0, 5.0}) EXPECT_EQ(run({.loss = 1, .burst = burst}, 1000).counters.lost, 1000u) << burst;
}

TEST(Link, OneCauseLeavesTheOthersAsTheyWere) {
  const LinkOptions plain{.seed = 9, .jitter = 5 * kMillisecond, .loss = 0.2};
  LinkOptions more = plain;
  more.duplicates = 0.3;
  more.held_back = 0.1;
  more.held_back_by = 40 * kMillisecond;
  const Passage a = run(plain, 5000), b = run(more, 5000);
  EXPECT_EQ(a.arrivals(5000), b.arrivals(5000));
  EXPECT_EQ(a.counters.lost, b.counters.lost);
  std::vector<Microseconds> first(5000, -1), earliest(5000, -1);
  for (const Seen& s : a.seen) first[s.number] = s.arrived;
  std::size_t moved = 0;
  for (const Seen& s : b.seen)
    if (earliest[s.number] < 0) earliest[s.number] = s.arrived;
  for (std::size_t i = 0; i < 5000; ++i) moved += earliest[i] > first[i] ? 1u : 0u;
  EXPECT_NEAR(static_cast<double>(moved), 0.08 * 5000, 70) << "only what was held back comes later";
  EXPECT_NEAR(static_cast<double>(b.counters.duplicated), 0.3 * 4000, 120);
}

TEST(Link, TheSameSeedGivesTheSameArrivals) {
  LinkOptions options{.seed = 4, .jitter = 3 * kMillisecond, .gamma_mean = 5 * kMillisecond, .gamma_deviation = kMillisecond};
  options.loss = 0.1;
  options.burst = 3;
  options.duplicates = 0.1;
  const auto times = [&] { return delays(run(options, 3000)); };
  const auto first = times();
  EXPECT_EQ(first, times());
  options.seed = 5;
  EXPECT_NE(first, times());
}

/// 100 bytes with their headers take 1 ms at 1.024 Mbit/s.
TEST(Link, ABottleneckDelaysAndItsQueueOverflows) {
  const LinkOptions options{.rate = 1'024'000, .queue = 1280};
  const Passage slow = run(options, 1000, kMillisecond, 100);
  EXPECT_EQ(slow.seen.size(), 1000u);
  for (const Microseconds d : delays(slow)) EXPECT_EQ(d, kMillisecond);
  const Passage fast = run(options, 1000, kMillisecond / 2, 100);
  EXPECT_NEAR(static_cast<double>(fast.seen.size()), 500, 12);
  EXPECT_EQ(std::ranges::max(delays(fast)), 10 * kMillisecond) << "the queue holds ten";
  EXPECT_EQ(fast.counters.overflowed, 1000 - fast.seen.size());
}

/// What is on its way arrives when it would have; counters and draws are those of a new link.
TEST(Link, ThatBeginsAnewLosesNothingThatIsOnItsWay) {
  const LinkOptions other{.seed = 3, .delay = 5 * kMillisecond, .jitter = 4 * kMillisecond, .loss = 0.5};
  Link link = Link::create({.seed = 1, .delay = 30 * kMillisecond}).value(), fresh = Link::create(other).value();
  const std::vector<std::uint8_t> first{1}, second{2};
  link.send(0, first);
  link.send(10 * kMillisecond, second);
  ASSERT_TRUE(link.restart(other, 12 * kMillisecond));
  EXPECT_EQ(link.next(), 18 * kMillisecond);
  for (Microseconds now = kMillisecond; now < kSecond; now += kMillisecond)
    for (Link* one : {&link, &fresh}) one->send(now, first);
  for (std::size_t before = 0; before < 2;) {
    const auto arrival = link.poll(2 * kSecond);
    ASSERT_TRUE(arrival);
    const bool is_old =
        arrival->time == (before == 0 ? 18 : 28) * kMillisecond && link.counters().arrived == fresh.counters().arrived;
    if (is_old) ++before;
    else EXPECT_EQ(fresh.poll(2 * kSecond)->time, arrival->time);
  }
  while (const auto arrival = link.poll(2 * kSecond)) EXPECT_EQ(fresh.poll(2 * kSecond)->time, arrival->time);
  EXPECT_FALSE(fresh.next());
  EXPECT_EQ(link.counters().lost, fresh.counters().lost);
  EXPECT_EQ(link.counters().arrived, fresh.counters().arrived);
  EXPECT_EQ(link.counters().reordered, fresh.counters().reordered);
  EXPECT_FALSE(link.restart({.loss = 2}, 0));
}

TEST(Link, NothingPassesDuringAnOutage) {
  const Passage got =
      run({.delay = 30 * kMillisecond, .outages = {{kSecond, kSecond + 100 * kMillisecond}, {2 * kSecond, 3 * kSecond}}}, 4000);
  EXPECT_EQ(got.counters.cut, 1100u);
  const std::vector<bool> arrived = got.arrivals(4000);
  for (std::size_t i = 0; i < 4000; ++i) EXPECT_EQ(arrived[i], !(i >= 1000 && i < 1100) && !(i >= 2000 && i < 3000)) << i;
}

TEST(Link, ARecordedDelayIsRepeated) {
  const Passage got = run({.recorded = {{0, 5000}, {10'000, 7000}, {20'000, 0}}}, 60);
  for (const Seen& s : got.seen) EXPECT_EQ(s.arrived - s.sent, s.number % 20 < 10 ? 5000 : 7000) << s.number;
}

TEST(Link, OptionsOutsideTheirRangeAreRefused) {
  const auto rule = [](auto change) {
    LinkOptions options;
    change(options);
    const auto link = Link::create(options);
    return std::string(link ? "" : link.error().rule);
  };
  EXPECT_EQ(rule([](LinkOptions&) {}), "");
  const std::vector<std::function<void(LinkOptions&)>> wrong{
      [](auto& o) { o.delay = -1; },
      [](auto& o) { o.jitter = 3'600'000'001; },
      [](auto& o) { o.gamma_deviation = 1; },
      [](auto& o) { o.gamma_piece = 999; },
      [](auto& o) { o.loss = std::nan(""); },
      [](auto& o) { o.loss = 1.01; },
      [](auto& o) { o.loss = 0.9, o.burst = 2; },
      [](auto& o) { o.burst = 0.5; },
      [](auto& o) { o.duplicates = -0.1; },
      [](auto& o) { o.held_back = 2; },
      [](auto& o) { o.held_back_by = -5; },
      [](auto& o) { o.rate = -1; },
      [](auto& o) { o.rate = INFINITY; },
      [](auto& o) {
        o.recorded = {{0, 5}};
      },
      [](auto& o) {
        o.recorded = {{1, 5}, {2, 5}};
      },
      [](auto& o) {
        o.recorded = {{0, 5}, {0, 5}};
      },
      [](auto& o) {
        o.recorded = {{0, -5}, {7, 5}};
      },
      [](auto& o) {
        o.outages = {{5, 5}};
      },
      [](auto& o) {
        o.outages = {{5, 9}, {8, 12}};
      },
  };
  for (std::size_t i = 0; i < wrong.size(); ++i) EXPECT_EQ(rule(wrong[i]), "R-LNK-1") << i;
}

TEST(Link, AllocatesOnlyForMoreThanEverBefore) {
  Link link = Link::create({.delay = 20 * kMillisecond, .jitter = 5 * kMillisecond, .loss = 0.1, .duplicates = 0.1}).value();
  const std::vector<std::uint8_t> bytes(1200);
  Microseconds now = 0;
  const auto step = [&] {
    now += kMillisecond;
    while (link.poll(now)) {
    }
    link.send(now, bytes);
  };
  for (int i = 0; i < 30; ++i) link.send(now, bytes);
  const auto sent = testing::allocated_bytes();
  while (link.poll(kSecond)) {
  }
  EXPECT_EQ(testing::allocated_bytes(), sent) << "arrivals never do";
  now = kSecond;
  for (int i = 0; i < 5000; ++i) step();
  const auto before = testing::allocated_bytes();
  for (int i = 0; i < 1000; ++i) step();
  EXPECT_EQ(testing::allocated_bytes(), before);
}

}  // namespace
}  // namespace tactus::sim
