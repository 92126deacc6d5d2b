// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/scene_builder.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(SceneBuilder, MetresGoToTheNearestPointOfTheGrid) {
  const double half = std::sqrt(0.5);
  const auto built = SceneBuilder(500)
                         .rigid("cube", {{0.25, -1.0, 3.4e-7}, {1.0005 * half, 0, 0, -1.0005 * half}})
                         .rigid("table", {}, {.dof = Dof::none})
                         .rigid("slider", {{-0.25, 0, 0}, {}}, {.dof = Dof::x})
                         .build();
  ASSERT_TRUE(built);
  const Scene& scene = **built;
  EXPECT_EQ(scene.tick_rate, 500u);
  EXPECT_EQ(scene.grid, GridExponents{});
  EXPECT_EQ(scene.max_extrapolation, 1000) << "2 s";
  EXPECT_EQ(scene.baseline_span, 1);
  EXPECT_FALSE(scene.bounds);
  ASSERT_EQ(scene.objects.size(), 3u);
  EXPECT_EQ(scene.objects[0].initial.position, (Vec3i{1 << 20, -(1 << 22), 1})) << "1.43 steps";
  const std::array<std::int32_t, 4>& q = scene.objects[0].initial.rotation;
  EXPECT_NEAR(q[0], half * (1 << 30), 1) << "made a unit again";
  EXPECT_NEAR(q[3], -half * (1 << 30), 1);
  EXPECT_EQ(scene.objects[1].dof, Dof::none);
  EXPECT_EQ(scene.objects[1].initial, RigidPose{});
  EXPECT_EQ(scene.objects[2].name, "slider");
  EXPECT_EQ(std::vector(scene.moving().begin(), scene.moving().end()), (std::vector<std::uint32_t>{0, 2}));
}

TEST(SceneBuilder, WhatIsSaidOfTheStreamIsInTheScene) {
  const auto built =
      SceneBuilder().rigid("cube", {{1, 0, 0}, {}}).grid({20, 15, 18, 10}).extrapolate(0.0126).baselines(8).build();
  ASSERT_TRUE(built);
  EXPECT_EQ((*built)->grid, (GridExponents{20, 15, 18, 10}));
  EXPECT_EQ((*built)->objects[0].initial.position[0], 1 << 20) << "whatever the order of the calls";
  EXPECT_EQ((*built)->max_extrapolation, 13);
  EXPECT_EQ((*built)->baseline_span, 8);
  EXPECT_EQ(SceneBuilder().extrapolate(0).build().value()->max_extrapolation, 1) << "a tick at least";
  EXPECT_EQ(SceneBuilder().extrapolate(1e9).build().value()->max_extrapolation, 65535) << "and what the field can say";
}

TEST(SceneBuilder, RigidObjectsAreOfProfileMainUnlessItIsSaid) {
  EXPECT_TRUE(SceneBuilder().rigid("cube").build().value()->is_smoothed);
  EXPECT_FALSE(SceneBuilder().rigid("cube").rigid_profile(RigidProfile::thesis).build().value()->is_smoothed);
  EXPECT_FALSE(SceneBuilder().rigid("wall", {}, {.dof = Dof::none}).build().value()->is_smoothed) << "nothing moves";
}

/// What fades per frame, and the sets of weights, where they are left open.
TEST(SceneBuilder, WhatIsLeftOpenSuitsTheBasisAndTheBoundThatIsDeclared) {
  const TriMesh mesh = testing::sheet(3, 2);
  const auto coded = [&](DeformableCoding coding, double visual) {
    const auto built = SceneBuilder().deformable("a", mesh, std::move(coding)).declare_bounds({}, {.visual = visual}).build();
    return std::pair((*built)->deformables[0].fade, (*built)->deformables[0].weight_sets);
  };
  const DeformableCoding with_basis{.frame_period = 1000, .basis = testing::wave_basis(mesh, 3, 4)};
  EXPECT_EQ(coded(with_basis, 2.5e-4), std::pair(std::uint16_t{64225}, std::uint8_t{2})) << "98 % in a second";
  EXPECT_EQ(coded(with_basis, 1e-5), std::pair(std::uint16_t{0}, std::uint8_t{1}));
  EXPECT_EQ(coded({}, 2.5e-4), std::pair(std::uint16_t{0}, std::uint8_t{1})) << "nothing fades without a basis";
  DeformableCoding asked = with_basis;
  asked.fade = 0.5;
  asked.weight_sets = 4;
  EXPECT_EQ(coded(asked, 1e-5), std::pair(std::uint16_t{32768}, std::uint8_t{4}));
  const auto without_bounds = SceneBuilder().deformable("a", mesh, with_basis).build();
  EXPECT_EQ((*without_bounds)->deformables[0].fade, 64225);
  asked.fade = 1.01;
  EXPECT_STREQ(SceneBuilder().deformable("a", mesh, asked).build().error().error.rule, "R-API-4");
}

