// SPDX-License-Identifier: Apache-2.0
/// A WebSocket (RFC 6455) to a program on this machine. The only file that knows Boost.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include <tactus/device/device.h>

namespace tactus::device::inverse3 {

class WebSocket {
 public:
  /// in   service  HOST:PORT, a numeric address of the loopback or "localhost"
  ///      most     [bytes] of a message; a longer one ends the connection
  /// err  a sentence: the address is none or not on this machine, or nobody answers there
  /// time at most `deadline`
  static tl::expected<std::unique_ptr<WebSocket>, std::string> connect(const std::string& service, std::size_t most,
                                                                       Time deadline);

  enum class Status : std::uint8_t { done, timeout, gone };
  /// One thread at a time sends or receives.   time until `deadline`
  Status send(std::string_view text, Time deadline) noexcept;
  /// Wait for the next message, which message() holds until the next call.
  Status receive(Time deadline) noexcept;
  std::string_view message() const noexcept;

  ~WebSocket();
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;

 private:
  struct Impl;
  explicit WebSocket(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus::device::inverse3
