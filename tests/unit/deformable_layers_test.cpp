// SPDX-License-Identifier: Apache-2.0
/// Haptic and visual halves: each keeps the bounds it vouches for, and the loss of one does not stop the other.
#include <gtest/gtest.h>

#include <tactus/deformable/encoder.h>
#include "tests/property/allocated.h"
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using testing::BoundWatch;
using testing::DentedSheet;
using testing::MeshEnds;
using testing::SheetFrame;

constexpr std::uint32_t kSquares = 12;
constexpr std::int64_t kFrames = 300;

StreamHeader split_header(const TriMesh& mesh, std::size_t modes, std::uint8_t span = 1) {
  StreamHeader header =
      testing::mesh_header(mesh, DeformableProfile::main, modes > 0 ? testing::wave_basis(mesh, kSquares, modes) : ModeBasis{});
  header.meshes[0].split = true;
  header.baseline_span = span;
  return header;
}

class SplitBounds : public ::testing::TestWithParam<std::tuple<DeformableThresholds, std::size_t, double>> {};

TEST_P(SplitBounds, HoldAfterEachHalf) {
  const auto& [thresholds, modes, noise] = GetParam();
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const StreamHeader header = split_header(mesh, modes);
  MeshEnds ends(header, {.thresholds = thresholds, .key_interval = 1});
  DentedSheet sheet(mesh, kSquares, noise);
  BoundWatch felt(header, thresholds), seen(header, thresholds);
  for (std::int64_t k = 0; k < kFrames; ++k) {
    const SheetFrame frame = sheet.frame(k);
    const auto first = ends.encoder.encode(k, frame.displacement, frame.touch);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->half, first->bytes.empty() ? Layer::all : Layer::haptic);
    ends.deliver(*first, k);
    felt.look_at_area(frame, ends.decoder.displacements_at(k));
    ends.deliver(ends.encoder.encode_rest(), k);
    if (HasFatalFailure()) return;
    seen.look(frame, ends.decoder.displacements_at(k));
    EXPECT_TRUE(ends.encoder.encode_rest().bytes.empty());
  }
  EXPECT_EQ(felt.broken(), 0U);
  EXPECT_EQ(seen.broken(), 0U);
  EXPECT_EQ(ends.halves[0] > 0, thresholds.weber_fraction.has_value());
  EXPECT_GT(ends.halves[1], 20U);
  EXPECT_EQ(ends.halves[2], 0U);
}

INSTANTIATE_TEST_SUITE_P(Settings, SplitBounds,
                         ::testing::Combine(::testing::Values(DeformableThresholds{2.5e-4, 0.025}, DeformableThresholds{1e-3, {}},
                                                              DeformableThresholds{5e-5, 0.1}, DeformableThresholds{0, 0.025},
                                                              DeformableThresholds{1e-3, 0.0}),
                                            ::testing::Values(0, 8), ::testing::Values(0.0, 1e-4)));

TEST(MeshSplit, MotionIsPredictedAcrossHapticHalves) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  std::array<std::size_t, 2> bytes{};
  for (const bool split : {false, true}) {
    StreamHeader header = split_header(mesh, 8);
    header.meshes[0].split = split;
    MeshEnds ends(header, {});
    DentedSheet sheet(mesh, kSquares);
    for (std::int64_t k = 0; k < kFrames; ++k) {
      const SheetFrame frame = sheet.frame(k);
      ends.deliver(ends.encoder.encode(k, frame.displacement, frame.touch).value(), k);
      ends.deliver(ends.encoder.encode_rest(), k);
    }
    bytes[split ? 1 : 0] = ends.bytes;
    EXPECT_EQ(ends.halves[2] > 0, !split);
  }
  EXPECT_LT(bytes[1], 2 * bytes[0]);
}

