// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_header.h>

#include <algorithm>
#include <array>
#include <set>

#include <tactus/base/shown.h>
#include <tactus/base/text.h>
#include <tactus/trace/csv_fields.h>
#include <tactus/trace/csv_units.h>

namespace tactus {
namespace {

using Fields = std::vector<std::string>;

Fields split(std::string_view text, char separator) {
  Fields fields;
  split_fields(text, separator, fields);
  return fields;
}

/// Of a comment, without its mark.
std::string_view words_of(const CsvLine& line) {
  std::string_view text = trim_field(line.text);
  text.remove_prefix(std::min(text.find_first_not_of("#%/"), text.size()));
  return trim_field(text);
}

/// What separates the fields of a line of names: the most frequent one outside quotes; blanks if there is no other.
char separator_of(std::string_view names) noexcept {
  constexpr std::string_view kMarks = ",;\t|";
  std::array<std::size_t, kMarks.size()> counts{};
  bool is_quoted = false;
  for (const char c : names) {
    if (c == '"') is_quoted = !is_quoted;
    const std::size_t which = kMarks.find(c);
    if (which != std::string_view::npos && !is_quoted) ++counts[which];
  }
  return kMarks[static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin())];
}

struct Values {
  std::size_t fields = 0, numbers = 0, missing = 0;
  bool are_values() const { return numbers > 0 && 2 * (numbers + missing) > fields; }
  bool are_all() const { return fields > 1 && numbers == fields; }
};

Values count_values(const Fields& fields) {
  Values values{.fields = fields.size()};
  for (const std::string& field : fields) {
    if (is_missing_word(field)) ++values.missing;
    else if (is_value(field)) ++values.numbers;
  }
  return values;
}

/// The separator by which the line has the most values; of equal ones the likelier.
char separator_of_values(std::string_view text) {
  char best = ',';
  double most = -1;
  for (const char separator : kCsvSeparators) {
    const Values values = count_values(split(text, separator));
    const double fraction = static_cast<double>(values.numbers + values.missing) / static_cast<double>(values.fields);
    const double score = values.numbers == 0 ? 0 : fraction + (values.fields > 1 ? 1e-3 : 0);
    if (score > most + 1e-9) best = separator, most = score;
  }
  return best;
}

class Finder {
 public:
  explicit Finder(std::span<const CsvLine> lines) : lines_(lines) {
    for (std::size_t i = 0; i < lines.size(); ++i) (lines[i].is_comment ? comments_ : rows_).push_back(i);
  }

  CsvHeader find(CsvNames names) {
    take_separator_line();
    if (names == CsvNames::first) names_are_first();
    else if (names == CsvNames::none) has_no_names(0);
    else find_names();
    for (std::string& name : header_.names) name = std::string(trim_field(name));
    return std::move(header_);
  }

 private:
  void take_separator_line();
  void names_are_first();
  void has_no_names(std::size_t row);
  void find_names();
  bool begins_values(std::size_t row, char separator) const;
  bool names_are_in_a_comment(std::size_t values);
  void stack_names(std::vector<Fields> stack);
  void read_preamble(std::size_t end);
  void take_length_unit(std::string_view field, std::string_view next);
  char separator(std::string_view text) const { return fixed_ != 0 ? fixed_ : separator_of_values(text); }

