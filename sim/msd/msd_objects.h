// SPDX-License-Identifier: Apache-2.0
/// The scene's one-dimensional objects (sim/msd/msd.h: masses on springs and dampers) in space: planes that yield along their
/// normal. Thesis 4.3.1.
///
/// To trace, stream and client such an object is a rigid one that moves along one axis: its pose is that of its surface x'_o, which
/// stays for N ticks; its velocity is the mean of the last period. Probes press and never pull. Their numbers among the trace's objects
/// follow those of the rigid objects.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/sim/msd/msd.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/touchable.h>

namespace tactus::sim {

/// One object, and its loop between device and surface.
struct MsdBody {
  SceneMsd spec;
  MsdLoop loop;

  double depth(const Vec3& point) const noexcept { return dot(spec.position - point, spec.normal); }
};

class MsdObjects final : public Simulated {
 public:
  /// pre  the scene has such objects.
  /// err  invalid R-SIM-3: the sum of the users' springs reaches or exceeds the limit of eq. 4.38
  static Result<std::unique_ptr<MsdObjects>> create(const Scene& scene);

  /// Also begins the tick of the loops.
  void observe(TraceFrame& frame) noexcept override;
  Touch touch(std::size_t user, const DeviceSample& device, bool held) noexcept override;
  void push(std::size_t user, double fraction) noexcept override;
  /// Every N-th call deforms.   err  invalid_argument R-SIM-1: a surface is beyond 1e4 m
  tl::expected<void, Diagnostic> step() override;

 private:
  explicit MsdObjects(const Scene& scene);

  std::vector<MsdBody> bodies_;
  std::vector<std::optional<std::size_t>> touched_;  // body, per user
  std::vector<Vec3> forces_;                         // [N] on the hand in this tick, per user
  std::uint32_t first_;                              // index of the first body among the trace's objects
  double stiffness_ = 0;                             // of the coupling [N/m]
  std::int64_t tick_ = 0;
};

/// At a client: G_c between the device and the received surface.
class MsdView final : public Touchable {
 public:
  explicit MsdView(const Scene& scene);

  /// in  object  counted from the first one here
  void show(std::size_t object, const Pose& pose) noexcept { poses_[object] = pose; }
  Touch touch(std::size_t user, const DeviceSample& device, bool held) noexcept override;

  std::span<const Pose> poses() const noexcept { return poses_; }

 private:
  std::vector<MsdBody> bodies_;
  std::vector<std::optional<std::size_t>> touched_;
  std::vector<Pose> poses_;
  std::uint32_t first_;   // index of the first body among the trace's objects
  double stiffness_ = 0;  // of the coupling [N/m]
};

}  // namespace tactus::sim
