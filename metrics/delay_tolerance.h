// SPDX-License-Identifier: Apache-2.0
/// How much delay a recorded touch tolerates until the user feels it, by thesis 4.2.2: a client that learns of the object's motion a round
/// trip R late renders |df| = k R v_p more force (eq. 4.17) than the server, whose force f_s is what should be rendered (eq. 4.15). That
/// stays under the Weber fraction c up to
///
///   R_max = c |f_s| / (k v_p)                                                                                      eqs. 4.20, 4.31
///
/// v_p is the speed of the device against f_s: motion along a surface stretches nothing. Equation 4.31 takes force and speed along the
/// motion, which is the same where they are parallel. Who does not go against the force feels no delay.
/// A deformable object follows a fraction K < 1 of the displacement only (eq. 4.54) and tolerates 1 / K times as much.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <tactus/trace/frame.h>

namespace tactus {

class DelayTolerance {
 public:
  static constexpr std::array kRoundTrips{0.010, 0.025, 0.050, 0.075, 0.100, 0.150};  ///< [s]

  /// in   weber  c, above 0
  DelayTolerance(const TraceInfo& info, double weber) : weber_(weber), tick_(1.0 / info.tick_rate), users_(info.users.size()) {}

  /// What touches what.
  struct Pair {
    std::uint32_t user = 0;
    bool is_mesh = false;
    std::uint32_t object = 0;  ///< or mesh
    friend bool operator<(const Pair& a, const Pair& b) noexcept {
      return std::tie(a.user, a.is_mesh, a.object) < std::tie(b.user, b.is_mesh, b.object);
    }
  };
  /// K of what a user touches, 0 to 1.
  using Follows = std::function<double(const Pair&, const UserSample&)>;
  /// in   follows  none: K is 1, also of what is deformable
  /// pre  ticks increase.   time O(users)
  void add(const TraceFrame& frame, const Follows& follows = {});

  class Touch {
   public:
    void add(std::optional<double> most, double follows);
    std::uint64_t ticks() const noexcept { return ticks_; }
    std::uint64_t pressing() const noexcept { return pressing_; }  ///< ticks in which delay adds force
    /// [s] R_max that a fraction of the pressing ticks does not reach, within kBin; none: longer than kLongest, or nobody pressed
    std::optional<double> quantile(double fraction) const noexcept;
    /// Fraction of all ticks in which a round trip of kRoundTrips[i] is perceptible.
    double perceptible(std::size_t i) const noexcept;

    double follows() const noexcept { return ticks_ == 0 ? 1 : follows_ / static_cast<double>(ticks_); }  ///< mean of K

    static constexpr double kBin = 1e-4, kLongest = 1;  ///< [s]

   private:
    std::uint64_t ticks_ = 0, pressing_ = 0;
    double follows_ = 0;  // sum
    std::array<std::uint64_t, kRoundTrips.size()> perceptible_{};
    std::map<std::uint32_t, std::uint64_t> bins_;  // by their number; only those with ticks
  };
  const std::map<Pair, Touch>& touches() const noexcept { return touches_; }

 private:
  /// Where a device was in the last ticks: its velocity is that of 8 ms, or of one tick where they are longer.
  struct Path {
    std::vector<std::pair<std::int64_t, Vec3>> positions;  // oldest first
    std::optional<Vec3> velocity(double tick) const noexcept;
  };

  double weber_, tick_;  // [s]
  std::vector<Path> users_;
  std::map<Pair, Touch> touches_;
};

/// R_max [s]; none: the device does not move against the force.
/// in   force [N] on the hand at the server; velocity [m/s] of the device; stiffness [N/m] > 0 of the coupling
std::optional<double> tolerable_round_trip(const Vec3& force, const Vec3& velocity, double stiffness, double weber) noexcept;

}  // namespace tactus
