// SPDX-License-Identifier: Apache-2.0
/// A trace as a scene, its frames as a sender's input, and what a client shows as a trace.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/client/replica.h>
#include <tactus/scene/scene.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/scene/scene_objects.h>
#include <tactus/sender.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/trace_file.h>

namespace tactus {

// ==== trace scene ====
// Converts a trace into a scene, and its frames into a sender's input.

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

/// The same for a sender of these options: it declares the bounds that the sender keeps, on which its coding may depend.
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

// ==== trace clusters ====
// The clusters of a trace's meshes: a basis for bodies that turn and walk.

/// Reads the whole trace and finds the clusters of each mesh that moves, by name, on shapes that are spread over it evenly.
/// err  those of the reader and of motion_clusters()
/// time of reading, and that of motion_clusters() for up to twice kClusterShapes shapes, fewer of a mesh of more than 100 000 vertices
Result<std::map<std::string, ClusterBasis>> find_clusters(TraceReader& reader, std::size_t count);

// ==== trace replica ====
// What a client shows, as a trace: the other way round than trace_scene.h.

/// The objects of a scene, and the bounds that it declares; no users.
TraceInfo replica_info(const Scene& scene, std::string source);

/// A frame with room for the objects of a scene; shapes are at rest.
TraceFrame replica_frame(const Scene& scene);

/// Poses and shapes that a replica shows at a tick; a shape is new if any vertex is elsewhere than in the frame. A replica has no
/// velocities of its own.
/// pre  all are of the same scene   time O(objects + vertices)
void take_shown(Replica& replica, const Scene& scene, std::int64_t tick, TraceFrame& frame);

}  // namespace tactus
