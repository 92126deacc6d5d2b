// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/sim/transparency/transparency.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <tactus/base/rule.h>

namespace tactus::sim {

// ==== pressing ====

namespace {

constexpr double kPressingTick = 1e-3;  // [s]
constexpr double kOutside = -0.1;       // [m] between presses a hand is away

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
  MsdLoopOptions options{.object = pressing.object, .tick = kPressingTick, .coupling = Coupling::pressing, .users = {}};
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
  const auto wave = [&](double since) { return sine(2 * std::numbers::pi * frequency * since); };
  for (const Press& press : presses) {
    if (time >= press.begin && time < press.hold) return press.depth * wave(std::min(time - press.begin, quarter));
    if (time >= press.hold && time < press.end) return press.depth;
    if (time >= press.end && time < press.end + quarter) return press.depth * wave(press.end + quarter - time);
  }
  return kOutside;
}

Result<std::vector<PressForces>> press(const Pressing& pressing) {
  TACTUS_TRY(std::vector<Hand> hands, hands_of(pressing));
  MsdLoop loop = loop_of(pressing);
  std::vector<PressForces> out(hands.size());
  const auto ticks = static_cast<std::int64_t>(std::llround(pressing.duration / kPressingTick));
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    loop.begin_tick();
    for (std::size_t i = 0; i < hands.size(); ++i) {
      const double device = depth_of(pressing.users[i].presses, static_cast<double>(tick) * kPressingTick, pressing.frequency);
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

// ==== rigid transparency ====

namespace {

using Complex = std::complex<double>;

/// G_s G_o / (1 + G_s G_o), the object's position by the probe's at the server.
Complex follows(const RigidCoupling& c, Complex s) noexcept {
  const Complex server = c.server_stiffness + c.server_damping * s;
  return server / (c.mass * s * s + c.damping * s + server);
}

/// G_o / (1 + G_s G_o), the object's position by a force on it [m/N].
Complex yields(const RigidCoupling& c, Complex s) noexcept {
  return 1.0 / (c.mass * s * s + (c.damping + c.server_damping) * s + c.server_stiffness);
}

Complex client(const RigidCoupling& c, Complex s) noexcept { return c.client_stiffness + c.client_damping * s; }

}  // namespace

Complex delay_factor(double omega, double delay, DelayModel model) noexcept {
  if (model == DelayModel::exact) return std::polar(1.0, -omega * delay);
  const Complex half(0, 0.5 * omega * delay);
  return (1.0 - half) / (1.0 + half);
}

double pade_limit(double delay) noexcept { return delay > 0 ? 1 / (3 * delay) : std::numeric_limits<double>::infinity(); }

Complex force_by_velocity(const RigidCoupling& coupling, double omega, DelayModel model) noexcept {
  const Complex s(0, omega);
  return client(coupling, s) / s * (1.0 - delay_factor(omega, coupling.round_trip(), model) * follows(coupling, s));
}

Complex force_by_resistance(const RigidCoupling& coupling, double omega, DelayModel model) noexcept {
  const Complex s(0, omega);
  return client(coupling, s) * delay_factor(omega, coupling.backward, model) * yields(coupling, s);
}

double damping_of_factor(double mass, double factor, double step) noexcept { return mass * (1 - factor * factor) / (2 * step); }

double client_force(const SteadyPush& push, double client_stiffness, double server_stiffness, double round_trip) noexcept {
  return client_stiffness / server_stiffness * (round_trip * server_stiffness * push.velocity + push.server_force());
}

std::optional<double> tolerable_delay(const SteadyPush& push, double stiffness, double weber) noexcept {
  if (push.velocity == 0) return std::nullopt;
  return weber * std::abs(push.server_force()) / (std::abs(push.velocity) * stiffness);
}

std::optional<double> tolerable_change(const SteadyPush& push, double stiffness, double round_trip, double weber) noexcept {
  if (push.velocity == 0) return std::nullopt;
  return weber * std::abs(client_force(push, stiffness, stiffness, round_trip)) / (std::abs(push.velocity) * stiffness);
}

double reduced_stiffness(const SteadyPush& push, double stiffness, double round_trip) noexcept {
  const double delayed = std::abs(client_force(push, stiffness, stiffness, round_trip));
  return delayed > 0 ? stiffness * std::abs(push.server_force()) / delayed : stiffness;
}

double blending(const Vec3& constraint, const Vec3& face) noexcept {
  return 2 / std::numbers::pi * arc_cosine(std::min(std::abs(dot(constraint, face)), 1.0));
}

double reduced_stiffness(double resistive, double speed, double stiffness, double round_trip, double beta) noexcept {
  return stiffness * -resistive / (-resistive + beta * round_trip * stiffness * speed);
}

std::optional<double> tolerable_delay(double resistive, double speed, double stiffness, double weber) noexcept {
  if (speed == 0) return std::nullopt;
  return weber * -resistive / (speed * stiffness);
}

std::optional<double> tolerable_change(double resistive, double speed, double stiffness, double round_trip,
                                       double weber) noexcept {
  if (speed == 0) return std::nullopt;
  return weber * (round_trip * stiffness * speed - resistive) / (speed * stiffness);
}

// ==== deformable transparency ====

namespace {

using Complex = std::complex<double>;

double square(double x) noexcept { return x * x; }

Complex impedance(const DeformableCoupling& c, double omega, double round_trip, Complex follows) noexcept {
  const Complex s(0, omega);
  return (c.client_stiffness + c.client_damping * s) * (1.0 - std::polar(1.0, -omega * round_trip) * follows) / s;
}

/// |k_o + k_s - k_s e^(-j omega R)|^2, the yielding of object and delay together.
double yielding(const DeformableCoupling& c, double stiffness, double omega, double round_trip) noexcept {
  const double sum = c.object_stiffness + stiffness;
  return square(sum) - 2 * stiffness * sum * cosine(omega * round_trip) + square(stiffness);
}

}  // namespace

Complex follows(const DeformableCoupling& coupling, double omega) noexcept {
  const Complex s(0, omega);
  return coupling.server_stiffness /
         (coupling.object_mass * s * s + coupling.object_damping * s + coupling.object_stiffness + coupling.server_stiffness);
}

double follows_slowly(const DeformableCoupling& coupling) noexcept {
  return coupling.server_stiffness / (coupling.object_stiffness + coupling.server_stiffness);
}

Complex client_impedance(const DeformableCoupling& coupling, double omega, double round_trip) noexcept {
  return impedance(coupling, omega, round_trip, follows(coupling, omega));
}

Complex server_impedance(const DeformableCoupling& coupling, double omega) noexcept {
  return coupling.server_stiffness * (1.0 - follows(coupling, omega)) / Complex(0, omega);
}

Complex slow_client_impedance(const DeformableCoupling& coupling, double omega, double round_trip) noexcept {
  return impedance(coupling, omega, round_trip, follows_slowly(coupling));
}

std::optional<double> tolerable_delay(const DeformableCoupling& coupling, double omega, double weber) noexcept {
  const double ratio = follows_slowly(coupling);
  const double stiffness = square(coupling.client_stiffness), damper = square(coupling.client_damping * omega);
  const double cos_angle = ((1 + square(ratio)) * (stiffness + damper) - square((1 + weber) * (1 - ratio)) * stiffness) /
                           (2 * ratio * (stiffness + damper));
  if (!(std::abs(cos_angle) <= 1)) return std::nullopt;
  return arc_cosine(cos_angle) / omega;
}

double reduced_stiffness(const DeformableCoupling& coupling, double omega, double round_trip) noexcept {
  const double k = coupling.server_stiffness;
  const double wanted = square(coupling.object_stiffness) / yielding(coupling, k, omega, round_trip);
  return k * std::sqrt(std::max(wanted - square(coupling.client_damping * omega / k), 0.0));
}

double reduced_stiffness_undamped(const DeformableCoupling& coupling, double omega, double round_trip) noexcept {
  const double k = coupling.client_stiffness;
  return k * coupling.object_stiffness / std::sqrt(yielding(coupling, k, omega, round_trip));
}

}  // namespace tactus::sim
