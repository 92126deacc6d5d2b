// SPDX-License-Identifier: Apache-2.0
/// Recordings for the 3-D panels of Foxglove and Lichtblick: MCAP with scene updates, transforms, and what plots need.
///
/// topic                        message                                        when
/// /tf                          foxglove_msgs/msg/FrameTransforms              each time that is written; frames objects/NAME, users/NAME,
///                                                                             meshes/NAME in "world"
/// /scene/objects               foxglove_msgs/msg/SceneUpdate                  the first time; entities that move with their frames
/// /scene/meshes/<name>         foxglove_msgs/msg/SceneUpdate                  the first time, and when the shape is new
/// /scene/users/<name>          foxglove_msgs/msg/SceneUpdate                  each time: device, touched point, forces
/// /objects/<name>/pose, /users/<name>/device, force, server_force             as in a trace (trace_file.h), each time that is written
/// A force that the trace does not know (RecordedForces) has neither topic nor arrow.
///
/// A viewer that jumps in time takes up the last message of every topic: what an entity needs is whole in the last message of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/base/tri_mesh.h>
#include <tactus/trace/frame.h>

namespace tactus::foxglove {

// ==== foxglove messages ====
// What the 3-D panels of Foxglove and Lichtblick draw, as messages of ROS 2: foxglove_msgs/msg/SceneUpdate and FrameTransforms.

struct Colour {
  double r = 0, g = 0, b = 0, a = 1;  ///< 0 to 1
};

struct Arrow {
  Vec3 from, along;  ///< [m] along: from its foot to its head, not zero
  double thickness;  ///< [m] of the shaft
  Colour colour;
};

struct Solid {
  Pose pose;
  Vec3 size;  ///< [m]
  Colour colour;
};

struct Triangles {
  std::span<const Vec3> points;  ///< [m]
  std::span<const Triangle> triangles;
  Colour colour;
  std::span<const Colour> colours;  ///< one per point, or none
};

/// What stays in place until the next entity of this id comes on the same topic.
struct Entity {
  std::string frame, id;
  bool moves_with_frame = false;  ///< else it stays where its frame was at its time
  std::vector<Arrow> arrows{};
  std::vector<Solid> cubes{}, spheres{};
  std::vector<Triangles> triangles{};
};

struct Transform {
  std::string_view child;
  Pose pose;  ///< of the child, in the world
};

inline constexpr std::string_view kWorld = "world";  ///< the frame that hangs on none

inline constexpr std::string_view kSceneUpdate = "foxglove_msgs/msg/SceneUpdate";
inline constexpr std::string_view kFrameTransforms = "foxglove_msgs/msg/FrameTransforms";
/// Definitions in the schema encoding `ros2msg`.
std::string scene_update_schema();
std::string frame_transforms_schema();

/// Write the CDR bytes of a message to `message`.   in  time  [ns] of the recording
void encode_scene_update(std::vector<std::uint8_t>& message, std::uint64_t time, std::span<const Entity> entities);
void encode_frame_transforms(std::vector<std::uint8_t>& message, std::uint64_t time, std::span<const Transform> transforms);

}  // namespace tactus::foxglove

namespace tactus {

// ==== foxglove writer ====

/// What a rigid object looks like, around its origin.
struct FoxgloveShape {
  Vec3 box{};         ///< [m] edge lengths; all zero: not known, its axes are drawn
  TriMesh surface{};  ///< [m] with triangles, instead of the box
};

struct FoxgloveOptions {
  double rate = 60;                 ///< [Hz] at most, > 0
  double metres_per_newton = 0.05;  ///< length of a force's arrow, > 0
};

class FoxgloveWriter {
 public:
  /// path "-" is standard output.
  /// in   shapes  of the first objects; the others' are not known
  /// err  io R-TRC-1; invalid_argument R-TRC-17 as TraceWriter, or an option
  static Result<FoxgloveWriter> create(const std::string& path, const TraceInfo& info, std::vector<FoxgloveShape> shapes,
                                       const FoxgloveOptions& options = {});

  /// Write a frame, if one is due.   pre  frames of a trace that is described by the info, in their order
  Result<void> write(const TraceFrame& frame);
  Result<void> finish();
  std::uint64_t messages() const noexcept;

  FoxgloveWriter(FoxgloveWriter&&) noexcept;
  FoxgloveWriter& operator=(FoxgloveWriter&&) noexcept;
  ~FoxgloveWriter();

 private:
  struct Impl;
  explicit FoxgloveWriter(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
