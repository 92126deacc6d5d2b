// SPDX-License-Identifier: Apache-2.0
/// Little-endian byte strings: a reader that cannot leave its span and a writer that appends.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace tactus {

/// Reads from the front of a span. Past its end every read yields zero or nothing and ok() stays false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) noexcept : bytes_(bytes) {}

  template <std::integral T>
  T integer() noexcept {
    using U = std::make_unsigned_t<T>;
    U value = 0;
    const auto raw = take(sizeof(T));
    for (std::size_t i = 0; i < raw.size(); ++i) value = static_cast<U>(value | static_cast<U>(U{raw[i]} << (8 * i)));
    return static_cast<T>(value);
  }
  double f64() noexcept { return std::bit_cast<double>(integer<std::uint64_t>()); }

  std::span<const std::uint8_t> take(std::uint64_t count) noexcept {
    if (count > remaining()) {
      failed_ = true;
      position_ = bytes_.size();
      return {};
    }
    const auto part = bytes_.subspan(position_, static_cast<std::size_t>(count));
    position_ += part.size();
    return part;
  }
  /// u32 length, then so many bytes.
  std::string_view text() noexcept {
    const auto raw = take(integer<std::uint32_t>());
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }

  std::size_t position() const noexcept { return position_; }
  std::size_t remaining() const noexcept { return bytes_.size() - position_; }
  bool ok() const noexcept { return !failed_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
  bool failed_ = false;
};

class ByteWriter {
 public:
  template <std::integral T>
  void integer(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bytes_.push_back(static_cast<std::uint8_t>(static_cast<std::make_unsigned_t<T>>(value) >> (8 * i)));
  }
  void f64(double value) { integer(std::bit_cast<std::uint64_t>(value)); }
  void append(std::span<const std::uint8_t> raw) { bytes_.insert(bytes_.end(), raw.begin(), raw.end()); }
  void append(std::string_view raw) { bytes_.insert(bytes_.end(), raw.begin(), raw.end()); }
  /// u32 length, then the bytes.
  void text(std::string_view value) {
    integer(static_cast<std::uint32_t>(value.size()));
    append(value);
  }
  /// Overwrite an integer written earlier, such as a length that was not known then.
  template <std::integral T>
  void patch(std::size_t position, T value) noexcept {
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bytes_[position + i] = static_cast<std::uint8_t>(static_cast<std::make_unsigned_t<T>>(value) >> (8 * i));
  }

  void clear() noexcept { bytes_.clear(); }
  std::size_t size() const noexcept { return bytes_.size(); }
  std::span<const std::uint8_t> bytes() const noexcept { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

} // namespace tactus
