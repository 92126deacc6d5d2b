// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/falcon/falcon_frame.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include <tactus/base/rule.h>

namespace tactus::device::falcon {

// ==== falcon frame ====

namespace {

constexpr std::uint8_t kBegin = '<', kEnd = '>', kZero = 0x41;
constexpr std::uint8_t kHome = 1;
constexpr std::size_t kModemBytes = 2;
constexpr std::size_t kFlags = 13, kUnknown = 14;  // indices in a frame

bool fits(std::uint8_t byte, std::size_t index) noexcept {
  if (index == kUnknown) return true;
  if (index == kFrameBytes - 1) return byte == kEnd;
  const unsigned most = index == kFlags ? 0x7f : 0xf;
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
    const std::size_t index = at_++;
    if (index % kPacketBytes < kModemBytes) continue;
    if (auto out = take(transfer_[index])) return out;
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

// ==== falcon start ====

namespace {

using Bytes = std::vector<std::uint8_t>;
using Done = tl::expected<void, Diagnostic>;

// Requests to the chip, and their values.
constexpr std::uint8_t kReset = 0, kModem = 1, kFlow = 2, kBaud = 3, kData = 4, kLatency = 9;
struct Setting {
  std::uint8_t request;
  std::uint16_t value;
};
constexpr Setting kDropIn{kReset, 1}, kDropOut{kReset, 2};
constexpr Setting kLineLow{kModem, 0x0100}, kLineHigh{kModem, 0x0101};                        // DTR
constexpr std::array kForFrames{Setting{kLatency, 1}, Setting{kBaud, 2}, kDropIn, kDropOut};  // 1 ms, 1.5 Mbit/s
constexpr std::array kForGreeting{
    kDropIn,           kDropOut,          Setting{kLatency, 16},   Setting{kBaud, 0x4138},  // 16 ms, 9600 bit/s
    Setting{kData, 8}, Setting{kFlow, 0}, Setting{kModem, 0x0200},                          // 8N1, RTS low
    kLineLow,          kLineHigh};
constexpr std::array kForFirmware{kLineLow, Setting{kBaud, 0x15}};  // 140 kbit/s

constexpr std::array<std::uint8_t, 3> kGreeting{0x0a, 0x43, 0x0d};
constexpr std::array<std::uint8_t, 4> kGreeted{0x0a, 0x44, 0x2c, 0x0d};
constexpr std::array<std::uint8_t, 1> kReady{0x41};
constexpr int kGreetings = 10;                    // the first ones may find it asleep
constexpr int kAsked = 10;                        // frames
constexpr Time kFrameTime = 20 * kMillisecond;    // for an answer when it runs,
constexpr Time kStartTime = 100 * kMillisecond;   // and before
constexpr std::size_t kPiece = kPacketBytes - 2;  // of firmware; its echo fits a packet

constexpr const char* kRemedy = "Name the firmware file that came with the vendor's driver, and switch the Falcon off and on.";

tl::unexpected<Diagnostic> failed(const tl::unexpected<Error>& error, std::string detail, std::string remedy = {},
                                  std::string file = {}) {
  Diagnostic out{error.value()};
  out.detail = std::move(detail);
  out.remedy = std::move(remedy);
  out.file = std::move(file);
  return tl::unexpected(std::move(out));
}

tl::unexpected<Diagnostic> lost(std::string detail) { return failed(fail(Errc::io, "R-DEV-4"), std::move(detail)); }

Done set(UsbPort& port, std::span<const Setting> settings) {
  for (const auto& [request, value] : settings)
    if (port.control(request, value) != UsbStatus::done) return lost("the USB chip cannot be set up");
  return {};
}

Done write(UsbPort& port, std::span<const std::uint8_t> bytes) {
  const UsbTransfer out = port.write(bytes);
  if (out.status != UsbStatus::done || out.bytes != bytes.size()) return lost("sending failed while it started");
  return {};
}

/// What comes, at most `most` bytes, until the time is over.
tl::expected<Bytes, Diagnostic> read(UsbPort& port, std::size_t most, Time deadline) {
  Bytes out;
  std::array<std::uint8_t, kPacketBytes> packet{};
  while (out.size() < most && port.now() < deadline) {
    const UsbTransfer in = port.read(packet, deadline);
    if (in.status != UsbStatus::done && in.status != UsbStatus::timeout) return lost("receiving failed while it started");
    for (std::size_t i = 2; i < in.bytes; ++i) out.push_back(packet[i]);  // behind the modem bytes
  }
  return out;
}

/// Whether its firmware runs: it answers a frame.
tl::expected<bool, Diagnostic> answers(UsbPort& port) {
  TACTUS_CHECK(set(port, kForFrames));
  ReplyParser parser;
  const Frame request = encode(Request{});
  for (int i = 0; i < kAsked; ++i) {
    TACTUS_CHECK(write(port, request));
    std::array<std::uint8_t, kPacketBytes> packet{};
    for (const Time deadline = port.now() + kFrameTime; port.now() < deadline;) {
      const UsbTransfer in = port.read(packet, deadline);
      if (in.status != UsbStatus::done && in.status != UsbStatus::timeout) return lost("receiving failed while it started");
      parser.give(std::span(packet).first(in.bytes));
      while (const auto reply = parser.next())
        if (*reply) return true;
    }
  }
  return false;
}

tl::expected<Bytes, Diagnostic> load(const std::string& path) {
  const auto missing = [&path](std::string detail) {
    return failed(fail(Errc::unsupported, "R-DEV-3"), std::move(detail), kRemedy, path);
  };
  if (path.empty()) return missing("the Falcon was switched on and has no firmware yet");
  std::ifstream file(path, std::ios::binary);
  if (!file) return missing(std::string("the firmware cannot be read: ") + std::strerror(errno));
  Bytes out(kMostFirmware + 1);
  file.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size()));
  out.resize(static_cast<std::size_t>(file.gcount()));
  if (file.bad() || out.empty()) return missing("there is nothing to read in this file");
  if (out.size() > kMostFirmware) return missing("this is no firmware: it is too long");
  return out;
}

Done greet(UsbPort& port) {
  TACTUS_CHECK(set(port, kForGreeting));
  Bytes heard;
  for (int i = 0; i < kGreetings; ++i) {
    TACTUS_CHECK(write(port, kGreeting));
    TACTUS_TRY(const Bytes answer, read(port, kGreeted.size(), port.now() + kStartTime));
    heard.insert(heard.end(), answer.begin(), answer.end());
    if (std::search(heard.begin(), heard.end(), kGreeted.begin(), kGreeted.end()) != heard.end()) return {};
  }
  if (heard.empty()) return lost("it does not answer the greeting; is its power supply plugged in?");
  return failed(fail(Errc::malformed, "R-DEV-5"), "it answers the greeting with something else");
}

Done expect_echo(UsbPort& port, std::span<const std::uint8_t> sent, std::size_t at) {
  TACTUS_TRY(const Bytes echo, read(port, sent.size(), port.now() + kStartTime));
  if (echo.size() < sent.size()) return lost("it stopped taking its firmware at byte " + std::to_string(at + echo.size()));
  if (!std::equal(sent.begin(), sent.end(), echo.begin(), echo.end()))
    return failed(fail(Errc::malformed, "R-DEV-5"),
                  "it did not take its firmware as it was sent, near byte " + std::to_string(at));
  return {};
}

Done hand_over(UsbPort& port, std::span<const std::uint8_t> firmware) {
  TACTUS_CHECK(greet(port));
  TACTUS_CHECK(set(port, kForFirmware));
  TACTUS_CHECK(write(port, kReady));
  TACTUS_CHECK(expect_echo(port, kReady, 0));
  for (std::size_t at = 0; at < firmware.size(); at += kPiece) {
    const auto piece = firmware.subspan(at, std::min(kPiece, firmware.size() - at));
    TACTUS_CHECK(write(port, piece));
    TACTUS_CHECK(expect_echo(port, piece, at));
  }
  return {};
}

}  // namespace

Done start(UsbPort& port, const std::string& firmware) {
  TACTUS_TRY(const bool runs, answers(port));
  if (runs) return {};
  TACTUS_TRY(const Bytes bytes, load(firmware));
  TACTUS_CHECK(hand_over(port, bytes));
  TACTUS_TRY(const bool runs_now, answers(port));
  if (runs_now) return {};
  return failed(fail(Errc::unsupported, "R-DEV-3"), "the Falcon took this file, but it does not run", kRemedy, firmware);
}

}  // namespace tactus::device::falcon
