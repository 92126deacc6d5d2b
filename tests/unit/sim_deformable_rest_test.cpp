// SPDX-License-Identifier: Apache-2.0
// What rests is left alone, and nothing else changes by it: sim/deformable/deformable_body.h, deformable_objects.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <tactus/sim/deformable/deformable_body.h>
#include <tactus/sim/simulation.h>

namespace tactus::sim {
namespace {

using Tick = DeformableBody::Tick;

SceneDeformable slab(const std::string& method) {
  SceneDeformable object;
  object.name = "slab";
  object.mesh = make_slab(4, 4, 1, 0.01);
  object.materials = {{1e4, 0.3, 1e3}};
  for (std::uint32_t v = 0; v < 25; ++v) object.fixed.push_back(v);  // its lower side
  object.stiffness = 100;
  object.mass_damping = 30;
  object.stiffness_damping = 2e-4;
  object.method = method;
  return object;
}

constexpr double kSize = 0.06;  // [m] its diagonal

/// A triangle of the surface none of whose corners is fixed.
std::uint32_t free_triangle(const DeformableBody& body, const SceneDeformable& object) {
  const TetSurface& faces = body.surface();
  const auto is_free = [&](const Triangle& triangle) {
    return std::ranges::none_of(triangle,
                                [&](std::uint32_t v) { return std::ranges::binary_search(object.fixed, faces.vertex[v]); });
  };
  return static_cast<std::uint32_t>(std::ranges::find_if(faces.mesh.triangles, is_free) - faces.mesh.triangles.begin());
}

/// The same object, of which no step is ever left out.
struct Restless {
  FemModel model;
  std::unique_ptr<Integrator> integrator;
  FemState state;
  Eigen::VectorXd weight, pushed;

