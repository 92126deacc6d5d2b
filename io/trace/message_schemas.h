// SPDX-License-Identifier: Apache-2.0
/// ROS 2 message definitions that a trace carries, each with all that it depends on. Internal to the library.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace tactus {

enum class MessageType : std::uint8_t {
  pose,
  twist,
  point,
  vector,
  contact,
  mesh,
  displacements,
  surface_contact,
  quaternion,
  buttons,
  time_reference,
  servo,
  log,
  reports
};

/// "geometry_msgs/msg/PoseStamped"
std::string_view schema_name(MessageType type) noexcept;

/// Text of the definition in the `ros2msg` schema encoding: the message itself, then its dependencies behind "MSG:" lines.
std::string schema_text(MessageType type);

}  // namespace tactus
