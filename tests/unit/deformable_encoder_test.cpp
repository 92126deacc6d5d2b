// SPDX-License-Identifier: Apache-2.0
/// Bounds hold on what the receiver shows, for every vertex and every frame; both ends hold the same state after every packet.
#include <tactus/sender.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "tests/property/allocated.h"
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using testing::BoundWatch;
using testing::DentedSheet;
using testing::moved_by;
using testing::set_vertex;
using testing::shared;
using testing::sheet_spec;
using testing::SheetEnds;
using testing::SheetFrame;
using testing::vertex_of;

constexpr std::uint32_t kSquares = 12;

struct Sent {
  std::size_t packets = 0, broken = 0;
  double worst = 0;  // [m]
};

SenderOptions with(const DeformableThresholds& thresholds) {
  return {.triggers = {}, .deformable = {.thresholds = thresholds}, .policy = {}};
}

Sent run_sheet(const SceneSpec& spec, const DeformableThresholds& thresholds, std::int64_t frames, double noise = 0) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  DentedSheet sheet(mesh, kSquares, noise);
  SheetEnds ends(shared(spec), with(thresholds));
  BoundWatch watch(*ends.sender.scene(), thresholds);
  for (std::int64_t k = 0; k < frames; ++k) {
    const SheetFrame frame = sheet.frame(k);
    ends.send(k, frame);
    if (::testing::Test::HasFatalFailure()) return {};
    watch.look(frame, ends.shown(k));
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
  const Sent run = run_sheet(sheet_spec(mesh, DeformableProfile::main, basis), {setting.visual, setting.weber_fraction}, 400);
  EXPECT_EQ(run.broken, 0U);
  EXPECT_GT(run.packets, 50U);
}

INSTANTIATE_TEST_SUITE_P(Settings, MainBounds,
                         ::testing::Combine(::testing::Values(Setting{2.5e-4, 0.025}, Setting{5e-5, 0.1}, Setting{1e-3, {}},
                                                              Setting{1e-3, 0.0}, Setting{0, 0.025}, Setting{0, {}},
                                                              Setting{1e3, 0.05}),
                                            ::testing::Values(0, 1, 12)));

TEST(DeformableMain, BoundsHoldWithNoiseFarBeyondThem) {
  const SceneSpec spec = sheet_spec(testing::sheet(kSquares, kSquares));
  for (const double noise : {1e-5, 5e-5, 1.5e-4, 1e-3}) EXPECT_EQ(run_sheet(spec, {2.5e-4, 0.025}, 120, noise).broken, 0U);
}

/// A sheet that waves in its own modes.
std::size_t bytes_of_waves(const SceneSpec& spec, const ModeBasis& basis) {
  SheetEnds ends(shared(spec));
  const std::size_t modes = basis.steps.size(), components = basis.entries.size() / modes;
  for (std::int64_t k = 0; k < 300; ++k) {
    std::vector<double> shape(components);
    for (std::size_t m = 0; m < modes; ++m) {
      const double a = 0.01 / 2048 * std::sin((0.05 + 0.02 * static_cast<double>(m)) * static_cast<double>(k));
      const std::int16_t* e = basis.entries.data() + m * components;
      for (std::size_t i = 0; i < components; ++i) shape[i] += a * e[i];
    }
    SheetFrame frame;
    for (const double u : shape) frame.displacements.push_back(static_cast<float>(u));
    ends.send(k, frame);
  }
  return ends.bytes;
}

TEST(DeformableMain, MotionInTheBasisCostsAFractionOfWhatItCostsWithout) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const ModeBasis basis = testing::wave_basis(mesh, kSquares, 6);
  const std::size_t without = bytes_of_waves(sheet_spec(mesh), basis);
  EXPECT_LT(2 * bytes_of_waves(sheet_spec(mesh, DeformableProfile::main, basis), basis), without);
}

TEST(DeformableMain, DependentModesDoNoHarm) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  ModeBasis basis = testing::wave_basis(mesh, kSquares, 4);
  const auto copy = basis.entries;
  basis.entries.insert(basis.entries.end(), copy.begin(), copy.end());
  basis.steps.insert(basis.steps.end(), {1, 65535, 600, 600});
  EXPECT_EQ(run_sheet(sheet_spec(mesh, DeformableProfile::main, basis), {}, 200).broken, 0U);
}

