// SPDX-License-Identifier: Apache-2.0
/// The ROS 2 messages of a trace as values, to and from CDR. Internal to the library.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/rigid/trigger.h>
#include <tactus/trace/frame.h>

namespace tactus {

/// Nanoseconds since the recording began. Tick and time belong together one to one, because a tick takes at least 1000 ns.
///   time = round(tick * 1e9 / tick_rate)
/// pre  0 <= tick < kMaxSeconds * tick_rate
std::uint64_t time_of_tick(std::int64_t tick, std::uint32_t tick_rate) noexcept;
/// round(time * tick_rate / 1e9)
std::int64_t tick_of_time(std::uint64_t time, std::uint32_t tick_rate) noexcept;

inline constexpr std::int64_t kMaxSeconds = std::int64_t{1} << 31;  ///< what the seconds of a ROS 2 stamp hold
inline constexpr std::uint32_t kMaxTickRate = 1'000'000;            ///< as in StreamHeader

struct Twist {
  Vec3 linear;   ///< [m/s]
  Vec3 angular;  ///< [rad/s]
};

/// Write the CDR bytes of a message with header.stamp `time` to `message`. header.frame_id is "world"; of a contact, whose point
/// and normal are in the object's frame, it is the object's name.
void encode_pose(std::vector<std::uint8_t>& message, std::uint64_t time, const Pose& pose);
void encode_twist(std::vector<std::uint8_t>& message, std::uint64_t time, const Twist& twist);
void encode_vector(std::vector<std::uint8_t>& message, std::uint64_t time, const Vec3& vector);  ///< point and vector alike
void encode_quaternion(std::vector<std::uint8_t>& message, std::uint64_t time, const Quat& quaternion);
void encode_buttons(std::vector<std::uint8_t>& message, std::uint64_t time, std::uint32_t down);
/// in  device  [ns] on the clock of a user's device   pre  0 <= device < 1e9 kMaxSeconds
void encode_time_reference(std::vector<std::uint8_t>& message, std::uint64_t time, std::int64_t device);
/// `device` is not part of the message.
void encode_contact(std::vector<std::uint8_t>& message, std::uint64_t time, const Contact& contact, std::string_view object);

void encode_servo(std::vector<std::uint8_t>& message, std::uint64_t time, const ServoSample& servo);
void encode_reports(std::vector<std::uint8_t>& message, std::uint64_t time, const DeviceReports& reports);
/// An entry of a log, of level "info".   in  text  UTF-8
void encode_log(std::vector<std::uint8_t>& message, std::uint64_t time, std::string_view text);

void encode_mesh(std::vector<std::uint8_t>& message, const TriMesh& mesh);  ///< has no header
void encode_displacements(std::vector<std::uint8_t>& message, std::uint64_t time, std::span<const float> displacements);
void encode_mesh_contact(std::vector<std::uint8_t>& message, std::uint64_t time, const SurfaceContact& contact,
                         std::string_view mesh);

/// A decoded message and the time of its header.
template <class T>
struct Stamped {
  std::uint64_t time = 0;  ///< [ns]
  T value;
};

/// err  unsupported R-TRC-7: not plain little-endian CDR; malformed R-TRC-13: size or text does not fit the type;
///      invalid R-TRC-14: a number is NaN or infinite, a time is negative or has 1e9 ns or more, a contact's kind, normal or
///      stiffness is invalid, a duration is negative, there are not as many displacements as `out` takes.
Result<Stamped<Pose>> decode_pose(std::span<const std::uint8_t> message) noexcept;
Result<Stamped<Twist>> decode_twist(std::span<const std::uint8_t> message) noexcept;
Result<Stamped<Vec3>> decode_vector(std::span<const std::uint8_t> message) noexcept;
Result<Stamped<Quat>> decode_quaternion(std::span<const std::uint8_t> message) noexcept;
Result<Stamped<std::uint32_t>> decode_buttons(std::span<const std::uint8_t> message) noexcept;
Result<Stamped<std::int64_t>> decode_time_reference(std::span<const std::uint8_t> message) noexcept;
Result<Stamped<Contact>> decode_contact(std::span<const std::uint8_t> message) noexcept;

Result<Stamped<ServoSample>> decode_servo(std::span<const std::uint8_t> message) noexcept;
/// out  `out` gets the reports; the result is the time of the header
/// err  also invalid R-TRC-14: the sizes are not those of the bytes
Result<std::uint64_t> decode_reports(std::span<const std::uint8_t> message, DeviceReports& out);
/// The text lasts as long as the message.   err  also invalid R-TRC-11: it is not UTF-8
Result<Stamped<std::string_view>> decode_log(std::span<const std::uint8_t> message) noexcept;

Result<Stamped<SurfaceContact>> decode_mesh_contact(std::span<const std::uint8_t> message) noexcept;
/// out  `out` gets the displacements; the result is the time of the header
Result<std::uint64_t> decode_displacements(std::span<const std::uint8_t> message, std::span<float> out) noexcept;
/// err  also R-SRF-n: the mesh breaks a rule of tri_mesh.h
Result<TriMesh> decode_mesh(std::span<const std::uint8_t> message);

/// Whether a contact can be recorded: its kind and numbers satisfy contact.h.
bool is_valid(const Contact& contact) noexcept;
bool is_valid(const SurfaceContact& contact) noexcept;

}  // namespace tactus
