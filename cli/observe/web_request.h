// SPDX-License-Identifier: Apache-2.0
/// Which requests of a browser are answered. The door is open on this machine alone, but any page that a browser shows can make it knock:
/// by an address of its own that resolves to this machine, or by a script.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tactus::cli {

struct WebRequest {
  std::string_view method, target;
  std::string_view host, origin;       ///< of the first such field
  std::size_t hosts = 0, origins = 0;  ///< how many fields there are
  bool upgrades = false;               ///< to a WebSocket
};

/// The status of HTTP, and for those that refuse a sentence.
struct WebAnswer {
  unsigned status = 0;
  std::string_view text{};
};
inline constexpr unsigned kPageAnswer = 200, kLiveAnswer = 101;
inline constexpr std::string_view kPageTarget = "/", kLiveTarget = "/live";

/// The host must be this machine by number or as localhost, with our port, and a WebSocket must be asked for by the page from there.
WebAnswer judge(const WebRequest& request, std::uint16_t port);

}  // namespace tactus::cli
