// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/mcap_reader.h>

#include <algorithm>
#include <string_view>

#include <tactus/base/bytes.h>
#include <tactus/base/text.h>
#include <tactus/trace/block_crc.h>
#include <tactus/trace/byte_source.h>
#include <tactus/trace/file_kind.h>

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

tl::expected<Reader, Diagnostic> Reader::open(ByteSource source, const ReadLimits& limits) {
  Reader reader(std::move(source), limits);
  TACTUS_CHECK(reader.start_file());
  return reader;
}

tl::expected<Reader, Diagnostic> Reader::open(RecordingFiles files, OnDamage on_damage, const ReadLimits& limits) {
  TACTUS_TRY(ByteSource source, diagnosed(files.open(0)));
  Reader reader(std::move(source), limits);
  for (const ReadNote& note : files.notes) reader.notes_.add(note);
  reader.files_ = std::move(files);
  reader.on_damage_ = on_damage;
  TACTUS_CHECK(reader.start_file());
  return reader;
}

/// From the front of source_ to its first record behind the header.
tl::expected<void, Diagnostic> Reader::start_file() {
  section_ = Section::data;
  position_ = record_start_ = summary_start_ = earned_ = 0;
  chunk_.clear();
  ahead_.clear();
  chunk_position_ = ahead_begin_ = 0;
  chunk_number_ = 0;
  schema_numbers_.of_file.clear();
  channel_numbers_.of_file.clear();
  within_ = Within::top;
  at_message_ = false;
  TACTUS_TRY(const Compression packed, diagnosed(source_.unpack()));
  is_unpacked_ = packed != Compression::none;
  is_spoilt_ = false;
  std::vector<std::uint8_t> front;
  if (!is_unpacked_) {
    TACTUS_TRY(const auto first, diagnosed(source_.peek(kKindBytes)));
    front.assign(first.begin(), first.end());
  }
  const std::string path = files_.paths.empty() ? std::string() : files_.paths[file_];
  std::vector<std::uint8_t> magic;
  TACTUS_TRY(const bool has_magic, diagnosed(read_exactly(magic, kMagic.size())));
  if (!has_magic || !std::equal(magic.begin(), magic.end(), kMagic.begin())) {
    Diagnostic error = not_mcap(is_unpacked_ ? magic : front, path);
    if (is_unpacked_) error.detail = "within its " + std::string(name_of(packed)) + " data";
    const bool may_be_damage = has_magic && (is_unpacked_ || error.error.code == Errc::malformed || magic[0] == kMagic[0]);
    if (!skips_damage() || !may_be_damage) return tl::unexpected(std::move(error));
    lose(fail(Errc::malformed, "R-TRC-2").value(), kMagic.size(), std::nullopt, std::nullopt);
  }
  crc_ = crc32(std::span<const std::uint8_t>(magic));

  record_start_ = position_;
  const auto read_header = [&]() -> Result<void> {
    TACTUS_TRY(const bool has_prefix, read_exactly(prefix_, kRecordPrefix));
    if (!has_prefix) return refuse(Errc::truncated, "R-TRC-3");
    ByteReader prefix(prefix_);
    if (static_cast<Opcode>(prefix.u8()) != Opcode::header) return refuse(Errc::malformed, "R-TRC-9");
    const std::uint64_t length = prefix.u64();
    if (length > limits_.record_bytes) return refuse(Errc::limit_exceeded, "R-TRC-5");
    TACTUS_TRY(const bool has_header, read_exactly(record_, length));
    if (!has_header) return refuse(Errc::truncated, "R-TRC-3");
    ByteReader content(record_);
    const std::string_view profile = get_text(content);
    const std::string_view library = get_text(content);
    if (!content.ok()) return refuse(Errc::malformed, "R-TRC-4");
    if (!is_utf8(profile) || !is_utf8(library)) return refuse(Errc::invalid, "R-TRC-11");
    return {};
  };
  const auto header = read_header();
  if (!header && (!skips_damage() || header.error().code == Errc::truncated || header.error().code == Errc::io))
    return tl::unexpected(explain(header.error()));
  if (!header) TACTUS_CHECK(diagnosed(get_over(header.error())));
  if (skips_damage()) declare_from_summary();
  return {};
}

