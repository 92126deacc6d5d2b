// SPDX-License-Identifier: Apache-2.0
/// Bounds hold on what the decoder shows, for every vertex and every frame; both ends hold the same state after every packet.
#include <tactus/deformable/encoder.h>

#include <gtest/gtest.h>

#include <limits>

#include "tests/property/allocated.h"
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using testing::BoundWatch;
using testing::DentedSheet;
using testing::MeshEnds;
using testing::SheetFrame;

constexpr std::uint32_t kSquares = 12;

struct Sent {
  std::size_t packets = 0, broken = 0;
  double worst = 0;  // [m]
};

Sent run_sheet(const StreamHeader& header, const DeformableThresholds& thresholds, std::int64_t frames, double noise = 0) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  DentedSheet sheet(mesh, kSquares, noise);
  MeshEnds ends(header, {.thresholds = thresholds});
  BoundWatch watch(header, thresholds);
  for (std::int64_t k = 0; k < frames; ++k) {
    const SheetFrame frame = sheet.frame(k);
    ends.send(k, frame);
    if (::testing::Test::HasFatalFailure()) return {};
    watch.look(frame, ends.decoder.displacements_at(k));
  }
  return {ends.packets, watch.broken(), watch.worst()};
}

struct Setting {
  double visual;
  std::optional<double> weber_fraction;
};

class MainBounds : public ::testing::TestWithParam<std::tuple<Setting, std::size_t>> {};

TEST_P(MainBounds, HoldForEveryVertexAndFrame) {
  const auto& [setting, modes] = GetParam();
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const ModeBasis basis = modes > 0 ? testing::wave_basis(mesh, kSquares, modes) : ModeBasis{};
  const Sent run =
      run_sheet(testing::mesh_header(mesh, DeformableProfile::main, basis), {setting.visual, setting.weber_fraction}, 400);
  EXPECT_EQ(run.broken, 0U);
  EXPECT_GT(run.packets, 50U);
}

INSTANTIATE_TEST_SUITE_P(Settings, MainBounds,
                         ::testing::Combine(::testing::Values(Setting{2.5e-4, 0.025}, Setting{5e-5, 0.1}, Setting{1e-3, {}},
                                                              Setting{1e-3, 0.0}, Setting{0, 0.025}, Setting{0, {}},
                                                              Setting{1e3, 0.05}),
                                            ::testing::Values(0, 1, 12)));

TEST(MeshMain, BoundsHoldWithNoiseFarBeyondThem) {
  const StreamHeader header = testing::mesh_header(testing::sheet(kSquares, kSquares));
  for (const double noise : {1e-5, 5e-5, 1.5e-4, 1e-3}) EXPECT_EQ(run_sheet(header, {2.5e-4, 0.025}, 120, noise).broken, 0U);
}

/// A sheet that waves in its own modes.
std::size_t bytes_of_waves(const StreamHeader& header, const ModeBasis& basis) {
  MeshEnds ends(header, {});
  const std::size_t modes = basis.steps.size(), components = basis.entries.size() / modes;
  for (std::int64_t k = 0; k < 300; ++k) {
    SheetFrame frame{std::vector<Vec3>(components / 3), {}};
    for (std::size_t m = 0; m < modes; ++m) {
      const double a = 0.01 / 2048 * std::sin((0.05 + 0.02 * static_cast<double>(m)) * static_cast<double>(k));
      const std::int16_t* e = basis.entries.data() + m * components;
      for (std::size_t v = 0; v < components / 3; ++v)
        frame.displacement[v] = frame.displacement[v] + Vec3{a * e[3 * v], a * e[3 * v + 1], a * e[3 * v + 2]};
    }
    ends.send(k, frame);
  }
  return ends.bytes;
}

TEST(MeshMain, MotionInTheBasisCostsAFractionOfWhatItCostsWithout) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const ModeBasis basis = testing::wave_basis(mesh, kSquares, 6);
  const std::size_t without = bytes_of_waves(testing::mesh_header(mesh), basis);
  EXPECT_LT(2 * bytes_of_waves(testing::mesh_header(mesh, DeformableProfile::main, basis), basis), without);
}

TEST(MeshMain, DependentModesDoNoHarm) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  ModeBasis basis = testing::wave_basis(mesh, kSquares, 4);
  const auto copy = basis.entries;
  basis.entries.insert(basis.entries.end(), copy.begin(), copy.end());
  basis.steps.insert(basis.steps.end(), {1, 65535, 600, 600});
  EXPECT_EQ(run_sheet(testing::mesh_header(mesh, DeformableProfile::main, basis), {}, 200).broken, 0U);
}

