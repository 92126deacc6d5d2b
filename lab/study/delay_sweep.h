// SPDX-License-Identifier: Apache-2.0
/// Round trips, networks and clients: what delay does to the force and to what is seen, without compensation, with the thesis's, and with clients
/// that simulate the scene themselves. All of it is deterministic.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lab/study/delay.h"

namespace tactus::sim::study {

/// What clients do about delay.
enum class Clients : std::uint8_t {
  plain,       ///< nothing
  stiffness,   ///< CompensationMethod::stiffness
  printed,     ///< CompensationMethod::stiffness_thesis
  simulation,  ///< CompensationMethod::simulation
  misled,      ///< the same, and what they know of the scene is wrong: mass, friction, stiffness and Young's modulus by +10 %
};
inline constexpr std::array kClients{Clients::plain, Clients::stiffness, Clients::printed, Clients::simulation, Clients::misled};
const char* name(Clients clients) noexcept;

struct DelayPoint {
  Microseconds round_trip = 0;
  bool varies =
      false;  ///< half of it gamma distributed, a new value each 0.5 s (thesis 4.2.4.3), behind adaptive playout; else all of it constant
  std::uint64_t seed = 1;
};

/// Of a user; nan: there is nothing to measure, as nothing is touched, or no other user looks there. Small and flat, so that it passes
/// through a pipe.
struct DelayNumbers {
  // Hands that feel the force, against the same hand without delay.
  float mean = 0, peak = 0;  ///< of the force, over that without delay: 0.1 is 10 % more
  float outside = 0;         ///< fraction of the contact in which it is more than 10 % off
  float energy = 0;          ///< [J] least that the device has put in
  // The devices of the run without delay, played back: the same motion.
  float force_error = 0;  ///< RMS of the error over RMS of the force
  float seen = 0;         ///< [m] where the touched point is shown, from where it would be without delay: RMS
  float most_seen = 0;    ///< [m] 95th percentile of it
  float apart = 0;  ///< [m] where the other user sees the object that both look at, from where this one does: 95th percentile
};

inline constexpr std::size_t kMostSweepUsers = 2;
using DelayResult = std::array<std::array<DelayNumbers, kMostSweepUsers>, kClients.size()>;

/// All clients at one point.   pre  the scene has 1 to kMostSweepUsers users   err  of Simulation
tl::expected<DelayResult, Diagnostic> run_point(const Scene& scene, const DelayPoint& point);

}  // namespace tactus::sim::study