TEST(DeformableExtremes, OneVertexWithoutTriangle) {
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    SheetEnds ends(shared(sheet_spec({{{0, 0, 0}}, {}}, profile), testing::kWithThesis));
    for (std::int64_t k = 0; k < 50; ++k) {
      const SheetFrame frame{moved_by(1, {1e-3 * static_cast<double>(k), 0, 0}), {}};
      ends.send(k, frame);
      EXPECT_LE(norm(to_metres(ends.receiver.decoded_displacements(0)[0], 22) - vertex_of(frame.displacements, 0)),
                DeformableThresholds{}.visual);
    }
    EXPECT_EQ(ends.packets, 49U);
  }
}

TEST(DeformableExtremes, AtRestNothingIsSentAndNothingDrifts) {
  const TriMesh mesh = testing::sheet(2, 2);
  SheetEnds ends(shared(sheet_spec(mesh, DeformableProfile::main, testing::wave_basis(mesh, 2, 2))));
  DentedSheet sheet(mesh, 2);
  for (std::int64_t k = 0; k < 30; ++k) ends.send(k, sheet.frame(k));
  const SheetFrame rest{sheet.frame(29).displacements, {}};
  for (std::int64_t k = 30; k < 130; ++k) ends.send(k, rest);  // motion comes to rest
  const std::uint64_t hash = ends.receiver.state_hash(1);
  for (std::int64_t k = 130; k < 1000130; ++k) ASSERT_TRUE(ends.encode(k, rest)->empty());
  EXPECT_EQ(ends.receiver.state_hash(1), hash);
  EXPECT_EQ(ends.sender.state_hash(1), hash);
}

TEST(DeformableExtremes, RangeLimitsAndJumps) {
  const TriMesh mesh = testing::sheet(3, 3);
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    const ModeBasis basis = profile == DeformableProfile::main ? testing::wave_basis(mesh, 3, 3) : ModeBasis{};
    const DeformableThresholds exact{0, {}};
    SheetEnds ends(shared(sheet_spec(mesh, profile, basis), testing::kWithThesis), with(exact));
    BoundWatch watch(*ends.sender.scene(), exact);
    for (std::int64_t k = 0; k < 40; ++k) {
      const double far = k % 2 == 0 ? 32.0 : -32.0;  // 2^27 units of 2^-22 m
      SheetFrame frame{moved_by(16, {far, -far, far}), {}};
      set_vertex(frame.displacements, 5, {});
      ends.send(k, frame);
      watch.look(frame, ends.receiver.decoded_displacements(0));
    }
    EXPECT_EQ(ends.packets, 40U);
    if (profile == DeformableProfile::main) {
      EXPECT_EQ(watch.broken(), 0U);
    }
  }
}

TEST(DeformableExtremes, OneVertexJumpsEveryFrameAndNobodyTouches) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const double visual : {0.0, 2.5e-4}) {
    SheetEnds ends(shared(sheet_spec(mesh, DeformableProfile::main, testing::wave_basis(mesh, kSquares, 4))),
                   with({visual, 0.025}));
    BoundWatch watch(*ends.sender.scene(), {visual, 0.025});
    SheetFrame frame{moved_by(mesh.vertices.size(), {}), {}};
    for (std::int64_t k = 0; k < 3000; ++k) {
      set_vertex(frame.displacements, 70, {0, 0, k % 2 == 0 ? 0.02 : -0.02});
      ends.send(k, frame);
      watch.look(frame, ends.shown(k));
    }
    EXPECT_EQ(watch.broken(), 0U);
    EXPECT_EQ(ends.packets, 3000U);
  }
}

/// As large as a mesh may be: scene and packets pass with the limits that receivers have by default.
TEST(DeformableExtremes, AMillionVertices) {
  const TriMesh mesh = testing::sheet(1023, 1023);
  ASSERT_EQ(mesh.vertices.size(), kMaxMeshVertices);
  const DeformableThresholds exact{0, {}};
  SheetEnds ends(parse_scene(write_scene(*shared(sheet_spec(mesh))).value()).value().scene, with(exact));
  SheetFrame frame{moved_by(mesh.vertices.size(), {}), {}};
  for (std::int64_t k = 0; k < 2; ++k) {
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      set_vertex(frame.displacements, v, {30 * std::sin(static_cast<double>(v * v)), -31.0 * static_cast<double>(k), 0.001});
    ends.send(k, frame);
    if (HasFatalFailure()) return;
    const double unit = std::ldexp(1.0, -22);
    for (std::size_t v = 0; v < mesh.vertices.size(); v += 997)
      EXPECT_LE(norm(to_metres(ends.receiver.decoded_displacements(0)[v], 22) - vertex_of(frame.displacements, v)), unit);
  }
  EXPECT_EQ(ends.packets, 2U);
}