/// A sender that drops visual halves: what is felt stays within its bound, what is seen again as soon as one arrives.
TEST(MeshSplit, VisualHalvesMayBeLost) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const DeformableThresholds thresholds;
  for (const std::uint8_t span : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{4}}) {
    const StreamHeader header = split_header(mesh, 6, span);
    MeshEnds ends(header, {.thresholds = thresholds, .key_interval = 0});
    DentedSheet sheet(mesh, kSquares);
    BoundWatch felt(header, thresholds), seen(header, thresholds);
    std::size_t lost = 0, keys = 0;
    for (std::int64_t k = 0; k < kFrames; ++k) {
      const SheetFrame frame = sheet.frame(k);
      const auto first = ends.encoder.encode(k, frame.displacement, frame.touch).value();
      keys += first.key ? 1U : 0U;
      ends.deliver(first, k);
      felt.look_at_area(frame, ends.decoder.displacements_at(k));
      const EncodedDeformablePacket rest = ends.encoder.encode_rest();
      keys += rest.key ? 1U : 0U;
      if (k % 3 == 1 && !rest.bytes.empty() && !rest.key) {
        ends.encoder.forget_last();
        ++lost;
        EXPECT_EQ(ends.decoder.state_hash(), ends.encoder.state_hash());
        continue;
      }
      ends.deliver(rest, k);
      if (HasFatalFailure()) return;
      seen.look(frame, ends.decoder.displacements_at(k));
    }
    EXPECT_GT(lost, 20U);
    EXPECT_EQ(felt.broken(), 0U);
    EXPECT_EQ(seen.broken(), 0U);
    if (span > 1) {
      EXPECT_EQ(keys, 1U) << "the baseline before the lost packet is kept";
    } else {
      EXPECT_GT(keys, lost / 2);
    }
  }
}

/// What becomes of a stream whose visual halves never arrive.
struct Starved {
  std::size_t accepted = 0, refused = 0, keys = 0;
};

/// in  rest(encoder)     makes a visual half, or not, and loses it
///     refused(encoder)  a haptic half was not accepted
Starved starve(std::uint8_t span, const auto& rest, const auto& refused) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  MeshEnds ends(split_header(mesh, 6, span), {.thresholds = {}, .key_interval = 0});
  DentedSheet sheet(mesh, kSquares);
  Starved out;
  for (std::int64_t k = 0; k < kFrames; ++k) {
    const SheetFrame frame = sheet.frame(k);
    const auto felt = ends.encoder.encode(k, frame.displacement, frame.touch).value();
    if (const auto decoded = ends.decoder.decode(felt.bytes); decoded) {
      ++out.accepted;
      out.keys += decoded->key ? 1U : 0U;
    } else if (!felt.bytes.empty()) {
      EXPECT_STREQ(decoded.error().rule, "R-PKT-4");
      ++out.refused;
      refused(ends.encoder);
    }
    rest(ends.encoder);
  }
  return out;
}

constexpr std::array<std::uint8_t, 3> kSpans{1, 2, 8};
void lose(DeformableEncoder& encoder) { (void)encoder.encode_rest(); }
void ignore(DeformableEncoder&) {}

TEST(MeshSplit, VisualHalvesMayBeLeftOut) {
  for (const std::uint8_t span : kSpans) {
    const Starved out = starve(span, ignore, ignore);
    EXPECT_GT(out.accepted, 50U);
    EXPECT_EQ(out.refused, 0U);
    EXPECT_EQ(out.keys, 1U);
  }
}

TEST(MeshSplit, DroppedVisualHalvesCostKeysWhereNoOlderBaselineIsKept) {
  const auto drop = [](DeformableEncoder& encoder) {
    if (!encoder.encode_rest().bytes.empty()) encoder.forget_last();
  };
  std::array<Starved, 3> out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = starve(kSpans[i], drop, ignore);
    EXPECT_GT(out[i].accepted, 50U);
    EXPECT_EQ(out[i].refused, 0U);
  }
  EXPECT_GT(out[0].keys, out[0].accepted * 9 / 10);
  EXPECT_LT(out[1].keys, out[1].accepted / 4);
  EXPECT_LT(out[2].keys, out[2].accepted / 10);
}

