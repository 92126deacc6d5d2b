// SPDX-License-Identifier: Apache-2.0
#include <tactus/metrics/delay_tolerance.h>

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kWindow = 8e-3;      // [s] of the velocity
constexpr double kLeastSpeed = 1e-6;  // [m/s] less is rounding
constexpr double kLeastForce = 1e-9;  // [N]

}  // namespace

std::optional<double> tolerable_round_trip(const Vec3& force, const Vec3& velocity, double stiffness, double weber) noexcept {
  const double size = norm(force);
  if (size < kLeastForce) return std::nullopt;
  const double against = -dot(velocity, force) / size;
  if (against < kLeastSpeed) return std::nullopt;
  return weber * size / (stiffness * against);
}

void DelayTolerance::Touch::add(std::optional<double> most, double follows) {
  ++ticks_;
  follows_ += follows;
  if (!most) return;
  ++pressing_;
  for (std::size_t i = 0; i < kRoundTrips.size(); ++i) perceptible_[i] += kRoundTrips[i] > *most ? 1U : 0U;
  if (*most < kLongest) ++bins_[static_cast<std::uint32_t>(*most / kBin)];
}

std::optional<double> DelayTolerance::Touch::quantile(double fraction) const noexcept {
  std::uint64_t seen = 0;
  for (const auto& [bin, ticks] : bins_) {
    seen += ticks;
    if (static_cast<double>(seen) >= fraction * static_cast<double>(pressing_)) return kBin * (bin + 1.0);
  }
  return std::nullopt;
}

double DelayTolerance::Touch::perceptible(std::size_t i) const noexcept {
  return ticks_ == 0 ? 0 : static_cast<double>(perceptible_[i]) / static_cast<double>(ticks_);
}

std::optional<Vec3> DelayTolerance::Path::velocity(double tick) const noexcept {
  if (positions.size() < 2) return std::nullopt;
  const auto& [from, a] = positions.front();
  const auto& [to, b] = positions.back();
  return (1 / (tick * static_cast<double>(to - from))) * (b - a);
}

void DelayTolerance::add(const TraceFrame& frame, const Follows& follows) {
  for (std::uint32_t i = 0; i < frame.users.size(); ++i) {
    const UserSample& user = frame.users[i];
    auto& positions = users_[i].positions;
    const auto is_old = [&](const auto& position) { return static_cast<double>(frame.tick - position.first) * tick_ > kWindow; };
    if (!positions.empty() && frame.tick - positions.back().first > 1 && is_old(positions.back())) positions.clear();  // a pause
    const auto kept = std::ranges::find_if_not(positions, is_old);
    positions.erase(positions.begin(), kept == positions.end() && kept != positions.begin() ? kept - 1 : kept);
    positions.emplace_back(frame.tick, user.device.position);
    const auto velocity = users_[i].velocity(tick_);
    if (!velocity) continue;
    const auto add_to = [&](const Pair& pair, double k) {
      const double fraction = follows ? follows(pair, user) : 1;
      touches_[pair].add(tolerable_round_trip(user.server_force, *velocity, fraction * k, weber_), fraction);
    };
    if (user.contact.kind != ContactKind::none) add_to({i, false, user.contact.object}, user.contact.stiffness);
    if (user.surface_contact) add_to({i, true, user.surface_contact->mesh}, user.surface_contact->stiffness);
  }
}

}  // namespace tactus
