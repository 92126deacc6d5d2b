// SPDX-License-Identifier: Apache-2.0
#include "cli/report/printer.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include <tactus/base/shown.h>
#include "cli/options/options_codec.h"
#include "cli/report/json.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

constexpr std::pair<const char*, const char*> kSchemas[]{
#include "schemas.inc"
};

constexpr std::size_t kLongest = 1000;  // foreign text

/// "{}" becomes `name`.
std::string filled(std::string text, const std::string& name) {
  if (const auto at = text.find("{}"); at != std::string::npos) text.replace(at, 2, name);
  return text;
}

const std::string& text_at(const Json& schema, const char* key) {
  static const std::string none;
  const auto found = schema.find(key);
  return found == schema.end() ? none : found->get_ref<const std::string&>();
}

/// The unit after a number, " mm", or nothing.
std::string unit_of(const Json& schema) {
  const std::string &unit = text_at(schema, "x-unit"), &format = text_at(schema, "x-format");
  const bool has_own_unit = unit == "none" || unit == "of the row" || format == "percent" || format == "duration";
  return has_own_unit ? "" : unit;
}

std::string labelled(const std::string& title, const Json& schema) {
  const std::string unit = unit_of(schema);
  return unit.empty() ? title : fmt::format("{} [{}]", title, unit);
}

std::string number_text(const Json& value, const Json& schema) {
  const std::string& format = text_at(schema, "x-format");
  const double scale = schema.value("x-scale", 1.0);
  if (format.empty() && scale == 1 && value.is_number_unsigned()) return std::to_string(value.get<std::uint64_t>());
  if (format.empty() && scale == 1 && value.is_number_integer()) return std::to_string(value.get<std::int64_t>());
  const double scaled = scale * value.get<double>();
  if (format == "percent") return percent(scaled);
  if (format == "duration") return duration(scaled);
  if (format == "significant") return significant(scaled);
  return fmt::format(fmt::runtime("{:" + (format.empty() ? ".6g" : format) + "}"), scaled);
}

enum class With { nothing, unit };  // after a number: its unit or noun

std::string text_of(const Json& value, const Json& schema, With with);

/// Elements of arrays, members of objects.
std::string joined(const Json& value, const Json& schema, With with) {
  std::string text;
  const auto add = [&](const char* between, const Json& part, const Json& of_part, With with_part) {
    if (of_part.value("x-hidden", false) || (of_part.contains("x-omit") && of_part["x-omit"] == part)) return;
    const std::string more = text_of(part, of_part, with_part);
    text += (text.empty() || more.starts_with(' ') ? "" : between) + more;
  };
  if (value.is_object())
    for (const auto& [key, property] : schema["properties"].items())
      if (value.contains(key)) add(with == With::unit ? ", " : ":", value[key], property, with);
  if (value.is_array())
    for (const Json& part : value)  // the unit of numbers is that of the array
      add(part.is_string()  ? ", "
          : part.is_array() ? "; "
                            : " ",
          part, part.is_number() ? schema : schema["items"], With::nothing);
  return text;
}

std::string text_of(const Json& value, const Json& schema, With with) {
  std::string text;
  if (value.is_null()) text = "-";
  else if (value.is_boolean()) text = value.get<bool>() ? "yes" : "no";
  else if (value.is_string()) text = value.get<std::string>();
  else if (value.is_number()) text = number_text(value, schema);
  else text = joined(value, schema, text_at(schema, "x-as") == "cell" ? With::unit : with);
  if (const auto words = schema.find("x-words"); words != schema.end())
    if (const auto word = words->find(!value.is_boolean() ? text : value.get<bool>() ? "true" : "false"); word != words->end())
      return *word;
  if (with == With::unit && value.is_number() && schema.contains("x-count"))
    text = counted(value.get<std::uint64_t>(), text_at(schema, "x-count").c_str());
  else if (with == With::unit && !value.is_null() && !unit_of(schema).empty()) text += " " + unit_of(schema);
  return schema.contains("x-text") ? filled(schema["x-text"], text) : text;
}

/// A table: cells by row and column. Without columns, words and values.
struct Block {
  struct Row {
    std::string label;
    std::map<std::string, std::string> cells{};  // by column
  };
  explicit Block(const std::string& name) : key(name), title(name) {}
  std::string key, title;
  std::vector<std::string> columns{};
  std::vector<Row> rows{};

