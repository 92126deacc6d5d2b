// SPDX-License-Identifier: Apache-2.0
/// How a reader gets over damage, and how it says where it stands.
#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

#include <tactus/base/shown.h>
#include <tactus/trace/mcap_reader.h>

namespace tactus::mcap {
namespace {

constexpr std::size_t kLongestSign = 512;  // [bytes] by which the search recognises a record
constexpr std::size_t kPiece = 64u << 10;
constexpr std::uint64_t kDay = 86'400'000'000'000;  // [ns]

/// A schema or channel with plain names in lengths that fit.
bool is_declaration(ByteReader in, Opcode opcode, std::uint64_t length) noexcept {
  const auto is_plain = [](std::span<const std::uint8_t> text) {
    return std::all_of(text.begin(), text.end(), [](std::uint8_t c) { return c >= 0x20 && c < 0x7f; });
  };
  const std::size_t before = in.position();
  const std::uint16_t id = in.u16();
  if (opcode == Opcode::channel) in.u16();
  const auto name = in.bytes(in.u32()), encoding = in.bytes(in.u32());
  in.u32();  // size of what follows
  return in.ok() && (id > 0 || opcode == Opcode::channel) && !name.empty() && is_plain(name) && is_plain(encoding) &&
         in.position() - before <= length;
}

}  // namespace

void Reader::lose(const Error& cause, std::uint64_t bytes, std::optional<std::uint64_t> from,
                  std::optional<std::uint64_t> until) {
  constexpr std::size_t kMost = 10'000;
  if (losses_.size() < kMost) losses_.push_back({files_.name(file_), cause, bytes, from, until});
}

/// Skip what the error spoils: a message, the rest of a chunk, a chunk, or everything up to the next record that can be recognised.
Result<void> Reader::get_over(const Error& error) {
  if (within_ == Within::chunk_record && !chunk_.empty()) {
    lose(error, 0, at_message_ ? std::optional(message_.log_time) : last_time_,
         at_message_ ? std::optional(message_.log_time) : last_time_);
    return {};
  }
  if (within_ == Within::chunk_rest && !chunk_.empty()) {
    lose(error, chunk_.size() - chunk_position_, std::max(last_time_.value_or(chunk_from_), chunk_from_), chunk_until_);
    chunk_position_ = chunk_.size();
    return {};
  }
  const auto opcode = prefix_.empty() ? Opcode{0} : static_cast<Opcode>(prefix_[0]);
  const std::string_view rule = error.rule;
  const bool is_whole = !record_.empty() && record_.size() + kRecordPrefix == position_ - record_start_;
  if (section_ == Section::done) {  // footer and what follows it
    lose(error, 0, std::nullopt, std::nullopt);
    return {};
  }
  if (opcode == Opcode::chunk && is_whole && rule != "R-TRC-4") {
    lose(error, kRecordPrefix + record_.size(), chunk_from_, chunk_until_);
    chunk_.clear();
    chunk_position_ = 0;
    return {};
  }
  if (opcode == Opcode::data_end && rule == "R-TRC-6") {
    lose(error, 0, std::nullopt, std::nullopt);
    return {};
  }
  if (opcode == Opcode::footer && is_whole) {  // it points elsewhere: what it ends has been read
    lose(error, 0, std::nullopt, std::nullopt);
    section_ = Section::done;
    return {};
  }
  const bool is_contained = opcode == Opcode::schema || opcode == Opcode::channel || opcode == Opcode::attachment ||
                            opcode == Opcode::metadata || opcode == Opcode::message;
  if (is_contained && is_whole && rule != "R-TRC-5" && rule != "R-TRC-4") {
    lose(error, kRecordPrefix + record_.size(), last_time_, last_time_);
    return {};
  }
  return search_record(error);
}

/// Look for the next record behind the first byte of the damaged one.
Result<void> Reader::search_record(const Error& error) {
  const std::uint64_t begin = record_start_;
  std::vector<std::uint8_t> bytes;
  if (!prefix_.empty()) bytes.assign(prefix_.begin() + 1, prefix_.end());
  bytes.insert(bytes.end(), record_.begin(), record_.end());
  const std::uint64_t start = position_ - bytes.size();  // of the file, where bytes[0] is
  bytes.insert(bytes.end(), ahead_.begin() + static_cast<std::ptrdiff_t>(ahead_begin_), ahead_.end());
  ahead_.clear();
  ahead_begin_ = 0;
  std::uint64_t dropped = 0;
  bool ended = false;
  std::size_t at = 0;
  for (;;) {
    for (; at + kLongestSign <= bytes.size() || (ended && at < bytes.size()); ++at) {
      if (!is_record(std::span<const std::uint8_t>(bytes).subspan(at))) continue;
      bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
      position_ = start + dropped + at;
      ahead_ = std::move(bytes);
      lose(error, position_ - begin, last_time_, std::nullopt);
      return {};
    }
    if (ended) break;
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
    dropped += at;
    at = 0;
    const std::size_t held = bytes.size();
    bytes.resize(held + kPiece);
    TACTUS_TRY(const std::size_t got, read_source(std::span(bytes).subspan(held)));
    bytes.resize(held + got);
    ended = got < kPiece;
  }
  position_ = start + dropped + bytes.size();
  if (error.code != Errc::truncated) lose(error, position_ - begin, last_time_, std::nullopt);  // else it is a plain cut
  cut_short_ = true;
  section_ = Section::done;
  return {};
}

/// A record that can hardly be anything else: a chunk whose lengths agree, a message of a known channel and a time near the last one,
/// a schema, a channel, the end of the data, a footer.
bool Reader::is_record(std::span<const std::uint8_t> at) const {
  if (at.empty()) return false;
  const auto opcode = static_cast<Opcode>(at[0]);
  const bool is_declared = opcode == Opcode::schema || opcode == Opcode::channel;
  if (!is_declared && opcode != Opcode::chunk && opcode != Opcode::message && opcode != Opcode::data_end &&
      opcode != Opcode::footer)
    return false;
  ByteReader in(at);
  in.u8();
  const std::uint64_t length = in.u64();
  if (!in.ok() || length > limits_.record_bytes) return false;
  if (is_declared) return is_declaration(in, opcode, length);
  if (opcode == Opcode::data_end) return length == 4;
  if (opcode == Opcode::footer) return length == kFooterContent;
  if (opcode == Opcode::message) {
    const bool is_known = channel_numbers_.of_file.contains(in.u16());
    in.u32();
    const std::uint64_t time = in.u64();
    return in.ok() && is_known && length >= 22 && last_time_ && time + kDay > *last_time_ && time < *last_time_ + kDay;
  }
  const std::uint64_t from = in.u64(), until = in.u64();
  in.u64();
  in.u32();
  const std::uint32_t name_bytes = in.u32();
  if (name_bytes > 4) return false;
  const auto name = in.bytes(name_bytes);
  const std::uint64_t packed = in.u64();
  const bool is_known = compression_of_name({reinterpret_cast<const char*>(name.data()), name.size()}).has_value();
  return in.ok() && is_known && from <= until && packed <= length && length - packed == 8 + 8 + 8 + 4 + 4 + name_bytes + 8;
}

/// Channels may be declared only within a chunk that is lost: the summary has them once more.
void Reader::declare_from_summary() {
  const auto bytes = read_summary();
  constexpr std::size_t kEnding = kRecordPrefix + kFooterContent + kMagic.size();
  std::vector<std::uint8_t> footer(kEnding);
  if (!bytes || !source_.read_at(*source_.size() - kEnding, footer)) return;
  const auto covered = std::span<const std::uint8_t>(footer).first(kRecordPrefix + kFooterContent - 4);
  const std::uint32_t stored = ByteReader(std::span<const std::uint8_t>(footer).subspan(covered.size(), 4)).u32();
  if (stored != 0 && stored != crc32(covered, crc32(*bytes))) return;  // damaged itself: what the data declare holds
  ByteReader summary(*bytes);
  while (summary.ok() && summary.remaining() > 0) {
    const auto opcode = static_cast<Opcode>(summary.u8());
    const ByteReader content = summary.sub(summary.u64());
    if (!summary.ok()) return;
    if (opcode == Opcode::schema) static_cast<void>(add_schema(content));
    if (opcode == Opcode::channel) static_cast<void>(add_channel(content));
  }
}

Diagnostic Reader::explain(const Error& error) const {
  Diagnostic out{.error = error};
  const auto append = [&](const std::string& part) {
    if (!part.empty()) out.detail += (out.detail.empty() ? "" : ", ") + part;
  };
  if (const std::string name = files_.name(file_); !name.empty()) append(shown(name));
  if (is_unpacked_) append("of the unpacked file");
  if (within_ != Within::top && chunk_number_ > 0) append("chunk " + std::to_string(chunk_number_));
  if (at_message_) {
    const auto channel = channels_.find(message_.channel_id);
    std::array<char, 48> time{};
    std::snprintf(time.data(), time.size(), "%.6f", 1e-9 * static_cast<double>(message_.log_time));
    append((channel == channels_.end() ? std::string("a message") : shown(channel->second.topic)) + " at log time " +
           time.data() + " s");
  } else if (within_ == Within::top && !record_.empty() && !prefix_.empty() && static_cast<Opcode>(prefix_[0]) == Opcode::chunk &&
             chunk_number_ > 0) {
    std::array<char, 96> span{};
    std::snprintf(span.data(), span.size(), " (log time %.3f s to %.3f s)", 1e-9 * static_cast<double>(chunk_from_),
                  1e-9 * static_cast<double>(chunk_until_));
    append("chunk " + std::to_string(chunk_number_) + span.data());
  }
  return out;
}

}  // namespace tactus::mcap
