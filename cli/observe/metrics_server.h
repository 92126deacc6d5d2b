// SPDX-License-Identifier: Apache-2.0
/// The endpoint of `serve --metrics`: /metrics for Prometheus and /health, on this machine, served by a thread of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "cli/live/monitor.h"
#include "cli/report/messages.h"

namespace tactus::cli {

class MetricsServer {
 public:
  /// pre  the monitor outlives it
  /// in   port  0: any free one
  /// err  the port is taken or not allowed; this program was built without it
  static tl::expected<std::unique_ptr<MetricsServer>, Failure> create(std::uint16_t port, const Monitor& monitor,
                                                                      ServerFacts facts);
  virtual ~MetricsServer() = default;

  virtual const std::string& address() const noexcept = 0;  ///< "http://127.0.0.1:9464/metrics"
};

}  // namespace tactus::cli
