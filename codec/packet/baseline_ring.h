// SPDX-License-Identifier: Apache-2.0
/// The newest states of a substream, by the number of the packet that made them. spec/25-packet.md sections 4 and 5. Internal to the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tactus {

/// `State` has a member tick.
template <class State>
class BaselineRing {
 public:
  BaselineRing(State initial, std::size_t count) : initial_(std::move(initial)), slots_(count) {
    for (Slot& slot : slots_) slot.state = initial_;
  }

  const State& initial() const noexcept { return initial_; }
  /// State after the last packet; before the first, the initial state.
  const State& newest() const noexcept { return slots_[newest_].held ? slots_[newest_].state : initial_; }
  const State* find(std::uint64_t number) const noexcept {
    for (const Slot& slot : slots_)
      if (slot.held && slot.number == number) return &slot.state;
    return nullptr;
  }

  /// Replace the oldest state by a new one.   in  fill(State&)  writes it; the argument may be the baseline itself
  template <class Fill>
  void push(std::uint64_t number, Fill&& fill) noexcept {
    newest_ = (newest_ + 1) % slots_.size();
    Slot& slot = slots_[newest_];
    fill(slot.state);
    slot.held = true;
    slot.number = number;
  }
  /// Discard the newest state.   pre  one was pushed since the last pop, and there are two slots
  void pop() noexcept {
    slots_[newest_].held = false;
    newest_ = (newest_ + slots_.size() - 1) % slots_.size();
  }

 private:
  struct Slot {
    bool held = false;
    std::uint64_t number = 0;
    State state;
  };

  State initial_;
  std::vector<Slot> slots_;
  std::size_t newest_ = 0;
};

}  // namespace tactus
