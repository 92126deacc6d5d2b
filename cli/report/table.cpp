// SPDX-License-Identifier: Apache-2.0
#include "cli/report/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include <tactus/base/shown.h>
#include "cli/progress.h"

namespace tactus::cli {

std::string percent(double fraction) {
  if (fraction == 0 || fraction == 1) return fmt::format("{:.0f} %", 100 * fraction);
  return fmt::format("{:.{}f} %", 100 * fraction, fraction < 0.0995 || fraction > 0.995 ? 2 : 1);
}

std::string significant(double value, int digits) { return value == 0 ? "0" : fmt::format("{:.{}g}", value, digits); }

std::string duration(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.2f} us", 1e6 * seconds);
  return seconds < 1 ? fmt::format("{:.1f} ms", 1e3 * seconds) : fmt::format("{:.2f} s", seconds);
}

std::size_t display_width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string counted(unsigned long long number, const char* noun) {
  if (number != 1 && std::string_view(noun) == "vertex") return fmt::format("{} vertices", number);
  return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
}

std::vector<std::string> shown_cells(std::vector<std::string> cells) {
  constexpr std::size_t kWidestCell = 1000;
  for (std::string& cell : cells) cell = shown(cell, kWidestCell);
  return cells;
}

void Columns::look(const std::vector<std::string>& cells, bool heading) {
  columns_.resize(std::max(columns_.size(), cells.size()));
  for (std::size_t i = 0; i < cells.size(); ++i) {
    columns_[i].width = std::max(columns_[i].width, display_width(cells[i]));
    if (heading || cells[i].empty()) continue;
    const char first = cells[i].front();
    columns_[i].is_text = columns_[i].is_text || first == '/' || std::isalpha(static_cast<unsigned char>(first)) != 0;
  }
}

std::string Columns::aligned(const std::vector<std::string>& cells) const {
  std::string text;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (columns_[i].width == 0) continue;
    const std::string pad(columns_[i].width - display_width(cells[i]), ' ');
    text += (i == 0 ? "" : "  ") + (i == 0 || columns_[i].is_text ? cells[i] + pad : pad + cells[i]);
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

void Table::heading(std::vector<std::string> cells) { add(true, std::move(cells)); }
void Table::row(std::vector<std::string> cells) { add(false, std::move(cells)); }

void Table::add(bool heading, std::vector<std::string> cells) {
  cells = shown_cells(std::move(cells));
  columns_.look(cells, heading);
  lines_.push_back({heading, std::move(cells)});
}

void Table::print(std::FILE* out) const {
  bool first = true;
  for (const Line& line : lines_) {
    if (line.heading && !first) fmt::print(out, "\n");
    first = false;
    if (line.heading) print_heading(out, columns_.aligned(line.cells));
    else fmt::print(out, "{}\n", columns_.aligned(line.cells));
  }
}

void print_heading(std::FILE* out, const std::string& text) {
  const bool bold = is_coloured(fileno(out));
  fmt::print(out, "{}{}{}\n", bold ? "\x1b[1m" : "", text, bold ? "\x1b[0m" : "");
}

}  // namespace tactus::cli
