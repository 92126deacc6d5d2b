// SPDX-License-Identifier: Apache-2.0
/// Converts a trace into a scene, and its frames into a sender's input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/sender.h>
#include <tactus/trace/frame.h>

namespace tactus {

/// Coding options of a trace's objects, with the defaults of SceneBuilder; the trace sets the frame periods of the deformable ones.
struct TraceCoding {
  DeformableCoding deformable{};
  std::uint8_t spring_modes = 0;  ///< main: modes of the basis that both ends compute for each object
  std::function<Result<ModeBasis>(const TraceDeformable&)> basis{};  ///< main: makes each object's basis; empty: without
  std::map<std::string, ClusterBasis> clusters{};                    ///< main: of the objects of these names, see find_clusters()
  RigidProfile rigid = RigidProfile::main;
};

/// Declares a deformable object.   err  those of the basis; R-API-9 spring_modes are not less than the free components
Result<void> add_deformable(SceneBuilder& scene, const TraceDeformable& mesh, const TraceCoding& coding);

/// The scene of a trace: its objects in order, at rest in the poses of `first`, and its deformable objects.
/// err  invalid_argument R-API-5 wrong count; those of a basis
Result<SceneBuilder> scene_builder(const TraceInfo& info, const TraceFrame& first, const TraceCoding& coding = {});

/// The same for a sender of these options: it promises the bounds that the sender keeps, on which its coding may depend.
Result<SceneBuilder> scene_builder(const TraceInfo& info, const TraceFrame& first, const TraceCoding& coding,
                                   const SenderOptions& sender);

/// The touch that sets this object's haptic threshold: of several users, the one with the least force, as its threshold is the
/// lowest.
/// out  force is that of the coupling, k |x_p - x_d|
std::optional<SurfaceTouch> touch_of(const TraceFrame& frame, std::size_t deformable) noexcept;

/// Converts frames into a sender's input. Holds the lists that a Truth points to.
class FrameTruth {
 public:
  explicit FrameTruth(const TraceInfo& info) : contacts_(info.users.size()), deformables_(info.meshes.size()) {}

  /// Valid until the next call, and as long as the frame.   time O(users * deformable objects), no allocation
  /// pre  the frame is of the same trace
  Truth of(const TraceFrame& frame) noexcept;

 private:
  std::vector<Contact> contacts_;
  std::vector<DeformableTruth> deformables_;
};

}  // namespace tactus
