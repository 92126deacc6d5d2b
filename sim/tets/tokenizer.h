// SPDX-License-Identifier: Apache-2.0
/// Words of an untrusted text file, line by line, for the readers of mesh files.
#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <string_view>

#include <tactus/base/rule.h>
#include <tactus/sim/tets/tet_files.h>

namespace tactus::sim {

class Tokenizer {
 public:
  enum class Comments { none, hash };  ///< hash: from # to the end of the line
  Tokenizer(std::string_view text, std::string_view file, Comments comments) : rest_(text), file_(file), comments_(comments) {}

  /// Go to the next line that has words.   out  false: there is none
  bool next_line() noexcept;
  /// The same where there must be one.   err  R-TET-10
  tl::expected<void, Diagnostic> line();
  bool has_word() noexcept;          ///< on this line
  std::string_view word() noexcept;  ///< the next on this line; empty: none

  /// The next word as a number.   err  R-TET-11, R-TET-12, R-TET-13 (the line has no more words)
  template <class T>
  tl::expected<void, Diagnostic> number(T& value) {
    const std::string_view text = word();
    if (text.empty()) return broken(Errc::malformed, "R-TET-13");
    const std::string_view digits = text.starts_with('+') && !text.starts_with("+-") ? text.substr(1) : text;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size()) return broken(Errc::malformed, "R-TET-11", text);
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
  std::string_view rest_, line_, file_;  // behind the line, what is left of it
  std::size_t number_ = 0;
  Comments comments_;
};

}  // namespace tactus::sim
