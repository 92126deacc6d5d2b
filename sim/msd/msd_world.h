// SPDX-License-Identifier: Apache-2.0
/// The scene's one-dimensional objects (sim/msd/msd.h) in space: planes that give way along their normal. Thesis 4.3.1.
///
/// To trace, stream and client such an object is a rigid one that moves along one axis: its pose is that of its surface x'_o, which
/// stays for N ticks; its velocity is the mean of the last period. Probes press and never pull. A probe touches one object at a
/// time: the first one met, until it lets go.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/rigid/rigid_state.h>
#include <tactus/sim/contact/contact.h>
#include <tactus/sim/msd/msd.h>
#include <tactus/sim/rigid/rigid_world.h>
#include <tactus/sim/scene/scene.h>

namespace tactus::sim {

class MsdWorld {
 public:
  /// pre  the scene has such objects.
  /// err  invalid R-SIM-3: together, the users' springs are as stiff as eq. 4.38 allows, or stiffer
  static Result<std::unique_ptr<MsdWorld>> create(const Scene& scene);

  /// Begin a tick: state of every object.   out  one each
  void observe(std::span<RigidSample> objects) noexcept;
  /// Move a probe at the server [m]; none: it is held by something else.
  /// out  the force of G_s; contact.object counts from the scene's first object
  /// time O(objects); no allocation, as in all that follows.
  Touch touch_server(std::size_t user, const std::optional<Vec3>& device) noexcept;
  /// The same at the client, where the objects are seen there.   in  poses  one each   out  [N] on the hand, of G_c
  Vec3 touch_client(std::size_t user, const std::optional<Vec3>& device, std::span<const Pose> poses) noexcept;
  /// Let a force [N] act in this tick.   in  object  counted from the first one here
  void push(std::size_t object, const Vec3& force) noexcept;
  /// End the tick; every N-th one deforms.   err  invalid_argument R-SIM-1: a surface is beyond 1e4 m
  tl::expected<void, StepError> step();

 private:
  struct Body {
    SceneMsd spec;
    MsdLoop loop;

    double depth(const Vec3& point) const noexcept { return dot(spec.position - point, spec.normal); }
  };
  using Touched = std::optional<std::size_t>;  // body

  explicit MsdWorld(const Scene& scene);

  std::vector<Body> bodies_;
  std::vector<Touched> server_, client_;  // one per user
  std::uint32_t first_;                   // index of the first body among the trace's objects
  double stiffness_ = 0;                  // of the coupling [N/m]
  std::int64_t tick_ = 0;
};

}  // namespace tactus::sim
