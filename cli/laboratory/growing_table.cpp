// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/growing_table.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <optional>

#include <tactus/base/shown.h>
#include <tactus/trace/csv_reader.h>

namespace tactus::cli {
namespace {

std::string line_of(const GrowingTable::Row& cells) {
  std::string out;
  for (const std::string& cell : cells) out += csv_field(cell) + ',';
  out.back() = '\n';
  return out;
}

/// Cells of one line, `at` moves behind it; nothing when the line has no end.
std::optional<GrowingTable::Row> read_line(const std::string& text, std::size_t& at) {
  GrowingTable::Row cells(1);
  bool in_quotes = false;
  for (std::size_t i = at; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && in_quotes && i + 1 < text.size() && text[i + 1] == '"') cells.back() += text[++i];
    else if (c == '"') in_quotes = !in_quotes;
    else if (c == ',' && !in_quotes) cells.emplace_back();
    else if (c == '\n' && !in_quotes) {
      at = i + 1;
      return cells;
    } else cells.back() += c;
  }
  return std::nullopt;
}

/// No link is followed, so that no other file is written to.
Descriptor open_table(const std::string& path, int how) {
  return Descriptor(::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | how, 0644));
}

tl::unexpected<Failure> refuse_write(const std::string& path, int why) {
  auto refused = refuse_io(path, "cannot be written", why);
  if (why == ELOOP) refused.value().remedy = "It is a link: remove it, or give another folder with -o.";
  return refused;
}

/// Write or append, and wait until the disk has it.
Outcome store(const std::string& path, const std::string& text, int how) {
  const Descriptor file = open_table(path, how);
  bool stored = file.is_open();
  for (std::size_t at = 0; stored && at < text.size();) {
    const ssize_t wrote = ::write(file.number(), text.data() + at, text.size() - at);
    stored = wrote > 0;
    at += stored ? static_cast<std::size_t>(wrote) : 0;
  }
  stored = stored && fsync(file.number()) == 0;
  return stored ? Outcome() : refuse_write(path, errno);
}

}  // namespace

tl::expected<GrowingTable, Failure> GrowingTable::open(std::string path, Row columns) {
  GrowingTable out(std::move(path), std::move(columns));
  std::error_code failed;
  std::string text;
  if (std::filesystem::exists(out.path_, failed)) {
    auto found = read_regular_file(out.path_);
    if (!found) return tl::unexpected(found.error());
    text = *std::move(found);
  }
  std::size_t at = 0;
  const auto first = read_line(text, at);
  if (!first) {
    if (auto stored = store(out.path_, line_of(out.columns_), O_TRUNC); !stored) return tl::unexpected(stored.error());
    return out;
  }
  if (*first != out.columns_)
    return refuse(shown_path(out.path_) + ": its columns differ from those of this table", "Give another folder with -o.");
  while (auto cells = read_line(text, at)) {
    out.rows_.push_back(*std::move(cells));
    if (out.rows_.back().size() != out.columns_.size()) return out.refuse_row(out.rows_.size() - 1);
  }
  if (at == text.size()) return out;
  if (text.find('\n', at) != std::string::npos)
    return out.refuse_row(out.rows_.size());  // it holds others: its quotes are damaged
  const Descriptor table = open_table(out.path_, 0);
  const bool cut = table.is_open() && ftruncate(table.number(), static_cast<off_t>(at)) == 0;  // a row that was cut off
  if (!cut) return refuse_write(out.path_, errno);
  return out;
}

tl::unexpected<Failure> GrowingTable::refuse_row(std::size_t row) const {
  return refuse(fmt::format("{}, row {}: not a row of this table", shown_path(path_), row + 1),
                "Remove it, or give another folder with -o.");
}

Outcome GrowingTable::add(Row row) {
  if (auto stored = store(path_, line_of(row), O_APPEND); !stored) return stored;
  rows_.push_back(std::move(row));
  return {};
}

Outcome GrowingTable::replace(std::vector<Row> rows) {
  std::string text = line_of(columns_);
  for (const Row& row : rows) text += line_of(row);
  if (auto written = write_file(path_, text, OutputFile::Existing::replace); !written) return written;
  rows_ = std::move(rows);
  return {};
}

}  // namespace tactus::cli
