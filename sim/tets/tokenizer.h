// SPDX-License-Identifier: Apache-2.0
/// Lines and words of an untrusted text file, for the readers of mesh files. The text has gone through decode_text (text.h).
#pragma once

#include <cmath>
#include <concepts>
#include <string_view>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/sim/tets/tet_files.h>

namespace tactus::sim {

class LineReader {
 public:
  enum class Comments { none, hash };  ///< hash: from # to the end of the line
  LineReader(std::string_view text, Comments comments) noexcept : rest_(text), comments_(comments) {}

  /// Go to the next line, whatever is on it.   out  false: there is none
  bool any_line() noexcept;
  /// Go to the next line that has words.   out  false: there is none
  bool next_line() noexcept;
  bool has_word() noexcept;          ///< on this line
  std::string_view word() noexcept;  ///< the next on this line; empty: none
  /// The next word, also of the lines that follow; empty: none.
  std::string_view next_word() noexcept { return has_word() || next_line() ? word() : std::string_view(); }
  std::string_view whole_line() const noexcept { return whole_; }  ///< without its comment
  std::size_t line_number() const noexcept { return number_; }     ///< from 1
  std::size_t bytes_left() const noexcept { return line_.size() + rest_.size(); }

 private:
  std::string_view rest_, whole_, line_;  // behind the line, the line, what is left of it
  std::size_t number_ = 0;
  Comments comments_;
};

/// Reads numbers, too, and knows the rules of tetrahedron files.
class Tokenizer : private LineReader {
 public:
  using LineReader::Comments, LineReader::has_word, LineReader::next_line, LineReader::word;
  Tokenizer(std::string_view text, std::string_view file, Comments comments) : LineReader(text, comments), file_(file) {}

  /// Go to the next line that has words, where there must be one.   err  R-TET-10
  tl::expected<void, Diagnostic> line();

  /// The next word as a number.   err  R-TET-11, R-TET-12, R-TET-13 (the line has no more words)
  template <class T>
  tl::expected<void, Diagnostic> number(T& value) {
    const std::string_view text = word();
    if (text.empty()) return broken(Errc::malformed, "R-TET-13");
    const auto parsed = parse_number<T>(text);
    if (!parsed) return broken(Errc::malformed, "R-TET-11", text);
    value = *parsed;
    if constexpr (std::floating_point<T>) {
      if (!std::isfinite(value)) return broken(Errc::invalid, "R-TET-12", text);
    }
    return {};
  }
  /// How many of something follow, each at least `bytes` long.   err  as number(), R-TET-9 more than `most`, R-TET-10 more than can be
  tl::expected<void, Diagnostic> count(std::size_t& value, std::size_t most, std::size_t bytes);
  tl::expected<void, Diagnostic> coordinates(Vec3& value);
  /// No word is left on this line.   err  R-TET-13
  tl::expected<void, Diagnostic> end_of_line();

  tl::unexpected<Diagnostic> broken(Errc code, RuleName rule, std::string_view word = {}) const;

 private:
  std::string_view file_;
};

}  // namespace tactus::sim
