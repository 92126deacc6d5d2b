// SPDX-License-Identifier: Apache-2.0
/// Corrections that fade, fractions of the bounds and sets of weights: bounds hold, both ends agree, and what rests costs nothing.
#include <gtest/gtest.h>

#include <algorithm>

#include <tactus/tactus.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using testing::BoundWatch;
using testing::DentedSheet;
using testing::SheetEnds;
using testing::SheetFrame;

constexpr std::uint32_t kSquares = 12;
constexpr std::uint16_t kTwentieth = 3277;
constexpr DeformableThresholds kThresholds{2.5e-4, 0.025};

struct Coding {
  std::uint16_t fade = 0;
  std::uint8_t weight_sets = 1;
  bool layered = false;
};

SharedScene scene_of(const TriMesh& mesh, const Coding& coding, std::uint32_t tick_rate = 60) {
  SceneSpec spec = testing::sheet_spec(mesh, DeformableProfile::main, testing::wave_basis(mesh, kSquares, 8));
  spec.tick_rate = tick_rate;
  spec.deformables[0].fade = coding.fade;
  spec.deformables[0].weight_sets = coding.weight_sets;
  spec.deformables[0].layered = coding.layered;
  return testing::shared(std::move(spec));
}

SenderOptions options(std::optional<double> fraction = {}) {
  return {.triggers = {},
          .deformable = {.thresholds = kThresholds, .visual_fraction = fraction, .haptic_fraction = fraction},
          .policy = {.key_interval = 0}};
}

struct Sent {
  std::size_t bytes = 0, packets = 0, broken = 0;
  double worst = 0;  // [m]
};

/// `frames` frames of the dent, then some in which it stays where it is. The motion of the modes took at most 3.0 s to end when measured.
struct Walk {
  Sent moving, settling, resting;
};

Walk walked(const Coding& coding, std::int64_t frames, std::optional<double> fraction = {}, std::uint32_t tick_rate = 60) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  DentedSheet sheet(mesh, kSquares);
  SheetEnds ends(scene_of(mesh, coding, tick_rate), options(fraction));
  Walk out;
  SheetFrame frame;
  for (std::int64_t k = 0; k < 3 * frames; ++k) {
    if (k < frames) frame = sheet.frame(k);
    BoundWatch watch(*ends.sender.scene(), kThresholds);
    const std::size_t bytes = ends.bytes, packets = ends.packets;
    ends.send(k, frame);
    if (::testing::Test::HasFatalFailure()) return {};
    watch.look(frame, ends.shown(k));
    Sent& sent = k < frames ? out.moving : k < 2 * frames ? out.settling : out.resting;
    sent.bytes += ends.bytes - bytes;
    sent.packets += ends.packets - packets;
    sent.broken += watch.broken();
    sent.worst = std::max(sent.worst, watch.worst());
  }
  return out;
}

TEST(DeformableFade, SavesBitsWhileADentWalks) {
  const Walk kept = walked({}, 300), faded = walked({.fade = kTwentieth}, 300);
  EXPECT_EQ(kept.moving.broken + faded.moving.broken, 0U);
  EXPECT_LT(faded.moving.bytes, kept.moving.bytes);
}

TEST(DeformableFade, AnObjectAtRestSendsNothing) {
  for (const bool layered : {false, true}) {
    const Walk faded = walked({.fade = kTwentieth, .layered = layered}, 200);
    EXPECT_EQ(faded.moving.broken + faded.settling.broken + faded.resting.broken, 0U);
    EXPECT_GT(faded.moving.packets, 50U);
    EXPECT_EQ(faded.resting.packets, 0U);
  }
}

TEST(DeformableFade, BoundsHoldInLayers) {
  for (const std::uint16_t fade : {std::uint16_t{1}, kTwentieth, std::uint16_t{65535}}) {
    const Walk layers = walked({.fade = fade, .weight_sets = 7, .layered = true}, 200);
    EXPECT_EQ(layers.moving.broken, 0U);
    EXPECT_GT(layers.moving.packets, 50U);
  }
}

TEST(DeformableFractions, ErrorsReachTheBoundBeforeAPacketGoes) {
  const Walk whole = walked({}, 300, 1.0), half = walked({}, 300, 0.5);
  EXPECT_EQ(whole.moving.broken + half.moving.broken, 0U);
  EXPECT_LT(half.moving.packets, whole.moving.packets);
  EXPECT_GT(half.moving.worst, 0.9 * kThresholds.visual);
}

TEST(DeformableFractions, DefaultLeavesAMarginWhereShapesComeFast) {
  const auto bytes = [](std::uint32_t rate, std::optional<double> fraction) {
    return walked({}, 120, fraction, rate).moving.bytes;
  };
  EXPECT_EQ(bytes(60, {}), bytes(60, 1.0));
  EXPECT_EQ(bytes(100, {}), bytes(100, 1.0));
  EXPECT_EQ(bytes(101, {}), bytes(101, 0.7));
  EXPECT_NE(bytes(101, {}), bytes(101, 1.0));
}

TEST(DeformableWeights, SeveralSetsCostNoMoreThanTheNamesOfThem) {
  std::size_t least = SIZE_MAX;
  for (const std::uint8_t one : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{4}})
    least = std::min(least, walked({.weight_sets = one}, 200).moving.bytes);
  const Walk all = walked({.weight_sets = 7}, 200);
  EXPECT_EQ(all.moving.broken, 0U);
  EXPECT_LE(all.moving.bytes, least + all.moving.packets);
}

}  // namespace
}  // namespace tactus
