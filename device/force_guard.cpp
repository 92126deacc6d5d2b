// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/force_guard.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/rule.h>

namespace tactus::device {
namespace {

constexpr Time kFade = 10 * kMillisecond;
constexpr Time kDefaultSlewTime = 5 * kMillisecond;
constexpr Time kMostElapsed = 2 * kMillisecond;  // after a pause the slew limit must not allow a jump
constexpr double kLeastMove = 1e-7;              // [m] less gives no velocity
constexpr double kMostDamping = 5;               // [N s/m] at 1 kHz stable on every device that a hand holds

double seconds(Time time) noexcept { return 1e-9 * static_cast<double>(time); }

}  // namespace

const char* name_of(GuardAction action) noexcept {
  constexpr std::array<const char*, kGuardActions> kNames{"not finite", "stale", "not valid", "clamp", "passivity", "slew"};
  return kNames[static_cast<std::size_t>(action)];
}

Result<ForceGuard> ForceGuard::create(const Capabilities& capabilities, const GuardLimits& limits) {
  const double nominal = capabilities.nominal_force;
  const bool is_fine = std::isfinite(limits.force) && limits.force >= 0 && limits.force <= nominal &&
                       std::isfinite(limits.slew) && limits.slew >= 0 && limits.fresh > 0 && limits.fresh <= kFade;
  if (capabilities.force_axes == 0 || !(nominal > 0) || !is_fine) return fail(Errc::invalid_argument, "R-API-4");
  GuardLimits used = limits;
  if (used.force == 0) used.force = nominal;
  if (used.slew == 0) used.slew = nominal / seconds(kDefaultSlewTime);
  return ForceGuard(used);
}

GuardedForce ForceGuard::stop() noexcept {
  written_ = {};
  has_passed_ = has_position_ = fades_ = false;
  before_ = actions_ = 0;
  return GuardedForce({});
}

GuardedForce ForceGuard::pass(const ForceCommand& command, const Reading& reading, Time now) noexcept {
  const Time elapsed = has_passed_ ? std::clamp<Time>(now - last_, 0, kMostElapsed) : 0;
  actions_ = 0;
  const bool is_good = is_finite(command.force);
  const bool is_there = reading.state == Reading::State::valid && is_valid(reading.sample);
  if (!is_good) note(GuardAction::not_finite);
  if (!is_there) note(GuardAction::not_valid);
  const Time stale_from = command.time + limits_.fresh;
  if (now > stale_from) note(GuardAction::stale);
  if (is_there) observe(reading);
  else has_position_ = false;
  const Vec3 before = written_;
  if (actions_ != 0) {
    written_ = fade(actions_ == 1u << static_cast<unsigned>(GuardAction::stale) ? stale_from : now, now);
  } else {
    fades_ = false;
    written_ = slew(clamp(dissipate(clamp(command.force), elapsed)), before, elapsed);
  }
  last_ = now;
  has_passed_ = true;
  record(command.force, now);
  return GuardedForce(written_);
}

Vec3 ForceGuard::fade(Time since, Time now) noexcept {
  if (!fades_) {
    fades_ = true;
    fade_begin_ = since;
    fade_from_ = written_;
  }
  const double left = 1 - static_cast<double>(now - fade_begin_) / static_cast<double>(kFade);
  return std::clamp(left, 0.0, 1.0) * fade_from_;
}

/// The force written last acted along the path to this reading.
void ForceGuard::observe(const Reading& reading) noexcept {
  const Vec3& position = reading.sample.position;
  moved_ = has_position_ ? position - position_ : Vec3{};
  energy_ += dot(written_, moved_);
  position_ = position;
  has_position_ = true;
}

/// A damper that takes back, if the device goes on moving as it did, all that it gave away: no harder than one that is stable itself.
Vec3 ForceGuard::dissipate(const Vec3& force, Time elapsed) noexcept {
  const double distance = norm(moved_);
  if (!limits_.passivity || energy_ <= 0 || elapsed == 0 || distance < kLeastMove) return force;
  note(GuardAction::passivity);
  const double strength = std::min(energy_ / distance, kMostDamping * distance / seconds(elapsed));  // [N] along the path
  return force - (strength / distance) * moved_;
}

Vec3 ForceGuard::clamp(const Vec3& force) noexcept {
  const double size = norm(force);
  if (size <= limits_.force) return force;
  note(GuardAction::clamp);
  return (limits_.force / size) * force;
}

Vec3 ForceGuard::slew(const Vec3& force, const Vec3& before, Time elapsed) noexcept {
  const Vec3 change = force - before;
  const double size = norm(change), most = limits_.slew * seconds(elapsed);
  if (size <= most) return force;
  note(GuardAction::slew);
  return before + (most / size) * change;
}

void ForceGuard::record(const Vec3& asked, Time now) noexcept {
  for (std::size_t i = 0; i < kGuardActions; ++i) {
    const auto bit = static_cast<std::uint8_t>(1u << i);
    if ((actions_ & bit) == 0) continue;
    ++counts_[i];
    if ((before_ & bit) == 0 && logged_ < kLogged) log_[logged_++] = {now, static_cast<GuardAction>(i), asked, written_};
  }
  before_ = actions_;
}

}  // namespace tactus::device
