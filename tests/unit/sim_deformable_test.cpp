// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>

#include <tactus/base/bytes.h>
#include <tactus/sim/deformable/deformable_body.h>
#include <tactus/sim/simulation.h>
#include "tests/property/allocated.h"

namespace tactus::sim {
namespace {

// ==== sim deformable ====
// Deformable objects in the loop: sim/deformable/deformable_objects.h, sim/simulation.h.

Scene shipped(const std::string& name) { return load_scene(find_scene(name).value()).value(); }

/// A slab of 6 x 6 x 1 cm that hangs at its corners, its upper side at z = 0, and one probe that starts at `start`.
Scene slab_scene(std::uint32_t rate, const Vec3& start) {
  const auto number = [](double value) { return std::to_string(value); };
  const std::string text =
      "name = \"slab\"\nduration = 1.0\ngravity = [0, 0, 0]\n"
      "[touch]\nstiffness = 20\nfriction = 0.2\nlift_stiffness = 20\n"
      "[[deformable]]\nname = \"slab\"\ncells = [6, 6, 1]\ncell = 0.01\nposition = [-0.03, -0.03, -0.01]\n"
      "young = 1e4\npoisson = 0.3\ndensity = 1e4\nrate = " +
      std::to_string(rate) + "\n[[user]]\nname = \"hand\"\nobject = \"slab\"\nstart = [" + number(start.x) + ", " +
      number(start.y) + ", " + number(start.z) + "]\n";
  return parse_scene(text, "slab.toml").value();
}

std::vector<DeviceSample> device_at(const Vec3& position) {
  std::vector<DeviceSample> samples(1);
  samples[0].position = position;
  return samples;
}

std::uint64_t hash_of_run(const Scene& scene, std::uint64_t seed, int ticks) {
  auto simulation = Simulation::create(scene, {.seed = seed, .grip = {}, .channel = {}});
  EXPECT_TRUE(simulation);
  Fnv1a hash;
  const auto add = [&hash](const Vec3& v) {
    for (const double part : {v.x, v.y, v.z}) hash.add64(std::bit_cast<std::uint64_t>(part));
  };
  for (int i = 0; i < ticks; ++i) {
    EXPECT_TRUE(simulation->step());
    const TraceFrame& frame = simulation->frame();
    for (const UserSample& user : frame.users) add(user.device.position), add(user.force), add(user.server_force);
    for (const DeformableSample& mesh : frame.meshes)
      for (const float value : mesh.displacements) hash.add32(std::bit_cast<std::uint32_t>(value));
  }
  return hash.value();
}

TEST(DeformableSimulation, SameSeedSameBitsOtherSeedOtherBits) {
  const Scene scene = shipped("membrane");
  const std::uint64_t first = hash_of_run(scene, 1, 2000);
  EXPECT_EQ(first, hash_of_run(scene, 1, 2000));
  EXPECT_NE(first, hash_of_run(scene, 2, 2000));
}

TEST(DeformableSimulation, StepsAllocateNothingAfterTheFirstDeformations) {
  for (const std::uint32_t rate : {1u, 17u}) {
    Scene scene = shipped("membrane");
    scene.deformables[0].rate = rate;
    auto simulation = Simulation::create(scene);
    ASSERT_TRUE(simulation);
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulation->step());
    const std::uint64_t before = testing::allocated_bytes();
    int touched = 0;
    for (int i = 0; i < 2500; ++i) {
      if (!simulation->step()) break;
      touched += simulation->frame().users[0].surface_contact.has_value();
    }
    EXPECT_EQ(testing::allocated_bytes() - before, 0u) << "rate " << rate;
    EXPECT_GT(touched, 500) << "or contact was not tried";
  }
}

TEST(DeformableSimulation, MeanForceOfAPeriodActsInItsStepAndShowsInTheNext) {
  constexpr std::uint32_t kRate = 8;
  Scene scene = slab_scene(kRate, {0.003, 0.004, -0.001});
  scene.deformables[0].method = "velocity-verlet";
  auto simulation = Simulation::create(scene);
  ASSERT_TRUE(simulation);
  Vec3 impulse;  // of the server's forces on the slab [N s]
  for (std::uint32_t tick = 0; tick <= kRate; ++tick) {
    ASSERT_TRUE(simulation->step(device_at({0.003, 0.004, -0.001 - 1e-4 * tick})));
    const TraceFrame& frame = simulation->frame();
    EXPECT_EQ(frame.meshes[0].updated, tick == kRate) << "one step of delay (T_c)";
    ASSERT_TRUE(frame.users[0].surface_contact);
    EXPECT_EQ(frame.users[0].surface_contact->stiffness, 20);
    if (tick < kRate) impulse = impulse - kTick * frame.users[0].server_force;
  }
  // Free and at rest, under a force that is held over the step: sum m u = h / 2 * impulse.
  const SceneDeformable& slab = scene.deformables[0];
  Vec3 moment;
  const auto& u = simulation->frame().meshes[0].displacements;
  for (std::size_t t = 0; t < slab.mesh.tets.size(); ++t)
    for (const std::uint32_t v : slab.mesh.tets[t])
      moment = moment + (volume(slab.mesh, t) * 1e4 / 4) * Vec3{double{u[3 * v]}, double{u[3 * v + 1]}, double{u[3 * v + 2]}};
  const Vec3 expected = (0.5 * kRate * kTick) * impulse;
  EXPECT_LT(expected.z, -1e-7);
  EXPECT_LT(norm(moment - expected), 1e-6 * norm(expected));
}

TEST(DeformableSimulation, ClientApproachesANewShapeWithoutAJump) {
  Scene scene = slab_scene(10, {0.001, 0.002, -0.004});
  scene.deformables[0].fixed = {0, 6, 42, 48, 49, 55, 91, 97};
  auto simulation = Simulation::create(scene);
  ASSERT_TRUE(simulation);
  double server_jump = 0, client_jump = 0;
  Vec3 server, client;
  for (int tick = 0; tick < 300; ++tick) {
    ASSERT_TRUE(simulation->step(device_at({0.001, 0.002, -0.004})));
    const UserSample& user = simulation->frame().users[0];
    if (tick > 0) {
      server_jump = std::max(server_jump, norm(user.server_force - server));
      client_jump = std::max(client_jump, norm(user.force - client));
    }
    server = user.server_force;
    client = user.force;
  }
  EXPECT_GT(server_jump, 1e-3);
  EXPECT_LT(client_jump, 0.15 * server_jump) << "a tenth of it every tick";
}

TEST(DeformableSimulation, AtTheHapticRateBothEndsFeelTheSame) {
  Scene scene = shipped("membrane");
  scene.deformables[0].rate = 1;
  auto simulation = Simulation::create(scene);
  ASSERT_TRUE(simulation);
  double largest = 0;
  for (int i = 0; i < 1800; ++i) {
    ASSERT_TRUE(simulation->step());
    const UserSample& user = simulation->frame().users[0];
    ASSERT_EQ(user.force, user.server_force) << i;
    largest = std::max(largest, norm(user.force));
    if (!user.surface_contact) continue;
    const SurfaceContact& contact = *user.surface_contact;
    ASSERT_EQ(user.force, contact.stiffness * (contact.proxy - user.device.position));
  }
  EXPECT_GT(largest, 0.05);
}

TEST(DeformableSimulation, TwoUsersAMembraneAndACubeInOneScene) {
  Scene scene = shipped("push-1dof");
  const Scene membrane = shipped("membrane");
  scene.deformables = membrane.deformables;
  for (Vec3& v : scene.deformables[0].mesh.vertices) v.y += 0.5;
  scene.gravity = {};              // which would tear the membrane from the hand; the cube then slides freely,
  scene.objects[0].damping = 0.9;  // as through honey
  scene.deformables[0].rate = 2;
  SceneUser second = membrane.users[0];
  second.name = "second";
  second.object = 1;  // behind the cube
  second.start.y += 0.5;
  for (PathPhase& phase : second.path) phase.to.y += 0.5, phase.centre.y += 0.5;
  scene.users.push_back(second);
  auto simulation = Simulation::create(scene);
  ASSERT_TRUE(simulation);
  const TraceInfo info = simulation->info();
  ASSERT_EQ(info.meshes.size(), 1u);
  EXPECT_EQ(info.meshes[0].name, "membrane");
  EXPECT_EQ(info.meshes[0].rest.triangles.size(), 1424u);
  int cube = 0, mesh = 0;
  float deepest = 0;
  for (int i = 0; i < 2500; ++i) {
    ASSERT_TRUE(simulation->step());
    const TraceFrame& frame = simulation->frame();
    ASSERT_FALSE(frame.users[0].surface_contact);
    ASSERT_EQ(frame.users[1].contact.kind, ContactKind::none);
    cube += frame.users[0].contact.kind != ContactKind::none;
    mesh += frame.users[1].surface_contact.has_value();
    for (const float value : frame.meshes[0].displacements) deepest = std::min(deepest, value);
  }
  EXPECT_GT(cube, 1000);
  EXPECT_GT(mesh, 1000);
  EXPECT_LT(deepest, -0.005F);
  EXPECT_GT(simulation->frame().objects[0].pose.position.x, 0.1);
}

TEST(DeformableSimulation, StandsBesideABoxAndAOneDimensionalObject) {
  Scene scene = shipped("push-1dof");
  scene.deformables = shipped("membrane").deformables;
  for (Vec3& v : scene.deformables[0].mesh.vertices) v.y += 0.5;
  scene.msds = shipped("msd-1d").msds;
  scene.msds[0].position.x = 0.13;  // behind the box's mid point
  scene.msds[0].rate = 1;
  auto simulation = Simulation::create(scene);
  ASSERT_TRUE(simulation);
  ASSERT_EQ(simulation->info().objects.size(), 2u);
  EXPECT_EQ(simulation->info().objects[1].name, "surface");
  auto position = [](double x, double z) {
    std::vector<DeviceSample> samples(1);
    samples[0].position = {x, 0, z};
    return samples;
  };
  ASSERT_TRUE(simulation->step(position(-0.03, 0.02)));
  ASSERT_TRUE(simulation->step(position(-0.0195, 0.02)));
  EXPECT_EQ(simulation->frame().users[0].contact.object, 0u) << "the box";
  EXPECT_EQ(simulation->frame().objects[1].pose.position.x, 0.13);
  ASSERT_TRUE(simulation->step(position(-0.0195, 0.2)));
  EXPECT_EQ(simulation->frame().users[0].contact.kind, ContactKind::none);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulation->step(position(0.132, 0.2)));
  EXPECT_EQ(simulation->frame().users[0].contact.object, 1u);
  EXPECT_GT(simulation->frame().objects[1].pose.position.x, 0.1301);
  EXPECT_FALSE(simulation->frame().users[0].surface_contact);
}