  bool is_list() const { return columns.size() == 1 && columns[0].empty(); }
  bool has_row(const std::string& sought) const { return indices_.contains(sought); }
  void add(const std::string& row, const std::string& label, const std::string& column, const std::string& text) {
    if (std::ranges::find(columns, column) == columns.end()) columns.push_back(column);
    const auto [at, is_new] = indices_.try_emplace(row, rows.size());
    if (is_new) rows.push_back({label});
    std::string& cell = rows[at->second].cells[column];
    cell += (cell.empty() || text.starts_with(' ') ? "" : ", ") + text;
  }
  /// To a row that is there, in a column before the others.
  void join(const std::string& row, const std::string& column, const std::string& text) {
    if (std::ranges::find(columns, column) == columns.end()) columns.insert(columns.begin(), column);
    add(row, row, column, text);
  }

 private:
  std::map<std::string, std::size_t> indices_{};  // of rows
};

/// Where what is walked over stands.
struct Context {
  std::string block, name{};  // name: of the element around
  std::optional<std::string> row{}, column{};
  std::string row_label{}, prefix{};  // prefix: of columns
  bool joins = false;                 // rows that are there, with its column before theirs
  const Json* row_schema = nullptr;
};

class Layout {
 public:
  Layout(const Json& value, const Json& schema) { object(value, schema, {.block = text_at(schema, "x-block")}); }
  void object(const Json& value, const Json& schema, const Context& context);
  void print(std::FILE* out) const;

 private:
  void member(const Json& value, const Json& schema, const Context& context);
  void texts(const Json& value, const Json& schema, Block& to, const std::string& title);
  void rows(const Json& value, const Json& schema, const Context& context);
  void elements(const Json& value, const Json& schema, const Context& context);
  void leaf(const Json& value, const Json& schema, const Context& context, const std::string& title);
  Block& block(const std::string& title) {
    const auto found = std::ranges::find(blocks_, title, &Block::key);
    return found == blocks_.end() ? blocks_.emplace_back(title) : *found;
  }
  /// Calls look(member, its schema) in the order of the schema.
  template <class Look>
  void for_each_member(const Json& value, const Json& schema, Look look) {
    static const Json none = Json::object();
    const Json& known = schema.contains("properties") ? schema["properties"] : none;
    for (const auto& [key, property] : known.items())
      if (value.contains(key)) look(value[key], property);
    for (const auto& [key, part] : value.items()) {
      if (known.contains(key) || !schema.contains("additionalProperties") || !schema["additionalProperties"].is_object())
        continue;
      Json property = schema["additionalProperties"];
      property["title"] = key;
      look(part, property);
    }
  }

  std::vector<Block> blocks_;
  std::vector<std::string> sentences_, notes_;
};

/// Of several possible, the schema whose constants are those of the value.
const Json& chosen(const Json& value, const Json& schema) {
  if (!schema.contains("oneOf")) return schema;
  for (const Json& one : schema["oneOf"]) {
    const auto differs = [&](const auto& item) {
      return item.value().contains("const") && item.value()["const"] != value.value(item.key(), Json());
    };
    const auto members = one["properties"].items();
    if (std::none_of(members.begin(), members.end(), differs)) return one;
  }
  return schema;
}

void Layout::object(const Json& value, const Json& schema, const Context& context) {
  for_each_member(value, chosen(value, schema), [&](const Json& part, const Json& property) { member(part, property, context); });
}

