// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/diagnostic.h>
#include <tactus/base/rule.h>
#include <tactus/trace/bag_folder.h>
#include <tactus/trace/byte_source.h>
#include <tactus/trace/input_budget.h>
#include <tactus/trace/mcap.h>
#include <tactus/trace/read_notes.h>

namespace tactus::mcap {

/// What a reader accepts before it allocates.
struct ReadLimits {
  std::uint64_t record_bytes = 256u << 20;      ///< content of a record that must be held whole
  std::uint64_t chunk_bytes = 256u << 20;       ///< uncompressed records of a chunk
  std::uint64_t declaration_bytes = 16u << 20;  ///< all schemas and channels together
};

/// What next() found.
enum class Item : std::uint8_t { end, message, attachment, metadata };

/// Reads any MCAP file, or the files of a bag one after the other, front to back and trusts nothing in it. A file that is zstd or LZ4 as a
/// whole is unpacked on the way, as are messages that rosbag2 compressed one by one. In a later file of a bag, channels and schemas keep the
/// numbers that they, or their equals, have had in the files before. Holds one record and one chunk at a time. The memory of a record
/// grows with the bytes read, not with the length announced. A compressed chunk takes its announced size at once, within ReadLimits
/// and the budget: 64 MiB, and 256 bytes more for each byte read (input_budget.h). Checks every CRC that is present. Unknown records
/// are skipped.
/// err (all)  R-TRC-1 .. R-TRC-11, R-TRC-18 as listed in trace_file.h; the offset is that of the record at top level.
class Reader {
 public:
  static tl::expected<Reader, Diagnostic> open(ByteSource source, const ReadLimits& limits = {});
  static tl::expected<Reader, Diagnostic> open(RecordingFiles files, OnDamage on_damage = OnDamage::refuse,
                                               const ReadLimits& limits = {});
  /// Called at each record at top level with how far the reading has come.   pre  all bytes are known; `watcher` outlives the reading
  void watch(ReadWatcher* watcher, std::uint64_t all) noexcept { watcher_ = watcher, watched_bytes_ = all; }

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
  /// Messages of a channel that were read so far.
  std::uint64_t messages_of(std::uint16_t channel) const noexcept { return channel < counts_.size() ? counts_[channel] : 0; }

  /// Charge bytes that are handed out without having been read.   err  R-TRC-18
  Result<void> spend(std::uint64_t bytes) noexcept {
    return budget_.spend(bytes) ? Result<void>() : refuse(Errc::limit_exceeded, "R-TRC-18");
  }

  /// An error of this reader, or of what the current message says, with all that is known of the location.
  Diagnostic explain(const Error& error) const;
  /// What was decided about the files.
  const ReadNotes& notes() const noexcept { return notes_; }
  /// What OnDamage::skip left out so far.
  const std::vector<ReadLoss>& losses() const noexcept { return losses_; }
  /// The current message, or all messages of a time, are left out by the one who reads them.
  void lose_message(const Error& cause) { lose(cause, 0, message_.log_time, message_.log_time); }
  void lose_tick(const Error& cause, std::uint64_t time) { lose(fail_at(cause, 8 * record_start_).value(), 0, time, time); }
  bool skips_damage() const noexcept { return on_damage_ == OnDamage::skip; }
  /// Bytes read of all files, packed as they are.
  std::uint64_t bytes_read() const noexcept { return files_before_ + source_.stored_bytes_read(); }
  const RecordingFiles& files() const noexcept { return files_; }

  /// True if the input, or one of its files, ended before the footer. Valid once next() has returned Item::end.
  bool cut_short() const noexcept { return cut_short_; }
  /// File position of the current record [bytes].
  std::uint64_t offset() const noexcept { return record_start_; }
  /// Statistics of a complete file that is not a pipe. Looks ahead without moving the read position.
  std::optional<Statistics> statistics();

 private:
  enum class Section : std::uint8_t { data, summary, done };
  enum class Within : std::uint8_t { top, chunk_record, chunk_rest };  // what damage spoils
  Reader(ByteSource source, const ReadLimits& limits) : source_(std::move(source)), limits_(limits) {}