TEST(MeshThesis, EndsAgreeAndErrorsStayWithinThresholdAndQuantiser) {
  for (const bool kept : {false, true}) {
    for (const std::uint8_t bits : {std::uint8_t{1}, std::uint8_t{8}, std::uint8_t{12}}) {
      StreamHeader header = testing::mesh_header(testing::sheet(kSquares, kSquares), DeformableProfile::thesis);
      header.meshes[0].quant_bits = bits;
      header.meshes[0].models_kept = kept;
      const Sent run = run_sheet(header, {2.5e-4, 0.025}, 300);
      EXPECT_GT(run.packets, 100U);
      if (bits == 12) {  // one bit per component cannot
        EXPECT_LT(run.worst, 2.5e-4 + 1e-6);
      }
    }
  }
}

TEST(MeshThesis, ListsWhatReachesAThreshold) {
  const StreamHeader header = testing::mesh_header(testing::sheet(4, 4), DeformableProfile::thesis);
  MeshEnds ends(header, {.thresholds = {1e-3, 0.1, 0}});
  SheetFrame frame{std::vector<Vec3>(25), SurfaceTouch{0, 1.0, 1000}};  // h = 0.1 mm
  const double unit = std::ldexp(1.0, -22);
  frame.displacement[0] = {0, 0, 1e-4 + unit};      // in the area of interest, above h
  frame.displacement[1] = {0, 0, 1e-4 - 2 * unit};  // and below
  frame.displacement[24] = {0, 1e-3 + unit, 0};     // three rings away from triangle 0 there is no vertex 24
  ends.send(0, frame);
  const auto shown = ends.decoder.displacements();
  EXPECT_NE(shown[0], (DeformableDecoder::Displacement{}));
  EXPECT_EQ(shown[1], (DeformableDecoder::Displacement{}));
  EXPECT_NE(shown[24], (DeformableDecoder::Displacement{}));
  EXPECT_EQ(std::ranges::count(shown, DeformableDecoder::Displacement{}), 23);
}

TEST(MeshExtremes, OneVertexWithoutTriangle) {
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    const StreamHeader header = testing::mesh_header({{{0, 0, 0}}, {}}, profile);
    MeshEnds ends(header, {});
    for (std::int64_t k = 0; k < 50; ++k) {
      const SheetFrame frame{{Vec3{1e-3 * static_cast<double>(k), 0, 0}}, {}};
      ends.send(k, frame);
      EXPECT_LE(norm(to_metres(ends.decoder.displacements()[0], 22) - frame.displacement[0]), 2.5e-4);
    }
    EXPECT_EQ(ends.packets, 49U);
  }
}

TEST(MeshExtremes, AtRestNothingIsSentAndNothingDrifts) {
  const TriMesh mesh = testing::sheet(2, 2);
  MeshEnds ends(testing::mesh_header(mesh, DeformableProfile::main, testing::wave_basis(mesh, 2, 2)), {});
  DentedSheet sheet(mesh, 2);
  for (std::int64_t k = 0; k < 30; ++k) ends.send(k, sheet.frame(k));
  const SheetFrame rest{sheet.frame(29).displacement, {}};
  for (std::int64_t k = 30; k < 130; ++k) ends.send(k, rest);  // motion comes to rest
  const std::uint64_t hash = ends.decoder.state_hash();
  for (std::int64_t k = 130; k < 1000130; ++k) ASSERT_TRUE(ends.encoder.encode(k, rest.displacement)->bytes.empty());
  EXPECT_EQ(ends.decoder.state_hash(), hash);
  EXPECT_EQ(ends.encoder.state_hash(), hash);
}

TEST(MeshExtremes, RangeLimitsAndJumps) {
  const TriMesh mesh = testing::sheet(3, 3);
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    const ModeBasis basis = profile == DeformableProfile::main ? testing::wave_basis(mesh, 3, 3) : ModeBasis{};
    const DeformableThresholds exact{0, {}};
    const StreamHeader header = testing::mesh_header(mesh, profile, basis);
    MeshEnds ends(header, {.thresholds = exact});
    BoundWatch watch(header, exact);
    for (std::int64_t k = 0; k < 40; ++k) {
      const double far = k % 2 == 0 ? 32.0 : -32.0;  // 2^27 units of 2^-22 m
      SheetFrame frame{std::vector<Vec3>(16, Vec3{far, -far, far}), {}};
      frame.displacement[5] = {0, 0, 0};
      ends.send(k, frame);
      watch.look(frame, ends.decoder.displacements());
    }
    EXPECT_EQ(ends.packets, 40U);
    if (profile == DeformableProfile::main) {
      EXPECT_EQ(watch.broken(), 0U);
    }
  }
}

