// SPDX-License-Identifier: Apache-2.0
/// Error against run time of one method at one step size: the time error. What the mesh itself gets wrong is in precision_space.h.
///
/// error             relative 2-norm over all sample times of
/// displacement      u, all vertices; `displacement_end`: at the last sample time only
/// velocity          v, all vertices
/// weight            u under self weight applied at once, in all as much as the load
/// push              u under the load applied at once, which excites every motion the mesh has
/// force             the force of a probe that presses the patch down
/// energy            elastic and kinetic energy
///
/// The reference is the same mesh under the Runge-Kutta method of order 4, which is not among the methods compared. It does not hold
/// forces over its steps. Half and a quarter as many steps yield the reference's own error (Richardson) and its order.
/// The methods hold external forces over a step, so each gets them where that costs it no order: the one-sided methods those at the
/// end, the others those in the middle. At that time the probe's penetration is predicted from the velocity at the beginning of the
/// step.
#pragma once

#include "lab/study/precision_scene.h"

namespace tactus::sim::study {

/// Processor time of this thread [s]: other work on the machine does not count.
double processor_seconds() noexcept;

enum class Loading { force, probe, weight, push };

/// One simulation from rest, seen at the sample times.
struct Trajectory {
  std::vector<Eigen::VectorXd> u;  ///< [m] per sample time
  std::vector<Eigen::VectorXd> v;  ///< [m/s]
  Eigen::VectorXd energy;          ///< [J] per sample time
  Eigen::VectorXd force;           ///< [N] per sample time, of the probe
  double setup_seconds = 0;        ///< processor time of this thread: integrator made, factored, first step
  double step_seconds = 0;         ///< the other steps, scaled to all of them
  double newton_per_step = 0;      ///< iterations
  double solver_per_step = 0;
  int unconverged_steps = 0;  ///< Newton ran out of iterations
  std::string taken;          ///< if the method was chosen: which one
};

/// The error's step counts from 0 at rest.
tl::expected<Trajectory, Diagnostic> simulate(const PrecisionScene& scene, const PrecisionMethod& method, int steps_per_sample,
                                              Loading loading);

/// The same under the Runge-Kutta method of order 4.
tl::expected<Trajectory, Diagnostic> runge_kutta(const PrecisionScene& scene, int steps_per_sample, Loading loading);

struct Errors {
  double displacement_end = 0, displacement = 0, velocity = 0, force = 0, energy = 0, weight = 0, push = 0;  ///< relative; NaN:
                                                                                                             ///< the run stopped
};

struct Reference {
  Trajectory load, probe, weight, push;
  Errors floor;      ///< of the reference itself, estimated
  double order = 0;  ///< observed, of the displacement
  double step = 0;   ///< [s]
};
tl::expected<Reference, Diagnostic> make_reference(const PrecisionScene& scene);

struct PrecisionPoint {
  std::string method;
  int steps_per_sample = 0;
  double step = 0;  ///< [s]
  Errors errors;
  double seconds_per_second = 0;  ///< processor time per simulated time, median
  double setup_seconds = 0;
  int runs = 0;  ///< behind the medians
  double newton_per_step = 0, solver_per_step = 0;
  int unconverged_steps = 0;
  std::string taken;   ///< if the method was chosen: which one
  std::string remark;  ///< why it stopped and there are no errors; "probe: ..." when only the force is missing
};

/// How often a run is timed after a warm-up. If that takes longer than `longest_repeated` [s], it is the only run timed.
struct Timing {
  int runs = 5;
  double longest_repeated = 1;
};
PrecisionPoint measure(const PrecisionScene& scene, const PrecisionMethod& method, int steps_per_sample,
                       const Reference& reference, const Timing& timing);

}  // namespace tactus::sim::study
