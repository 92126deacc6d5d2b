// SPDX-License-Identifier: Apache-2.0
/// Stiffness with which a client renders an object that the server simulates, so that the delay between them adds no force.
/// Thesis 4.2.3 and 4.3.3. Nothing of it is coded, sent or predicted.
///
///   every tick      move(x_d)                           the device's path of the last round trip is kept
///   in contact      k = reduced(touch, round_trip)      the force is then k times the stretch
///   out of contact  release()
///
/// Deformable objects, equations 4.52 to 4.56. The object counts as a spring k_o behind the coupling k: of the device's displacement it follows the fraction K = k / (k_o + k), a round trip
/// late. While the device goes in by w within a round trip, the stretch that the client sees is too long by K w:
///
///   k_r = k (1 - K w / stretch), not below k (1 - K) and not above k, filtered: mean[n] = lambda k_r + (1 - lambda) mean[n-1]
///
/// Stretch and w are taken along the inward normal, so that friction and motion along the surface do not count. w keeps its sign, as in
/// 4.52: 4.55 takes its magnitude, which would soften the object also while the user lets it go. A contact's first value is not filtered.
///
/// Rigid objects, after algorithm 1 and equations 4.24 to 4.30. While the device goes on by w within a round trip, the stretch p that the
/// client sees is too long by w, as far as the object follows; the object's load (load/load_state.h) is what it resists with, F. Along
/// the direction u of the push:
///
///   F   = -(external + pushes of the others) . u; while the object stands still, what would set it in motion: |hold| - pushes . u; not below 0
///   k_r = k F / (F + beta k min(w, p - F/k)), filtered; k if min(..) is not positive
///
/// beta (4.27) is 0 where the face lies on what holds the object and 1 where it stands upright on it. In the steady state p = F/k + w, and the
/// force k_r p is F: that is 4.30. It has w in place of min(..), which is more than the stretch holds of it while a user comes from outside or
/// has just overcome the friction: the force would break down. And where others push harder than the object resists, so that it runs
/// away from the user, F is 0 and not left out: 4.30 would switch to k and beat the user.
///
/// Algorithm 1 as printed, for comparison (Options::as_printed), by touch: each begins with k and lambda is 0.01. It differs: along the device's velocity, not the push
/// (4.29); R, playout included, times that velocity, the mean of 8 ms, not the displacement of the last round trip; all of it, not what the stretch holds; at rest the
/// pushes of others do not count, and k is kept while the force rendered last, before any limit of the device, is below the friction; who is pushed on gets k. At rest is
/// what is shown at rest, and a round trip beyond the known path counts in full, up to most_delay.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>

namespace tactus {

/// K: fraction of the device's displacement that an object of k_o follows behind a coupling k, both in N/m. Equation 4.54.
constexpr double followed_fraction(double object, double coupling) noexcept { return coupling / (object + coupling); }

class StiffnessReduction {
 public:
  static constexpr std::uint32_t kMostDelay = 10'000;  ///< [ticks]
  /// Lambda, and that of rigid objects that others push, too: two hands side by side swing at one object the more, the faster their stiffness
  /// follows. 0.01 of thesis 4.2.3.4 lags behind a press of 0.5 Hz; slower ones behind a delay that changes. reports/delay
  static constexpr double kFilter = 0.1, kSharedFilter = 0.03, kPrintedFilter = 0.01;

  struct Options {
    std::uint32_t most_delay = 1000;  ///< [ticks] longest round trip that is made up for, 1 to kMostDelay
    bool as_printed = false;          ///< of rigid objects: algorithm 1, as above
    std::optional<double> filter{};   ///< lambda per tick, above 0 to 1; none: by what is touched, below
  };
  struct DeformableTouch {
    Vec3 stretch;                 ///< [m] from the proxy on the surface to the device
    Vec3 normal{0, 0, 1};         ///< of the surface there, outward, unit length
    double coupling = 0;          ///< k [N/m] of proxy and device, > 0
    double object_stiffness = 0;  ///< k_o [N/m] at the touched point, > 0, infinite where it does not move (stiffness_at())
  };

  struct RigidTouch {
    Vec3 stretch;          ///< [m] from the proxy on the surface to the device
    Vec3 normal{0, 0, 1};  ///< of the face, world frame, unit length
    double coupling = 0;   ///< k [N/m], > 0
    bool moves = false;    ///< the object, as it is shown
    Vec3 external;         ///< [N] of its load
    Vec3 others;           ///< [N] sum of the pushes of all other users
    Vec3 hold;             ///< [N] of its load
  };

  /// err  invalid_argument R-API-4: options; limit_exceeded R-API-11
  static Result<StiffnessReduction> create(const Options& options);

  /// The device's position at the next tick [m].   time O(1), no allocation
  void move(const Vec3& device) noexcept;
  /// The stiffness [N/m] for this tick.
  /// in   round_trip [ticks]; what is longer than most_delay, or than the path that is known, counts as that
  /// time O(1), no allocation
  double reduced(const DeformableTouch& touch, std::uint32_t round_trip) noexcept;
  double reduced(const RigidTouch& touch, std::uint32_t round_trip) noexcept;
  /// Nothing is touched at this tick.
  void release() noexcept { is_touching_ = false; }

 private:
  explicit StiffnessReduction(const Options& options);
  Vec3 displacement(std::uint32_t round_trip) const noexcept;
  double filtered(double wanted, double usual) noexcept;
  double as_printed(const RigidTouch& touch, std::uint32_t round_trip) noexcept;

  bool as_printed_;
  std::optional<double> filter_;
  std::vector<Vec3> path_;  // ring
  std::size_t next_ = 0, known_ = 0;
  double mean_ = 0;      // [N/m]
  double rendered_ = 0;  // [N] last, as printed
  bool is_touching_ = false;
};

}  // namespace tactus