TEST(MeshExtremes, OneVertexJumpsEveryFrameAndNobodyTouches) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const double visual : {0.0, 2.5e-4}) {
    const StreamHeader header = testing::mesh_header(mesh, DeformableProfile::main, testing::wave_basis(mesh, kSquares, 4));
    MeshEnds ends(header, {.thresholds = {visual, 0.025}});
    BoundWatch watch(header, {visual, 0.025});
    SheetFrame frame{std::vector<Vec3>(mesh.vertices.size()), {}};
    for (std::int64_t k = 0; k < 3000; ++k) {
      frame.displacement[70] = {0, 0, k % 2 == 0 ? 0.02 : -0.02};
      ends.send(k, frame);
      watch.look(frame, ends.decoder.displacements_at(k));
    }
    EXPECT_EQ(watch.broken(), 0U);
    EXPECT_EQ(ends.packets, 3000U);
  }
}

/// As large as a mesh may be: header and packets pass with the limits that decoders have by default.
TEST(MeshExtremes, AMillionVertices) {
  const TriMesh mesh = testing::sheet(1023, 1023);
  ASSERT_EQ(mesh.vertices.size(), kMaxMeshVertices);
  const DeformableThresholds exact{0, {}};
  const StreamHeader header = parse_header(write_header(testing::mesh_header(mesh)).value()).value().header;
  MeshEnds ends(header, {.thresholds = exact});
  SheetFrame frame{std::vector<Vec3>(mesh.vertices.size()), {}};
  for (std::int64_t k = 0; k < 2; ++k) {
    for (std::size_t v = 0; v < frame.displacement.size(); ++v)
      frame.displacement[v] = {30 * std::sin(static_cast<double>(v * v)), -31.0 * static_cast<double>(k), 0.001};
    ends.send(k, frame);
    if (HasFatalFailure()) return;
    const double unit = std::ldexp(1.0, -22);
    for (std::size_t v = 0; v < frame.displacement.size(); v += 997)
      EXPECT_LE(norm(to_metres(ends.decoder.displacements()[v], 22) - frame.displacement[v]), unit);
  }
  EXPECT_EQ(ends.packets, 2U);
}

TEST(MeshExtremes, VanishingForceAndVanishingStiffness) {
  const StreamHeader header = testing::mesh_header(testing::sheet(4, 4));
  for (const SurfaceTouch touch : {SurfaceTouch{3, 0, 500}, SurfaceTouch{3, 5, 1e-300}, SurfaceTouch{3, 1e300, 1}}) {
    for (const double floor : {0.0, 2e-4}) {
      const DeformableThresholds thresholds{2.5e-4, 0.025, floor};
      MeshEnds ends(header, {.thresholds = thresholds});
      BoundWatch watch(header, thresholds);
      for (std::int64_t k = 0; k < 20; ++k) {
        SheetFrame frame{std::vector<Vec3>(25, Vec3{1e-5 * static_cast<double>(k), 0, 3e-5}), touch};
        ends.send(k, frame);
        watch.look(frame, ends.decoder.displacements_at(k));
      }
      EXPECT_EQ(watch.broken(), 0U);
    }
  }
}

TEST(MeshExtremes, Slivers) {
  TriMesh mesh;
  for (int i = 0; i < 60; ++i) mesh.vertices.push_back({i * 1e-3, i % 2 * 1e-9, 0});
  for (std::uint32_t i = 0; i + 2 < 60; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  MeshEnds ends(testing::mesh_header(mesh), {.thresholds = {1e-5, {}}});
  BoundWatch watch(ends.encoder.header(), {1e-5, {}});
  for (std::int64_t k = 0; k < 50; ++k) {
    SheetFrame frame{std::vector<Vec3>(60), {}};
    for (std::size_t v = 0; v < 60; ++v)
      frame.displacement[v].y = 1e-3 * std::sin(0.1 * static_cast<double>(v) + 0.3 * static_cast<double>(k));
    ends.send(k, frame);
    watch.look(frame, ends.decoder.displacements_at(k));
  }
  EXPECT_EQ(watch.broken(), 0U);
}

TEST(DeformableEncoder, RefusesWhatIsNotFiniteOrOutOfRangeAndGoesOn) {
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    const TriMesh mesh = testing::sheet(kSquares, kSquares);
    DentedSheet sheet(mesh, kSquares);
    MeshEnds ends(testing::mesh_header(mesh, profile), {});
    const SheetFrame good = sheet.frame(20);
    ends.send(0, good);
    const std::uint64_t hash = ends.encoder.state_hash();
    constexpr double kInf = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
    const auto refused = [&](const SheetFrame& frame, std::int64_t tick, std::string_view rule) {
      const auto packet = ends.encoder.encode(tick, frame.displacement, frame.touch);
      ASSERT_FALSE(packet) << rule;
      EXPECT_EQ(packet.error().code, Errc::invalid_argument);
      EXPECT_EQ(packet.error().rule, rule);
      EXPECT_EQ(ends.encoder.state_hash(), hash);
    };
    for (const double bad : {kNan, kInf, -kInf}) {
      SheetFrame frame = good;
      frame.displacement[77].y = bad;
      refused(frame, 1, "R-API-1");
      frame = good;
      frame.touch = SurfaceTouch{0, bad, 500};
      refused(frame, 1, "R-API-1");
    }
    SheetFrame frame = good;
    frame.displacement[0].x = 32.1;
    refused(frame, 1, "R-API-2");
    frame.displacement[0].x = -1e300;
    refused(frame, 1, "R-API-2");
    refused(good, 0, "R-API-5");  // the tick was there
    refused({std::vector<Vec3>(3), {}}, 1, "R-API-5");
    for (const SurfaceTouch touch :
         {SurfaceTouch{1000000, 1, 500}, SurfaceTouch{0, -1, 500}, SurfaceTouch{0, 1, 0}, SurfaceTouch{0, 1, -3}})
      refused({good.displacement, touch}, 1, "R-API-5");
    ends.send(1, sheet.frame(30));
    EXPECT_EQ(ends.packets, 2U);
  }
}

