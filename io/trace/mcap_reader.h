// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>
#include <tactus/trace/byte_source.h>
#include <tactus/trace/input_budget.h>
#include <tactus/trace/mcap.h>

namespace tactus::mcap {

/// What a reader accepts before it allocates.
struct ReadLimits {
  std::uint64_t record_bytes = 256u << 20;      ///< content of a record that must be held whole
  std::uint64_t chunk_bytes = 256u << 20;       ///< uncompressed records of a chunk
  std::uint64_t declaration_bytes = 16u << 20;  ///< all schemas and channels together
};

/// What next() found.
enum class Item : std::uint8_t { end, message, attachment, metadata };

/// Reads any MCAP file front to back and trusts nothing in it. Holds one record and one chunk at a time. The memory of a record
/// grows with the bytes read, not with the length announced. A compressed chunk takes its announced size at once, within ReadLimits
/// and the budget: 64 MiB, and 256 bytes more for each byte read (input_budget.h). Checks every CRC that is present. Unknown records
/// are skipped.
/// err (all)  R-TRC-1 .. R-TRC-11, R-TRC-18 as listed in trace_file.h; the offset is that of the record at top level.
class Reader {
 public:
  static Result<Reader> open(ByteSource source, const ReadLimits& limits = {});

  /// Move on to the next message, attachment or metadata record; schemas and channels are noted on the way. After an error the
  /// reader must not be used further.
  Result<Item> next();

  /// What next() found; valid until its next call.
  const Message& message() const noexcept { return message_; }
  const Attachment& attachment() const noexcept { return attachment_; }
  const Metadata& metadata() const noexcept { return metadata_; }

  /// Everything declared so far.
  const std::map<std::uint16_t, Schema>& schemas() const noexcept { return schemas_; }
  const std::map<std::uint16_t, Channel>& channels() const noexcept { return channels_; }

  /// Charge bytes that are handed out without having been read.   err  R-TRC-18
  Result<void> spend(std::uint64_t bytes) noexcept {
    return budget_.spend(bytes) ? Result<void>() : refuse(Errc::limit_exceeded, "R-TRC-18");
  }

  /// True if the input ended before the footer. Valid once next() has returned Item::end.
  bool cut_short() const noexcept { return cut_short_; }
  /// File position of the current record [bytes].
  std::uint64_t offset() const noexcept { return record_start_; }
  /// Statistics of a complete file that is not a pipe. Looks ahead without moving the read position.
  std::optional<Statistics> statistics();

 private:
  enum class Section : std::uint8_t { data, summary, done };
  Reader(ByteSource source, const ReadLimits& limits) : source_(std::move(source)), limits_(limits) {}

  Result<bool> read_exactly(std::vector<std::uint8_t>& out, std::uint64_t count);
  Result<bool> skip(std::uint64_t count);
  Result<std::optional<Item>> next_at_top();
  Result<std::optional<Item>> next_in_chunk();
  Result<std::optional<Item>> take_record(Opcode opcode, ByteReader content);
  Result<void> open_chunk(ByteReader content);
  Result<void> add_schema(ByteReader content);
  Result<void> add_channel(ByteReader content);
  Result<Item> take_message(ByteReader content);
  Result<Item> take_attachment(ByteReader content);
  Result<Item> take_metadata(ByteReader content);
  Result<void> end_data(ByteReader content, std::uint32_t crc_before);
  Result<void> end_file(ByteReader content, std::uint32_t crc_before);
  tl::unexpected<Error> refuse(Errc code, RuleName rule) const noexcept { return fail(code, rule, 8 * record_start_); }

  ByteSource source_;
  ReadLimits limits_;
  InputBudget budget_;
  Section section_ = Section::data;
  bool cut_short_ = false;
  std::uint64_t position_ = 0, record_start_ = 0, summary_start_ = 0;
  std::uint32_t crc_ = 0;                      // of the section so far
  std::vector<std::uint8_t> prefix_, record_;  // of the record at top level
  std::vector<std::uint8_t> chunk_;            // decompressed
  std::size_t chunk_position_ = 0;
  std::uint64_t declared_bytes_ = 0;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  Message message_;
  Attachment attachment_;
  Metadata metadata_;
};

}  // namespace tactus::mcap
