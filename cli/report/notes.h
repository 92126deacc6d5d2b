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
/// "topic /cup/pose: 12 samples ...; the first at 3.021 s" for each, as a note on standard error and as a warning of the report.
void tell(const std::vector<ReadNote>& notes, const std::string& file, Report& report);

}  // namespace tactus::cli