TEST(SceneBuilder, MotionConstantsAreOnTheGridOfVelocities) {
  const auto built = [](const MotionPhysics& physics, std::uint8_t dof = Dof::all) {
    return SceneBuilder().rigid("cube", {}, {.dof = dof}).motion(physics).build();
  };
  const auto scene = built({{0, 3, -4}, 0.25});
  ASSERT_TRUE(scene);
  EXPECT_EQ((*scene)->motion, (MotionConstants{{0, 3 << 17, -4 << 17}, 5 << 15})) << "0.25 times 5 m/s^2";
  EXPECT_EQ(built({}).value()->motion, std::nullopt);
  EXPECT_EQ(built({{0, 0, -9.81}, 0}, Dof::none).value()->motion, std::nullopt) << "nothing moves";
  EXPECT_TRUE(built({{2048, 0, 0}, 1}));
  for (const MotionPhysics& wrong :
       {MotionPhysics{{2049, 0, 0}, 0}, MotionPhysics{{0, 0, -1}, -1}, MotionPhysics{{0, 0, -1}, 2049},
        MotionPhysics{{0, std::nan(""), 0}, 0}, MotionPhysics{{0, 0, -1}, HUGE_VAL}}) {
    const auto refused = built(wrong);
    ASSERT_FALSE(refused);
    EXPECT_STREQ(refused.error().error.rule, "R-API-4");
  }
}

TEST(SceneBuilder, DeformableObjectsAndTheirCoding) {
  const TriMesh mesh = testing::sheet(3, 2);
  const ModeBasis basis = testing::wave_basis(mesh, 3, 4);
  DeformableCoding main{.rings = 5, .frame_period = 50.0 / 3, .layered = true, .basis = basis};
  DeformableCoding thesis{
      .profile = DeformableProfile::thesis, .quant_bits = 11, .models_kept = true, .layered = true, .basis = basis};
  const auto built = SceneBuilder().deformable("a", mesh, main).deformable("b", mesh, thesis).build(testing::kWithThesis);
  ASSERT_TRUE(built);
  const DeformableObject &a = (*built)->deformables[0], &b = (*built)->deformables[1];
  EXPECT_EQ(a.name, "a");
  EXPECT_EQ(a.profile, DeformableProfile::main);
  EXPECT_EQ(a.rings, 5);
  EXPECT_EQ(a.frame_period, 4267u) << "x 2^-8 ticks";
  EXPECT_TRUE(a.layered);
  EXPECT_EQ(a.basis, basis);
  EXPECT_EQ(a.triangles, mesh.triangles);
  ASSERT_EQ(a.rest.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < a.rest.size(); ++v) EXPECT_LE(norm(to_metres(a.rest[v], 22) - mesh.vertices[v]), 0.87 * 0x1p-22);
  EXPECT_EQ(b.profile, DeformableProfile::thesis);
  EXPECT_EQ(b.quant_bits, 11);
  EXPECT_TRUE(b.models_kept);
  EXPECT_TRUE(b.layered);
  EXPECT_TRUE(b.basis.steps.empty()) << "of profile main alone";
}

TEST(SceneBuilder, StiffnessIsDeclaredByLevels) {
  const TriMesh mesh = testing::sheet(1, 1);
  const double fixed = std::numeric_limits<double>::infinity();
  const auto built = SceneBuilder().deformable("a", mesh, {.stiffness = {0.01, 100, 1e9, fixed}}).build();
  ASSERT_TRUE(built);
  EXPECT_EQ((*built)->deformables[0].stiffness, (std::vector<std::uint8_t>{1, 127, 255, 0}));
  const auto refused = [&](std::vector<double> stiffness) {
    return std::string(SceneBuilder().deformable("a", mesh, {.stiffness = std::move(stiffness)}).build().error().error.rule);
  };
  EXPECT_EQ(refused({1, 1, 1}), "R-STR-20") << "four vertices";
  EXPECT_EQ(refused({1, 1, 1, 0}), "R-API-4");
  EXPECT_EQ(refused({1, 1, 1, std::numeric_limits<double>::quiet_NaN()}), "R-API-4");
}

