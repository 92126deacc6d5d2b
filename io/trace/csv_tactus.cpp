// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/trace/csv.h>
#include <tactus/trace/csv_plan.h>
#include <tactus/trace/csv_reader.h>
#include <tactus/trace/messages.h>

namespace tactus {
namespace {

constexpr std::size_t kRowsForRate = 256;  // looked at before the tick rate is settled

struct Row {
  std::uint64_t line = 0;
  double time = 0;
  TraceFrame frame;  // its tick is set for layout `tactus`
};

class Importer {
 public:
  Importer(const CsvMapping& mapping, CsvPlan plan, std::string out_path)
      : mapping_(mapping), plan_(std::move(plan)), out_path_(std::move(out_path)) {}

  Result<CsvImport> run(CsvReader& reader);
  Diagnostic located(const Error& error) const {
    return {.error = error, .line = line_, .detail = location_of_field(column_, text_)};
  }
  bool has_output() const noexcept { return writer_.has_value(); }

 private:
  Result<Row> parse(const CsvReader& reader);
  template <class T>
  Result<T> number(const std::vector<std::string>& fields, std::size_t column);
  Result<void> parse_reports(const std::vector<std::string>& fields, std::size_t column, DeviceReports& reports);
  Result<void> parse_servo(const std::vector<std::string>& fields, const std::array<std::size_t, 4>& columns, ServoSample& servo);
  Result<void> parse_others(const std::vector<std::string>& fields, Row& row);
  Result<void> start();
  std::uint32_t find_rate() const;
  Result<void> write(Row& row);
  Result<std::int64_t> tick_of(const Row& row) const;

