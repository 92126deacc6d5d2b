// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/sweep_plan.h"

#include <algorithm>
#include <sstream>
#include <string_view>

namespace tactus::cli {
namespace {

/// A command's word with value(NAME) for each {NAME}. What was inserted is not searched again.
template <class Value>
std::string filled(std::string_view word, Value value) {
  std::string out;
  while (true) {
    const std::size_t open = std::min(word.find('{'), word.size());
    out += word.substr(0, open);
    if (open == word.size()) return out;
    const std::size_t close = word.find('}', open);
    out += value(word.substr(open + 1, close - open - 1));
    word.remove_prefix(close + 1);
  }
}

/// Words between blanks.
std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

using Values = std::map<std::string, std::string, std::less<>>;  ///< what stands for {name}

Values named_values(const SweepPlan& plan, const std::vector<std::string>& chosen) {
  Values out;
  for (std::size_t i = 0; i < plan.parameters.size(); ++i) out[plan.parameters[i].name] = chosen[i];
  return out;
}

std::string filled(std::string_view word, const Values& values) {
  return filled(word, [&](std::string_view place) -> const std::string& { return values.find(place)->second; });
}

template <class Named>
void append_columns(std::vector<std::string>& out, const std::vector<Named>& named) {
  for (const Named& one : named) out.push_back(one.column);
}

}  // namespace

std::size_t SweepPlan::points() const {
  std::size_t count = 1;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (i == 0 || parameters[i].axis != parameters[i - 1].axis) count *= parameters[i].values.size();
  return count;
}

std::size_t SweepPlan::repetitions() const { return repeats ? parameters.back().values.size() : 1; }

std::vector<std::string> SweepPlan::values(std::size_t point) const {
  std::vector<std::string> out(parameters.size());
  for (std::size_t i = parameters.size(); i-- > 0;) {
    const std::size_t count = parameters[i].values.size();
    out[i] = parameters[i].values[point % count];
    if (i == 0 || parameters[i].axis != parameters[i - 1].axis) point /= count;
  }
  return out;
}

/// Turned by one from block to block: where the last parameter has as many values as there are shards, each gets all of them.
bool SweepPlan::is_of(std::size_t point, const SweepShard& shard) const {
  return (point + point / shard.count) % shard.count == shard.index - 1;
}

const SweepInput* SweepPlan::input_named(const std::string& value) const {
  const auto input = std::ranges::find(inputs, value, &SweepInput::name);
  return input == inputs.end() ? nullptr : &*input;
}

std::vector<std::pair<std::string, const SweepInput*>> SweepPlan::files_of(std::size_t point) const {
  const auto chosen = values(point);
  const Values named = named_values(*this, chosen);
  std::vector<std::pair<std::string, const SweepInput*>> out;
  for (const std::string& value : chosen)
    if (const SweepInput* input = input_named(value)) out.emplace_back(filled(input->file, named), input);
  return out;
}

std::vector<std::string> SweepPlan::words(const SweepInput& input, std::size_t point, const std::string& path) const {
  Values named = named_values(*this, values(point));
  named["file"] = path;
  std::vector<std::string> out;
  for (const std::string& word : input.command) out.push_back(filled(word, named));
  return out;
}

std::vector<std::string> SweepPlan::words(std::size_t point,
                                          const std::function<std::string(const std::string& file)>& path_of) const {
  const auto chosen = values(point);
  const Values named = named_values(*this, chosen);
  Values stands;
  std::map<std::string, std::string> split_words;  // {name} as a word of its own -> words
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const SweepInput* input = input_named(chosen[i]);
    stands[parameters[i].name] = input ? path_of(filled(input->file, named)) : chosen[i];
    if (!input) split_words["{" + parameters[i].name + "}"] = chosen[i];
  }
  std::vector<std::string> out;
  for (const std::string& word : command) {
    if (const auto found = split_words.find(word); found != split_words.end()) {
      for (std::string& part : split(found->second)) out.push_back(std::move(part));
    } else {
      out.push_back(filled(word, stands));
    }
  }
  return out;
}

std::vector<std::string> SweepPlan::columns() const {
  std::vector<std::string> out;
  for (const SweepParameter& parameter : parameters) out.push_back(parameter.name);
  append_columns(out, measures);
  return out;
}

std::vector<std::string> SweepPlan::time_columns() const {
  std::vector<std::string> out;
  for (const SweepParameter& parameter : parameters) out.push_back(parameter.name);
  out.insert(out.end(), {kHostColumn, kSecondsColumn});
  append_columns(out, times);
  return out;
}

std::vector<std::string> SweepPlan::all_columns() const {
  std::vector<std::string> out = columns();
  out.insert(out.end(), {kHostColumn, kSecondsColumn});
  append_columns(out, times);
  append_columns(out, derived);
  return out;
}

}  // namespace tactus::cli
