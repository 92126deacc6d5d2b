// SPDX-License-Identifier: Apache-2.0
/// The ROS 2 messages of a trace as values, to and from CDR, and their definitions. Internal to the library.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/rigid/trigger.h>
#include <tactus/trace/frame.h>

namespace tactus {

// ==== cdr ====
// Little-endian XCDR1 with its 4-byte encapsulation header, as ROS 2 stores messages. Values are aligned to their size, counted
// from behind that header (DDS-XTypes 7.4.1, RTPS 10).

class CdrWriter {
 public:
  /// Start a message in `out`, replacing what it held.
  explicit CdrWriter(std::vector<std::uint8_t>& out);
  void u8(std::uint8_t value) { out_.u8(value); }
  void u32(std::uint32_t value);
  void i64(std::int64_t value);
  void f32(float value) { u32(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value);
  void text(std::string_view value);  ///< length with the closing zero, the bytes, a zero
  void vec3(const Vec3& value);
  void quat(const Quat& value);  ///< x, y, z, w, as ROS writes it

 private:
  void align(std::size_t size);
  std::vector<std::uint8_t>& bytes_;
  ByteWriter out_;
};

/// Past the end every read yields zero; check done() once, when all is read.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> message) noexcept;
  /// The encapsulation header names the one representation that is read here.
  bool is_supported() const noexcept { return supported_; }
  std::uint8_t u8() noexcept { return body_.u8(); }
  std::uint32_t u32() noexcept;
  std::int64_t i64() noexcept;
  float f32() noexcept { return std::bit_cast<float>(u32()); }
  double f64() noexcept;
  /// Length of a sequence whose items take `item_size` bytes each. A length that cannot fit into the rest of the message fails
  /// and yields 0, so that the caller may allocate the items.
  std::uint32_t count(std::size_t item_size) noexcept;
  std::string_view text() noexcept;
  Vec3 vec3() noexcept;
  Quat quat() noexcept;
  Pose pose() noexcept;  ///< geometry_msgs/Pose, and Transform
  /// True if the whole message was read without overrun; up to 3 bytes of padding may follow.
  bool done() const noexcept { return body_.ok() && !malformed_ && body_.remaining() < 4; }

 private:
  void align(std::size_t size) noexcept;
  bool supported_ = false;
  bool malformed_ = false;
  ByteReader body_;
};

// ==== schemas ====
// ROS 2 message definitions that a trace carries, each with all that it depends on.

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

// ==== messages ====
// The ROS 2 messages of a trace as values, to and from CDR.

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
