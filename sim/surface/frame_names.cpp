// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/frame_names.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>

namespace tactus::sim {
namespace {

constexpr std::size_t kMostDigits = 18;          // of a number: whole numbers that 64 bits hold
constexpr std::size_t kNamedNumbers = 8;         // missing ones that a note names
constexpr std::uint64_t kMostMissing = 1000000;  // beyond that they are only counted

tl::unexpected<Diagnostic> refused(RuleName rule, std::string detail) {
  return tl::unexpected(Diagnostic{.error = fail(Errc::invalid, rule).value(), .detail = std::move(detail)});
}

bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }
bool is_letter_or_digit(char c) noexcept { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

/// A name as words and numbers in turn: words[0] numbers[0] words[1] ... Numbers keep their spelling.
struct Name {
  std::string full;
  std::vector<std::string> words = {""}, numbers = {};

  std::string pattern(std::size_t starred) const {
    std::string out = words[0];
    for (std::size_t i = 0; i < numbers.size(); ++i) out += (i == starred ? "*" : numbers[i]) + words[i + 1];
    return out;
  }
};

/// A sign belongs to the number where neither a letter nor a digit stands before it: f_-3, t=-0.5, but not frame-0001 nor 2024-05.
Name split(const std::string& full) {
  Name name;
  name.full = full;
  const std::size_t stem = full.rfind('.');
  std::size_t at = 0;
  while (at < stem) {
    const bool is_sign = (full[at] == '-' || full[at] == '+') && at + 1 < stem && is_digit(full[at + 1]) &&
                         (at == 0 || !is_letter_or_digit(full[at - 1]));
    if (!is_sign && !is_digit(full[at])) {
      name.words.back() += full[at++];
      continue;
    }
    std::size_t end = at + 1;
    while (end < stem && is_digit(full[end])) ++end;
    if (end + 1 < stem && full[end] == '.' && is_digit(full[end + 1])) {
      ++end;
      while (end < stem && is_digit(full[end])) ++end;
    }
    name.numbers.push_back(full.substr(at, end - at));
    name.words.emplace_back();
    at = end;
  }
  name.words.back() += full.substr(stem);
  return name;
}

/// f-1 beside f0: names whose numbers follow a letter and a minus are negative where others have none.
void take_signs(std::vector<Name>& names) {
  std::set<std::vector<std::string>> forms;
  for (const Name& name : names) forms.insert(name.words);
  for (Name& name : names) {
    for (std::size_t i = 0; i < name.numbers.size(); ++i) {
      if (!name.words[i].ends_with('-')) continue;
      std::vector<std::string> words = name.words;
      words[i].pop_back();
      if (!forms.contains(words)) continue;
      name.words = std::move(words);
      name.numbers[i].insert(0, 1, '-');
    }
  }
}

std::size_t decimals(const std::string& number) {
  const std::size_t point = number.find('.');
  return point == std::string::npos ? 0 : number.size() - point - 1;
}

/// The number times 10^places; nothing: it does not fit.
std::optional<std::int64_t> scaled(const std::string& number, std::size_t places) {
  std::string digits = number;
  const std::size_t own = decimals(number);
  if (own > 0) digits.erase(digits.size() - own - 1, 1);
  digits.append(places - own, '0');
  const std::size_t first = digits.find_first_of("123456789");
  if (first != std::string::npos && digits.size() - first > kMostDigits) return std::nullopt;
  return parse_number<std::int64_t>(digits);
}

std::string unscaled(std::int64_t value, std::size_t places) {
  std::string digits = std::to_string(std::abs(value));
  if (digits.size() <= places) digits.insert(0, places + 1 - digits.size(), '0');
  if (places > 0) digits.insert(digits.size() - places, 1, '.');
  return (value < 0 ? "-" : "") + digits;
}

/// Names of one form; what differs between them.
using Group = std::vector<Name>;

std::vector<std::size_t> varying(const Group& group) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < group[0].numbers.size(); ++i)
    if (std::any_of(group.begin(), group.end(), [&](const Name& n) { return n.numbers[i] != group[0].numbers[i]; }))
      out.push_back(i);
  return out;
}

std::size_t distinct(const Group& group, std::size_t number) {
  std::set<std::string> seen;
  for (const Name& name : group) seen.insert(name.numbers[number]);
  return seen.size();
}

tl::unexpected<Diagnostic> several(std::string first, std::string second) {
  auto error = refused("R-SEQ-5", first + " and " + second);
  error.value().remedy = "Choose one of them with --series '" + first + "', or keep each in a folder of its own.";
  return error;
}

/// A number that differs between all of a group: the only one, or the first of those that change together.
tl::expected<std::size_t, Diagnostic> number_of(const Group& group, ReadNotes& notes) {
  const std::vector<std::size_t> indices = varying(group);
  if (indices.empty()) return group[0].numbers.size();  // one file
  for (const std::size_t index : indices) {
    if (distinct(group, index) != group.size()) continue;
    if (indices.size() > 1)
      notes.add("", "several numbers of the names change together; the first in which all differ counts", group[0].full);
    return index;
  }
  const std::size_t last = indices.back();
  const auto other =
      std::find_if(group.begin(), group.end(), [&](const Name& n) { return n.pattern(last) != group[0].pattern(last); });
  return several(group[0].pattern(last), other->pattern(last));
}

