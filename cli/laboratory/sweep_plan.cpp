// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/sweep_plan.h"

#include <map>
#include <set>
#include <sstream>

#include <tactus/sim/scene/toml_reader.h>
#include "cli/output.h"

namespace tactus::cli {
namespace {

constexpr std::size_t kMostPoints = 1000000;
constexpr std::size_t kMostEntries = 256;    // of each list but the values of a parameter
constexpr std::size_t kLongestWord = 65536;  // [bytes] of a command with its values: Linux passes twice as much
constexpr std::size_t kLongestPath = 4096;   // [bytes] PATH_MAX of Linux
constexpr std::size_t kMostPlanBytes = std::size_t{1} << 20;

bool is_simple(std::string_view name) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '.'; };
  return !name.empty() && name.front() != '.' && std::all_of(name.begin(), name.end(), plain);
}

/// RFC 6901: begins with '/', and '~' stands in ~0 and ~1 only. Numbers of elements have at most nine digits.
bool is_json_pointer(std::string_view text) {
  constexpr std::size_t kMostDigits = 9;
  for (std::size_t at = text.find('/'); at != std::string_view::npos; at = text.find('/', at + 1)) {
    const std::string_view token = text.substr(at + 1, text.find('/', at + 1) - at - 1);
    if (token.size() > kMostDigits && token.find_first_not_of("0123456789") == std::string_view::npos) return false;
  }
  for (std::size_t at = text.find('~'); at != std::string_view::npos; at = text.find('~', at + 1))
    if (at + 1 == text.size() || (text[at + 1] != '0' && text[at + 1] != '1')) return false;
  return text.starts_with('/');
}

class PlanReader {
 public:
  explicit PlanReader(std::string_view file) : in_(file) {}

  SweepPlan read(const toml::table& root) {
    in_.allow(root, "", {"name", "command", "input", "vary", "measure", "plot"});
    SweepPlan plan;
    plan.name = name(root, "", "name");
    plan.command = strings(root, "", "command");
    for (const toml::table* table : in_.tables(root, "", "input")) plan.inputs.push_back(input(*table));
    check_size(root, "input", plan.inputs.size());
    check_size(root, "command", plan.command.size());
    if (const toml::table* vary = required_table(root, "vary")) {
      check_size(*vary, "vary", vary->size());
      for (const auto& [key, node] : *vary)
        plan.parameters.push_back({std::string(key.str()), strings(*vary, "vary", key.str())});
    }
    if (const toml::table* measure = required_table(root, "measure")) {
      check_size(*measure, "measure", measure->size());
      for (const auto& [key, node] : *measure) plan.measures.push_back(measured(*measure, key.str()));
    }
    const auto plots = in_.tables(root, "", "plot");
    check_size(root, "plot", plots.size());
    if (in_.failed()) return plan;  // what follows compares everything with everything
    for (const toml::table* table : plots) plan.plots.push_back(plot(*table, plan));
    check_uses(root, plan);
    check_files(root, plan);
    return plan;
  }

  void parse(std::string_view text, SweepPlan& plan) {
    in_.parse(text, kMostPlanBytes, [&](const toml::table& root) { plan = read(root); });
  }
  bool failed() const { return in_.failed(); }
  Diagnostic error() const { return in_.error(); }

 private:
  void invalid(const toml::node& node, RuleName rule, std::string key, std::string remedy) {
    in_.fail_at(node.source(), Errc::invalid, rule, std::move(key), std::move(remedy));
  }

  void check_size(const toml::node& node, const char* key, std::size_t count) {
    if (count > kMostEntries) invalid(node, "R-SCN-6", key, "give at most " + std::to_string(kMostEntries));
  }

  const toml::table* required_table(const toml::table& root, const char* key) {
    const toml::table* table = in_.table(root, "", key);
    if (!table) invalid(root, "R-SCN-4", key, std::string("add a table [") + key + "]");
    return table;
  }

  std::string name(const toml::table& table, const std::string& path, const char* key) {
    std::string value = in_.text(table, path, key);
    if (!value.empty() && !is_simple(value))
      invalid(table, "R-SCN-6", sim::TomlReader::join(path, key), "use letters, digits, '-', '_' and '.' only");
    return value;
  }

  std::vector<std::string> strings(const toml::table& table, const std::string& path, std::string_view key) {
    std::vector<std::string> out;
    const toml::node* node = table.get(key);
    const toml::array* array = node ? node->as_array() : nullptr;
    const std::string place = sim::TomlReader::join(path, key);
    if (!array || array->empty()) {
      invalid(node ? *node : table, node ? RuleName("R-SCN-5") : RuleName("R-SCN-4"), place,
              "write an array of strings, at least one");
      return out;
    }
    for (const auto& element : *array) {
      const auto text = element.value_exact<std::string>();
      if (!text) invalid(element, "R-SCN-5", place, "write strings, as on a command line: \"2.5%\"");
      out.push_back(text.value_or(""));
    }
    return out;
  }

