// SPDX-License-Identifier: Apache-2.0
#include <tactus/thesis/force_signal.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::uint32_t kRate = 1000;

/// A push, with tremor: rises, holds, swings, and ends.
Vec3 push(std::int64_t tick) {
  const double t = 1e-3 * static_cast<double>(tick);
  if (t < 0.2 || t > 3.5) return {};
  const double f = std::min(3.0, 8 * (t - 0.2)) + 0.2 * std::sin(60 * t);
  return {f * std::cos(0.5 * t), f * std::sin(0.5 * t), 0.1 * f};
}

struct Counts {
  std::size_t samples = 0, bytes = 0;
  double worst = 0;  // error over the deadband
};

Counts run(const ForceCoding& coding) {
  auto sender = ForceSender::create(coding, kRate).value();
  ForceReceiver receiver(kRate);
  Counts out;
  for (std::int64_t tick = 0; tick < 5000; ++tick) {
    const Vec3 force = push(tick);
    const auto sample = sender.encode(tick, force).value();
    if (!sample.empty()) {
      ++out.samples;
      out.bytes += sample.size();
      EXPECT_TRUE(receiver.push(sample));
      EXPECT_EQ(receiver.state(), sender.state());
    }
    const Vec3 shown = receiver.force(tick);
    const double budget = coding.rule == ForceRule::weber ? coding.weber_fraction * std::max(norm(shown), coding.floor)
                                                          : 0.1 * (norm(shown) + 1e-5);
    const double grid = std::ldexp(1, -12);  // half of it on each axis
    out.worst = std::max(out.worst, std::max(0.0, norm(force - shown) - grid) / budget);
  }
  return out;
}

TEST(ForceSignal, TheForceStaysWithinItsDeadband) {
  std::size_t before = 5000;
  for (const double p : {0.02, 0.08, 0.3}) {
    for (const ForcePredictor predictor : {ForcePredictor::hold, ForcePredictor::linear}) {
      const Counts counts = run({.rule = ForceRule::weber, .predictor = predictor, .weber_fraction = p});
      EXPECT_LE(counts.worst, 1) << p;
      EXPECT_GT(counts.samples, 10u);
      if (predictor == ForcePredictor::hold) {
        EXPECT_LT(counts.samples, before) << "a wider deadband costs less";
        before = counts.samples;
      }
    }
  }
}

TEST(ForceSignal, ALineNeedsFewerSamplesForARamp) {
  const auto count = [](ForcePredictor predictor) {
    auto sender = ForceSender::create({.rule = ForceRule::weber, .predictor = predictor, .weber_fraction = 0.05}, kRate).value();
    std::size_t samples = 0;
    for (std::int64_t tick = 0; tick < 1000; ++tick)
      samples += sender.encode(tick, {1 + 2e-3 * static_cast<double>(tick), 0, 0}).value().empty() ? 0u : 1u;
    return samples;
  };
  EXPECT_LT(count(ForcePredictor::linear), count(ForcePredictor::hold));
}

/// The rule of IEEE 1918.1.1, sample by sample: k = 0.1, epsilon 1e-5, hold.
TEST(ForceSignal, Ieee1918) {
  auto sender = ForceSender::create({.rule = ForceRule::ieee1918}, kRate).value();
  const std::vector<std::pair<double, bool>> steps{{0, false},   {1, true},      {1.05, false}, {1.099, false}, {1.11, true},
                                                   {1.0, false}, {0.9985, true}, {0, true},     {0.25, true}};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto sample = sender.encode(static_cast<std::int64_t>(i), {0, steps[i].first, 0}).value();
    EXPECT_EQ(!sample.empty(), steps[i].second) << i;
  }
  const Counts counts = run({.rule = ForceRule::ieee1918});
  EXPECT_LE(counts.worst, 1);
}

TEST(ForceSignal, ForceAtRestCostsNothing) {
  auto sender = ForceSender::create({}, kRate).value();
  for (std::int64_t tick = 0; tick < 100; ++tick) EXPECT_TRUE(sender.encode(tick, {}).value().empty());
  EXPECT_FALSE(sender.encode(100, {0, 0, 2}).value().empty());
  for (std::int64_t tick = 101; tick < 2000; ++tick) EXPECT_TRUE(sender.encode(tick, {0, 0, 2}).value().empty());
}

TEST(ForceSignal, WrongCallsChangeNothing) {
  EXPECT_STREQ(ForceSender::create({.weber_fraction = 0}, kRate).error().rule, "R-API-4");
  EXPECT_STREQ(ForceSender::create({.weber_fraction = std::nan("")}, kRate).error().rule, "R-API-4");
  EXPECT_STREQ(ForceSender::create({.weber_fraction = 1e-3, .floor = 1e-3}, kRate).error().rule, "R-API-4");
  auto sender = ForceSender::create({}, kRate).value();
  ASSERT_TRUE(sender.encode(5, {1, 0, 0}));
  const ForceState before = sender.state();
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_STREQ(sender.encode(6, {infinite, 0, 0}).error().rule, "R-API-1");
  EXPECT_STREQ(sender.encode(6, {5000, 0, 0}).error().rule, "R-API-2");
  EXPECT_STREQ(sender.encode(5, {2, 0, 0}).error().rule, "R-API-5");
  EXPECT_EQ(sender.state(), before);
  EXPECT_TRUE(sender.encode(6, {2, 0, 0}));
}

TEST(ForceSignal, DamagedSamplesAreRefused) {
  auto sender = ForceSender::create({.predictor = ForcePredictor::linear}, kRate).value();
  Bytes last;
  for (std::int64_t tick = 0; tick < 300; ++tick)
    if (const auto sample = sender.encode(tick, push(tick)).value(); !sample.empty()) last.assign(sample.begin(), sample.end());
  ASSERT_GT(last.size(), 6u);
  const auto rule_of = [](const Bytes& bytes) {
    ForceReceiver receiver(kRate);
    const auto pushed = receiver.push(bytes);
    return std::string(pushed ? "" : pushed.error().rule);
  };
  EXPECT_EQ(rule_of(last), "");
  for (std::size_t size = 0; size < last.size(); ++size)
    EXPECT_EQ(rule_of(Bytes(last.begin(), last.begin() + static_cast<std::ptrdiff_t>(size))), "R-FRC-1");
  Bytes longer = last;
  longer.push_back(0);
  EXPECT_EQ(rule_of(longer), "R-FRC-1");
  EXPECT_EQ(rule_of({3, 0, 0, 0, 0, 0, 0}), "R-FRC-1") << "a slope of nothing";
  EXPECT_EQ(rule_of({2, 0x82, 0x80, 0x80, 0x10, 0, 0}), "R-FRC-2") << "beyond 4096 N";
  EXPECT_EQ(rule_of({0xfe, 0xff, 0xff, 0xff, 0x1f, 0, 0, 0}), "R-FRC-2") << "no tick";
  ForceReceiver receiver(kRate);
  ASSERT_TRUE(receiver.push(Bytes{20, 2, 0, 0}));
  EXPECT_STREQ(receiver.push(Bytes{20, 4, 0, 0}).error().rule, "R-FRC-3");
  EXPECT_STREQ(receiver.push(Bytes{18, 4, 0, 0}).error().rule, "R-FRC-3");
  std::mt19937_64 random(1);
  for (int run = 0; run < 100000; ++run) {
    Bytes bytes(random() % 20);
    for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
    ForceReceiver fresh(kRate);
    static_cast<void>(fresh.push(bytes));
    EXPECT_TRUE(is_finite(fresh.force(1000)));
  }
}

}  // namespace
}  // namespace tactus
