// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_rows.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/base/shown.h>
#include <tactus/base/text.h>
#include <tactus/trace/csv_plan.h>
#include <tactus/trace/missing.h>

namespace tactus {
namespace {

constexpr double kLengthAsIs = 1e-3;  // what the square of a rotation's length may be off 1 and keep its bits
constexpr std::size_t kMostObjects = 4096;

double length_of(const Quat& q) noexcept { return std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z); }

Quat about(std::uint8_t axis, double angle) noexcept {
  const double c = std::cos(angle / 2), s = std::sin(angle / 2);
  return {c, axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0};
}

/// Of a matrix, row by row, that turns and does not stretch.
Quat of_matrix(const std::array<double, 9>& m) noexcept {
  const double trace = m[0] + m[4] + m[8];
  if (trace > 0) {
    const double s = 2 * std::sqrt(trace + 1);
    return {s / 4, (m[7] - m[5]) / s, (m[2] - m[6]) / s, (m[3] - m[1]) / s};
  }
  if (m[0] > m[4] && m[0] > m[8]) {
    const double s = 2 * std::sqrt(1 + m[0] - m[4] - m[8]);
    return {(m[7] - m[5]) / s, s / 4, (m[1] + m[3]) / s, (m[2] + m[6]) / s};
  }
  if (m[4] > m[8]) {
    const double s = 2 * std::sqrt(1 + m[4] - m[0] - m[8]);
    return {(m[2] - m[6]) / s, (m[1] + m[3]) / s, s / 4, (m[5] + m[7]) / s};
  }
  const double s = 2 * std::sqrt(1 + m[8] - m[0] - m[4]);
  return {(m[3] - m[1]) / s, (m[2] + m[6]) / s, (m[5] + m[7]) / s, s / 4};
}

/// Rows and columns of length 1 at right angles, within what digits lose, and no mirror.
bool is_rotation(const std::array<double, 9>& m) noexcept {
  const Vec3 a{m[0], m[1], m[2]}, b{m[3], m[4], m[5]}, c{m[6], m[7], m[8]};
  const auto off = [](double is, double wanted) { return std::abs(is - wanted) > kRotationTolerance; };
  return !off(norm(a), 1) && !off(norm(b), 1) && !off(dot(a, b), 0) && !off(dot(cross(a, b), c), 1);
}

}  // namespace

CsvRows::CsvRows(const CsvMapping& mapping, CsvNamedPlan& plan)
    : mapping_(mapping), plan_(plan), turns_(mapping.axes != std::array<std::int8_t, 3>{1, 2, 3}) {
  const auto& [x, y, z] = mapping.axes;
  const std::array<int, 3> order{std::abs(x), std::abs(y), std::abs(z)};
  const int swaps = (order[0] > order[1]) + (order[0] > order[2]) + (order[1] > order[2]);
  mirror_ = (swaps % 2 == 0 ? 1 : -1) * (x < 0 ? -1 : 1) * (y < 0 ? -1 : 1) * (z < 0 ? -1 : 1);
}

Diagnostic CsvRows::wrong(RuleName rule, std::string remedy) const {
  const bool is_row = std::string_view(rule) == "R-CSV-3";
  return {.error = fail(Errc::malformed, rule).value(),
          .line = line_,
          .detail = is_row ? "" : location_of_field(plan_.names[column_], text_),
          .remedy = std::move(remedy)};
}

CsvRows::Read CsvRows::read(const std::vector<std::string>& fields, const CsvNumber& number, double& value) {
  value = 0;
  if (!number.column) return Read::value;
  const std::string& field = fields[*number.column];
  const auto parsed = parse_number<double>(field);
  if (parsed && std::isfinite(*parsed)) {
    value = number.scale * *parsed;
    return Read::value;
  }
  column_ = *number.column;
  text_ = field;
  if (!parsed && !is_missing_word(field) && std::ranges::find(mapping_.missing, field) == mapping_.missing.end())
    return Read::wrong;
  why_ = field.empty() ? "an empty field" : "'" + shown(field) + "'";
  return Read::missing;
}

