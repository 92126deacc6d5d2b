// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/ros_messages.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <tactus/trace/cdr.h>
#include <tactus/trace/message_schemas.h>
#include <tactus/trace/missing.h>

namespace tactus {
namespace {

constexpr double kLargest = 1e15;  // so that no sum or quotient of what follows overflows
constexpr std::size_t kCovariance = 36;
constexpr std::size_t kLeastTransform = 72;  // bytes
constexpr std::uint32_t kSecond = 1'000'000'000;

const std::array<std::pair<std::string_view, RosType>, 6> types_by_schema{{{schema_name(MessageType::pose), RosType::pose},
                                                                           {schema_name(MessageType::twist), RosType::twist},
                                                                           {kOdometrySchema, RosType::odometry},
                                                                           {kWrenchSchema, RosType::wrench},
                                                                           {kTransformSchema, RosType::transform},
                                                                           {kTransformsSchema, RosType::transforms}}};

/// tf2 drops a leading slash; a prefix of "/" leaves two.
std::string_view frame_name(std::string_view text) noexcept {
  return text.substr(std::min(text.find_first_not_of('/'), text.size()));
}

RosItem read_header(CdrReader& in) noexcept {
  RosItem item;
  const auto seconds = static_cast<std::int32_t>(in.u32());
  const std::uint32_t nanoseconds = in.u32();
  item.frame = frame_name(in.text());
  item.has_stamp = seconds >= 0 && nanoseconds < kSecond && (seconds > 0 || nanoseconds > 0);
  if (item.has_stamp) item.stamp = static_cast<std::uint64_t>(seconds) * kSecond + nanoseconds;
  return item;
}

RosFault fault_of(const Vec3& v) noexcept {
  if (!is_finite(v)) return RosFault::not_finite;
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) > kLargest ? RosFault::too_large : RosFault::none;
}

RosFault make_unit(Quat& q) noexcept {
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!std::isfinite(length)) return RosFault::not_finite;
  if (length == 0) return RosFault::no_rotation;
  if (!is_rotation_length(length)) return RosFault::rotation_length;
  q = {q.w / length, q.x / length, q.y / length, q.z / length};
  return RosFault::none;
}

RosFault check(Pose& pose) noexcept {
  const RosFault position = fault_of(pose.position);
  return position != RosFault::none ? position : make_unit(pose.rotation);
}

RosFault fault_of(const Twist& twist) noexcept {
  const RosFault linear = fault_of(twist.linear);
  return linear != RosFault::none ? linear : fault_of(twist.angular);
}

RosItem read_transform(CdrReader& in) noexcept {
  RosItem item = read_header(in);
  item.child = frame_name(in.text());
  item.pose = in.pose();
  item.fault = check(item.pose);
  if (item.child == item.frame) item.fault = RosFault::own_parent;
  if (item.child.empty() || item.frame.empty()) item.fault = RosFault::no_name;
  return item;
}

bool has_covariance(CdrReader& in) noexcept {
  bool any = false;
  for (std::size_t i = 0; i < kCovariance; ++i) any = in.f64() != 0 || any;
  return any;
}

RosItem read_odometry(CdrReader& in) noexcept {
  RosItem item = read_header(in);
  item.child = frame_name(in.text());
  item.pose = in.pose();
  item.fault = check(item.pose);
  item.ignored = has_covariance(in);
  item.twist = {in.vec3(), in.vec3()};
  item.twist_fault = fault_of(item.twist);
  item.ignored = has_covariance(in) || item.ignored;
  return item;
}

RosItem read_item(CdrReader& in, RosType type) noexcept {
  if (type == RosType::odometry) return read_odometry(in);
  if (type == RosType::transform || type == RosType::transforms) return read_transform(in);
  RosItem item = read_header(in);
  if (type == RosType::pose) {
    item.pose = in.pose();
    item.fault = check(item.pose);
  } else if (type == RosType::twist) {
    item.twist = {in.vec3(), in.vec3()};
    item.fault = fault_of(item.twist);
  } else {
    item.force = in.vec3();
    item.fault = fault_of(item.force);
    item.ignored = in.vec3() != Vec3{};
  }
  return item;
}

}  // namespace

const char* text_of(RosFault fault) noexcept {
  switch (fault) {
    case RosFault::none:
      return "";
    case RosFault::not_finite:
      return "a number is NaN or infinite";
    case RosFault::too_large:
      return "a number is beyond 1e15";
    case RosFault::no_rotation:
      return "the rotation is 0, 0, 0, 0";
    case RosFault::rotation_length:
      return "the rotation's length is off 1 by more than 2 %";
    case RosFault::own_parent:
      return "a frame hangs on itself";
    case RosFault::no_name:
      return "a frame has no name";
    case RosFault::malformed:
      return "the message is not of its channel's type";
    case RosFault::impossible_time:
      return "the log time is behind the year 2100";
    case RosFault::encoding:
      return "the message is not plain little-endian CDR";
  }
  return "";
}

RosType ros_type(std::string_view schema) noexcept {
  for (const auto& [name, type] : types_by_schema) {
    const std::size_t msg = name.find("/msg/");
    if (schema == name || (schema.size() + 4 == name.size() && schema.starts_with(name.substr(0, msg)) &&
                           schema.substr(msg) == name.substr(msg + 4)))
      return type;
  }
  return RosType::none;
}

void decode_ros(std::span<const std::uint8_t> message, RosType type, std::vector<RosItem>& out) {
  const std::size_t first = out.size();
  CdrReader in(message);
  RosFault fault = in.is_supported() ? RosFault::none : RosFault::encoding;
  if (fault == RosFault::none) {
    const std::uint32_t count = type == RosType::transforms ? in.count(kLeastTransform) : 1;
    for (std::uint32_t i = 0; i < count; ++i) out.push_back(read_item(in, type));
    if (!in.done()) fault = RosFault::malformed;
  }
  if (fault == RosFault::none) return;
  out.resize(first);
  out.push_back({.fault = fault, .frame = {}, .child = {}, .twist_fault = fault});
}

}  // namespace tactus