  Restless(const SceneDeformable& object, const Vec3& gravity)
      : model(FemModel::create(object.mesh, fem_options(object)).value()),
        integrator(make_integrator(model, chosen_method(object, model).options).value()),
        state(model.rest()),
        weight(model.size()),
        pushed(Eigen::VectorXd::Zero(model.size())) {
    for (Eigen::Index i = 0; i < weight.size(); i += 3)
      weight.segment<3>(i) = model.lumped_mass()[i] * Eigen::Vector3d(gravity.x, gravity.y, gravity.z);
  }
  void tick() {
    ASSERT_TRUE(integrator->step(weight + pushed, state));
    pushed.setZero();
  }
};

class Methods : public ::testing::TestWithParam<const char*> {};

/// Without weight nothing moves before the first push, and bit by bit all that follows is as if the object had been stepped all
/// along, until it rests again: then what never sleeps goes on trembling.
TEST_P(Methods, SleepChangesNothing) {
  const SceneDeformable object = slab(GetParam());
  auto body = DeformableBody::create(object, {}, 0).value();
  Restless other(object, {});
  const TetSurface faces = surface(object.mesh);
  constexpr std::array<double, 3> kWeights{0.25, 0.25, 0.5};
  const std::uint32_t number = free_triangle(*body, object);
  const Triangle& touched = faces.mesh.triangles[number];
  std::array<std::uint32_t, 3> corners{};
  for (std::size_t k = 0; k < 3; ++k) corners[k] = faces.vertex[touched[k]];
  int slept = 0, slept_again = 0;
  double largest = 0;
  for (int tick = 0; tick < 20000 && slept_again < 500; ++tick) {
    if (tick >= 200 && tick < 260) {
      const Vec3 force{0.01, 0, -0.02};
      body->push(number, kWeights, force);
      add_force(corners, kWeights, force, other.pushed);
    }
    const auto done = body->tick();
    ASSERT_TRUE(done);
    body->show();
    other.tick();
    (tick < 200 ? slept : slept_again) += *done == Tick::slept;
    if (slept_again == 0) {
      ASSERT_TRUE(body->state().u == other.state.u && body->state().v == other.state.v) << "tick " << tick;
    }
    largest = std::max(largest, other.state.u.cwiseAbs().maxCoeff());
    ASSERT_LE((body->state().u - other.state.u).cwiseAbs().maxCoeff(), 0x1p-36 * kSize) << "tick " << tick;
  }
  EXPECT_EQ(slept, 200) << "all before the push";
  EXPECT_EQ(slept_again, 500);
  EXPECT_GT(largest, 1e-6);
}

/// Under weight bits tremble for ever; what goes on stepping stays where sleep began, and the shape that is reported keeps its bits.
TEST_P(Methods, UnderItsWeightItSleepsWhereItWouldStay) {
  const SceneDeformable object = slab(GetParam());
  const Vec3 gravity{0, 0, -1};
  auto body = DeformableBody::create(object, gravity, 0).value();
  Restless other(object, gravity);
  int tick = 0;
  for (Tick last = Tick::stepped; last != Tick::slept; ++tick) {
    ASSERT_LT(tick, 20000) << "never rests";
    last = body->tick().value();
    body->show();
    if (last == Tick::stepped) other.tick();
  }
  ASSERT_EQ(body->state().u, other.state.u);
  EXPECT_GT(body->state().u.cwiseAbs().maxCoeff(), 1e-6);
  for (int i = 0; i < 3000; ++i) {
    other.tick();
    ASSERT_EQ(body->tick().value(), Tick::slept);
    ASSERT_LT((body->state().u - other.state.u).cwiseAbs().maxCoeff(), 0x1p-36 * kSize) << i;
  }
  body->push(free_triangle(*body, object), std::array<double, 3>{1, 0, 0}, {0, 0, 1e-6});
  EXPECT_EQ(body->tick().value(), Tick::stepped) << "the least push wakes it";
}

INSTANTIATE_TEST_SUITE_P(DeformableRest, Methods,
                         ::testing::Values("velocity-verlet", "backward-euler", "newmark", "tr-bdf2", "projective"));

TEST(DeformableRest, WhatCannotMoveTakesNoStep) {
  SceneDeformable object = slab("auto");
  object.fixed.clear();
  for (std::uint32_t v = 0; v < object.mesh.vertices.size(); ++v) object.fixed.push_back(v);
  auto body = DeformableBody::create(object, {0, 0, -10}, 0).value();
  for (int tick = 0; tick < 10; ++tick) {
    body->push(3, std::array<double, 3>{1, 0, 0}, {0, 0, 1});
    ASSERT_EQ(body->tick().value(), Tick::slept);
  }
}

Scene touched_scene(std::uint32_t rate) {
  return parse_scene(
             "name = \"rest\"\nduration = 1.0\ngravity = [0, 0, 0]\n"
             "[touch]\nstiffness = 20\nfriction = 0.2\nlift_stiffness = 20\n"
             "[[deformable]]\nname = \"slab\"\ncells = [6, 6, 1]\ncell = 0.01\nposition = [-0.03, -0.03, -0.01]\n"
             "young = 1e4\npoisson = 0.3\ndensity = 1e4\nmass_damping = 15\nfixed = \"corners\"\nrate = " +
                 std::to_string(rate) + "\n[[user]]\nname = \"hand\"\nobject = \"slab\"\nstart = [0.001, 0.002, 0.02]\n",
             "rest.toml")
      .value();
}

/// Shapes are reported while they are computed and when they are touched; at rest there are none.
TEST(DeformableRest, ReportsShapesWhileItMovesOrIsTouched) {
  for (const std::uint32_t rate : {1u, 8u}) {
    auto simulation = Simulation::create(touched_scene(rate)).value();
    std::vector<DeviceSample> device(1);
    int before = 0, during = 0, at_last = 0;
    for (int tick = 0; tick < 12000; ++tick) {
      const bool down = tick >= 400 && tick < 600;
      device[0].position = {0.001, 0.002, down ? -0.001 : 0.02};
      ASSERT_TRUE(simulation.step(device));
      const TraceFrame& frame = simulation.frame();
      EXPECT_EQ(frame.users[0].surface_contact.has_value(), down) << tick;
      const int updated = frame.meshes[0].updated ? 1 : 0;
      if (down && tick % static_cast<int>(rate) == 0) {
        EXPECT_EQ(updated, 1) << tick;
      }
      (tick < 400 ? before : tick < 600 ? during : tick >= 11900 ? at_last : during) += updated;
    }
    EXPECT_EQ(before, 0) << rate;
    EXPECT_GT(during, 50) << rate;
    EXPECT_EQ(at_last, 0) << "at rest again, rate " << rate;
  }
}

/// A slab that falls 1.3 m, 5 mm in a tick, onto a probe that keeps still.
TEST(DeformableRest, AFastSlabIsFelt) {
  for (const double height : {0.3, 1.3, 20.0}) {
    auto scene = parse_scene(
                     "name = \"drop\"\nduration = 3.0\ngravity = [0, 0, -9.81]\n"
                     "[touch]\nstiffness = 100\nfriction = 0.4\nlift_stiffness = 20\n"
                     "[[deformable]]\nname = \"slab\"\ncells = [6, 6, 1]\ncell = 0.01\nposition = [-0.03, -0.03, " +
                         std::to_string(height) +
                         "]\nyoung = 1e4\npoisson = 0.45\ndensity = 1000\n"
                         "[[user]]\nname = \"hand\"\nobject = \"slab\"\nstart = [0.003, 0.004, 0.0]\n",
                     "drop.toml")
                     .value();
    auto simulation = Simulation::create(scene).value();
    std::vector<DeviceSample> device(1);
    device[0].position = {0.003, 0.004, 0};
    const double arrives = std::sqrt(2 * height / 9.81);
    int touched = 0;
    for (int tick = 0; tick * kTick < arrives + 0.02; ++tick) {
      ASSERT_TRUE(simulation.step(device));
      if (simulation.frame().users[0].surface_contact) ++touched;
    }
    EXPECT_GE(touched, 15) << height << " m";
  }
}

}  // namespace
}  // namespace tactus::sim
