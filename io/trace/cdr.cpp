// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/cdr.h>

#include <algorithm>
#include <array>

namespace tactus {

namespace {

constexpr std::array<std::uint8_t, 4> kLittleEndian{0x00, 0x01, 0x00, 0x00};

constexpr std::size_t padding(std::size_t position, std::size_t size) noexcept { return (size - position % size) % size; }

/// Least significant byte first, all in one go: most of what a trace is made of.
template <class Number>
void put(std::vector<std::uint8_t>& out, Number value) {
  std::array<std::uint8_t, sizeof value> bytes;
  for (std::size_t i = 0; i < sizeof value; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

}  // namespace

CdrWriter::CdrWriter(std::vector<std::uint8_t>& out) : bytes_(out), out_(out) {
  out.assign(kLittleEndian.begin(), kLittleEndian.end());
}

void CdrWriter::align(std::size_t size) {
  if (const std::size_t missing = padding(bytes_.size() - kLittleEndian.size(), size); missing > 0)
    bytes_.insert(bytes_.end(), missing, 0);
}

void CdrWriter::u32(std::uint32_t value) {
  align(sizeof value);
  put(bytes_, value);
}

void CdrWriter::i64(std::int64_t value) {
  align(sizeof value);
  put(bytes_, static_cast<std::uint64_t>(value));
}

void CdrWriter::f64(double value) { i64(std::bit_cast<std::int64_t>(value)); }

void CdrWriter::text(std::string_view value) {
  u32(static_cast<std::uint32_t>(value.size() + 1));
  out_.bytes({reinterpret_cast<const std::uint8_t*>(value.data()), value.size()});
  u8(0);
}

void CdrWriter::vec3(const Vec3& value) {
  f64(value.x);
  f64(value.y);
  f64(value.z);
}

void CdrWriter::quat(const Quat& value) {
  f64(value.x);
  f64(value.y);
  f64(value.z);
  f64(value.w);
}

CdrReader::CdrReader(std::span<const std::uint8_t> message) noexcept
    : supported_(message.size() >= kLittleEndian.size() &&
                 std::equal(kLittleEndian.begin(), kLittleEndian.begin() + 2, message.begin())),
      body_(message.subspan(std::min(message.size(), kLittleEndian.size()))) {}

void CdrReader::align(std::size_t size) noexcept { body_.bytes(padding(body_.position(), size)); }

std::uint32_t CdrReader::u32() noexcept {
  align(sizeof(std::uint32_t));
  return body_.u32();
}

std::int64_t CdrReader::i64() noexcept {
  align(sizeof(std::int64_t));
  return static_cast<std::int64_t>(body_.u64());
}

double CdrReader::f64() noexcept { return std::bit_cast<double>(i64()); }

std::uint32_t CdrReader::count(std::size_t item_size) noexcept {
  const std::uint32_t items = u32();
  if (items <= body_.remaining() / item_size) return items;
  malformed_ = true;
  return 0;
}

std::string_view CdrReader::text() noexcept {
  const auto raw = body_.bytes(u32());
  if (raw.empty() || raw.back() != 0) {
    malformed_ = true;
    return {};
  }
  return {reinterpret_cast<const char*>(raw.data()), raw.size() - 1};
}

Vec3 CdrReader::vec3() noexcept {
  const double x = f64(), y = f64();
  return {x, y, f64()};
}

Quat CdrReader::quat() noexcept {
  Quat q;
  q.x = f64();
  q.y = f64();
  q.z = f64();
  q.w = f64();
  return q;
}

Pose CdrReader::pose() noexcept {
  const Vec3 position = vec3();
  return {position, quat()};
}

}  // namespace tactus
