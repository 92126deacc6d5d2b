// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/resends.h>

#include <algorithm>

#include <tactus/session/fragments.h>

namespace tactus {
namespace {

constexpr std::uint64_t kLatest = 120'000;  // [us] from the first sending to the arrival of a copy
constexpr std::uint64_t kApart = 10'000;    // [us]

}  // namespace

Resends::Resends(std::size_t largest) : kept_(kKept + std::min((largest + kFragmentSize - 1) / kFragmentSize, kMostFragments)) {
  for (Kept& kept : kept_) kept.bytes.reserve(kFragmentSize);
}

void Resends::keep(std::uint64_t datagram, const Packet& packet, const Portion& portion, std::uint64_t now) noexcept {
  Kept& kept = kept_[next_];
  next_ = (next_ + 1) % kept_.size();
  waiting_ -= kept.copies;
  kept.datagram = datagram;
  kept.number = packet.number;
  kept.time = now;
  kept.substream = static_cast<std::uint16_t>(packet.substream);
  kept.sequence = packet.sequence;
  kept.index = static_cast<std::uint16_t>(portion.index);
  kept.count = static_cast<std::uint16_t>(portion.count);
  kept.copies = 0;
  kept.bytes.assign(portion.bytes.begin(), portion.bytes.end());
}

void Resends::lost(std::uint64_t datagram, std::uint64_t now, unsigned copies) noexcept {
  for (Kept& kept : kept_) {
    if (kept.datagram != datagram) continue;
    waiting_ += copies - kept.copies;
    kept.copies = copies;
    kept.due = now;
  }
}

const Resends::Kept* Resends::next(std::uint64_t now, std::uint64_t way) noexcept {
  if (waiting_ == 0) return nullptr;
  const Kept* out = nullptr;
  for (Kept& kept : kept_) {
    if (kept.copies > 0 && now + way > kept.time + kLatest) {
      waiting_ -= kept.copies;
      kept.copies = 0;
    }
    if (kept.copies > 0 && kept.due <= now && (out == nullptr || kept.number < out->number)) out = &kept;
  }
  return out;
}

void Resends::sent(const Kept& copy, std::uint64_t now) noexcept {
  Kept& kept = kept_[static_cast<std::size_t>(&copy - kept_.data())];
  --kept.copies;
  --waiting_;
  kept.due = now + kApart;
}

std::optional<std::uint64_t> Resends::due() const noexcept {
  std::optional<std::uint64_t> out;
  if (waiting_ == 0) return out;
  for (const Kept& kept : kept_)
    if (kept.copies > 0) out = std::min(out.value_or(kept.due), kept.due);
  return out;
}

}  // namespace tactus
