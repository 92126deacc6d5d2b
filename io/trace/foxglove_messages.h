// SPDX-License-Identifier: Apache-2.0
/// What the 3-D panels of Foxglove and Lichtblick draw, as messages of ROS 2: foxglove_msgs/msg/SceneUpdate and FrameTransforms.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/tri_mesh.h>

namespace tactus::foxglove {

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