TEST(MeshSplit, AnUnnoticedLossStopsTheStreamUntilAKeyPacket) {
  for (const std::uint8_t span : kSpans) {
    const Starved silent = starve(span, lose, ignore);
    EXPECT_EQ(silent.accepted, 0U) << "nobody touches at first: the only key packet is a visual half, and lost";
    EXPECT_GT(silent.refused, 50U);
    const Starved asked = starve(span, lose, [](DeformableEncoder& encoder) { encoder.request_key(); });
    EXPECT_GT(asked.accepted, asked.refused * 9 / 10) << "a refusal brings a key packet, mostly a haptic half";
  }
}

/// Keys come once for each request, also when every bound holds, and again when the key packet itself was lost.
TEST(MeshSplit, RequestedKeyPackets) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const std::vector<Vec3> shape(mesh.vertices.size(), Vec3{0, 0, 0.01});
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    for (const bool split : {false, true}) {
      for (const bool touched : {false, true}) {
        StreamHeader header = testing::mesh_header(mesh, profile);
        header.meshes[0].split = profile == DeformableProfile::main && split;
        MeshEnds ends(header, {.thresholds = {}, .key_interval = 0, .split = split});
        const auto touch = touched ? std::optional(SurfaceTouch{5, 1, 500}) : std::nullopt;
        std::int64_t tick = 0;
        const auto frame = [&] {
          const auto first = ends.encoder.encode(tick, shape, touch).value();
          ends.deliver(first, tick);
          const EncodedDeformablePacket rest = ends.encoder.encode_rest();
          ends.deliver(rest, tick++);
          EXPECT_FALSE(first.key && rest.key);
          return first.key || rest.key;
        };
        EXPECT_TRUE(frame());
        EXPECT_FALSE(frame());
        ends.encoder.request_key();
        EXPECT_TRUE(frame());
        EXPECT_FALSE(frame());
        ends.encoder.request_key();
        EXPECT_EQ(ends.encoder.encode(tick, shape, touch)->key, touched || !split);
        if (touched) {
          ends.encoder.forget_last();
          EXPECT_TRUE(ends.encoder.encode_rest().bytes.empty()) << "what is felt goes first";
        } else {
          EXPECT_EQ(ends.encoder.encode_rest().key, split);
          ends.encoder.forget_last();
        }
        ++tick;
        EXPECT_TRUE(frame());
        EXPECT_FALSE(frame());
        if (HasFatalFailure()) return;
      }
    }
  }
}

/// Losses of any packet, whole ones too, and of key packets; the encoder is told once per packet.
TEST(MeshSplit, AnyPacketMayBeLost) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    for (const bool split : {false, true}) {
      StreamHeader header = testing::mesh_header(mesh, profile);
      header.meshes[0].split = profile == DeformableProfile::main && split;
      header.baseline_span = 3;
      MeshEnds ends(header, {.thresholds = {}, .key_interval = 0.5, .split = split});
      DentedSheet sheet(mesh, kSquares);
      BoundWatch seen(header, {});
      std::mt19937_64 random(3);
      for (std::int64_t k = 0; k < kFrames; ++k) {
        const SheetFrame frame = sheet.frame(k);
        bool lost = false;
        const auto pass = [&](const EncodedDeformablePacket& packet) {
          if (!packet.bytes.empty() && random() % 3 == 0) {
            ends.encoder.forget_last();
            ends.encoder.forget_last();  // once is enough
            lost = true;
          } else {
            ends.deliver(packet, k);
          }
        };
        pass(ends.encoder.encode(k, frame.displacement, frame.touch).value());
        pass(ends.encoder.encode_rest());
        if (HasFatalFailure()) return;
        ASSERT_EQ(ends.decoder.state_hash(), ends.encoder.state_hash());
        if (!lost && profile == DeformableProfile::main) seen.look(frame, ends.decoder.displacements_at(k));
      }
      EXPECT_EQ(seen.broken(), 0U);
      EXPECT_GT(ends.halves[split ? 1 : 2], 50U);
    }
  }
}

