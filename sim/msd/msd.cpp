// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/msd/msd.h>

#include <algorithm>

namespace tactus::sim {

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

void MsdLoop::begin_tick() noexcept {
  server_.advance(options_.divider);
  last_ = 0;
}

double MsdLoop::press(std::size_t user, double device) const noexcept {
  const double penetration = device - server_.value;
  const bool free = device == kAway || (options_.coupling == Coupling::pressing && penetration <= 0);
  return free ? 0 : -users_[user].spec.server_stiffness * penetration;
}

double MsdLoop::feel(std::size_t index, double device, double received, double stiffness) noexcept {
  User& user = users_[index];
  // A packet with x'_o is sent whenever it changes; in between the network holds the last value.
  if (received != user.model.to) user.model.receive(received);
  user.model.advance(options_.divider);
  const double penetration = device == kAway ? 0 : device - user.model.value;
  const double rate = (penetration - user.penetration) / options_.tick;
  user.penetration = penetration;
  const double resistance = stiffness * penetration + user.spec.client_damping * rate;
  const bool free = device == kAway || (options_.coupling == Coupling::pressing && (penetration <= 0 || resistance <= 0));
  return user.rendered = free ? 0 : -resistance;
}

void MsdLoop::end_tick() noexcept {
  sum_ += last_;
  if (++phase_ < options_.divider) return;
  // T_c: the result of this period's forces takes effect in the next period.
  const double x = model_.step(options_.decimator == Decimator::mean ? sum_ / options_.divider : last_);
  server_.receive(x);
  for (User& user : users_) user.sent = x;
  sum_ = 0;
  phase_ = 0;
}

void MsdLoop::step(std::span<const double> device) noexcept {
  begin_tick();
  for (std::size_t i = 0; i < users_.size(); ++i) {
    load(-press(i, users_[i].forward.pass(device[i])));
    feel(i, device[i], users_[i].backward.pass(users_[i].sent));
  }
  end_tick();
}

}  // namespace tactus::sim
