// SPDX-License-Identifier: Apache-2.0
#include "cli/report/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include <tactus/base/shown.h>
#include "cli/progress.h"

namespace tactus::cli {

std::size_t display_width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string counted(unsigned long long number, const char* noun) {
  if (number != 1 && std::string_view(noun) == "vertex") return fmt::format("{} vertices", number);
  return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
}

void Table::heading(std::vector<std::string> cells) { add(true, std::move(cells)); }
void Table::row(std::vector<std::string> cells) { add(false, std::move(cells)); }

void Table::add(bool heading, std::vector<std::string> cells) {
  constexpr std::size_t kWidestCell = 1000;
  for (std::string& cell : cells) cell = shown(cell, kWidestCell);
  lines_.push_back({heading, std::move(cells)});
}

void Table::print(std::FILE* out) const {
  std::vector<std::size_t> widths;
  for (const Line& line : lines_) {
    widths.resize(std::max(widths.size(), line.cells.size()));
    for (std::size_t i = 0; i < line.cells.size(); ++i) widths[i] = std::max(widths[i], display_width(line.cells[i]));
  }
  const auto is_text = [&](std::size_t column) {
    return column == 0 || std::any_of(lines_.begin(), lines_.end(), [&](const Line& line) {
             if (line.heading || column >= line.cells.size() || line.cells[column].empty()) return false;
             const char first = line.cells[column].front();
             return first == '/' || std::isalpha(static_cast<unsigned char>(first)) != 0;
           });
  };
  const bool coloured = is_coloured(fileno(out));
  bool first = true;
  for (const Line& line : lines_) {
    if (line.heading && !first) fmt::print(out, "\n");
    first = false;
    std::string text;
    for (std::size_t i = 0; i < line.cells.size(); ++i) {
      const std::string& cell = line.cells[i];
      const std::string pad(widths[i] - display_width(cell), ' ');
      text += (i == 0 ? "" : "  ") + (is_text(i) ? cell + pad : pad + cell);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    const bool bold = line.heading && coloured;
    fmt::print(out, "{}{}{}\n", bold ? "\x1b[1m" : "", text, bold ? "\x1b[0m" : "");
  }
}

}  // namespace tactus::cli
