// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/force_trend.h>

#include <algorithm>
#include <limits>

namespace tactus {
namespace {

constexpr double kLongest = 0.01;  // [s] between the ticks compared: older ones say nothing of now
constexpr double kNone = std::numeric_limits<double>::infinity();

}  // namespace

ForceTrend::ForceTrend(const Scene& scene) : scene_(scene) {
  for (auto& forces : forces_) forces.assign(scene.objects.size(), kNone);
}

void ForceTrend::read(std::int64_t tick, std::span<const RigidSample> samples, std::span<const Contact> contacts) noexcept {
  std::rotate(ticks_.begin(), ticks_.end() - 1, ticks_.end());
  std::rotate(forces_.begin(), forces_.end() - 1, forces_.end());
  ticks_[0] = tick;
  for (const std::uint32_t i : scene_.moving()) forces_[0][i] = kNone;
  for (const Contact& contact : contacts) {
    if (contact.kind == ContactKind::none) continue;
    double& least = forces_[0][contact.object];
    least = std::min(least, norm(contact_force(contact, samples[contact.object].pose)));
  }
}

double ForceTrend::sinking(std::uint32_t object) const noexcept {
  const double now = forces_[0][object], before = forces_[2][object];
  const double seconds = static_cast<double>(ticks_[0] - ticks_[2]) / scene_.tick_rate;
  if (!(now > 0 && now < before && before < kNone) || seconds > kLongest) return 0;
  return (before - now) / (now * seconds);
}

}  // namespace tactus
