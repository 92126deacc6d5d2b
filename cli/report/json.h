// SPDX-License-Identifier: Apache-2.0
/// The values of reports, for the files that make them: JSON's header costs seconds, so that no header includes this one.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/report/printer.h"

namespace tactus::cli {

using Json = nlohmann::ordered_json;

/// A value of JSON. Headers that only pass it on declare it.
struct Value {
  Value(Json made) : json(std::move(made)) {}  // NOLINT(google-explicit-constructor): it is one
  Json json;
};
inline void to_json(Json& out, const Value& value) { out = value.json; }

/// As printed: indented, and text that is no UTF-8 made so.
std::string text_of_json(const Json& json);

/// A schema of cli/schemas.
const Json& schema(const std::string& name);
/// What a schema says of a property, references followed.
Json resolved(const Json& property, const Json& root);
/// A table as a person sees it.
void print_table(const Json& value, const Json& schema, std::FILE* out);
/// The columns of an element of an array, each with its cell.
std::vector<std::pair<std::string, std::string>> cells_of(const Json& element, const Json& schema, const Json& root);

}  // namespace tactus::cli