  const CsvMapping& mapping_;
  CsvPlan plan_;
  std::string out_path_;
  std::uint64_t line_ = 1;
  std::string column_, text_;  // of the field that is being read
  std::vector<Row> waiting_;   // until the tick rate is known
  std::optional<TraceWriter> writer_;
  Row last_;  // written before
  CsvImport done_;
};

Result<CsvImport> Importer::run(CsvReader& reader) {
  while (true) {
    line_ = reader.line() + 1;
    TACTUS_TRY(const bool more, reader.next());
    if (!more) break;
    line_ = reader.line();
    if (reader.is_open() && !mapping_.keep_last) {
      done_.notes.add("", "the last line has no end: it may be cut and is left out (--keep-last takes it)",
                      "line " + std::to_string(line_));
      break;
    }
    TACTUS_TRY(Row row, parse(reader));
    if (writer_) {
      TACTUS_CHECK(write(row));
      continue;
    }
    waiting_.push_back(std::move(row));
    if (waiting_.size() == kRowsForRate) TACTUS_CHECK(start());
  }
  if (!writer_ && waiting_.empty()) return fail(Errc::truncated, "R-CSV-1");
  if (!writer_) TACTUS_CHECK(start());
  TACTUS_CHECK(writer_->finish());
  return done_;
}

template <class T>
Result<T> Importer::number(const std::vector<std::string>& fields, std::size_t column) {
  column_ = plan_.names[column];
  text_ = fields[column];
  const auto value = parse_number<T>(text_);
  if (!value || !std::isfinite(static_cast<double>(*value))) return fail(Errc::malformed, "R-CSV-4");
  return *value;
}

Result<Row> Importer::parse(const CsvReader& reader) {
  const auto& fields = reader.fields();
  column_.clear();
  text_.clear();
  if (fields.size() != plan_.names.size()) return fail(Errc::malformed, "R-CSV-3");
  Row row;
  row.line = reader.line();
  row.frame.objects.resize(plan_.info.objects.size());
  row.frame.users.resize(plan_.info.users.size());
  for (const CsvBinding& binding : plan_.bindings) {
    TACTUS_TRY(const double value, number<double>(fields, binding.column));
    double& field = binding.object_field != nullptr ? binding.object_field(row.frame.objects[binding.index])
                                                    : binding.user_field(row.frame.users[binding.index]);
    field = value;
  }
  for (UserSample& user : row.frame.users) user.contact.device = user.device.position;
  TACTUS_CHECK(parse_others(fields, row));
  if (plan_.time) {
    TACTUS_TRY(row.time, number<double>(fields, *plan_.time));
  }
  column_.clear();
  text_.clear();
  return row;
}

Result<void> Importer::parse_servo(const std::vector<std::string>& fields, const std::array<std::size_t, 4>& columns,
                                   ServoSample& servo) {
  TACTUS_TRY(servo.lateness, number<std::int64_t>(fields, columns[0]));
  TACTUS_TRY(servo.age, number<std::int64_t>(fields, columns[1]));
  TACTUS_TRY(servo.missed, number<std::uint32_t>(fields, columns[2]));
  TACTUS_TRY(servo.guard, number<std::uint32_t>(fields, columns[3]));
  return servo.lateness >= 0 && servo.age >= 0 ? Result<void>() : fail(Errc::malformed, "R-CSV-4");
}

Result<void> Importer::parse_reports(const std::vector<std::string>& fields, std::size_t column, DeviceReports& reports) {
  column_ = plan_.names[column];
  text_ = fields[column];
  for (std::string_view left = text_; !left.empty();) {
    const std::size_t end = std::min(left.find(' '), left.size());
    const auto bytes = bytes_of_hex(left.substr(0, end));
    if (!bytes || bytes->empty()) return fail(Errc::malformed, "R-CSV-4");
    reports.sizes.push_back(static_cast<std::uint32_t>(bytes->size()));
    reports.bytes.insert(reports.bytes.end(), bytes->begin(), bytes->end());
    left.remove_prefix(std::min(end + 1, left.size()));
  }
  return {};
}

Result<void> Importer::parse_others(const std::vector<std::string>& fields, Row& row) {
  if (plan_.tick) {
    TACTUS_TRY(row.frame.tick, number<std::int64_t>(fields, *plan_.tick));
  }
  if (plan_.shown) {
    TACTUS_TRY(row.frame.shown, number<std::int64_t>(fields, *plan_.shown));
  }
  for (std::size_t i = 0; i < plan_.dof.size(); ++i) {
    TACTUS_TRY(const auto dof, number<std::uint8_t>(fields, plan_.dof[i]));
    const bool is_first = !writer_ && waiting_.empty();
    if (is_first) plan_.info.objects[i].dof = dof;
    if (dof > Dof::all || dof != plan_.info.objects[i].dof) return fail(Errc::malformed, "R-CSV-4");
  }
  for (std::size_t i = 0; i < plan_.users.size(); ++i) {
    const CsvUserColumns& columns = plan_.users[i];
    UserSample& user = row.frame.users[i];
    TACTUS_TRY(const auto kind, number<std::uint8_t>(fields, columns.kind));
    if (kind > static_cast<std::uint8_t>(ContactKind::spring)) return fail(Errc::malformed, "R-CSV-4");
    user.contact.kind = static_cast<ContactKind>(kind);
    TACTUS_TRY(user.contact.object, number<std::uint32_t>(fields, columns.object));
    if (kind > 0 && user.contact.object >= plan_.info.objects.size()) return fail(Errc::malformed, "R-CSV-4");
    if (columns.buttons) {
      TACTUS_TRY(user.device.buttons, number<std::uint32_t>(fields, *columns.buttons));
    }
    if (columns.time) {
      TACTUS_TRY(user.device.time, number<std::int64_t>(fields, *columns.time));
      if (user.device.time < 0 || user.device.time / 1'000'000'000 >= kMaxSeconds) return fail(Errc::malformed, "R-CSV-4");
    }
    if (columns.servo) TACTUS_CHECK(parse_servo(fields, *columns.servo, user.servo));
    if (columns.reports) TACTUS_CHECK(parse_reports(fields, *columns.reports, user.reports));
  }
  return {};
}

/// Ticks per second, 0 when nothing states it.
std::uint32_t Importer::find_rate() const {
  if (mapping_.tick_rate > 0) return mapping_.tick_rate;
  const Row& row = waiting_.back();
  if (row.frame.tick == 0) return TraceInfo().tick_rate;
  const double rate = std::round(static_cast<double>(row.frame.tick) / row.time);
  return rate >= 1 && rate <= kMaxTickRate ? static_cast<std::uint32_t>(rate) : 0;
}

Result<void> Importer::start() {
  line_ = 1;
  plan_.info.tick_rate = find_rate();
  if (plan_.info.tick_rate == 0) return fail(Errc::invalid_argument, "R-CSV-7");
  TACTUS_TRY(writer_, TraceWriter::create(out_path_, plan_.info));
  for (Row& row : waiting_) TACTUS_CHECK(write(row));
  waiting_.clear();
  return {};
}

Result<std::int64_t> Importer::tick_of(const Row& row) const {
  const double seconds = static_cast<double>(row.frame.tick) / plan_.info.tick_rate;
  const bool agrees = std::abs(row.time - seconds) <= 0.5 / plan_.info.tick_rate;
  if (!agrees && mapping_.tick_rate == 0) return fail(Errc::invalid, "R-CSV-5");
  return row.frame.tick;
}

Result<void> Importer::write(Row& row) {
  line_ = row.line;
  TACTUS_TRY(const std::int64_t tick, tick_of(row));
  const bool increases = done_.ticks.count() == 0 ? tick >= 0 : tick > last_.frame.tick;
  if (!increases || tick / plan_.info.tick_rate >= kMaxSeconds) return fail(Errc::invalid, "R-CSV-5");
  row.frame.tick = tick;
  TACTUS_CHECK(writer_->write(row.frame));
  done_.ticks.add(tick);
  done_.segments = 1;
  last_ = std::move(row);
  return {};
}

}  // namespace

tl::expected<CsvImport, Diagnostic> import_tactus_csv(CsvReader& reader, const CsvMapping& mapping, CsvPlan plan,
                                                      const std::string& out_path, bool& has_output) {
  Importer importer(mapping, std::move(plan), out_path);
  const auto done = importer.run(reader);
  has_output = importer.has_output();
  if (done) return *done;
  return tl::unexpected(importer.located(done.error()));
}

}  // namespace tactus
