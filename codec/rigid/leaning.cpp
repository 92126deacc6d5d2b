// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/leaning.h>

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kTau = Acceleration::kFade;
constexpr double kMargin = 0.6;  // share of a bound; the rest is for the error at the update and for what the truth really does

/// [s] s of B [s^2].
double lead(double ratio) noexcept {
  const double y = std::sqrt(std::min(2 * ratio, 2 * kTau * kTau)) / kTau;
  return kTau * std::min(y - y * y / 6, 1.0);
}

}  // namespace

Acceleration::Motion leaning(const Acceleration::Motion& acceleration, const ErrorShare& share) noexcept {
  const double per_second_squared = share(acceleration.linear, acceleration.angular);
  if (per_second_squared == 0) return {};
  const double s = lead(kMargin / per_second_squared);
  return {s * acceleration.linear, s * acceleration.angular};
}

}  // namespace tactus
