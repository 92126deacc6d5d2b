// SPDX-License-Identifier: Apache-2.0
/// The parts of a truth that are held, from tick to tick. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/packet/held_part.h>

namespace tactus {

class HeldList {
 public:
  static constexpr std::uint32_t kMostContacts = 16;  ///< that are listed of a tick

  /// allocates, and nothing later
  explicit HeldList(const Scene& scene) {
    const std::size_t rigid = scene.objects.size(), meshes = scene.deformables.size();
    slots_[static_cast<std::size_t>(TruthPart::object)].assign(rigid, kNone);
    slots_[static_cast<std::size_t>(TruthPart::shape)].assign(meshes, kNone);
    slots_[static_cast<std::size_t>(TruthPart::touch)].assign(meshes, kNone);
    if (scene.loads) slots_[static_cast<std::size_t>(TruthPart::load)].assign(rigid, kNone);
    const std::size_t most = rigid * (scene.loads ? 2 : 1) + 2 * meshes + 2 * std::size_t{kMostContacts};
    parts_.reserve(most);
    seen_.reserve(most);
  }

  std::span<const HeldPart> parts() const noexcept { return parts_; }
  bool empty() const noexcept { return parts_.empty(); }
  /// In this tick, as far as it was looked at.
  bool has(TruthPart part, std::uint32_t index) const noexcept {
    const std::uint32_t at = find(part, index);
    return at != kNone && is_seen(at);
  }
  /// It was found to be bad, or kept, in this tick.
  bool is_seen(std::size_t at) const noexcept { return seen_[at] == ticks_; }

  /// Before the parts of a tick are looked at.
  void begin() noexcept {
    ++ticks_;
    contacts_ = 0;
  }
  /// It breaks this rule.   out  it was not held in the tick before
  bool hold(const HeldPart& held) noexcept {
    if (held.part == TruthPart::contact && contacts_++ >= kMostContacts) return false;
    const std::uint32_t at = find(held.part, held.index);
    if (at != kNone) {
      parts_[at].rule = held.rule;
      seen_[at] = ticks_;
      return false;
    }
    if (held.part != TruthPart::contact) slot(held) = static_cast<std::uint32_t>(parts_.size());
    parts_.push_back(held);
    seen_.push_back(ticks_);
    return true;
  }
  /// There is no news of it: if it was held, it is.
  void keep(TruthPart part, std::uint32_t index) noexcept {
    if (const std::uint32_t at = find(part, index); at != kNone) seen_[at] = ticks_;
  }
  void keep(std::size_t at) noexcept { seen_[at] = ticks_; }
  /// After the parts of a tick were looked at: what was not held in it breaks no rule any more.
  void end() noexcept {
    if (std::ranges::all_of(seen_, [this](std::uint64_t seen) { return seen == ticks_; })) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const HeldPart part = parts_[i];
      const bool stays = is_seen(i);
      if (part.part != TruthPart::contact) slot(part) = stays ? static_cast<std::uint32_t>(kept) : kNone;
      if (!stays) continue;
      parts_[kept] = part;
      seen_[kept++] = ticks_;
    }
    parts_.resize(kept);
    seen_.resize(kept);
  }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  std::uint32_t& slot(const HeldPart& held) noexcept { return slots_[static_cast<std::size_t>(held.part)][held.index]; }
  std::uint32_t find(TruthPart part, std::uint32_t index) const noexcept {
    if (part != TruthPart::contact) return slots_[static_cast<std::size_t>(part)][index];
    const auto found =
        std::ranges::find_if(parts_, [&](const HeldPart& held) { return held.part == part && held.index == index; });
    return found == parts_.end() ? kNone : static_cast<std::uint32_t>(found - parts_.begin());
  }

  std::vector<HeldPart> parts_;
  std::vector<std::uint64_t> seen_;                  // of each: the tick, counted, that found it so last
  std::array<std::vector<std::uint32_t>, 5> slots_;  // by part and index: where it is in parts_; contacts have none
  std::uint64_t ticks_ = 0;                          // that were looked at
  std::uint32_t contacts_ = 0;                       // that are bad in this one
};

}  // namespace tactus
