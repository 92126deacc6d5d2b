// SPDX-License-Identifier: Apache-2.0
/// Haply Inverse3 through the vendor's service on this machine: JSON over a WebSocket. The service sends a state after each command, and
/// only then: read() asks with the last force, and waits for the answer.
///
/// read() and write() allocate what the JSON parser needs for its token, and nothing else once the first messages have come.
#pragma once

#include <tactus/device/device.h>

namespace tactus::device::inverse3 {

class Inverse3Backend final : public Backend {
 public:
  const char* name() const noexcept override { return "inverse3"; }
  const char* title() const noexcept override { return "Haply Inverse3 (the vendor's service)"; }
  /// Nothing is asked of the service: it would begin to move forces.
  Listing list() const override;
  /// in   which    device_id of the service; empty: the first that it names
  ///      options  service: HOST:PORT on this machine, 127.0.0.1:10001 otherwise
  /// time up to 2 s
  tl::expected<std::unique_ptr<Device>, Diagnostic> open(const std::string& which, const OpenOptions& options) const override;
};

}  // namespace tactus::device::inverse3
