// SPDX-License-Identifier: Apache-2.0
/// When a sender codes a key packet. Informative: a choice of the encoder. Internal to the library.
#pragma once

#include <cmath>
#include <cstdint>

#include <tactus/packet/packet_order.h>

namespace tactus {

class KeyPolicy {
 public:
  /// in   interval  [s] between key packets; 0: only the necessary ones
  KeyPolicy(double interval, std::uint32_t tick_rate) noexcept
      : interval_(static_cast<std::int64_t>(std::ceil(interval * tick_rate))), silence_(forget_ticks(tick_rate)) {}

  /// True for the first packet, once per interval, on request, and after a pause so long that receivers may soon drop their
  /// states.
  /// in   last  tick of the last packet
  bool is_due(std::int64_t tick, std::int64_t last) const noexcept {
    return requested_ || key_tick_ < 0 || (interval_ > 0 && tick - key_tick_ >= interval_) || 2 * (tick - last) > silence_;
  }
  void request() noexcept { requested_ = true; }
  /// True if the next packet must be sent even if every bound holds.
  bool is_requested() const noexcept { return requested_; }
  void sent(std::int64_t tick, bool key) noexcept {
    requested_ = false;
    if (key) key_tick_ = tick;
  }

 private:
  std::int64_t interval_, silence_;
  std::int64_t key_tick_ = -1;  // of the last key packet; -1: none yet
  bool requested_ = false;
};

}  // namespace tactus
