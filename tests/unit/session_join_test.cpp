// SPDX-License-Identifier: Apache-2.0
/// A client joins over a line that another one uses.
#include <gtest/gtest.h>

#include "lab/study/join.h"

namespace tactus::sim::study {
namespace {

JoinResult join(const JoinCase& of) { return run_join(of).value(); }

/// 1.3 MB at 10 Mbit/s and 200 ms: the line alone takes 1.1 s, what joins before the first piece 0.4 s, or 0.2 s where the seal has validated
/// the address.
TEST(SessionJoin, FollowsALongFastLine) {
  const JoinCase line{.round_trip = 200'000, .rate = 10e6};
  const JoinResult plain = join(line);
  EXPECT_LT(plain.live, 1.75);
  EXPECT_LT(plain.sent, 1.05) << "hardly any piece goes twice";
  EXPECT_LT(plain.worst, 0.030) << "what another client waits for";
  EXPECT_EQ(plain.lost, 0);
  JoinCase sealed = line;
  sealed.sealed = true;
  EXPECT_LT(join(sealed).live, 1.55);
}

TEST(SessionJoin, LossIsMadeUpForInAFewRoundTrips) {
  double sent = 0;
  for (const std::uint64_t seed : {2u, 3u, 4u}) {
    const JoinResult result = join({.round_trip = 200'000, .rate = 10e6, .loss = 0.1, .seed = seed});
    EXPECT_LT(result.live, 2.6) << seed;
    sent += result.sent / 3;
  }
  EXPECT_LT(sent, 1.25);
}

TEST(SessionJoin, AShortQueueIsNotOverrun) {
  const JoinResult result = join({.round_trip = 40'000, .rate = 10e6, .queue = 20'000});
  EXPECT_LT(result.live, 1.35);
  EXPECT_LT(result.lost, 0.02);
}

TEST(SessionJoin, KeepsToTheRateThatTheUserStates) {
  const JoinResult result = join({.side = 60, .round_trip = 40'000, .rate = 10e6, .limit = 1'000'000});
  EXPECT_GT(result.live, 8e-6 * static_cast<double>(result.declaration));
  EXPECT_LT(result.live, 1.5 * 8e-6 * static_cast<double>(result.declaration));
  EXPECT_LT(result.worst, 0.005);
}

/// 20 kbit/s, of which another client takes some, and one in ten datagrams lost: it takes its time, but is reported all the way.
TEST(SessionJoin, ASlowLineIsEnough) {
  const JoinResult result = join({.side = 40, .round_trip = 40'000, .rate = 20e3, .loss = 0.1, .queue = 1'000'000});
  EXPECT_GT(result.live, 1);
  EXPECT_LT(result.live, 100);
  EXPECT_LT(result.longest_silence, 10);
}

}  // namespace
}  // namespace tactus::sim::study
