// SPDX-License-Identifier: Apache-2.0
/// Stiffness with which a client renders a deformable object that the server simulates, so that the delay between them adds no force
/// while the user presses. Thesis 4.3.3, equations 4.52 to 4.56. Nothing of it is coded, sent or predicted.
///
///   every tick      move(x_d)                           the device's path of the last round trip is kept
///   in contact      k = reduced(touch, round_trip)      the force is then k times the stretch
///   out of contact  release()
///
/// The object counts as a spring k_o behind the coupling k: of the device's way it follows the share K = k / (k_o + k), a round trip
/// late. While the device goes in by w within a round trip, the stretch that the client sees is too long by K w:
///
///   k_r = k (1 - K w / stretch), not below k (1 - K) and not above k, filtered: mean[n] = lambda k_r + (1 - lambda) mean[n-1]
///
/// Stretch and w are taken along the inward normal, so that friction and motion along the surface do not count. w keeps its sign, as in
/// 4.52: 4.55 takes its magnitude, which would soften the object also while the user lets it go. A contact's first value is not filtered.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>

namespace tactus {

class StiffnessReduction {
 public:
  static constexpr std::uint32_t kMostDelay = 10'000;  ///< [ticks]

  struct Options {
    std::uint32_t most_delay = 1000;  ///< [ticks] longest round trip that is made up for, 1 to kMostDelay
    double filter = 0.1;              ///< lambda per tick, above 0 to 1; 0.01 of thesis 4.2.3.4 lags behind a press of 0.5 Hz
  };
  struct Touch {
    Vec3 stretch;                 ///< [m] from the proxy on the surface to the device
    Vec3 normal{0, 0, 1};         ///< of the surface there, outward, unit length
    double coupling = 0;          ///< k [N/m] of proxy and device, > 0
    double object_stiffness = 0;  ///< k_o [N/m] at the touched point, > 0
  };

  /// err  invalid_argument R-API-4: options; limit_exceeded R-API-11
  static Result<StiffnessReduction> create(const Options& options);

  /// The device's place at the next tick [m].   time O(1), no allocation
  void move(const Vec3& device) noexcept;
  /// The stiffness [N/m] for this tick.
  /// in   round_trip [ticks]; what is longer than most_delay, or than the path that is known, counts as that
  /// time O(1), no allocation
  double reduced(const Touch& touch, std::uint32_t round_trip) noexcept;
  /// Nothing is touched at this tick.
  void release() noexcept { is_touching_ = false; }

 private:
  explicit StiffnessReduction(const Options& options) : filter_(options.filter), path_(options.most_delay + std::size_t{1}) {}
  const Vec3& place(std::uint32_t ago) const noexcept;

  double filter_;
  std::vector<Vec3> path_;  // ring
  std::size_t next_ = 0, known_ = 0;
  double mean_ = 0;  // [N/m]
  bool is_touching_ = false;
};

}  // namespace tactus