TEST(StiffnessLevels, AreNearAndInOrder) {
  for (double stiffness = 0.016; stiffness < 690e3; stiffness *= 1.003)
    EXPECT_NEAR(stiffness_of_level(stiffness_level(stiffness).value()) / stiffness, 1, 0.036) << stiffness;
  for (int level = 0; level < 256; ++level)
    EXPECT_EQ(stiffness_level(stiffness_of_level(static_cast<std::uint8_t>(level))).value(), level);
}

TEST(SceneBuilder, DeclaredBoundsAreThoseOfItsObjects) {
  const TriMesh mesh = testing::sheet(1, 1);
  const RigidTriggers rigid{.visual_position = 0.011};
  const DeformableThresholds deformable{.visual = 3e-4};
  const auto with = [&](SceneBuilder builder) {
    return builder.declare_bounds(rigid, deformable).build(testing::kWithThesis).value()->bounds.value();
  };
  const StreamBounds both =
      with(SceneBuilder().rigid("cube").deformable("m", mesh).deformable("t", mesh, {.profile = DeformableProfile::thesis}));
  EXPECT_EQ(both.rigid, rigid);
  ASSERT_EQ(both.deformables.size(), 2u);
  EXPECT_EQ(both.deformables[0], (DeformableBounds{deformable, true}));
  EXPECT_EQ(both.deformables[1], (DeformableBounds{deformable, false}));
  EXPECT_FALSE(with(SceneBuilder().rigid("wall", {}, {.dof = Dof::none})).rigid) << "nothing rigid can move";
}

std::string refusal(SceneBuilder builder) {
  const auto built = builder.build(testing::kWithThesis);
  if (built) return "none";
  EXPECT_EQ(Error(built.error()).rule, built.error().error.rule) << "a finding is an error, too";
  return std::string(built.error().error.rule) + " of '" + built.error().object + "'";
}

TEST(SceneBuilder, ARefusalNamesTheObjectAndTheRule) {
  const auto rigid = [](const Pose& pose) { return refusal(SceneBuilder().rigid("good").rigid("bad", pose).rigid("last")); };
  EXPECT_EQ(rigid({}), "none");
  EXPECT_EQ(rigid({{kNan, 0, 0}, {}}), "R-API-1 of 'bad'");
  EXPECT_EQ(rigid({{}, {1, 0, std::numeric_limits<double>::infinity(), 0}}), "R-API-1 of 'bad'");
  EXPECT_EQ(rigid({{0, 513, 0}, {}}), "R-API-2 of 'bad'");
  EXPECT_EQ(rigid({{}, {0.5, 0, 0, 0}}), "R-API-3 of 'bad'");
  const auto deformable = [](const auto& change) {
    TriMesh mesh = testing::sheet(1, 1);
    change(mesh);
    return refusal(SceneBuilder().rigid("cube").deformable("good", testing::sheet(1, 1)).deformable("bad", mesh));
  };
  EXPECT_EQ(deformable([](TriMesh&) {}), "none");
  EXPECT_EQ(deformable([](TriMesh& m) { m.vertices[2].y = kNan; }), "R-API-1 of 'bad'");
  EXPECT_EQ(deformable([](TriMesh& m) { m.vertices[2].y = 1e5; }), "R-API-2 of 'bad'");
  EXPECT_EQ(deformable([](TriMesh& m) { m.vertices[1] = m.vertices[3]; }), "R-API-10 of 'bad'") << "no area";
  EXPECT_EQ(deformable([](TriMesh& m) {
              m.vertices[1] = m.vertices[0] + Vec3{0, 1e-9, 0};
            }),
            "R-API-10 of 'bad'")
      << "none on the grid";
}

