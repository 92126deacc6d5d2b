// SPDX-License-Identifier: Apache-2.0
/// Meshes of profile thesis: lists of vertices, errors on one scale; and what is refused without component thesis.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactus/player.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/thesis/thesis.h>
#include "tests/fuzz/sections.h"
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using testing::BoundWatch;
using testing::DentedSheet;
using testing::kWithThesis;
using testing::moved_by;
using testing::set_vertex;
using testing::SheetEnds;
using testing::SheetFrame;

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kSquares = 12;
constexpr std::int64_t kFrames = 300;

SceneSpec sheet_spec(const TriMesh& mesh) { return testing::sheet_spec(mesh, DeformableProfile::thesis); }

SenderOptions options(double key_interval, const DeformableThresholds& thresholds = {}) {
  return {.triggers = {}, .deformable = {.thresholds = thresholds}, .policy = {.key_interval = key_interval}};
}

// ==== the component ====

/// A sheet of profile main, and one of profile thesis; their declaration, and where in it the profile of each is.
struct Declared {
  SceneSpec spec;
  Bytes bytes;
  std::size_t main_at = 0, thesis_at = 0;
};

/// magic, version, profile, flags, body_size; tick_rate, exponents, max_extrapolation, baseline_span; counts of objects of either kind, of a
/// byte each.
constexpr std::size_t kFirstObject = (4 + 1 + 1 + 2 + 4) + (4 + 4 + 2 + 1) + (1 + 1);

Declared declared() {
  Declared out;
  out.spec = testing::sheet_spec(testing::sheet(1, 1), DeformableProfile::main);
  const std::size_t one = write_scene(*testing::shared(out.spec)).value().size();
  const TriMesh mesh = testing::sheet(1, 1);
  out.spec.deformables.push_back(make_deformable_object("thesis", mesh, out.spec.grid.position).value());
  out.spec.deformables[1].profile = DeformableProfile::thesis;
  out.bytes = write_scene(*testing::shared(out.spec, kWithThesis)).value();
  out.main_at = kFirstObject;
  out.thesis_at = one - 4;  // in place of the check value
  return out;
}

void expect_unsupported(const Error& error, const char* rule) {
  EXPECT_EQ(error.code, Errc::unsupported);
  EXPECT_STREQ(error.rule, rule);
  EXPECT_EQ(advice(error), Advice::close);
}

TEST(ThesisComponent, WithoutItADeclarationOfItsMeshesIsUnsupported) {
  const Declared scene = declared();
  ASSERT_EQ(scene.bytes[scene.main_at], static_cast<std::uint8_t>(DeformableProfile::main));
  ASSERT_EQ(scene.bytes[scene.thesis_at], static_cast<std::uint8_t>(DeformableProfile::thesis));
  const auto parsed = parse_scene(scene.bytes);
  ASSERT_FALSE(parsed);
  expect_unsupported(parsed.error(), "R-DEF-2");
  EXPECT_EQ(parsed.error().bit_offset, 8 * (scene.thesis_at + 1)) << "behind the profile";
  for (const Error& error : {StreamFileReader::open(scene.bytes).error(), Player::open(scene.bytes).error()}) {
    expect_unsupported(error, "R-DEF-2");
    EXPECT_EQ(error.bit_offset, parsed.error().bit_offset);
  }
  const auto with = parse_scene(scene.bytes, kWithThesis);
  ASSERT_TRUE(with) << with.error().rule;
  EXPECT_EQ(with->scene->deformables, scene.spec.deformables);
  EXPECT_TRUE(StreamFileReader::open(scene.bytes, kWithThesis));
  EXPECT_TRUE(Player::open(scene.bytes, {.replica = {}, .limits = kWithThesis}));
  EXPECT_TRUE(Receiver::create(with->scene)) << "the scene has the component";
}

/// Where the profile of an object is one that nobody knows.
TEST(ThesisComponent, AMeshIsRefusedWhereOneOfNoProfileIs) {
  Declared scene = declared();
  const std::uint64_t without = parse_scene(scene.bytes).error().bit_offset;
  scene.bytes[scene.thesis_at] = 2;
  testing::repair(scene.bytes);
  for (const DecodeLimits& limits : {DecodeLimits{}, kWithThesis}) {
    const auto parsed = parse_scene(scene.bytes, limits);
    ASSERT_FALSE(parsed);
    expect_unsupported(parsed.error(), "R-DEF-2");
    EXPECT_EQ(parsed.error().bit_offset, without);
  }
}

TEST(ThesisComponent, WithoutItNoSceneOfItsMeshesIsMade) {
  const Declared scene = declared();
  const auto created = Scene::create(scene.spec);
  ASSERT_FALSE(created);
  expect_unsupported(created.error(), "R-DEF-2");
  const auto checked = check_scene(scene.spec);
  ASSERT_FALSE(checked);
  expect_unsupported(checked.error(), "R-DEF-2");
  EXPECT_TRUE(check_scene(scene.spec, kWithThesis));
  const auto builder = [] {
    SceneBuilder out;
    out.deformable("main", testing::sheet(1, 1)).deformable("bad", testing::sheet(1, 1), {.profile = DeformableProfile::thesis});
    return out;
  };
  const auto built = builder().build();
  ASSERT_FALSE(built);
  expect_unsupported(built.error().error, "R-DEF-2");
  EXPECT_EQ(built.error().object, "bad");
  EXPECT_TRUE(builder().build(kWithThesis));
}

