// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace tactus::cli {

/// Columns of a table: words to the left, figures to the right. For tables too long to be kept: look at all lines, then make them
/// again and print each as aligned() has it.
class Columns {
 public:
  void look(const std::vector<std::string>& cells, bool heading);
  std::string aligned(const std::vector<std::string>& cells) const;  ///< pre  look() has seen these cells

 private:
  struct Column {
    std::size_t width = 0;
    bool is_text = false;
  };
  std::vector<Column> columns_;
};

/// What a table prints of cells that may hold foreign text.
std::vector<std::string> shown_cells(std::vector<std::string> cells);

void print_heading(std::FILE* out, const std::string& text);  ///< emphasised on a terminal

/// Text in columns with widths common to the whole table: words to the left, figures to the right. Cells may hold foreign text, which
/// is printed as shown() has it.
class Table {
 public:
  void heading(std::vector<std::string> cells);  ///< starts a block; emphasised on a terminal
  void row(std::vector<std::string> cells);
  void print(std::FILE* out) const;

 private:
  struct Line {
    bool heading;
    std::vector<std::string> cells;
  };
  void add(bool heading, std::vector<std::string> cells);

  std::vector<Line> lines_;
  Columns columns_;
};

/// Columns that a terminal needs for UTF-8 text without wide or combining characters.
std::size_t display_width(const std::string& text);

/// "1 object", "2 objects"
std::string counted(unsigned long long number, const char* noun);

}  // namespace tactus::cli