void Layout::member(const Json& value, const Json& schema, const Context& context) {
  const std::string& as = text_at(schema, "x-as");
  const std::string title = filled(text_at(schema, "title"), context.name);
  if (schema.value("x-hidden", false) || as == "name" || (schema.contains("x-omit") && schema["x-omit"] == value)) return;
  if (const std::string note = text_at(schema, "x-note"); !note.empty() && std::ranges::find(notes_, note) == notes_.end())
    notes_.push_back(note);
  if (as == "heading" || as == "sentence" || as == "lines") return texts(value, schema, block(context.block), title);
  Context inner = context;
  if (schema.contains("x-block")) inner.block = filled(schema["x-block"], context.name);
  const bool is_cell = as == "cell" || !value.is_structured();
  if (is_cell || (value.is_array() && !schema["items"].contains("properties"))) return leaf(value, schema, inner, title);
  const bool has_block = !title.empty() && !schema.contains("x-block") && as != "row" && as != "column" && as != "joins" &&
                         as != "columns" && !context.row;
  if (has_block && value.is_object()) inner.block = title;
  if (as == "row") {
    inner.row = title;
    inner.row_label = labelled(title, schema);
    inner.row_schema = &schema;
  } else if (as == "column" || as == "joins") {
    inner.column = title;
    inner.joins = as == "joins";
  } else if (context.row && value.is_object() && !title.empty()) {
    inner.prefix += title + " ";
  }
  if (value.is_array()) elements(value, schema, inner);
  else if (as == "rows") rows(value, schema, inner);
  else object(value, schema, inner);
}

void Layout::texts(const Json& value, const Json& schema, Block& to, const std::string& title) {
  const std::string as = schema["x-as"];
  if (as == "heading") to.title = text_of(value, schema, With::unit);
  if (as == "sentence")
    for (const Json& text : value.is_array() ? value : Json::array({value})) sentences_.push_back(text);
  if (as == "lines")
    for (std::size_t i = 0; i < value.size(); ++i) to.add(title + std::to_string(i), title, "", value[i]);
}

void Layout::rows(const Json& value, const Json& schema, const Context& context) {
  for_each_member(value, schema, [&](const Json& part, Json property) {
    if (!part.is_structured()) return member(part, property, context);
    property["x-as"] = "row";
    member(part, property, context);
  });
}

void Layout::elements(const Json& value, const Json& schema, const Context& context) {
  const Json& items = schema["items"];
  const std::string &as = text_at(schema, "x-as"), &title = text_at(schema, "title");
  std::size_t number = 0;
  for (const Json& element : value) {
    std::string name;
    for_each_member(element, items, [&](const Json& part, const Json& property) {
      if (text_at(property, "x-as") == "name") name += (name.empty() ? "" : ", ") + text_of(part, property, With::unit);
    });
    Context at = context;
    if (as == "columns") {
      at.column = name;
    } else if (as == "blocks") {
      at.name = context.name.empty() ? name : name + " at " + context.name;
      at.block = filled(title, at.name);
    } else {
      if (!title.empty() && !schema.contains("x-block")) at.block = filled(title, context.name);
      at.row = fmt::format("{}/{}", context.row.value_or(""), number++);
      at.row_label = name;
      at.row_schema = &schema;
    }
    object(element, items, at);
  }
}

/// As a cell, with the unit that its row has.
std::string plain_text(const Json& value, const Json& schema, const Json* row) {
  if (!row || !row->contains("x-scale") || text_at(schema, "x-unit") != "of the row")
    return text_of(value, schema, With::nothing);
  Json of_row = schema;
  of_row["x-scale"] = (*row)["x-scale"];
  return text_of(value, of_row, With::nothing);
}

void Layout::leaf(const Json& value, const Json& schema, const Context& context, const std::string& title) {
  if (context.joins) {
    const auto found = std::ranges::find(blocks_, context.block, &Block::key);
    if (found != blocks_.end() && found->has_row(title)) found->join(title, *context.column, text_of(value, schema, With::unit));
    return;
  }
  const std::string &own = text_at(schema, "x-row"), &column = text_at(schema, "x-column");
  const std::string row = own.empty() ? title : filled(own, context.name);
  const auto plain = [&] { return plain_text(value, schema, context.row_schema); };
  Block& to = block(context.block);
  if (context.row && context.column) return to.add(*context.row, context.row_label, *context.column, plain());
  if (context.row && schema.contains("x-column"))
    return to.add(*context.row, context.row_label, column, column.empty() ? text_of(value, schema, With::unit) : plain());
  if (context.row) return to.add(*context.row, context.row_label, context.prefix + labelled(title, schema), plain());
  if (context.column) return to.add(row, labelled(row, schema), *context.column, plain());
  const bool is_count = !column.empty() && schema.contains("x-count");
  to.add(row, row, column, is_count ? plain() : text_of(value, schema, With::unit));
}