  SweepInput input(const toml::table& table) {
    in_.allow(table, "input", {"name", "file", "command"});
    SweepInput out{name(table, "input", "name"), name(table, "input", "file"), strings(table, "input", "command")};
    check_places(table, "input.command", out.command, {{"file", kLongestPath}});
    return out;
  }

  SweepMeasure measured(const toml::table& table, std::string_view column) {
    SweepMeasure measure{std::string(column), in_.text(table, "measure", column)};
    if (!measure.place.empty() && !is_json_pointer(measure.place))
      invalid(table, "R-SCN-6", sim::TomlReader::join("measure", column),
              "write a JSON pointer, such as /traffic/payload/bit_per_s");
    return measure;
  }

  void check_column(const toml::table& table, const char* key, const std::string& value, const SweepPlan& plan) {
    const auto columns = plan.columns();
    if (std::find(columns.begin(), columns.end(), value) == columns.end())
      invalid(table, "R-SCN-7", sim::TomlReader::join("plot", key), "name a parameter or a measure of this plan");
  }

  /// A rule of `where` names a column, and of a parameter a value that it takes.
  void check_rule(const toml::table& where, const std::pair<std::string, std::string>& rule, const SweepPlan& plan) {
    check_column(where, "where", rule.first, plan);
    for (const SweepParameter& p : plan.parameters)
      if (p.name == rule.first && std::find(p.values.begin(), p.values.end(), rule.second) == p.values.end())
        invalid(where, "R-SCN-7", "plot.where." + rule.first, "give one of the values of this parameter in [vary]");
  }

  std::string column(const toml::table& table, const char* key, const SweepPlan& plan) {
    std::string value = in_.text(table, "plot", key);
    check_column(table, key, value, plan);
    return value;
  }

  /// A text or an array of texts.
  std::vector<std::string> texts(const toml::table& table, const char* key) {
    const toml::node* node = table.get(key);
    if (node && node->is_array()) return strings(table, "plot", key);
    return {in_.text(table, "plot", key)};
  }

  SweepPlot plot(const toml::table& table, const SweepPlan& plan) {
    in_.allow(table, "plot", {"name", "title", "x", "y", "series", "x_label", "y_label", "log", "where"});
    SweepPlot plot;
    plot.name = name(table, "plot", "name");
    plot.title = in_.text(table, "plot", "title", plot.name);
    plot.x = column(table, "x", plan);
    plot.y = texts(table, "y");
    for (const std::string& y : plot.y) check_column(table, "y", y, plan);
    plot.series = column(table, "series", plan);
    plot.x_label = in_.text(table, "plot", "x_label", plot.x);
    plot.y_label = table.contains("y_label") ? texts(table, "y_label") : plot.y;
    if (plot.y_label.size() != plot.y.size()) invalid(table, "R-SCN-7", "plot.y_label", "give one for each y");
    const std::size_t axes = in_.word(table, "plot", "log", {"none", "x", "y", "xy"}, "none");
    plot.log_x = axes == 1 || axes == 3;
    plot.log_y = axes >= 2;
    if (const toml::table* where = in_.table(table, "plot", "where"))
      for (const auto& [key, node] : *where) {
        plot.where.emplace_back(key.str(), in_.text(*where, "plot.where", key.str()));
        check_rule(*where, plot.where.back(), plan);
      }
    return plot;
  }

  using Lengths = std::map<std::string, std::size_t, std::less<>>;  ///< [bytes] by name, of what stands for {name} at most

  /// Each {name} in a command stands for something, and no word grows too long.
  void check_places(const toml::node& at, const char* key, const std::vector<std::string>& words, const Lengths& lengths) {
    for (const std::string& word : words) {
      std::size_t length = word.size();
      for (std::size_t open = word.find('{'); open != std::string::npos; open = word.find('{', open + 1)) {
        const std::size_t close = word.find('}', open);
        const std::string place = word.substr(open + 1, close - open - 1);
        const auto known = lengths.find(place);
        if (close == std::string::npos) invalid(at, "R-SCN-7", key, "close {" + place + " with a }");
        else if (known == lengths.end()) invalid(at, "R-SCN-7", key, "correct {" + place + "}: nothing here has this name");
        else length += known->second;
      }
      if (length > kLongestWord)
        invalid(at, "R-SCN-6", key, "shorten a word: with its values it may have at most 65536 bytes, files counted as 4096");
    }
  }

