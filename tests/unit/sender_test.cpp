// SPDX-License-Identifier: Apache-2.0
/// A scene of several substreams at its sender: what a tick brings, what an error leaves, and what packets build on.
#include <tactus/sender.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <string_view>

#include <tactus/receiver.h>
#include <tactus/rigid/trigger.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using testing::all;
using testing::SheetFrame;

constexpr std::uint32_t kSquares = 4;
constexpr std::size_t kSubstreams = 4;
constexpr double kTick = 1.0 / 60;

/// What truly is at a tick, and can be made wrong.
struct Frame {
  std::vector<RigidSample> samples;
  std::vector<Contact> contacts;
  std::vector<SheetFrame> sheets;

  /// Valid until the next call.
  Truth truth() {
    shapes.clear();
    for (const SheetFrame& sheet : sheets) shapes.push_back(sheet.truth());
    return {samples, contacts, shapes};
  }

 private:
  std::vector<DeformableTruth> shapes;
};

class World {
 public:
  explicit World(std::uint64_t seed = 1, double noise = 0) : cube_(seed), sheet_(mesh_, kSquares, noise) {}

  Frame step() {
    Frame out;
    out.samples.resize(3);
    out.samples[0] = cube_.step(kTick);
    out.samples[2].pose.position.x = 0.1 * std::sin(0.1 * static_cast<double>(tick_));
    out.contacts = {testing::touch(0, out.samples[0].pose, 0.002)};
    out.sheets.assign(kSubstreams - 1, sheet_.frame(tick_++));
    return out;
  }

 private:
  TriMesh mesh_ = testing::sheet(kSquares, kSquares);
  testing::Motion cube_;
  testing::DentedSheet sheet_;
  std::int64_t tick_ = 0;
};

std::vector<std::uint64_t> hashes(const Sender& sender) {
  std::vector<std::uint64_t> out;
  for (std::size_t i = 0; i < kSubstreams; ++i) out.push_back(sender.state_hash(i));
  return out;
}

using Bytes = std::vector<std::uint8_t>;
std::vector<Bytes> bytes_of(std::span<const Packet> packets) {
  std::vector<Bytes> out;
  for (const Packet& packet : packets) out.emplace_back(packet.bytes.begin(), packet.bytes.end());
  return out;
}

TEST(Sender, SubstreamsComeInOrderAndWhatIsFeltFirst) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  auto sender = Sender::create(scene, {.triggers = {}, .deformable = {}, .policy = {.first_sequence = 65530}}).value();
  World world;
  std::array<std::uint16_t, kSubstreams> next;
  next.fill(65530);
  std::array<std::size_t, kSubstreams> count{};
  for (std::int64_t tick = 0; tick < 300; ++tick) {
    Frame frame = world.step();
    const auto packets = all(sender.encode(tick, frame.truth()));
    EXPECT_TRUE(std::ranges::is_sorted(packets, {}, &Packet::substream));
    for (std::size_t i = 0; i < packets.size(); ++i) {
      const Packet& packet = packets[i];
      EXPECT_EQ(packet.bytes[0], packet.substream);
      EXPECT_EQ(packet.sequence, next.at(packet.substream)++);
      EXPECT_EQ(packet.layer == Layer::all, packet.substream != 1);
      ++count.at(packet.substream);
      if (i == 0 || packets[i - 1].substream != packet.substream) continue;
      EXPECT_EQ(packet.substream, 1u) << "two packets are of an object in layers";
      EXPECT_EQ(packets[i - 1].layer, Layer::haptic);
      EXPECT_EQ(packet.layer, Layer::visual);
    }
  }
  for (const std::size_t c : count) EXPECT_GT(c, 20u);
}

TEST(Sender, SaysNothingOfWhatHasNoNewShape) {
  auto sender = Sender::create(testing::scene_of_every_kind(kSquares)).value();
  World world;
  for (int i = 0; i < 20; ++i) world.step();
  Frame frame = world.step();
  for (RigidSample& sample : frame.samples) sample.velocity = sample.angular_velocity = {};
  const Truth truth = frame.truth();
  const auto substreams = [&](std::int64_t tick, const Truth& of) {
    std::set<std::size_t> out;
    for (const Packet& packet : all(sender.encode(tick, of))) out.insert(packet.substream);
    return out;
  };
  std::vector<DeformableTruth> none(3), last(3);
  last[2] = truth.deformables[2];
  EXPECT_EQ(substreams(0, {frame.samples}), (std::set<std::size_t>{0}));
  EXPECT_EQ(substreams(1, {.objects = frame.samples, .deformables = none}), (std::set<std::size_t>{}));
  EXPECT_EQ(substreams(2, {.objects = frame.samples, .deformables = last}), (std::set<std::size_t>{3}));
  EXPECT_EQ(substreams(3, {.objects = frame.samples, .deformables = truth.deformables}), (std::set<std::size_t>{1, 2}));
  EXPECT_EQ(substreams(4, {.objects = frame.samples, .deformables = truth.deformables}), (std::set<std::size_t>{}));
}