TEST(DeformableSimulation, GravityBendsWhatHangsAtItsCorners) {
  Scene scene = slab_scene(1, {0, 0, 0.5});
  scene.deformables[0].fixed = {0, 6, 42, 48, 49, 55, 91, 97};
  scene.deformables[0].mass_damping = 20;
  scene.gravity = {0, 0, -1};
  auto simulation = Simulation::create(scene);
  ASSERT_TRUE(simulation);
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(simulation->step(device_at({0, 0, 0.5})));
  const auto& u = simulation->frame().meshes[0].displacements;
  EXPECT_LT(u[3 * 24 + 2], -1e-3F) << "the middle";
  EXPECT_EQ(u[2], 0.0F) << "a corner";
}

TEST(DeformableSimulation, DivergenceIsAnErrorWithARemedy) {
  Scene scene = shipped("membrane");
  scene.deformables[0].method = "velocity-verlet";  // 17 ms is far beyond its limit
  auto simulation = Simulation::create(scene);
  ASSERT_TRUE(simulation);
  for (std::int64_t i = 0; i < simulation->ticks(); ++i) {
    const auto stepped = simulation->step();
    for (const float value : simulation->frame().meshes[0].displacements) ASSERT_TRUE(std::isfinite(value));
    if (stepped) continue;
    EXPECT_STREQ(stepped.error().error.rule, "R-FEM-6");
    EXPECT_EQ(stepped.error().step, i);
    EXPECT_STREQ(stepped.error().kind, "deformable object");
    EXPECT_EQ(stepped.error().element, 0u);
    EXPECT_NE(stepped.error().remedy.find("tr-bdf2"), std::string::npos) << stepped.error().remedy;
    return;
  }
  FAIL() << "it did not diverge";
}

