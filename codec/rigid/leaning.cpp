// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/leaning.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactus {
namespace {

constexpr double kTau = 0.03;      // [s]
constexpr double kMargin = 0.6;    // share of a bound; the rest is for the error at the update and for what the truth really does
constexpr double kLongest = 0.05;  // [s] of two differences: older ones say nothing of now

/// The smaller of two numbers of one sign; else 0.
double agreed(double a, double b) noexcept {
  if (a * b <= 0) return 0;
  return std::abs(a) < std::abs(b) ? a : b;
}

Vec3 agreed(const Vec3& a, const Vec3& b) noexcept { return {agreed(a.x, b.x), agreed(a.y, b.y), agreed(a.z, b.z)}; }

/// permitted / size, for a smallest ratio.
void limit(double& least, double permitted, double size) noexcept {
  if (size * least > permitted) least = permitted / size;
}

/// [s] s of B [s^2].
double lead(double ratio) noexcept {
  const double y = std::sqrt(std::min(2 * ratio, 2 * kTau * kTau)) / kTau;
  return kTau * std::min(y - y * y / 6, 1.0);
}

}  // namespace

Leaning::Leaning(const Scene& scene) : scene_(scene) {
  ticks_.fill(std::numeric_limits<std::int64_t>::min() / 4);
  for (auto& motions : motions_) motions.resize(scene.objects.size());
}

void Leaning::read(std::int64_t tick, std::span<const RigidSample> samples) noexcept {
  std::rotate(ticks_.begin(), ticks_.end() - 1, ticks_.end());
  std::rotate(motions_.begin(), motions_.end() - 1, motions_.end());
  ticks_[0] = tick;
  for (const std::uint32_t i : scene_.moving()) motions_[0][i] = {samples[i].velocity, samples[i].angular_velocity};
}

double Leaning::seconds(std::size_t from, std::size_t to) const noexcept {
  return static_cast<double>(ticks_[to] - ticks_[from]) / scene_.tick_rate;
}

Leaning::Motion Leaning::acceleration(std::uint32_t object) const noexcept {
  if (seconds(2, 0) > kLongest) return {};
  const Motion &a = motions_[2][object], &b = motions_[1][object], &c = motions_[0][object];
  const double before = 1 / seconds(2, 1), now = 1 / seconds(1, 0);
  return {agreed(before * (b.velocity - a.velocity), now * (c.velocity - b.velocity)),
          agreed(before * (b.angular_velocity - a.angular_velocity), now * (c.angular_velocity - b.angular_velocity))};
}

RigidSample Leaning::lean(std::uint32_t object, std::span<const RigidSample> samples, std::span<const Contact> contacts,
                          const RigidTriggers& triggers) const noexcept {
  RigidSample out = samples[object];
  const auto [a, alpha] = acceleration(object);
  if (a == Vec3{} && alpha == Vec3{}) return out;
  double ratio = kTau * kTau / kMargin;
  limit(ratio, triggers.visual_position, norm(a));
  limit(ratio, triggers.visual_rotation, norm(alpha));
  for (const Contact& contact : contacts) {
    if (contact.kind == ContactKind::none || contact.object != object || triggers.haptic == HapticRule::off) continue;
    if (triggers.haptic == HapticRule::fixed) {
      limit(ratio, triggers.fixed_position, norm(a));
      limit(ratio, triggers.fixed_rotation, norm(alpha));
      continue;
    }
    const Vec3 at_point = a + cross(alpha, rotate(out.pose.rotation, contact.point));
    const bool is_spring = contact.kind == ContactKind::spring;
    const double felt = is_spring ? norm(at_point) : std::abs(dot(at_point, rotate(out.pose.rotation, contact.normal)));
    limit(ratio, force_budget(triggers, norm(contact_force(contact, out.pose))) / contact.stiffness, felt);
  }
  const double s = lead(kMargin * ratio);
  out.velocity = out.velocity + s * a;
  out.angular_velocity = out.angular_velocity + s * alpha;
  return out;
}

}  // namespace tactus