/// What a receiver of all packets shows is within the bounds times their factor; a narrower one holds from the next tick on.
TEST(Sender, WidenedBoundsHoldAndAskForLess) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  const SenderOptions options;
  std::array<std::size_t, 4> bytes{}, steps{1, 4, 8, 1};
  auto sender = Sender::create(scene, options).value();
  auto receiver = Receiver::create(scene).value();
  World world(3);
  double worst = 0;  // error of a position over its given bound
  for (std::int64_t tick = 0; tick < 2000; ++tick) {
    const auto phase = static_cast<std::size_t>(tick / 500);
    if (tick % 500 == 0) sender.set_widening(static_cast<double>(steps[phase]));
    Frame frame = world.step();
    const Truth truth = frame.truth();
    for (const Packet& packet : all(sender.encode(tick, truth))) {
      bytes[phase] += packet.bytes.size();
      ASSERT_TRUE(receiver.push(packet.bytes));
    }
    const double factor = static_cast<double>(steps[phase]);
    const RigidTriggers& t = options.triggers;
    const Pose shown = to_pose(receiver.replica().pose(0, tick), scene->grid.position);
    const double error = norm(shown.position - frame.samples[0].pose.position);
    if (phase > 0) worst = std::max(worst, error / t.visual_position);
    EXPECT_LE(error, factor * t.visual_position);
    EXPECT_LE(angle_between(shown.rotation, frame.samples[0].pose.rotation), factor * t.visual_rotation);
    const Vec3 force = contact_force(frame.contacts[0], frame.samples[0].pose);
    EXPECT_LE(haptic_ratio(t, force, contact_force(frame.contacts[0], shown)), factor);
    for (std::size_t object = 0; object < 2; ++object) {  // those of profile main, which keeps its bounds
      const auto shape = receiver.replica().displacements(object, tick);
      for (std::size_t v = 0; v < shape.size(); ++v) {
        double squared = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double e = std::ldexp(shape[v][axis], -scene->grid.position) -
                           static_cast<double>(truth.deformables[object].displacements[3 * v + axis]);
          squared += e * e;
        }
        EXPECT_LE(std::sqrt(squared), factor * options.deformable.thresholds.visual);
      }
    }
  }
  EXPECT_GT(worst, 1.2) << "they are used";
  EXPECT_LT(1.5 * static_cast<double>(bytes[1]), static_cast<double>(bytes[0]));
  EXPECT_LT(bytes[2], bytes[1]);
  EXPECT_GT(bytes[3], bytes[1]);
}

TEST(Sender, AWideningIsAtLeastOne) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  const auto hashes_with = [&](double factor) {
    auto sender = Sender::create(scene).value();
    sender.set_widening(factor);
    World world;
    for (std::int64_t tick = 0; tick < 200; ++tick) {
      Frame frame = world.step();
      all(sender.encode(tick, frame.truth()));
    }
    return hashes(sender);
  };
  const auto as_given = hashes_with(1);
  for (const double factor : {0.0, -3.0, 0.5, std::numeric_limits<double>::quiet_NaN()}) EXPECT_EQ(hashes_with(factor), as_given);
  EXPECT_EQ(hashes_with(1e300), hashes_with(64));
  EXPECT_NE(hashes_with(64), as_given);
}

TEST(Sender, ASceneWithoutMotionNeedsNoSamples) {
  const SharedScene still = SceneBuilder().rigid("wall", {}, Dof::none).build().value();
  auto sender = Sender::create(still).value();
  const RigidSample sample;
  sender.request_key();
  EXPECT_TRUE(all(sender.encode(0, {})).empty());
  EXPECT_TRUE(all(sender.encode(1, {{&sample, 1}})).empty());
  EXPECT_STREQ(sender.encode(2, {std::vector<RigidSample>(2)}).error().rule, "R-API-5");
  EXPECT_TRUE(sender.encode(2, {}));
}

