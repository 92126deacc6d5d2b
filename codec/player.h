// SPDX-License-Identifier: Apache-2.0
/// A stream file as a client sees it, tick by tick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <tactus/base/result.h>
#include <tactus/file/stream_file.h>
#include <tactus/receiver.h>

namespace tactus {

/// A packet of a file, decoded.
struct PlayedPacket : DecodedPacket {
  std::size_t bytes = 0;   ///< of the packet, with the number of its substream
  std::size_t offset = 0;  ///< of the packet in the file
};

/// Plays a stream file into a replica, as if every packet arrived in the tick that sent it.
class Player {
 public:
  /// pre  `file` outlives the player.   err  as StreamFileReader::open and Receiver::create
  static Result<Player> open(std::span<const std::uint8_t> file, const ReceiverOptions& options = {});

  /// Apply the next packet that is due at `tick`; nothing when none is.
  /// err  as StreamFileReader::next and Receiver::push, with offsets counted from the start of the file; invalid R-FIL-7: the
  ///      file and the packet name different ticks.
  Result<std::optional<PlayedPacket>> play(std::int64_t tick) noexcept;
  /// Tick of the next packet; nothing at the end.   err  as play()
  Result<std::optional<std::int64_t>> next_tick() noexcept;

  /// What Receiver::pose() and Receiver::displacements() show.
  Pose pose(std::uint32_t object, std::int64_t tick) const noexcept { return receiver_.pose(object, tick); }
  std::span<const float> displacements(std::size_t object, std::int64_t tick) noexcept {
    return receiver_.displacements(object, tick);
  }

  Receiver& receiver() noexcept { return receiver_; }
  Replica& replica() noexcept { return receiver_.replica(); }
  const Scene& scene() const noexcept { return *reader_.scene(); }
  std::uint64_t header_bytes() const noexcept { return reader_.header_bytes(); }
  bool complete() const noexcept { return reader_.complete(); }  ///< valid after the last packet

 private:
  Player(std::span<const std::uint8_t> file, StreamFileReader reader, Receiver receiver) noexcept;

  std::span<const std::uint8_t> file_;
  StreamFileReader reader_;
  Receiver receiver_;
  std::optional<FilePacket> waiting_;
};

}  // namespace tactus
