// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include <tactus/sim/scene/toml_reader.h>
#include "cli/laboratory/sweep_plan.h"
#include "cli/output.h"

namespace tactus::cli {
namespace {

constexpr std::size_t kMostPoints = 1000000;
constexpr std::uint32_t kMostInRange = 1000;
constexpr const char* kOwnFiles[] = {"points.csv", "times.csv", "table.csv", "context.json", "shards"};
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
    in_.allow(root, "", {"name", "command", "input", "vary", "zip", "repeat", "measure", "time", "derive", "plot"});
    SweepPlan plan;
    plan.name = name(root, "", "name");
    plan.command = strings(root, "", "command");
    const auto inputs = in_.tables(root, "", "input"), plots = in_.tables(root, "", "plot");
    check_size(root, "command", plan.command.size());
    check_size(root, "input", inputs.size());
    check_size(root, "plot", plots.size());
    read_parameters(root, plan);
    read_columns(root, plan);
    if (in_.failed()) return plan;  // what follows compares everything with everything
    for (const toml::table* table : inputs) plan.inputs.push_back(input(*table, plan));
    check_columns(root, plan);
    for (const toml::table* table : plots) plan.plots.push_back(plot(*table, plan));
    if (in_.failed()) return plan;
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

  void read_parameters(const toml::table& root, SweepPlan& plan) {
    std::size_t axis = 0;
    const auto groups = in_.tables(root, "", "zip");
    if (const toml::table* vary = in_.table(root, "", "vary"))
      for (const auto& [key, node] : *vary) parameter(*vary, "vary", key.str(), axis++, plan);
    for (const toml::table* group : groups) {
      for (const auto& [key, node] : *group) {
        parameter(*group, "zip", key.str(), axis, plan);
        if (plan.parameters.back().values.size() !=
            std::ranges::find(plan.parameters, axis, &SweepParameter::axis)->values.size())
          invalid(node, "R-SCN-7", sim::TomlReader::join("zip", key.str()),
                  "give the parameters of one [[zip]] equally many values");
      }
      ++axis;
    }
    if (plan.parameters.empty()) invalid(root, "R-SCN-4", "vary", "add a table [vary]");
    if (const toml::table* repeat = in_.table(root, "", "repeat")) {
      plan.repeats = true;
      if (repeat->size() != 1) return invalid(*repeat, "R-SCN-7", "repeat", "give one parameter, such as a seed");
      parameter(*repeat, "repeat", repeat->begin()->first.str(), axis, plan);
    }
    check_size(root, "vary", plan.parameters.size());
  }

  void parameter(const toml::table& table, const char* path, std::string_view key, std::size_t axis, SweepPlan& plan) {
    const toml::node& node = *table.get(key);
    plan.parameters.push_back(
        {std::string(key),
         node.is_table() ? range(*node.as_table(), sim::TomlReader::join(path, key)) : strings(table, path, key), axis});
    if (!is_simple(key)) invalid(node, "R-SCN-6", sim::TomlReader::join(path, key), "use letters, digits, '-', '_' and '.' only");
  }

  /// The number that a text begins with, and what follows it.
  std::pair<double, std::string> end_of_range(const toml::table& table, const std::string& path, const char* key) {
    const std::string text = in_.text(table, path, key);
    double value = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc() || !std::isfinite(value))
      invalid(table, "R-SCN-5", sim::TomlReader::join(path, key), "write a number and its unit: \"0.1mm\"");
    return {value, std::string(read.ptr, text.data() + text.size())};
  }