TEST(MeshSplit, ThesisListsWhatIsFeltInAPacketOfItsOwn) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  StreamHeader header = testing::mesh_header(mesh, DeformableProfile::thesis);
  header.meshes[0].quant_bits = 12;
  MeshEnds ends(header, {.thresholds = {}, .key_interval = 1, .split = true});
  DentedSheet sheet(mesh, kSquares);
  BoundWatch watch(header, {});
  Rings rings(header.meshes[0]);
  std::vector<DeformableDecoder::Displacement> before(mesh.vertices.size());
  for (std::int64_t k = 0; k < kFrames; ++k) {
    const SheetFrame frame = sheet.frame(k);
    const auto first = ends.encoder.encode(k, frame.displacement, frame.touch).value();
    ends.deliver(first, k);
    if (!first.bytes.empty() && !first.key) {
      rings.triangles_around(frame.touch->triangle, header.meshes[0].rings);
      const auto shown = ends.decoder.displacements();
      for (std::uint32_t v = 0; v < before.size(); ++v) {
        if (std::ranges::count(rings.vertices(), v) > 0) continue;
        ASSERT_EQ(shown[v], before[v]);
      }
    }
    ends.deliver(ends.encoder.encode_rest(), k);
    if (HasFatalFailure()) return;
    const auto shown = ends.decoder.displacements();
    before.assign(shown.begin(), shown.end());
    watch.look(frame, shown);
  }
  EXPECT_LT(watch.worst(), 2.5e-4 + 1e-6);
  EXPECT_GT(ends.halves[0], 100U);
  EXPECT_GT(ends.halves[1], 100U);
  EXPECT_EQ(ends.halves[2], 0U);
}

/// A key packet that would list nothing, because the mesh is back in the initial state.
TEST(MeshSplit, ThesisKeyPacketsListAVertexAtLeast) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const bool split : {false, true}) {
    const StreamHeader header = testing::mesh_header(mesh, DeformableProfile::thesis);
    MeshEnds ends(header, {.thresholds = {}, .key_interval = 0.1, .split = split});
    const SurfaceTouch touch{5, 1, 500};
    for (std::int64_t k = 0; k < 60; ++k) {
      const std::vector<Vec3> shape(mesh.vertices.size(), Vec3{0, 0, k % 13 < 6 ? 0.01 : 0});
      const auto first = ends.encoder.encode(k, shape, k % 2 == 0 ? std::optional(touch) : std::nullopt);
      ASSERT_TRUE(first);
      ends.deliver(*first, k);
      ends.deliver(ends.encoder.encode_rest(), k);
      if (HasFatalFailure()) return;
      for (std::size_t v = 0; v < shape.size(); ++v)
        ASSERT_LT(norm(to_metres(ends.decoder.displacements()[v], 22) - shape[v]), 3e-4) << k;
    }
  }
}

TEST(MeshSplit, AllocatesNothingAfterSetUp) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    StreamHeader header = profile == DeformableProfile::main ? split_header(mesh, 8, 3) : testing::mesh_header(mesh, profile);
    MeshEnds ends(header, {.thresholds = {}, .key_interval = 0.3, .split = true});
    DentedSheet sheet(mesh, kSquares);
    std::vector<SheetFrame> frames;
    for (std::int64_t k = 0; k < 120; ++k) frames.push_back(sheet.frame(k));
    const std::uint64_t before = testing::allocated_bytes();
    std::size_t decoded = 0;
    for (std::int64_t k = 0; k < 120; ++k) {
      const SheetFrame& frame = frames[static_cast<std::size_t>(k)];
      const auto first = ends.encoder.encode(k, frame.displacement, frame.touch);
      if (first && !first->bytes.empty()) decoded += ends.decoder.decode(first->bytes).has_value() ? 1U : 0U;
      const auto rest = ends.encoder.encode_rest();
      if (k % 31 == 0) ends.encoder.request_key();
      if (k % 7 == 0) ends.encoder.forget_last();
      else if (!rest.bytes.empty()) decoded += ends.decoder.decode(rest.bytes).has_value() ? 1U : 0U;
      (void)ends.decoder.displacements_at(k);
    }
    EXPECT_EQ(testing::allocated_bytes(), before);
    EXPECT_GT(decoded, 60U);
  }
}

}  // namespace
}  // namespace tactus