TEST(SceneBuilder, ARefusalOfTheDeclarationNamesTheObjectToo) {
  const TriMesh mesh = testing::sheet(1, 1);
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").rigid("bad", {}, {.dof = Dof::rx | Dof::ry})), "R-STR-12 of 'bad'");
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").rigid("")), "R-STR-11 of ''");
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").rigid("twice").rigid("twice")), "R-STR-11 of 'twice'");
  EXPECT_EQ(refusal(SceneBuilder().rigid("twice").deformable("twice", mesh)), "R-STR-11 of 'twice'");
  EXPECT_EQ(refusal(SceneBuilder().deformable("bad", mesh, {.rings = 33})), "R-DEF-3 of 'bad'");
  EXPECT_EQ(refusal(SceneBuilder().deformable("bad", mesh, {.profile = DeformableProfile::thesis, .quant_bits = 13})),
            "R-DEF-3 of 'bad'");
  EXPECT_EQ(refusal(SceneBuilder().deformable("bad", {})), "R-DEF-4 of 'bad'");
  ModeBasis basis = testing::wave_basis(mesh, 1, 1);
  basis.entries.pop_back();
  EXPECT_EQ(refusal(SceneBuilder().deformable("bad", mesh, {.basis = basis})), "R-DEF-7 of 'bad'");
  TriMesh wrong = mesh;
  wrong.triangles[1][2] = 4;
  EXPECT_EQ(refusal(SceneBuilder().deformable("bad", wrong)), "R-DEF-6 of 'bad'");
}

TEST(SceneBuilder, WhatIsWrongWithNoObjectNamesNone) {
  EXPECT_EQ(refusal(SceneBuilder(0).rigid("a")), "R-STR-6 of ''");
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").grid({31, 17, 20, 12})), "R-STR-7 of ''");
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").grid({200, 17, 20, 12})), "R-STR-7 of ''");
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").extrapolate(-1)), "R-API-4 of ''");
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").extrapolate(kNan)), "R-API-4 of ''");
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").baselines(0)), "R-STR-9 of ''");
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").baselines(65)), "R-STR-9 of ''");
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").declare_bounds({.visual_position = -1}, {})), "R-STR-17 of ''");
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").declare_bounds({.weber_fraction = 4}, {})), "R-API-4 of ''");
  EXPECT_EQ(refusal(SceneBuilder().rigid("a").declare_bounds({.perceptual_fraction = 4}, {})), "R-API-4 of ''");
}

