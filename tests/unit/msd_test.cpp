// SPDX-License-Identifier: Apache-2.0
/// Masses, springs and dampers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <tactus/sim/msd/msd.h>
#include <tactus/sim/simulation.h>
#include "tests/property/allocated.h"

namespace tactus::sim {
namespace {

// ==== msd ====

constexpr MsdObject kObject{.stiffness = 100, .damping = 1, .mass = 0.01};

MsdLoopOptions one_user(std::uint32_t divider) {
  MsdLoopOptions out{.object = kObject, .divider = divider, .users = {}};
  out.users.push_back({.server_stiffness = 200, .client_stiffness = 300, .client_damping = 2});
  return out;
}

TEST(MsdModel, SolvesItsDifferenceEquation) {
  constexpr double kPeriod = 0.01;
  MsdModel model(kObject, kPeriod);
  double x1 = 0, x2 = 0;
  for (int n = 0; n < 50; ++n) {
    const double f = std::sin(0.3 * n), x = model.step(f);
    const double acceleration = (x - 2 * x1 + x2) / (kPeriod * kPeriod), velocity = (x - x1) / kPeriod;
    ASSERT_NEAR(kObject.mass * acceleration + kObject.damping * velocity + kObject.stiffness * x, f, 1e-12);
    x2 = x1;
    x1 = x;
  }
}

TEST(MsdLoop, RestsWhereTheSpringsBalance) {
  MsdLoop loop(one_user(10));
  for (int i = 0; i < 3000; ++i) loop.step(std::array{1e-3});
  const double surface = 1e-3 * 200 / 300;
  EXPECT_NEAR(loop.surface(), surface, 1e-12);
  EXPECT_NEAR(loop.rendered_force(0), -300 * (1e-3 - surface), 1e-9);
}

TEST(MsdLoop, TheSurfaceMovesOncePerPeriodAndOnePeriodLate) {
  MsdLoop loop(one_user(10));
  MsdModel model(kObject, 0.01);
  double expected = 0;
  for (int tick = 0; tick < 200; ++tick) {
    loop.step(std::array{1e-3});
    ASSERT_NEAR(loop.surface(), expected, 1e-15) << tick;
    if (tick % 10 == 9) expected = model.step(200 * (1e-3 - expected));
  }
}

TEST(MsdLoop, TheMeanOfAPeriodCounts) {
  MsdLoopOptions options = one_user(4);
  MsdLoop mean(options);
  options.decimator = Decimator::last;
  MsdLoop last(options);
  for (int tick = 0; tick < 5; ++tick) {
    const std::array device{tick < 2 ? 2e-3 : 0.0};
    mean.step(device);
    last.step(device);
  }
  EXPECT_NEAR(mean.surface(), MsdModel(kObject, 4e-3).step(0.5 * 200 * 2e-3), 1e-15);
  EXPECT_EQ(last.surface(), 0);
}

TEST(MsdLoop, DelaysShiftTheirChannels) {
  MsdLoopOptions options = one_user(1);
  MsdLoop direct(options);
  options.users[0].to_server = 7;
  options.users[0].from_server = 5;
  MsdLoop delayed(options);
  std::vector<double> surfaces;
  for (int tick = 0; tick < 60; ++tick) {
    direct.step(std::array{1e-3});
    delayed.step(std::array{1e-3});
    surfaces.push_back(direct.surface());
    if (tick < 7) ASSERT_EQ(delayed.surface(), 0) << tick;
    else ASSERT_EQ(delayed.surface(), surfaces[static_cast<std::size_t>(tick - 7)]) << tick;
    const double seen = tick < 12 ? 0 : surfaces[static_cast<std::size_t>(tick - 12)];
    const double before = tick < 13 ? 0 : surfaces[static_cast<std::size_t>(tick - 13)];
    const double rate = tick == 0 ? 1 : (before - seen) / 1e-3;  // of the penetration
    ASSERT_NEAR(delayed.rendered_force(0), -(300 * (1e-3 - seen) + 2 * rate), 1e-12) << tick;
  }
}

TEST(MsdLoop, ALinearApproachEndsWithThePeriod) {
  MsdLoopOptions options = one_user(10);
  options.client = Approach::linear;
  options.users[0].client_damping = 0;
  MsdLoop loop(options);
  for (int tick = 0; tick < 10; ++tick) loop.step(std::array{1e-3});
  const double rendered = loop.rendered_force(0);
  for (int tick = 1; tick <= 10; ++tick) {
    loop.step(std::array{1e-3});
    EXPECT_NEAR(loop.rendered_force(0), rendered + 300 * loop.surface() * tick / 10, 1e-12) << tick;
  }
}

TEST(MsdLoop, PressingNeverPulls) {
  MsdLoopOptions options = one_user(10);
  options.coupling = Coupling::pressing;
  MsdLoop loop(options);
  for (int tick = 0; tick < 500; ++tick) {
    loop.step(std::array{5e-3 * std::sin(0.05 * tick)});
    ASSERT_LE(loop.rendered_force(0), 0) << tick;
  }
}

TEST(MsdLoop, AHandThatIsAwayChangesNothing) {
  MsdLoopOptions options = one_user(10);
  MsdLoop alone(options);
  options.users.push_back(options.users[0]);
  MsdLoop accompanied(options);
  for (int tick = 0; tick < 300; ++tick) {
    alone.step(std::array{1e-3});
    accompanied.step(std::array{1e-3, kAway});
    ASSERT_EQ(accompanied.surface(), alone.surface());
    ASSERT_EQ(accompanied.rendered_force(1), 0);
  }
}

TEST(MsdLoop, StepsAllocateNothing) {
  MsdLoopOptions options = one_user(10);
  options.users[0].to_server = 50;
  MsdLoop loop(options);
  const std::uint64_t before = testing::allocated_bytes();
  for (int tick = 0; tick < 1000; ++tick) loop.step(std::array{1e-3});
  EXPECT_EQ(testing::allocated_bytes(), before);
}

// ==== msd simulation ====
// One-dimensional objects in scenes and in the loop: sim/scene/scene.h, sim/msd/msd_objects.h, sim/simulation.h.

constexpr MsdObject kFigure{.stiffness = 100, .damping = 1, .mass = 0.01};  // thesis figure 4.16

Scene shipped() { return load_scene(find_scene("msd-1d").value()).value(); }

Scene object_at_origin(const MsdObject& object, std::uint32_t rate, double stiffness) {
  Scene scene = shipped();
  scene.touch->stiffness = stiffness;
  scene.msds[0].object = object;
  scene.msds[0].rate = rate;
  return scene;
}

/// Device positions of two users: the first this deep in the object of the scene, the second away.
std::vector<DeviceSample> first_at(double depth) {
  std::vector<DeviceSample> samples(2);
  samples[0].position = {depth, 0, 0};
  samples[1].position = {-1, 0, 0};
  return samples;
}

/// Surface of the trace's object under a step of the first user's device.
std::vector<double> step_response(const Scene& scene, double depth, int ticks) {
  auto simulation = Simulation::create(scene);
  EXPECT_TRUE(simulation);
  std::vector<double> out;
  for (int i = 0; i < ticks; ++i) {
    EXPECT_TRUE(simulation->step(first_at(depth)));
    out.push_back(simulation->frame().objects.at(0).pose.position.x);
  }
  return out;
}

TEST(MsdSimulation, MovesAsTheClosedFormOfTheLoop) {
  // Eq. 4.36 under a step d: a x(n+1) + (b + k_s) x(n) + c x(n-1) = k_s d, x(0) = x(-1) = 0, by its two roots. The spring is soft
  // enough that the surface never leaves the probe: where it did, the loop would not be linear.
  constexpr double kDepth = 1e-3, kStiffness = 150, kPeriod = 0.01;
  const double inertia = kFigure.mass / (kPeriod * kPeriod), viscosity = kFigure.damping / kPeriod;
  const double a = inertia + viscosity + kFigure.stiffness, b = -2 * inertia - viscosity + kStiffness, c = inertia;
  const std::complex<double> root = std::sqrt(std::complex<double>(b * b - 4 * a * c));
  const std::complex<double> p = (-b + root) / (2 * a), q = (-b - root) / (2 * a);
  const double rest = kStiffness * kDepth / (kStiffness + kFigure.stiffness);
  const std::complex<double> of_p = rest * (1.0 / q - 1.0) / (1.0 / p - 1.0 / q), of_q = -rest - of_p;
  const std::vector<double> x = step_response(object_at_origin(kFigure, 10, kStiffness), kDepth, 1000);
  for (std::size_t tick = 0; tick < x.size(); ++tick) {
    const auto n = static_cast<double>(tick / 10);
    const double expected = tick < 10 ? 0 : rest + (of_p * std::pow(p, n) + of_q * std::pow(q, n)).real();
    ASSERT_NEAR(x[tick], expected, 1e-15) << tick;
  }
  EXPECT_GT(*std::max_element(x.begin(), x.end()), 1.2 * rest) << "it rings";
}

TEST(MsdSimulation, ApproachesContinuousMotionWithTheRate) {
  // m x'' + b x' + (k_o + k_s) x = k_s d: underdamped, from rest.
  constexpr MsdObject kSlow{.stiffness = 100, .damping = 10, .mass = 1};
  constexpr double kDepth = 1e-3, kStiffness = 100;
  const double decay = kSlow.damping / (2 * kSlow.mass);
  const double omega = std::sqrt((kSlow.stiffness + kStiffness) / kSlow.mass - decay * decay);
  const double rest = kStiffness * kDepth / (kStiffness + kSlow.stiffness);
  const auto error = [&](std::uint32_t rate) {
    const std::vector<double> x = step_response(object_at_origin(kSlow, rate, kStiffness), kDepth, 1000);
    double largest = 0;
    for (std::size_t tick = 0; tick < x.size(); tick += rate) {
      const double t = static_cast<double>(tick) * kTick;
      const double exact = rest * (1 - std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t)));
      largest = std::max(largest, std::abs(x[tick] - exact));
    }
    return largest / rest;
  };
  const double coarse = error(4), fine = error(2), finest = error(1);
  EXPECT_LT(finest, 0.02);
  EXPECT_NEAR(coarse / fine, 2, 0.2) << "first order, as backward differences are";
  EXPECT_NEAR(fine / finest, 2, 0.2);
}

