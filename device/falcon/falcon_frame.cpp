// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/falcon/falcon_frame.h>

#include <tactus/base/rule.h>

namespace tactus::device::falcon {
namespace {

constexpr std::uint8_t kBegin = '<', kEnd = '>', kZero = 0x41;
constexpr std::uint8_t kHome = 1;
constexpr std::size_t kModemBytes = 2;
constexpr std::size_t kFlags = 13, kUnknown = 14;  // places in a frame

bool fits(std::uint8_t byte, std::size_t place) noexcept {
  if (place == kUnknown) return true;
  if (place == kFrameBytes - 1) return byte == kEnd;
  const unsigned most = place == kFlags ? 0x7f : 0xf;
  return byte >= kZero && byte - kZero <= static_cast<int>(most);
}

Reply decode(const Frame& frame) noexcept {
  Reply out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    unsigned value = 0;
    for (std::size_t digit = 0; digit < 4; ++digit)
      value |= static_cast<unsigned>(frame[1 + 4 * axis + digit] - kZero) << 4 * digit;
    out.counts[axis] = static_cast<std::int16_t>(value);
  }
  const auto flags = static_cast<unsigned>(frame[kFlags] - kZero);
  out.buttons = static_cast<std::uint8_t>(flags & 0xfu);
  out.homed = static_cast<std::uint8_t>(flags >> 4);
  return out;
}

}  // namespace

Frame encode(const Request& request) noexcept {
  Frame out;
  out.fill(kZero);
  out.front() = kBegin;
  out.back() = kEnd;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto value = static_cast<std::uint16_t>(request.motors[axis]);
    for (std::size_t digit = 0; digit < 4; ++digit)
      out[1 + 4 * axis + digit] = static_cast<std::uint8_t>(kZero + (static_cast<unsigned>(value) >> 4 * digit & 0xfu));
  }
  out[kFlags] = static_cast<std::uint8_t>(kZero + (kHome | static_cast<unsigned>(request.light)));
  return out;
}

void ReplyParser::give(std::span<const std::uint8_t> transfer) noexcept {
  transfer_ = transfer;
  at_ = 0;
}

std::optional<Result<Reply>> ReplyParser::next() noexcept {
  while (at_ < transfer_.size()) {
    const std::size_t place = at_++;
    if (place % kPacketBytes < kModemBytes) continue;
    if (auto out = take(transfer_[place])) return out;
  }
  return std::nullopt;
}

std::optional<Result<Reply>> ReplyParser::take(std::uint8_t byte) noexcept {
  if (byte == kBegin) {
    const bool cuts_off = filled_ > 0;
    frame_[0] = byte;
    filled_ = 1;
    if (cuts_off) return fail(Errc::malformed, "R-DEV-5");
    return std::nullopt;
  }
  if (filled_ == 0) return std::nullopt;
  if (!fits(byte, filled_)) {
    filled_ = 0;
    return fail(Errc::malformed, "R-DEV-5");
  }
  frame_[filled_++] = byte;
  if (filled_ < kFrameBytes) return std::nullopt;
  filled_ = 0;
  return decode(frame_);
}

}  // namespace tactus::device::falcon
