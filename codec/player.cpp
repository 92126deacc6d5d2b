// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/rule.h>
#include <tactus/player.h>

#include <utility>

namespace tactus {

Player::Player(std::span<const std::uint8_t> file, StreamFileReader reader, Receiver receiver) noexcept
    : file_(file), reader_(std::move(reader)), receiver_(std::move(receiver)) {}

Result<Player> Player::open(std::span<const std::uint8_t> file, const ReceiverOptions& options) {
  TACTUS_TRY(StreamFileReader reader, StreamFileReader::open(file, options.limits));
  TACTUS_TRY(Receiver receiver, Receiver::create(reader.scene(), options));
  return Player(file, std::move(reader), std::move(receiver));
}

Result<std::optional<std::int64_t>> Player::next_tick() noexcept {
  if (!waiting_) {
    TACTUS_TRY(waiting_, reader_.next());
  }
  return waiting_ ? std::optional(waiting_->tick) : std::nullopt;
}

Result<std::optional<PlayedPacket>> Player::play(std::int64_t tick) noexcept {
  TACTUS_TRY(const auto due, next_tick());
  if (!due || *due > tick) return std::optional<PlayedPacket>{};
  const std::span<const std::uint8_t> bytes = waiting_->bytes;
  const auto offset = static_cast<std::size_t>(bytes.data() - file_.data());
  const auto decoded = receiver_.push(waiting_->number, bytes);
  waiting_.reset();
  if (!decoded) return fail_at(decoded.error(), 8 * std::uint64_t{offset} + decoded.error().bit_offset);
  if (decoded->tick != *due) return fail(Errc::invalid, "R-FIL-7", 8 * std::uint64_t{offset});
  return std::optional(PlayedPacket{*decoded, bytes.size(), offset});
}

}  // namespace tactus