Result<bool> Reader::next_file() {
  if (file_ + 1 >= files_.count()) return false;
  files_before_ += source_.stored_bytes_read();
  ++file_;
  auto opened = files_.open(file_);
  if (opened) {
    source_ = *std::move(opened);
    const auto started = start_file();
    if (started) return true;
    const Error cause = started.error().error;
    if (!skips_damage() && cause.code != Errc::truncated) return tl::unexpected(cause);
    if (!skips_damage()) notes_.add(files_.name(file_), "it ends before its first record; nothing of it is read");
    else lose(cause, 0, std::nullopt, std::nullopt);
  } else {
    if (!skips_damage()) return tl::unexpected(opened.error());
    lose(opened.error(), 0, std::nullopt, std::nullopt);
  }
  section_ = Section::done;
  cut_short_ = true;
  return true;
}

/// Read on, and let the budget know: what is stored earns, what is unpacked costs.
Result<std::size_t> Reader::read_source(std::span<std::uint8_t> out) {
  const auto got = source_.read(out);
  if (!got && skips_damage() && got.error().code == Errc::malformed) {  // the rest of a packed file is lost
    if (!is_spoilt_) lose(fail_at(got.error(), 8 * position_).value(), 0, last_time_, std::nullopt);
    is_spoilt_ = true;
    return std::size_t{0};
  }
  if (!got) return fail_at(got.error(), 8 * position_);
  budget_.earn(source_.stored_bytes_read() - earned_);
  earned_ = source_.stored_bytes_read();
  if (is_unpacked_) TACTUS_CHECK(spend(*got));
  return *got;
}

