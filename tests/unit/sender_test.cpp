// SPDX-License-Identifier: Apache-2.0
/// A scene of several substreams at its sender: what a tick brings, what an error leaves, and what packets build on.
#include <tactus/sender.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

TEST(Sender, SubstreamsComeInOrderAndWhatIsRenderedFirst) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  auto sender = Sender::create(scene).value();
  World world;
  std::array<std::uint64_t, kSubstreams> next;
  next.fill(1);
  std::array<std::size_t, kSubstreams> count{};
  for (std::int64_t tick = 0; tick < 300; ++tick) {
    Frame frame = world.step();
    const auto packets = all(sender.encode(tick, frame.truth()));
    EXPECT_TRUE(std::ranges::is_sorted(packets, {}, &Packet::substream));
    for (std::size_t i = 0; i < packets.size(); ++i) {
      const Packet& packet = packets[i];
      EXPECT_EQ(packet.bytes[0], packet.substream);
      EXPECT_EQ(packet.number, next.at(packet.substream)++);
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
TEST(Sender, ScaledBoundsHoldAndNeedLess) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  const SenderOptions options;
  std::array<std::size_t, 4> bytes{}, steps{1, 4, 8, 1};
  auto sender = Sender::create(scene, options).value();
  auto receiver = Receiver::create(scene).value();
  World world(3);
  double worst = 0;  // error of a position over its given bound
  for (std::int64_t tick = 0; tick < 2000; ++tick) {
    const auto phase = static_cast<std::size_t>(tick / 500);
    if (tick % 500 == 0) sender.set_bound_scale(static_cast<double>(steps[phase]));
    Frame frame = world.step();
    const Truth truth = frame.truth();
    for (const Packet& packet : all(sender.encode(tick, truth))) {
      bytes[phase] += packet.bytes.size();
      ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
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

TEST(Sender, ABoundScaleIsAtLeastOne) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  const auto hashes_with = [&](double factor) {
    auto sender = Sender::create(scene).value();
    sender.set_bound_scale(factor);
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
  const SharedScene still = SceneBuilder().rigid("wall", {}, {.dof = Dof::none}).build().value();
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

/// A jump that no update can name in one: the next tick sends the rest.
TEST(Sender, AJumpAcrossTheWholeGridTakesTwoUpdates) {
  SceneSpec spec = testing::spec_of(1);
  spec.objects[0].initial.position = {-2100000000, 0, 0};
  const SharedScene scene = testing::shared(std::move(spec));
  auto sender = Sender::create(scene, {.triggers = {.visual_position = 2e-6}}).value();
  auto receiver = Receiver::create(scene).value();
  RigidSample body;
  for (std::int64_t tick = 0; tick < 6; ++tick) {
    body.pose.position.x = tick < 2 ? -500.6 + 1e-4 * static_cast<double>(tick) : 500;
    for (const Packet& packet : all(sender.encode(tick, {.objects = {&body, 1}})))
      ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
    const double error = norm(to_pose(receiver.replica().pose(0, tick), scene->grid.position).position - body.pose.position);
    if (tick == 2) {
      EXPECT_NEAR(error, 488.6, 1) << "half of the distance";
    } else {
      EXPECT_LE(error, 2e-6) << tick;
    }
    EXPECT_TRUE(sender.held().empty());
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
    std::uint64_t number = 0;  // of the newest that arrived
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
        ASSERT_TRUE(receiver.push(packet.number, packet.bytes)) << tick;
        number = packet.number;
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
    EXPECT_EQ(keys, 1u) << "the state before the forgotten packet is a baseline";
    EXPECT_EQ(number, decoded) << "a forgotten packet's number is that of the next one";
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
  ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
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
  ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
  EXPECT_EQ(receiver.state_hash(0), sender.state_hash(0));
  EXPECT_TRUE(next().bytes.empty());
}

/// Beside a sender that is not informed: of other substreams, of packets that never were, of old ones, of the same one again.
TEST(Sender, UnknownAndOldAcknowledgementsChangeNothing) {
  for (const Baseline baseline : {Baseline::previous, Baseline::acknowledged}) {
    const SharedScene scene = testing::scene_of_every_kind(kSquares, 8);
    const SenderOptions options{.triggers = {}, .deformable = {}, .policy = {.key_interval = 0, .baseline = baseline}};
    auto informed = Sender::create(scene, options).value(), spared = Sender::create(scene, options).value();
    World world;
    std::array<std::vector<std::uint64_t>, kSubstreams> sent;
    std::size_t others = 0;
    for (std::int64_t tick = 0; tick < 200; ++tick) {
      Frame frame = world.step();
      const auto packets = all(informed.encode(tick, frame.truth()));
      ASSERT_EQ(bytes_of(packets), bytes_of(all(spared.encode(tick, frame.truth())))) << tick;
      for (const Packet& packet : packets) sent.at(packet.substream).push_back(packet.number);
      informed.acknowledge(kSubstreams, 1);
      informed.acknowledge(1000, 1);
      for (std::size_t i = 0; i < kSubstreams; ++i) {
        if (sent[i].empty()) {
          informed.acknowledge(i, 1);
          continue;
        }
        const std::uint64_t newest = sent[i].back();
        informed.acknowledge(i, 0);
        for (const std::uint64_t ahead : {1u, 2u, 300u, 32768u, 65536u}) informed.acknowledge(i, newest + ahead);
        for (const std::uint64_t ahead : {std::uint64_t{1} << 61, ~std::uint64_t{0} - newest})
          informed.acknowledge(i, newest + ahead);
        if (sent[i].size() > 12) informed.acknowledge(i, sent[i][sent[i].size() - 10]);
        if (baseline == Baseline::previous) {
          informed.acknowledge(i, newest);
        } else if (tick % 3 == 0 && sent[i].size() > 2) {  // both are informed of this one, and then of nothing older
          const std::uint64_t known = sent[i][sent[i].size() - 2];
          informed.acknowledge(i, known);
          spared.acknowledge(i, known);
          for (std::size_t back = 2; back < std::min<std::size_t>(sent[i].size(), 20); ++back)
            informed.acknowledge(i, sent[i][sent[i].size() - back]);
          ++others;
        }
      }
    }
    EXPECT_EQ(others > 50, baseline == Baseline::acknowledged);
  }
}

}  // namespace
}  // namespace tactus
