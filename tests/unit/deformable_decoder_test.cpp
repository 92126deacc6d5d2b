// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string_view>

#include <tactus/deformable/main_state.h>
#include <tactus/receiver.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

// ==== deformable decoder ====
/// Packets of deformable objects that are damaged, late, lost or cut: an error with a rule or a decoded packet, never another state.

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kSquares = 6;

struct Recorded {
  SharedScene scene;
  std::vector<Bytes> packets;  // number i + 1 is packets[i]
};

struct Coding {
  DeformableProfile profile;
  std::size_t modes = 0;
  bool layered = false;
};

Recorded record(const Coding& coding, std::uint8_t span = 1) {
  const auto& [profile, modes, layered] = coding;
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  SceneSpec spec = testing::sheet_spec(mesh, profile, modes > 0 ? testing::wave_basis(mesh, kSquares, modes) : ModeBasis{});
  spec.baseline_span = span;
  spec.deformables[0].models_kept = profile == DeformableProfile::thesis;
  spec.deformables[0].layered = layered;
  Recorded out{testing::shared(std::move(spec), testing::kWithThesis), {}};
  testing::DentedSheet sheet(mesh, kSquares);
  testing::SheetEnds ends(out.scene);
  for (std::int64_t k = 0; k < 40; ++k)
    for (const Packet& packet : testing::all(ends.encode(k, sheet.frame(k))))
      out.packets.emplace_back(packet.bytes.begin(), packet.bytes.end());
  return out;
}

Result<DecodedPacket> push_exact(Receiver& receiver, std::uint64_t number, const Bytes& packet) {
  const auto exact = std::make_unique_for_overwrite<std::uint8_t[]>(packet.size());
  std::ranges::copy(packet, exact.get());
  return receiver.push(number, {exact.get(), packet.size()});
}

class DamagedPackets : public ::testing::TestWithParam<Coding> {
 protected:
  /// A receiver that has seen the first ten packets.
  Receiver started() const {
    auto receiver = Receiver::create(recorded_.scene).value();
    for (std::size_t i = 0; i < 10; ++i) EXPECT_TRUE(receiver.push(i + 1, recorded_.packets[i]));
    return receiver;
  }
  /// Refused, and nothing happened; or accepted by a receiver of its own.
  void expect_survived(Receiver& receiver, const Bytes& packet) const {
    const std::uint64_t hash = receiver.state_hash(1);
    const auto decoded = push_exact(receiver, kNext, packet);
    if (decoded) {
      receiver = started();
      return;
    }
    EXPECT_TRUE(std::string_view(decoded.error().rule).starts_with("R-"));
    EXPECT_LE(decoded.error().code, Errc::state);
    EXPECT_LE(decoded.error().bit_offset, 8 * packet.size());
    EXPECT_EQ(receiver.state_hash(1), hash);
  }

  static constexpr std::uint64_t kNext = 11;
  const Recorded recorded_ = record(GetParam(), 2);
};

TEST_P(DamagedPackets, EveryPrefixEveryBitEveryByte) {
  const Bytes good = recorded_.packets[10];
  Receiver receiver = started();
  for (std::size_t size = 0; size < good.size(); ++size)
    expect_survived(receiver, Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)));
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const int change : {1, 2, 4, 8, 16, 32, 64, 128, 255}) {
      Bytes bad = good;
      bad[i] = static_cast<std::uint8_t>(bad[i] ^ change);
      expect_survived(receiver, bad);
    }
  }
  Bytes longer = good;
  longer.resize(longer.size() + 12, 1);
  const auto refused = push_exact(receiver, kNext, longer);
  ASSERT_FALSE(refused);
  EXPECT_STREQ(refused.error().rule, "R-RNG-2");
  EXPECT_TRUE(push_exact(receiver, kNext, good));
  EXPECT_STREQ(push_exact(receiver, kNext, good).error().rule, "R-PKT-5");
}