/// Each wrong call beside a sender that never got it: nothing of any substream is another.
TEST(Sender, NothingChangesAfterAnError) {
  const std::function<void(Frame&)> wrongs[] = {
      [](Frame& f) { f.samples.pop_back(); },
      [](Frame& f) { f.sheets.pop_back(); },
      [](Frame& f) { f.sheets.resize(4); },
      [](Frame& f) { f.sheets[2].displacements.pop_back(); },
      [](Frame& f) { f.sheets[0].displacements = {0}; },
  };
  const SharedScene scene = testing::scene_of_every_kind(kSquares, 2);
  const SenderOptions options{.triggers = {}, .deformable = {}, .policy = {.key_interval = 0.7}};
  auto sender = Sender::create(scene, options).value(), spared = Sender::create(scene, options).value();
  World world;
  std::int64_t tick = 0;
  std::size_t packets = 0;
  for (int round = 0; round < 12; ++round) {
    for (const auto& change : wrongs) {
      Frame frame = world.step(), bad = frame;
      change(bad);
      const auto before = hashes(sender);
      const auto refused = sender.encode(tick, bad.truth());
      ASSERT_FALSE(refused);
      EXPECT_EQ(refused.error().code, Errc::invalid_argument);
      EXPECT_STREQ(refused.error().rule, "R-API-5");
      EXPECT_EQ(hashes(sender), before);
      for (const std::int64_t late : {tick - 1, std::int64_t{-5}, std::int64_t{0xffffffff}})
        EXPECT_STREQ(sender.encode(late, frame.truth()).error().rule, "R-API-5") << late;
      const auto sent = all(sender.encode(tick, frame.truth()));
      ASSERT_EQ(bytes_of(sent), bytes_of(all(spared.encode(tick, frame.truth())))) << "tick " << tick;
      EXPECT_EQ(hashes(sender), hashes(spared));
      EXPECT_TRUE(sender.held().empty());
      packets += sent.size();
      ++tick;
    }
  }
  EXPECT_GT(packets, 100u);
}

/// A jump that no update can name in one: the next tick tells the rest.
TEST(Sender, AJumpAcrossTheWholeGridTakesTwoUpdates) {
  SceneSpec spec = testing::spec_of(1);
  spec.objects[0].initial.position = {-2100000000, 0, 0};
  const SharedScene scene = testing::shared(std::move(spec));
  auto sender = Sender::create(scene, {.triggers = {.visual_position = 2e-6}}).value();
  auto receiver = Receiver::create(scene).value();
  RigidSample body;
  for (std::int64_t tick = 0; tick < 6; ++tick) {
    body.pose.position.x = tick < 2 ? -500.6 + 1e-4 * static_cast<double>(tick) : 500;
    for (const Packet& packet : all(sender.encode(tick, {.objects = {&body, 1}}))) ASSERT_TRUE(receiver.push(packet.bytes));
    const double error = norm(to_pose(receiver.replica().pose(0, tick), scene->grid.position).position - body.pose.position);
    if (tick == 2) EXPECT_NEAR(error, 488.6, 1) << "half of the way";
    else EXPECT_LE(error, 2e-6) << tick;
    EXPECT_TRUE(sender.held().empty());
  }
}

// ==== held ====

/// Ten objects on circles at 60 Hz, and what each is to be shown as: the last good place of one that is held.
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
  for (const bool is_eased : {false, true}) {
    SceneSpec spec = testing::spec_of(Roundabout::kObjects);
    spec.tick_rate = 60;
    spec.max_extrapolation = 120;
    spec.is_eased = is_eased;
    if (is_eased) spec.motion = {{0, 0, -1285816}, 321454};
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
          for (const Packet& packet : all(sender.encode(tick, truth))) ASSERT_TRUE(receiver.push(packet.bytes));
          ASSERT_EQ(sender.held().size(), is_bad ? 1u : 0u) << wrong.rule << " tick " << tick;
          if (is_bad) {
            const HeldPart& held = sender.held()[0];
            EXPECT_TRUE(held.part == TruthPart::object && held.index == 4 && held.since == 100)
                << held.index << " " << held.since;
            EXPECT_EQ(held.rule, wrong.rule);
            EXPECT_EQ(name_of(*scene, held), "object 4");
          }
          for (std::uint32_t i = 0; i < Roundabout::kObjects; ++i) {
            const Vec3 shown = to_pose(receiver.replica().pose(i, tick), scene->grid.position).position;
            if (norm(shown - world.wanted[i]) > 0.005) ++over;
            if (i != 4) continue;
            if (is_bad && tick > 160 && shown != before) ++moved_while_held;
            before = shown;
          }
        }
        EXPECT_EQ(over, 0u) << wrong.rule << (is_eased ? " eased" : "") << (names_moved ? " named" : "");
        EXPECT_EQ(moved_while_held, 0u) << wrong.rule;
      }
    }
  }
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
    for (const Packet& packet : all(sender.encode(tick, {.objects = samples}))) ASSERT_TRUE(receiver.push(packet.bytes));
    const Vec3 shown = to_pose(receiver.replica().pose(1, tick), scene->grid.position).position;
    if (tick < 40) EXPECT_EQ(shown, home.position);
    else EXPECT_LE(norm(shown - samples[1].pose.position), 0.006) << tick;
    EXPECT_EQ(sender.held().size(), tick < 40 ? 1u : 0u);
  }
}

