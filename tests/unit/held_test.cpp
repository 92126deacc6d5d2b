// SPDX-License-Identifier: Apache-2.0
/// What of a truth breaks a rule is held: the others go on, and it is named.
#include <tactus/sender.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string_view>
#include <vector>

#include <tactus/receiver.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using testing::all;
using testing::SheetFrame;

constexpr std::uint32_t kSquares = 4;
constexpr double kTick = 1.0 / 60;

using Bytes = std::vector<std::uint8_t>;
std::vector<Bytes> bytes_of(std::span<const Packet> packets) {
  std::vector<Bytes> out;
  for (const Packet& packet : packets) out.emplace_back(packet.bytes.begin(), packet.bytes.end());
  return out;
}

/// Ten objects on circles at 60 Hz, and what each is to be shown as: the last good pose of one that is held.
class Roundabout {
 public:
  static constexpr std::size_t kObjects = 10;
  static constexpr double kSpeed = 0.7;

  void step(std::int64_t tick) {
    for (std::size_t i = 0; i < kObjects; ++i) {
      const double w = kSpeed * (1 + 0.1 * static_cast<double>(i)), a = w * kTick * static_cast<double>(tick);
      samples[i] = {};
      samples[i].pose.position = {std::sin(a), std::cos(a) + 0.01 * static_cast<double>(i), 0.1 * static_cast<double>(i)};
      samples[i].velocity = {w * std::cos(a), -w * std::sin(a), 0};
      wanted[i] = samples[i].pose.position;
    }
  }
  std::vector<RigidSample> samples = std::vector<RigidSample>(kObjects);
  std::vector<Vec3> wanted = std::vector<Vec3>(kObjects);
};

struct Wrong {
  std::string_view rule;
  std::function<void(RigidSample&)> change;
};

const double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinite = std::numeric_limits<double>::infinity();
const Wrong kWrongs[] = {
    {"R-API-1", [](RigidSample& s) { s.pose.position.y = kNan; }},
    {"R-API-1", [](RigidSample& s) { s.angular_velocity.z = -kInfinite; }},
    {"R-API-2", [](RigidSample& s) { s.pose.position.z = -600; }},
    {"R-API-2", [](RigidSample& s) { s.velocity.x = 1e9; }},
    {"R-API-3",
     [](RigidSample& s) {
       s.pose.rotation = {0, 0, 0, 0};
     }},
    {"R-API-6",
     [](RigidSample& s) {
       s.pose.rotation = {std::cos(0.1), 0, 0, std::sin(0.1)};
     }},
};