/// False when the input ends first; `out` then holds what was there.
Result<bool> Reader::read_exactly(std::vector<std::uint8_t>& out, std::uint64_t count) {
  out.clear();
  while (out.size() < count) {
    const std::size_t start = out.size();
    out.resize(start + static_cast<std::size_t>(std::min(kPiece, count - start)));
    const std::span<std::uint8_t> piece = std::span(out).subspan(start);
    std::size_t got = std::min(piece.size(), ahead_.size() - ahead_begin_);
    std::copy_n(ahead_.begin() + static_cast<std::ptrdiff_t>(ahead_begin_), got, piece.begin());
    ahead_begin_ += got;
    if (got < piece.size()) {
      TACTUS_TRY(const std::size_t more, read_source(piece.subspan(got)));
      got += more;
    }
    crc_ = block_crc(piece.first(got), crc_);
    position_ += got;
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
  for (;;) {
    while (section_ != Section::done) {
      const auto item = step();
      if (item && *item && **item != Item::end) return **item;
      if (item) continue;
      if (!skips_damage() || item.error().code == Errc::io) return tl::unexpected(item.error());
      TACTUS_CHECK(get_over(item.error()));
    }
    if (cut_short_ && !files_.name(file_).empty() && file_ != cut_noted_) {
      notes_.add(files_.name(file_), "it ends without its index; what is before the cut is read");
      cut_noted_ = file_;
    }
    TACTUS_TRY(const bool more, next_file());
    if (!more) return Item::end;
  }
}

Result<std::optional<Item>> Reader::step() {
  at_message_ = false;
  return chunk_position_ < chunk_.size() ? next_in_chunk() : next_at_top();
}

Result<std::optional<Item>> Reader::next_in_chunk() {
  within_ = Within::chunk_rest;
  ByteReader in(std::span<const std::uint8_t>(chunk_).subspan(chunk_position_));
  const auto opcode = static_cast<Opcode>(in.u8());
  const ByteReader content = in.sub(in.u64());
  if (!in.ok()) return refuse(Errc::malformed, "R-TRC-4");
  chunk_position_ += in.position();
  within_ = Within::chunk_record;
  const bool allowed = opcode == Opcode::schema || opcode == Opcode::channel || opcode == Opcode::message || !is_known(opcode);
  if (!allowed || opcode == Opcode{0}) return refuse(Errc::malformed, "R-TRC-9");
  return take_record(opcode, content);
}

Result<std::optional<Item>> Reader::next_at_top() {
  within_ = Within::top;
  record_start_ = position_;
  const std::uint32_t crc_before = crc_;
  record_.clear();
  const auto stop = [this]() -> Result<std::optional<Item>> {
    if (skips_damage() && !record_.empty()) return refuse(Errc::truncated, "R-TRC-4");  // its length may be the damage
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
    return whole ? Result<std::optional<Item>>(std::nullopt) : stop();
  }
  if (length > limits_.record_bytes) return refuse(Errc::limit_exceeded, "R-TRC-5");
  TACTUS_TRY(const bool whole, read_exactly(record_, length));
  if (!whole) return stop();
  if (watcher_ != nullptr) watcher_->on_read(bytes_read(), watched_bytes_);
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

/// Handle a record that is allowed at its position.
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
  ++chunk_number_;
  chunk_from_ = content.u64();  // of its messages, which have their own: reported when the chunk is damaged
  chunk_until_ = content.u64();
  const std::uint64_t size = content.u64();
  const std::uint32_t crc = content.u32();
  const auto compression = compression_of_name(get_text(content));
  const auto records = content.bytes(content.u64());
  if (!content.ok()) return refuse(Errc::malformed, "R-TRC-4");
  if (!compression) return refuse(Errc::unsupported, "R-TRC-7");
  const bool is_packed = *compression != Compression::none;
  if (size > limits_.chunk_bytes) return refuse(Errc::limit_exceeded, "R-TRC-5");
  if (!is_packed && size != records.size()) return refuse(Errc::malformed, "R-TRC-8");
  if (is_packed) TACTUS_CHECK(spend(size));
  if (content.remaining() > 0 && skips_damage()) {  // a false length may have swallowed what comes next
    const auto rest = whole_of(content);
    lose(fail(Errc::malformed, "R-TRC-4", 8 * record_start_).value(), 0, std::nullopt, std::nullopt);
    ahead_.erase(ahead_.begin(), ahead_.begin() + static_cast<std::ptrdiff_t>(ahead_begin_));
    ahead_.insert(ahead_.begin(), rest.begin(), rest.end());
    ahead_begin_ = 0;
    position_ -= rest.size();
  }
  chunk_position_ = 0;
  chunk_.resize(static_cast<std::size_t>(size));
  if (is_packed && !decompress_exactly(*compression, records, chunk_)) return refuse(Errc::malformed, "R-TRC-8");
  if (!is_packed) std::copy(records.begin(), records.end(), chunk_.begin());
  if (differs(crc, block_crc(chunk_))) return refuse(Errc::checksum, "R-TRC-6");
  return {};
}

std::string rest_of(ByteReader content) {
  const auto bytes = content.bytes(content.remaining());
  return {bytes.begin(), bytes.end()};
}

/// Keep what is declared for the first time; the same once more, under this number or of another file, changes nothing. Among all files of a
/// recording it has the number of its equal before, its own, or a free one.
/// in  content  all that it says but its number
template <class Declared, class Equals>
Result<void> Reader::declare(Declared declared, std::string content, std::map<std::uint16_t, Declared>& known, Numbers& numbers,
                             const Equals& equals) {
  if (const auto old = numbers.of_file.find(declared.id); old != numbers.of_file.end())
    return equals(known.at(old->second), declared) ? Result<void>() : refuse(Errc::invalid, "R-TRC-10");
  const std::size_t size = content.size();
  const auto [same, is_new] = numbers.by_content.try_emplace(std::move(content), declared.id);
  if (is_new && known.contains(declared.id)) {
    while (numbers.free <= 0xFFFF && known.contains(static_cast<std::uint16_t>(numbers.free))) ++numbers.free;
    if (numbers.free > 0xFFFF) return refuse(Errc::limit_exceeded, "R-TRC-5");
    same->second = static_cast<std::uint16_t>(numbers.free);
  }
  numbers.of_file.emplace(declared.id, same->second);
  if (!is_new) return {};
  declared_bytes_ += size;
  if (declared_bytes_ > limits_.declaration_bytes) return refuse(Errc::limit_exceeded, "R-TRC-5");
  declared.id = same->second;
  known.emplace(declared.id, std::move(declared));
  return {};
}

Result<void> Reader::add_schema(ByteReader content) {
  if (section_ == Section::summary) return {};
  Schema schema;
  schema.id = content.u16();
  std::string rest = rest_of(content);
  schema.name = get_text(content);
  schema.encoding = get_text(content);
  schema.data = get_text(content);
  if (!content.ok()) return refuse(Errc::malformed, "R-TRC-4");
  if (schema.id == 0) return {};  // the format: invalid, to be ignored
  if (!is_utf8(schema.name) || !is_utf8(schema.encoding)) return refuse(Errc::invalid, "R-TRC-11");
  const auto equals = [](const Schema& a, const Schema& b) {
    return a.name == b.name && a.encoding == b.encoding && a.data == b.data;
  };
  return declare(std::move(schema), std::move(rest), schemas_, schema_numbers_, equals);
}

Result<void> Reader::add_channel(ByteReader content) {
  if (section_ == Section::summary) return {};
  Channel channel;
  channel.id = content.u16();
  channel.schema_id = content.u16();
  std::string rest = rest_of(content);
  channel.topic = get_text(content);
  channel.message_encoding = get_text(content);
  auto metadata = get_map(content);
  if (!content.ok()) return refuse(Errc::malformed, "R-TRC-4");
  if (!metadata || !is_utf8(channel.topic) || !is_utf8(channel.message_encoding)) return refuse(Errc::invalid, "R-TRC-11");
  channel.metadata = *std::move(metadata);
  if (channel.schema_id != 0) {
    const auto schema = schema_numbers_.of_file.find(channel.schema_id);
    if (schema == schema_numbers_.of_file.end()) return refuse(Errc::invalid, "R-TRC-10");
    channel.schema_id = schema->second;
  }
  rest.insert(0, std::to_string(channel.schema_id) + ":");
  const auto equals = [](const Channel& a, const Channel& b) {
    return a.schema_id == b.schema_id && a.topic == b.topic && a.message_encoding == b.message_encoding &&
           a.metadata == b.metadata;
  };
  return declare(std::move(channel), std::move(rest), channels_, channel_numbers_, equals);
}

Result<Item> Reader::take_message(ByteReader content) {
  message_.channel_id = content.u16();
  message_.sequence = content.u32();
  message_.log_time = content.u64();
  message_.publish_time = content.u64();
  message_.data = whole_of(content);
  if (!content.ok()) return refuse(Errc::malformed, "R-TRC-4");
  const auto channel = channel_numbers_.of_file.find(message_.channel_id);
  if (channel == channel_numbers_.of_file.end()) return refuse(Errc::invalid, "R-TRC-10");
  message_.channel_id = channel->second;
  at_message_ = true;
  if (counts_.size() <= message_.channel_id) counts_.resize(std::size_t{message_.channel_id} + 1);
  ++counts_[message_.channel_id];
  last_time_ = message_.log_time;
  const bool may_be_packed =
      !message_.data.empty() && (message_.data[0] == 0x28 || message_.data[0] == 0x04);  // CDR begins with 0
  if (may_be_packed) TACTUS_CHECK(unpack_message());
  return Item::message;
}

/// rosbag2 compresses messages one by one if it is told to; their channels still say "cdr".
Result<void> Reader::unpack_message() {
  const Compression compression = compression_of_data(message_.data);
  if (compression == Compression::none || channels_.at(message_.channel_id).message_encoding != "cdr") return {};
  const auto size = announced_size(compression, message_.data);
  if (!size) return refuse(Errc::malformed, "R-TRC-8");
  if (*size > limits_.chunk_bytes) return refuse(Errc::limit_exceeded, "R-TRC-5");
  TACTUS_CHECK(spend(*size));
  unpacked_message_.resize(static_cast<std::size_t>(*size));
  if (!decompress_exactly(compression, message_.data, unpacked_message_)) return refuse(Errc::malformed, "R-TRC-8");
  message_.data = unpacked_message_;
  return {};
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
  if (differs(crc, block_crc(all.first(covered)))) return refuse(Errc::checksum, "R-TRC-6");
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
  section_ = Section::summary;
  summary_start_ = position_;
  crc_ = 0;
  if (differs(crc, crc_before) && losses_.empty()) return refuse(Errc::checksum, "R-TRC-6");
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
  cut_short_ = cut_short_ || !has_magic;
  TACTUS_TRY(const bool has_more, read_exactly(record_, 1));
  return has_more ? refuse(Errc::malformed, "R-TRC-2") : Result<void>();
}

std::optional<std::vector<std::uint8_t>> Reader::read_summary() {
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
  return bytes;
}

std::optional<Statistics> Reader::statistics() {
  if (files_.count() > 1) return std::nullopt;
  const auto bytes = read_summary();
  if (!bytes) return std::nullopt;
  ByteReader summary(*bytes);
  while (summary.ok() && summary.remaining() > 0) {
    const auto opcode = static_cast<Opcode>(summary.u8());
    const ByteReader content = summary.sub(summary.u64());
    if (summary.ok() && opcode == Opcode::statistics) return parse_statistics(content);
  }
  return std::nullopt;
}

}  // namespace tactus::mcap
