// SPDX-License-Identifier: Apache-2.0
/// One-dimensional deformable object pressed by several users; it is deformed at a lower rate than the haptic one. Thesis 4.3.1,
/// figures 4.14 and 4.15.
///
///   rate 1/T_s           every client                      server                            rate 1/T_n, T_n = N T_s
///   x_d ──T_f──────────> f_s = G_s (x_d - x'_o)  ──decimator──>  D_o(z)  ──T_c = z^-1──> x'_o ──┬──> server, next period
///   f_c = G_c (x'_o - x_d) <──────────────────────T_b───────────────────────────────────────────┘
///
/// Positions grow into the object: x_d > x'_o is a penetration. Its surface rests at 0.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace tactus::sim {

struct MsdObject {
  double stiffness = 0;  ///< k_o [N/m]
  double damping = 0;    ///< b_o [N s/m]
  double mass = 0;       ///< m_o [kg], positive
};

/// Largest sum of the users' k_s that is stable with deformation period T_n: k_o + 2 b_o / T_n + 4 m_o / T_n^2.   eqs. 4.37, 4.38
constexpr double critical_stiffness(const MsdObject& o, double period) noexcept {
  return o.stiffness + 2 * o.damping / period + 4 * o.mass / (period * period);
}

/// D_o(z), eq. 4.35: backward differences of m_o x'' + b_o x' + k_o x = f.
class MsdModel {
 public:
  /// in   period  T_n [s]
  MsdModel(const MsdObject& object, double period) noexcept;

  /// x_o(n) [m] under f(n) [N].   time O(1)
  double step(double force) noexcept;

 private:
  double now_, before_, older_;  // factors of x(n), x(n-1), x(n-2) [N/m]
  double last_ = 0, second_last_ = 0;
};

/// How the N forces of a period are combined for the deformation.
enum class Decimator : std::uint8_t { mean, last };
/// How a low-rate surface position is used at the high rate: at once, or approached linearly over the period.
enum class Approach : std::uint8_t { at_once, linear };
/// Tied: G_s and G_c pull, too, so that the loop is linear as in the analysis. Pressing: a probe outside feels nothing.
enum class Coupling : std::uint8_t { tied, pressing };

struct MsdUser {
  double server_stiffness = 0;    ///< k_s [N/m]
  double client_stiffness = 0;    ///< k_c [N/m]
  double client_damping = 0;      ///< b_c [N s/m]
  std::uint32_t to_server = 0;    ///< T_f in ticks
  std::uint32_t from_server = 0;  ///< T_b in ticks
};

/// x_d of a hand that touches nothing, tied or not.
inline constexpr double kAway = -std::numeric_limits<double>::infinity();

struct MsdLoopOptions {
  MsdObject object;
  double tick = 1e-3;         ///< T_s [s]
  std::uint32_t divider = 1;  ///< N
  Decimator decimator = Decimator::mean;
  Approach server = Approach::at_once;  ///< of the intermediate models
  Approach client = Approach::at_once;
  Coupling coupling = Coupling::tied;
  std::vector<MsdUser> users;

  double period() const noexcept { return divider * tick; }  ///< T_n [s]
};

/// The loop of figure 4.14 without hands: device positions in, forces out.   time O(users) per tick; no allocation.
class MsdLoop {
 public:
  /// pre  divider, mass and tick are positive
  explicit MsdLoop(const MsdLoopOptions& options);

  /// Advance by one tick.
  /// in   device  x_d of every user [m], or kAway
  void step(std::span<const double> device) noexcept;

  /// The same in parts, for callers with a network of their own: begin_tick(), any of the three, end_tick().
  void begin_tick() noexcept;  ///< surface() is then that of this tick
  /// G_s: force on the hand of a user [N], positive into the object.
  double press(std::size_t user, double device) const noexcept;
  /// G_c: likewise at the client, which received this surface x'_o [m].
  double feel(std::size_t index, double device, double received) noexcept {
    return feel(index, device, received, users_[index].spec.client_stiffness);
  }
  /// With another stiffness [N/m] than the user's k_c at this tick.
  double feel(std::size_t index, double device, double received, double stiffness) noexcept;
  void load(double force) noexcept { last_ += force; }  ///< on the object in this tick [N]; forces add up
  void end_tick() noexcept;

  /// Force on the hand of a user [N], positive into the object; after step().
  double rendered_force(std::size_t user) const noexcept { return users_[user].rendered; }
  /// Surface as the server's forces use it [m].
  double surface() const noexcept { return server_.value; }
  /// Mean velocity of the surface over the last period [m/s].
  double velocity() const noexcept { return (server_.to - server_.from) / options_.period(); }

 private:
  /// A signal some ticks ago; before the first sample it is 0.
  class Delay {
   public:
    explicit Delay(std::uint32_t ticks) : ring_(ticks) {}
    double pass(double sample) noexcept;

   private:
    std::vector<double> ring_;
    std::size_t next_ = 0;
  };
  /// A low-rate signal used at the high rate.
  struct Intermediate {
    Approach approach;
    double from = 0, to = 0, value = 0;
    std::uint32_t age = 0;  // ticks since `to` came

    void receive(double sample) noexcept;
    void advance(std::uint32_t divider) noexcept;
  };
  struct User {
    MsdUser spec;
    Delay forward, backward;
    Intermediate model;
    double penetration = 0, rendered = 0, sent = 0;
  };

  MsdLoopOptions options_;
  MsdModel model_;
  Intermediate server_;
  std::vector<User> users_;
  double sum_ = 0, last_ = 0;  // of the forces in this period [N]
  std::uint32_t phase_ = 0;    // ticks of this period that are done
};

}  // namespace tactus::sim
