// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/tets/tokenizer.h>

#include <algorithm>

#include <tactus/base/rule.h>

namespace tactus::sim {
namespace {

constexpr std::string_view kBlank = " \t\r\f\v";
constexpr std::size_t kLongestQuote = 40;  // bytes of a word that an error repeats

std::string quoted(std::string_view word) { return word.empty() ? "" : '\'' + std::string(word.substr(0, kLongestQuote)) + '\''; }

}  // namespace

bool LineReader::any_line() noexcept {
  if (rest_.empty()) {
    line_ = {};
    return false;
  }
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  whole_ = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++number_;
  if (comments_ == Comments::hash) whole_ = whole_.substr(0, whole_.find('#'));
  line_ = whole_;
  return true;
}

bool LineReader::next_line() noexcept {
  while (any_line())
    if (has_word()) return true;
  return false;
}

bool LineReader::has_word() noexcept {
  line_.remove_prefix(std::min(line_.find_first_not_of(kBlank), line_.size()));
  return !line_.empty();
}

std::string_view LineReader::word() noexcept {
  if (!has_word()) return {};
  const std::string_view found = line_.substr(0, line_.find_first_of(kBlank));
  line_.remove_prefix(found.size());
  return found;
}

tl::expected<void, Diagnostic> Tokenizer::line() {
  if (next_line()) return {};
  return broken(Errc::truncated, "R-TET-10");
}

tl::expected<void, Diagnostic> Tokenizer::count(std::size_t& value, std::size_t most, std::size_t bytes) {
  TACTUS_CHECK(number(value));
  if (value > most) return broken(Errc::limit_exceeded, "R-TET-9", std::to_string(value));
  if (value > (bytes_left() + 1) / bytes) return broken(Errc::truncated, "R-TET-10", std::to_string(value));
  return {};
}

tl::expected<void, Diagnostic> Tokenizer::coordinates(Vec3& value) {
  TACTUS_CHECK(number(value.x));
  TACTUS_CHECK(number(value.y));
  return number(value.z);
}

tl::expected<void, Diagnostic> Tokenizer::end_of_line() {
  if (const std::string_view left = word(); !left.empty()) return broken(Errc::malformed, "R-TET-13", left);
  return {};
}

tl::unexpected<Diagnostic> Tokenizer::broken(Errc code, RuleName rule, std::string_view word) const {
  return tl::unexpected(
      Diagnostic{.error = fail(code, rule).value(), .file = std::string(file_), .line = line_number(), .detail = quoted(word)});
}

}  // namespace tactus::sim
