// SPDX-License-Identifier: Apache-2.0
/// Tables of text, and figures as they stand in them.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <tactus/rigid/rigid_state.h>

namespace tactus::cli {

// ==== figures ====
// Figures as reports print them.

inline constexpr std::array<const char*, 4> kReasons{"request", "heartbeat", "visual", "haptic"};  // index: Reason
inline constexpr std::array<const char*, 3> kLayers{"haptic", "visual", "all"};                    // index: Layer

inline constexpr std::uint64_t kUdpHeader = 28;  // [bytes] IPv4 20, UDP 8
inline constexpr std::uint64_t kNumberedDatagram =
    kUdpHeader + 2;  // [bytes] and the packet's number, which the packet does not name

std::string percent(double fraction);  ///< "4.2 %", "0 %"
std::string significant(double value, int digits = 3);
std::string duration(double seconds);  ///< "12.00 us", "3.1 ms", "2.50 s"

inline constexpr std::array<const char*, 6> kDofNames{"x", "y", "z", "rx", "ry", "rz"};
/// Along and about which axes an object can move.
inline std::string dof_text(std::uint8_t dof) {
  if (dof == Dof::none) return "static";
  if (dof == Dof::all) return "all";
  std::string text;
  for (std::size_t i = 0; i < kDofNames.size(); ++i) {
    if (dof >> i & 1u) text += (text.empty() ? "" : " ") + std::string(kDofNames[i]);
  }
  return text;
}

inline double per(double amount, double base) { return base > 0 ? amount / base : 0; }

// ==== table ====

/// Columns of a table: words to the left, figures to the right; none where all cells are empty. For tables too long to be kept: look at all lines, then make them
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
