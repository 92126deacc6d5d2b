// SPDX-License-Identifier: Apache-2.0
/// A virtual hand on a force-feedback device: a mass pulled by a spring and a damper toward a minimum-jerk path, with tremor.
///   m x'' = k (x_t - x) + b (x_t' - x') + f_rendered + f_tremor
/// The rendered force closes the loop. The device's reports are quantised by its encoders and smoothed (thesis 3.2.4.1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/sim/random.h>
#include <tactus/sim/scene/scene.h>

namespace tactus::sim {

struct HandImpedance {
  double mass, stiffness, damping;  ///< [kg], [N/m], [N s/m]
};

/// A stylus held loosely to firmly. Order of magnitude of the human wrist and arm at rest; chosen, not fitted.
constexpr HandImpedance hand_impedance(Grip grip) noexcept {
  switch (grip) {
    case Grip::loose:
      return {0.1, 220, 12};
    case Grip::normal:
      return {0.2, 310, 16};
    case Grip::firm:
      return {0.3, 400, 21};
  }
  return {};
}

/// Seed of the hand of a scene's user, in a simulation or a session of this seed.
std::uint64_t hand_seed(std::uint64_t seed, std::size_t user) noexcept;

/// Fraction of the path done at fraction s of the time, with zero velocity and acceleration at both ends (Flash and Hogan 1985), and its
/// slope.
struct MinimumJerk {
  double position, slope;
};
constexpr MinimumJerk minimum_jerk(double s) noexcept {
  return {s * s * s * (10 + s * (-15 + 6 * s)), 30 * s * s * (1 - s) * (1 - s)};
}

/// Band noise: per axis 16 sines of random phase and frequency in 8..12 Hz.
class Tremor {
 public:
  /// Force on a hand of this impedance that makes its free motion `rms` per axis [m].
  Tremor(double rms, const HandImpedance& hand, Random& random);
  Vec3 force(double time) const noexcept;  ///< [N]

 private:
  static constexpr std::size_t kSines = 16;
  struct Sine {
    double frequency, phase, amplitude;  // [rad/s], [rad], [N]
  };
  std::array<std::array<Sine, kSines>, 3> axes_;
};

/// Encoders and the smoothing after them.
class DeviceFilter {
 public:
  DeviceFilter(const SceneDevice& device, const Vec3& start);
  Vec3 read(const Vec3& position) noexcept;

 private:
  double resolution_;
  std::vector<Vec3> window_;
  std::size_t next_ = 0;
};

/// World position of a phase's point, given the shown pose of the object and the end of the last movement, `hand`.
Vec3 waypoint(PathFrame frame, const Vec3& to, const Pose& object, const Vec3& goal, const Vec3& hand) noexcept;

/// Target position and velocity of the hand.
struct Aim {
  Vec3 position, velocity;  ///< [m], [m/s]
};

/// Round a vertical axis from one point to another; radius, angle and height change evenly.
class Spiral {
 public:
  Spiral(const Vec3& from, const Vec3& to, const Vec3& centre, double turns);
  Aim at(double fraction) const noexcept;  ///< fraction of the path; velocity per fraction, not per second

 private:
  Vec3 centre_;
  double radius_, height_, angle_, sweep_, growth_, rise_;
};

class Hand {
 public:
  /// Everything that differs between two hands of one scene comes from the seed.
  Hand(const SceneUser& user, Grip grip, std::uint64_t seed);

  /// Advance by one tick.
  /// in   rendered  [N] force on the hand since the last call, already clipped to the device's limit
  ///      object  the watched object as the user sees it
  /// time O(1), about 1 us (the tremor's sines); no allocation.
  DeviceSample step(const Vec3& rendered, const Pose& object) noexcept;

  const HandImpedance& impedance() const noexcept { return impedance_; }
  const Vec3& position() const noexcept { return position_; }  ///< [m] of the hand itself, before the encoders
  double aim_speed() const noexcept { return aim_speed_; }     ///< [m/s] of what it follows, in the last step()

 private:
  void begin_phase(const Pose& object) noexcept;

  SceneUser user_;
  Random random_;
  HandImpedance impedance_;
  Tremor tremor_;
  DeviceFilter filter_;
  Vec3 position_, velocity_;
  Vec3 from_, to_;  // of the phase that runs or ran last
  std::optional<Spiral> spiral_;
  double aim_speed_ = 0;
  std::size_t next_ = 0;  // phase; after the last one the hand stays where it is
  std::int64_t tick_ = 0, begin_ = 0, end_ = 0;
};

}  // namespace tactus::sim
