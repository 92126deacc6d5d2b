// SPDX-License-Identifier: Apache-2.0
/// In place of metrics_server.cpp in a program that was built without Boost.
#include "cli/observe/metrics_server.h"

namespace tactus::cli {

tl::expected<std::unique_ptr<MetricsServer>, Failure> MetricsServer::create(std::uint16_t /*port*/, const Monitor& /*monitor*/,
                                                                            ServerFacts /*facts*/) {
  return refuse_arguments("--metrics: this program was built without Boost", "Install libboost-dev and build it again.");
}

}  // namespace tactus::cli