template <std::size_t N>
CsvRows::Read CsvRows::read(const std::vector<std::string>& fields, const std::array<CsvNumber, N>& numbers,
                            std::span<double> values) {
  Read worst = Read::value;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Read one = read(fields, numbers[i], values[i]);
    if (one == Read::wrong) return one;
    if (one == Read::missing) worst = one;
  }
  return worst;
}

CsvRows::Read CsvRows::read_rotation(const std::vector<std::string>& fields, const CsvChannel& channel, Quat& rotation) {
  using Turn = CsvChannel::Turn;
  std::array<double, 9> n{};
  const std::size_t count = channel.turn == Turn::quaternion ? 4 : channel.turn == Turn::matrix ? 9 : 3;
  if (const Read read_all = read(fields, channel.rotation, std::span(n).first(count)); read_all != Read::value) return read_all;
  if (channel.rotation[0].column) column_ = *channel.rotation[0].column;
  text_.clear();
  switch (channel.turn) {
    case Turn::none:
      break;
    case Turn::euler:
      rotation = about(channel.euler_axes[0], n[0]) * about(channel.euler_axes[1], n[1]) * about(channel.euler_axes[2], n[2]);
      break;
    case Turn::vector: {
      const double angle = norm({n[0], n[1], n[2]}), s = angle > 0 ? std::sin(angle / 2) / angle : 0.5;
      rotation = {std::cos(angle / 2), s * n[0], s * n[1], s * n[2]};
      break;
    }
    case Turn::matrix:
      why_ = "a matrix that is no rotation";
      if (!is_rotation(n)) return Read::missing;
      rotation = of_matrix(n);
      [[fallthrough]];
    case Turn::quaternion: {
      if (channel.turn == Turn::quaternion) rotation = {n[0], n[1], n[2], n[3]};
      const double length = length_of(rotation);
      why_ = length == 0 ? "a rotation of length 0" : "a rotation whose length is off 1 by more than 2 %";
      if (!is_rotation_length(length)) return Read::missing;
      if (std::abs(length * length - 1) <= kLengthAsIs) break;
      plan_.notes.add("column " + plan_.names[column_], "rotations whose length is off 1 by less than 2 % are made 1 long", at());
      rotation = {rotation.w / length, rotation.x / length, rotation.y / length, rotation.z / length};
    }
  }
  return Read::value;
}

CsvRows::Read CsvRows::read_sample(const std::vector<std::string>& fields, const CsvChannel& channel, RigidSample& sample) {
  const auto vector = [&](const std::array<CsvNumber, 3>& numbers, Vec3& v) {
    std::array<double, 3> n{};
    const Read done = read(fields, numbers, n);
    v = {n[0], n[1], n[2]};
    return done;
  };
  Read worst = vector(channel.position, sample.pose.position);
  const auto take = [&](Read one) { worst = std::max(worst, one); };
  if (worst != Read::wrong && channel.turn != CsvChannel::Turn::none) take(read_rotation(fields, channel, sample.pose.rotation));
  if (worst != Read::wrong && channel.has_velocity) take(vector(channel.velocity, sample.velocity));
  if (worst != Read::wrong && channel.has_angular_velocity) take(vector(channel.angular_velocity, sample.angular_velocity));
  if (worst != Read::value) return worst;
  if (channel.has_angular_velocity && mapping_.angular_velocity_frame == AngularVelocityFrame::body) {
    const Quat& q = sample.pose.rotation;
    const double size = length_of(q);
    sample.angular_velocity = rotate(Quat{q.w / size, q.x / size, q.y / size, q.z / size}, sample.angular_velocity);
  }
  if (turns_) turn_axes(sample, channel.kind == CsvChannel::Kind::object);
  return worst;
}

