// SPDX-License-Identifier: Apache-2.0
/// The values of reports, for the files that make them: JSON's header costs seconds, so that no header includes this one.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

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

/// A schema of cli/schemas, with what it refers to in its place.
const Json& schema(const std::string& name);
/// A table as a person sees it.
void print_table(const Json& value, const Json& schema, std::FILE* out);
/// A value as it stands in a table whose head says its unit.   in  property  what the schema says of it
std::string cell_of(const Json& value, const Json& property);

}  // namespace tactus::cli