TEST(MsdSimulation, TheJuryLimitIsRefused) {
  const auto rule = [](const Scene& scene) -> std::string {
    const auto simulation = Simulation::create(scene);
    return simulation ? "" : simulation.error().rule;
  };
  ASSERT_NEAR(critical_stiffness(kFigure, 0.01), 700, 1e-9);
  EXPECT_EQ(rule(object_at_origin(kFigure, 10, 349.9)), "");
  EXPECT_EQ(rule(object_at_origin(kFigure, 10, 350.1)), "R-SIM-3");
  EXPECT_EQ(rule(object_at_origin(kFigure, 17, 340)), "R-SIM-3");
  Scene alone = object_at_origin(kFigure, 10, 690);
  EXPECT_EQ(rule(alone), "R-SIM-3");
  alone.users.pop_back();
  EXPECT_EQ(rule(alone), "");
}

TEST(MsdSimulation, AFrameHoldsOneInstantInOneDegreeOfFreedom) {
  auto simulation = Simulation::create(shipped());
  ASSERT_TRUE(simulation);
  ASSERT_EQ(simulation->info().objects.size(), 1u);
  EXPECT_EQ(simulation->info().objects[0].dof, Dof::x);
  int pressed = 0, both = 0;
  for (std::int64_t i = 0; i < simulation->ticks(); ++i) {
    ASSERT_TRUE(simulation->step());
    const TraceFrame& frame = simulation->frame();
    const RigidSample& surface = frame.objects.at(0);
    ASSERT_EQ(surface.pose.position.y, 0);
    ASSERT_EQ(surface.pose.position.z, 0);
    ASSERT_EQ(surface.pose.rotation, Quat{});
    int now = 0;
    for (const UserSample& user : frame.users) {
      ASSERT_LE(user.force.x, 0) << "a push back, never a pull";
      if (user.contact.kind == ContactKind::none) continue;
      ++now;
      ASSERT_LT(norm(user.server_force - contact_force(user.contact, surface.pose)), 1e-12);
      ASSERT_LT(user.server_force.x, 0);
    }
    pressed += now > 0;
    both += now == 2;
  }
  EXPECT_GT(pressed, 2000);
  EXPECT_GT(both, 1000);
}