  static Lengths lengths_of(const SweepPlan& plan) {
    Lengths lengths;
    for (const SweepParameter& parameter : plan.parameters)
      for (const std::string& value : parameter.values) {
        std::size_t& longest = lengths[parameter.name];
        longest = std::max(longest, plan.input_named(value) ? kLongestPath : value.size());
      }
    return lengths;
  }

  /// Every parameter is used in the command and nothing else, and the sweep has a sane number of points.
  void check_uses(const toml::table& root, const SweepPlan& plan) {
    std::size_t points = 1;
    check_places(root.contains("command") ? *root.get("command") : root, "command", plan.command, lengths_of(plan));
    for (const SweepParameter& parameter : plan.parameters) {
      points = std::min(points * parameter.values.size(), kMostPoints + 1);
      const std::string word = "{" + parameter.name + "}";
      const auto uses = [&](const std::string& w) { return w.find(word) != std::string::npos; };
      if (std::none_of(plan.command.begin(), plan.command.end(), uses))
        invalid(*root["vary"][parameter.name].node(), "R-SCN-7", "vary." + parameter.name,
                "use " + word + " in command, or leave the parameter out");
    }
    if (points > kMostPoints) invalid(root, "R-SCN-6", "vary", "stay below 1000000 combinations");
  }

  /// Names in the sweep's folder: its own, those of inputs and of figures.
  void check_files(const toml::table& root, const SweepPlan& plan) {
    std::set<std::string> files{"points.csv", "context.json"}, names;
    for (const SweepInput& input : plan.inputs)
      if (!names.insert(input.name).second || !files.insert(input.file).second)
        invalid(root, "R-SCN-7", "input", "give every input a name and a file of its own, and not points.csv or context.json");
    for (const SweepPlot& plot : plan.plots)
      if (!files.insert(plot.name + ".svg").second)
        invalid(root, "R-SCN-7", "plot.name", "give every figure a name of its own, which with .svg is no input's file");
  }

  sim::TomlReader in_;
};

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

}  // namespace

std::size_t SweepPlan::points() const {
  std::size_t count = 1;
  for (const SweepParameter& parameter : parameters) count *= parameter.values.size();
  return count;
}

std::vector<std::string> SweepPlan::values(std::size_t point) const {
  std::vector<std::string> out(parameters.size());
  for (std::size_t i = parameters.size(); i-- > 0;) {
    const std::size_t count = parameters[i].values.size();
    out[i] = parameters[i].values[point % count];
    point /= count;
  }
  return out;
}

std::vector<std::string> SweepInput::words(const std::string& path) const {
  std::vector<std::string> out;
  for (const std::string& word : command)
    out.push_back(filled(word, [&](std::string_view) -> const std::string& { return path; }));
  return out;
}

const SweepInput* SweepPlan::input_named(const std::string& value) const {
  const auto input = std::ranges::find(inputs, value, &SweepInput::name);
  return input == inputs.end() ? nullptr : &*input;
}

std::vector<std::string> SweepPlan::words(std::size_t point, const std::string& folder) const {
  const auto chosen = values(point);
  std::map<std::string, std::string, std::less<>> stands;
  std::map<std::string, std::string> split_words;  // {name} as a word of its own -> words
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const SweepInput* input = input_named(chosen[i]);
    stands[parameters[i].name] = input ? folder + "/" + input->file : chosen[i];
    if (!input) split_words["{" + parameters[i].name + "}"] = chosen[i];
  }
  std::vector<std::string> out;
  for (const std::string& word : command) {
    if (const auto found = split_words.find(word); found != split_words.end()) {
      for (std::string& part : split(found->second)) out.push_back(std::move(part));
    } else {
      out.push_back(filled(word, [&](std::string_view place) -> const std::string& { return stands.find(place)->second; }));
    }
  }
  return out;
}

std::vector<std::string> SweepPlan::columns() const {
  std::vector<std::string> out;
  for (const SweepParameter& parameter : parameters) out.push_back(parameter.name);
  for (const SweepMeasure& measure : measures) out.push_back(measure.column);
  return out;
}

tl::expected<SweepPlan, Failure> load_plan(const std::string& path) {
  TACTUS_TRY(const auto text, read_file(path, kMostPlanBytes));
  PlanReader reader(path);
  SweepPlan plan;
  reader.parse(text, plan);
  if (reader.failed()) return refuse(reader.error());
  plan.text = text;
  return plan;
}

}  // namespace tactus::cli
