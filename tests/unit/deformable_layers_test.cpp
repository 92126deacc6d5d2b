// SPDX-License-Identifier: Apache-2.0
/// Haptic and visual layers: each packet keeps the bounds it vouches for, and dropping visual ones does not stop the haptic ones.
#include <gtest/gtest.h>

#include <algorithm>

#include <tactus/tactus.h>
#include "tests/property/allocated.h"
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using testing::BoundWatch;
using testing::DentedSheet;
using testing::SheetEnds;
using testing::SheetFrame;

constexpr std::uint32_t kSquares = 12;
constexpr std::int64_t kFrames = 300;

SharedScene layered_scene(const TriMesh& mesh, std::size_t modes, std::uint8_t span = 1, bool layered = true) {
  SceneSpec spec =
      testing::sheet_spec(mesh, DeformableProfile::main, modes > 0 ? testing::wave_basis(mesh, kSquares, modes) : ModeBasis{});
  spec.deformables[0].layered = layered;
  spec.baseline_span = span;
  return testing::shared(std::move(spec));
}

/// Either profile, in layers or not; of profile thesis no declaration says it.
SharedScene scene_of(const TriMesh& mesh, DeformableProfile profile, bool layered, std::uint8_t span = 1) {
  SceneSpec spec = testing::sheet_spec(mesh, profile);
  spec.deformables[0].layered = layered;
  spec.baseline_span = span;
  return testing::shared(std::move(spec), testing::kWithThesis);
}

SenderOptions options(double key_interval, const DeformableThresholds& thresholds = {}) {
  return {.triggers = {}, .deformable = {.thresholds = thresholds}, .policy = {.key_interval = key_interval}};
}

class LayeredBounds : public ::testing::TestWithParam<std::tuple<DeformableThresholds, std::size_t, double>> {};

TEST_P(LayeredBounds, HoldAfterEachPacket) {
  const auto& [thresholds, modes, noise] = GetParam();
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const SharedScene scene = layered_scene(mesh, modes);
  SheetEnds ends(scene, options(1, thresholds));
  DentedSheet sheet(mesh, kSquares, noise);
  BoundWatch rendered(*scene, thresholds), seen(*scene, thresholds);
  for (std::int64_t k = 0; k < kFrames; ++k) {
    const SheetFrame frame = sheet.frame(k);
    const auto packets = ends.encode(k, frame);
    ASSERT_TRUE(packets);
    ASSERT_LE(packets->size(), 2U);
    if (packets->size() == 2) {
      EXPECT_EQ(packets->front().layer, Layer::haptic) << "what is rendered goes first";
      EXPECT_EQ(packets->back().layer, Layer::visual);
      EXPECT_FALSE(packets->back().key);
    }
    const bool none_rendered = packets->empty() || packets->front().layer == Layer::visual;
    if (none_rendered) rendered.look_at_area(frame, ends.shown(k));
    for (const Packet& packet : *packets) {
      ends.deliver(packet, k);
      if (packet.layer == Layer::haptic) rendered.look_at_area(frame, ends.shown(k));
    }
    ends.agree(k);
    if (HasFatalFailure()) return;
    seen.look(frame, ends.shown(k));
  }
  EXPECT_EQ(rendered.broken(), 0U);
  EXPECT_EQ(seen.broken(), 0U);
  EXPECT_EQ(ends.layers[0] > 0, thresholds.weber_fraction.has_value());
  EXPECT_GT(ends.layers[1], 20U);
  EXPECT_EQ(ends.layers[2], 0U);
}

INSTANTIATE_TEST_SUITE_P(Settings, LayeredBounds,
                         ::testing::Combine(::testing::Values(DeformableThresholds{2.5e-4, 0.025}, DeformableThresholds{1e-3, {}},
                                                              DeformableThresholds{5e-5, 0.1}, DeformableThresholds{0, 0.025},
                                                              DeformableThresholds{1e-3, 0.0}),
                                            ::testing::Values(0, 8), ::testing::Values(0.0, 1e-4)));

TEST(DeformableLayers, MotionIsPredictedAcrossHapticPackets) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  std::array<std::size_t, 2> bytes{};
  for (const bool layered : {false, true}) {
    SheetEnds ends(layered_scene(mesh, 8, 1, layered));
    DentedSheet sheet(mesh, kSquares);
    for (std::int64_t k = 0; k < kFrames; ++k) ends.send(k, sheet.frame(k));
    bytes[layered ? 1 : 0] = ends.bytes;
    EXPECT_EQ(ends.layers[2] > 0, !layered);
  }
  EXPECT_LT(bytes[1], 2 * bytes[0]);
}

