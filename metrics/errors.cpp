// SPDX-License-Identifier: Apache-2.0
#include <tactus/metrics/errors.h>

#include <algorithm>
#include <cmath>

#include <tactus/rigid/rigid_state.h>

namespace tactus {

void ErrorSeries::add(double error, bool over) noexcept {
  ++samples_;
  square_sum_ += error * error;
  max_ = std::max(max_, error);
  sampled_ = true;
  over_ = over_ || over;
}

void ErrorSeries::end_tick(std::int64_t tick) noexcept {
  ticks_ += sampled_ ? 1 : 0;
  ticks_over_ += over_ ? 1 : 0;
  if (over_) run_.add(tick);
  else run_ = {};
  longest_run_ = std::max(longest_run_, run_.length());
  sampled_ = over_ = false;
}

double ErrorSeries::rms() const noexcept { return samples_ == 0 ? 0 : std::sqrt(square_sum_ / static_cast<double>(samples_)); }

ErrorMetrics::ErrorMetrics(const TraceInfo& info, const RigidTriggers& bounds) : bounds_(bounds) {
  for (std::uint32_t i = 0; i < info.objects.size(); ++i) {
    if (info.objects[i].dof != Dof::none) moving_.push_back(i);
  }
  for (const TraceUser& user : info.users) users_.push_back({.name = user.name});
}

bool ErrorMetrics::breaks_rule(const Pose& truth, const Pose& shown, const Vec3& force, const Vec3& estimate) noexcept {
  if (bounds_.haptic == HapticRule::fixed) {
    const double distance = norm(shown.position - truth.position) / bounds_.fixed_position;
    const double angle = angle_between(truth.rotation, shown.rotation) / bounds_.fixed_rotation;
    worst_ratio_ = std::max({worst_ratio_, distance, angle});
    return std::max(distance, angle) > 1;
  }
  const double ratio = haptic_ratio(bounds_, force, estimate);
  worst_ratio_ = std::max(worst_ratio_, ratio);
  return ratio > 1;
}

/// Below the force floor the permitted error stays that of the floor, as in the haptic rule.
bool ErrorMetrics::is_perceptible(double force, double error) const noexcept {
  return error > weber_fraction_at(force) * std::max(force, bounds_.force_floor);
}

void ErrorMetrics::add(const TraceFrame& truth, std::span<const Pose> shown, std::span<const std::uint8_t> levels) noexcept {
  for (const std::uint32_t i : moving_) {
    const int level = levels.empty() ? 0 : levels[i];
    if (level == kOutOfInterest) continue;
    const Pose& pose = truth.objects[i].pose;
    const double distance = std::ldexp(norm(shown[i].position - pose.position), -level);
    const double angle = std::ldexp(angle_between(pose.rotation, shown[i].rotation), -level);
    position_.add(distance, distance > bounds_.visual_position);
    rotation_.add(angle, angle > bounds_.visual_rotation);
  }
  for (std::size_t i = 0; i < users_.size(); ++i) {
    const UserSample& user = truth.users[i];
    users_[i].has_force = users_[i].has_force || norm(user.force) > 0 || norm(user.server_force) > 0;
    users_[i].has_contact = users_[i].has_contact || user.contact.kind != ContactKind::none || user.surface_contact;
  }
  for (const UserSample& user : truth.users) {
    if (user.contact.kind == ContactKind::none) continue;
    const std::uint32_t object = user.contact.object;
    const Pose& pose = truth.objects[object].pose;
    const Vec3 force = contact_force(user.contact, pose);
    const Vec3 estimate = contact_force(user.contact, shown[object]);
    const double error = norm(estimate - force);
    force_.add(error, breaks_rule(pose, shown[object], force, estimate));
    perceived_.add(error, is_perceptible(norm(force), error));
  }
  for (ErrorSeries* series : {&position_, &rotation_, &force_, &perceived_}) series->end_tick(truth.tick);
}

std::vector<std::string> ErrorMetrics::unbound_users() const {
  std::vector<std::string> out;
  for (const User& user : users_)
    if (user.has_force && !user.has_contact) out.push_back(user.name);
  return out;
}

void ErrorMetrics::add_rendered(const TraceFrame& truth) noexcept {
  for (const UserSample& user : truth.users) {
    const double force = norm(user.server_force);
    if (force == 0 && norm(user.force) == 0) continue;
    const double error = norm(user.force - user.server_force);
    rendered_.add(error, is_perceptible(force, error));
  }
  rendered_.end_tick(truth.tick);
}

}  // namespace tactus
