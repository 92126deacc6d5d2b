// SPDX-License-Identifier: Apache-2.0
/// The space error of meshes of linear tetrahedra under refinement: what remains wrong however small the time step.
///
/// membrane     slab of 16 x 20 x 1 cells of 1 cm and finer ones of the same shape; clamped over one coarse cell at each corner (a
///              clamped point would sink in without limit), loaded on 4 x 4 cm of the top
/// cantilever   beam 1 x 0.2 x 0.2 m clamped at x = 0, loaded on the tip
///
/// Refinement r divides every edge of the coarse mesh into r. The mean deflection of the loaded patch is compared: under a static load
/// on the undeformed object, and in time with co-rotated elements under -sin^2(2 pi t). The limit of the static deflection comes from
/// quadratic elements (quadratic_tets.h); in time, the finest mesh takes its place.
#pragma once

#include "lab/study/precision_scene.h"

namespace tactus::sim::study {

/// The object at refinement r with Poisson's ratio nu; nothing for an unknown name ("membrane" or "cantilever").
std::optional<PrecisionScene> space_scene(std::string_view name, int refinement, double poisson);

/// Tip deflection of a beam per newton: F L^3 / (3 E I) + F L / (5/6 G A).
double timoshenko_deflection(double length, double width, double height, const Material& material);

struct StaticResult {
  double deflection = 0;  ///< [m] of the patch per newton
  double seconds = 0;     ///< processor time, assembly, factorisation and solution
};
/// err  as FemModel::create; R-FEM-7 when too little is fixed
tl::expected<StaticResult, Diagnostic> static_deflection(const PrecisionScene& scene);

/// One mesh to compute.
struct SpaceJob {
  int refinement = 1;
  double poisson = 0.45;
  bool transient = false;  ///< in time, too
  bool quadratic = false;  ///< with quadratic elements, too
};
std::vector<SpaceJob> space_jobs(std::string_view name, Extent extent);

struct SpacePoint {
  int refinement = 1;
  double poisson = 0.45;
  std::size_t vertices = 0, tets = 0;
  StaticResult at_rest;
  double quadratic_deflection = 0;  ///< [m] of the patch per newton; 0: not computed
  double step = 0;                  ///< [s] half of what is stable; 0: not computed in time
  double seconds_per_second = 0;    ///< processor time per simulated time
  std::vector<double> deflection;   ///< [m] at the sample times
};
/// In time by velocity Verlet, whose time error is far below the space error (precision.h).
tl::expected<SpacePoint, Diagnostic> measure_space(std::string_view name, const SpaceJob& job);

}  // namespace tactus::sim::study
