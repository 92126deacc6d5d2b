// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/fragments.h>

#include <algorithm>
#include <bit>
#include <utility>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>

namespace tactus {

// ==== fragments ====

Fragments::Fragments(std::size_t largest) : largest_(std::min(largest, kFragmentSize * kMostFragments)) {
  if (largest_ <= kFragmentSize) return;
  packets_.resize(kMost);
  for (Packet& packet : packets_) packet.bytes.resize(largest_);
}

Fragments::Packet* Fragments::find(std::uint64_t number, std::uint64_t substream) noexcept {
  for (Packet& packet : packets_)
    if (packet.number == number && packet.substream == substream) return &packet;
  return nullptr;
}

/// Where the fragment belongs; null: nowhere, as all slots hold newer packets. So one that was dropped never comes back: fragments of it
/// that were acknowledged are gone.
Fragments::Packet* Fragments::slot_for(std::uint64_t number, const FragmentPart& fragment) noexcept {
  if (Packet* const packet = find(number, fragment.substream)) return packet;
  const auto age = [](const Packet& packet) { return std::pair(packet.number, packet.substream); };
  Packet& oldest = *std::ranges::min_element(packets_, {}, age);
  if (age(oldest) > std::pair(number, fragment.substream)) return nullptr;
  oldest.number = number;
  oldest.substream = fragment.substream;
  oldest.count = static_cast<std::size_t>(fragment.count);
  oldest.have = oldest.size = 0;
  oldest.is_decoded = false;
  oldest.has.reset();
  return &oldest;
}

Result<Fragments::Taken> Fragments::take(std::uint64_t datagram, const FragmentPart& fragment) noexcept {
  const bool is_last = fragment.index + 1 == fragment.count;
  const bool sound = !packets_.empty() && fragment.count >= 2 && fragment.index < fragment.count &&
                     fragment.count <= kMostFragments && fragment.back < datagram && !fragment.bytes.empty() &&
                     fragment.bytes.size() <= kFragmentSize && (is_last || fragment.bytes.size() == kFragmentSize) &&
                     fragment.index * kFragmentSize + fragment.bytes.size() <= largest_;
  if (!sound) return fail(Errc::invalid, "R-SES-7");
  Packet* packet = slot_for(datagram - fragment.back, fragment);
  if (packet == nullptr) return Taken{};
  const auto index = static_cast<std::size_t>(fragment.index);
  if (packet->count != fragment.count) return fail(Errc::invalid, "R-SES-7");
  if (packet->has[index]) return Taken{packet->have < packet->count || packet->is_decoded, {}};
  packet->has[index] = true;
  std::ranges::copy(fragment.bytes, packet->bytes.begin() + static_cast<std::ptrdiff_t>(index * kFragmentSize));
  if (is_last) packet->size = index * kFragmentSize + fragment.bytes.size();
  if (++packet->have < packet->count) return Taken{true, {}};
  return Taken{false,
               Complete{packet->number, packet->substream, std::span<const std::uint8_t>(packet->bytes).first(packet->size)}};
}

void Fragments::decoded(const Complete& packet) noexcept { find(packet.number, packet.substream)->is_decoded = true; }

void Fragments::refused(const Complete& packet, std::size_t index) noexcept {
  Packet& mine = *find(packet.number, packet.substream);
  mine.has[index] = false;
  --mine.have;
}

// ==== pieces ====

std::optional<std::uint64_t> PieceSender::next() const noexcept {
  if (count_ >= pacer.window()) return std::nullopt;
  for (std::uint64_t index = front_; index < next_; index = (index | 63) + 1) {
    const std::uint64_t lost = ~(arrived_.word(index) | in_flight_.word(index)) >> index % 64;
    if (lost == 0) continue;
    const std::uint64_t first = index + static_cast<std::uint64_t>(std::countr_zero(lost));
    if (first < next_) return first;
  }
  if (next_ >= std::min(piece_count(bytes_->size()), front_ + piece_window(received_))) return std::nullopt;
  return next_;
}

std::span<const std::uint8_t> PieceSender::bytes(std::uint64_t index) const noexcept {
  const std::uint64_t begin = index * kPieceSize;
  return std::span(*bytes_).subspan(static_cast<std::size_t>(begin),
                                    static_cast<std::size_t>(std::min<std::uint64_t>(kPieceSize, bytes_->size() - begin)));
}

void PieceSender::sent(std::uint64_t index) noexcept {
  next_ = std::max(next_, index + 1);
  in_flight_.set(index);
  ++count_;
}

void PieceSender::arrived(std::uint64_t index) noexcept {
  lost(index);
  if (index < front_ || arrived_.has(index)) return;
  arrived_.set(index);
  ++received_;
  for (; front_ < next_ && arrived_.has(front_); ++front_) arrived_.clear(front_);
}

void PieceSender::lost(std::uint64_t index) noexcept {
  if (index < front_ || !in_flight_.has(index)) return;
  in_flight_.clear(index);
  --count_;
}

Result<void> PieceReceiver::take(std::uint64_t index, std::span<const std::uint8_t> bytes) try {
  const bool within = index < piece_count(size_) && index < front_ + piece_window(count());
  if (!within || bytes.size() != std::min(kPieceSize, size_ - index * kPieceSize)) return fail(Errc::invalid, "R-SES-8");
  if (index >= front_) above_.try_emplace(index, bytes.begin(), bytes.end());
  while (!above_.empty() && above_.begin()->first == front_) {
    const auto& next = above_.begin()->second;
    bytes_.insert(bytes_.end(), next.begin(), next.end());
    above_.erase(above_.begin());
    ++front_;
  }
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<std::span<const std::uint8_t>> PieceReceiver::declaration() const noexcept {
  Fnv1a hash;
  for (const std::uint8_t byte : bytes_) hash.add_byte(byte);
  if (hash.value() != hash_) return fail(Errc::checksum, "R-SES-10");
  return std::span<const std::uint8_t>(bytes_);
}

// ==== resends ====

namespace {

constexpr std::uint64_t kApart = 10'000;  // [us]

}  // namespace

Resends::Resends(std::size_t largest, std::size_t substreams)
    : kept_(kKept + std::min((largest + kFragmentSize - 1) / kFragmentSize, kMostFragments)),
      bytes_(kBytes + std::min(largest, kFragmentSize * kMostFragments)),
      broken_(substreams, 0),
      begun_(substreams, 0) {
  waiting_.reserve(kept_.size());
}

void Resends::unqueue(std::uint16_t slot) noexcept {
  std::erase(waiting_, slot);
  kept_[slot].copies = 0;
}

void Resends::settle(Kept& kept) noexcept {
  kept.is_settled = true;
  if (kept.copies > 0) unqueue(static_cast<std::uint16_t>(&kept - kept_.data()));
}

/// The oldest is dropped.
void Resends::pop() noexcept {
  Kept& oldest = kept_[first_];
  settle(oldest);
  oldest.datagrams = {};
  first_ = (first_ + 1) % kept_.size();
  --count_;
}

std::uint16_t Resends::keep(std::uint64_t datagram, const Packet& packet, const Portion& portion, std::uint64_t now,
                            bool is_chained) noexcept {
  const std::size_t size = portion.bytes.size(), capacity = bytes_.size();
  if (end_ % capacity + size > capacity) end_ += capacity - end_ % capacity;
  while (count_ == kept_.size() || (count_ > 0 && end_ + size > kept_[first_].begin + capacity)) pop();
  const std::size_t slot = (first_ + count_++) % kept_.size();
  kept_[slot] = {.datagrams = {datagram},
                 .number = packet.number,
                 .time = now,
                 .due = now,
                 .begin = end_,
                 .substream = static_cast<std::uint16_t>(packet.substream),
                 .index = static_cast<std::uint16_t>(portion.index),
                 .count = static_cast<std::uint16_t>(portion.count),
                 .size = static_cast<std::uint16_t>(size),
                 .copies = 0,
                 .is_chained = is_chained,
                 .is_settled = false};
  std::ranges::copy(portion.bytes, bytes_.begin() + static_cast<std::ptrdiff_t>(end_ % capacity));
  end_ += size;
  return static_cast<std::uint16_t>(slot);
}

bool Resends::keeps(std::uint16_t slot, std::uint64_t datagram) const noexcept {
  return slot != kNone && std::ranges::find(kept_[slot].datagrams, datagram) != kept_[slot].datagrams.end();
}

void Resends::arrived(std::uint16_t slot, std::uint64_t datagram) noexcept {
  if (slot == kNone) return;
  Kept& kept = kept_[slot];
  if (std::ranges::find(kept.datagrams, datagram) != kept.datagrams.end()) settle(kept);
}

void Resends::lost(std::uint16_t slot, std::uint64_t datagram, std::uint64_t now, unsigned copies) noexcept {
  if (slot == kNone) return;
  Kept& kept = kept_[slot];
  if (kept.is_settled || kept.datagrams[0] != datagram) return;
  if (kept.copies == 0) waiting_.push_back(slot);
  kept.copies = static_cast<std::uint8_t>(copies);
  kept.due = now;
}

const Resends::Kept* Resends::next(std::uint64_t now, const Latest& latest) noexcept {
  const Kept* out = nullptr;
  for (std::size_t i = 0; i < waiting_.size();) {
    Kept& kept = kept_[waiting_[i]];
    const std::uint64_t latest_after = kept.is_chained ? latest.chained : kept.substream == 0 ? latest.rigid : latest.shape;
    if (now + latest.one_way > kept.time + latest_after) {
      if (kept.is_chained) break_chain(kept.substream);
      settle(kept);
      continue;
    }
    if (kept.due <= now && (out == nullptr || kept.number < out->number)) out = &kept;
    ++i;
  }
  return out;
}

std::uint16_t Resends::sent(const Kept& copy, std::uint64_t datagram, std::uint64_t now) noexcept {
  const auto slot = static_cast<std::uint16_t>(&copy - kept_.data());
  Kept& kept = kept_[slot];
  std::ranges::copy_backward(kept.datagrams.begin(), kept.datagrams.end() - 1, kept.datagrams.end());
  kept.datagrams[0] = datagram;
  kept.due = now + kApart;
  if (kept.copies == 1) unqueue(slot);
  else --kept.copies;
  return slot;
}

std::optional<std::uint64_t> Resends::due() const noexcept {
  std::optional<std::uint64_t> out;
  for (const std::uint16_t slot : waiting_) out = std::min(out.value_or(kept_[slot].due), kept_[slot].due);
  return out;
}

void Resends::break_chain(std::size_t substream) noexcept {
  if (std::exchange(broken_[substream], std::uint8_t{1}) == 0) ++count_broken_;
}

std::optional<std::size_t> Resends::poll_broken() noexcept {
  if (count_broken_ == 0) return std::nullopt;
  const auto broken = std::ranges::find(broken_, std::uint8_t{1});
  *broken = 0;
  --count_broken_;
  return static_cast<std::size_t>(broken - broken_.begin());
}

void Resends::settle_chain(std::size_t substream, std::uint64_t number) noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    Kept& kept = kept_[(first_ + i) % kept_.size()];
    if (kept.substream == substream && kept.number < number) settle(kept);
  }
  begun_[substream] = number;
  if (std::exchange(broken_[substream], std::uint8_t{0}) == 1) --count_broken_;
}