/// One of ten becomes what it must not be, for 100 ticks, and comes back: the others keep their bounds at every tick, it is shown where it was
/// last within its own, at rest, and named; from the first good tick on its bounds hold again.
TEST(Held, OneBadObjectDoesNotStopTheOthers) {
  for (const bool is_smoothed : {false, true}) {
    SceneSpec spec = testing::spec_of(Roundabout::kObjects);
    spec.tick_rate = 60;
    spec.max_extrapolation = 120;
    spec.is_smoothed = is_smoothed;
    if (is_smoothed) spec.motion = {{0, 0, -1285816}, 321454};
    spec.objects[4].dof = Dof::x | Dof::y | Dof::z;
    const SharedScene scene = testing::shared(std::move(spec));
    for (const Wrong& wrong : kWrongs) {
      for (const bool names_moved : {false, true}) {
        const SenderOptions options{.triggers = {.heartbeat = 0, .visual_position = 0.005, .visual_rotation = 0.03}};
        auto sender = Sender::create(scene, options).value();
        auto receiver = Receiver::create(scene).value();
        Roundabout world;
        Vec3 last, before;
        std::size_t over = 0, moved_while_held = 0;
        for (std::int64_t tick = 0; tick < 250; ++tick) {
          world.step(tick);
          const bool is_bad = tick >= 100 && tick < 200;
          if (tick < 100) last = world.samples[4].pose.position;
          if (is_bad) wrong.change(world.samples[4]), world.wanted[4] = last;
          std::vector<std::uint32_t> moved{0, 1, 2, 3, 5, 6, 7, 8, 9};
          if (!is_bad || tick == 100) moved.push_back(4);  // what it is does not change any more
          Truth truth{.objects = world.samples};
          if (names_moved) truth.moved = moved;
          for (const Packet& packet : all(sender.encode(tick, truth))) ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
          ASSERT_EQ(sender.held().size(), is_bad ? 1u : 0u) << wrong.rule << " tick " << tick;
          if (is_bad) {
            const HeldPart& held = sender.held()[0];
            EXPECT_TRUE(held.part == TruthPart::object && held.index == 4 && held.since == 100)
                << held.index << " " << held.since;
            EXPECT_EQ(held.rule, wrong.rule);
            EXPECT_EQ(name_of(*scene, held), "object 4");
            EXPECT_STREQ(describe(held), describe(Error{Errc::invalid_argument, wrong.rule.data(), 0}));
            EXPECT_STRNE(describe(held), describe(Error{}));
            EXPECT_STRNE(remedy(held), "");
          }
          for (std::uint32_t i = 0; i < Roundabout::kObjects; ++i) {
            const Vec3 shown = to_pose(receiver.replica().pose(i, tick), scene->grid.position).position;
            if (norm(shown - world.wanted[i]) > 0.005) ++over;
            if (i != 4) continue;
            if (is_bad && tick > 160 && shown != before) ++moved_while_held;
            before = shown;
          }
        }
        EXPECT_EQ(over, 0u) << wrong.rule << (is_smoothed ? " smoothed" : "") << (names_moved ? " named" : "");
        EXPECT_EQ(moved_while_held, 0u) << wrong.rule;
      }
    }
  }
}

/// It slowed down, and what is accelerated is sent with velocities ahead of it: against its motion. To be held is to stop, which looks like more
/// of the same. What is held rests: all that is sent of it from then on does.
TEST(Held, RestsThoughItWasAccelerated) {
  const SharedScene scene = SceneBuilder(1000).rigid("rises").build().value();
  auto sender = Sender::create(scene, {.triggers = {.visual_position = 1e-3, .haptic = HapticRule::off}}).value();
  auto receiver = Receiver::create(scene).value();
  std::size_t sent = 0;
  for (std::int64_t tick = 0; tick < 400; ++tick) {
    const double t = 1e-3 * static_cast<double>(tick);
    RigidSample sample{{{9 * t - 10 * t * t, 0, 0}, {}}, {9 - 20 * t, 0, 0}, {}};
    if (tick >= 200) sample.pose.position.x = kNan;
    for (const Packet& packet : all(sender.encode(tick, {.objects = {&sample, 1}}))) {
      ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
      if (tick < 200) continue;
      ++sent;
      EXPECT_EQ(receiver.object(0).velocity, Vec3i{}) << tick;
    }
  }
  EXPECT_GT(sent, 0u);
}

TEST(Held, FromTheFirstTickOnWhereTheSceneDeclaresIt) {
  const Pose home{{0.25, -0.5, 1}, {}};
  const SharedScene scene = SceneBuilder(60).rigid("good").rigid("bad", home).build().value();
  auto sender = Sender::create(scene).value();
  auto receiver = Receiver::create(scene).value();
  std::vector<RigidSample> samples(2);
  for (std::int64_t tick = 0; tick < 60; ++tick) {
    samples[0].pose.position.x = 0.01 * static_cast<double>(tick);
    samples[1].pose.position.x = tick < 40 ? kNan : 0.3;
    for (const Packet& packet : all(sender.encode(tick, {.objects = samples})))
      ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
    const Vec3 shown = to_pose(receiver.replica().pose(1, tick), scene->grid.position).position;
    if (tick < 40) {
      EXPECT_EQ(shown, home.position);
    } else {
      EXPECT_LE(norm(shown - samples[1].pose.position), RigidTriggers{}.visual_position) << tick;
    }
    EXPECT_EQ(sender.held().size(), tick < 40 ? 1u : 0u);
  }
}