/// Long texts go on below, between words.
std::vector<std::string> lines_of(std::string text) {
  constexpr std::size_t kMost = 120;
  std::vector<std::string> lines;
  while (text.size() > kMost) {
    const std::size_t end = text.rfind(' ', kMost);
    if (end == std::string::npos || end == 0) break;
    lines.push_back(text.substr(0, end));
    text.erase(0, end + 1);
  }
  lines.push_back(std::move(text));
  return lines;
}

void print_list(const Block& block, std::FILE* out) {
  constexpr std::size_t kLeastLabel = 8;
  std::size_t width = kLeastLabel;
  for (const Block::Row& row : block.rows) width = std::max(width, 1 + display_width(shown(row.label)));
  for (const Block::Row& row : block.rows) {
    std::string label = shown(row.label);
    for (const std::string& line : lines_of(shown(row.cells.begin()->second, kLongest))) {
      fmt::print(out, "  {}{} {}\n", label, std::string(width - display_width(label), ' '), line);
      label.clear();
    }
  }
}

void print_grid(const Block& block, std::size_t width, std::FILE* out) {
  std::vector<std::string> columns, heading{block.title};
  for (const std::string& column : block.columns)
    if (!column.empty()) columns.push_back(column);
  heading[0].resize(heading[0].size() + std::max(width, display_width(heading[0])) - display_width(heading[0]), ' ');
  heading.insert(heading.end(), columns.begin(), columns.end());
  Table table;
  table.heading(heading);
  for (const Block::Row& row : block.rows) {
    std::vector<std::string> cells{"  " + row.label};
    for (const std::string& column : columns) {
      const auto found = row.cells.find(column);
      cells.push_back(found == row.cells.end() ? "" : found->second);
    }
    if (const auto found = row.cells.find(""); found != row.cells.end() && cells[1].empty()) cells[1] = found->second;
    table.row(std::move(cells));
  }
  table.print(out);
}

void Layout::print(std::FILE* out) const {
  std::size_t width = 0;
  for (const Block& block : blocks_)
    for (const Block::Row& row : block.rows)
      if (!block.is_list()) width = std::max(width, 2 + display_width(row.label));
  bool first = true;
  for (const Block& block : blocks_) {
    if (!std::exchange(first, false)) fmt::print(out, "\n");
    if (!block.is_list()) {
      print_grid(block, width, out);
      continue;
    }
    print_heading(out, shown(block.title));
    print_list(block, out);
  }
  for (const auto* sentences : {&sentences_, &notes_})
    for (const std::string& sentence : *sentences)
      fmt::print(out, "\n{}\n", fmt::join(lines_of(shown(sentence, kLongest)), "\n"));
}

/// With what is referred to in its place, and what stands beside a reference before that.   in  root  where "#" is
Json resolved(const Json& node, const Json& root) {
  if (!node.is_structured()) return node;
  const auto ref = node.find("$ref");
  Json out = node.is_array() ? Json::array() : Json::object();
  if (ref != node.end()) {
    const std::string path = *ref;
    const Json& from = path.starts_with('#') ? root : schema("parts");
    out = resolved(from["$defs"][path.substr(path.rfind('/') + 1)], root);
  }
  for (const auto& [key, value] : node.items()) {
    if (node.is_array()) out.push_back(resolved(value, root));
    else if (key != "$ref") out[key] = resolved(value, root);
  }
  return out;
}

}  // namespace

const Json& schema(const std::string& name) {
  static std::map<std::string, Json> read;
  const auto [entry, is_new] = read.try_emplace(name);
  if (is_new) {
    entry->second =
        Json::parse(std::ranges::find(kSchemas, std::string_view(name), &std::pair<const char*, const char*>::first)->second);
    entry->second = resolved(entry->second, entry->second);
  }
  return entry->second;
}

void print_table(const Json& value, const Json& schema, std::FILE* out) { Layout(value, schema).print(out); }

std::string cell_of(const Json& value, const Json& property) { return text_of(value, property, With::nothing); }

std::string text_of_json(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace); }

void print(const Value& value, const char* name, const CommonOptions& options, std::FILE* out) {
  if (options.json) fmt::print(out, "{}\n", text_of_json(value.json));
  else if (!options.quiet) print_table(value.json, schema(name), out);
}

}  // namespace tactus::cli
