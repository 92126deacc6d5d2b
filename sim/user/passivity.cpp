// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/sim/user/passivity.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace tactus::sim {

// ==== passivity ====

void PassivityObserver::arrive(const Vec3& position) noexcept {
  step_ = arrived_ ? position - position_ : Vec3{};
  energy_ -= dot(force_, step_);
  position_ = position;
  arrived_ = true;
  lowest_ = std::min(lowest_, energy_);
  violations_ += energy_ < -tolerance_ ? 1 : 0;
}

Vec3 PassivityController::limit(const Vec3& position, const Vec3& force) noexcept {
  port_.arrive(position);
  port_.cap(options_.max_stored);
  free_for_ = force == Vec3{} ? free_for_ + options_.tick : 0;
  if (free_for_ >= options_.reset_after) port_.reset();

  const Vec3& step = port_.step();
  const double missing = dot(force, step) - port_.energy(), step2 = dot(step, step);
  damping_ = missing > 0 && step2 > 0 ? std::min(missing * options_.tick / step2, options_.max_damping) : 0;
  const Vec3 shown = force - (damping_ / options_.tick) * step;
  port_.hold(shown);
  return shown;
}

// ==== sampled limit ====

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// The loop at z = e^jw: the hand without the spring, and the factor of k.
struct Response {
  std::complex<double> hand, filter;
};

Response at(double w, const HandImpedance& hand, double samples) {
  const std::complex<double> step = 1.0 - std::polar(1.0, -w);
  return {hand.mass * 2 * (cosine(w) - 1) / (kTick * kTick) + hand.stiffness + hand.damping * step / kTick,
          (1.0 - std::polar(1.0, -w * samples)) / (samples * step)};
}

/// The k that makes the imaginary part zero, and the real part that remains.
struct Crossing {
  double stiffness, rest;
};

Crossing crossing(double w, const HandImpedance& hand, double samples) {
  const Response r = at(w, hand, samples);
  const double k = -r.hand.imag() / r.filter.imag();
  return {k, r.hand.real() + k * r.filter.real()};
}

}  // namespace

double sampled_limit(const HandImpedance& hand, const SceneDevice& device) noexcept {
  const double n = device.filter;
  // z = -1, where no delay turns the phase
  const Response fastest = at(std::numbers::pi, hand, n);
  double limit = device.filter % 2 == 1 ? -fastest.hand.real() / fastest.filter.real() : kNone;
  const int steps = 500 + 32 * static_cast<int>(device.filter);  // the mean's response has a zero at every 2 pi / N
  Crossing last{kNone, kNone};
  double from = 0;
  for (int i = 1; i < steps && device.filter > 1; ++i) {
    const double w = std::numbers::pi * i / steps;
    const Crossing now = crossing(w, hand, n);
    if (last.stiffness > 0 && now.stiffness > 0 && last.rest > 0 && now.rest <= 0) {
      double low = from, high = w;
      for (int k = 0; k < 50; ++k) (crossing((low + high) / 2, hand, n).rest > 0 ? low : high) = (low + high) / 2;
      limit = std::min(limit, crossing(low, hand, n).stiffness);
    }
    last = now;
    from = w;
  }
  return std::max(0.0, limit);
}

// ==== swings ====

namespace {

constexpr double kTurn = 1e-4;                                      // [m] back from the farthest point: it was a turning point
constexpr std::int64_t kSwingWithin = std::int64_t{2} * kTickRate;  // [ticks]

}  // namespace

void SwingMeter::add(const Vec3& position, bool holds) noexcept {
  if (!holds || !holds_) axes_ = {};
  holds_ = holds;
  ++tick_;
  if (!holds) return;
  add(axes_[0], position.x);
  add(axes_[1], position.y);
  add(axes_[2], position.z);
}

void SwingMeter::add(Axis& axis, double x) noexcept {
  if (axis.direction == 0) {
    if (axis.turned_at == 0) axis.peak = axis.turned = x, axis.turned_at = tick_;
    if (std::abs(x - axis.turned) < kTurn) return;
    axis.direction = x > axis.turned ? 1 : -1;
    axis.peak = x;
  }
  const double beyond = axis.direction * (x - axis.peak);
  if (beyond >= 0) axis.peak = x;
  if (beyond > -kTurn) return;
  const std::size_t at = axis.swings % kInARow;
  axis.sizes[at] = std::abs(axis.peak - axis.turned);
  axis.begins[at] = axis.turned_at;
  axis.turned = axis.peak;
  axis.turned_at = tick_;
  axis.peak = x;
  axis.direction = -axis.direction;
  if (++axis.swings < kInARow || tick_ - *std::min_element(axis.begins.begin(), axis.begins.end()) > kSwingWithin) return;
  largest_ = std::max(largest_, *std::min_element(axis.sizes.begin(), axis.sizes.end()));
}

// ==== touch record ====

namespace {

constexpr std::uint32_t kLetGo = kTickRate / 2;  // [ticks] without a contact: it holds nothing

}  // namespace

void TouchRecord::add(const UserSample& sample, Aim aim) noexcept {
  const bool touches = sample.contact.kind != ContactKind::none || sample.surface_contact;
  const bool begins = touches && !touching_;
  touching_ = touches;
  port_.arrive(sample.device.position);
  if (begins) port_.reset();
  port_.hold(sample.force);
  summary_.lowest_energy = port_.lowest();
  summary_.largest_force = std::max(summary_.largest_force, norm(sample.force));
  summary_.largest_server_force = std::max(summary_.largest_server_force, norm(sample.server_force));
  free_for_ = touches ? 0 : free_for_ + 1;
  swings_.add(sample.device.position, aim == Aim::rests && summary_.contacts > 0 && free_for_ < kLetGo);
  summary_.swing = swings_.largest();
  summary_.ticks += touches ? 1 : 0;
  summary_.contacts += begins ? 1 : 0;
  in_a_second_ += (begins ? 1U : 0U) - (began_[tick_] ? 1U : 0U);
  began_[tick_] = begins;
  tick_ = (tick_ + 1) % began_.size();
  summary_.most_in_a_second = std::max(summary_.most_in_a_second, in_a_second_);

  if (sample.contact.kind != ContactKind::none) summary_.stiffest = std::max(summary_.stiffest, sample.contact.stiffness);
  if (!sample.surface_contact) return;
  summary_.stiffest = std::max(summary_.stiffest, sample.surface_contact->stiffness);
  const double pressed = norm(sample.server_force);
  if (summary_.hardest && pressed <= hardest_) return;
  hardest_ = pressed;
  summary_.hardest = sample.surface_contact;
}

}  // namespace tactus::sim