TEST(MsdSimulation, SameSeedSameBitsOtherSeedOtherBits) {
  const auto run = [](std::uint64_t seed) {
    auto simulation = Simulation::create(shipped(), {.seed = seed, .grip = {}, .channel = {}});
    std::vector<double> out;
    for (int i = 0; i < 1500; ++i) {
      EXPECT_TRUE(simulation->step());
      const TraceFrame& frame = simulation->frame();
      out.push_back(frame.objects[0].pose.position.x);
      for (const UserSample& user : frame.users)
        out.insert(out.end(), {user.device.position.x, user.force.x, user.server_force.x});
    }
    return out;
  };
  const std::vector<double> first = run(1);
  EXPECT_EQ(first, run(1));
  EXPECT_NE(first, run(2));
}

TEST(MsdSimulation, TravelsThroughTheCodecAndAllocatesNothing) {
  SimulationOptions options{.seed = 1, .grip = {}, .channel = ChannelOptions{}};
  options.channel->sender.triggers.weber_fraction = 0.05;
  auto simulation = Simulation::create(shipped(), options);
  ASSERT_TRUE(simulation);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(simulation->step());
  const std::uint64_t before = testing::allocated_bytes();
  int packets = 0;
  double difference = 0;
  for (int i = 0; i < 1500; ++i) {
    const auto packet = simulation->step();
    if (!packet) break;
    packets += static_cast<int>(packet->size());
    difference =
        std::max(difference, norm(simulation->client_poses()[0].position - simulation->frame().objects[0].pose.position));
  }
  EXPECT_EQ(testing::allocated_bytes() - before, 0u);
  EXPECT_GT(packets, 20);
  EXPECT_LT(packets, 1000);
  EXPECT_GT(difference, 0) << "the client sees what was decoded";
}

