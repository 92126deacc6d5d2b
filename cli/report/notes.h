// SPDX-License-Identifier: Apache-2.0
/// Notes of a reader, for people.
#pragma once

#include <string>
#include <vector>

#include <tactus/trace/read_notes.h>
#include "cli/report/report.h"

namespace tactus::cli {

/// "/cup/pose: 12 samples missing (the first at 3.021 s)"
std::string text_of(const ReadNote& note);
/// The same for each.
std::vector<std::string> texts_of(const std::vector<ReadNote>& notes);
/// "note: FILE: /cup/pose: 12 samples ..." on standard error: there people see them, once. A report has them in its JSON alone.
void print_notes(const std::vector<ReadNote>& notes, const std::string& file);
/// Both.
void report_notes(const std::vector<ReadNote>& notes, const std::string& file, Report& report);

}  // namespace tactus::cli