/// A contact or touch that is none does not count; what is felt at the others keeps its bound.
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
      ASSERT_EQ(sender.held().size(), 16u) << "no more are told";
      for (const HeldPart& held : sender.held()) EXPECT_TRUE(held.part == TruthPart::contact && held.index >= 1);
      EXPECT_EQ(sender.held()[0].since, 0);
      EXPECT_TRUE(spared.held().empty());
    }
  }
  const RigidSample rest[2]{};
  all(sender.encode(tick, {rest}));
  EXPECT_TRUE(sender.held().empty());
}

/// What touches an object that is held is not known; nobody is harmed by it.
TEST(Held, AContactOfAHeldObjectDoesNotCount) {
  const SharedScene scene = testing::scene_of(1);
  auto sender = Sender::create(scene).value();
  RigidSample body;
  std::size_t packets = 0;
  for (std::int64_t tick = 0; tick < 200; ++tick) {
    body.pose.position.x = tick < 100 ? 1e-3 * static_cast<double>(tick) : kNan;
    const Contact contact = testing::touch(0, {{0.1, 0, -0.01 * static_cast<double>(tick)}, {}}, 0.01);
    packets += tick < 120 ? 0 : all(sender.encode(tick, {{&body, 1}, {&contact, 1}})).size();
    if (tick < 120) all(sender.encode(tick, {{&body, 1}, {&contact, 1}}));
  }
  EXPECT_EQ(packets, 0u) << "it rests";
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
    for (const Packet& packet : all(sender.encode(tick, truth))) ASSERT_TRUE(receiver.push(packet.bytes));
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
    EXPECT_LE(norm(to_pose(receiver.replica().pose(0, tick), scene->grid.position).position - bodies[0].pose.position), 0.006);
  }
}

TEST(Sender, ARequestIsForEverySubstream) {
  auto sender =
      Sender::create(testing::scene_of_every_kind(kSquares), {.triggers = {}, .deformable = {}, .policy = {.key_interval = 0}})
          .value();
  World world;
  for (int i = 0; i < 20; ++i) world.step();
  Frame frame = world.step();
  const auto keys = [&](std::int64_t tick) {
    std::vector<std::size_t> out;
    for (const Packet& packet : all(sender.encode(tick, frame.truth())))
      if (packet.key) out.push_back(packet.substream);
    return out;
  };
  const std::vector<std::size_t> every{0, 1, 2, 3};
  EXPECT_EQ(keys(0), every);
  EXPECT_EQ(keys(1), std::vector<std::size_t>{});
  sender.request_key();
  EXPECT_EQ(keys(2), every);
  EXPECT_EQ(keys(3), std::vector<std::size_t>{});
}

/// A packet that is dropped at once: the next one builds on the state before it.
TEST(Sender, ForgottenRigidPacketsStopNothing) {
  for (const std::uint8_t span : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{5}}) {
    SceneSpec spec = testing::spec_of(3);
    spec.baseline_span = span;
    const SharedScene scene = testing::shared(std::move(spec));
    auto sender = Sender::create(scene, {.triggers = {}, .deformable = {}, .policy = {.key_interval = 0}}).value();
    auto receiver = Receiver::create(scene).value();
    std::vector<testing::Motion> motions{testing::Motion(1), testing::Motion(2), testing::Motion(3)};
    std::vector<RigidSample> samples(3);
    std::size_t forgotten = 0, keys = 0, decoded = 0;
    for (std::int64_t tick = 0; tick < 3000; ++tick) {
      for (std::size_t i = 0; i < 3; ++i) samples[i] = motions[i].step(1e-3);
      const Packet packet = testing::only(sender.encode(tick, {samples}));
      if (packet.bytes.empty()) continue;
      keys += packet.key ? 1u : 0u;
      if (tick > 0 && tick % 3 == 0) {
        sender.forget_last(0);
        sender.forget_last(0);  // once is enough
        sender.forget_last(7);  // there is none such
        ++forgotten;
      } else {
        ASSERT_TRUE(receiver.push(packet.bytes)) << tick;
        ++decoded;
        for (std::uint32_t i = 0; i < 3; ++i) {
          const Pose shown = to_pose(receiver.replica().pose(i, tick), scene->grid.position);
          ASSERT_LE(norm(shown.position - samples[i].pose.position), RigidTriggers{}.visual_position);
        }
      }
      ASSERT_EQ(receiver.state_hash(0), sender.state_hash(0)) << tick;
    }
    EXPECT_GT(forgotten, 20u);
    EXPECT_GT(decoded, 2 * forgotten);
    if (span > 1) {
      EXPECT_EQ(keys, 1u) << "the baseline before the forgotten packet is held";
    } else {
      EXPECT_GE(keys, forgotten);
    }
  }
}

