// SPDX-License-Identifier: Apache-2.0
/// What a touch shows: energy, the stability of a sampled wall, contacts.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstdint>
#include <limits>
#include <optional>

#include <tactus/base/geometry.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/user/hand.h>
#include <tactus/trace/frame.h>

namespace tactus::sim {

// ==== passivity ====
// Energy that a sampled environment gives away, and the damping that takes it back: passivity observer and controller
// (Hannaford and Ryu 2002). Thesis 2.2.2, eq. 2.2, figures 2.2b and 2.2c.
//
// sign   f is the force on the hand, held from one tick to the next; the hand puts energy into the environment against it:
//          E(n) = E(n-1) - f(n-1) . (x(n) - x(n-1))
//        passive as long as E >= 0. A spring of stiffness k that is pressed to depth X and released at d metres per tick gives
//        away k d X: the hold is one tick late, too weak on the way in and too strong on the way out.
// damping  before f(n) is rendered, the controller assumes that the hand moves on as in the last tick, and adds just enough of
//          -alpha (x(n) - x(n-1)) / T, alpha <= max_damping, to keep E(n+1) from being negative.
// tests    tests/unit/passivity_test.cpp

/// Watches the energy at the port between device and environment.
class PassivityObserver {
 public:
  /// in  tolerance  [J] rounding that does not count as a violation
  explicit PassivityObserver(double tolerance = 1e-12) noexcept : tolerance_(tolerance) {}

  /// Report the device's position.   time O(1), no allocation
  void arrive(const Vec3& position) noexcept;
  /// Report the force that acts on the hand until the next arrive().
  void hold(const Vec3& force) noexcept { force_ = force; }
  /// Limit the stored energy; 0 starts anew.
  void cap(double energy) noexcept { energy_ = std::min(energy_, energy); }
  void reset() noexcept { energy_ = 0; }

  const Vec3& step() const noexcept { return step_; }                ///< [m] from the last position to this one
  double energy() const noexcept { return energy_; }                 ///< [J] put in minus taken out
  double lowest() const noexcept { return lowest_; }                 ///< [J] least energy so far, at most 0
  std::uint64_t violations() const noexcept { return violations_; }  ///< ticks with energy below zero

 private:
  double tolerance_, energy_ = 0, lowest_ = 0;
  Vec3 position_, step_, force_;
  bool arrived_ = false;
  std::uint64_t violations_ = 0;
};

struct PassivityOptions {
  double tick = 1e-3;                                            ///< [s] T
  double max_damping = std::numeric_limits<double>::infinity();  ///< [Ns/m] stable limit at this rate: about mass / T
  double max_stored = std::numeric_limits<double>::infinity();   ///< [J] limit of stored energy, which would hide later activity
  double reset_after = std::numeric_limits<double>::infinity();  ///< [s] without force, then the account starts anew
};

class PassivityController {
 public:
  explicit PassivityController(const PassivityOptions& options) noexcept : options_(options) {}

  /// Force to render in place of the environment's.
  /// in   position  [m] of the device now
  ///      force     [N] on the hand
  /// time O(1), no allocation
  Vec3 limit(const Vec3& position, const Vec3& force) noexcept;

  const PassivityObserver& port() const noexcept { return port_; }  ///< including the controller's damping
  double damping() const noexcept { return damping_; }              ///< [Ns/m] alpha in this tick

 private:
  PassivityOptions options_;
  PassivityObserver port_;
  double damping_ = 0;
  double free_for_ = 0;  // [s]
};

// ==== sampled limit ====
// Stability limit of a virtual hand on a coupling: sampling and smoothing of the device delay the rendered force.

/// Largest stable stiffness k [N/m] of a spring from hand and device to a fixed point. For the simulated loop
///   m (x+ - 2 x + x-) / T^2 = -k_h x - b (x - x-) / T - k F x,   F the device's mean of N samples,
/// it is the least k with a pole on the unit circle, about b / ((N - 1) T / 2) where that is far above k_h. An object that yields
/// allows more.
/// time 40 us for N = 8, 2 ms for 1000
double sampled_limit(const HandImpedance& hand, const SceneDevice& device) noexcept;

// ==== swings ====
// A hand that wants to hold still and goes to and fro: the loop that it closes through the scene is not stable.

class SwingMeter {
 public:
  /// One tick.   in  holds  the hand wants to stay where it is, and touches something now and then   time O(1), no allocation
  void add(const Vec3& position, bool holds) noexcept;
  /// [m] The largest so far of the least of four swings in a row along an axis, from turning point to turning point, within two
  /// seconds: a push from outside makes one or two.
  double largest() const noexcept { return largest_; }

 private:
  static constexpr std::size_t kInARow = 4;
  struct Axis {
    int direction = 0;       // of the motion since the last turning point; 0: there was none
    double peak = 0;         // [m] farthest on it
    double turned = 0;       // [m] the last turning point
    std::size_t swings = 0;  // so far
    std::array<double, kInARow> sizes{};
    std::array<std::int64_t, kInARow> begins{};  // ticks
    std::int64_t turned_at = 0;
  };
  void add(Axis& axis, double x) noexcept;

  std::array<Axis, 3> axes_{};
  std::int64_t tick_ = 0;
  bool holds_ = false;
  double largest_ = 0;
};

// ==== touch record ====
// Summary of a run at one user's hand: contacts, forces, and the energy of the port between device and scene (thesis 2.2.2).

struct TouchSummary {
  std::uint64_t ticks = 0;     ///< in contact with anything, at the server
  std::uint64_t contacts = 0;  ///< begun
  std::uint32_t most_in_a_second =
      0;                     ///< contacts begun within one second: more than about ten is chattering, not the hand's motion
  double largest_force = 0;  ///< [N] rendered
  double largest_server_force = 0;  ///< [N] of the server
  double swing = 0;                 ///< [m] SwingMeter::largest, while the hand was to hold still
  /// [J] least net energy that the hand had put into the scene since a contact began, at most 0. A negative value means that the
  /// scene gave away more than it had taken. Sampling and delay cause this (eq. 2.2), and so do weight and other users, which
  /// have energy of their own. Each contact begins at 0, because energy taken by earlier ones would hide energy given by this
  /// one.
  double lowest_energy = 0;
  double stiffest = 0;                      ///< [N/m] largest stiffness of the couplings that held the hand
  std::optional<SurfaceContact> hardest{};  ///< where a deformable object was pressed with most force
};

class TouchRecord {
 public:
  /// What a hand wants.
  enum class Aim : std::uint8_t { moves, rests, unknown };
  /// One tick, as in the trace.   time O(1), no allocation
  void add(const UserSample& sample, Aim aim = Aim::unknown) noexcept;

  const TouchSummary& summary() const noexcept { return summary_; }

 private:
  TouchSummary summary_;
  PassivityObserver port_;
  bool touching_ = false;
  SwingMeter swings_;
  std::uint32_t free_for_ = 0;    // ticks without a contact
  double hardest_ = 0;            // [N]
  std::bitset<kTickRate> began_;  // in each tick of the last second
  std::size_t tick_ = 0;          // of that second
  std::uint32_t in_a_second_ = 0;
};

}  // namespace tactus::sim
