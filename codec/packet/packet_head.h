// SPDX-License-Identifier: Apache-2.0
/// The head of every payload: its baseline and its tick. spec/40-rigid.md section 2. Internal to the library.
#pragma once

#include <cstdint>

namespace tactus {

inline constexpr std::int64_t kTickLimit = 0xffffffff;  ///< ticks of packets are below

struct PacketHead {
  bool key = false;
  std::uint32_t baseline_delta = 1;  ///< numbers back, 1..farthest_baseline(); unused by key packets
  std::uint32_t tick_delta = 0;      ///< from the baseline's tick
};

/// Largest baseline_delta.   in  span  of the scene;  numbered  packets have given numbers, which need not be consecutive
constexpr std::uint32_t farthest_baseline(std::uint32_t span, bool numbered) noexcept {
  return numbered && span > 1 ? 4095 : span;
}

/// Key and baseline, as range-coded payloads have them.   in  models  with members key and baseline
template <class Coder, class Models>
void code_baseline(Coder& coder, Models& models, std::uint8_t span, PacketHead& head) noexcept {
  head.key = coder.bit(models.key, head.key ? 1u : 0u);
  if (!head.key && span > 1) head.baseline_delta = coder.magnitude(models.baseline, head.baseline_delta);
}

}  // namespace tactus