  std::span<const CsvLine> lines_;
  std::vector<std::size_t> rows_, comments_;
  char fixed_ = 0;  // by a line sep=;
  CsvHeader header_;
};

void Finder::take_separator_line() {
  if (rows_.empty()) return;
  const std::string_view first = trim_field(lines_[rows_[0]].text);
  const bool is_it = first.starts_with("sep=") && first.size() <= 5;
  if (!is_it) return;
  fixed_ = first.size() == 5 ? first[4] : '\t';  // a tab was trimmed
  rows_.erase(rows_.begin());
}

void Finder::names_are_first() {
  if (rows_.empty()) return;
  const CsvLine& line = lines_[rows_[0]];
  const char by_values = rows_.size() > 1 ? separator(lines_[rows_[1]].text) : separator_of(line.text);
  header_.separator = split(line.text, by_values).size() > 1 ? by_values : fixed_ != 0 ? fixed_ : separator_of(line.text);
  header_.names = split(line.text, header_.separator);
  header_.line = line.number;
  header_.values = rows_[0] + 1;
}

void Finder::has_no_names(std::size_t row) {
  if (row >= rows_.size()) return;
  const CsvLine& line = lines_[rows_[row]];
  header_.separator = separator(line.text);
  Fields fields = split(line.text, header_.separator);
  if (fields.size() > 1 && fields.back().empty()) fields.pop_back();
  for (std::size_t i = 0; i < fields.size(); ++i) header_.names.push_back('#' + std::to_string(i + 1));
  header_.values = rows_[row];
  header_.line = line.number;
  header_.notes.add("", "the table does not name its columns: they are #1 to #" + std::to_string(fields.size()));
}

bool Finder::begins_values(std::size_t row, char separator) const {
  const Values values = count_values(split(lines_[rows_[row]].text, separator));
  if (!values.are_values()) return false;
  if (values.are_all()) return true;
  constexpr std::size_t kFollow = 8;  // what a preamble declares of several channels looks like values for some lines
  for (std::size_t i = row + 1; i < std::min(rows_.size(), row + 1 + kFollow); ++i) {
    const Values next = count_values(split(lines_[rows_[i]].text, separator));
    const bool is_text = next.numbers == 0 && next.missing != next.fields;
    if (is_text || (i == row + 1 && !next.are_values() && next.missing != next.fields)) return false;
  }
  return true;
}

/// As numpy.savetxt, TUM and EuRoC write them.
bool Finder::names_are_in_a_comment(std::size_t values) {
  const std::size_t wanted = split(lines_[rows_[values]].text, header_.separator).size();
  for (std::size_t i = comments_.size(); i-- > 0;) {
    const std::size_t comment = comments_[i];
    if (comment > rows_[values]) continue;
    const std::string_view text = words_of(lines_[comment]);
    for (const char separator : {header_.separator, ',', ';', '\t', kBlanks}) {
      Fields names = split(text, separator);
      if (names.size() == wanted + 1 && names.back().empty()) names.pop_back();
      if (names.size() != wanted || count_values(names).numbers > 0) continue;
      header_.names = std::move(names);
      header_.line = lines_[comment].number;
      return true;
    }
    return false;
  }
  return false;
}

/// Names of one or several lines, the lowest first.
void Finder::stack_names(std::vector<Fields> stack) {
  const auto is_units = [](const Fields& fields) {
    std::size_t known = 0;
    for (const std::string& field : fields) {
      if (field.empty() || field == "-" || field == "[]") continue;
      if (!unit_of(field)) return false;
      ++known;
    }
    return known > 0;
  };
  if (stack.size() > 1 && is_units(stack[0])) {
    header_.units = stack[0];
    stack.erase(stack.begin());
  }
  header_.names = stack[0];
  std::set<std::size_t> doubled;
  for (std::size_t i = 0; i < stack[0].size(); ++i)
    if (!stack[0][i].empty() && std::ranges::count(stack[0], stack[0][i]) > 1) doubled.insert(i);
  if (doubled.empty() || stack.size() == 1) return;
  for (std::size_t level = 1; level < stack.size(); ++level) {
    Fields& above = stack[level];
    for (std::size_t i = 1; i < above.size(); ++i)
      if (above[i].empty()) above[i] = above[i - 1];
    std::set<std::string> different;
    for (const std::size_t i : doubled) different.insert(above[i]);
    if (different.size() < 2) continue;
    for (std::size_t i = 0; i < above.size(); ++i)  // the others of their groups: X, Y, Z of two, W of one
      if (!above[i].empty() && different.contains(above[i])) doubled.insert(i);
    for (const std::size_t i : doubled)
      if (!above[i].empty()) header_.names[i] = above[i] + ' ' + header_.names[i];
  }
  header_.notes.add(
      "", "names are in several lines: a column is called, for example, '" + shown(header_.names[*doubled.begin()]) + '\'');
}

/// "Length Units,Millimeters", "Units: mm"
void Finder::take_length_unit(std::string_view field, std::string_view next) {
  std::size_t word = field.find("nits");
  if (word == std::string_view::npos) word = field.find("nit");
  if (word == std::string_view::npos || word == 0 || (field[word - 1] | 0x20) != 'u') return;
  const std::size_t colon = field.find_first_of(":=", word);
  const std::string_view stated = colon == std::string_view::npos || colon + 1 == field.size() ? next : field.substr(colon + 1);
  if (const auto unit = unit_of(stated); unit && unit->dimension == CsvDimension::length)
    header_.length_unit = trim_field(stated);
}

/// Lines ahead of the names. Of what they declare, the unit of lengths is known.
void Finder::read_preamble(std::size_t end) {
  for (std::size_t row = 0; row < end; ++row) {
    const CsvLine& line = lines_[rows_[row]];
    const Fields fields = split(line.text, separator_of(line.text));
    for (std::size_t i = 0; i < fields.size(); ++i) take_length_unit(fields[i], i + 1 < fields.size() ? fields[i + 1] : "");
    header_.notes.add("", "lines ahead of the names are no values",
                      "line " + std::to_string(line.number) + ", '" + shown(line.text, 100) + '\'');
  }
}

void Finder::find_names() {
  std::size_t values = 0;
  while (values < rows_.size() && !begins_values(values, separator(lines_[rows_[values]].text))) ++values;
  if (values == rows_.size()) return names_are_first();
  header_.separator = separator(lines_[rows_[values]].text);
  header_.values = rows_[values];
  if (values == 0) {
    if (!names_are_in_a_comment(0)) has_no_names(0);
    return;
  }
  const Fields first = split(lines_[rows_[values]].text, header_.separator);
  const std::size_t count = first.size() - (first.size() > 1 && first.back().empty() ? 1 : 0);
  std::vector<Fields> stack;
  std::size_t top = values;
  while (top > 0) {
    Fields fields = split(lines_[rows_[top - 1]].text, header_.separator);
    if (fields.size() == first.size() + 1 && fields.back().empty()) fields.pop_back();
    if (fields.size() != first.size() && fields.size() != count) break;
    stack.push_back(std::move(fields));
    --top;
  }
  if (stack.empty()) {  // the names do not fit: the first row is wrong, or they are
    const CsvLine& line = lines_[rows_[values - 1]];
    header_.separator = fixed_ != 0 ? fixed_ : separator_of(line.text);
    header_.names = split(line.text, header_.separator);
    top = values - 1;
  } else {
    for (Fields& fields : stack) fields.resize(stack[0].size());
    stack_names(std::move(stack));
  }
  header_.line = lines_[rows_[values - 1]].number - (header_.units.empty() ? 0 : 1);
  read_preamble(top);
}

}  // namespace

CsvHeader find_header(std::span<const CsvLine> lines, CsvNames names) { return Finder(lines).find(names); }

}  // namespace tactus