tl::expected<Group, Diagnostic> only_group(std::vector<Name> names) {
  std::map<std::vector<std::string>, Group> groups;
  for (Name& name : names) groups[name.words].push_back(std::move(name));
  if (groups.size() == 1) return std::move(groups.begin()->second);
  const auto pattern = [](const Group& group) {
    const auto indices = varying(group);
    const std::size_t last = group[0].numbers.size();
    return group[0].pattern(!indices.empty() ? indices.back() : last > 0 ? last - 1 : 0);
  };
  return several(pattern(groups.begin()->second), pattern(std::next(groups.begin())->second));
}

/// * stands for anything.
bool matches(std::string_view text, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return text == pattern;
  if (!text.starts_with(pattern.substr(0, star))) return false;
  const std::string_view rest = pattern.substr(star + 1);
  for (std::size_t at = star; at <= text.size(); ++at)
    if (matches(text.substr(at), rest)) return true;
  return false;
}

std::string stem_of(const std::string& name) { return name.substr(0, name.rfind('.')); }

/// The difference that occurs most; of equals the smallest.
std::int64_t step_of(const std::vector<std::int64_t>& values) {
  std::map<std::int64_t, std::size_t> counts;
  for (std::size_t i = 1; i < values.size(); ++i) ++counts[values[i] - values[i - 1]];
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? 1 : most->first;
}

/// "frames 0 to 7, 3 and 4 missing".
void note_numbers(const std::vector<std::int64_t>& values, std::int64_t step, std::size_t places, ReadNotes& notes) {
  const auto name = [&](std::int64_t v) { return unscaled(v, places); };
  if (step != 1 || places > 0)
    notes.add("", "numbers go by " + name(step) + ": each step is one frame period (--rate or --period)");
  std::string missing;
  std::uint64_t count = 0;
  bool even = true;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const std::int64_t gap = values[i] - values[i - 1];
    even = even && gap % step == 0;
    for (std::int64_t v = values[i - 1] + step; v < values[i] && gap % step == 0 && count < kMostMissing; v += step)
      if (++count <= kNamedNumbers) missing += (count > 1 ? ", " : "") + name(v);
  }
  const std::string frames = "frames " + name(values.front()) + " to " + name(values.back());
  if (!even) notes.add("", frames + " are not at equal steps: their times follow their numbers");
  if (count > kNamedNumbers) missing += " ...";
  if (count > 0)
    notes.add("", frames + ", " + missing + " missing: the time goes on (" + std::to_string(count) +
                      (count == kMostMissing ? " or more" : "") + " in all)");
}

}  // namespace

bool is_backup(const std::string& name) {
  std::string low = name;
  std::transform(low.begin(), low.end(), low.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::string stem = stem_of(low);
  const auto has = [&](std::string_view part) { return stem.find(part) != std::string::npos; };
  return low.starts_with('.') || low.starts_with('#') || low.starts_with('~') || low.ends_with('~') || has("(copy") ||
         has("copy)") || has(" - copy") || stem.ends_with(" copy") || has("copy of ") || has(".bak") || has(".orig");
}

tl::expected<std::vector<FrameFile>, Diagnostic> order_frames(std::vector<std::string> files, const std::string& series,
                                                              ReadNotes& notes) {
  std::sort(files.begin(), files.end());
  if (!series.empty()) {
    const std::string example = files.empty() ? "" : files.front();
    std::erase_if(files, [&](const std::string& f) { return !matches(f, series) && !matches(stem_of(f), series); });
    if (files.empty()) return refused("R-SEQ-2", "no file is called like '" + series + "'; there is " + example);
  }
  std::vector<Name> names;
  names.reserve(files.size());
  for (const std::string& file : files) names.push_back(split(file));
  take_signs(names);
  TACTUS_TRY(auto group, only_group(std::move(names)));
  TACTUS_TRY(const auto index, number_of(group, notes));
  if (group.size() == 1) return std::vector<FrameFile>{{group[0].full, 0}};

  std::size_t places = 0;
  for (const Name& name : group) places = std::max(places, decimals(name.numbers[index]));
  std::vector<std::pair<std::int64_t, std::string>> frames;
  for (const Name& name : group) {
    const auto value = scaled(name.numbers[index], places);
    if (!value) return refused("R-SEQ-5", name.full + ": its number has more than 18 digits");
    frames.emplace_back(*value, name.full);
  }
  std::sort(frames.begin(), frames.end());
  const auto twice =
      std::adjacent_find(frames.begin(), frames.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
  if (twice != frames.end()) return refused("R-SEQ-5", "the same number in " + twice[0].second + " and " + twice[1].second);

  std::vector<std::int64_t> values;
  values.reserve(frames.size());
  for (const auto& [value, name] : frames) values.push_back(value);
  const std::int64_t step = step_of(values);
  note_numbers(values, step, places, notes);
  std::vector<FrameFile> out;
  out.reserve(frames.size());
  for (const auto& [value, name] : frames)
    out.push_back({name, static_cast<double>(value - values[0]) / static_cast<double>(step)});
  return out;
}

}  // namespace tactus::sim