TEST(DeformableSimulation, ReportsMethodReasonAndError) {
  const Scene scene = shipped("membrane");
  auto simulation = Simulation::create(scene, {.seed = 1, .grip = {}, .channel = {}, .estimate_every = 10});
  ASSERT_TRUE(simulation);
  const std::uint64_t with_estimate = [&] {
    for (int i = 0; i < 2000; ++i) EXPECT_TRUE(simulation->step());
    Fnv1a hash;
    for (const float value : simulation->frame().meshes[0].displacements) hash.add32(std::bit_cast<std::uint32_t>(value));
    return hash.value();
  }();
  const DeformableInfo& info = simulation->deformables()->info()[0];
  EXPECT_EQ(info.method, "velocity-verlet, 10 sub-steps");
  EXPECT_NE(info.reason.find("h omega"), std::string::npos);
  EXPECT_DOUBLE_EQ(info.step, 0.017);
  const auto error = simulation->deformables()->error(0);
  ASSERT_TRUE(error);
  EXPECT_GE(error->samples, 5);
  EXPECT_GT(error->most_of_motion, error->of_motion);
  EXPECT_LT(error->of_motion, 0.2);
  EXPECT_LT(std::abs(error->energy), 0.05);

  auto plain = Simulation::create(scene);
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE(plain->step());
  Fnv1a hash;
  for (const float value : plain->frame().meshes[0].displacements) hash.add32(std::bit_cast<std::uint32_t>(value));
  EXPECT_EQ(hash.value(), with_estimate) << "looking does not disturb";
  EXPECT_FALSE(plain->deformables()->error(0));
}

