// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <ostream>

#include <tactus/base/rule.h>
#include <tactus/trace/csv.h>
#include <tactus/trace/csv_plan.h>
#include <tactus/trace/csv_reader.h>

namespace tactus {
namespace {

std::string header_row(const TraceInfo& info) {
  std::string row = "tick,time_s";
  if (info.shows_past) row.append(",").append(kShownColumn);
  const auto add = [&row](const std::string& path, const char* name) { row.append(",").append(csv_field(path + name)); };
  for (const TraceObject& object : info.objects) {
    const std::string path = "/objects/" + object.name + "/";
    add(path, kDofColumn);
    for (const auto& column : kObjectColumns) add(path, column.name);
  }
  for (const TraceUser& user : info.users) {
    const std::string path = "/users/" + user.name + "/";
    add(path, kContactColumn);
    add(path, kContactObjectColumn);
    for_each_column(user, [&](const auto& column) { add(path, column.name); });
    if (user.senses.buttons) add(path, kButtonsColumn);
    if (user.senses.time) add(path, kDeviceTimeColumn);
    if (user.has_servo)
      for (const char* column : kServoColumns) add(path, column);
    if (user.report_descriptor) add(path, kReportsColumn);
  }
  return row + '\n';
}

template <class T>
void add_number(std::string& row, T value) {
  char digits[32];
  const auto result = std::to_chars(digits, digits + sizeof digits, value);
  if (!row.empty()) row += ',';
  row.append(digits, result.ptr);
}

void add_reports(std::string& row, const DeviceReports& reports) {
  row += ',';
  std::span<const std::uint8_t> left(reports.bytes);
  for (const std::uint32_t size : reports.sizes) {
    if (left.size() < reports.bytes.size()) row += ' ';
    row += hex_of(left.first(size));
    left = left.subspan(size);
  }
}

void write_row(std::string& row, const TraceInfo& info, TraceFrame& frame) {
  row.clear();
  add_number(row, frame.tick);
  add_number(row, static_cast<double>(frame.tick) / info.tick_rate);
  if (info.shows_past) add_number(row, frame.shown);
  for (std::size_t i = 0; i < frame.objects.size(); ++i) {
    add_number(row, unsigned{info.objects[i].dof});
    for (const auto& column : kObjectColumns) add_number(row, column.field(frame.objects[i]));
  }
  for (std::size_t i = 0; i < frame.users.size(); ++i) {
    UserSample& user = frame.users[i];
    const DeviceSenses& senses = info.users[i].senses;
    add_number(row, static_cast<unsigned>(user.contact.kind));
    add_number(row, user.contact.object);
    for_each_column(info.users[i], [&](const auto& column) { add_number(row, column.field(user)); });
    if (senses.buttons) add_number(row, user.device.buttons);
    if (senses.time) add_number(row, user.device.time);
    if (info.users[i].has_servo) {
      add_number(row, user.servo.lateness);
      add_number(row, user.servo.age);
      add_number(row, user.servo.missed);
      add_number(row, user.servo.guard);
    }
    if (info.users[i].report_descriptor) add_reports(row, user.reports);
  }
  row += '\n';
}

}  // namespace

Result<TickSpan> export_csv(TraceReader& reader, std::ostream& out) try {
  out << header_row(reader.info());
  TickSpan rows;
  TraceFrame frame;
  std::string row;
  while (true) {
    TACTUS_TRY(const bool more, reader.next(frame));
    if (!more) break;
    write_row(row, reader.info(), frame);
    out << row;
    rows.add(frame.tick);
  }
  return out.flush() ? Result<TickSpan>(rows) : fail(Errc::io, "R-TRC-1");
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

}  // namespace tactus
