// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/trace/byte_source.h>
#include <tactus/trace/input_budget.h>
#include <tactus/trace/mcap.h>

namespace tactus::mcap {

/// Writes an MCAP file front to back: messages in zstd chunks with message indexes, then a summary with all indexes and
/// statistics, and every check value that the format offers. Equal calls give equal bytes. A chunk that would exceed a reader's
/// remaining budget when unpacked is stored uncompressed, so that no file of ours is refused.
/// err (all)  io R-TRC-1: the operating system refused; the file is then unusable from that position on.
class Writer {
 public:
  /// path "-" is standard output.
  static Result<Writer> create(const std::string& path, std::string_view profile);

  /// pre  ids are new, a channel's schema was added before; not between the messages of a chunk.
  Result<void> add(const Schema& schema);
  Result<void> add(const Channel& channel);
  Result<void> add(const Attachment& attachment);
  Result<void> add(const Metadata& metadata);

  /// Append to the open chunk; nothing reaches the file before end_chunk().   pre  the channel was added.
  void add(const Message& message);
  std::size_t chunk_size() const noexcept { return chunk_.size(); }
  std::uint64_t chunk_start_time() const noexcept { return chunk_start_time_; }
  /// Compress the open chunk, hand it to the operating system and start the next; nothing to do when it is empty.
  Result<void> end_chunk();

  /// Write the last chunk, summary and footer. No calls are allowed afterwards.
  Result<void> finish();

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const noexcept;
  };
  using File = std::unique_ptr<std::FILE, CloseFile>;
  struct ChannelState {
    Channel channel;
    std::uint64_t message_count = 0;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> index;  // of the open chunk: log time, offset in the chunk
  };
  using SummaryGroups = std::vector<std::pair<Opcode, std::vector<std::uint8_t>>>;

  explicit Writer(File file) : file_(std::move(file)) {}
  Result<void> write_record(Opcode opcode, std::span<const std::uint8_t> content);
  Result<void> write_bytes(std::span<const std::uint8_t> bytes);
  void reset_chunk() noexcept;
  struct StoredChunk {
    std::string_view compression;
    std::span<const std::uint8_t> records;
  };
  Result<StoredChunk> stored_chunk();
  void append_chunk_index(std::uint64_t chunk_start, std::uint64_t chunk_length, const StoredChunk& stored,
                          const std::map<std::uint16_t, std::uint64_t>& index_offsets, std::uint64_t index_length);
  std::vector<std::uint8_t> statistics() const;
  SummaryGroups summary_groups() const;

  File file_;
  std::uint64_t position_ = 0;
  std::uint32_t crc_ = 0;  // of everything written so far
  Compressor compressor_;
  InputBudget budget_;               // what a reader of the file has left
  std::vector<std::uint8_t> chunk_;  // records of the open chunk
  std::uint64_t chunk_start_time_ = 0, chunk_end_time_ = 0;
  std::vector<Schema> schemas_;
  std::map<std::uint16_t, ChannelState> channels_;
  std::vector<std::uint8_t> chunk_indexes_, attachment_indexes_, metadata_indexes_;  // ready records for the summary
  Statistics counts_;
};

}  // namespace tactus::mcap
