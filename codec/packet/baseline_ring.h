// SPDX-License-Identifier: Apache-2.0
/// The newest states of a substream, by the number of the packet that made them. spec/25-packet.md sections 4 and 5. Internal to the
/// library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tactus {

/// `State` has a member tick.   time O(count) per call, count <= 64
template <class State>
class BaselineRing {
 public:
  BaselineRing(State initial, std::size_t count) : initial_(std::move(initial)), slots_(count), newest_(count) {
    for (Slot& slot : slots_) slot.state = initial_;
  }

  const State& initial() const noexcept { return initial_; }
  /// State with the highest number ever put, even if it is held no more; before the first, the initial state.
  const State& newest() const noexcept { return newest_ < slots_.size() ? slots_[newest_].state : initial_; }
  const State* find(std::uint64_t number) const noexcept {
    for (const Slot& slot : slots_)
      if (slot.held && slot.number == number) return &slot.state;
    return nullptr;
  }
  /// Lowest number held; nothing when none is.
  const std::uint64_t* lowest() const noexcept {
    const Slot* out = first_of([](const Slot& a, const Slot& b) { return a.number < b.number; });
    return out != nullptr ? &out->number : nullptr;
  }
  bool empty() const noexcept {
    return std::none_of(slots_.begin(), slots_.end(), [](const Slot& slot) { return slot.held; });
  }
  /// State shown at `tick` by a client that shows the past: the newest held that is not later, else the oldest. spec/60-client.md 6
  const State& at(std::int64_t tick) const noexcept {
    const Slot* out = first_of([tick](const Slot& a, const Slot& b) {
      const bool past = a.state.tick <= tick;
      if (past != (b.state.tick <= tick)) return past;
      return past ? a.number > b.number : a.number < b.number;
    });
    return out != nullptr ? out->state : newest();
  }

  /// Hold a new state, in place of that with the lowest number when all slots are taken.
  /// in   fill(State&)  writes it; the argument may be the baseline itself
  /// pre  `number` is above the lowest one held, or there is a free slot
  template <class Fill>
  void put(std::uint64_t number, Fill&& fill) noexcept {
    Slot* slot = &slots_.front();
    for (Slot& other : slots_)
      if (!other.held || (slot->held && other.number < slot->number)) slot = &other;
    fill(slot->state);
    slot->held = true;
    slot->number = number;
    if (newest_ >= slots_.size() || number >= slots_[newest_].number) newest_ = static_cast<std::size_t>(slot - slots_.data());
  }
  /// Discard the newest state.   pre  one was put since the last pop, and there are two slots
  void pop() noexcept {
    slots_[newest_].held = false;
    const Slot* left = first_of([](const Slot& a, const Slot& b) { return a.number > b.number; });
    newest_ = left != nullptr ? static_cast<std::size_t>(left - slots_.data()) : slots_.size();
  }
  /// Hold none. newest() stays what it is.
  void clear() noexcept {
    for (Slot& slot : slots_) slot.held = false;
  }

 private:
  struct Slot {
    bool held = false;
    std::uint64_t number = 0;
    State state;
  };

  /// The held slot that comes before all others; null when none is held.
  template <class Before>
  const Slot* first_of(Before&& before) const noexcept {
    const Slot* out = nullptr;
    for (const Slot& slot : slots_)
      if (slot.held && (out == nullptr || before(slot, *out))) out = &slot;
    return out;
  }

  State initial_;
  std::vector<Slot> slots_;
  std::size_t newest_;  // slots_.size(): none yet
};

}  // namespace tactus
