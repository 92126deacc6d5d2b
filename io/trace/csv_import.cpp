// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <set>

#include <tactus/base/rule.h>
#include <tactus/base/shown.h>
#include <tactus/base/text.h>
#include <tactus/trace/csv.h>
#include <tactus/trace/csv_fields.h>
#include <tactus/trace/csv_plan.h>
#include <tactus/trace/csv_reader.h>
#include <tactus/trace/csv_timeline.h>

namespace tactus {
namespace {

tl::unexpected<Diagnostic> refuse(const Error& error, std::uint64_t line) {
  return tl::unexpected(Diagnostic{.error = error, .line = line});
}

/// A reader at the names of the table.
CsvResult<CsvReader> open_table(const std::string& path, const CsvMapping& mapping) {
  auto reader = CsvReader::open(path, mapping.text);
  if (!reader) return tl::unexpected(Diagnostic{reader.error()});
  if (const auto kind = reader->foreign(); !kind.empty())
    return tl::unexpected(Diagnostic{
        .error = fail(Errc::malformed, "R-CSV-1").value(),
        .detail = "it is " + std::string(kind),
        .remedy =
            "Convert it to a text with commas between fields (Excel: save as CSV; MATLAB: writetable; NumPy: numpy.savetxt), or "
            "take its arrays with tactus.Trace.from_arrays in Python."});
  const auto has_names = reader->names();
  if (!has_names) return refuse(has_names.error(), reader->line() + 1);
  if (!*has_names) return refuse(fail(Errc::truncated, "R-CSV-1").value(), 1);
  return std::move(*reader);
}

/// Of a long table: every name in its column of objects. A trace declares its objects ahead of the first sample.
CsvResult<std::vector<std::string>> objects_of(const std::string& path, const CsvMapping& mapping, std::size_t column) {
  std::vector<std::string> names;
  if (path == "-") return names;
  TACTUS_TRY(CsvReader reader, open_table(path, mapping));
  std::set<std::string> known;
  while (true) {
    const auto more = reader.next();
    if (!more) return refuse(more.error(), reader.line() + 1);
    if (!*more) return names;
    if (column >= reader.fields().size() || !is_plain_name(reader.fields()[column])) continue;
    if (known.insert(reader.fields()[column]).second) names.push_back(reader.fields()[column]);
    if (names.size() > 4096) return names;
  }
}

/// A last line without an end may be cut within its last number.
CsvResult<bool> takes_line(const CsvReader& reader, const CsvMapping& mapping, CsvNamedPlan& plan) {
  const bool ends_unused = reader.fields().size() == plan.names.size() && !plan.used.back();
  if (!reader.is_open() || mapping.keep_last || ends_unused) return true;
  if (mapping.strict)
    return tl::unexpected(Diagnostic{.error = fail(Errc::malformed, "R-CSV-4").value(),
                                     .line = reader.line(),
                                     .detail = "the last line has no end",
                                     .remedy = "It may be cut: end it, remove it, or take it with --keep-last."});
  plan.notes.add("", "the last line has no end: it may be cut and is left out (--keep-last takes it)",
                 "line " + std::to_string(reader.line()));
  return false;
}

/// Columns that the mapping leaves out may say something about those that it takes.
void note_unread(CsvNamedPlan& plan) {
  std::string names;
  std::size_t count = 0;
  for (std::size_t i = 0; i < plan.names.size(); ++i) {
    if (plan.used[i] || plan.names[i].empty()) continue;
    if (++count <= 8) names += (count == 1 ? "" : ", ") + shown(plan.names[i], 40);
  }
  if (count > 0) plan.notes.add("", "columns that are not read: " + names + (count > 8 ? ", ..." : ""));
}

/// A file may hold several tables with blank lines between them, the next one with its own names.
bool ends_here(const CsvReader& reader, CsvNamedPlan& plan) {
  const auto& fields = reader.fields();
  if (!reader.is_after_blank() || fields.size() >= plan.names.size() || fields[0].empty() || is_value(fields[0])) return false;
  plan.notes.add("", "another table follows behind a blank line and is not read",
                 "line " + std::to_string(reader.line()) + ", '" + shown(fields[0], 40) + "'; --skip-lines " +
                     std::to_string(reader.line() - 1) + " reads it alone");
  return true;
}

CsvResult<CsvImport> run(CsvReader& reader, const CsvMapping& mapping, CsvNamedPlan& plan, CsvRows& rows, CsvTimeline& timeline) {
  while (true) {
    const auto more = reader.next();
    if (!more) return refuse(more.error(), reader.line() + 1);
    if (!*more) break;
    if (ends_here(reader, plan)) break;
    TACTUS_TRY(const bool is_whole, takes_line(reader, mapping, plan));
    if (!is_whole) break;
    TACTUS_TRY(auto row, rows.parse(reader));
    if (!row) continue;
    const std::uint64_t line = row->line;
    auto added = timeline.add(std::move(*row));
    if (added) continue;
    if (added.error().line == 0) added.error().line = line;
    return tl::unexpected(added.error());
  }
  const PointedFields& commas = reader.decimal_commas();
  if (commas.count > 0 && commas.open == commas.count)
    return tl::unexpected(
        Diagnostic{.error = fail(Errc::invalid_argument, "R-CSV-10").value(),
                   .line = reader.line(),
                   .detail = "numbers in quotes, such as \"1,000\", may be thousands or decimals",
                   .remedy = "Save the table without separators of thousands, or with semicolons between fields."});
  plan.notes.add("", "a number in quotes has a comma, which is taken for the decimal point", {}, commas.count);
  plan.notes.add("", "a line of names comes again and is left out", "line " + std::to_string(reader.first_repeated()),
                 reader.repeated_names());
  note_unread(plan);
  auto done = timeline.finish();
  if (!done && done.error().line == 0)
    done.error().line = reader.line() + (done.error().error.rule == std::string_view("R-CSV-1") ? 1 : 0);
  return done;
}

CsvResult<CsvImport> import_named(const std::string& path, CsvReader& reader, const CsvMapping& mapping,
                                  const std::string& out_path, const std::string& source, bool& has_output) {
  TACTUS_TRY(CsvNamedPlan plan, plan_named_csv(mapping, reader.header()));
  plan.info.source = source;
  CsvRows rows(mapping, plan);
  CsvTimeline timeline(mapping, plan, rows, out_path);
  if (plan.object) {
    TACTUS_TRY(auto names, objects_of(path, mapping, *plan.object));
    timeline.expect_objects(std::move(names));
  }
  auto done = run(reader, mapping, plan, rows, timeline);
  has_output = timeline.has_output();
  return done;
}

CsvResult<CsvImport> import_table(const std::string& path, const CsvMapping& mapping, const std::string& out_path,
                                  bool& has_output) {
  TACTUS_TRY(CsvReader reader, open_table(path, mapping));
  const std::string source = "import " + (path == "-" ? "standard input" : std::filesystem::path(path).filename().string());
  if (mapping.layout == CsvLayout::named_columns) return import_named(path, reader, mapping, out_path, source, has_output);
  auto plan = plan_csv(reader.header().names);
  if (!plan) {
    plan.error().line = reader.header().line;
    return tl::unexpected(plan.error());
  }
  plan->info.source = source;
  return import_tactus_csv(reader, mapping, *std::move(plan), out_path, has_output);
}

}  // namespace

tl::expected<CsvImport, Diagnostic> import_csv(const std::string& path, const CsvMapping& mapping,
                                               const std::string& out_path) try {
  bool has_output = false;
  auto done = import_table(path, mapping, out_path, has_output);
  std::error_code ignored;  // what is not a plain file was there before us
  if (!done && has_output && std::filesystem::is_regular_file(out_path, ignored)) std::filesystem::remove(out_path, ignored);
  return done;
} catch (const std::bad_alloc&) {
  return tl::unexpected(Diagnostic{out_of_memory().value()});
}

}  // namespace tactus