/// A forgotten key packet is due again, also where it was asked for meanwhile.
TEST(Sender, AForgottenKeyPacketComesAgain) {
  const SharedScene scene = testing::scene_of(1);
  auto sender = Sender::create(scene, {.triggers = {.heartbeat = 0}, .deformable = {}, .policy = {.key_interval = 0}}).value();
  auto receiver = Receiver::create(scene).value();
  RigidSample sample;
  sample.pose.position.x = 1;
  std::int64_t tick = 0;
  const auto next = [&] { return testing::only(sender.encode(tick++, {{&sample, 1}})); };
  ASSERT_TRUE(next().key);
  sender.forget_last(0);
  Packet packet = next();
  ASSERT_TRUE(packet.key);
  ASSERT_TRUE(receiver.push(packet.bytes));
  sender.request_key();
  ASSERT_TRUE(next().key);
  sender.forget_last(0);
  ASSERT_TRUE(next().key) << "still asked for";
  sample.pose.position.x = 2;
  ASSERT_FALSE(next().key);
  sender.request_key();
  sender.forget_last(0);
  packet = next();
  ASSERT_TRUE(packet.key);
  ASSERT_TRUE(receiver.push(packet.bytes));
  EXPECT_EQ(receiver.state_hash(0), sender.state_hash(0));
  EXPECT_TRUE(next().bytes.empty());
}

/// Beside a sender that is not told: of other substreams, of packets that never were, of old ones, of the same one again.
TEST(Sender, UnknownAndOldAcknowledgementsChangeNothing) {
  for (const Baseline baseline : {Baseline::previous, Baseline::acknowledged}) {
    const SharedScene scene = testing::scene_of_every_kind(kSquares, 8);
    const SenderOptions options{
        .triggers = {}, .deformable = {}, .policy = {.key_interval = 0, .first_sequence = 65500, .baseline = baseline}};
    auto told = Sender::create(scene, options).value(), spared = Sender::create(scene, options).value();
    World world;
    std::array<std::vector<std::uint16_t>, kSubstreams> sent;
    std::size_t others = 0;
    for (std::int64_t tick = 0; tick < 200; ++tick) {
      Frame frame = world.step();
      const auto packets = all(told.encode(tick, frame.truth()));
      ASSERT_EQ(bytes_of(packets), bytes_of(all(spared.encode(tick, frame.truth())))) << tick;
      for (const Packet& packet : packets) sent.at(packet.substream).push_back(packet.sequence);
      told.acknowledge(kSubstreams, 65500);
      told.acknowledge(1000, 1);
      for (std::size_t i = 0; i < kSubstreams; ++i) {
        if (sent[i].empty()) {
          told.acknowledge(i, 65500);
          continue;
        }
        const std::uint16_t newest = sent[i].back();
        for (const unsigned ahead : {1u, 2u, 300u, 32768u, 60000u})
          told.acknowledge(i, static_cast<std::uint16_t>(newest + ahead));
        if (sent[i].size() > 12) told.acknowledge(i, sent[i][sent[i].size() - 10]);
        if (baseline == Baseline::previous) {
          told.acknowledge(i, newest);
        } else if (tick % 3 == 0 && sent[i].size() > 2) {  // both are told of this one, and then of nothing older
          const std::uint16_t known = sent[i][sent[i].size() - 2];
          told.acknowledge(i, known);
          spared.acknowledge(i, known);
          for (std::size_t back = 2; back < std::min<std::size_t>(sent[i].size(), 20); ++back)
            told.acknowledge(i, sent[i][sent[i].size() - back]);
          ++others;
        }
      }
    }
    EXPECT_EQ(others > 50, baseline == Baseline::acknowledged);
  }
}

}  // namespace
}  // namespace tactus