TEST(DeformableEncoder, RefusesOptions) {
  const StreamHeader header = testing::mesh_header(testing::sheet(2, 2));
  const auto rule = [&](const auto& change) {
    DeformableEncoderOptions options;
    change(options);
    const auto encoder = DeformableEncoder::create(header, 0, options);
    return encoder ? std::string("none") : std::string(encoder.error().rule);
  };
  EXPECT_EQ(rule([](DeformableEncoderOptions&) {}), "none");
  EXPECT_EQ(rule([](DeformableEncoderOptions& o) { o.thresholds.visual = -1; }), "R-API-4");
  EXPECT_EQ(rule([](DeformableEncoderOptions& o) { o.thresholds.visual = std::nan(""); }), "R-API-4");
  EXPECT_EQ(rule([](DeformableEncoderOptions& o) { o.thresholds.weber_fraction = -0.1; }), "R-API-4");
  EXPECT_EQ(rule([](DeformableEncoderOptions& o) { o.thresholds.depth_floor = std::nan(""); }), "R-API-4");
  EXPECT_EQ(rule([](DeformableEncoderOptions& o) { o.haptic_share = 0; }), "R-API-4");
  EXPECT_EQ(rule([](DeformableEncoderOptions& o) { o.visual_share = 1.5; }), "R-API-4");
  EXPECT_STREQ(DeformableEncoder::create(header, 1).error().rule, "R-API-5");
}

TEST(DeformableEncoder, KeyPacketsBuildOnTheInitialState) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const StreamHeader header = testing::mesh_header(mesh, DeformableProfile::main, testing::wave_basis(mesh, kSquares, 8));
  DentedSheet sheet(mesh, kSquares);
  MeshEnds ends(header, {.thresholds = {}, .key_interval = 0.5});
  std::size_t keys = 0;
  for (std::int64_t k = 0; k < 240; ++k) {
    const auto packet = ends.encoder.encode(k, sheet.frame(k).displacement);
    ASSERT_TRUE(packet);
    if (packet->bytes.empty()) continue;
    ASSERT_TRUE(ends.decoder.decode(packet->bytes));
    if (!packet->key) continue;
    ++keys;
    auto fresh = DeformableDecoder::create(header, 0).value();
    ASSERT_TRUE(fresh.decode(packet->bytes));
    EXPECT_EQ(fresh.state_hash(), ends.decoder.state_hash());
  }
  EXPECT_GE(keys, 4U);
}

TEST(DeformableEncoder, AllocatesNothingAfterSetUp) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    StreamHeader header = testing::mesh_header(
        mesh, profile, profile == DeformableProfile::main ? testing::wave_basis(mesh, kSquares, 8) : ModeBasis{});
    header.meshes[0].models_kept = true;
    header.baseline_span = 3;
    DentedSheet sheet(mesh, kSquares);
    MeshEnds ends(header, {.thresholds = {}, .key_interval = 0.3});
    std::vector<SheetFrame> frames;
    for (std::int64_t k = 0; k < 120; ++k) frames.push_back(sheet.frame(k));
    const std::uint64_t before = testing::allocated_bytes();
    std::size_t decoded = 0;
    for (std::int64_t k = 0; k < 120; ++k) {
      const SheetFrame& frame = frames[static_cast<std::size_t>(k)];
      const auto packet = ends.encoder.encode(k, frame.displacement, frame.touch);
      if (packet && !packet->bytes.empty()) decoded += ends.decoder.decode(packet->bytes).has_value() ? 1U : 0U;
      (void)ends.decoder.displacements_at(k);
    }
    EXPECT_EQ(testing::allocated_bytes(), before);
    EXPECT_GT(decoded, 40U);
  }
}

}  // namespace
}  // namespace tactus