/// M v; of a rotation and a turning axis det(M) M v.
void CsvRows::turn_axes(RigidSample& sample, bool is_object) const {
  const auto turned = [&](const Vec3& v) {
    const double from[3]{v.x, v.y, v.z};
    const auto part = [&](std::int8_t axis) { return axis < 0 ? 0 - from[-axis - 1] : from[axis - 1]; };
    return Vec3{part(mapping_.axes[0]), part(mapping_.axes[1]), part(mapping_.axes[2])};
  };
  sample.pose.position = turned(sample.pose.position);
  const Quat& q = sample.pose.rotation;
  const Vec3 axis = mirror_ * turned({q.x, q.y, q.z}) + Vec3{};
  sample.pose.rotation = {q.w, axis.x, axis.y, axis.z};
  if (!is_object) return;
  sample.velocity = turned(sample.velocity);
  sample.angular_velocity = mirror_ * turned(sample.angular_velocity);
}

/// By the first time of the table, where it is not stated.
void CsvRows::settle_unit(const std::string& field) {
  if (plan_.time_is_stated) return;
  const auto unit = unit_of_epoch(field);
  if (!unit) return;
  plan_.time_unit = *unit;  // a guess: an implausible rate is asked about
  const char* name = *unit == 1           ? "nanoseconds"
                     : *unit == 1000      ? "microseconds"
                     : *unit == 1'000'000 ? "milliseconds"
                                          : "seconds";
  if (*unit != 1'000'000'000)
    plan_.notes.add("column " + plan_.names[*plan_.time],
                    std::string("taken as ") + name + " since 1970, as the numbers are that large");
}

/// Of a sensor that has seconds and nanoseconds apart.
bool CsvRows::add_fraction(const std::vector<std::string>& fields, CsvTime& time) {
  const auto part = parse_csv_time(fields[*plan_.fraction], plan_.fraction_unit);
  const bool fits = part && part->nanoseconds >= 0 && part->nanoseconds < plan_.time_unit;
  const std::string& name = plan_.names[*plan_.fraction];
  if (plan_.fraction_is_guess && !has_time_) {
    if (!fits || text_.find_first_not_of("0123456789") != std::string::npos) return plan_.fraction.reset(), true;
    plan_.used[*plan_.fraction] = true;
    plan_.notes.add("column " + plan_.names[*plan_.time], shown(name) + " is added to it, as its fraction");
  }
  column_ = *plan_.fraction;
  text_ = fields[column_];
  if (!fits) remedy_ = "It is no fraction of the column before: name one column that holds the whole time (--time COLUMN).";
  if (fits) time.nanoseconds += part->nanoseconds;
  return fits;
}

namespace {

/// [ns] 12:35:59.5 of 123559.5 s
std::optional<std::int64_t> clock_of(std::int64_t time) noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t digits = time / kSecond, hours = digits / 10000, minutes = digits / 100 % 100, seconds = digits % 100;
  if (time < 0 || hours > 23 || minutes > 59 || seconds > 60) return std::nullopt;
  return (hours * 3600 + minutes * 60 + seconds) * kSecond + time % kSecond;
}

}  // namespace

/// Numbers that no one called seconds, none of which ends in 61 to 99, and which step over these: 123559.9, 123600.0.
bool CsvRows::looks_like_clock(std::int64_t time) {
  constexpr std::int64_t kMost = 5'000'000'000;  // [ns] from row to row
  const auto clock = clock_of(time);
  may_be_clock_ = may_be_clock_ && clock.has_value() && !plan_.time_is_stated && plan_.time_unit == 1'000'000'000;
  if (!may_be_clock_) return false;
  const std::int64_t since = *clock - std::exchange(last_clock_, *clock);
  return has_time_ && since > 0 && since < kMost && time - last_time_ > since;
}

