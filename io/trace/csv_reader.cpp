// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_reader.h>

#include <algorithm>
#include <array>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>

namespace tactus {
namespace {

constexpr std::size_t kPiece = 64u << 10;
constexpr std::size_t kMaxLine = 1u << 20;
constexpr std::array<std::uint8_t, 4> kZstdMagic{0x28, 0xB5, 0x2F, 0xFD};  // RFC 8878 3.1.1
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBlank = " \t\r";
constexpr std::string_view kComment = "#%";

std::string_view trim(std::string_view text) noexcept {
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  return text.substr(0, text.find_last_not_of(kBlank) + 1);
}

/// Append what stands between the quote at the front of `line` and its partner; the result is what follows.
std::string_view unquote(std::string_view line, std::string& field) {
  for (line.remove_prefix(1); !line.empty(); line.remove_prefix(1)) {
    if (line[0] == '"') {
      line.remove_prefix(1);
      if (!line.starts_with('"')) break;  // two quotes are one, inside
    }
    field += line[0];
  }
  return line;
}

/// What separates the fields of a line of names: the most frequent one outside quotes.
char separator_of(std::string_view names) noexcept {
  constexpr std::string_view kSeparators = ",;\t";
  std::array<std::size_t, kSeparators.size()> counts{};
  bool is_quoted = false;
  for (const char c : names) {
    if (c == '"') is_quoted = !is_quoted;
    const std::size_t which = kSeparators.find(c);
    if (which != std::string_view::npos && !is_quoted) ++counts[which];
  }
  return kSeparators[static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin())];
}

/// "1,5" becomes "1.5"; what has both signs, or one twice, is no number.
void give_point(std::string& field) noexcept {
  const std::size_t comma = field.find(',');
  if (comma == std::string::npos || field.find_first_of(".,", comma + 1) != std::string::npos || field.find('.') < comma) return;
  field[comma] = '.';
}

}  // namespace

Result<CsvReader> CsvReader::open(const std::string& path) {
  TACTUS_TRY(ByteSource source, ByteSource::open_file(path));
  CsvReader reader(std::move(source));
  TACTUS_CHECK(reader.start());
  return reader;
}

Result<void> CsvReader::start() {
  TACTUS_CHECK(read_raw());
  if (raw_.size() >= kZstdMagic.size() && std::equal(kZstdMagic.begin(), kZstdMagic.end(), raw_.begin())) {
    zstd_.emplace();
    TACTUS_CHECK(refill());
  } else {
    text_.assign(raw_.begin(), raw_.end());
  }
  if (text_.starts_with(kByteOrderMark)) line_start_ = scanned_ = kByteOrderMark.size();
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
  const std::size_t start = text_.size();
  text_.resize(start + kPiece);
  const std::span<std::uint8_t> room(reinterpret_cast<std::uint8_t*>(text_.data()) + start, kPiece);
  std::size_t produced = 0;
  if (!zstd_) {
    TACTUS_TRY(produced, source_.read(room));
    ended_ = produced == 0;
  }
  while (zstd_ && produced == 0 && !ended_) {
    TACTUS_TRY(const auto progress, zstd_->decompress(raw_, room));
    raw_.erase(raw_.begin(), raw_.begin() + static_cast<std::ptrdiff_t>(progress.consumed));
    produced = progress.produced;
    if (!budget_.spend(produced)) return fail(Errc::limit_exceeded, "R-CSV-9");
    if (produced > 0 || !raw_.empty()) continue;
    TACTUS_CHECK(read_raw());
    ended_ = raw_.empty();
    if (ended_ && !zstd_->at_frame_end()) return fail(Errc::truncated, "R-CSV-1");
  }
  text_.resize(start + produced);
  return {};
}

Result<std::optional<std::string_view>> CsvReader::next_line() {
  while (true) {
    const std::size_t end = text_.find('\n', scanned_);
    if (end != std::string::npos || (ended_ && line_start_ < text_.size())) {
      const std::string_view line = std::string_view(text_).substr(line_start_, end - line_start_);
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
  while (true) {
    TACTUS_TRY(const auto line, next_line());
    if (!line) return std::nullopt;
    const std::string_view text = trim(*line);
    if (text.empty()) continue;
    if (kComment.find(text.front()) == std::string_view::npos) return *line;
    if (!has_names_) comment_ = trim(text.substr(1));
  }
}

Result<bool> CsvReader::next() {
  if (std::exchange(holds_, false)) {
    fields_.swap(held_);
    return true;
  }
  TACTUS_TRY(const auto row, next_row());
  if (row) split(*row);
  return row.has_value();
}

Result<bool> CsvReader::names() {
  TACTUS_TRY(const auto row, next_row());
  if (!row) return false;
  has_names_ = true;
  separator_ = separator_of(comment_);
  split(*row);
  if (!comment_.empty() && holds_numbers()) {
    held_ = fields_;
    split(comment_);
    holds_ = fields_.size() == held_.size();
    if (holds_) return true;
  }
  separator_ = separator_of(*row);
  split(*row);
  return true;
}

bool CsvReader::holds_numbers() const {
  return std::ranges::all_of(fields_, [](const std::string& field) { return parse_number<double>(field).has_value(); });
}

void CsvReader::split(std::string_view line) {
  const std::string_view blank = separator_ == '\t' ? kBlank.substr(0, 1) : kBlank;  // an empty field is one, too
  std::size_t count = 0;
  for (bool more = true; more; ++count) {
    if (count == fields_.size()) fields_.emplace_back();
    std::string& field = fields_[count];
    field.clear();
    line.remove_prefix(std::min(line.find_first_not_of(blank), line.size()));
    if (line.starts_with('"')) line = unquote(line, field);
    const std::size_t end = std::min(line.find(separator_), line.size());
    field += trim(line.substr(0, end));  // after a closing quote nothing should be left; if it is, the field is no number
    if (separator_ != ',') give_point(field);
    more = end < line.size();
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  fields_.resize(count);
}

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos && trim(text) == text) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

}  // namespace tactus