TEST_P(DamagedPackets, RandomBytes) {
  std::mt19937_64 random(5);
  Receiver receiver = started();
  for (int round = 0; round < 3000; ++round) {
    Bytes packet(random() % 60);
    for (std::uint8_t& b : packet) b = static_cast<std::uint8_t>(random());
    expect_survived(receiver, packet);
  }
}

INSTANTIATE_TEST_SUITE_P(Profiles, DamagedPackets,
                         ::testing::Values(Coding{DeformableProfile::thesis}, Coding{DeformableProfile::main},
                                           Coding{DeformableProfile::main, 6}, Coding{DeformableProfile::main, 6, true}));

TEST(DeformableDecoder, LostPacketsAreNoticedAndMayStillCome) {
  const Recorded recorded = record({DeformableProfile::main});
  auto receiver = Receiver::create(recorded.scene).value();
  EXPECT_STREQ(receiver.push(2, recorded.packets[1]).error().rule, "R-PKT-4");
  ASSERT_TRUE(receiver.push(1, recorded.packets[0]));
  EXPECT_STREQ(receiver.push(3, recorded.packets[2]).error().rule, "R-PKT-4");
  ASSERT_TRUE(receiver.push(2, recorded.packets[1]));
  ASSERT_TRUE(receiver.push(3, recorded.packets[2]));
}

TEST(DeformableDecoder, LimitsAndLengths) {
  const Recorded recorded = record({DeformableProfile::main});
  auto receiver = Receiver::create(recorded.scene, {.replica = {}, .limits = {.packet_bytes = 4}}).value();
  EXPECT_STREQ(receiver.push(1, Bytes(5)).error().rule, "R-PKT-1");
  const auto refused = Receiver::create(recorded.scene, {.replica = {}, .limits = {.vertices = 10}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::limit_exceeded);
  EXPECT_STREQ(refused.error().rule, "R-STR-14");
}

// ==== deformable motion ====

TEST(ModeMotion, WithoutAPacketNothingIsExpected) {
  std::array<std::int32_t, 2> out{1, 1};
  ModeMotion(2).predict(3, out);
  EXPECT_EQ(out, (std::array<std::int32_t, 2>{}));
}

TEST(ModeMotion, LearnsAnOscillation) {
  ModeMotion motion(1);
  const auto increment = [](int frame) { return static_cast<std::int32_t>(std::lround(20000 * std::cos(1.0 * frame))); };
  for (int frame = 0; frame < 100; ++frame) motion.update(1, std::array{increment(frame)});
  std::int64_t error = 0, size = 0;  // of the next frame, learning on
  for (int frame = 100; frame < 200; ++frame) {
    std::array<std::int32_t, 1> next{};
    motion.predict(1, next);
    error += std::abs(next[0] - increment(frame));
    size += std::abs(increment(frame));
    motion.update(1, std::array{increment(frame)});
  }
  EXPECT_LT(20 * error, size);
}

TEST(ModeMotion, StopsWhenPacketsStayAway) {
  ModeMotion motion(1);
  for (int packet = 0; packet < 20; ++packet) motion.update(1, std::array{1000});
  std::array<std::int32_t, 1> last{}, later{};
  motion.predict(ModeMotion::kMaxSteps, last);
  motion.predict(1000, later);
  EXPECT_GT(last[0], 4000);
  EXPECT_EQ(later, last);
}

TEST(ModeMotion, ExtremeIncrementsStayInRange) {
  ModeMotion motion(1);
  for (int packet = 0; packet < 100; ++packet) {
    const std::int32_t limit =
        packet % 3 == 0 ? std::numeric_limits<std::int32_t>::min() : std::numeric_limits<std::int32_t>::max();
    motion.update(static_cast<std::uint32_t>(packet % 4), std::array{limit});
    std::array<std::int32_t, 1> out{};
    motion.predict(8, out);
    EXPECT_LE(std::abs(std::int64_t{out[0]}), 1 << 27);
  }
}

}  // namespace
}  // namespace tactus
