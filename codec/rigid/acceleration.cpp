// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/acceleration.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactus {
namespace {

constexpr double kLongest = 0.01;  // [s] of two differences: older ones say nothing of now

/// The smaller of two numbers of one sign; else 0.
double agreed(double a, double b) noexcept {
  if (a * b <= 0) return 0;
  return std::abs(a) < std::abs(b) ? a : b;
}

Vec3 agreed(const Vec3& a, const Vec3& b) noexcept { return {agreed(a.x, b.x), agreed(a.y, b.y), agreed(a.z, b.z)}; }

}  // namespace

double Acceleration::departure(double seconds) noexcept { return kFade * (seconds - kFade * (1 - std::exp(-seconds / kFade))); }

Acceleration::Acceleration(const Scene& scene) : scene_(scene) {
  ticks_.fill(std::numeric_limits<std::int64_t>::min() / 4);
  for (auto& motions : motions_) motions.resize(scene.objects.size());
}

void Acceleration::read(std::int64_t tick, std::span<const RigidSample> samples) noexcept {
  std::rotate(ticks_.begin(), ticks_.end() - 1, ticks_.end());
  std::rotate(motions_.begin(), motions_.end() - 1, motions_.end());
  ticks_[0] = tick;
  for (const std::uint32_t i : scene_.moving()) motions_[0][i] = {samples[i].velocity, samples[i].angular_velocity};
}

double Acceleration::seconds(std::size_t from, std::size_t to) const noexcept {
  return static_cast<double>(ticks_[to] - ticks_[from]) / scene_.tick_rate;
}

Acceleration::Motion Acceleration::of(std::uint32_t object) const noexcept {
  if (seconds(2, 0) > kLongest) return {};
  const Motion &a = motions_[2][object], &b = motions_[1][object], &c = motions_[0][object];
  const double before = 1 / seconds(2, 1), now = 1 / seconds(1, 0);
  return {agreed(before * (b.linear - a.linear), now * (c.linear - b.linear)),
          agreed(before * (b.angular - a.angular), now * (c.angular - b.angular))};
}

}  // namespace tactus
