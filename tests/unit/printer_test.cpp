// SPDX-License-Identifier: Apache-2.0
#include "cli/report/printer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>

#include "cli/report/json.h"

namespace tactus::cli {
namespace {

constexpr std::array kReports{"report",  "info", "mesh",      "link",    "serve",   "join",  "pcap",
                              "capture", "play", "tolerable", "devices", "version", "error", "sweep"};

/// Alternatives of a report: those of `oneOf`, or the one there is.
std::vector<Json> alternatives(const Json& schema) {
  if (!schema.contains("oneOf")) return {schema};
  return {schema["oneOf"].begin(), schema["oneOf"].end()};
}

/// A value with every property that a schema knows, none equal to another or to what is left out.
Json sample(const Json& schema, int& next) {
  if (schema.contains("const")) return schema["const"];
  if (schema.contains("enum"))
    return schema["enum"].back() == schema.value("x-omit", Json()) ? schema["enum"][0] : schema["enum"].back();
  if (schema.contains("oneOf")) return sample(schema["oneOf"][0], next);
  const std::string type = schema["type"].is_array() ? schema["type"][0] : schema["type"];
  if (type == "boolean") return schema.value("x-omit", Json(false)) == Json(false);
  if (type == "string") return "text" + std::to_string(++next);
  if (type == "integer" || type == "number") return schema.value("maximum", 1) == 0 ? -++next : ++next;
  if (type == "array") {
    Json out = Json::array();
    for (int i = 0; i < std::max(1, schema.value("minItems", 1)); ++i) out.push_back(sample(schema["items"], next));
    return out;
  }
  Json out = Json::object();
  const Json members = schema.value("properties", Json::object());
  for (const auto& [key, part] : members.items()) out[key] = sample(part, next);
  if (const Json other = schema.value("additionalProperties", Json()); other.is_object()) out["more"] = sample(other, next);
  return out;
}

std::string table_of(const Json& value, const Json& schema) {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* const file = open_memstream(&text, &size);
  print_table(value, schema, file);
  std::fclose(file);
  std::string out(text, size);
  std::free(text);
  return out;
}

using Look = std::function<void(const Json& property, Json& around, const std::string& key, const std::string& path)>;

/// Each property of a schema that is seen, with the object of `value` around it.
void for_each_property(const Json& schema, Json& value, const std::string& path, const Look& look) {
  if (schema.value("x-hidden", false)) return;
  if (value.is_array() && !value.empty()) return for_each_property(schema["items"], value[0], path + "/0", look);
  if (!value.is_object()) return;
  const Json members = schema.value("properties", Json::object());
  for (const auto& [key, property] : members.items()) {
    look(property, value, key, path + "/" + key);
    if (value.contains(key)) for_each_property(property, value[key], path + "/" + key, look);
  }
}

bool is_number(const Json& schema) {
  const Json type = schema.value("type", Json());
  if (type == "array" && schema.contains("items")) return is_number(schema["items"]);
  return type == "number" || type == "integer";
}

TEST(Printer, EveryPropertyHasATitleAndEveryNumberAUnit) {
  for (const char* name : kReports)
    for (const Json& one : alternatives(schema(name))) {
      int next = 1;
      Json value = sample(one, next);
      for_each_property(one, value, name, [](const Json& property, Json&, const std::string&, const std::string& path) {
        EXPECT_TRUE(property.contains("title")) << path;
        const bool is_structured = property.value("type", Json()) == "object" || property.value("type", Json()) == "array";
        EXPECT_TRUE(property.value("title", "") != "" || is_structured) << path;
        EXPECT_TRUE(!is_number(property) || property.contains("x-unit") != property.contains("x-count")) << path;
      });
    }
}

/// Without it the table is another: a property of the schema cannot be forgotten by the printer.
TEST(Printer, EveryPropertyThatIsNotHiddenIsPrinted) {
  for (const char* name : kReports)
    for (const Json& one : alternatives(schema(name))) {
      int next = 1, looked = 0;
      const Json whole = sample(one, next);
      const std::string table = table_of(whole, schema(name));
      Json value = whole;
      for_each_property(
          one, value, name, [&](const Json& property, Json& around, const std::string& key, const std::string& path) {
            if (property.value("x-hidden", false)) return;
            const Json kept = around;
            around.erase(key);
            EXPECT_TRUE(key == "kind" || table_of(value, schema(name)) != table) << path;  // kind chooses the alternative
            around = kept;
            ++looked;
          });
      EXPECT_GE(looked, 4) << name;
    }
}

TEST(Printer, ValuesStandInTheirUnits) {
  const Json schema = Json::parse(R"({
    "type": "object", "x-block": "walk",
    "properties": {
      "steps": {"title": "scope", "type": "integer", "x-count": "step"},
      "seconds": {"title": "scope", "type": "number", "x-unit": "s", "x-format": ".1f", "x-text": " in {}"},
      "none": {"title": "none", "type": "integer", "x-count": "step", "x-omit": 0},
      "errors": {"title": "error", "type": "object", "x-as": "rows", "properties": {
        "arc_m": {"title": "arc", "x-unit": "mm", "x-scale": 1e3, "type": "object", "properties": {
          "max": {"title": "max", "type": "number", "x-unit": "of the row"},
          "late_s": {"title": "late", "type": "number", "x-unit": "ms", "x-scale": 1e3}}}}},
      "bounds": {"title": "bound", "type": "object", "x-as": "joins", "x-block": "error", "properties": {
        "arc_m": {"title": "arc", "type": "number", "x-unit": "mm", "x-scale": 1e3},
        "turn_rad": {"title": "turn", "type": "number", "x-unit": "rad"}}},
      "verdict": {"title": "verdict", "type": "string", "x-as": "sentence"}}})");
  const Json value = Json::parse(R"({"steps": 1, "seconds": 2, "none": 0, "errors": {"arc_m": {"max": 0.25, "late_s": 0.004}},
    "bounds": {"arc_m": 0.5, "turn_rad": 1}, "verdict": "Good."})");
  EXPECT_EQ(table_of(value, schema),
            "walk\n"
            "  scope    1 step in 2.0 s\n"
            "\n"
            "error        bound  max  late [ms]\n"
            "  arc [mm]  500 mm  250          4\n"
            "\n"
            "Good.\n");
}

TEST(Printer, ForeignTextCannotTouchTheTerminal) {
  const Json schema =
      Json::parse(R"({"type": "object", "x-block": "list", "properties": {"users": {"title": "users", "type": "array", "items": {
    "type": "object", "properties": {"name": {"title": "user", "type": "string", "x-as": "name"}, "says": {"title": "says", "type": "string"}}}}}})");
  const Json value{{"users", {{{"name", "\x1b[2J"}, {"says", "a\nb"}}}}};
  const std::string table = table_of(value, schema);
  EXPECT_EQ(table.find('\x1b'), std::string::npos) << table;
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 2) << table;
}

}  // namespace
}  // namespace tactus::cli