  /// `count` values from one number to another, equal steps or equal ratios.
  std::vector<std::string> range(const toml::table& table, const std::string& path) {
    in_.allow(table, path, {"from", "to", "count", "scale"});
    const auto [from, unit] = end_of_range(table, path, "from");
    const auto [to, unit_of_to] = end_of_range(table, path, "to");
    const std::uint32_t count = in_.whole(table, path, "count", {2, kMostInRange});
    const bool is_log = in_.word(table, path, "scale", {"linear", "log"}, "linear") == 1;
    if (unit != unit_of_to) invalid(table, "R-SCN-7", path, "give both ends of a range in one unit");
    if (is_log && !(from > 0 && to > 0)) invalid(table, "R-SCN-6", path, "give a logarithmic range ends above 0");
    std::vector<std::string> out;
    for (std::uint32_t i = 0; i < count && !in_.failed(); ++i) {
      const double at = i / (count - 1.0);
      out.push_back(fmt::format("{:.6g}{}", is_log ? from * std::pow(to / from, at) : from + (to - from) * at, unit));
    }
    return out;
  }

  std::vector<SweepMeasure> measures(const toml::table* table, const char* path) {
    std::vector<SweepMeasure> out;
    if (!table) return out;
    check_size(*table, path, table->size());
    for (const auto& [key, node] : *table) {
      out.push_back({std::string(key.str()), in_.text(*table, path, key.str())});
      if (!out.back().place.empty() && !is_json_pointer(out.back().place))
        invalid(*table, "R-SCN-6", sim::TomlReader::join(path, key.str()),
                "write a JSON pointer, such as /traffic/payload/bit_per_s");
    }
    return out;
  }

  void read_columns(const toml::table& root, SweepPlan& plan) {
    plan.measures = measures(required_table(root, "measure"), "measure");
    plan.times = measures(in_.table(root, "", "time"), "time");
    const toml::table* derive = in_.table(root, "", "derive");
    if (!derive) return;
    check_size(*derive, "derive", derive->size());
    for (const auto& [key, node] : *derive) {
      std::string text = in_.text(*derive, "derive", key.str());
      auto formula = Formula::parse(text);
      if (formula) plan.derived.push_back({std::string(key.str()), std::move(text), *std::move(formula)});
      else invalid(node, "R-SCN-5", sim::TomlReader::join("derive", key.str()), "correct the formula: " + formula.error());
    }
  }

  /// Every column has a name of its own, and formulas use those that are measured or varied.
  void check_columns(const toml::table& root, SweepPlan& plan) {
    std::set<std::string, std::less<>> known, timed{kSecondsColumn};
    for (const std::string& column : plan.all_columns())
      if (!known.insert(column).second) invalid(root, "R-SCN-7", column, "give every column a name of its own");
    for (const SweepMeasure& time : plan.times) timed.insert(time.column);
    for (const SweepDerived& derived : plan.derived) known.erase(derived.column);
    for (SweepDerived& derived : plan.derived)
      for (const std::string& name : derived.formula.names()) {
        derived.from_times = derived.from_times || timed.contains(name);
        if (!known.contains(name))
          invalid(root, "R-SCN-7", "derive." + derived.column, "use parameters, measures and times, not " + name);
      }
  }

  SweepInput input(const toml::table& table, const SweepPlan& plan) {
    in_.allow(table, "input", {"name", "file", "command"});
    SweepInput out{name(table, "input", "name"), in_.text(table, "input", "file"), {}};
    if (table.contains("command")) out.command = strings(table, "input", "command");
    Lengths lengths = lengths_of(plan);
    check_places(table, "input.file", {out.file}, lengths);
    lengths["file"] = kLongestPath;
    check_places(table, "input.command", out.command, lengths);
    return out;
  }

