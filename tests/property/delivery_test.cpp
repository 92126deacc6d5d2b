// SPDX-License-Identifier: Apache-2.0
/// Packets lost, repeated and out of order: what is accepted gives the sender's state at that packet, what is not changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include <tactus/receiver.h>
#include "raw_stream.h"

namespace tactus {
namespace {

using conformance::Bytes;
using conformance::RawHeader;

struct Sent {
  Bytes bytes;
  std::uint16_t sequence = 0;
  std::uint32_t baseline = 0;  // packets back; 0: key
  std::int64_t tick = 0;
  std::uint64_t hash = 0;  // of a receiver that lost nothing
};

RawHeader scene(std::uint8_t span) {
  RawHeader header;
  header.baseline_span = span;
  header.objects = {{"a"}, {"wall", Dof::none}, {"b", Dof::translation}, {"c", Dof::rz}};
  return header;
}

std::vector<Sent> send(const RawHeader& header, std::uint64_t seed) {
  conformance::Stream stream(header);
  conformance::Random random(seed);
  auto receiver = Receiver::create(header.parsed()).value();
  std::vector<Sent> out;
  std::int64_t tick = 0;
  std::uint16_t sequence = 65000;  // wraps on the way
  for (std::uint32_t i = 0; i < 10000; ++i, ++sequence) {
    const bool key = i % 20 == 0;
    const std::uint32_t baseline = key ? 0 : 1 + random.below(std::min<std::uint32_t>(i, header.baseline_span));
    conformance::Step step{.tick = tick, .updates = {}, .key = key, .baseline = baseline, .sequence = sequence};
    for (const std::uint32_t object : {0u, 2u, 3u}) {
      if (random.below(2) == 0) step.updates.push_back(random_update(random, stream.header(), object));
    }
    if (step.updates.empty()) step.updates.push_back(random_update(random, stream.header(), 0));
    Bytes bytes = stream.packet(step);
    EXPECT_TRUE(receiver.push(bytes));
    out.push_back({std::move(bytes), sequence, baseline, tick, receiver.state_hash(0)});
    tick += random.below(20);
  }
  return out;
}

/// A third of the packets lost, some repeated, some late.
std::vector<std::size_t> arrivals(std::size_t packets, std::uint64_t seed) {
  conformance::Random random(seed);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < packets; ++i) {
    if (random.below(3) == 0) continue;
    out.push_back(i);
    if (random.below(10) == 0) out.push_back(i - random.below(static_cast<std::uint32_t>(std::min<std::size_t>(i, 3)) + 1));
    if (random.below(5) == 0 && out.size() > 1) std::swap(out.back(), out[out.size() - 2]);
  }
  return out;
}

class Delivery : public ::testing::TestWithParam<int> {};

TEST_P(Delivery, AcceptedPacketsGiveTheSendersState) {
  const RawHeader header = scene(static_cast<std::uint8_t>(GetParam()));
  const std::vector<Sent> sent = send(header, 601);
  auto receiver = Receiver::create(header.parsed()).value();
  std::set<std::size_t> held;  // packets whose states a receiver holds
  int accepted = 0, overtaken = 0, stale = 0, without_baseline = 0;
  for (const std::size_t i : arrivals(sent.size(), 602)) {
    const std::uint64_t before = receiver.state_hash(0);
    const auto decoded = receiver.push(sent[i].bytes);
    const bool late = !held.empty() && i < *held.rbegin();
    if (held.contains(i) || (late && i < *held.begin())) {
      ++stale;
      ASSERT_FALSE(decoded);
      EXPECT_STREQ(decoded.error().rule, "R-PKT-5");
    } else if (sent[i].baseline > 0 && !held.contains(i - sent[i].baseline)) {
      ++without_baseline;
      ASSERT_FALSE(decoded);
      EXPECT_STREQ(decoded.error().rule, "R-PKT-4");
    } else {
      ++accepted;
      overtaken += late ? 1 : 0;
      ASSERT_TRUE(decoded) << decoded.error().rule;
      EXPECT_EQ(decoded->tick, sent[i].tick);
      held.insert(i);
      if (held.size() > header.baseline_span) held.erase(held.begin());
      EXPECT_EQ(receiver.state_hash(0), sent[*held.rbegin()].hash) << "of the newest, whatever came last";
      continue;
    }
    EXPECT_EQ(receiver.state_hash(0), before);
  }
  EXPECT_EQ(overtaken > 10, header.baseline_span > 1) << overtaken;
  EXPECT_GT(accepted, 100);
  EXPECT_GT(stale, 10);
  EXPECT_GT(without_baseline, 10);
}

INSTANTIATE_TEST_SUITE_P(Spans, Delivery, ::testing::Values(1, 2, 5, 16, 64));

}  // namespace
}  // namespace tactus
