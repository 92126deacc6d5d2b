// SPDX-License-Identifier: Apache-2.0
/// The only way a force reaches a device. In this order, once per tick:
///
///   finite?      a force with NaN or infinity counts as none                                  -> fades to zero
///   fresh?       a force from a sample older than GuardLimits::fresh counts as none           -> fades to zero
///   valid?       a device that is not homed or out of reach gets none                         -> fades to zero
///   clamp        at most the device's nominal force, same direction
///   passive      if asked for: damping dissipates the energy that the virtual object would give away
///                (Hannaford and Ryu 2002: passivity observer and controller)
///   slew         away from what was written last by at most slew * time
///
/// Fading: from what was written last to zero in a straight line, done 10 ms after it began, so that 20 ms after the last good force
/// there is none, whatever the slew limit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <tactus/device/device.h>

namespace tactus::device {

struct GuardLimits {
  double force = 0;  ///< [N] 0: the device's nominal force; never more than that
  double slew = 0;   ///< [N/s] 0: the nominal force within 5 ms
  Time fresh = 10 * kMillisecond;
  bool passivity = false;  ///< the controller; the observer always watches
};

struct ForceCommand {
  Vec3 force{};   ///< [N] on the hand, device frame
  Time time = 0;  ///< of what it was computed from
};

enum class GuardAction : std::uint8_t { not_finite, stale, not_valid, clamp, passivity, slew };
inline constexpr std::size_t kGuardActions = 6;
const char* name_of(GuardAction action) noexcept;

/// An action that began: it was not taken at the call before.
struct GuardEntry {
  Time time = 0;
  GuardAction action{};
  Vec3 asked{}, passed{};  ///< [N] at that call
};

class ForceGuard {
 public:
  /// err  invalid_argument R-API-4: a limit is negative, not finite, or above the device's nominal force; the device takes no force
  static Result<ForceGuard> create(const Capabilities& capabilities, const GuardLimits& limits);

  /// in   now  never falls
  /// time O(1), about 50 ns; no allocation
  GuardedForce pass(const ForceCommand& command, const Reading& reading, Time now) noexcept;
  /// Zero, at once: the end, or after Device::halt().
  GuardedForce stop() noexcept;

  const Vec3& written() const noexcept { return written_; }   ///< [N] by the last call
  std::uint8_t actions() const noexcept { return actions_; }  ///< of the last call: bit i is GuardAction i
  std::uint64_t count(GuardAction action) const noexcept { return counts_[static_cast<std::size_t>(action)]; }  ///< calls
  /// The first kLogged actions that began; later ones are counted only.
  std::span<const GuardEntry> log() const noexcept { return std::span(log_).first(logged_); }
  /// [J] that the device gave away and did not take back: above zero something active was rendered to the hand.
  double energy() const noexcept { return energy_; }
  const GuardLimits& limits() const noexcept { return limits_; }

  static constexpr std::size_t kLogged = 256;

 private:
  explicit ForceGuard(const GuardLimits& limits) noexcept : limits_(limits) {}
  void note(GuardAction action) noexcept { actions_ = static_cast<std::uint8_t>(actions_ | 1u << static_cast<unsigned>(action)); }
  Vec3 fade(Time since, Time now) noexcept;
  void observe(const Reading& reading) noexcept;
  Vec3 dissipate(const Vec3& force, Time elapsed) noexcept;
  Vec3 clamp(const Vec3& force) noexcept;
  Vec3 slew(const Vec3& force, const Vec3& before, Time elapsed) noexcept;
  void record(const Vec3& asked, Time now) noexcept;

  GuardLimits limits_;
  Vec3 written_{};
  Time last_ = 0;            // call of pass()
  bool has_passed_ = false;  // since the start, or stop()
  bool fades_ = false;
  Time fade_begin_ = 0;
  Vec3 fade_from_{};
  Vec3 position_{}, moved_{};  // [m] of the last valid reading, and since the one before
  bool has_position_ = false;
  double energy_ = 0;
  std::uint8_t actions_ = 0, before_ = 0;
  std::array<std::uint64_t, kGuardActions> counts_{};
  std::array<GuardEntry, kLogged> log_{};
  std::size_t logged_ = 0;
};

}  // namespace tactus::device
