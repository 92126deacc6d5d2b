// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/transparency/pressing.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tactus/base/rule.h>

namespace tactus::sim {
namespace {

constexpr double kTick = 1e-3;     // [s]
constexpr double kOutside = -0.1;  // [m] between presses a hand is away

/// A signal some ticks ago; before the first sample it is the first one.
class Delayed {
 public:
  explicit Delayed(std::uint32_t ticks) : ring_(ticks + std::size_t{1}) {}
  double pass(double sample) noexcept {
    if (count_++ == 0) std::ranges::fill(ring_, sample);
    ring_[next_] = sample;
    next_ = (next_ + 1) % ring_.size();
    return ring_[next_];
  }

 private:
  std::vector<double> ring_;
  std::size_t next_ = 0, count_ = 0;
};

struct Hand {
  Hand(const PressingUser& user, std::optional<StiffnessReduction> made)
      : round_trip(user.to_server + user.from_server),
        forward(user.to_server),
        backward(user.from_server),
        reduction(std::move(made)) {}

  /// [N/m]   in  device, surface [m] as the client knows them
  double stiffness(double device, double surface, const Pressing& pressing) noexcept {
    if (!reduction) return pressing.stiffness;
    reduction->move({0, 0, -device});
    const double stretch = device - surface;
    if (stretch > 0)
      return reduction->reduced(
          StiffnessReduction::DeformableTouch{{0, 0, -stretch}, {0, 0, 1}, pressing.stiffness, pressing.object.stiffness},
          round_trip);
    reduction->release();
    return pressing.stiffness;
  }

  std::uint32_t round_trip;
  Delayed forward, backward;
  std::optional<StiffnessReduction> reduction;
};

MsdLoop loop_of(const Pressing& pressing) {
  MsdLoopOptions options{.object = pressing.object, .tick = kTick, .coupling = Coupling::pressing, .users = {}};
  for (std::size_t i = 0; i < pressing.users.size(); ++i)
    options.users.push_back({pressing.stiffness, pressing.stiffness, pressing.client_damping});
  return MsdLoop(options);
}

Result<std::vector<Hand>> hands_of(const Pressing& pressing) {
  std::vector<Hand> out;
  for (const PressingUser& user : pressing.users) {
    if (user.to_server > StiffnessReduction::kMostDelay || user.from_server > StiffnessReduction::kMostDelay - user.to_server)
      return fail(Errc::invalid_argument, "R-API-4");
    std::optional<StiffnessReduction> reduction;
    if (pressing.compensation) {
      TACTUS_TRY(reduction, StiffnessReduction::create({.most_delay = std::max(user.to_server + user.from_server, 1U),
                                                        .filter = *pressing.compensation}));
    }
    out.emplace_back(user, std::move(reduction));
  }
  return out;
}

}  // namespace

double depth_of(const std::vector<Press>& presses, double time, double frequency) noexcept {
  const double quarter = 0.25 / frequency;
  const auto sine = [&](double since) { return std::sin(2 * std::numbers::pi * frequency * since); };
  for (const Press& press : presses) {
    if (time >= press.begin && time < press.hold) return press.depth * sine(std::min(time - press.begin, quarter));
    if (time >= press.hold && time < press.end) return press.depth;
    if (time >= press.end && time < press.end + quarter) return press.depth * sine(press.end + quarter - time);
  }
  return kOutside;
}

Result<std::vector<Felt>> press(const Pressing& pressing) {
  TACTUS_TRY(std::vector<Hand> hands, hands_of(pressing));
  MsdLoop loop = loop_of(pressing);
  std::vector<Felt> out(hands.size());
  const auto ticks = static_cast<std::int64_t>(std::llround(pressing.duration / kTick));
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    loop.begin_tick();
    for (std::size_t i = 0; i < hands.size(); ++i) {
      const double device = depth_of(pressing.users[i].presses, static_cast<double>(tick) * kTick, pressing.frequency);
      const double server = -loop.press(i, hands[i].forward.pass(device));
      const double surface = hands[i].backward.pass(loop.surface());
      loop.load(server);
      out[i].server.push_back(server);
      out[i].client.push_back(-loop.feel(i, device, surface, hands[i].stiffness(device, surface, pressing)));
    }
    loop.end_tick();
  }
  return out;
}

}  // namespace tactus::sim
