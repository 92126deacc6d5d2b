// SPDX-License-Identifier: Apache-2.0
/// What `tactus bench precision` computes: deformable objects under loads that vary smoothly, and the methods, solvers and step sizes
/// that are compared on them.
///
/// scene            object                                                       omega_max h at 1 ms
/// membrane         slab of 16 x 20 x 1 cells of 1 cm, eight fixed corners       0.58: explicit is stable
/// membrane-stiff   the same with E x 1000                                       18.3: explicit needs a tenth of the step
/// cantilever       beam 1 x 0.2 x 0.2 m, clamped at x = 0, load on the tip      2.1: explicit is just not stable
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/sim/fem/integrator.h>
#include <tactus/sim/fem/model.h>
#include "lab/study/study.h"

namespace tactus::sim::study {

/// Vertices that share a load, and their weights; the same weights average their displacement, so load and displacement do work on
/// each other.
struct Patch {
  std::vector<std::uint32_t> vertices;
  std::vector<double> weights;  ///< sum 1

  double deflection(const Eigen::VectorXd& u) const noexcept;       ///< mean z displacement [m]
  void add_force(double force, Eigen::VectorXd& f) const noexcept;  ///< along z [N]
};

/// A rigid plate on a given path that presses the patch down: force = stiffness x penetration (thesis eq. 2.6), never pulling.
struct Probe {
  double stiffness = 700;  ///< [N/m]
  double depth = 0.02;     ///< [m] its path is -depth sin^2(pi t / (2 duration)): starts in touch and at rest, ends at rest
};

struct PrecisionScene {
  std::string name, title;
  TetMesh mesh;
  Material material;
  std::vector<std::uint32_t> fixed;
  Patch patch;
  double load = 1;  ///< [N] amplitude of -sin^2(2 pi t) on the patch
  Probe probe;
  double duration = 0.5;
  int samples = 5;                     ///< errors are taken at so many evenly spaced times, the last one at the end
  std::vector<int> steps_per_sample;   ///< the step sizes: each meets every sample time exactly
  int reference_steps_per_sample = 0;  ///< of the Runge-Kutta reference; a multiple of 4

  double step(int per_sample) const noexcept { return duration / samples / per_sample; }
};

/// The scene of that name, or nothing. In brief: a coarse mesh, a fifth of the time, fewer step sizes.
std::optional<PrecisionScene> precision_scene(std::string_view name, Extent extent);
inline constexpr const char* kPrecisionScenes[] = {"membrane", "membrane-stiff", "cantilever"};

/// One line of a work-precision diagram: everything but the step size.
struct PrecisionMethod {
  std::string name;  ///< "Newmark 2x prefactored": at most two iterations per stage; "Newton": until converged
  IntegratorOptions options;
  Elasticity elasticity = Elasticity::corotated;
  bool chosen = false;  ///< what choose() takes for the object and the step; `options` are not used
};
std::vector<PrecisionMethod> precision_methods(Extent extent);

}  // namespace tactus::sim::study