/// A sender that drops visual packets: what is rendered stays within its bound, what is seen again as soon as one arrives.
TEST(DeformableLayers, VisualPacketsMayBeDropped) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const std::uint8_t span : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{4}}) {
    const SharedScene scene = layered_scene(mesh, 6, span);
    SheetEnds ends(scene, options(0));
    DentedSheet sheet(mesh, kSquares);
    BoundWatch rendered(*scene, {}), seen(*scene, {});
    std::size_t lost = 0, keys = 0;
    for (std::int64_t k = 0; k < kFrames; ++k) {
      const SheetFrame frame = sheet.frame(k);
      bool dropped = false;
      for (const Packet& packet : testing::all(ends.encode(k, frame))) {
        keys += packet.key ? 1U : 0U;
        dropped = k % 3 == 1 && packet.layer == Layer::visual && !packet.key;
        if (dropped) ends.sender.forget_last(1);
        else ends.deliver(packet, k);
      }
      ends.agree(k);
      if (HasFatalFailure()) return;
      lost += dropped ? 1U : 0U;
      rendered.look_at_area(frame, ends.shown(k));
      if (!dropped) seen.look(frame, ends.shown(k));
    }
    EXPECT_GT(lost, 20U);
    EXPECT_EQ(rendered.broken(), 0U);
    EXPECT_EQ(seen.broken(), 0U);
    EXPECT_EQ(keys, 1U) << "the state before the dropped packet is a baseline";
  }
}

/// What becomes of a stream whose visual packets never arrive.
struct Starved {
  std::size_t accepted = 0, refused = 0, keys = 0;
};

/// in  lose(sender)     a visual packet was made last, and is lost
///     refused(sender)  a haptic packet was not accepted
Starved starve(std::uint8_t span, const auto& lose, const auto& refused) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  SheetEnds ends(layered_scene(mesh, 6, span), options(0));
  DentedSheet sheet(mesh, kSquares);
  Starved out;
  for (std::int64_t k = 0; k < kFrames; ++k) {
    for (const Packet& packet : testing::all(ends.encode(k, sheet.frame(k)))) {
      if (packet.layer == Layer::visual) {
        lose(ends.sender);
        continue;
      }
      const auto decoded = ends.receiver.push(packet.number, packet.bytes);
      if (decoded) {
        ++out.accepted;
        out.keys += decoded->key ? 1U : 0U;
      } else {
        EXPECT_STREQ(decoded.error().rule, "R-PKT-4");
        ++out.refused;
        refused(ends.sender);
      }
    }
  }
  return out;
}

constexpr std::array<std::uint8_t, 3> kSpans{1, 2, 8};
void ignore(Sender&) {}

TEST(DeformableLayers, DroppedVisualPacketsCostNoKeys) {
  for (const std::uint8_t span : kSpans) {
    const Starved out = starve(
        span, [](Sender& sender) { sender.forget_last(1); }, ignore);
    EXPECT_GT(out.accepted, 50U);
    EXPECT_EQ(out.refused, 0U);
    EXPECT_EQ(out.keys, 1U);
  }
}

TEST(DeformableLayers, AnUnnoticedLossStopsTheStreamUntilAKeyPacket) {
  for (const std::uint8_t span : kSpans) {
    const Starved silent = starve(span, ignore, ignore);
    EXPECT_EQ(silent.accepted, 0U) << "nobody touches at first: the only key packet is a visual one, and lost";
    EXPECT_GT(silent.refused, 50U);
    const Starved asked = starve(span, ignore, [](Sender& sender) { sender.request_key(); });
    EXPECT_GT(asked.accepted, asked.refused * 9 / 10) << "a refusal brings a key packet, mostly a haptic one";
  }
}

/// Keys come once for each request, also when every bound holds, and again when the key packet itself was lost.
TEST(DeformableLayers, RequestedKeyPackets) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    for (const bool layered : {false, true}) {
      for (const bool touched : {false, true}) {
        SheetEnds ends(scene_of(mesh, profile, layered), options(0));
        const SheetFrame frame{testing::moved_by(mesh.vertices.size(), {0, 0, 0.01}),
                               touched ? std::optional(SurfaceTouch{5, 1, 500}) : std::nullopt};
        std::int64_t tick = 0;
        const auto keys = [&] {
          std::size_t count = 0;
          for (const Packet& packet : testing::all(ends.encode(tick, frame))) {
            ends.deliver(packet, tick);
            count += packet.key ? 1U : 0U;
          }
          ends.agree(tick++);
          return count;
        };
        EXPECT_EQ(keys(), 1U);
        EXPECT_EQ(keys(), 0U);
        ends.sender.request_key();
        EXPECT_EQ(keys(), 1U);
        EXPECT_EQ(keys(), 0U);
        ends.sender.request_key();
        const auto lost = ends.encode(tick++, frame).value();
        ASSERT_FALSE(lost.empty());
        EXPECT_TRUE(lost[0].key);
        EXPECT_EQ(lost[0].layer == Layer::haptic, layered && touched) << "what is rendered goes first";
        if (lost.size() == 1) {
          ends.sender.forget_last(1);
        } else {
          EXPECT_EQ(advice(ends.receiver.push(lost[1].number, lost[1].bytes).error()), Advice::request_key)
              << "it builds on the lost one";
          ends.sender.request_key();
        }
        EXPECT_EQ(keys(), 1U);
        EXPECT_EQ(keys(), 0U);
        if (HasFatalFailure()) return;
      }
    }
  }
}

