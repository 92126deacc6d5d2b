// SPDX-License-Identifier: Apache-2.0
#include "cli/report/notes.h"

#include <fmt/format.h>

#include <tactus/base/shown.h>

namespace tactus::cli {

std::string text_of(const ReadNote& note) {
  std::string text = note.where.empty() ? note.what : note.where + ": " + note.what;
  if (note.count > 1) text += fmt::format(" ({} times{}{})", note.count, note.first.empty() ? "" : ", the first ", note.first);
  else if (!note.first.empty()) text += " (" + note.first + ")";
  return text;
}

void tell(const std::vector<ReadNote>& notes, const std::string& file, Report& report) {
  for (const ReadNote& note : notes) {
    std::string text = text_of(note);
    fmt::print(stderr, "note: {}: {}\n", shown_path(file), shown(text, 1000));
    report.warnings.push_back(std::move(text));
  }
}

}  // namespace tactus::cli
