// SPDX-License-Identifier: Apache-2.0
/// Reports of commands. A report is one value of JSON (Value, json.h), and cli/schemas/NAME.json the one list of its fields. With --json
/// the value is printed, else a table that is laid out as the schema says. Beside what JSON Schema knows, a property may have
///   title               its words in the table; {}: the name of the element that it is in
///   x-unit, x-scale     what a number is printed in, and times what; "none": the words say it; "of the row": x-unit of the object around
///   x-count             for numbers of things, instead of x-unit: its noun, "tick"
///   x-format            of numbers: as in fmt, or "percent", "duration", "significant"
///   x-words             sentences that stand for values
///   x-text              what is printed, with {} for the value; after a space: no comma before it
///   x-omit              a value that is not worth a row
///   x-hidden            only in JSON
///   x-note              a sentence below all tables, if the property is there
///   x-block, x-row, x-column    where it stands, instead of a cell of its own; values in one cell are joined
///   x-as                of objects   "rows": one for each member; "row", "column": one for it as a whole; "cell": all in one cell;
///                                    "joins": a first column, of rows that are there
///                       of arrays    "blocks": one for each element; "columns"; "cell"; of texts "lines", "sentence"; else a table with a row for each
///                       of texts     "heading" of the report; "name" of the element; "sentence" below all tables
/// Objects have a block of their own, with an empty title that around them.
#pragma once

#include <cstdio>

namespace tactus::cli {

struct CommonOptions;
struct Value;

/// Print as the options say: JSON, a table, or nothing when quiet.   in  name  "report": of cli/schemas
void print(const Value& value, const char* name, const CommonOptions& options, std::FILE* out = stdout);

}  // namespace tactus::cli
