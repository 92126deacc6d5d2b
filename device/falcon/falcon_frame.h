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
#include <string>
#include <tl/expected.hpp>

#include <tactus/base/diagnostic.h>
#include <tactus/base/result.h>
#include <tactus/device/falcon/falcon_usb.h>

namespace tactus::device::falcon {

// ==== falcon frame ====

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

/// It asks to home, too, as every frame does: the axes that are homed are reported only then.   time O(1), no allocation
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

// ==== falcon start ====
// Brings an open Falcon to where it answers frames. Switched on it waits for its firmware, which is not free and comes with the vendor's
// driver; it then runs until it is switched off. Internal to this library.

inline constexpr std::size_t kMostFirmware = 65536;  ///< bytes; those known have about 8000

/// Set the chip up, ask for a frame, and if none comes hand over the firmware. No frame exerts a force.
/// in   firmware  file; read only if it is needed
/// err  unsupported R-DEV-3 it needs firmware, and the file is not named, cannot be read, or does not run; io R-DEV-4 a transfer failed,
///      or no answer; malformed R-DEV-5 the answer is another one
/// time 0.2 s at most if its firmware runs, else about 3 s
tl::expected<void, Diagnostic> start(UsbPort& port, const std::string& firmware);

}  // namespace tactus::device::falcon
