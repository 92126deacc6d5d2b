// SPDX-License-Identifier: Apache-2.0
/// A CSV file (RFC 4180) that grows by one row per finished piece of work. A row is on the disk before add() returns: a killed program
/// loses none, and a row that was cut off is dropped when the table is taken up again.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cli/output.h"

namespace tactus::cli {

class GrowingTable {
 public:
  using Row = std::vector<std::string>;

  /// Make the table, or take up the one that an earlier run left.
  /// err  it has other columns, or a row with more or fewer cells; it cannot be read or written, or is a link
  static tl::expected<GrowingTable, Failure> open(std::string path, Row columns);

  const std::vector<Row>& rows() const { return rows_; }
  /// err  as open().   pre  as many cells as columns
  Outcome add(Row row);
  /// Put these in place of all rows.
  Outcome replace(std::vector<Row> rows);
  /// What to say of a row that was read and makes no sense.
  tl::unexpected<Failure> refuse_row(std::size_t row) const;

 private:
  GrowingTable(std::string path, Row columns) : path_(std::move(path)), columns_(std::move(columns)) {}

  std::string path_;
  Row columns_;
  std::vector<Row> rows_;
};

}  // namespace tactus::cli
