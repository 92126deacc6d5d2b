// SPDX-License-Identifier: Apache-2.0
/// What all substreams share: numbers, packet heads, stored baselines. Internal to the library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/scene/scene.h>

namespace tactus {

// ==== substream ====
// Which objects of a scene a packet belongs to. spec/25-packet.md section 1.

/// A packet of one substream: 0 is that of the rigid objects together, i + 1 that of deformable object i, the next that of the loads.
struct SubstreamPacket {
  std::size_t substream = 0;
  std::span<const std::uint8_t> bytes;  ///< after the substream number
};

/// True if packets of this scene begin with their substream number, that is, if there are several substreams.
bool has_substream_number(const Scene& scene) noexcept;

inline bool is_of_deformable(const Scene& scene, std::size_t substream) noexcept {
  return substream > 0 && substream <= scene.deformables.size();
}

/// Where lost packets go again, those of this substream may build on the one before: all but layers, of which each takes the other from its
/// baseline, those of profile thesis, and loads.
inline bool may_chain(const Scene& scene, std::size_t substream) noexcept {
  if (substream == 0) return true;
  if (!is_of_deformable(scene, substream)) return false;
  const DeformableObject& object = scene.deformables[substream - 1];
  return object.profile == DeformableProfile::main && !object.layered;
}

/// Split off the substream number. Without a number, and in a scene where nothing can move, all bytes are the packet.
/// err  truncated R-PKT-6 the number is missing; invalid R-PKT-6 there is no such substream.
Result<SubstreamPacket> split_substream(const Scene& scene, std::span<const std::uint8_t> packet) noexcept;

// ==== packet head ====
// The head of every payload: its baseline and its tick. spec/40-rigid.md section 2.

inline constexpr std::int64_t kTickLimit = 0xffffffff;                 ///< ticks of packets are below
inline constexpr std::uint64_t kNumberLimit = std::uint64_t{1} << 62;  ///< numbers of packets are below, and above 0
constexpr bool is_number(std::uint64_t number) noexcept { return number > 0 && number < kNumberLimit; }

struct PacketHead {
  bool key = false;
  std::uint32_t baseline_delta = 1;  ///< numbers back, 1..farthest_baseline(); unused by key packets
  std::uint32_t tick_delta = 0;      ///< from the baseline's tick
};

/// Largest baseline_delta of a scene: numbers need not be consecutive. With a span of 1 it is not coded.
constexpr std::uint32_t farthest_baseline(std::uint32_t span) noexcept { return span > 1 ? 4095 : 1; }

/// Key and baseline, as range-coded payloads have them.   in  models  with members key and baseline
template <class Coder, class Models>
void code_baseline(Coder& coder, Models& models, std::uint8_t span, PacketHead& head) noexcept {
  head.key = coder.bit(models.key, head.key ? 1u : 0u);
  if (!head.key && span > 1) head.baseline_delta = coder.magnitude(models.baseline, head.baseline_delta);
}

// ==== baseline ring ====
// The newest states of a substream, by the number of the packet that made them. spec/25-packet.md sections 4 and 5. Internal to the
// library.

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

/// state_hash() that is declared where a codec's state is.
template <class Object, class State>
std::uint64_t hash_of_state(const Object& object, const State& state) noexcept {
  return state_hash(object, state);
}

}  // namespace tactus
