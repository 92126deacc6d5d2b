// SPDX-License-Identifier: Apache-2.0
/// Random walks with every trigger setting: no bound is broken on what a receiver shows, and the same input gives the same bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

constexpr double kTick = 1e-3;
constexpr std::size_t kObjects = 3;
constexpr double kIntervals[] = {0, 0.5};

struct Outcome {
  std::vector<std::uint8_t> bytes;  // of all packets
  int packets = 0, visual_violations = 0, haptic_violations = 0, differing_states = 0;
};

/// Error of a shown pose over the fixed thresholds that hold while an object is touched.
bool breaks_fixed(const RigidTriggers& t, const Pose& truth, const Pose& shown) {
  return norm(shown.position - truth.position) > t.fixed_position ||
         angle_between(shown.rotation, truth.rotation) > t.fixed_rotation;
}

Outcome walk(const SenderOptions& options, std::uint64_t seed) {
  const SharedScene scene = testing::scene_of(kObjects);
  const RigidTriggers& triggers = options.triggers;
  auto sender = Sender::create(scene, options).value();
  auto receiver = Receiver::create(scene).value();
  std::vector<testing::Motion> motions;
  for (std::size_t i = 0; i < kObjects; ++i) motions.emplace_back(seed + i);
  std::vector<RigidSample> samples(kObjects);
  Outcome out;
  for (std::int64_t tick = 0; tick < 1500; ++tick) {
    for (std::size_t i = 0; i < kObjects; ++i) samples[i] = motions[i].step(kTick);
    std::vector<Contact> contacts;
    if (tick % 500 < 350) contacts = {testing::touch(0, samples[0].pose, 0.002), testing::touch(1, samples[1].pose, 0.004)};
    const auto packets = sender.encode(tick, {.objects = samples, .contacts = contacts});
    if (!packets) {
      ADD_FAILURE() << "tick " << tick << ": " << packets.error().rule;
      return out;
    }
    for (const Packet& packet : *packets) {
      out.bytes.insert(out.bytes.end(), packet.bytes.begin(), packet.bytes.end());
      ++out.packets;
      const std::vector<std::uint8_t> exact(packet.bytes.begin(), packet.bytes.end());
      if (!receiver.push(packet.number, exact) || receiver.state_hash(0) != sender.state_hash(0)) ++out.differing_states;
    }
    for (std::uint32_t i = 0; i < kObjects; ++i) {
      const Pose& truth = samples[i].pose;
      const Pose shown = to_pose(receiver.replica().pose(i, tick), scene->grid.position);
      if (norm(shown.position - truth.position) > triggers.visual_position ||
          angle_between(shown.rotation, truth.rotation) > triggers.visual_rotation) {
        ++out.visual_violations;
      }
      for (const Contact& c : contacts) {
        if (c.object != i) continue;
        const bool broken = triggers.haptic == HapticRule::fixed
                                ? breaks_fixed(triggers, truth, shown)
                                : haptic_ratio(triggers, contact_force(c, truth), contact_force(c, shown)) > 1;
        if (broken) ++out.haptic_violations;
      }
    }
  }
  return out;
}

class Walk : public ::testing::TestWithParam<std::tuple<Reduction, HapticRule, double>> {};

TEST_P(Walk, KeepsEveryBoundOnReceiverOutput) {
  SenderOptions options;
  std::tie(options.triggers.reduction, options.triggers.haptic, options.triggers.weber_fraction) = GetParam();
  options.triggers.perceptual_fraction = std::min(1.0, options.triggers.weber_fraction / 0.1);
  for (const double heartbeat : kIntervals) {
    for (const double key_interval : kIntervals) {
      options.triggers.heartbeat = heartbeat;
      options.policy.key_interval = key_interval;
      const Outcome first = walk(options, 701), second = walk(options, 701);
      EXPECT_GT(first.packets, 5);
      EXPECT_EQ(first.differing_states, 0);
      EXPECT_EQ(first.visual_violations, 0);
      EXPECT_EQ(first.haptic_violations, 0);
      EXPECT_EQ(first.bytes, second.bytes);
    }
  }
}

std::string name_of(const ::testing::TestParamInfo<Walk::ParamType>& setting) {
  static constexpr const char* kReductions[] = {"Every", "Triggered"};
  static constexpr const char* kRules[] = {"Off", "Isotropic", "Cone", "Fixed", "Perceptual"};
  const auto& [reduction, haptic, p] = setting.param;
  return std::string(kReductions[static_cast<int>(reduction)]) + kRules[static_cast<int>(haptic)] +
         std::to_string(static_cast<int>(100 * p));
}

INSTANTIATE_TEST_SUITE_P(Settings, Walk,
                         ::testing::Combine(::testing::Values(Reduction::none, Reduction::dead_reckoning),
                                            ::testing::Values(HapticRule::off, HapticRule::isotropic, HapticRule::cone,
                                                              HapticRule::fixed, HapticRule::perceptual),
                                            ::testing::Values(0.02, 0.08, 0.30)),
                         name_of);

}  // namespace
}  // namespace tactus
