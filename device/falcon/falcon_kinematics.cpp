// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/falcon/falcon_kinematics.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <tactus/base/rule.h>

namespace tactus::device::falcon {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
// [m]
constexpr double kArm = 0.060;              // a
constexpr double kRod = 0.1025;             // b
constexpr double kJoints = 2 * 0.01125;     // d + e
constexpr double kInU = -0.0400 + 0.01443;  // -r + c: from the arm's joint to the origin, and from the handle to its joint
constexpr double kInV = 0.02309 - 0.025;    // -s + f
// u_i at 105, -15 and -135 degrees from x towards y.
constexpr double kSin15 = 0.25881904510252076, kCos15 = 0.96592582628906829, kSin45 = 0.70710678118654752;
constexpr std::array<Vec3, 3> kOutwards{Vec3{-kSin15, kCos15, 0}, Vec3{kCos15, -kSin15, 0}, Vec3{-kSin45, -kSin45, 0}};

constexpr double kAtZeroCount = 35 * kDegree;
constexpr double kPerCount = 2 * std::numbers::pi / (320 * 4) * (14.25 / 110);  // [rad]
constexpr double kPerTorque = -10000;                                           // [1/(N m)]

// In the workspace the sine stays above 0.42, the determinant below -0.32, the gradient below 1.24.
constexpr double kLeastSine = 0.1;
constexpr double kLeastDeterminant = 0.1;
constexpr double kMostGradient = 2;
constexpr double kClosed = 1e-10;      // [m]
constexpr double kLongestStep = 0.03;  // [m]

/// An arm as its plane sees it, at some position and angle.
struct Leg {
  double gap;     // [m] by which the rod misses the arm's end: zero in a pose
  double sine;    // of the angle between arm and rod
  Vec3 gradient;  // of the gap over the position: nearly a unit vector
};

struct InPlane {
  double u, v, w;  // [m]
};

InPlane in_plane(std::size_t leg, const Vec3& p) noexcept {
  const Vec3& u = kOutwards[leg];
  return {u.x * p.x + u.y * p.y + kInU, u.x * p.y - u.y * p.x + kInV, p.z};
}

/// How far the rod reaches within the plane; none: it is shorter than the distance out of it.
std::optional<double> reach(double v) noexcept {
  const double square = kRod * kRod - v * v;
  if (!(square > 0)) return std::nullopt;
  return std::sqrt(square);
}

std::optional<Leg> leg_at(std::size_t leg, const Vec3& position, double angle) noexcept {
  const auto [u, v, w] = in_plane(leg, position);
  const std::optional<double> rod = reach(v);
  const double cos = std::cos(angle), sin = std::sin(angle);
  const double du = u - kArm * cos, dw = w - kArm * sin;
  const double length = std::hypot(du, dw);
  if (!rod || !(length > 0)) return std::nullopt;
  const double gu = du / length, gv = v / *rod;
  const Vec3& outwards = kOutwards[leg];
  return Leg{length - kJoints - *rod,
             (dw * cos - du * sin) / length,
             {outwards.x * gu - outwards.y * gv, outwards.y * gu + outwards.x * gv, dw / length}};
}

std::optional<std::array<Leg, 3>> legs_at(const Vec3& position, const Triple& angles) noexcept {
  std::array<Leg, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<Leg> leg = leg_at(i, position, angles[i]);
    if (!leg) return std::nullopt;
    out[i] = *leg;
  }
  return out;
}

double determinant(const Vec3& a, const Vec3& b, const Vec3& c) noexcept { return dot(a, cross(b, c)); }

double determinant(const std::array<Leg, 3>& legs) noexcept {
  return determinant(legs[0].gradient, legs[1].gradient, legs[2].gradient);
}

/// x with a.x = right[0], b.x = right[1], c.x = right[2]
Vec3 solve(const std::array<Leg, 3>& legs, const Triple& right) noexcept {
  const Vec3 &a = legs[0].gradient, &b = legs[1].gradient, &c = legs[2].gradient;
  return (1 / determinant(legs)) * (right[0] * cross(b, c) + right[1] * cross(c, a) + right[2] * cross(a, b));
}

/// Poses of the Falcon: the handle in front of the arms, their elbows outwards.
Result<Pose> checked(const Vec3& position, const Triple& angles) noexcept {
  const auto legs = legs_at(position, angles);
  if (!legs || !(determinant(*legs) < -kLeastDeterminant) || !(position.z > 0)) return fail(Errc::invalid, "R-DEV-6");
  Pose out{position, angles};
  for (std::size_t i = 0; i < 3; ++i) {
    const Leg& leg = (*legs)[i];
    if (!(leg.sine > kLeastSine) || !(norm(leg.gradient) < kMostGradient)) return fail(Errc::invalid, "R-DEV-6");
    if (!(std::abs(leg.gap) < 2 * kClosed)) return fail(Errc::invalid, "R-DEV-6");
    out.jacobian[i] = (1 / (kArm * leg.sine)) * leg.gradient;
  }
  return out;
}

}  // namespace

Result<Pose> pose_at(const Vec3& position) noexcept {
  Triple angles{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [u, v, w] = in_plane(i, position);
    const double rod = reach(v).value_or(0) + kJoints;
    const double distance = std::hypot(u, w);
    const double cos = (distance * distance + kArm * kArm - rod * rod) / (2 * kArm * distance);
    if (!(std::abs(cos) < 1)) return fail(Errc::invalid, "R-DEV-6");
    angles[i] = std::atan2(w, u) - std::acos(cos);
  }
  return checked(position, angles);
}

Result<Pose> pose_with(const Triple& angles) noexcept {
  Vec3 position{0, 0, kMiddle};
  for (int step = 0; step < kMostSteps; ++step) {
    const auto legs = legs_at(position, angles);
    if (!legs) break;
    const Triple gaps{(*legs)[0].gap, (*legs)[1].gap, (*legs)[2].gap};
    if (std::max({std::abs(gaps[0]), std::abs(gaps[1]), std::abs(gaps[2])}) < kClosed) return checked(position, angles);
    const Vec3 change = solve(*legs, gaps);
    const double length = norm(change);
    if (!std::isfinite(length)) break;
    position = position - std::min(1.0, kLongestStep / length) * change;
  }
  return fail(Errc::invalid, "R-DEV-6");
}

Triple torques(const Pose& pose, const Vec3& force) noexcept {
  const auto& [a, b, c] = pose.jacobian;
  const double scale = 1 / determinant(a, b, c);
  return {scale * determinant(force, b, c), scale * determinant(force, c, a), scale * determinant(force, a, b)};
}

double angle_of(double count) noexcept { return kAtZeroCount + kPerCount * count; }
double count_of(double angle) noexcept { return (angle - kAtZeroCount) / kPerCount; }

std::array<std::int16_t, 3> motors_of(const Triple& torques) noexcept {
  const double largest = std::max({std::abs(torques[0]), std::abs(torques[1]), std::abs(torques[2])}) * std::abs(kPerTorque);
  const double scale = kPerTorque * (largest > kMotorLimit ? kMotorLimit / largest : 1);
  std::array<std::int16_t, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = static_cast<std::int16_t>(std::lround(scale * torques[i]));
  return out;
}

Triple torques_of(const std::array<std::int16_t, 3>& motors) noexcept {
  return {motors[0] / kPerTorque, motors[1] / kPerTorque, motors[2] / kPerTorque};
}

}  // namespace tactus::device::falcon
