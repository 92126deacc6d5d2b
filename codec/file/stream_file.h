// SPDX-License-Identifier: Apache-2.0
/// Stream file (.tct): scene declaration, packets with tick and check value, an index to seek by. spec/80-file.md.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// The number of the newest packet of each substream.
class PacketNumbers {
 public:
  PacketNumbers() = default;
  explicit PacketNumbers(const Scene& scene);
  /// 0: there was none. Null: the bytes are of no substream, and nobody decodes them (R-PKT-6).
  std::uint64_t* of(std::span<const std::uint8_t> packet) noexcept;
  void reset() noexcept;

 private:
  bool has_substream_number_ = false;
  std::vector<std::uint64_t> newest_;  // by substream number
};

/// Writes packets as a sender gives them that counts their numbers. A file without finish() is readable but has no index.
class StreamFileWriter {
 public:
  /// err  io R-FIL-1.   pre  `out` outlives the writer and is in binary mode.
  static Result<StreamFileWriter> create(std::ostream& out, const Scene& scene);
  /// in   tick  they do not fall;  number, packet, key  as in Packet. A file does not hold numbers: each is one above
  ///      that of the packet of its substream before
  /// err  io R-FIL-1; invalid_argument R-API-5: the order of ticks, or a number that is not the next one, which nothing is written of
  /// allocates a buffer that grows to the largest packet
  Result<void> add(std::int64_t tick, std::uint64_t number, std::span<const std::uint8_t> packet, bool key);
  Result<void> finish();
  std::uint64_t header_bytes() const noexcept { return header_bytes_; }
  std::uint64_t bytes() const noexcept { return offset_; }  ///< written so far, header and records

 private:
  struct Entry {
    std::int64_t tick;
    std::uint64_t offset;
  };
  StreamFileWriter(std::ostream& out, const Scene& scene);
  Result<void> write_record(std::uint8_t type, std::span<const std::uint8_t> payload);

  std::ostream* out_;
  std::uint64_t header_bytes_ = 0, offset_ = 0;
  std::int64_t tick_ = 0;
  PacketNumbers numbers_;
  std::vector<Entry> keys_;
  std::vector<std::uint8_t> payload_, record_;
};

struct FilePacket {
  std::int64_t tick = 0;     ///< equals the tick inside the packet (R-FIL-7, checked by whoever decodes both)
  std::uint64_t number = 0;  ///< counted in its substream from the start or from seek(), or as a numbered record names it
  std::span<const std::uint8_t> bytes;  ///< into the file's bytes
};

/// Reads a file that is in memory, front to back or from a key packet. Allocates for the scene only.
class StreamFileReader {
 public:
  /// err  as parse_scene
  static Result<StreamFileReader> open(std::span<const std::uint8_t> file, const DecodeLimits& limits = {});

  const SharedScene& scene() const noexcept { return scene_; }
  std::uint64_t header_bytes() const noexcept { return first_; }
  /// Next packet; nothing at the end. Unknown extension records are skipped.
  /// err  truncated R-FIL-2; unsupported R-FIL-3; malformed R-FIL-6, 8, 9; limit_exceeded R-FIL-4; checksum R-FIL-5.
  ///      The reader then stays where it is.
  Result<std::optional<FilePacket>> next() noexcept;
  /// Seek to the last key packet at or before `tick`, by the index. Returns false and changes nothing if the file has no valid
  /// index or no key packet that early. Numbers are counted from there: what comes is for a new Receiver.
  bool seek(std::int64_t tick) noexcept;
  /// True once the file's trailer was read: the file is complete.
  bool complete() const noexcept { return complete_; }
  std::uint64_t position() const noexcept { return position_; }  ///< bytes from the start of the file

 private:
  struct Record {
    std::uint8_t type = 0;
    std::size_t start = 0;  // of the payload
    std::span<const std::uint8_t> payload;
    std::size_t end = 0;  // of the record
  };
  Result<Record> read_record(std::size_t at) const noexcept;
  Result<FilePacket> read_packet(const Record& record) noexcept;
  bool find_index(std::span<const std::uint8_t>& entries) const noexcept;

  std::span<const std::uint8_t> file_;
  SharedScene scene_;
  DecodeLimits limits_;
  std::size_t first_ = 0;  // first record
  std::size_t position_ = 0;
  std::int64_t tick_ = 0;
  PacketNumbers numbers_;
  std::uint8_t packet_type_ = 0;  // of the records of packets; 0: there was none yet
  bool complete_ = false;
};

}  // namespace tactus
