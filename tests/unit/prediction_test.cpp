// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/prediction/prediction.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace tactus::sim {
namespace {

constexpr std::uint32_t kDelay = 60;        // [ticks] there and back
constexpr std::uint32_t kAge = kDelay + 1;  // a state answers the samples before it

Scene cube() {
  Scene out = load_scene(*find_scene("push-cube")).value();
  out.compensation.emplace().method = CompensationMethod::simulation;
  return out;
}

/// Pushes the cube of push-cube along x at a constant speed, from a while after the beginning on.
DeviceSample pushing(std::int64_t tick) {
  const double x = -0.03 + 2e-5 * static_cast<double>(std::max<std::int64_t>(0, tick - 200));
  return {.position = {std::min(x, 0.03), 0, 0.02}};
}

double distance(const Pose& a, const Pose& b) { return norm(a.position - b.position); }

/// A server of its own, which hears the device late and is heard late.
struct FarServer {
  explicit FarServer(const Scene& scene) : server(Server::create(scene, {}).value()), past(scene.objects[0].pose, 1000) {}
  void step(std::int64_t tick) {
    server->observe();
    past.add(tick, server->frame().objects[0].pose);
    const DeviceSample device = pushing(tick - kDelay / 2);
    server->touch({&device, 1});
    ASSERT_TRUE(server->step());
  }
  const Pose& heard(std::int64_t tick) const { return past.at(tick - kDelay / 2); }