TEST(DeformableExtremes, VanishingForceAndVanishingStiffness) {
  const SharedScene scene = shared(sheet_spec(testing::sheet(4, 4)));
  for (const SurfaceTouch touch : {SurfaceTouch{3, 0, 500}, SurfaceTouch{3, 5, 1e-300}, SurfaceTouch{3, 1e300, 1}}) {
    for (const double floor : {0.0, 2e-4}) {
      const DeformableThresholds thresholds{2.5e-4, 0.025, floor};
      SheetEnds ends(scene, with(thresholds));
      BoundWatch watch(*scene, thresholds);
      for (std::int64_t k = 0; k < 20; ++k) {
        const SheetFrame frame{moved_by(25, {1e-5 * static_cast<double>(k), 0, 3e-5}), touch};
        ends.send(k, frame);
        watch.look(frame, ends.shown(k));
      }
      EXPECT_EQ(watch.broken(), 0U);
    }
  }
}

/// Triangles that have no area on the grid: nobody makes such an object, but a scene may declare it.
TEST(DeformableExtremes, Slivers) {
  SceneSpec spec = sheet_spec({{{0, 0, 0}}, {}});
  DeformableObject& object = spec.deformables[0];
  object.rest.clear();
  for (std::int32_t i = 0; i < 60; ++i) object.rest.push_back({i << 12, 0, 0});
  for (std::uint32_t i = 0; i + 2 < 60; ++i) object.triangles.push_back({i, i + 1, i + 2});
  SheetEnds ends(shared(spec), with({1e-5, {}}));
  BoundWatch watch(*ends.sender.scene(), {1e-5, {}});
  for (std::int64_t k = 0; k < 50; ++k) {
    SheetFrame frame{moved_by(60, {}), {}};
    for (std::size_t v = 0; v < 60; ++v)
      set_vertex(frame.displacements, v, {0, 1e-3 * std::sin(0.1 * static_cast<double>(v) + 0.3 * static_cast<double>(k)), 0});
    ends.send(k, frame);
    watch.look(frame, ends.shown(k));
  }
  EXPECT_EQ(watch.broken(), 0U);
}

TEST(DeformableEncoder, HoldsWhatIsNotFiniteOrOutOfRangeAndGoesOn) {
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    const TriMesh mesh = testing::sheet(kSquares, kSquares);
    DentedSheet sheet(mesh, kSquares);
    SheetEnds ends(shared(sheet_spec(mesh, profile), testing::kWithThesis));
    const SheetFrame good = sheet.frame(20);
    ends.send(0, good);
    std::int64_t tick = 0;
    constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
    const auto refused = [&](const SheetFrame& frame, std::int64_t at) {
      const std::uint64_t hash = ends.sender.state_hash(1);
      const auto packets = ends.encode(at, frame);
      ASSERT_FALSE(packets);
      EXPECT_STREQ(packets.error().rule, "R-API-5");
      EXPECT_EQ(ends.sender.state_hash(1), hash);
    };
    const auto held = [&](const SheetFrame& frame, TruthPart part, std::string_view rule) {
      ASSERT_TRUE(ends.encode(++tick, frame)->empty()) << "the last shape is shown";
      ASSERT_EQ(ends.sender.held().size(), 1u) << rule;
      const HeldPart& found = ends.sender.held()[0];
      EXPECT_TRUE(found.part == part && found.rule == rule) << found.rule;
    };
    for (const float bad : {kNan, kInf, -kInf}) {
      SheetFrame frame = good;
      frame.displacements[3 * 77 + 1] = bad;
      held(frame, TruthPart::shape, "R-API-1");
      frame = good;
      frame.touch = SurfaceTouch{0, static_cast<double>(bad), 500};
      held(frame, TruthPart::touch, "R-API-1");
    }
    SheetFrame frame = good;
    frame.displacements[0] = 32.1F;
    held(frame, TruthPart::shape, "R-API-2");
    frame.displacements[0] = std::numeric_limits<float>::lowest();
    held(frame, TruthPart::shape, "R-API-2");
    refused(good, tick);  // the tick was there
    refused({moved_by(3, {}), {}}, tick + 1);
    for (const SurfaceTouch touch :
         {SurfaceTouch{1000000, 1, 500}, SurfaceTouch{0, -1, 500}, SurfaceTouch{0, 1, 0}, SurfaceTouch{0, 1, -3}})
      held({good.displacements, touch}, TruthPart::touch, "R-API-15");
    ends.send(++tick, sheet.frame(30));
    EXPECT_TRUE(ends.sender.held().empty());
    EXPECT_EQ(ends.packets, 2U);
  }
}

