// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace tactus::cli {

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
};

/// Columns that a terminal needs for UTF-8 text without wide or combining characters.
std::size_t display_width(const std::string& text);

/// "1 object", "2 objects"
std::string counted(unsigned long long number, const char* noun);

}  // namespace tactus::cli
