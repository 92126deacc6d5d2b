// SPDX-License-Identifier: Apache-2.0
/// When a sender builds a packet on the initial state. Informative: a choice of the encoder. Internal to the library.
#pragma once

#include <cmath>
#include <cstdint>

#include <tactus/packet/packet_order.h>

namespace tactus {

class KeyPolicy {
 public:
  /// in   interval  [s] from key packet to key packet; 0: none but the necessary ones
  KeyPolicy(double interval, std::uint32_t tick_rate) noexcept
      : interval_(static_cast<std::int64_t>(std::ceil(interval * tick_rate))), silence_(forget_ticks(tick_rate)) {}

  /// The first packet, one per interval, one that was asked for, and one after a pause so long that receivers may soon forget what
  /// there was.   in  last  tick of the last packet
  bool is_due(std::int64_t tick, std::int64_t last) const noexcept {
    return requested_ || key_tick_ < 0 || (interval_ > 0 && tick - key_tick_ >= interval_) || 2 * (tick - last) > silence_;
  }
  void request() noexcept { requested_ = true; }
  /// The next packet is due although every bound may hold.
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
