// SPDX-License-Identifier: Apache-2.0
/// Packets of deformable objects that nobody acknowledges go again, made anew.
#include <tactus/sender.h>

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <vector>

#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

constexpr std::uint32_t kSquares = 4;

/// A sheet that lies 10 mm off its rest, moves by as much at tick 1 and stays there.
class MovedOnce {
 public:
  explicit MovedOnce(Baseline baseline) {
    SceneSpec spec = testing::sheet_spec(mesh_);
    spec.baseline_span = 8;
    scene_ = testing::shared(std::move(spec));
    SenderOptions options;
    options.policy.key_interval = 0;
    options.policy.baseline = baseline;
    sender = Sender::create(scene_, options).value();
    receiver = Receiver::create(scene_).value();
  }

  Packet step() {
    const std::vector<float> shape = testing::moved_by(mesh_.vertices.size(), {0, 0, tick_ == 0 ? 0.01 : 0.02});
    const DeformableTruth truth{.displacements = shape, .touch = {}};
    return testing::only(sender->encode(tick_++, {.deformables = {&truth, 1}}));
  }
  /// Ticks at which packets go until `end`; none of them arrives.
  std::vector<std::int64_t> lose_until(std::int64_t end) {
    std::vector<std::int64_t> out;
    while (tick_ < end)
      if (const Packet packet = step(); !packet.bytes.empty()) out.push_back(tick_ - 1);
    return out;
  }
  void deliver(const Packet& packet) {
    ASSERT_FALSE(packet.bytes.empty());
    ASSERT_TRUE(receiver->push(packet.number, packet.bytes));
    sender->acknowledge(packet.substream, packet.number);
    EXPECT_EQ(sender->state_hash(1), receiver->state_hash(1));
  }
  std::int64_t next_tick() const { return tick_; }

  std::optional<Sender> sender;
  std::optional<Receiver> receiver;

 private:
  TriMesh mesh_ = testing::sheet(kSquares, kSquares);
  SharedScene scene_;
  std::int64_t tick_ = 0;
};

using Ticks = std::vector<std::int64_t>;

TEST(DeformableRepeat, WhatIsNotAcknowledgedGoesAgainEverLater) {
  MovedOnce sheet(Baseline::acknowledged);
  sheet.deliver(sheet.step());
  sheet.sender->set_link({.ack_timeout = 10, .loss = 0.1});
  EXPECT_EQ(sheet.lose_until(100), (Ticks{1, 12, 33, 74}));
  Packet packet;
  while (packet.bytes.empty() && sheet.next_tick() < 1000) packet = sheet.step();
  EXPECT_EQ(sheet.next_tick(), 74 + 81 + 1);
  sheet.deliver(packet);
  EXPECT_EQ(sheet.lose_until(2000), Ticks{}) << "it has arrived";
}

TEST(DeformableRepeat, NothingGoesAgainWhereNothingIsLostOrNobodyAcknowledges) {
  MovedOnce lossless(Baseline::acknowledged);
  lossless.deliver(lossless.step());
  lossless.sender->set_link({.ack_timeout = 10, .loss = 0});
  EXPECT_EQ(lossless.lose_until(1000), (Ticks{1}));

  MovedOnce chained(Baseline::previous);
  chained.deliver(chained.step());
  chained.sender->set_link({.ack_timeout = 10, .loss = 0.1});
  EXPECT_EQ(chained.lose_until(1000), (Ticks{1}));
}

TEST(DeformableRepeat, AnAnswerWithoutEndIsTaken) {
  MovedOnce sheet(Baseline::acknowledged);
  sheet.deliver(sheet.step());
  sheet.sender->set_link({.ack_timeout = std::numeric_limits<std::int64_t>::max(), .loss = 1});
  EXPECT_EQ(sheet.lose_until(500), (Ticks{1}));
}

}  // namespace
}  // namespace tactus
