// SPDX-License-Identifier: Apache-2.0
/// What a RigidWorld knows of its own error, over all steps so far.
#pragma once

#include <cstdint>
#include <vector>

namespace tactus::sim {

/// The largest of a quantity, and where it was.
struct Worst {
  double value = 0;
  std::int64_t tick = -1;    ///< -1: never above zero
  std::uint32_t object = 0;  ///< index over the scene's objects

  void add(double other, std::int64_t at, std::uint32_t of) noexcept {
    if (other > value) *this = {other, at, of};
  }
};

struct RigidErrors {
  /// Of one object.
  struct Object {
    double penetration = 0;  ///< [m] deepest into floor or another object, beyond the 10 um in which bodies rest
    double drift = 0;  ///< [m] farthest while it lay or stood, nobody pushed it or what it touches, and it was slower than 1 mm/s
    double flight = 0;  ///< [J] largest change of its energy while it touched nothing, unpushed and undamped
  };
  std::vector<Object> objects;     ///< all of the scene; zero for those that never move
  Worst penetration;               ///< [m] the deepest
  Worst drift;                     ///< [m] the farthest
  Worst flight;                    ///< [J] the largest
  Worst residual;                  ///< [m/s] speed of approach that the solver left at a contact
  Worst unswept;                   ///< [m/s] of an object so fast that it may pass others unnoticed
  std::uint64_t steps = 0;         ///< of groups of touching objects
  std::uint64_t solved_again = 0;  ///< of them, with more effort than others
  std::uint64_t unsolved = 0;      ///< of them, with a residual or an energy above what 2 mm/s amount to all the same
  double contact_energy = 0;       ///< [J] that contacts gave in all: pushing out what is too deep, and what the solver makes
  double momentum = 0;             ///< [N s] largest that no force, floor or static object gave in a step
};

}  // namespace tactus::sim