// ==== held packets ====

/// So that the bytes begin at 0 without gaps.
void HeldPackets::compact() noexcept {
  order_.clear();
  for (std::size_t i = 0; i < held_.size(); ++i) order_.push_back(static_cast<std::uint16_t>(i));
  std::ranges::sort(order_, {}, [this](std::uint16_t i) { return held_[i].begin; });
  end_ = 0;
  for (const std::uint16_t i : order_) {
    Held& held = held_[i];
    const auto from = bytes_.begin() + static_cast<std::ptrdiff_t>(held.begin);
    std::copy(from, from + static_cast<std::ptrdiff_t>(held.size), bytes_.begin() + static_cast<std::ptrdiff_t>(end_));
    held.begin = end_;
    end_ += held.size;
  }
}

bool HeldPackets::hold(std::uint64_t number, std::size_t substream, std::span<const std::uint8_t> packet,
                       std::uint64_t now) noexcept {
  const auto name = [](const Held& held) { return std::pair(held.number, held.substream); };
  const auto slot = std::ranges::lower_bound(held_, std::pair(number, substream), {}, name);
  if (slot != held_.end() && name(*slot) == std::pair(number, substream)) return true;
  if (held_.size() == kMost) return false;
  if (end_ + packet.size() > bytes_.size()) compact();
  if (end_ + packet.size() > bytes_.size()) return false;
  std::ranges::copy(packet, bytes_.begin() + static_cast<std::ptrdiff_t>(end_));
  held_.insert(slot, {number, now, end_, packet.size(), substream});
  end_ += packet.size();
  return true;
}

std::optional<std::uint64_t> HeldPackets::waits_since(std::uint64_t now) const noexcept {
  std::optional<std::uint64_t> out;
  for (const Held& held : held_)
    if (now <= held.at + kLongest) out = std::min(out.value_or(held.at), held.at);
  return out;
}

}  // namespace tactus
