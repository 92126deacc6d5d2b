// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/ros_messages.h>

#include <cmath>

#include <tactus/base/rule.h>
#include <tactus/trace/messages.h>

namespace tactus {
namespace {

constexpr double kNearUnit = 0.01;  // of a rotation's length
constexpr std::size_t kCovariance = 36;
constexpr std::size_t kLeastTransform = 72;  // bytes

/// std_msgs/Header → frame_id. Its stamp is not used: the time of the log is.
std::string_view read_frame(CdrReader& in) noexcept {
  in.u32();
  in.u32();
  return in.text();
}

/// False: not of unit length, as far as numbers of 32 bits keep that.
bool make_unit(Quat& q) noexcept {
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(std::abs(length - 1) < kNearUnit)) return false;
  q = {q.w / length, q.x / length, q.y / length, q.z / length};
  return true;
}

bool make_valid(Pose& pose) noexcept { return is_finite(pose.position) && make_unit(pose.rotation); }

RosTransform read_transform(CdrReader& in) noexcept {
  const std::string_view parent = read_frame(in);
  const std::string_view child = in.text();
  return {parent, child, in.pose()};
}

void skip_covariance(CdrReader& in) noexcept {
  for (std::size_t i = 0; i < kCovariance; ++i) in.f64();
}

}  // namespace

Result<void> decode_transforms(std::span<const std::uint8_t> message, bool is_list, std::vector<RosTransform>& out) {
  CdrReader in(message);
  if (!in.is_supported()) return fail(Errc::unsupported, "R-TRC-7");
  const std::size_t first = out.size();
  const std::uint32_t count = is_list ? in.count(kLeastTransform) : 1;
  for (std::uint32_t i = 0; i < count; ++i) out.push_back(read_transform(in));
  if (!in.done()) return fail(Errc::malformed, "R-TRC-13");
  for (std::size_t i = first; i < out.size(); ++i)
    if (!make_valid(out[i].pose)) return fail(Errc::invalid, "R-TRC-14");
  return {};
}

Result<RosOdometry> decode_odometry(std::span<const std::uint8_t> message) noexcept {
  CdrReader in(message);
  if (!in.is_supported()) return fail(Errc::unsupported, "R-TRC-7");
  read_frame(in);
  in.text();  // of the child
  RosOdometry out{.pose = in.pose(), .twist = {}};
  skip_covariance(in);
  out.twist.linear = in.vec3();
  out.twist.angular = in.vec3();
  skip_covariance(in);
  if (!in.done()) return fail(Errc::malformed, "R-TRC-13");
  if (!make_valid(out.pose) || !is_finite(out.twist.linear) || !is_finite(out.twist.angular))
    return fail(Errc::invalid, "R-TRC-14");
  out.twist = {rotate(out.pose.rotation, out.twist.linear), rotate(out.pose.rotation, out.twist.angular)};
  return out;
}

Result<RosWrench> decode_wrench(std::span<const std::uint8_t> message) noexcept {
  CdrReader in(message);
  if (!in.is_supported()) return fail(Errc::unsupported, "R-TRC-7");
  const std::string_view frame = read_frame(in);
  const Vec3 force = in.vec3();
  in.vec3();  // torque
  if (!in.done()) return fail(Errc::malformed, "R-TRC-13");
  if (!is_finite(force)) return fail(Errc::invalid, "R-TRC-14");
  return RosWrench{frame, force};
}

}  // namespace tactus