/// The grid follows from the size of the world; where that and the bounds do not go together, both figures are reported.
TEST(SceneBuilder, AWorldHasASize) {
  const auto exponent = [](double metres) { return SceneBuilder().rigid("a").world_size(metres).build().value()->grid.position; };
  EXPECT_EQ(exponent(1), 22) << "no finer than usual";
  EXPECT_EQ(exponent(511.9), 22);
  EXPECT_EQ(exponent(512), 21) << "the last step is below 512 m";
  EXPECT_EQ(exponent(5000), 18);
  EXPECT_EQ(exponent(8e6), 8);
  const SharedScene far = SceneBuilder().rigid("a", {{4999, 0, 0}, {}}).world_size(5000).build().value();
  EXPECT_EQ(to_pose(far->objects[0].initial, far->grid.position).position.x, 4999);
  EXPECT_LE(SceneBuilder().rigid("a").world_size(1e5).build().value()->grid.velocity, 14) << "as R-STR-7 asks for";
  EXPECT_EQ(SceneBuilder().rigid("a").grid({20, 17, 20, 12}).world_size(100).build().value()->grid.position, 20);
  for (const double metres : {0.0, -1.0, kNan, 1e7})
    EXPECT_EQ(refusal(SceneBuilder().rigid("a").world_size(metres)), "R-API-4 of ''");
  const RigidTriggers fine{.visual_position = 1e-4};
  EXPECT_TRUE(SceneBuilder().rigid("a").declare_bounds(fine, {}).world_size(16'000).build());
  const auto refused = SceneBuilder().rigid("a").declare_bounds(fine, {}).world_size(1e5).build();
  ASSERT_FALSE(refused);
  EXPECT_STREQ(refused.error().error.rule, "R-API-4");
  for (const char* part : {"1e+05 m", "0.1 mm", "1.638e+04 m"})
    EXPECT_NE(refused.error().detail.find(part), std::string::npos) << refused.error().detail;
  EXPECT_TRUE(SceneBuilder().rigid("a", {}, {.dof = Dof::none}).declare_bounds(fine, {}).world_size(1e5).build())
      << "nothing moves";
  const auto away = SceneBuilder().rigid("a", {{600, 0, 0}, {}}).build();
  EXPECT_NE(away.error().detail.find("512 m"), std::string::npos) << away.error().detail;
}

TEST(SceneBuilder, GravityAndFrictionBeyondTheGridAreReported) {
  const auto detail = [](double gravity, double friction) {
    const auto built = SceneBuilder().rigid("a").motion({{0, 0, -gravity}, friction}).build();
    return built ? std::string("taken") : built.error().detail;
  };
  EXPECT_EQ(detail(9.81, 100), "taken");
  EXPECT_EQ(detail(0, 1e9), "taken") << "without gravity nothing slides to rest";
  EXPECT_EQ(detail(2048, 0), "taken");
  EXPECT_NE(detail(2049, 0).find("gravity of 2049 m/s^2"), std::string::npos) << detail(2049, 0);
  EXPECT_NE(detail(9.81, 300).find("2943 m/s^2: each is from 0 to 2048 m/s^2"), std::string::npos) << detail(9.81, 300);
  EXPECT_NE(detail(9.81, -1), "taken");
}

TEST(SceneBuilder, HowManyAreTooManyIsReported) {
  SceneBuilder builder;
  for (int i = 0; i < 12; ++i) builder.rigid("o" + std::to_string(i));
  DecodeLimits limits;
  limits.objects = 10;
  const auto refused = builder.build(limits);
  EXPECT_STREQ(refused.error().error.rule, "R-STR-14");
  EXPECT_EQ(refused.error().detail, "12 objects where 10 are allowed");
  EXPECT_NE(std::string(remedy(refused.error().error)).find("every receiver"), std::string::npos);
}

TEST(SceneBuilder, BuildingTakesTheObjects) {
  SceneBuilder builder(250);
  builder.rigid("cube").baselines(8);
  EXPECT_EQ(builder.build().value()->objects.size(), 1u);
  const SharedScene empty = builder.build().value();
  EXPECT_TRUE(empty->objects.empty());
  EXPECT_EQ(empty->baseline_span, 1);
  EXPECT_EQ(builder.rigid("cube").build().value()->tick_rate, 250u) << "a name may come again";
}

/// Whoever works with a scene holds the very same one; it lives as long as the last of them.
TEST(SceneBuilder, ASceneIsSharedNotCopied) {
  SharedScene scene = SceneBuilder().rigid("cube").deformable("sheet", testing::sheet(2, 2)).build().value();
  const Scene* const address = scene.get();
  const auto alone = scene.use_count();
  auto sender = Sender::create(scene).value();
  auto receiver = Receiver::create(scene).value();
  EXPECT_EQ(scene.use_count(), alone + 2);
  EXPECT_EQ(sender.scene().get(), address);
  EXPECT_EQ(receiver.scene().get(), address);
  std::weak_ptr<const Scene> watch = scene;
  scene.reset();
  EXPECT_FALSE(watch.expired());
  RigidSample sample;
  sample.pose.position.x = 1;
  for (const Packet& packet : testing::all(sender.encode(0, {{&sample, 1}})))
    EXPECT_TRUE(receiver.push(packet.number, packet.bytes));
  EXPECT_EQ(receiver.state_hash(0), sender.state_hash(0));
  const Sender moved = std::move(sender);
  EXPECT_EQ(moved.scene().get(), address);
  receiver = Receiver::create(testing::scene_of(1)).value();
  EXPECT_FALSE(watch.expired());
}

TEST(SceneBuilder, ABuiltSceneIsWrittenAndRead) {
  const SharedScene scene = SceneBuilder(60)
                                .rigid("cube", {{0.1, 0.2, 0.3}, {}})
                                .deformable("sheet", testing::sheet(2, 2), {.frame_period = 1.5})
                                .baselines(4)
                                .declare_bounds({}, {})
                                .build()
                                .value();
  const auto parsed = parse_scene(write_scene(*scene).value());
  ASSERT_TRUE(parsed) << parsed.error().rule;
  EXPECT_EQ(parsed->scene->objects[0].initial, scene->objects[0].initial);
  EXPECT_EQ(parsed->scene->deformables, scene->deformables);
  EXPECT_EQ(parsed->scene->bounds, scene->bounds);
  EXPECT_EQ(parsed->scene->baseline_span, 4);
  EXPECT_EQ(parsed->scene->moving().size(), 1u);
}

}  // namespace
}  // namespace tactus