TEST(DeformableEncoder, RefusesOptions) {
  const SharedScene scene = shared(sheet_spec(testing::sheet(2, 2)));
  const auto rule = [&](const auto& change) {
    SenderOptions options;
    change(options.deformable);
    const auto sender = Sender::create(scene, options);
    return sender ? std::string("none") : std::string(sender.error().rule);
  };
  EXPECT_EQ(rule([](DeformableOptions&) {}), "none");
  EXPECT_EQ(rule([](DeformableOptions& o) { o.thresholds.visual = -1; }), "R-API-4");
  EXPECT_EQ(rule([](DeformableOptions& o) { o.thresholds.visual = std::nan(""); }), "R-API-4");
  EXPECT_EQ(rule([](DeformableOptions& o) { o.thresholds.weber_fraction = -0.1; }), "R-API-4");
  EXPECT_EQ(rule([](DeformableOptions& o) { o.thresholds.depth_floor = std::nan(""); }), "R-API-4");
  EXPECT_EQ(rule([](DeformableOptions& o) { o.haptic_fraction = 0; }), "R-API-4");
  EXPECT_EQ(rule([](DeformableOptions& o) { o.visual_fraction = 1.5; }), "R-API-4");
}

TEST(DeformableEncoder, KeyPacketsBuildOnTheInitialState) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const SharedScene scene = shared(sheet_spec(mesh, DeformableProfile::main, testing::wave_basis(mesh, kSquares, 8)));
  DentedSheet sheet(mesh, kSquares);
  SheetEnds ends(scene, {.triggers = {}, .deformable = {}, .policy = {.key_interval = 0.5}});
  std::size_t keys = 0;
  for (std::int64_t k = 0; k < 240; ++k) {
    const Packet packet = testing::only(ends.encode(k, {sheet.frame(k).displacements, {}}));
    if (packet.bytes.empty()) continue;
    ASSERT_TRUE(ends.receiver.push(packet.number, packet.bytes));
    if (!packet.key) continue;
    ++keys;
    auto fresh = Receiver::create(scene).value();
    ASSERT_TRUE(fresh.push(packet.number, packet.bytes));
    EXPECT_EQ(fresh.state_hash(1), ends.receiver.state_hash(1));
  }
  EXPECT_GE(keys, 4U);
}

TEST(DeformableEncoder, AllocatesNothingAfterSetUp) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const DeformableProfile profile : {DeformableProfile::thesis, DeformableProfile::main}) {
    SceneSpec spec =
        sheet_spec(mesh, profile, profile == DeformableProfile::main ? testing::wave_basis(mesh, kSquares, 8) : ModeBasis{});
    spec.deformables[0].models_kept = true;
    spec.baseline_span = 3;
    DentedSheet sheet(mesh, kSquares);
    SheetEnds ends(shared(spec, testing::kWithThesis), {.triggers = {}, .deformable = {}, .policy = {.key_interval = 0.3}});
    std::vector<SheetFrame> frames;
    for (std::int64_t k = 0; k < 120; ++k) frames.push_back(sheet.frame(k));
    const std::uint64_t before = testing::allocated_bytes();
    std::size_t decoded = 0;
    for (std::int64_t k = 0; k < 120; ++k) {
      const auto packets = ends.encode(k, frames[static_cast<std::size_t>(k)]);
      if (!packets) break;
      for (const Packet& packet : *packets) decoded += ends.receiver.push(packet.number, packet.bytes).has_value() ? 1U : 0U;
      (void)ends.shown(k);
    }
    EXPECT_EQ(testing::allocated_bytes(), before);
    EXPECT_GT(decoded, 40U);
  }
}

}  // namespace
}  // namespace tactus