/// Losses of any packet, of key packets, and of both packets of a frame. Whoever makes them is notified once per packet, at once; where
/// that comes too late, because the visual packet of the frame builds on a lost haptic one, the receiver asks for a key packet.
TEST(DeformableLayers, AnyPacketMayBeLost) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    for (const bool layered : {false, true}) {
      SheetEnds ends(scene_of(mesh, profile, layered, 3), options(0.5));
      DentedSheet sheet(mesh, kSquares);
      BoundWatch seen(*ends.sender.scene(), {});
      std::mt19937_64 random(3);
      std::size_t requests = 0;
      bool behind = false;
      for (std::int64_t k = 0; k < kFrames; ++k) {
        const SheetFrame frame = sheet.frame(k);
        const auto packets = ends.encode(k, frame).value();
        std::size_t lost = 0;
        bool refused = false;
        for (std::size_t i = 0; i < packets.size(); ++i) {
          const bool last = i + 1 == packets.size();
          if (refused) {
            const auto pushed = ends.receiver.push(packets[i].number, packets[i].bytes);
            ASSERT_FALSE(pushed);
            EXPECT_EQ(advice(pushed.error()), Advice::request_key);
          } else if (random() % 3 == 0) {
            ++lost;
            refused = !last;
            if (!last) continue;
            ends.sender.forget_last(1);
            ends.sender.forget_last(1);  // once is enough
          } else {
            ends.deliver(packets[i], k);
          }
        }
        if (HasFatalFailure()) return;
        if (refused) {
          ends.sender.request_key();
          ++requests;
        }
        behind = refused || (behind && (lost > 0 || packets.empty()));
        if (behind) continue;  // the key packet is still to come
        ASSERT_EQ(ends.receiver.state_hash(1), ends.sender.state_hash(1));
        if (lost == 0 && profile == DeformableProfile::main) seen.look(frame, ends.shown(k));
      }
      EXPECT_EQ(seen.broken(), 0U);
      EXPECT_GT(ends.layers[layered ? 1 : 2], 50U);
      EXPECT_EQ(requests > 10, layered);
    }
  }
}

/// A sender keeps its bounds whatever its packets build on, or refuses to be made.
TEST(DeformableLayers, BoundsHoldWithAcknowledgedBaselinesToo) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  SceneSpec spec = testing::sheet_spec(mesh);
  spec.deformables[0].layered = true;
  spec.baseline_span = 8;
  const SharedScene scene = testing::shared(std::move(spec));
  SenderOptions acknowledged = options(0);
  acknowledged.policy.baseline = Baseline::acknowledged;
  if (!Sender::create(scene, acknowledged)) return;
  SheetEnds ends(scene, acknowledged);
  DentedSheet sheet(mesh, kSquares);
  BoundWatch seen(*scene, {});
  for (std::int64_t k = 0; k < kFrames; ++k) {
    const SheetFrame frame = sheet.frame(k);
    for (const Packet& packet : testing::all(ends.encode(k, frame))) {
      ends.deliver(packet, k);
      if (HasFatalFailure()) return;
      ends.sender.acknowledge(packet.substream, packet.number);
    }
    seen.look(frame, ends.shown(k));
  }
  EXPECT_EQ(seen.broken(), 0U) << "worst " << seen.worst() << " m";
}

TEST(DeformableLayers, AllocatesNothingAfterSetUp) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    SheetEnds ends(profile == DeformableProfile::main ? layered_scene(mesh, 8, 3) : scene_of(mesh, profile, true), options(0.3));
    DentedSheet sheet(mesh, kSquares);
    std::vector<SheetFrame> frames;
    for (std::int64_t k = 0; k < 120; ++k) frames.push_back(sheet.frame(k));
    const std::uint64_t before = testing::allocated_bytes();
    std::size_t decoded = 0;
    for (std::int64_t k = 0; k < 120; ++k) {
      const auto packets = ends.encode(k, frames[static_cast<std::size_t>(k)]);
      if (!packets) break;
      if (k % 31 == 0) ends.sender.request_key();
      for (std::size_t i = 0; i < packets->size(); ++i) {
        if (k % 7 == 0 && i + 1 == packets->size()) ends.sender.forget_last(1);
        else decoded += ends.receiver.push((*packets)[i].number, (*packets)[i].bytes).has_value() ? 1U : 0U;
      }
      (void)ends.shown(k);
    }
    EXPECT_EQ(testing::allocated_bytes(), before);
    EXPECT_GT(decoded, 60U);
  }
}

}  // namespace
}  // namespace tactus
