// SPDX-License-Identifier: Apache-2.0
/// The frames of a Falcon whose firmware runs: 16 bytes each way, one reply per request.
///
///   byte   request                             reply
///   0      '<'                                 '<'
///   1-12   three motor values                  three encoder counts          int16 as four digits, least first; a digit is 0x41 + 0..15
///   13     0x41 + (1 home, 2 green, 4 blue,    0x41 + (bits 0-3 buttons,
///          8 red)                              bits 4-6 axes that are homed)
///   14     0x41                                not known: any but '<'
///   15     '>'                                 '>'
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <tactus/base/result.h>

namespace tactus::device::falcon {

inline constexpr std::size_t kFrameBytes = 16;
inline constexpr std::size_t kPacketBytes = 64;  ///< of a USB IN transfer; each starts with two bytes about the modem lines
inline constexpr std::uint8_t kAllHomed = 7;

using Frame = std::array<std::uint8_t, kFrameBytes>;
using Motors = std::array<std::int16_t, 3>;

enum class Light : std::uint8_t { none = 0, green = 2, blue = 4, red = 8 };

struct Request {
  Motors motors{};
  Light light = Light::none;
};

struct Reply {
  std::array<std::int16_t, 3> counts{};
  std::uint8_t buttons = 0;  ///< 4 bits: plus, forward, centre, minus
  std::uint8_t homed = 0;    ///< 3 bits, one per axis
  friend bool operator==(const Reply&, const Reply&) = default;
};

/// It asks to home, too, as every frame does: the axes that are homed are told only then.   time O(1), no allocation
Frame encode(const Request& request) noexcept;

/// Replies out of USB IN transfers, which end anywhere. Bytes between frames are skipped; '<' always begins a frame.
class ReplyParser {
 public:
  /// The next transfer, its modem bytes included.   pre  next() gave none; the bytes stay until it does again
  void give(std::span<const std::uint8_t> transfer) noexcept;
  /// The next reply; none: it takes another transfer.
  /// err  malformed R-DEV-5, once per broken frame: a byte is no digit, or the frame ends too early or too late. Reading goes on behind it.
  std::optional<Result<Reply>> next() noexcept;

 private:
  std::optional<Result<Reply>> take(std::uint8_t byte) noexcept;

  std::span<const std::uint8_t> transfer_{};
  std::size_t at_ = 0;
  Frame frame_{};
  std::size_t filled_ = 0;
};

}  // namespace tactus::device::falcon
