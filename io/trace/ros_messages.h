// SPDX-License-Identifier: Apache-2.0
/// ROS 2 messages with motion or forces, as recordings of other programs hold them. All of a message is parsed; what is not used is reported.
/// Internal to the library.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/trace/messages.h>

namespace tactus {

/// What makes a sample count as missing. One rule for every message.
enum class RosFault : std::uint8_t {
  none,
  not_finite,       ///< a number is NaN or infinite
  too_large,        ///< beyond 1e15 of its unit
  no_rotation,      ///< 0, 0, 0, 0
  rotation_length,  ///< off 1 by more than 2 %; within, it is made 1
  own_parent,       ///< a transform of a frame to itself
  no_name,          ///< a transform of a frame without a name
  malformed,        ///< the message is not CDR of its type
  impossible_time,  ///< the log time is behind the year 2100
  encoding,         ///< of a representation of CDR that is not read
};
const char* text_of(RosFault fault) noexcept;

inline constexpr std::string_view kTransformSchema = "geometry_msgs/msg/TransformStamped";
inline constexpr std::string_view kTransformsSchema = "tf2_msgs/msg/TFMessage";
inline constexpr std::string_view kOdometrySchema = "nav_msgs/msg/Odometry";
inline constexpr std::string_view kWrenchSchema = "geometry_msgs/msg/WrenchStamped";

enum class RosType : std::uint8_t { none, pose, twist, odometry, wrench, transform, transforms };

/// The type of a schema that is read: "geometry_msgs/msg/PoseStamped", or as older writers spell it, without "/msg".
RosType ros_type(std::string_view schema) noexcept;

/// One thing that a message holds. Names last as long as the message.
struct RosItem {
  RosFault fault = RosFault::none;
  bool has_stamp = false;         ///< it is neither zero nor impossible
  std::uint64_t stamp = 0;        ///< [ns]
  std::string_view frame, child;  ///< header.frame_id and child_frame_id, without leading slashes
  Pose pose{};                    ///< of a pose, an odometry and a transform: of unit length
  Twist twist{};                  ///< as published: of an odometry, in `child`
  RosFault twist_fault = RosFault::none;
  Vec3 force{};          ///< [N]
  bool ignored = false;  ///< a torque or a covariance is not zero
};

/// out  `out` gets the items behind those that it has; of a message that cannot be parsed, one with that fault and no names
void decode_ros(std::span<const std::uint8_t> message, RosType type, std::vector<RosItem>& out);

}  // namespace tactus
