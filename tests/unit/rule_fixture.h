// SPDX-License-Identifier: Apache-2.0
/// spec/rules.csv as it is, for tests that hold the library against it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <fstream>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/result.h>

namespace tactus::testing {

struct RuleRow {
  std::string rule, classes, chapter, text, fault, remedy, action;
};

/// Fields are plain, or in quotation marks with none inside.
inline std::vector<RuleRow> rule_rows() {
  std::vector<RuleRow> rows;
  std::ifstream table(TACTUS_RULES_CSV);
  std::string line;
  std::getline(table, line);  // of names
  while (std::getline(table, line)) {
    RuleRow row;
    std::size_t at = 0;
    for (std::string* field : {&row.rule, &row.classes, &row.chapter, &row.text, &row.fault, &row.remedy, &row.action}) {
      const bool quoted = at < line.size() && line[at] == '"';
      const std::size_t begin = at + (quoted ? 1 : 0), end = std::min(line.find(quoted ? '"' : ',', begin), line.size());
      *field = line.substr(begin, end - begin);
      at = end + (quoted ? 2 : 1);
    }
    rows.push_back(row);
  }
  return rows;
}

inline std::string count(std::uint64_t n) {
  return n >= 1u << 20 && std::has_single_bit(n) ? "2^" + std::to_string(std::bit_width(n) - 1) : std::to_string(n);
}
inline std::string mib(std::uint64_t bytes) { return std::to_string(bytes >> 20) + " MiB"; }

/// What must hold names the limits of the library, and so does what is wrong unless it has no number at all.
inline void expect_limits(std::string_view rule, std::initializer_list<std::string> limits) {
  for (const RuleRow& row : rule_rows()) {
    if (row.rule != rule) continue;
    const bool has_number = row.fault.find_first_of("0123456789") != std::string::npos;
    for (const std::string& limit : limits) {
      EXPECT_NE(row.text.find(limit), std::string::npos) << rule << " says otherwise than " << limit << ": " << row.text;
      if (has_number) {
        EXPECT_NE(row.fault.find(limit), std::string::npos) << rule << " says otherwise than " << limit << ": " << row.fault;
      }
    }
    return;
  }
  ADD_FAILURE() << rule << " is not in the table";
}

}  // namespace tactus::testing
