// SPDX-License-Identifier: Apache-2.0
/// The head of every payload: its baseline and its tick. spec/40-rigid.md section 2. Internal to the library.
#pragma once

#include <cstdint>

namespace tactus {

inline constexpr std::int64_t kTickLimit = 0xffffffff;  ///< ticks of packets are below

struct PacketHead {
  bool key = false;
  std::uint32_t baseline_delta = 1;  ///< sequence numbers back, 1..baseline_span; unused by key packets
  std::uint32_t tick_delta = 0;      ///< from the baseline's tick
};

/// Key and baseline, as range-coded payloads have them.   in  models  with members key and baseline
template <class Coder, class Models>
void code_baseline(Coder& coder, Models& models, std::uint8_t span, PacketHead& head) noexcept {
  head.key = coder.bit(models.key, head.key ? 1u : 0u);
  if (!head.key && span > 1) head.baseline_delta = coder.magnitude(models.baseline, head.baseline_delta);
}

}  // namespace tactus
