// SPDX-License-Identifier: Apache-2.0
/// Typed access to a TOML table that remembers the first rule broken, so that scene.cpp reads as a list of keys.
#pragma once

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/sim/scene/scene.h>

namespace tactus::sim {

// ==== toml text ====
// Limits the nesting of a TOML file before it is parsed. The parser recurses for every nested table, in any notation, and does
// not limit the parts of a dotted key.

inline constexpr std::size_t kMostTomlNesting = 32;  ///< parts of one dotted key; brackets within brackets

/// The first line that exceeds this limit. Strings and comments are skipped by the rules of TOML 1.0; text that is not TOML is
/// checked up to its first mistake.   time O(size), no allocation
std::optional<std::uint32_t> too_nested_line(std::string_view text) noexcept;

// ==== toml reader ====

struct Range {
  double low, high;
};

/// A device, a pipe or a folder, which is not read like a file.
inline bool is_special_file(const std::string& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
}

class TomlReader {
 public:
  explicit TomlReader(std::string_view file) : file_(file) {}

  bool failed() const { return error_.has_value(); }
  Diagnostic error() const { return *error_; }

  void fail_at(const toml::source_region& where, Errc code, RuleName rule, std::string key, std::string remedy) {
    if (!error_)
      error_ = Diagnostic{.error = tactus::fail(code, rule).value(),
                          .file = file_,
                          .line = where.begin.line,
                          .detail = std::move(key),
                          .remedy = std::move(remedy)};
  }

  /// Parse `text` and hand its root to `read`.   err  R-SCN-2, R-SCN-9
  template <class Read>
  void parse(std::string_view text, std::size_t most_bytes, Read read) {
    const auto exceeds = [&](std::uint32_t line, std::string remedy) {
      error_ = Diagnostic{.error = tactus::fail(Errc::limit_exceeded, "R-SCN-9").value(),
                          .file = file_,
                          .line = line,
                          .remedy = std::move(remedy)};
    };
    if (text.size() > most_bytes) return exceeds(0, "give a file of at most " + std::to_string(most_bytes >> 20) + " MiB");
    if (const auto line = too_nested_line(text))
      return exceeds(*line, "nest tables, arrays and dotted keys at most " + std::to_string(kMostTomlNesting) + " deep");
    try {
      read(toml::parse(text, file_));
    } catch (const toml::parse_error& error) {
      fail_at(error.source(), Errc::malformed, "R-SCN-2", "", std::string(error.description()));
    }
  }

  /// Keys outside `known` are errors: a misspelt key must not turn into a default.
  void allow(const toml::table& table, const std::string& path, std::initializer_list<std::string_view> known) {
    for (const auto& [key, node] : table) {
      if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
      std::string remedy = "use one of:";
      for (const auto name : known) remedy.append(" ").append(name);
      fail_at(key.source(), Errc::invalid, "R-SCN-3", join(path, key.str()), std::move(remedy));
    }
  }

  double number(const toml::table& table, const std::string& path, std::string_view key, Range range,
                std::optional<double> fallback = std::nullopt) {
    const toml::node* node = find(table, path, key, fallback.has_value());
    return node ? checked_number(*node, join(path, key), range) : fallback.value_or(range.low);
  }

  std::uint32_t whole(const toml::table& table, const std::string& path, std::string_view key, Range range,
                      std::optional<std::uint32_t> fallback = std::nullopt) {
    const toml::node* node = find(table, path, key, fallback.has_value());
    return node ? checked_whole(*node, join(path, key), range) : fallback.value_or(static_cast<std::uint32_t>(range.low));
  }

  std::uint32_t checked_whole(const toml::node& node, const std::string& key, Range range) {
    const double value = checked_number(node, key, range);
    if (value != std::floor(value)) fail_at(node.source(), Errc::invalid, "R-SCN-5", key, "write a whole number");
    return static_cast<std::uint32_t>(value);
  }

  Vec3 vector(const toml::table& table, const std::string& path, std::string_view key, Range range,
              std::optional<Vec3> fallback = std::nullopt) {
    const toml::node* node = find(table, path, key, fallback.has_value());
    if (!node) return fallback.value_or(Vec3{});
    const auto v = numbers<3>(*node, join(path, key), range);
    return {v[0], v[1], v[2]};
  }