  tl::expected<void, Diagnostic> start_file();
  Result<bool> next_file();
  Result<std::optional<Item>> step();
  Result<void> get_over(const Error& error);
  Result<void> search_record(const Error& error);
  bool is_record(std::span<const std::uint8_t> at) const;
  void declare_from_summary();
  std::optional<std::vector<std::uint8_t>> read_summary();
  void lose(const Error& cause, std::uint64_t bytes, std::optional<std::uint64_t> from, std::optional<std::uint64_t> until);
  Result<void> unpack_message();

  Result<std::size_t> read_source(std::span<std::uint8_t> out);
  Result<bool> read_exactly(std::vector<std::uint8_t>& out, std::uint64_t count);
  Result<bool> skip(std::uint64_t count);
  Result<std::optional<Item>> next_at_top();
  Result<std::optional<Item>> next_in_chunk();
  Result<std::optional<Item>> take_record(Opcode opcode, ByteReader content);
  Result<void> open_chunk(ByteReader content);
  Result<void> add_schema(ByteReader content);
  Result<void> add_channel(ByteReader content);
  /// Of the schemas or the channels of this file and of the files before.
  struct Numbers {
    std::map<std::uint16_t, std::uint16_t> of_file;  // that this file gives them -> in schemas_, channels_
    std::map<std::string, std::uint16_t> by_content;
    std::uint32_t free = 1;  // none below is
  };
  template <class Declared, class Equals>
  Result<void> declare(Declared declared, std::string content, std::map<std::uint16_t, Declared>& known, Numbers& numbers,
                       const Equals& equals);
  Result<Item> take_message(ByteReader content);
  Result<Item> take_attachment(ByteReader content);
  Result<Item> take_metadata(ByteReader content);
  Result<void> end_data(ByteReader content, std::uint32_t crc_before);
  Result<void> end_file(ByteReader content, std::uint32_t crc_before);
  tl::unexpected<Error> refuse(Errc code, RuleName rule) const noexcept { return fail(code, rule, 8 * record_start_); }

  ByteSource source_;
  RecordingFiles files_;
  std::size_t file_ = 0;            // that is read
  std::uint64_t files_before_ = 0;  // their bytes
  std::uint64_t earned_ = 0;        // stored bytes of this file that the budget knows of
  bool is_unpacked_ = false;
  bool is_spoilt_ = false;  // its packed bytes are damaged from here on
  std::size_t cut_noted_ = static_cast<std::size_t>(-1);
  ReadLimits limits_;
  OnDamage on_damage_ = OnDamage::refuse;
  std::vector<ReadLoss> losses_;
  ReadNotes notes_;
  std::vector<std::uint8_t> ahead_;  // bytes that the search for a record gave back
  std::size_t ahead_begin_ = 0;
  InputBudget budget_;
  Section section_ = Section::data;
  bool cut_short_ = false;
  std::uint64_t position_ = 0, record_start_ = 0, summary_start_ = 0;
  std::uint32_t crc_ = 0;                      // of the section so far
  std::vector<std::uint8_t> prefix_, record_;  // of the record at top level
  std::vector<std::uint8_t> chunk_;            // decompressed
  std::size_t chunk_position_ = 0;
  std::uint64_t chunk_number_ = 0, chunk_from_ = 0, chunk_until_ = 0;  // of the file, from 1; log times that it announces
  Within within_ = Within::top;
  bool at_message_ = false;                 // the current record is message_
  std::optional<std::uint64_t> last_time_;  // [ns] of the last message
  Numbers schema_numbers_, channel_numbers_;
  std::vector<std::uint8_t> unpacked_message_;
  std::uint64_t declared_bytes_ = 0;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::vector<std::uint64_t> counts_;  // of messages, by channel
  ReadWatcher* watcher_ = nullptr;
  std::uint64_t watched_bytes_ = 0;
  Message message_;
  Attachment attachment_;
  Metadata metadata_;
};

}  // namespace tactus::mcap
