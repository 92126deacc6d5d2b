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

/// Writes packets as they come. A file without finish() is readable but has no index.
class StreamFileWriter {
 public:
  /// err  io R-FIL-1.   pre  `out` outlives the writer and is in binary mode.
  static Result<StreamFileWriter> create(std::ostream& out, const Scene& scene);
  /// pre  ticks do not fall.   err  io R-FIL-1; invalid_argument R-API-5 (tick order).
  /// allocates a buffer that grows to the largest packet
  Result<void> add(std::int64_t tick, std::span<const std::uint8_t> packet, bool key);
  Result<void> finish();
  std::uint64_t header_bytes() const noexcept { return header_bytes_; }
  std::uint64_t bytes() const noexcept { return offset_; }  ///< written so far, header and records

 private:
  struct Entry {
    std::int64_t tick;
    std::uint64_t offset;
  };
  explicit StreamFileWriter(std::ostream& out) : out_(&out) {}
  Result<void> write_record(std::uint8_t type, std::span<const std::uint8_t> payload);

  std::ostream* out_;
  std::uint64_t header_bytes_ = 0, offset_ = 0;
  std::int64_t tick_ = 0;
  std::vector<Entry> keys_;
  std::vector<std::uint8_t> payload_, record_;
};

struct FilePacket {
  std::int64_t tick = 0;                ///< equals the tick inside the packet (R-FIL-7, checked by whoever decodes both)
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
  /// err  truncated R-FIL-2; unsupported R-FIL-3; limit_exceeded R-FIL-4; checksum R-FIL-5; malformed R-FIL-6, 8.
  ///      The reader then stays where it is.
  Result<std::optional<FilePacket>> next() noexcept;
  /// Seek to the last key packet at or before `tick`, by the index. Returns false and changes nothing if the file has no valid
  /// index or no key packet that early.
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
  bool find_index(std::span<const std::uint8_t>& entries) const noexcept;

  std::span<const std::uint8_t> file_;
  SharedScene scene_;
  DecodeLimits limits_;
  std::size_t first_ = 0;  // first record
  std::size_t position_ = 0;
  std::int64_t tick_ = 0;
  bool complete_ = false;
};

}  // namespace tactus
