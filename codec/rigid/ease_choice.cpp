// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/ease_choice.h>

#include <array>

#include <tactus/rigid/rigid_syntax.h>

namespace tactus {
namespace {

constexpr double kInside = 0.7;  // share of the bounds at the end, 1 at the begin: the truth will not do exactly what is taken
constexpr std::array kParts{0.25, 0.5, 0.75, 1.0};

bool stays_inside(const UpdateCourse& c, const ErrorShare& share, double duration) noexcept {
  for (const double part : kParts) {
    const double t = part * duration, left = 1 - part, gone = Acceleration::departure(t);
    const Vec3 moved = left * c.offset.moved + c.error.moved + t * c.drift.linear - gone * c.acceleration.linear;
    const Vec3 turned = left * c.offset.turned + c.error.turned + t * c.drift.angular - gone * c.acceleration.angular;
    if (!(share(moved, turned, t) <= 1 - (1 - kInside) * part)) return false;
  }
  return true;
}

}  // namespace

std::uint8_t longest_ease(const UpdateCourse& course, const ErrorShare& share, std::uint32_t tick_rate) noexcept {
  for (int ease = usual_ease(tick_rate); ease > 0; --ease)
    if (stays_inside(course, share, static_cast<double>(1u << ease) / tick_rate)) return static_cast<std::uint8_t>(ease);
  return 0;
}

}  // namespace tactus
