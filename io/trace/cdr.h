// SPDX-License-Identifier: Apache-2.0
/// Little-endian XCDR1 with its 4-byte encapsulation header, as ROS 2 stores messages. Values are aligned to their size, counted
/// from behind that header (DDS-XTypes 7.4.1, RTPS 10). Internal to the library.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/geometry.h>

namespace tactus {

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

}  // namespace tactus