/// Nothing else is: rigid objects as the thesis codes them, and meshes of profile main.
TEST(ThesisComponent, IsNotNeededForWhatHasNoMeshOfIt) {
  EXPECT_TRUE(SceneBuilder().rigid("cube").rigid_profile(RigidProfile::thesis).build());
  const SharedScene main = testing::shared(testing::sheet_spec(testing::sheet(1, 1)));
  EXPECT_TRUE(parse_scene(write_scene(*main).value()));
  EXPECT_TRUE(Receiver::create(main));
}

// ==== meshes ====

struct Sent {
  std::size_t packets = 0;
  double worst = 0;  // [m]
};

Sent run_sheet(const SceneSpec& spec, std::int64_t frames) {
  const DeformableThresholds thresholds{2.5e-4, 0.025};
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  DentedSheet sheet(mesh, kSquares);
  SheetEnds ends(testing::shared(spec, kWithThesis), options(5, thresholds));
  BoundWatch watch(*ends.sender.scene(), thresholds);
  for (std::int64_t k = 0; k < frames; ++k) {
    const SheetFrame frame = sheet.frame(k);
    ends.send(k, frame);
    if (::testing::Test::HasFatalFailure()) return {};
    watch.look(frame, ends.shown(k));
  }
  return {ends.packets, watch.worst()};
}

TEST(ThesisMesh, EndsAgreeAndErrorsStayWithinThresholdAndQuantiser) {
  for (const bool kept : {false, true}) {
    for (const std::uint8_t bits : {std::uint8_t{1}, std::uint8_t{8}, std::uint8_t{12}}) {
      SceneSpec spec = sheet_spec(testing::sheet(kSquares, kSquares));
      spec.deformables[0].quant_bits = bits;
      spec.deformables[0].models_kept = kept;
      const Sent run = run_sheet(spec, 300);
      EXPECT_GT(run.packets, 100U);
      if (bits == 12) {  // one bit per component cannot
        EXPECT_LT(run.worst, 2.5e-4 + 1e-6);
      }
    }
  }
}

TEST(ThesisMesh, ListsWhatReachesAThreshold) {
  SheetEnds ends(testing::shared(sheet_spec(testing::sheet(4, 4)), kWithThesis), options(5, {1e-3, 0.1, 0}));
  SheetFrame frame{moved_by(25, {}), SurfaceTouch{0, 1.0, 1000}};  // h = 0.1 mm
  const double unit = std::ldexp(1.0, -22);
  set_vertex(frame.displacements, 0, {0, 0, 1e-4 + unit});      // in the area of interest, above h
  set_vertex(frame.displacements, 1, {0, 0, 1e-4 - 2 * unit});  // and below
  set_vertex(frame.displacements, 24, {0, 1e-3 + unit, 0});     // three rings away from triangle 0 there is no vertex 24
  ends.send(0, frame);
  const auto shown = ends.receiver.decoded_displacements(0);
  EXPECT_NE(shown[0], Vec3i{});
  EXPECT_EQ(shown[1], Vec3i{});
  EXPECT_NE(shown[24], Vec3i{});
  EXPECT_EQ(std::ranges::count(shown, Vec3i{}), 23);
}

TEST(ThesisMesh, ListsWhatIsRenderedInAPacketOfItsOwn) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  SceneSpec spec = sheet_spec(mesh);
  spec.deformables[0].quant_bits = 12;
  spec.deformables[0].layered = true;
  const SharedScene scene = testing::shared(std::move(spec), kWithThesis);
  SheetEnds ends(scene, options(1));
  DentedSheet sheet(mesh, kSquares);
  BoundWatch watch(*scene, {});
  Rings rings(scene->deformables[0]);
  std::vector<Vec3i> before(mesh.vertices.size());
  for (std::int64_t k = 0; k < kFrames; ++k) {
    const SheetFrame frame = sheet.frame(k);
    for (const Packet& packet : testing::all(ends.encode(k, frame))) {
      ends.deliver(packet, k);
      if (packet.layer != Layer::haptic || packet.key) continue;
      rings.triangles_around(frame.touch->triangle, scene->deformables[0].rings);
      const auto shown = ends.receiver.decoded_displacements(0);
      for (std::uint32_t v = 0; v < before.size(); ++v) {
        if (std::ranges::count(rings.vertices(), v) > 0) continue;
        ASSERT_EQ(shown[v], before[v]);
      }
    }
    ends.agree(k);
    if (HasFatalFailure()) return;
    const auto shown = ends.receiver.decoded_displacements(0);
    before.assign(shown.begin(), shown.end());
    watch.look(frame, shown);
  }
  EXPECT_LT(watch.worst(), DeformableThresholds{}.visual + 1e-6);
  EXPECT_GT(ends.layers[0], 100U);
  EXPECT_GT(ends.layers[1], 100U);
  EXPECT_EQ(ends.layers[2], 0U);
}

/// A key packet that would list nothing, because the object is back in the initial state.
TEST(ThesisMesh, KeyPacketsListAVertexAtLeast) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  for (const bool layered : {false, true}) {
    SceneSpec spec = sheet_spec(mesh);
    spec.deformables[0].layered = layered;
    SheetEnds ends(testing::shared(std::move(spec), kWithThesis), options(0.1));
    for (std::int64_t k = 0; k < 60; ++k) {
      const SheetFrame frame{testing::moved_by(mesh.vertices.size(), {0, 0, k % 13 < 6 ? 0.01 : 0}),
                             k % 2 == 0 ? std::optional(SurfaceTouch{5, 1, 500}) : std::nullopt};
      ends.send(k, frame);
      if (HasFatalFailure()) return;
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        ASSERT_LT(norm(to_metres(ends.receiver.decoded_displacements(0)[v], 22) - testing::vertex_of(frame.displacements, v)),
                  3e-4)
            << k;
    }
  }
}

}  // namespace
}  // namespace tactus
