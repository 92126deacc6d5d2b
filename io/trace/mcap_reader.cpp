// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/mcap_reader.h>

#include <algorithm>
#include <string_view>

#include <tactus/base/bytes.h>
#include <tactus/base/text.h>
#include <tactus/trace/byte_source.h>

namespace tactus::mcap {
namespace {

/// Bytes read from the source at once: a record's memory grows with the bytes read, not with a false length. Chunks: open_chunk().
constexpr std::uint64_t kPiece = 64u << 10;
constexpr std::uint64_t kSummaryBytes = 64u << 20;  // larger summaries are not read ahead

std::string_view get_text(ByteReader& in) {
  const auto raw = in.bytes(in.u32());
  return {reinterpret_cast<const char*>(raw.data()), raw.size()};
}

/// A check value of 0 means "not computed".
bool differs(std::uint32_t stored, std::uint32_t computed) noexcept { return stored != 0 && stored != computed; }

std::span<const std::uint8_t> whole_of(ByteReader in) { return in.bytes(in.remaining()); }

/// Nothing if a string is not UTF-8, a key occurs twice or a length does not fit.
std::optional<TextMap> get_map(ByteReader& in) {
  TextMap map;
  ByteReader entries = in.sub(in.u32());
  while (entries.ok() && entries.remaining() > 0) {
    const std::string_view key = get_text(entries);
    const std::string_view value = get_text(entries);
    if (!entries.ok() || !is_utf8(key) || !is_utf8(value) || !map.emplace(key, value).second) return std::nullopt;
  }
  return in.ok() ? std::optional(map) : std::nullopt;
}

bool is_known(Opcode opcode) noexcept { return opcode >= Opcode::header && opcode <= Opcode::data_end; }

bool may_follow_data_end(Opcode opcode) noexcept {
  switch (opcode) {
    case Opcode::schema:
    case Opcode::channel:
    case Opcode::chunk_index:
    case Opcode::attachment_index:
    case Opcode::metadata_index:
    case Opcode::statistics:
    case Opcode::summary_offset:
    case Opcode::footer:
      return true;
    default:
      return !is_known(opcode);
  }
}

std::optional<Statistics> parse_statistics(ByteReader in) {
  Statistics s;
  s.message_count = in.u64();
  s.schema_count = in.u16();
  s.channel_count = in.u32();
  s.attachment_count = in.u32();
  s.metadata_count = in.u32();
  s.chunk_count = in.u32();
  s.message_start_time = in.u64();
  s.message_end_time = in.u64();
  ByteReader counts = in.sub(in.u32());
  while (counts.ok() && counts.remaining() > 0) {
    const std::uint16_t id = counts.u16();
    s.channel_message_counts[id] = counts.u64();
  }
  return in.ok() && counts.ok() ? std::optional(s) : std::nullopt;
}

}  // namespace

Result<Reader> Reader::open(ByteSource source, const ReadLimits& limits) {
  Reader reader(std::move(source), limits);
  std::vector<std::uint8_t> front;
  TACTUS_TRY(const bool has_magic, reader.read_exactly(front, kMagic.size()));
  if (!std::equal(front.begin(), front.end(), kMagic.begin())) return reader.refuse(Errc::malformed, "R-TRC-2");
  if (!has_magic) return reader.refuse(Errc::truncated, "R-TRC-3");

  reader.record_start_ = reader.position_;
  TACTUS_TRY(const bool has_prefix, reader.read_exactly(reader.prefix_, kRecordPrefix));
  if (!has_prefix) return reader.refuse(Errc::truncated, "R-TRC-3");
  ByteReader prefix(reader.prefix_);
  if (static_cast<Opcode>(prefix.u8()) != Opcode::header) return reader.refuse(Errc::malformed, "R-TRC-9");
  const std::uint64_t length = prefix.u64();
  if (length > limits.record_bytes) return reader.refuse(Errc::limit_exceeded, "R-TRC-5");
  TACTUS_TRY(const bool has_header, reader.read_exactly(reader.record_, length));
  if (!has_header) return reader.refuse(Errc::truncated, "R-TRC-3");
  ByteReader content(reader.record_);
  const std::string_view profile = get_text(content);
  const std::string_view library = get_text(content);
  if (!content.ok()) return reader.refuse(Errc::malformed, "R-TRC-4");
  if (!is_utf8(profile) || !is_utf8(library)) return reader.refuse(Errc::invalid, "R-TRC-11");
  return reader;
}

/// False when the input ends first; `out` then holds what was there.
Result<bool> Reader::read_exactly(std::vector<std::uint8_t>& out, std::uint64_t count) {
  out.clear();
  while (out.size() < count) {
    const std::size_t start = out.size();
    out.resize(start + static_cast<std::size_t>(std::min(kPiece, count - start)));
    const std::span<std::uint8_t> piece = std::span(out).subspan(start);
    TACTUS_TRY(const std::size_t got, source_.read(piece));
    crc_ = crc32(piece.first(got), crc_);
    position_ += got;
    budget_.earn(got);
    if (got < piece.size()) {
      out.resize(start + got);
      return false;
    }
  }
  return true;
}

Result<bool> Reader::skip(std::uint64_t count) {
  while (count > 0) {
    const std::uint64_t part = std::min(kPiece, count);
    TACTUS_TRY(const bool whole, read_exactly(record_, part));
    if (!whole) return false;
    count -= part;
  }
  return true;
}

Result<Item> Reader::next() {
  while (section_ != Section::done) {
    TACTUS_TRY(const auto item, chunk_position_ < chunk_.size() ? next_in_chunk() : next_at_top());
    if (item) return *item;
  }
  return Item::end;
}

Result<std::optional<Item>> Reader::next_in_chunk() {
  ByteReader in(std::span<const std::uint8_t>(chunk_).subspan(chunk_position_));
  const auto opcode = static_cast<Opcode>(in.u8());
  const ByteReader content = in.sub(in.u64());
  if (!in.ok()) return refuse(Errc::malformed, "R-TRC-4");
  chunk_position_ += in.position();
  const bool allowed = opcode == Opcode::schema || opcode == Opcode::channel || opcode == Opcode::message || !is_known(opcode);
  if (!allowed || opcode == Opcode{0}) return refuse(Errc::malformed, "R-TRC-9");
  return take_record(opcode, content);
}

Result<std::optional<Item>> Reader::next_at_top() {
  record_start_ = position_;
  const std::uint32_t crc_before = crc_;
  const auto stop = [this]() -> std::optional<Item> {
    cut_short_ = true;
    section_ = Section::done;
    return Item::end;
  };
  TACTUS_TRY(const bool has_prefix, read_exactly(prefix_, kRecordPrefix));
  if (!has_prefix) return stop();
  ByteReader prefix(prefix_);
  const auto opcode = static_cast<Opcode>(prefix.u8());
  const std::uint64_t length = prefix.u64();
  if (opcode == Opcode{0} || opcode == Opcode::header) return refuse(Errc::malformed, "R-TRC-9");
  if (section_ == Section::summary && !may_follow_data_end(opcode)) return refuse(Errc::malformed, "R-TRC-9");
  if (!is_known(opcode)) {
    TACTUS_TRY(const bool whole, skip(length));
    return whole ? std::nullopt : stop();
  }
  if (length > limits_.record_bytes) return refuse(Errc::limit_exceeded, "R-TRC-5");
  TACTUS_TRY(const bool whole, read_exactly(record_, length));
  if (!whole) return stop();
  const ByteReader content(record_);
  if (opcode == Opcode::data_end) {
    TACTUS_CHECK(end_data(content, crc_before));
    return std::nullopt;
  }
  if (opcode == Opcode::footer) {
    TACTUS_CHECK(end_file(content, crc_before));
    return Item::end;
  }
  return take_record(opcode, content);
}

/// Handle a record that is allowed at its place.
Result<std::optional<Item>> Reader::take_record(Opcode opcode, ByteReader content) {
  switch (opcode) {
    case Opcode::schema:
      TACTUS_CHECK(add_schema(content));
      return std::nullopt;
    case Opcode::channel:
      TACTUS_CHECK(add_channel(content));
      return std::nullopt;
    case Opcode::chunk:
      TACTUS_CHECK(open_chunk(content));
      return std::nullopt;
    case Opcode::message:
      return take_message(content);
    case Opcode::attachment:
      return take_attachment(content);
    case Opcode::metadata:
      return take_metadata(content);
    default:
      return std::nullopt;  // indexes and unknown records: not needed to read front to back
  }
}

Result<void> Reader::open_chunk(ByteReader content) {
  content.u64();  // message start and end time: the messages have their own
  content.u64();
  const std::uint64_t size = content.u64();
  const std::uint32_t crc = content.u32();
  const std::string_view compression = get_text(content);
  const auto records = content.bytes(content.u64());
  if (!content.ok()) return refuse(Errc::malformed, "R-TRC-4");
  if (compression != "zstd" && !compression.empty()) return refuse(Errc::unsupported, "R-TRC-7");
  const bool zstd = !compression.empty();
  if (size > limits_.chunk_bytes) return refuse(Errc::limit_exceeded, "R-TRC-5");
  if (!zstd && size != records.size()) return refuse(Errc::malformed, "R-TRC-8");
  if (zstd) TACTUS_CHECK(spend(size));
  chunk_position_ = 0;
  chunk_.resize(static_cast<std::size_t>(size));
  if (zstd && !decompress_exactly(records, chunk_)) return refuse(Errc::malformed, "R-TRC-8");
  if (!zstd) std::copy(records.begin(), records.end(), chunk_.begin());
  if (differs(crc, crc32(chunk_))) return refuse(Errc::checksum, "R-TRC-6");
  return {};
}

Result<void> Reader::add_schema(ByteReader content) {
  if (section_ == Section::summary) return {};
  const std::size_t size = content.remaining();
  Schema schema;
  schema.id = content.u16();
  schema.name = get_text(content);
  schema.encoding = get_text(content);
  schema.data = get_text(content);
  if (!content.ok()) return refuse(Errc::malformed, "R-TRC-4");
  if (schema.id == 0) return {};  // the format: invalid, to be ignored
  if (!is_utf8(schema.name) || !is_utf8(schema.encoding)) return refuse(Errc::invalid, "R-TRC-11");
  if (const auto old = schemas_.find(schema.id); old != schemas_.end())
    return old->second == schema ? Result<void>() : refuse(Errc::invalid, "R-TRC-10");
  declared_bytes_ += size;
  if (declared_bytes_ > limits_.declaration_bytes) return refuse(Errc::limit_exceeded, "R-TRC-5");
  schemas_.emplace(schema.id, std::move(schema));
  return {};
}

Result<void> Reader::add_channel(ByteReader content) {
  if (section_ == Section::summary) return {};
  const std::size_t size = content.remaining();
  Channel channel;
  channel.id = content.u16();
  channel.schema_id = content.u16();
  channel.topic = get_text(content);
  channel.message_encoding = get_text(content);
  auto metadata = get_map(content);
  if (!content.ok()) return refuse(Errc::malformed, "R-TRC-4");
  if (!metadata || !is_utf8(channel.topic) || !is_utf8(channel.message_encoding)) return refuse(Errc::invalid, "R-TRC-11");
  channel.metadata = *std::move(metadata);
  if (channel.schema_id != 0 && !schemas_.contains(channel.schema_id)) return refuse(Errc::invalid, "R-TRC-10");
  if (const auto old = channels_.find(channel.id); old != channels_.end())
    return old->second == channel ? Result<void>() : refuse(Errc::invalid, "R-TRC-10");
  declared_bytes_ += size;
  if (declared_bytes_ > limits_.declaration_bytes) return refuse(Errc::limit_exceeded, "R-TRC-5");
  channels_.emplace(channel.id, std::move(channel));
  return {};
}

Result<Item> Reader::take_message(ByteReader content) {
  message_.channel_id = content.u16();
  message_.sequence = content.u32();
  message_.log_time = content.u64();
  message_.publish_time = content.u64();
  message_.data = whole_of(content);
  if (!content.ok()) return refuse(Errc::malformed, "R-TRC-4");
  if (!channels_.contains(message_.channel_id)) return refuse(Errc::invalid, "R-TRC-10");
  return Item::message;
}

Result<Item> Reader::take_attachment(ByteReader content) {
  const auto all = whole_of(content);
  attachment_.log_time = content.u64();
  attachment_.create_time = content.u64();
  attachment_.name = get_text(content);
  attachment_.media_type = get_text(content);
  attachment_.data = content.bytes(content.u64());
  const std::size_t covered = content.position();
  const std::uint32_t crc = content.u32();
  if (!content.ok()) return refuse(Errc::malformed, "R-TRC-4");
  if (differs(crc, crc32(all.first(covered)))) return refuse(Errc::checksum, "R-TRC-6");
  if (!is_utf8(attachment_.name) || !is_utf8(attachment_.media_type)) return refuse(Errc::invalid, "R-TRC-11");
  return Item::attachment;
}

Result<Item> Reader::take_metadata(ByteReader content) {
  metadata_.name = get_text(content);
  auto entries = get_map(content);
  if (!content.ok()) return refuse(Errc::malformed, "R-TRC-4");
  if (!entries || !is_utf8(metadata_.name)) return refuse(Errc::invalid, "R-TRC-11");
  metadata_.entries = *std::move(entries);
  return Item::metadata;
}

Result<void> Reader::end_data(ByteReader content, std::uint32_t crc_before) {
  const std::uint32_t crc = content.u32();
  if (!content.ok() || content.remaining() > 0) return refuse(Errc::malformed, "R-TRC-4");
  if (differs(crc, crc_before)) return refuse(Errc::checksum, "R-TRC-6");
  section_ = Section::summary;
  summary_start_ = position_;
  crc_ = 0;
  return {};
}

Result<void> Reader::end_file(ByteReader content, std::uint32_t crc_before) {
  if (content.remaining() != kFooterContent) return refuse(Errc::malformed, "R-TRC-4");
  const std::uint64_t summary_start = content.u64();
  content.u64();  // summary offsets: not needed to read front to back
  const std::uint32_t crc = content.u32();
  const bool has_summary = section_ == Section::summary && record_start_ > summary_start_;
  if (summary_start != (has_summary ? summary_start_ : 0)) return refuse(Errc::invalid, "R-TRC-9");
  const auto covered = std::span<const std::uint8_t>(record_).first(kFooterContent - sizeof crc);
  if (section_ == Section::summary && differs(crc, crc32(covered, crc32(prefix_, crc_before))))
    return refuse(Errc::checksum, "R-TRC-6");

  record_start_ = position_;
  section_ = Section::done;
  TACTUS_TRY(const bool has_magic, read_exactly(record_, kMagic.size()));
  if (!std::equal(record_.begin(), record_.end(), kMagic.begin())) return refuse(Errc::malformed, "R-TRC-2");
  cut_short_ = !has_magic;
  TACTUS_TRY(const bool has_more, read_exactly(record_, 1));
  return has_more ? refuse(Errc::malformed, "R-TRC-2") : Result<void>();
}

std::optional<Statistics> Reader::statistics() {
  constexpr std::uint64_t kEnding = kRecordPrefix + kFooterContent + kMagic.size();
  const auto size = source_.size();
  if (!size || *size < kEnding) return std::nullopt;
  std::vector<std::uint8_t> bytes(kEnding);
  if (!source_.read_at(*size - kEnding, bytes)) return std::nullopt;
  ByteReader footer(bytes);
  const bool is_footer = static_cast<Opcode>(footer.u8()) == Opcode::footer && footer.u64() == kFooterContent;
  const std::uint64_t start = footer.u64();
  if (!is_footer || start == 0 || start > *size - kEnding || *size - kEnding - start > kSummaryBytes) return std::nullopt;

  bytes.resize(static_cast<std::size_t>(*size - kEnding - start));
  if (!source_.read_at(start, bytes)) return std::nullopt;
  ByteReader summary(bytes);
  while (summary.ok() && summary.remaining() > 0) {
    const auto opcode = static_cast<Opcode>(summary.u8());
    const ByteReader content = summary.sub(summary.u64());
    if (summary.ok() && opcode == Opcode::statistics) return parse_statistics(content);
  }
  return std::nullopt;
}

}  // namespace tactus::mcap