bool CsvRows::read_time(const std::vector<std::string>& fields, CsvRow& row) {
  column_ = *plan_.time;
  text_ = fields[column_];
  if (plan_.clock) text_ += ' ' + fields[*plan_.clock];
  if (!has_time_) settle_unit(text_);
  const auto order = static_cast<DateOrder>(mapping_.date_order);
  auto time = parse_csv_time(text_, plan_.time_unit, order);
  if (!time && order == DateOrder::by_digits && parse_csv_time(text_, plan_.time_unit, DateOrder::mdy))
    remedy_ = "Say which number is the month: --date-order mdy or dmy.";
  if (time && time->kind == CsvTimeKind::number && plan_.time_is_clock) {
    const auto clock = clock_of(time->nanoseconds);
    if (!clock) remedy_ = "It is no time of day as 123559.5 is: give another --time-unit.";
    time = clock ? std::optional(CsvTime{*clock, CsvTimeKind::clock}) : std::nullopt;
  }
  if (!time || (has_time_ && time->kind != kind_)) return false;
  if (time->kind == CsvTimeKind::number && !plan_.fraction && looks_like_clock(time->nanoseconds)) {
    remedy_ =
        "Times seem to be hours, minutes and seconds, as 123559 and 123600 are one second apart: say --time-unit hhmmss if they "
        "are, "
        "--time-unit s if they are seconds.";
    asks_ = true;
    return false;
  }
  if (plan_.clock && time->kind != CsvTimeKind::date) return false;
  if (plan_.fraction && time->kind == CsvTimeKind::number && !add_fraction(fields, *time)) return false;
  const std::int64_t turn = std::ranges::count(text_, ':') == 1 ? kDayUnit / 24 : kDayUnit;  // of minutes: past the hour
  row.time = time->nanoseconds;
  if (time->kind == CsvTimeKind::clock) {  // past midnight
    if (has_time_ && row.time + wrapped_ < last_time_ - turn / 2) wrapped_ += turn;
    row.time += wrapped_;
  }
  if (time->kind != CsvTimeKind::number) plan_.time_is_stated = true;
  if (!has_time_) {
    if (time->kind == CsvTimeKind::date || unit_of_epoch(fields[*plan_.time]) == plan_.time_unit) first_date_ = row.time;
    has_time_ = true;
    kind_ = time->kind;
  }
  last_time_ = row.time;
  return true;
}

/// By the first rotation: recordings mostly begin near none, so that w is near 1.
CsvResult<void> CsvRows::settle_order(const std::vector<std::string>& fields, CsvChannel& channel) {
  std::array<double, 4> n{};
  if (read(fields, channel.rotation, std::span(n)) != Read::value) return {};
  if (!is_rotation_length(length_of({n[0], n[1], n[2], n[3]}))) return {};
  constexpr double kNear = 0.95;
  const bool is_counted = channel.order == CsvChannel::Order::counted, is_last = std::abs(n[3]) > kNear;
  column_ = *channel.rotation[0].column;
  if ((is_counted && is_last) || (!is_counted && !is_last && std::abs(n[0]) <= kNear)) {
    text_ = fields[column_];
    for (std::size_t i = 1; i < 4; ++i) text_ += ", " + fields[*channel.rotation[i].column];
    Diagnostic error = wrong("R-CSV-10", "Which of the four is w? Give --quaternion-order wxyz or xyzw.");
    error.error = fail(Errc::invalid_argument, "R-CSV-10").value();
    return tl::unexpected(error);
  }
  channel.order = CsvChannel::Order::known;
  if (is_last) std::rotate(channel.rotation.begin(), channel.rotation.begin() + 3, channel.rotation.begin() + 4);
  const std::string why = is_counted ? "counted from 0" : "the first one is near none";
  plan_.notes.add("column " + plan_.names[column_],
                  std::string("rotations are taken as ") + (is_last ? "x, y, z, w" : "w, x, y, z") + ": " + why +
                      "; --quaternion-order says otherwise",
                  at());
  return {};
}

