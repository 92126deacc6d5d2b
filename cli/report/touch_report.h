// SPDX-License-Identifier: Apache-2.0
/// What a simulation was like at each hand, and where its numbers say more about sampling than about the scene.
#pragma once

#include <cstdint>
#include <string>

namespace tactus::sim {
struct Scene;
class Simulation;
}  // namespace tactus::sim

namespace tactus::cli {

struct Report;

/// How a user touched what is there.
struct TouchReport {
  std::string user;
  double share = 0;                    ///< of the ticks, in contact
  std::uint64_t contacts = 0;          ///< begun
  std::uint32_t most_in_a_second = 0;  ///< of them
  double largest_force = 0;            ///< [N] felt
  double lowest_energy = 0;            ///< [J] of a contact, at most 0
};

/// One TouchReport for each user, and a warning for each that chatters, presses a deformable object harder than eq. 4.38 allows at
/// the place of the largest force, or was held by a coupling that its device's smoothing makes swing.
void report_touches(const sim::Scene& scene, const sim::Simulation& simulation, Report& report);

}  // namespace tactus::cli
