// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_reader.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include <tactus/base/rule.h>

namespace tactus {
namespace {

constexpr std::size_t kPiece = 64u << 10;
constexpr std::size_t kMaxLine = 1u << 20;
constexpr std::size_t kMaxAhead = 4u << 20;                                // bytes looked at for the names
constexpr std::array<std::uint8_t, 4> kZstdMagic{0x28, 0xB5, 0x2F, 0xFD};  // RFC 8878 3.1.1

/// A byte order mark begins a line where files are put together.
std::string_view without_mark(std::string_view line) noexcept { return line.starts_with("\xEF\xBB\xBF") ? line.substr(3) : line; }

/// "|---|:--:|" below the names of a table in Markdown, "-----+----" of a database
bool is_rule_line(std::string_view text) noexcept {
  return text.find_first_not_of("|-+=: \t") == std::string_view::npos && text.find_first_of("|+") != std::string_view::npos &&
         (text.find("--") != std::string_view::npos || text.find("==") != std::string_view::npos);
}

bool is_comment(std::string_view text) noexcept {
  return text[0] == '#' || text[0] == '%' || text.starts_with("//") || is_rule_line(text);
}

}  // namespace

Result<CsvReader> CsvReader::open(const std::string& path, const CsvText& format) {
  TACTUS_TRY(ByteSource source, ByteSource::open_file(path));
  CsvReader reader(std::move(source));
  TACTUS_CHECK(reader.start(format));
  return reader;
}

Result<void> CsvReader::start(const CsvText& format) {
  wanted_names_ = format.names;
  TACTUS_CHECK(read_raw());
  if (raw_.size() >= kZstdMagic.size() && std::equal(kZstdMagic.begin(), kZstdMagic.end(), raw_.begin())) {
    zstd_.emplace();
    TACTUS_CHECK(refill());
  } else {
    decoder_.add({reinterpret_cast<const char*>(raw_.data()), raw_.size()}, text_);
  }
  while (line_ < format.skip_lines) {
    TACTUS_TRY(const auto line, next_line());
    if (!line) break;
  }
  return {};
}

std::string_view CsvReader::foreign() const noexcept {
  const std::string_view begin = std::string_view(text_).substr(0, 4096);
  constexpr std::pair<std::string_view, std::string_view> kKinds[]{{"PK\x03\x04", "an Excel workbook, or another zip archive"},
                                                                   {"\xD0\xCF\x11\xE0", "an old Excel workbook"},
                                                                   {"MATLAB 5.0 MAT-file", "a MATLAB file"},
                                                                   {"\x89HDF", "an HDF5 or MATLAB file"},
                                                                   {"\x93NUMPY", "a NumPy array"},
                                                                   {"\x1F\x8B", "compressed by gzip"},
                                                                   {"ROSBAG", "a ROS 1 bag"},
                                                                   {"\x89MCAP", "an MCAP recording"},
                                                                   {"SQLite format 3", "a SQLite database"}};
  for (const auto& [magic, kind] : kKinds)
    if (begin.starts_with(magic)) return kind;
  const std::size_t first = begin.find_first_not_of(" \t\r\n[");
  if (first != std::string_view::npos && begin.substr(first).starts_with('{')) return "JSON";
  return {};
}

Result<void> CsvReader::read_raw() {
  raw_.resize(kPiece);
  TACTUS_TRY(const std::size_t count, source_.read(raw_));
  raw_.resize(count);
  budget_.earn(count);
  return {};
}

/// More text behind text_, or ended_.
Result<void> CsvReader::refill() {
  text_.erase(0, line_start_);
  scanned_ -= line_start_;
  line_start_ = 0;
  piece_.resize(kPiece);
  std::size_t produced = 0;
  if (!zstd_) {
    TACTUS_TRY(produced, source_.read(piece_));
    ended_ = produced == 0;
  }
  while (zstd_ && produced == 0 && !ended_) {
    TACTUS_TRY(const auto progress, zstd_->decompress(raw_, piece_));
    raw_.erase(raw_.begin(), raw_.begin() + static_cast<std::ptrdiff_t>(progress.consumed));
    produced = progress.produced;
    if (!budget_.spend(produced)) return fail(Errc::limit_exceeded, "R-CSV-9");
    if (produced > 0 || !raw_.empty()) continue;
    TACTUS_CHECK(read_raw());
    ended_ = raw_.empty();
    if (ended_ && !zstd_->at_frame_end()) return fail(Errc::truncated, "R-CSV-1");
  }
  decoder_.add({reinterpret_cast<const char*>(piece_.data()), produced}, text_);
  if (ended_) decoder_.end(text_);
  return {};
}

Result<std::optional<std::string_view>> CsvReader::next_line() {
  while (true) {
    const std::size_t end = text_.find('\n', scanned_);
    if (end != std::string::npos || (ended_ && line_start_ < text_.size())) {
      const std::string_view line = std::string_view(text_).substr(line_start_, end - line_start_);
      is_open_ = end == std::string::npos;
      line_start_ = scanned_ = std::min(end, text_.size() - 1) + 1;
      ++line_;
      return line;
    }
    if (ended_) return std::nullopt;
    scanned_ = text_.size();
    if (scanned_ - line_start_ > kMaxLine) return fail(Errc::limit_exceeded, "R-CSV-6");
    TACTUS_CHECK(refill());
  }
}

/// The next line that is neither blank nor a comment.
Result<std::optional<std::string_view>> CsvReader::next_row() {
  while (replayed_ < ahead_.size()) {
    const CsvLine& line = ahead_[replayed_++];
    line_ = line.number;
    is_open_ = line.is_open;
    is_after_blank_ = line.is_after_blank;
    if (!line.is_comment) return std::string_view(line.text);
  }
  for (is_after_blank_ = false;; is_after_blank_ = true) {
    TACTUS_TRY(const auto line, next_line());
    if (!line) return std::nullopt;
    const std::string_view text = trim_field(without_mark(*line));
    if (!text.empty() && !is_comment(text)) return without_mark(*line);
  }
}

bool CsvReader::is_name_again(std::string_view line) {
  const auto is_it = [&](const CsvLine& name) { return !name.is_comment && name.text == line; };
  const auto names = std::span(ahead_).first(std::min(header_.values, ahead_.size()));
  if (!std::ranges::any_of(names, is_it)) return false;
  if (repeated_names_++ == 0) first_repeated_ = line_;
  return true;
}

Result<bool> CsvReader::next() {
  auto row = next_row();
  while (row && *row && is_name_again(**row)) row = next_row();
  if (!row) return tl::make_unexpected(row.error());
  if (!*row) return false;
  bytes_ = (*row)->size();
  const PointedFields pointed = split_fields(**row, header_.separator, fields_);
  decimal_commas_.count += pointed.count;
  decimal_commas_.open += pointed.open;
  while (fields_.size() > header_.names.size() && fields_.back().empty()) fields_.pop_back();
  return true;
}

/// Lines until find_header() has what it needs.   out  false: there are none
Result<bool> CsvReader::look_ahead() {
  std::size_t bytes = 0, rows = 0;
  bool is_after_blank = false;
  while (rows < kHeaderLines && bytes < kMaxAhead) {
    TACTUS_TRY(const auto line, next_line());
    if (!line) break;
    const std::string_view text = trim_field(without_mark(*line));
    if (text.empty()) {
      is_after_blank = true;
      continue;
    }
    ahead_.push_back({.number = line_,
                      .text = std::string(without_mark(*line)),
                      .is_comment = is_comment(text),
                      .is_after_blank = std::exchange(is_after_blank, false),
                      .is_open = is_open_});
    bytes += line->size();
    if (!ahead_.back().is_comment) ++rows;
    if (ahead_.back().is_comment && ahead_.size() - rows > 2 * kHeaderLines) ahead_.erase(ahead_.begin());  // the last ones count
  }
  return rows > 0;
}

Result<bool> CsvReader::names() {
  TACTUS_TRY(const bool has_rows, look_ahead());
  if (!has_rows) return false;
  const std::uint64_t reached = line_;
  header_ = find_header(ahead_, wanted_names_);
  replayed_ = header_.values;
  if (replayed_ == ahead_.size()) line_ = reached;
  else line_ = header_.line;
  fields_ = header_.names;
  return true;
}

}  // namespace tactus
