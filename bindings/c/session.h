// SPDX-License-Identifier: Apache-2.0
/// What both ends of sessions share.
#pragma once

#include <tactus/session/session_options.h>

#include "handles.h"

namespace tactus::c {

/// Times never step back.
class Clock {
 public:
  /// err  R-API-12 out of range; R-API-5 before an earlier one
  Result<void> advance(std::uint64_t now) noexcept {
    if (now > kLastTime) return refuse();
    if (now < now_) return fail(Errc::invalid_argument, "R-API-5");
    now_ = now;
    return {};
  }

 private:
  std::uint64_t now_ = 0;
};

inline bool is_reason(std::uint32_t reason) noexcept { return reason <= static_cast<std::uint32_t>(LeaveReason::protocol); }

void add(const Traffic& traffic, tactus_session_status& out) noexcept;
void add(const std::optional<RoundTrip>& trip, tactus_session_status& out) noexcept;

/// err  R-API-12 no room for the largest datagram
Result<void> check_room(const std::uint8_t* bytes, std::size_t capacity, const std::size_t* size) noexcept;

}  // namespace tactus::c
