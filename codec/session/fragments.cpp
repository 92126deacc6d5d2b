// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/fragments.h>

#include <algorithm>
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

/// Where the fragment belongs; null: nowhere, as all places hold newer packets. So one that gave way never comes back: fragments of it
/// that were acknowledged are gone.
Fragments::Packet* Fragments::place_for(std::uint64_t number, const FragmentPart& fragment) noexcept {
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
  Packet* packet = place_for(datagram - fragment.back, fragment);
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

// ==== pieces ====

std::optional<std::uint64_t> PieceSender::next(std::uint64_t now, std::uint64_t patience) const noexcept {
  const std::uint64_t end = std::min(piece_count(bytes_->size()), arrived_.front() + most_);
  for (std::uint64_t index = arrived_.front(); index < end; ++index) {
    const OnItsWay& sent = on_its_way_[index % kPieceWindow];
    const bool waits = sent.number > 0 && sent.index == index && now < sent.time + patience;
    if (!waits && !arrived_.has(index)) return index;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> PieceSender::due(std::uint64_t patience) const noexcept {
  std::optional<std::uint64_t> out;
  for (const OnItsWay& sent : on_its_way_)
    if (sent.number > 0 && sent.index < arrived_.front() + most_ && !arrived_.has(sent.index))
      out = std::min(out.value_or(~std::uint64_t{0}), sent.time + patience);
  return out;
}

std::span<const std::uint8_t> PieceSender::bytes(std::uint64_t index) const noexcept {
  const std::uint64_t begin = index * kPieceSize;
  return std::span(*bytes_).subspan(static_cast<std::size_t>(begin),
                                    static_cast<std::size_t>(std::min<std::uint64_t>(kPieceSize, bytes_->size() - begin)));
}

void PieceSender::sent(std::uint64_t index, std::uint64_t number, std::uint64_t now) noexcept {
  on_its_way_[index % kPieceWindow] = {index, number, now};
}

void PieceSender::arrived(std::uint64_t number) noexcept {
  for (OnItsWay& sent : on_its_way_) {
    if (sent.number != number) continue;
    sent.number = 0;
    most_ = std::min(most_ + 1, kPieceWindow);
    return arrived_.add(sent.index);
  }
}

void PieceSender::lost(std::uint64_t number) noexcept {
  for (OnItsWay& sent : on_its_way_)
    if (sent.number == number) sent.number = 0;
}

void PieceSender::slow_down() noexcept { most_ = std::max(most_ / 2, kFewest); }

Result<void> PieceReceiver::take(std::uint64_t index, std::span<const std::uint8_t> bytes) try {
  const std::uint64_t begin = index * kPieceSize;
  const bool within = index < piece_count(size_) && index < have_.front() + kPieceWindow;
  if (!within || bytes.size() != std::min(kPieceSize, size_ - begin)) return fail(Errc::invalid, "R-SES-8");
  if (have_.has(index)) return {};
  const auto end = static_cast<std::size_t>(begin + bytes.size());
  if (bytes_.size() < end) bytes_.resize(end);
  std::ranges::copy(bytes, bytes_.begin() + static_cast<std::ptrdiff_t>(begin));
  have_.add(index);
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
