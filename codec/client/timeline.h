// SPDX-License-Identifier: Apache-2.0
/// What a client that shows the past keeps of each object, and how it bends over gaps. Integers. spec/60-client.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <tactus/rigid/rigid_predictor.h>
#include <tactus/rigid/rigid_state.h>

namespace tactus {

// ==== timeline ====
// What a client that shows the past knows of one object: its newest updates, in the order of their ticks. spec/60-client.md section 7.

class Timeline {
 public:
  static constexpr std::size_t kMost = 64;

  struct Update {
    std::uint64_t number = 0;  ///< of the packet that made it; 0: the initial state
    RigidState state;
  };
  /// The updates on either side of a tick.
  struct Around {
    const Update& before;  ///< the last that is not later; without one, the first
    const Update* after;   ///< the next; null: none is known
  };

  /// Begin with an initial state.
  void reset(const RigidState& initial) noexcept;
  /// Add an update; without room, in place of the first one, which may be this.   time O(1) for updates in order
  void add(const Update& update) noexcept;
  Around around(std::int64_t tick) const noexcept;  ///< time O(updates after `tick`)
  /// The update before one of around(); null: there is none.
  const Update* previous(const Update& update) const noexcept { return &update == updates_.data() ? nullptr : &update - 1; }

 private:
  std::array<Update, kMost> updates_;  // ordered by (tick, number)
  std::size_t count_ = 1;
};

/// Which of the newest packets were decoded.
class HeardPackets {
 public:
  static constexpr std::uint64_t kReach = 1024;  ///< numbers

  void reset() noexcept { *this = {}; }
  void add(std::uint64_t number) noexcept;
  /// Whether all packets between two numbers were decoded, these not counted.   time O(numbers between), at most kReach
  bool all_between(std::uint64_t first, std::uint64_t last) const noexcept;

 private:
  bool has(std::uint64_t number) const noexcept {
    return newest_ - number < kReach && (bits_[word(number)] >> (number % 64) & 1u);
  }
  static std::size_t word(std::uint64_t number) noexcept { return static_cast<std::size_t>(number / 64 % (kReach / 64)); }

  std::array<std::uint64_t, kReach / 64> bits_{};
  std::uint64_t newest_ = 0;  // 0: none
};

// ==== bend ====
// The way of an object between two updates when a packet between them is missing. spec/60-client.md section 7.

/// A cubic that leaves `a` and meets `b` with their velocities; a straight line where these are 0.
/// Its error grows with the fourth power of the time between, that of dead reckoning with the second.
/// pre  a.tick <= tick <= b.tick, a.tick < b.tick, b.tick - a.tick <= max_extrapolation.   time about 0.5 us, no allocation.
RigidPose bend(const Scene& scene, const RigidState& a, const RigidState& b, std::int64_t tick) noexcept;

}  // namespace tactus
