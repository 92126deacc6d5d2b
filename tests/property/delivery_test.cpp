// SPDX-License-Identifier: Apache-2.0
/// Packets with gaps between their numbers, lost, repeated and out of order: what is accepted gives the sender's state at that packet,
/// what is not changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <vector>

#include <tactus/receiver.h>
#include <tactus/rigid/rigid_syntax.h>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Sent {
  Bytes bytes;
  std::uint64_t number = 0;
  std::uint32_t baseline = 0;  // packets back; 0: key
  std::int64_t tick = 0;
  std::uint64_t hash = 0;  // of a receiver that lost nothing
};

/// Random numbers that are the same with every standard library: only the engine is, distributions are not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// 0 .. limit - 1
  std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(engine_() % limit); }
  /// Any sign, widths 0 .. max_width equally likely.
  std::int32_t integer(unsigned max_width) {
    const unsigned width = below(max_width + 1);
    const auto bits = static_cast<std::int32_t>(engine_() >> 33) & static_cast<std::int32_t>((std::uint32_t{1} << width) - 1);
    return below(2) == 0 ? bits : -bits;
  }

 private:
  std::mt19937_64 engine_;
};

SharedScene scene(std::uint8_t span) {
  SceneSpec spec;
  spec.baseline_span = span;
  spec.objects = {{"a", Dof::all, {}}, {"wall", Dof::none, {}}, {"b", Dof::translation, {}}, {"c", Dof::rz, {}}};
  return Scene::create(std::move(spec)).value();
}

/// One that keeps every rule: residuals of any size that the object's axes allow, rotations up to half a circle.
CodedUpdate random_update(Random& random, const Scene& scene, std::uint32_t object) {
  const auto level = static_cast<std::uint8_t>(random.below(4) == 0 ? random.below(16) : random.below(6));
  CodedUpdate out{.reason = static_cast<Reason>(random.below(4)), .level = level, .residual = {}};
  // Three rotation components of this width stay below length 1.
  const unsigned turn_width = scene.grid.rotation > level + 1U ? scene.grid.rotation - level - 1U : 0;
  const std::array<unsigned, kQuantities> widths{12, 10, std::min(turn_width, 16U), 8};
  for (std::size_t quantity = 0; quantity < kQuantities; ++quantity) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t bit = quantity < 2 ? axis : axis + 3;
      if (scene.objects[object].dof >> bit & 1U) out.residual.of[quantity][axis] = random.integer(widths[quantity]);
    }
  }
  return out;
}

/// A packet with half of the moving objects. No encoder is asked what it would do.
Bytes packet(Random& random, const Scene& scene, const PacketHead& head) {
  std::vector<std::size_t> updated;
  for (std::size_t i = 0; i < scene.moving().size(); ++i)
    if (random.below(2) == 0) updated.push_back(i);
  if (updated.empty()) updated.push_back(0);
  Bytes payload(std::size_t{1} << 16);
  RangeEncoder coder(payload);
  RigidModels models = start_models();
  RigidHead rigid{head, static_cast<std::uint32_t>(updated.size())};
  code_head(coder, models, scene, rigid);
  std::size_t next = 0;
  for (const std::size_t i : updated) {
    coder.magnitude(models.gap, static_cast<std::uint32_t>(i - next));
    CodedUpdate update = random_update(random, scene, scene.moving()[i]);
    code_update(coder, models, scene, scene.moving()[i], update);
    next = i + 1;
  }
  payload.resize(coder.finish());
  return payload;
}

std::vector<Sent> send(const SharedScene& scene, std::uint64_t seed) {
  Random random(seed);
  auto receiver = Receiver::create(scene).value();
  std::vector<Sent> out;
  std::int64_t tick = 0;
  std::uint64_t number = 1;
  for (std::uint32_t i = 0; i < 10000; ++i) {
    const bool key = i % 20 == 0;
    const std::uint32_t baseline = key ? 0 : 1 + random.below(std::min<std::uint32_t>(i, scene->baseline_span));
    const Sent* from = key ? nullptr : &out[i - baseline];
    const auto back = static_cast<std::uint32_t>(key ? 1 : number - from->number);
    Bytes bytes = packet(random, *scene, {key, back, static_cast<std::uint32_t>(tick - (key ? 0 : from->tick))});
    EXPECT_TRUE(receiver.push(number, bytes));
    out.push_back({std::move(bytes), number, baseline, tick, receiver.state_hash(0)});
    tick += random.below(20);
    number += scene->baseline_span > 1 ? 1 + random.below(60) : 1;  // 64 packets back are fewer than 4095 numbers
  }
  return out;
}

/// A third of the packets lost, some repeated, some late.
std::vector<std::size_t> arrivals(std::size_t packets, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < packets; ++i) {
    if (random.below(3) == 0) continue;
    out.push_back(i);
    if (random.below(10) == 0) out.push_back(i - random.below(static_cast<std::uint32_t>(std::min<std::size_t>(i, 3)) + 1));
    if (random.below(5) == 0 && out.size() > 1) std::swap(out.back(), out[out.size() - 2]);
  }
  return out;
}

class Delivery : public ::testing::TestWithParam<int> {};

