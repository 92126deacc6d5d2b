// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/fragments.h>

#include <algorithm>
#include <utility>

#include <tactus/base/rule.h>

namespace tactus {

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

}  // namespace tactus