/// A contact or touch that is none does not count; what is rendered at the others keeps its bound.
TEST(Held, ABadContactDoesNotCount) {
  const SharedScene scene = testing::scene_of(2);
  const RigidTriggers triggers{.weber_fraction = 0.05};
  auto sender = Sender::create(scene, {.triggers = triggers}).value(),
       spared = Sender::create(scene, {.triggers = triggers}).value();
  testing::Motion motion(3);
  const std::function<void(Contact&)> wrongs[] = {
      [](Contact& c) { c.kind = ContactKind::spring, c.device.x = kNan; },
      [](Contact& c) { c.stiffness = -1; },
      [](Contact& c) { c.object = 2; },
      [](Contact& c) {
        c.normal = {0, 0, 3};
      },
      [](Contact& c) { c.kind = static_cast<ContactKind>(7); },
  };
  std::int64_t tick = 0;
  for (const auto& change : wrongs) {
    for (int i = 0; i < 100; ++i, ++tick) {
      std::vector<RigidSample> samples(2);
      samples[0] = motion.step(1e-3);
      const Contact good = testing::touch(0, samples[0].pose, 0.002);
      std::vector<Contact> contacts(20, good);
      for (std::size_t k = 1; k < contacts.size(); ++k) {
        contacts[k] = testing::touch(0, samples[0].pose, 1e-4);  // a small force, which would have a small bound
        change(contacts[k]);
      }
      const auto packets = all(sender.encode(tick, {samples, contacts}));
      ASSERT_EQ(bytes_of(packets), bytes_of(all(spared.encode(tick, {samples, {&good, 1}})))) << tick;
      ASSERT_EQ(sender.held().size(), 16u) << "no more are reported";
      for (const HeldPart& held : sender.held()) EXPECT_TRUE(held.part == TruthPart::contact && held.index >= 1);
      EXPECT_EQ(sender.held()[0].since, 0);
      EXPECT_TRUE(spared.held().empty());
    }
  }
  const RigidSample rest[2]{};
  all(sender.encode(tick, {rest}));
  EXPECT_TRUE(sender.held().empty());
}

/// What touches an object that is held is not known; nobody is harmed by it. Where it was last is not what is shown, but within the bounds:
/// whoever it were rendered to would receive it.
TEST(Held, AContactOfAHeldObjectDoesNotCount) {
  const SharedScene scene = testing::scene_of(1);
  auto sender = Sender::create(scene, {.triggers = {.visual_position = 3e-3}}).value();
  RigidSample body;
  Pose last;
  std::size_t packets = 0;
  for (std::int64_t tick = 0; tick < 300; ++tick) {
    const bool is_bad = tick >= 100 && tick < 200;
    body.pose.position.z = is_bad ? kNan : 2e-3 * std::sin(0.05 * static_cast<double>(std::min<std::int64_t>(tick, 99)));
    if (!is_bad) last = body.pose;
    const Contact contact = testing::touch(0, last, 1e-4);
    const std::size_t touches = tick < 120 ? 0 : 1;
    packets = all(sender.encode(tick, {{&body, 1}, {&contact, touches}})).size();
    if (is_bad) {
      ASSERT_EQ(packets, 0u) << tick;
    }
    if (tick == 200) {
      EXPECT_EQ(packets, 1u) << "the same, where it counts";
    }
  }
}

/// What there is no news of stays what it is.
TEST(Held, StaysHeldUntilThereIsNews) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const SharedScene scene = SceneBuilder(60).deformable("sheet", mesh).build().value();
  auto sender = Sender::create(scene).value();
  SheetFrame good{std::vector<float>(3 * mesh.vertices.size()), {}}, bad = good;
  bad.displacements[0] = std::numeric_limits<float>::quiet_NaN();
  bad.touch = {.triangle = 0, .force = -1};
  const DeformableTruth frames[]{good.truth(), bad.truth(), {}, {}, good.truth(), {}};
  std::int64_t tick = 0;
  for (const DeformableTruth& frame : frames) {
    all(sender.encode(tick, {.deformables = {&frame, 1}}));
    EXPECT_EQ(sender.held().size(), tick >= 1 && tick < 4 ? 2u : 0u) << tick;
    if (tick == 3) {
      EXPECT_TRUE(sender.held()[0].part == TruthPart::shape && sender.held()[0].since == 1);
      EXPECT_TRUE(sender.held()[1].part == TruthPart::touch && sender.held()[1].rule == std::string_view("R-API-15"));
    }
    ++tick;
  }
}

