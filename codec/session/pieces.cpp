// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/pieces.h>

#include <algorithm>

#include <tactus/base/hash.h>
#include <tactus/base/out_of_memory.h>
#include <tactus/base/rule.h>

namespace tactus {

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

}  // namespace tactus