TEST(DeformableSimulation, RigidScenesMakeNoDeformableWorld) {
  auto simulation = Simulation::create(shipped("push-1dof"));
  ASSERT_TRUE(simulation);
  EXPECT_EQ(simulation->deformables(), nullptr);
  ASSERT_TRUE(simulation->step());
  EXPECT_TRUE(simulation->frame().meshes.empty());
  EXPECT_TRUE(simulation->info().meshes.empty());
}

/// Largest difference [N] between what client and server render over a second of pressing.
double force_difference(double visual) {
  Scene scene = shipped("membrane");
  SimulationOptions options{.seed = 1, .grip = {}, .channel = ChannelOptions{}};
  options.channel->sender.deformable.thresholds = {.visual = visual, .weber_fraction = {}};
  auto simulation = Simulation::create(scene, options);
  EXPECT_TRUE(simulation);
  EXPECT_EQ(simulation->stream_scene()->deformables.size(), 1u);
  double largest = 0;
  std::uint64_t packets = 0;
  for (int i = 0; i < 2500; ++i) {
    const auto sent = simulation->step();
    if (!sent) break;
    packets += sent->size();
    const TraceFrame& frame = simulation->frame();
    largest = std::max(largest, norm(frame.users[0].force - frame.users[0].server_force));
  }
  EXPECT_GT(packets, 20u);
  return largest;
}

TEST(DeformableSimulation, ClientFeelsTheDecodedShape) {
  const double fine = force_difference(1e-6), coarse = force_difference(2e-3);
  EXPECT_GT(coarse, 2 * fine) << "a coarser shape must show in the force";
}

// ==== sim deformable rest ====
// What rests is left alone, and nothing else changes by it: sim/deformable/deformable_body.h, deformable_objects.h.

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
TEST(DeformableRest, AFastSlabIsRendered) {
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