TEST_P(Delivery, AcceptedPacketsGiveTheSendersState) {
  const SharedScene declared = scene(static_cast<std::uint8_t>(GetParam()));
  const std::vector<Sent> sent = send(declared, 601);
  auto receiver = Receiver::create(declared).value();
  std::set<std::size_t> held;  // packets whose states a receiver holds
  int accepted = 0, reordered = 0, stale = 0, without_baseline = 0;
  for (const std::size_t i : arrivals(sent.size(), 602)) {
    const std::uint64_t before = receiver.state_hash(0);
    const auto decoded = receiver.push(sent[i].number, sent[i].bytes);
    const bool late = !held.empty() && i < *held.rbegin();
    if (held.contains(i) || (late && i < *held.begin())) {
      ++stale;
      ASSERT_FALSE(decoded);
      EXPECT_STREQ(decoded.error().rule, "R-PKT-5");
    } else if (sent[i].baseline > 0 && !held.contains(i - sent[i].baseline)) {
      ++without_baseline;
      ASSERT_FALSE(decoded);
      EXPECT_STREQ(decoded.error().rule, "R-PKT-4");
    } else {
      ++accepted;
      reordered += late ? 1 : 0;
      ASSERT_TRUE(decoded) << decoded.error().rule;
      EXPECT_EQ(decoded->tick, sent[i].tick);
      held.insert(i);
      if (held.size() > declared->baseline_span) held.erase(held.begin());
      EXPECT_EQ(receiver.state_hash(0), sent[*held.rbegin()].hash) << "of the newest, whatever came last";
      continue;
    }
    EXPECT_EQ(receiver.state_hash(0), before);
  }
  EXPECT_EQ(reordered > 0, declared->baseline_span > 1) << reordered;
  EXPECT_GT(accepted, 100);
  EXPECT_GT(stale, 10);
  EXPECT_GT(without_baseline, 10);
}

INSTANTIATE_TEST_SUITE_P(Spans, Delivery, ::testing::Values(1, 2, 5, 16, 64));

/// A packet may build on one 4095 numbers before it, however many states are kept; with one state, on the number before it alone.
TEST(DeliveryRules, ABaselineIsAtMost4095NumbersBack) {
  Random random(603);
  for (const std::uint8_t span : {std::uint8_t{2}, std::uint8_t{64}}) {
    const SharedScene declared = scene(span);
    auto receiver = Receiver::create(declared).value();
    ASSERT_TRUE(receiver.push(1, packet(random, *declared, {true, 1, 10})));
    const std::uint64_t hash = receiver.state_hash(0);
    const auto rule = [&](std::uint64_t number, std::uint32_t back) {
      const auto decoded = receiver.push(number, packet(random, *declared, {false, back, 1}));
      return decoded ? "" : decoded.error().rule;
    };
    EXPECT_STREQ(rule(4097, 4096), "R-PKT-3");
    EXPECT_STREQ(rule(2, 0), "R-PKT-3");
    EXPECT_STREQ(rule(4095, 4095), "R-PKT-4") << "number 0 is none";
    EXPECT_STREQ(rule(10, 4095), "R-PKT-4") << "before all numbers";
    EXPECT_STREQ(rule(4097, 4095), "R-PKT-4");
    EXPECT_EQ(receiver.state_hash(0), hash);
    EXPECT_STREQ(rule(4096, 4095), "");
  }
  const SharedScene declared = scene(1);
  auto receiver = Receiver::create(declared).value();
  ASSERT_TRUE(receiver.push(1, packet(random, *declared, {true, 1, 10})));
  EXPECT_STREQ(receiver.push(3, packet(random, *declared, {false, 1, 1})).error().rule, "R-PKT-4");
  EXPECT_TRUE(receiver.push(2, packet(random, *declared, {false, 1, 1})));
}

/// Ticks rise with the numbers, those of key packets too.
TEST(DeliveryRules, TicksDoNotFallAsNumbersRise) {
  Random random(604);
  const SharedScene declared = scene(16);
  auto receiver = Receiver::create(declared).value();
  const auto rule = [&](std::uint64_t number, std::uint32_t tick) {
    const std::uint64_t hash = receiver.state_hash(0);
    const auto decoded = receiver.push(number, packet(random, *declared, {true, 1, tick}));
    if (decoded) return "";
    EXPECT_EQ(decoded.error().code, Errc::invalid);
    EXPECT_EQ(receiver.state_hash(0), hash);
    return decoded.error().rule;
  };
  EXPECT_STREQ(rule(10, 100), "");
  EXPECT_STREQ(rule(100, 99), "R-RIG-1");
  EXPECT_STREQ(rule(std::uint64_t{1} << 61, 0), "R-RIG-1") << "however far ahead";
  EXPECT_STREQ(rule(100, 100), "") << "it may be the same";
  EXPECT_STREQ(rule(50, 101), "R-RIG-1") << "before the newest its tick is that of the newest at most";
  EXPECT_STREQ(rule(50, 90), "");
  EXPECT_STREQ(rule(51, 100), "");
  EXPECT_STREQ(rule(52, 3), "") << "among reordered packets the newest alone counts";
  EXPECT_EQ(receiver.tick(0), 100);
}

}  // namespace
}  // namespace tactus