  void check_column(const toml::table& table, const char* key, const std::string& value, const SweepPlan& plan) {
    const auto columns = plan.all_columns();
    if (std::find(columns.begin(), columns.end(), value) == columns.end())
      invalid(table, "R-SCN-7", sim::TomlReader::join("plot", key), "name a parameter or a measure of this plan");
    if (plan.repeats && value == plan.parameters.back().name)
      invalid(table, "R-SCN-7", sim::TomlReader::join("plot", key),
              "name another parameter: figures show the spread over this one");
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
    in_.allow(table, "plot",
              {"name", "title", "x", "y", "series", "x_label", "y_label", "series_label", "names", "log", "where"});
    SweepPlot plot;
    plot.name = name(table, "plot", "name");
    plot.title = in_.text(table, "plot", "title", plot.name);
    plot.x = column(table, "x", plan);
    plot.y = texts(table, "y");
    for (const std::string& y : plot.y) check_column(table, "y", y, plan);
    plot.series = column(table, "series", plan);
    plot.x_label = in_.text(table, "plot", "x_label", plot.x);
    plot.series_label = in_.text(table, "plot", "series_label", plot.series);
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
    if (const toml::table* names = in_.table(table, "plot", "names"))
      for (const auto& [key, node] : *names) plot.names[std::string(key.str())] = in_.text(*names, "plot.names", key.str());
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

  /// Every parameter is used, in the command or for its inputs, and the sweep has a sane number of points.
  void check_uses(const toml::table& root, const SweepPlan& plan) {
    std::size_t points = 1;
    check_places(root.contains("command") ? *root.get("command") : root, "command", plan.command, lengths_of(plan));
    for (std::size_t i = 0; i < plan.parameters.size(); ++i) {
      const SweepParameter& parameter = plan.parameters[i];
      if (i == 0 || parameter.axis != plan.parameters[i - 1].axis)
        points = std::min(points * parameter.values.size(), kMostPoints + 1);
      const std::string word = "{" + parameter.name + "}";
      const auto uses = [&](const std::string& w) { return w.find(word) != std::string::npos; };
      const bool is_used = std::ranges::any_of(plan.command, uses) ||
                           std::ranges::any_of(plan.inputs, [&](const SweepInput& input) { return uses(input.file); });
      if (!is_used) {
        const toml::node* node = root["vary"][parameter.name].node();
        invalid(node ? *node : root, "R-SCN-7", (node ? "vary." : "") + parameter.name,
                "use " + word + " in command, or leave the parameter out");
      }
    }
    if (points > kMostPoints) invalid(root, "R-SCN-6", "vary", "stay below 1000000 combinations");
  }

  /// Names in the sweep's folder: its own, those of inputs and of figures. An input's file depends on what its command depends on.
  void check_files(const toml::table& root, const SweepPlan& plan) {
    std::set<std::string> names, files(std::begin(kOwnFiles), std::end(kOwnFiles));
    for (const SweepInput& input : plan.inputs) {
      if (!names.insert(input.name).second || files.contains(input.file))
        invalid(root, "R-SCN-7", "input", "give every input a name and a file of its own, and not points.csv or context.json");
      for (const SweepParameter& parameter : plan.parameters) {
        const std::string word = "{" + parameter.name + "}";
        const auto uses = [&](const std::string& w) { return w.find(word) != std::string::npos; };
        if (std::ranges::any_of(input.command, uses) && !uses(input.file))
          invalid(root, "R-SCN-7", "input.file", "write " + word + " into the name of the file, too");
      }
    }
    if (in_.failed()) return;
    std::map<std::string, const SweepInput*> made;
    const auto add = [&](const std::string& file, const SweepInput& input) {
      if (!is_simple(file)) invalid(root, "R-SCN-6", "input.file", "use letters, digits, '-', '_' and '.' only");
      if (files.contains(file) || made.emplace(file, &input).first->second != &input)
        invalid(root, "R-SCN-7", "input", "give every input a name and a file of its own, and not points.csv or context.json");
    };
    const auto varies = [](const SweepInput& input) { return input.file.find('{') != std::string::npos; };
    for (const SweepInput& input : plan.inputs)
      if (!varies(input)) add(input.file, input);
    const bool any_varies = std::ranges::any_of(plan.inputs, varies);
    for (std::size_t point = 0; any_varies && point < plan.points() && !in_.failed(); ++point)
      for (const auto& [file, input] : plan.files_of(point)) add(file, *input);
    for (const auto& [file, input] : made) files.insert(file);
    for (const SweepPlot& plot : plan.plots)
      if (!files.insert(plot.name + ".svg").second)
        invalid(root, "R-SCN-7", "plot.name", "give every figure a name of its own, which with .svg is no input's file");
  }

  sim::TomlReader in_;
};

}  // namespace

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
