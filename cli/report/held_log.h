// SPDX-License-Identifier: Apache-2.0
/// What was held as it broke a rule, in words: each part once, and once when it is back.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tactus/packet/held_part.h>

namespace tactus::cli {

/// "cube: a value is not a finite number (R-API-1)", with how far positions of the scene reach where that is the rule.
std::string text_of(const Scene& scene, const HeldPart& held);

class HeldLog {
 public:
  /// Of a tick.   time O(what is held) while nothing begins or ends
  void look(std::int64_t tick, std::span<const HeldPart> held);
  /// What has begun or ended with the last look(). Valid until the next.
  std::span<const HeldPart> begun() const noexcept { return begun_; }
  std::span<const HeldPart> ended() const noexcept { return ended_; }
  /// A line for each part and run of ticks: what, why, from when to when, and what to do; of many the first, and how many more.
  std::vector<std::string> lines(const Scene& scene) const;

 private:
  struct Run {
    HeldPart held;
    std::int64_t last;  // tick; kGoesOn: it is not over
  };
  static constexpr std::int64_t kGoesOn = -1;

  std::vector<Run> runs_;
  std::vector<HeldPart> now_, begun_, ended_;
  std::int64_t tick_ = 0;  // of the last look()
};

}  // namespace tactus::cli