  template <std::size_t N>
  std::array<double, N> numbers(const toml::node& node, const std::string& key, Range range) {
    std::array<double, N> out{};
    const toml::array* array = node.as_array();
    if (!array || array->size() != N) {
      fail_at(node.source(), Errc::invalid, "R-SCN-5", key, "write an array of " + std::to_string(N) + " numbers");
      return out;
    }
    for (std::size_t i = 0; i < N; ++i) out[i] = checked_number((*array)[i], key, range);
    return out;
  }

  bool flag(const toml::table& table, const std::string& path, std::string_view key, bool fallback) {
    const toml::node* node = find(table, path, key, true);
    if (!node) return fallback;
    if (!node->is_boolean()) fail_at(node->source(), Errc::invalid, "R-SCN-5", join(path, key), "write true or false");
    return node->value_or(fallback);
  }

  std::string text(const toml::table& table, const std::string& path, std::string_view key,
                   const std::optional<std::string>& fallback = std::nullopt) {
    const toml::node* node = find(table, path, key, fallback.has_value());
    if (!node) return fallback.value_or("");
    const auto value = node->value_exact<std::string>();
    if (!value || value->empty() || value->size() > 255)
      fail_at(node->source(), Errc::invalid, "R-SCN-5", join(path, key), "write a string of 1 to 255 bytes");
    return value.value_or("");
  }

  /// What becomes part of a topic of the trace and of a column.
  std::string name(const toml::table& table, const std::string& path) {
    std::string given = text(table, path, "name");
    if (!given.empty() && !is_plain_name(given))
      fail_at(table["name"].node()->source(), Errc::invalid, "R-SCN-6", join(path, "name"),
              "write UTF-8 without '/' and control characters");
    return given;
  }

  /// A word of a fixed list, as its index.
  std::size_t word(const toml::table& table, const std::string& path, std::string_view key,
                   std::initializer_list<std::string_view> words, std::string fallback) {
    return word(table, path, key, std::span(words.begin(), words.size()), std::move(fallback));
  }
  std::size_t word(const toml::table& table, const std::string& path, std::string_view key,
                   std::span<const std::string_view> words, std::string fallback) {
    const std::string value = text(table, path, key, std::move(fallback));
    const auto found = std::find(words.begin(), words.end(), value);
    if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    std::string remedy = "use one of:";
    for (const auto name : words) remedy.append(" ").append(name);
    fail_at(table[key].node() ? table[key].node()->source() : table.source(), Errc::invalid, "R-SCN-7", join(path, key),
            std::move(remedy));
    return 0;
  }

  /// The tables of `[[key]]`; none if it is absent.
  std::vector<const toml::table*> tables(const toml::table& table, const std::string& path, std::string_view key) {
    std::vector<const toml::table*> out;
    const toml::node* node = find(table, path, key, true);
    if (!node) return out;
    const toml::array* array = node->as_array();
    if (!array || !array->is_homogeneous(toml::node_type::table)) {
      fail_at(node->source(), Errc::invalid, "R-SCN-5", join(path, key), "write it as [[" + join(path, key) + "]]");
      return out;
    }
    for (const auto& element : *array) out.push_back(element.as_table());
    return out;
  }

  /// The table `[key]`; null if it is absent.
  const toml::table* table(const toml::table& parent, const std::string& path, std::string_view key) {
    const toml::node* node = find(parent, path, key, true);
    if (node && !node->is_table())
      fail_at(node->source(), Errc::invalid, "R-SCN-5", join(path, key), "write it as [" + join(path, key) + "]");
    return node ? node->as_table() : nullptr;
  }

  static std::string join(const std::string& path, std::string_view key) {
    return path.empty() ? std::string(key) : path + "." + std::string(key);
  }

 private:
  const toml::node* find(const toml::table& table, const std::string& path, std::string_view key, bool optional) {
    const toml::node* node = table.get(key);
    if (!node && !optional)
      fail_at(table.source(), Errc::invalid, "R-SCN-4", join(path, key), "add this key to the table that begins here");
    return node;
  }

  double checked_number(const toml::node& node, const std::string& key, Range range) {
    const auto value = node.value<double>();
    if (!node.is_number() || !value) {
      fail_at(node.source(), Errc::invalid, "R-SCN-5", key, "write a number");
      return range.low;
    }
    if (!(*value >= range.low && *value <= range.high)) {
      fail_at(node.source(), Errc::invalid, "R-SCN-6", key,
              "stay within " + short_number(range.low) + " to " + short_number(range.high));
      return range.low;
    }
    return *value;
  }

  static std::string short_number(double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%g", value);
    return buffer;
  }

  std::string file_;
  std::optional<Diagnostic> error_;
};

}  // namespace tactus::sim
