// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/mcap_writer.h>

#include <algorithm>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>
#include <tactus/trace/block_crc.h>

namespace tactus::mcap {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::span<const std::uint8_t> as_bytes(std::string_view text) noexcept {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

void put_text(ByteWriter& out, std::string_view text) {
  out.u32(static_cast<std::uint32_t>(text.size()));
  out.bytes(as_bytes(text));
}

void put_map(ByteWriter& out, const TextMap& map) {
  std::size_t size = 0;
  for (const auto& [key, value] : map) size += 4 + key.size() + 4 + value.size();
  out.u32(static_cast<std::uint32_t>(size));
  for (const auto& [key, value] : map) {
    put_text(out, key);
    put_text(out, value);
  }
}

void put_map(ByteWriter& out, const std::map<std::uint16_t, std::uint64_t>& map) {
  out.u32(static_cast<std::uint32_t>(map.size() * (2 + 8)));
  for (const auto& [key, value] : map) {
    out.u16(key);
    out.u64(value);
  }
}

void put_record(ByteWriter& out, Opcode opcode, std::span<const std::uint8_t> content) {
  out.u8(static_cast<std::uint8_t>(opcode));
  out.u64(content.size());
  out.bytes(content);
}

Bytes content_of(const Schema& schema) {
  Bytes bytes;
  ByteWriter out(bytes);
  out.u16(schema.id);
  put_text(out, schema.name);
  put_text(out, schema.encoding);
  put_text(out, schema.data);
  return bytes;
}

Bytes content_of(const Channel& channel) {
  Bytes bytes;
  ByteWriter out(bytes);
  out.u16(channel.id);
  out.u16(channel.schema_id);
  put_text(out, channel.topic);
  put_text(out, channel.message_encoding);
  put_map(out, channel.metadata);
  return bytes;
}

Bytes content_of(const Attachment& attachment) {
  Bytes bytes;
  ByteWriter out(bytes);
  out.u64(attachment.log_time);
  out.u64(attachment.create_time);
  put_text(out, attachment.name);
  put_text(out, attachment.media_type);
  out.u64(attachment.data.size());
  out.bytes(attachment.data);
  out.u32(crc32(bytes));
  return bytes;
}

}  // namespace

void Writer::CloseFile::operator()(std::FILE* file) const noexcept {
  if (file != stdout) std::fclose(file);
}

Result<Writer> Writer::create(const std::string& path, std::string_view profile) {
  File file(path == "-" ? stdout : std::fopen(path.c_str(), "wb"));
  if (!file) return fail(Errc::io, "R-TRC-1");
  Writer writer(std::move(file));
  TACTUS_CHECK(writer.write_bytes(kMagic));
  Bytes header;
  ByteWriter out(header);
  put_text(out, profile);
  put_text(out, "tactus");
  TACTUS_CHECK(writer.write_record(Opcode::header, header));
  return writer;
}

Result<void> Writer::add(const Schema& schema) {
  schemas_.push_back(schema);
  return write_record(Opcode::schema, content_of(schema));
}

Result<void> Writer::add(const Channel& channel) {
  channels_[channel.id].channel = channel;
  return write_record(Opcode::channel, content_of(channel));
}

Result<void> Writer::add(const Attachment& attachment) {
  const Bytes content = content_of(attachment);
  Bytes index;
  ByteWriter out(index);
  out.u64(position_);
  out.u64(kRecordPrefix + content.size());
  out.u64(attachment.log_time);
  out.u64(attachment.create_time);
  out.u64(attachment.data.size());
  put_text(out, attachment.name);
  put_text(out, attachment.media_type);
  ByteWriter indexes(attachment_indexes_);
  put_record(indexes, Opcode::attachment_index, index);
  ++counts_.attachment_count;
  return write_record(Opcode::attachment, content);
}

Result<void> Writer::add(const Metadata& metadata) {
  Bytes content;
  ByteWriter record(content);
  put_text(record, metadata.name);
  put_map(record, metadata.entries);
  Bytes index;
  ByteWriter out(index);
  out.u64(position_);
  out.u64(kRecordPrefix + content.size());
  put_text(out, metadata.name);
  ByteWriter indexes(metadata_indexes_);
  put_record(indexes, Opcode::metadata_index, index);
  ++counts_.metadata_count;
  return write_record(Opcode::metadata, content);
}

void Writer::add(const Message& message) {
  const std::uint64_t time = message.log_time;
  const bool first_of_chunk = chunk_.empty();
  chunk_start_time_ = first_of_chunk ? time : std::min(chunk_start_time_, time);
  chunk_end_time_ = first_of_chunk ? time : std::max(chunk_end_time_, time);
  counts_.message_start_time = counts_.message_count == 0 ? time : std::min(counts_.message_start_time, time);
  counts_.message_end_time = std::max(counts_.message_end_time, time);
  ++counts_.message_count;

  ChannelState& state = channels_.at(message.channel_id);
  ++state.message_count;
  state.index.emplace_back(time, chunk_.size());

  ByteWriter out(chunk_);
  out.u8(static_cast<std::uint8_t>(Opcode::message));
  out.u64(2 + 4 + 8 + 8 + message.data.size());
  out.u16(message.channel_id);
  out.u32(message.sequence);
  out.u64(time);
  out.u64(message.publish_time);
  out.bytes(message.data);
}

Result<Writer::StoredChunk> Writer::stored_chunk() {
  if (!budget_.spend(chunk_.size())) return StoredChunk{"", chunk_};
  TACTUS_TRY(const auto compressed, compressor_.compress(chunk_));
  return StoredChunk{"zstd", compressed};
}

Result<void> Writer::end_chunk() {
  if (chunk_.empty()) return {};
  TACTUS_TRY(const StoredChunk stored, stored_chunk());
  Bytes content;
  content.reserve(stored.records.size() + 64);
  ByteWriter out(content);
  out.u64(chunk_start_time_);
  out.u64(chunk_end_time_);
  out.u64(chunk_.size());
  out.u32(block_crc(chunk_));
  put_text(out, stored.compression);
  out.u64(stored.records.size());
  out.bytes(stored.records);
  const std::uint64_t chunk_start = position_;
  TACTUS_CHECK(write_record(Opcode::chunk, content));
  const std::uint64_t chunk_end = position_;

  std::map<std::uint16_t, std::uint64_t> index_offsets;
  for (auto& [id, state] : channels_) {
    if (state.index.empty()) continue;
    index_offsets[id] = position_;
    content.clear();
    out.u16(id);
    out.u32(static_cast<std::uint32_t>(state.index.size() * (8 + 8)));
    for (const auto& [time, offset] : state.index) {
      out.u64(time);
      out.u64(offset);
    }
    TACTUS_CHECK(write_record(Opcode::message_index, content));
  }
  append_chunk_index(chunk_start, chunk_end - chunk_start, stored, index_offsets, position_ - chunk_end);
  reset_chunk();
  if (std::fflush(file_.get()) != 0) return fail(Errc::io, "R-TRC-1", 8 * position_);
  return {};
}

void Writer::append_chunk_index(std::uint64_t chunk_start, std::uint64_t chunk_length, const StoredChunk& stored,
                                const std::map<std::uint16_t, std::uint64_t>& index_offsets, std::uint64_t index_length) {
  Bytes content;
  ByteWriter out(content);
  out.u64(chunk_start_time_);
  out.u64(chunk_end_time_);
  out.u64(chunk_start);
  out.u64(chunk_length);
  put_map(out, index_offsets);
  out.u64(index_length);
  put_text(out, stored.compression);
  out.u64(stored.records.size());
  out.u64(chunk_.size());
  ByteWriter indexes(chunk_indexes_);
  put_record(indexes, Opcode::chunk_index, content);
  ++counts_.chunk_count;
}

void Writer::reset_chunk() noexcept {
  chunk_.clear();
  for (auto& [id, state] : channels_) state.index.clear();
}

Bytes Writer::statistics() const {
  std::map<std::uint16_t, std::uint64_t> message_counts;
  for (const auto& [id, state] : channels_) message_counts[id] = state.message_count;
  Bytes content;
  ByteWriter out(content);
  out.u64(counts_.message_count);
  out.u16(static_cast<std::uint16_t>(schemas_.size()));
  out.u32(static_cast<std::uint32_t>(channels_.size()));
  out.u32(counts_.attachment_count);
  out.u32(counts_.metadata_count);
  out.u32(counts_.chunk_count);
  out.u64(counts_.message_start_time);
  out.u64(counts_.message_end_time);
  put_map(out, message_counts);
  return content;
}

/// Summary records grouped by opcode, channels ahead of the statistics, as the format demands.
Writer::SummaryGroups Writer::summary_groups() const {
  Bytes schemas, channels, statistics_record;
  ByteWriter schema_out(schemas), channel_out(channels), statistics_out(statistics_record);
  for (const Schema& schema : schemas_) put_record(schema_out, Opcode::schema, content_of(schema));
  for (const auto& [id, state] : channels_) put_record(channel_out, Opcode::channel, content_of(state.channel));
  put_record(statistics_out, Opcode::statistics, statistics());
  return {{Opcode::schema, std::move(schemas)},
          {Opcode::channel, std::move(channels)},
          {Opcode::statistics, std::move(statistics_record)},
          {Opcode::chunk_index, chunk_indexes_},
          {Opcode::attachment_index, attachment_indexes_},
          {Opcode::metadata_index, metadata_indexes_}};
}

Result<void> Writer::finish() {
  TACTUS_CHECK(end_chunk());
  Bytes content;
  ByteWriter out(content);
  out.u32(crc_);
  TACTUS_CHECK(write_record(Opcode::data_end, content));

  const std::uint64_t summary_start = position_;
  crc_ = 0;  // the summary has a check value of its own
  Bytes offsets;
  ByteWriter offsets_out(offsets);
  for (const auto& [opcode, records] : summary_groups()) {
    if (records.empty()) continue;
    content.clear();
    out.u8(static_cast<std::uint8_t>(opcode));
    out.u64(position_);
    out.u64(records.size());
    put_record(offsets_out, Opcode::summary_offset, content);
    TACTUS_CHECK(write_bytes(records));
  }
  const std::uint64_t offsets_start = position_;
  TACTUS_CHECK(write_bytes(offsets));

  content.clear();
  out.u8(static_cast<std::uint8_t>(Opcode::footer));
  out.u64(kFooterContent);
  out.u64(summary_start);
  out.u64(offsets_start);
  out.u32(crc32(content, crc_));
  out.bytes(kMagic);
  TACTUS_CHECK(write_bytes(content));
  std::FILE* const file = file_.release();
  const bool closed = file == stdout ? std::fflush(file) == 0 : std::fclose(file) == 0;
  return closed ? Result<void>() : fail(Errc::io, "R-TRC-1", 8 * position_);
}

Result<void> Writer::write_record(Opcode opcode, std::span<const std::uint8_t> content) {
  Bytes prefix;
  ByteWriter out(prefix);
  out.u8(static_cast<std::uint8_t>(opcode));
  out.u64(content.size());
  TACTUS_CHECK(write_bytes(prefix));
  return write_bytes(content);
}

Result<void> Writer::write_bytes(std::span<const std::uint8_t> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) return fail(Errc::io, "R-TRC-1", 8 * position_);
  position_ += bytes.size();
  budget_.earn(bytes.size());
  crc_ = block_crc(bytes, crc_);
  return {};
}

}  // namespace tactus::mcap
