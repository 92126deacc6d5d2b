// SPDX-License-Identifier: Apache-2.0
/// Stability of the deformation loop at the server (loop 1 of thesis figure 4.14), by simulation and by its poles.
#pragma once

#include <cstdint>

#include <tactus/sim/msd/msd.h>
#include "lab/study/study.h"

namespace tactus::sim::study {

/// `users` hands that press with k_s each, the k-th one from the k-th second on.
struct ServerLoop {
  MsdObject object;
  double tick = 1e-3;  ///< T_s [s]
  std::uint32_t divider = 10;
  std::uint32_t users = 1;
  Decimator decimator = Decimator::mean;
  Approach approach = Approach::at_once;

  double period() const noexcept { return divider * tick; }
  MsdLoopOptions options(double stiffness) const;  ///< k_s of every user [N/m]
};

/// Every hand steps 1 mm into the object and stays.
///   diverges  the surface moves beyond 1e6 times the sum of the steps within 20 000 deformation periods
///   stable    in the last quarter it stays within a tenth of how far it strayed in the first quarter
/// time O(users N), 1.5 ns each, 20 000 times
Verdict step_response(const ServerLoop& loop, double stiffness);

/// Largest k_s per user [N/m] with a step response that does not diverge, to a relative 1e-4.
double measured_limit(const ServerLoop& loop);

/// Largest magnitude of the closed loop's poles: eq. 4.36, with the model's linear approach to a new surface where that is chosen.
double spectral_radius(const ServerLoop& loop, double stiffness) noexcept;

/// Largest k_s per user [N/m] by Jury's criterion. With a linear approach, the mean of the forces has a weight
/// a = (N+1)/(2N) of the new surface and 1-a of the one before, and Jury's criterion yields
///   min( (k_o + b_o/T_n) / (1-a),  N (k_o + 2 b_o/T_n + 4 m_o/T_n^2) )
double jury_limit(const ServerLoop& loop) noexcept;

}  // namespace tactus::sim::study
