// SPDX-License-Identifier: Apache-2.0
// The study of `tactus bench signals` finds what is known of made-up signals.
#include "lab/study/signals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::sim::study {
namespace {

TraceInfo recording(std::uint32_t tick_rate) {
  TraceInfo info;
  info.tick_rate = tick_rate;
  info.users = {{"still"}, {"hand"}};
  return info;
}

/// The second user circles; from the second second on it touches a wall, and feels a force that grows.
TraceFrame frame_at(std::int64_t tick, std::uint32_t tick_rate) {
  const double t = static_cast<double>(tick) / tick_rate, angle = 2 * std::numbers::pi * t;
  TraceFrame out{.tick = tick, .objects = {}, .users = std::vector<UserSample>(2)};
  UserSample& hand = out.users[1];
  hand.device.position = {0.05 * std::cos(angle), 0.05 * std::sin(angle), 0};
  if (t < 1) return out;
  hand.server_force = {0, 0, t};
  hand.surface_contact = SurfaceContact{.proxy = hand.device.position + Vec3{0, 0, 2e-3}, .stiffness = 500};
  return out;
}

const SignalResult& find(const std::vector<SignalResult>& results, Signal signal, const std::string& name) {
  const auto found = std::ranges::find_if(results, [&](const auto& r) { return r.signal == signal && r.name == name; });
  EXPECT_NE(found, results.end()) << name;
  return *found;
}

TEST(SignalStudy, EveryBoundIsKeptAndEveryRateCounted) {
  for (const std::uint32_t rate : {500u, 1000u}) {
    auto study = SignalStudy::create(recording(rate)).value();
    for (std::int64_t tick = 0; tick < 3 * rate; ++tick) ASSERT_TRUE(study.add(frame_at(tick, rate)));
    const auto results = study.results();
    for (const SignalResult& r : results) {
      EXPECT_EQ(r.user, 1u) << "the other one neither moves nor feels";
      EXPECT_EQ(r.samples, 3 * rate);
      EXPECT_EQ(r.over, 0u) << r.name;
      EXPECT_LE(r.worst, 1) << r.name;
      EXPECT_LE(r.rms, r.largest);
      EXPECT_GT(r.bytes, 3 * r.packets);
    }
    EXPECT_EQ(find(results, Signal::device, "every sample").packets, 3 * rate);
    std::uint64_t before = 3 * rate;
    for (const char* name : {"0.1 mm", "0.3 mm", "1 mm", "3 mm"}) {
      const SignalResult& r = find(results, Signal::device, name);
      EXPECT_LT(r.packets, before) << name;
      EXPECT_GT(r.worst, 0.7) << "the bound is used";
      before = r.packets;
    }
    // On a circle the line leaves the bound e after the time sqrt(2 e / a); the velocity lags by half of its window.
    EXPECT_NEAR(static_cast<double>(find(results, Signal::device, "1 mm").packets), 3 * std::sqrt(1.97 / 2e-3), 15);
    EXPECT_GT(find(results, Signal::contact, "2 %, 0.5 mm").packets, find(results, Signal::contact, "20 %, 0.5 mm").packets);
    // From 1 to 3 N in steps of p: log 3 / log (1 + p).
    const std::uint64_t held = find(results, Signal::force, "4 %, hold").packets;
    EXPECT_NEAR(static_cast<double>(held), std::log(3) / std::log(1.04), 2);
    EXPECT_LT(find(results, Signal::force, "4 %, linear").packets, held) << "it grows linearly";
    EXPECT_NEAR(static_cast<double>(find(results, Signal::force, "IEEE 1918.1.1").packets), std::log(3) / std::log(1.1), 2);
  }
}

TEST(SignalStudy, WhatARecordingLacksIsLeftOut) {
  auto study = SignalStudy::create(recording(100)).value();
  for (std::int64_t tick = 0; tick < 100; ++tick) ASSERT_TRUE(study.add(frame_at(tick, 100)));  // no contact yet
  for (const SignalResult& r : study.results()) EXPECT_EQ(r.signal, Signal::device) << r.name;
  TraceFrame wrong = frame_at(100, 100);
  wrong.users[1].device.position.x = NAN;
  EXPECT_FALSE(study.add(wrong));
  EXPECT_TRUE(
      SignalStudy::create({.tick_rate = 100, .objects = {}, .users = {}, .source = {}, .scene = {}}).value().results().empty());
}

}  // namespace
}  // namespace tactus::sim::study