bool CsvRows::find_object(const std::vector<std::string>& fields, std::size_t& index) {
  const std::string& name = fields[*plan_.object];
  const auto found = object_index_.find(name);
  if (found != object_index_.end()) return index = found->second, true;
  column_ = *plan_.object;
  text_ = name;
  if (!is_plain_name(name) || objects_.size() == kMostObjects) return false;
  index = objects_.size();
  objects_.push_back(name);
  object_index_.emplace(name, index);
  return true;
}

/// What is not read may be lacking, at the end.
bool CsvRows::has_all(const std::vector<std::string>& fields) {
  if (fields.size() >= plan_.names.size()) return fields.size() == plan_.names.size();
  const auto lacking = plan_.used.begin() + static_cast<std::ptrdiff_t>(fields.size());
  if (std::find(lacking, plan_.used.end(), true) != plan_.used.end() || plan_.fraction.value_or(0) >= fields.size()) return false;
  plan_.notes.add("", "rows lack fields at their end, of columns that are not read", at());
  return true;
}

CsvResult<std::optional<CsvRow>> CsvRows::parse(const CsvReader& reader) {
  const auto& fields = reader.fields();
  line_ = reader.line();
  text_.clear();
  remedy_.clear();
  const auto refuse_row = [&](RuleName rule, std::string_view what) -> CsvResult<std::optional<CsvRow>> {
    if (!mapping_.skip_bad || asks_)
      return tl::unexpected(wrong(
          rule,
          !remedy_.empty() ? remedy_
          : std::string_view(rule) == "R-CSV-3"
              ? "Correct the row, or leave such rows out with --skip-bad."
              : "Correct the field; if it means that there is no value, give --missing TEXT; --skip-bad leaves such rows out."));
    plan_.notes.add("", what, at());
    return std::optional<CsvRow>();
  };
  if (!has_all(fields)) return refuse_row("R-CSV-3", "rows with another number of fields are left out");
  CsvRow row{.line = line_, .time = 0, .bytes = reader.bytes() + 1, .segment = {}, .values = {}};
  if (plan_.segment) row.segment = fields[*plan_.segment];
  if (plan_.time) {
    const auto lacks = [&](std::optional<std::size_t> column) { return column && is_missing_word(fields[*column]); };
    const bool lacks_time = lacks(plan_.time);
    if (lacks_time || lacks(plan_.clock) || lacks(plan_.fraction)) {
      column_ = lacks_time ? *plan_.time : plan_.clock ? *plan_.clock : *plan_.fraction;
      text_ = fields[column_];
      if (mapping_.strict) return tl::unexpected(wrong("R-CSV-4", "Correct the time, or do not give --strict."));
      plan_.notes.add("column " + plan_.names[column_], "rows without a time are left out", at());
      return std::optional<CsvRow>();
    }
    if (!read_time(fields, row)) return refuse_row("R-CSV-4", "rows whose time cannot be read are left out");
  }
  std::size_t object = 0;
  if (plan_.object && !find_object(fields, object)) return refuse_row("R-CSV-4", "rows whose object has no name are left out");
  for (std::size_t i = 0; i < plan_.channels.size(); ++i) {
    CsvValue& value = row.values.emplace_back();
    value.channel = static_cast<std::uint32_t>(object * plan_.channels.size() + i);
    if (plan_.channels[i].order != CsvChannel::Order::known) TACTUS_CHECK(settle_order(fields, plan_.channels[i]));
    const Read done = read_sample(fields, plan_.channels[i], value.sample);
    if (done == Read::wrong) return refuse_row("R-CSV-4", "rows with a field that cannot be read are left out");
    value.is_there = done == Read::value;
    if (value.is_there) continue;
    if (mapping_.strict)
      return tl::unexpected(wrong("R-CSV-4", "A value is missing: " + why_ + ". Correct it, or do not give --strict."));
    plan_.notes.add("column " + plan_.names[column_], "a sample is missing: " + why_,
                    at() + (plan_.time ? ", time " + fields[*plan_.time] : ""));
  }
  return std::optional(std::move(row));
}

}  // namespace tactus
