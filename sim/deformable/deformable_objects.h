// SPDX-License-Identifier: Apache-2.0
/// The scene's deformable objects: finite elements at a low rate, forces at the haptic rate. Thesis 2.3.4.2, 3.3.2, figure 4.14.
///
///   every tick         server   proxy on the surface x'_o as the last deformation left it: f_s = k_s (x_p - x_d)
///                      client   proxy on the same surface, when N > 1 on a cut-out of it that approaches it linearly over one
///                               period (sim/contact/intermediate_model.h): f_c, rendered to the hand
///   every N-th tick    D_o      one step of T_n = N T_s under the mean of the forces -f_s of its N ticks, each spread over the
///                               corners of the triangle touched by its barycentric weights, and gravity
///                      T_c      its result is x'_o of the next period: the one-step delay of the loop (eqs. 4.36, 4.38)
///
/// An interface, so that a scene without deformables makes no such object and a build without finite elements needs no part of it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <tactus/sim/deformable/elastic_physics.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/touchable.h>
#include <tactus/trace/frame.h>

namespace tactus::sim {

/// Human-readable solver summary of an object.
struct DeformableInfo {
  std::string name;
  std::size_t vertices = 0;
  std::string method;            ///< "tr-bdf2, prefactored"
  std::string reason;            ///< why
  double step = 0;               ///< T_n [s]
  double largest_frequency = 0;  ///< [rad/s] at rest; 0: not measured, as the scene names the method
  ElasticStep shared{};          ///< what comes nearest to it at a client that steps the object itself
};

/// Cost of a deformation [s]: wall clock, and CPU time of all threads of the process.
struct DeformationTime {
  double wall = 0, cpu = 0;
};

/// Error of single deformation steps by step doubling, as fractions of the motion in a step (sim/fem/error_estimate.h), and the energy error
/// of all together.
struct DeformableError {
  double of_motion = 0, most_of_motion = 0;
  std::int64_t samples = 0;
  double energy = 0;  ///< gained without cause, relative to all energy that moved (sim/fem/error_estimate.h); negative: lost
};

class DeformableObjects : public Simulated {
 public:
  /// Write the current shapes to the frame. `updated` is set if the last tick computed a shape, which it does not while the
  /// object rests, or if a shape is due and report_at_rest is set.
  void observe(TraceFrame& frame) noexcept override = 0;
  /// Advance by one tick.   time of an object that rests and whose probes are far: O(users); no allocation after the first deformation
  /// err  invalid_argument R-FEM-6, internal R-FEM-7 with element and remedy; the shapes before the step are kept
  tl::expected<void, Diagnostic> step() override = 0;

  /// True if a shape of this object is due now, computed or not.
  virtual bool is_due(std::size_t object) const noexcept = 0;
  /// The same objects at clients that see the truth at once.   pre  DeformableOptions::true_views
  virtual Touchable& true_view() noexcept = 0;

  virtual std::span<const TraceDeformable> meshes() const noexcept = 0;  ///< surfaces at rest
  virtual std::span<const DeformableInfo> info() const noexcept = 0;
  virtual DeformationTime time(std::size_t object) const noexcept = 0;         ///< of its last deformation, with surface and tree
  virtual std::optional<DeformableError> error(std::size_t object) const = 0;  ///< when asked for in the options
  /// [J] Kinetic and elastic energy of its last shape, and gravity's since its rest shape.   time of one evaluation per deformation
  virtual double energy(std::size_t object) noexcept = 0;
};

struct DeformableOptions {
  bool true_views = true;            ///< clients see what is computed; else they have a DeformableView
  std::uint32_t estimate_every = 0;  ///< estimate the local error of every n-th deformation, 0: of none
  int parts = 1;                     ///< of each step
  bool as_bodies = false;            ///< touched as clients touch elastic bodies that they step themselves (deformable_probes.h)
  bool report_at_rest = false;       ///< observe() reports every shape that is due, also of sleeping objects
};

/// pre  the scene has deformables.
/// err  unsupported R-SIM-2: this build has no finite elements; R-TET-n, R-FEM-1..4, 7, 8: the scene asks for an invalid object
Result<std::unique_ptr<DeformableObjects>> make_deformable_objects(const Scene& scene, const DeformableOptions& options);

}  // namespace tactus::sim