/// A shape that breaks a rule is the last good one; the rigid objects, the other shapes and the loads go on.
TEST(Held, ShapesAndLoadsAreTheLastGoodOnes) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const SharedScene scene = SceneBuilder(60)
                                .rigid("cube")
                                .rigid("ball")
                                .deformable("left", mesh)
                                .deformable("right", mesh)
                                .loads({.force_exp = 10, .users = 1})
                                .build()
                                .value();
  auto sender = Sender::create(scene).value();
  auto receiver = Receiver::create(scene).value();
  testing::DentedSheet sheet(mesh, kSquares);
  std::vector<float> kept;
  const double visual = SenderOptions{}.deformable.thresholds.visual;
  for (std::int64_t tick = 0; tick < 120; ++tick) {
    const bool is_bad = tick >= 40 && tick < 80;
    SheetFrame left = sheet.frame(tick), right = left;
    if (tick < 40) kept = left.displacements;
    const std::vector<float> wanted = is_bad ? kept : left.displacements;
    if (is_bad) left.displacements[7] = tick % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : 40.0f;
    const DeformableTruth shapes[]{left.truth(), right.truth()};
    const RigidSample bodies[2]{{.pose = {{0.01 * static_cast<double>(tick), 0, 0}, {}}, .velocity = {}, .angular_velocity = {}},
                                {}};
    const Vec3 push{1 + 0.01 * static_cast<double>(tick), 0, 0};
    ObjectLoad loads[2]{{{1, 0, 0}, {}, {&push, 1}}, {{is_bad ? kInfinite : 2, 0, 0}, {}, {&push, 1}}};
    const Truth truth{.objects = bodies, .contacts = {}, .deformables = shapes, .loads = loads};
    for (const Packet& packet : all(sender.encode(tick, truth))) ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
    ASSERT_EQ(sender.held().size(), is_bad ? 2u : 0u) << tick;
    if (is_bad) {
      EXPECT_EQ(name_of(*scene, sender.held()[0]), "left");
      EXPECT_EQ(sender.held()[0].rule, std::string_view(tick % 2 == 0 ? "R-API-1" : "R-API-2"));
      EXPECT_TRUE(sender.held()[0].part == TruthPart::shape && sender.held()[0].since == 40);
      EXPECT_EQ(name_of(*scene, sender.held()[1]), "ball");
      EXPECT_TRUE(sender.held()[1].part == TruthPart::load && sender.held()[1].rule == std::string_view("R-API-1"));
    }
    const std::vector<float>* wants[]{&wanted, &right.displacements};
    for (std::size_t object = 0; object < 2; ++object) {
      const auto shape = receiver.replica().displacements(object, tick);
      for (std::size_t v = 0; v < shape.size(); ++v) {
        const Vec3 u = to_metres(shape[v], scene->grid.position);
        const float* const w = wants[object]->data() + 3 * v;
        EXPECT_LE(norm(u - Vec3{static_cast<double>(w[0]), static_cast<double>(w[1]), static_cast<double>(w[2])}), visual)
            << tick;
      }
    }
    EXPECT_NEAR(to_force(receiver.load(1, tick)[kExternal], 10).x, 2, 0.21);
    EXPECT_LE(norm(to_pose(receiver.replica().pose(0, tick), scene->grid.position).position - bodies[0].pose.position),
              RigidTriggers{}.visual_position);
  }
}

}  // namespace
}  // namespace tactus