  std::unique_ptr<Server> server;
  PastPoses past;
};

TEST(PastPoses, AreThoseOfTheirTicks) {
  const auto at = [](double x) { return Pose{{x, 0, 0}, {}}; };
  PastPoses past(at(0), 4);
  EXPECT_EQ(past.at(100).position.x, 0);
  past.add(10, at(1));
  past.add(11, at(1));  // nothing
  past.add(20, at(2));
  EXPECT_EQ(past.at(9).position.x, 0);
  EXPECT_EQ(past.at(10).position.x, 1);
  EXPECT_EQ(past.at(19).position.x, 1);
  EXPECT_EQ(past.at(20).position.x, 2);
  for (int i = 0; i < 10; ++i) past.add(30 + i, at(3 + i));
  EXPECT_EQ(past.at(9).position.x, 9) << "the oldest that is kept";
  EXPECT_EQ(past.at(38).position.x, 11);
  EXPECT_EQ(past.at(1000).position.x, 12);
}

TEST(PastShapes, AreComparedBetweenTheirTicks) {
  PastShapes past(1, 100, 10);
  for (int i = 1; i <= 5; ++i) {
    const float shape[3]{0.001F * static_cast<float>(i), 0, 0};
    past.add(10 * i, shape);
  }
  const PastShapes::Displacement heard{3 << 10, 0, 0};  // 0.003 m
  past.hear({&heard, 1}, 20, 0);
  EXPECT_EQ(past.heard_age(), 0);
  past.compare(25, 1);  // own: 0.0025 m
  EXPECT_LT(past.heard_age(), 0);
  past.show();
  const double metre = 1 << PastShapes::kExp;
  EXPECT_NEAR(past.shown()[0][0] / metre, 0.005 + (3072 / metre - 0.0025), 2 / metre);
  const float later[3]{0.105F, 0, 0};
  past.add(200, later);  // it rested from 50 to 190
  past.hear({&heard, 1}, 20, 0);
  past.compare(120, 1);
  past.show();
  EXPECT_NEAR(past.shown()[0][0] / metre, 0.105 + (3072 / metre - 0.005), 2 / metre) << "at rest it has its last shape";
  past.hear({&heard, 1}, 20, 0);
  past.show_heard();
  EXPECT_EQ(past.shown()[0][0], 3 << 10);
}

TEST(Prediction, IsWhatTheServerWillBeWhenTheDeviceHasGotThere) {
  const Scene scene = cube();
  FarServer server(scene);
  const auto own = Prediction::create(scene, 0).value();
  PastPoses predicted(scene.objects[0].pose, 1000);
  double farthest = 0;
  for (std::int64_t tick = 0; tick < 3500; ++tick) {
    server.step(tick);
    own->hear(0, server.heard(tick), tick);
    own->correct(kAge);
    predicted.add(tick, own->poses()[0]);
    own->step(pushing(tick));
    farthest = std::max(farthest, distance(predicted.at(tick - kDelay / 2), server.past.at(tick)));
  }
  EXPECT_GT(server.past.at(3499).position.x, 0.04) << "the cube is pushed";
  EXPECT_LT(farthest, 1e-9);
}

/// What the client knows of friction, mass and damping is wrong: it is corrected, a little at a time.
TEST(Prediction, ComesToTheServersStateWithoutAJump) {
  const Scene scene = cube();
  Scene wrong = scene;
  wrong.objects[0].friction *= 1.2;
  wrong.objects[0].mass *= 1.1;
  FarServer server(scene);
  const auto own = Prediction::create(wrong, 0).value();
  double farthest = 0, longest = 0;
  Pose before = scene.objects[0].pose;
  for (std::int64_t tick = 0; tick < 5000; ++tick) {
    server.step(tick);
    own->hear(0, server.heard(tick), tick);
    own->correct(kAge);
    if (tick > 0) longest = std::max(longest, distance(own->poses()[0], before));
    before = own->poses()[0];
    farthest = std::max(farthest, distance(before, server.past.at(tick)));
    own->step(pushing(tick));
  }
  EXPECT_LT(longest, 3 * 2e-5) << "[m] in a tick, while the device goes 2e-5";
  EXPECT_LT(farthest, 2.5e-3) << "what the delay takes alone is 1.2 mm, one way";
  EXPECT_LT(distance(own->poses()[0], server.past.at(4999)), 1.1e-4);
}

constexpr DeviceSample kAway{.position = {-0.05, 0, 0.02}};  // touches nothing

/// What others push moves the own object at once; what they turned is turned to where the server has it.
TEST(Prediction, FollowsWhatOthersDo) {
  const Scene scene = cube();
  const auto own = Prediction::create(scene, 0).value();
  double pushed = 0;
  for (std::int64_t tick = 0; tick < 300; ++tick) {
    own->hear(0, scene.objects[0].pose, tick);
    own->push(0, {tick < 100 ? 2.0 : 0.0, 0, 0});
    own->correct(kAge);
    pushed = std::max(pushed, own->poses()[0].position.x);
    own->step(kAway);
  }
  EXPECT_GT(pushed, 5e-4) << "by 2 N against a friction of 1.1 N, before the server says that it stands";

  const double half = 0.15;
  const Pose turned{{0.01, 0, 0.02}, {std::cos(half), 0, 0, std::sin(half)}};
  double before = angle_between(own->poses()[0].rotation, turned.rotation);
  for (std::int64_t tick = 0; tick < 1500; ++tick) {
    own->hear(0, turned, tick);
    own->correct(kAge);
    const double now = angle_between(own->poses()[0].rotation, turned.rotation);
    ASSERT_LT(std::abs(now - before), 0.01) << "[rad] in tick " << tick;
    before = now;
    own->step(kAway);
  }
  EXPECT_LT(before, 2.1e-3);
  EXPECT_LT(distance(own->poses()[0], turned), 1.1e-4);
}

TEST(Prediction, MovesNothingAlongAxesThatAreLocked) {
  Scene scene = cube();
  scene.objects[0].dof = Dof::x;
  const auto own = Prediction::create(scene, 0).value();
  const Pose& home = scene.objects[0].pose;
  for (std::int64_t tick = 0; tick < 500; ++tick) {
    own->hear(0, {home.position + Vec3{0.005, 0.005, 0}, {std::cos(0.1), 0, 0, std::sin(0.1)}}, tick);
    own->correct(tick < 250 ? kAge : 0);
    if (tick < 250) {
      ASSERT_EQ(own->poses()[0].position.y, home.position.y) << tick;
      ASSERT_EQ(own->poses()[0].rotation, home.rotation) << tick;
    }
    own->step(kAway);
  }
  own->correct(kAge);
  EXPECT_NEAR(own->poses()[0].position.x, home.position.x + 0.005, 1.1e-4);
  EXPECT_NEAR(own->poses()[0].position.y, home.position.y, 1e-12);
}

/// One that yields keeps no error: what others press is added to what the own user presses.
TEST(Prediction, AddsWhatTheServerKnowsToWhatYields) {
  Scene scene = load_scene(*find_scene("msd-1d")).value();
  const auto own = Prediction::create(scene, 0).value();
  const Vec3 rest = scene.msds[0].position;
  for (std::int64_t tick = 0; tick < 400; ++tick) {
    const double sunk = tick < 200 ? 0.004 : 0;
    own->hear(0, {rest - Vec3{0, 0, sunk}, {}}, tick);
    own->correct(kAge);
    if (tick == 199) {
      EXPECT_NEAR(own->poses()[0].position.z, rest.z - 0.004, 1e-6);
    }
    own->step({.position = rest + Vec3{0, 0, 0.05}});
  }
  EXPECT_NEAR(own->poses()[0].position.z, rest.z, 1e-6);
}

TEST(Prediction, SetsWhatIsFarAwayToTheServersPose) {
  const Scene scene = cube();
  const auto own = Prediction::create(scene, 0).value();
  const Pose there{{2, 1, 0.02}, {}};
  for (std::int64_t tick = 0; tick < 3; ++tick) {
    own->hear(0, there, tick);
    own->correct(kAge);
    EXPECT_LT(distance(own->poses()[0], there), 1e-3) << tick;
    own->step({.position = {-0.05, 0, 0.02}});
  }
}

TEST(Prediction, TurnsAtOnceWhatIsTurnedFarAway) {
  const Scene scene = cube();
  const auto own = Prediction::create(scene, 0).value();
  const Pose there{scene.objects[0].pose.position, {std::cos(0.6), 0, 0, std::sin(0.6)}};
  own->hear(0, there, 0);
  own->correct(kAge);
  EXPECT_LT(angle_between(own->poses()[0].rotation, there.rotation), 1e-6);
}

/// Corrections about one axis after the other, far apart in time, add up to the pose of the server and not to another.
TEST(Prediction, AddsTurnsAboutSeveralAxes) {
  Scene scene = cube();
  scene.gravity = {};
  scene.floor.reset();
  const auto own = Prediction::create(scene, 0).value();
  const Vec3 position = scene.objects[0].pose.position;
  const Quat about_x{std::cos(0.4), std::sin(0.4), 0, 0}, about_y{std::cos(0.4), 0, std::sin(0.4), 0};
  for (const Quat& server : {about_x, about_y * about_x}) {
    double before = 0.8;
    for (std::int64_t tick = 0; tick < 1500; ++tick) {
      own->hear(0, {position, server}, tick);
      own->correct(kAge);
      const double now = angle_between(own->poses()[0].rotation, server);
      ASSERT_LE(now, before + 1e-9) << "no farther than to it, in tick " << tick;
      before = now;
      own->step(kAway);
    }
    EXPECT_LT(before, 2.1e-3);
  }
}

#ifdef TACTUS_WITH_FEM
/// Presses into the membrane, slowly, from tick 50 on.
DeviceSample pressing(std::int64_t tick) {
  return {.position = {0.012, 0, 0.001 - 1e-5 * static_cast<double>(std::clamp<std::int64_t>(tick - 50, 0, 600))}};
}

std::vector<PastShapes::Displacement> kept(std::span<const PastShapes::Displacement> shape) {
  return {shape.begin(), shape.end()};
}

/// A shape that is heard some ticks after its frame began is compared with the own one of that time.
TEST(Prediction, ComparesShapesByTheirAge) {
  const Scene scene = load_scene(*find_scene("membrane-small")).value();
  const std::int64_t period = scene.deformables[0].rate, late = 5;
  const auto server = Prediction::create(scene, 0).value(), own = Prediction::create(scene, 0).value();
  std::map<std::int64_t, std::vector<PastShapes::Displacement>> shapes;  // of the server, by tick
  std::int32_t deepest = 0, farthest = 0;
  for (std::int64_t tick = 0; tick < 800; ++tick) {
    server->correct(0);
    if (const auto shape = server->new_shape(0); !shape.empty()) shapes[tick] = kept(shape);
    server->step(pressing(tick));
    const std::int64_t began = tick + 1 - kAge - late;
    if (shapes.contains(began)) own->hear(0, shapes[began], PastShapes::kExp, began + late);
    own->correct(kAge);
    if (const auto shape = own->new_shape(0); !shape.empty() && shapes.contains(tick))
      for (std::size_t v = 0; v < shape.size(); ++v) {
        deepest = std::max(deepest, std::abs(shapes[tick][v][2]));
        farthest = std::max(farthest, std::abs(shape[v][2] - shapes[tick][v][2]));
      }
    own->step(pressing(tick));
  }
  EXPECT_GT(shapes.size(), static_cast<std::size_t>(600 / period));
  EXPECT_GT(deepest, 3000) << "x 2^-20 m";
  EXPECT_LE(farthest, 2);
}

/// An object that sleeps at the client takes over what the server makes of it, frame by frame.
TEST(Prediction, ShowsWhatIsHeardOfAShapeThatSleeps) {
  const Scene scene = load_scene(*find_scene("membrane-small")).value();
  const auto own = Prediction::create(scene, 0).value();
  const std::int64_t period = scene.deformables[0].rate;
  std::vector<PastShapes::Displacement> dent(std::size_t{17 * 21 * 2});
  dent[100][2] = -1000;
  std::int32_t seen = 0;
  for (std::int64_t tick = 0; tick < 600; ++tick) {
    if (tick % period == 0) own->hear(0, dent, PastShapes::kExp, tick);
    own->correct(kAge);
    if (const auto shape = own->new_shape(0); !shape.empty()) seen = shape[100][2];
    own->step(kAway);
  }
  EXPECT_NEAR(seen, -1000, 2);
}
#endif

TEST(Prediction, FollowsTheServerWhileTheDelayIsNotKnown) {
  const Scene scene = cube();
  const auto own = Prediction::create(scene, 0).value();
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    const Pose heard{{1e-4 * static_cast<double>(tick), 0, 0.02}, {}};
    own->hear(0, heard, tick);
    own->correct(0);
    EXPECT_EQ(own->poses()[0].position, heard.position);
    own->step({.position = {-0.05, 0, 0.02}});
  }
}

TEST(Prediction, IsTheServersStateOnceItsPhysicsBrokeDown) {
  const Scene scene = cube();
  const auto own = Prediction::create(scene, 0).value();
  const Pose heard{{0.01, 0, 0.02}, {}};
  for (std::int64_t tick = 0; tick < 3; ++tick) {
    own->hear(0, heard, tick);
    own->push(0, {1e15, 0, 0});
    own->correct(kAge);
    own->step({.position = {-0.05, 0, 0.02}});
  }
  own->correct(kAge);
  EXPECT_EQ(own->poses()[0].position, heard.position);
}

TEST(Prediction, WhatRestsIsLeftAlone) {
  const Scene scene = cube();
  const auto own = Prediction::create(scene, 0).value();
  Pose heard = scene.objects[0].pose;
  heard.position.x += 5e-5;  // within what a codec leaves
  for (std::int64_t tick = 0; tick < 300; ++tick) {
    own->hear(0, heard, tick);
    own->correct(kAge);
    own->step({.position = {-0.05, 0, 0.02}});
  }
  own->correct(kAge);
  EXPECT_EQ(own->poses()[0].position.x, scene.objects[0].pose.position.x);
}

}  // namespace
}  // namespace tactus::sim
