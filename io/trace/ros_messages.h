// SPDX-License-Identifier: Apache-2.0
/// ROS 2 messages that our own traces do not have, but recordings of other programs do.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/trace/messages.h>

namespace tactus {

inline constexpr std::string_view kTransformSchema = "geometry_msgs/msg/TransformStamped";
inline constexpr std::string_view kTransformsSchema = "tf2_msgs/msg/TFMessage";
inline constexpr std::string_view kOdometrySchema = "nav_msgs/msg/Odometry";
inline constexpr std::string_view kWrenchSchema = "geometry_msgs/msg/WrenchStamped";

/// Where the frame `child` is in the frame `parent`. Names last as long as the message.
struct RosTransform {
  std::string_view parent, child;
  Pose pose;  ///< of unit length
};

struct RosOdometry {
  Pose pose;
  Twist twist;  ///< in the frame of `pose`, as ours; the message has it in the frame of the child
};

struct RosWrench {
  std::string_view frame;  ///< of `force`; lasts as long as the message
  Vec3 force;              ///< [N]
};

/// in   is_list  a TFMessage; otherwise a TransformStamped
/// out  `out` gets the transforms behind those that it has
/// err  unsupported R-TRC-7, malformed R-TRC-13 as messages.h; invalid R-TRC-14: a number is not finite, or a rotation not of unit length
Result<void> decode_transforms(std::span<const std::uint8_t> message, bool is_list, std::vector<RosTransform>& out);
Result<RosOdometry> decode_odometry(std::span<const std::uint8_t> message) noexcept;
Result<RosWrench> decode_wrench(std::span<const std::uint8_t> message) noexcept;

}  // namespace tactus
