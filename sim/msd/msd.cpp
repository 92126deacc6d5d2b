// SPDX-License-Identifier: Apache-2.0
#include "sim/msd/msd.h"

#include <algorithm>

namespace tactus {

MsdModel::MsdModel(const MsdObject& object, double period) noexcept
    : now_(object.mass / (period * period) + object.damping / period + object.stiffness),
      before_(-2 * object.mass / (period * period) - object.damping / period),
      older_(object.mass / (period * period)) {}

double MsdModel::step(double force) noexcept {
  const double x = (force - before_ * last_ - older_ * second_last_) / now_;
  second_last_ = last_;
  last_ = x;
  return x;
}

double MsdLoop::Delay::pass(double sample) noexcept {
  if (ring_.empty()) return sample;
  const double out = ring_[next_];
  ring_[next_] = sample;
  next_ = (next_ + 1) % ring_.size();
  return out;
}

void MsdLoop::Intermediate::receive(double sample) noexcept {
  from = value;
  to = sample;
  age = 0;
}

void MsdLoop::Intermediate::advance(std::uint32_t divider) noexcept {
  age = std::min(age + 1, divider);
  value = approach == Approach::at_once ? to : from + (to - from) * age / divider;
}

MsdLoop::MsdLoop(const MsdLoopOptions& options)
    : options_(options), model_(options.object, options.period()), server_{.approach = options.server} {
  for (const MsdUser& user : options.users)
    users_.push_back(User{user, Delay(user.to_server), Delay(user.from_server), Intermediate{.approach = options.client}});
}

double MsdLoop::server_force(const User& user, double device) const noexcept {
  const double penetration = device - server_.value;
  const bool free = device == kAway || (options_.coupling == Coupling::pressing && penetration <= 0);
  return free ? 0 : user.spec.server_stiffness * penetration;
}

void MsdLoop::feel(User& user, double device) noexcept {
  // The packet that carries x'_o leaves whenever it changed; in between the network holds the last value.
  if (const double received = user.backward.pass(user.sent); received != user.model.to) user.model.receive(received);
  user.model.advance(options_.divider);
  const double penetration = device == kAway ? 0 : device - user.model.value;
  const double rate = (penetration - user.penetration) / options_.tick;
  user.penetration = penetration;
  const double resistance = user.spec.client_stiffness * penetration + user.spec.client_damping * rate;
  const bool free = device == kAway || (options_.coupling == Coupling::pressing && (penetration <= 0 || resistance <= 0));
  user.felt = free ? 0 : -resistance;
}

void MsdLoop::step(std::span<const double> device) noexcept {
  server_.advance(options_.divider);
  last_ = 0;
  for (std::size_t i = 0; i < users_.size(); ++i) {
    last_ += server_force(users_[i], users_[i].forward.pass(device[i]));
    feel(users_[i], device[i]);
  }
  sum_ += last_;
  if (++phase_ < options_.divider) return;
  // T_c: what is computed from this period's forces is used from the next period on.
  const double x = model_.step(options_.decimator == Decimator::mean ? sum_ / options_.divider : last_);
  server_.receive(x);
  for (User& user : users_) user.sent = x;
  sum_ = 0;
  phase_ = 0;
}

}  // namespace tactus
