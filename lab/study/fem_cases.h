// SPDX-License-Identifier: Apache-2.0
/// Deformable objects in extreme states, and how each method of integration copes with them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactus/sim/fem/integrator.h>
#include "lab/study/study.h"

namespace tactus::sim::study {

struct FemCase {
  std::string name;
  TetMesh mesh;
  FemOptions options;
  FemState start;      ///< of every vertex
  double step = 1e-3;  ///< [s]
  std::int64_t steps = 1000;
  double gravity = 0;  ///< [m/s^2] along -z
};

struct FemOutcome {
  Verdict verdict = Verdict::stable;
  bool refused = false;        ///< before the first step: material, mesh or method
  std::string error;           ///< step, element, rule and remedy
  std::int64_t steps = 0;      ///< done
  std::size_t inverted = 0;    ///< tetrahedra inside out at the end
  double energy = 0;           ///< kinetic and elastic at the end, as a fraction of the beginning
  std::size_t not_finite = 0;  ///< states with NaN or infinity that left a step
  bool kept_state = true;      ///< after an error the state is that before the step, bit by bit
  double farthest = 0;         ///< [m] largest displacement at the end
  std::string taken;           ///< method and solver
  double drift = 0;            ///< [m] largest change of a displacement over the second half of the steps
};

/// Run a case without forces but its weight.
///   stable    it went through all steps, energy did not grow, nothing is inside out
///   limit     the same, but tetrahedra stay inside out
///   diverges  an error, or energy is more than ten times what it was (that of velocity Verlet swings below its limit)
/// in   method  with the solver that a scene with this method gets (suited()); none: the choice of choose()
FemOutcome run(const FemCase& fem_case, std::optional<Method> method);

/// The extremes, on a slab of 4 x 5 x 1 cells of 1 cm with fixed corners, E 10 kPa, nu 0.45, 10 000 kg/m^3, damped by mass (20/s).
/// in   extent  brief: 2 x 2 x 1 cells and a fifth of the steps
std::vector<FemCase> fem_cases(Extent extent);

/// That slab, displaced at random by up to `amplitude` [m] and let go.
FemCase shaken_slab(Extent extent, const Material& material, double amplitude);

/// Largest step [s] with which velocity Verlet stays bounded over 4000 steps, to a relative 1e-3.
/// pre  FemCase::options has no damping
double largest_explicit_step(FemCase fem_case);

}  // namespace tactus::sim::study
