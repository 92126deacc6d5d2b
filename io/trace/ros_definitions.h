// SPDX-License-Identifier: Apache-2.0
/// Texts of ROS 2 message definitions in the schema encoding `ros2msg`.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tactus::ros {

/// Without "/msg/" in its name, as recorders of ROS 2 write it and as fields refer to it.
struct Definition {
  std::string_view name, fields;
};

inline constexpr Definition kTime{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"};
inline constexpr Definition kPoint{"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"};
inline constexpr Definition kVector3{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"};
inline constexpr Definition kQuaternion{"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"};
inline constexpr Definition kPose{"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"};

/// The message itself, then what it depends on behind "MSG:" lines.
inline std::string definition_text(std::string_view fields, std::span<const Definition> dependencies) {
  std::string text(fields);
  for (const Definition& definition : dependencies)
    text.append(80, '=').append("\nMSG: ").append(definition.name).append("\n").append(definition.fields);
  return text;
}

}  // namespace tactus::ros