TEST(MsdScene, KeysAndTheirErrors) {
  const std::string head = "name = \"t\"\nduration = 1.0\ngravity = [0, 0, 0]\n";
  const std::string body = head +
                           "[[msd]]\nname = \"m\"\nstiffness = 100\ndamping = 1\nmass = 0.01\n"
                           "position = [1, 2, 3]\n";  // lines 4 to 9
  const auto plain = parse_scene(body, "t.toml");
  ASSERT_TRUE(plain) << to_string(plain.error());
  EXPECT_EQ(plain->msds.at(0).normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(plain->msds.at(0).dof(), Dof::z);
  EXPECT_EQ(plain->msds.at(0).rate, 1u);
  EXPECT_EQ(plain->msds.at(0).touch_damping, 0);
  EXPECT_EQ(parse_scene(body + "faces = \"-y\"\n", "t.toml")->msds.at(0).normal, (Vec3{0, -1, 0}));
  struct Broken {
    std::string text;
    const char* rule;
    std::uint32_t line;
    const char* key;
  };
  const auto without = [&](const std::string& key) {
    const auto at = body.find(key);
    return body.substr(0, at) + body.substr(body.find('\n', at));
  };
  const std::vector<Broken> cases{{body + "colour = 1\n", "R-SCN-3", 10, "msd.colour"},
                                  {without("mass"), "R-SCN-4", 4, "msd.mass"},
                                  {without("position"), "R-SCN-4", 4, "msd.position"},
                                  {body + "rate = 0\n", "R-SCN-6", 10, "msd.rate"},
                                  {body + "faces = \"up\"\n", "R-SCN-7", 10, "msd.faces"},
                                  {body + "touch_damping = -1\n", "R-SCN-6", 10, "msd.touch_damping"},
                                  {body + body.substr(head.size()), "R-SCN-7", 10, "msd.name"}};
  for (const Broken& c : cases) {
    const auto scene = parse_scene(c.text, "t.toml");
    ASSERT_FALSE(scene) << c.key;
    EXPECT_STREQ(scene.error().error.rule, c.rule) << c.key;
    EXPECT_EQ(scene.error().line, c.line) << c.key;
    EXPECT_EQ(scene.error().detail, c.key);
  }
}

}  // namespace
}  // namespace tactus::sim
