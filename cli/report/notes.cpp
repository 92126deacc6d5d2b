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

std::vector<std::string> texts_of(const std::vector<ReadNote>& notes) {
  std::vector<std::string> texts;
  texts.reserve(notes.size());
  for (const ReadNote& note : notes) texts.push_back(text_of(note));
  return texts;
}

void print_notes(const std::vector<ReadNote>& notes, const std::string& file) {
  for (const ReadNote& note : notes) fmt::print(stderr, "note: {}: {}\n", shown_path(file), shown(text_of(note), 1000));
}

void report_notes(const std::vector<ReadNote>& notes, const std::string& file, Report& report) {
  print_notes(notes, file);
  report.add(notes);
}

}  // namespace tactus::cli
