// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/array_trace.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include <tactus/base/rule.h>
#include <tactus/trace/csv_rate.h>
#include <tactus/trace/differences.h>
#include <tactus/trace/missing.h>
#include <tactus/trace/sample_track.h>
#include <tactus/trace/trace_file.h>

namespace tactus {
namespace {

constexpr double kSecond = 1e9;                     // [ns]
constexpr double kOnGrid = 1e-3, kNearGrid = 0.05;  // [ticks]

std::string seconds_text(std::int64_t time) {
  char text[40];
  std::snprintf(text, sizeof text, "at %.9g s", static_cast<double>(time) / kSecond);
  return text;
}

/// One array, without its missing samples.
struct Lane {
  std::string where;
  std::span<const double> values;
  std::size_t width = 0;
  std::vector<std::size_t> rows{};  // with a sample
  std::size_t taken = 0;            // of them, by the track
  SampleTrack<std::int64_t> track{};
};

bool is_sample(const Lane& lane, std::size_t row) {
  const auto values = lane.values.subspan(row * lane.width, lane.width);
  double square = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) return false;
    square += value * value;
  }
  return lane.width != 4 || is_rotation_length(std::sqrt(square));
}

class ArrayWriter {
 public:
  ArrayWriter(const SampledArrays& arrays, ReadNotes& notes) : arrays_(arrays), notes_(notes) {}
  Result<TickSpan> run(const std::string& path);

 private:
  Result<void> take_times();
  Result<void> spread_groups();
  CsvRow row_of(std::size_t row) const;
  Result<void> take_lanes();
  Result<void> add_lane(std::string where, std::span<const double> values, std::size_t width);
  void note_missing(const Lane& lane);
  void note_repaired(const Lane& lane);
  Result<void> find_rate();
  Result<void> take_contacts();
  double off_grid(double rate) const;
  std::int64_t since_start(std::size_t row) const { return (even_.empty() ? arrays_.time[rows_[row]] : even_[row]) - start_; }
  double time_of(std::size_t row) const { return static_cast<double>(since_start(row)) / kSecond; }
  bool is_pause(double time);
  RigidSample sample_of(const Lane& lane, std::size_t row) const;
  SampleTrack<std::int64_t>& lane_at(Lane& lane, std::int64_t time) const;
  void make(std::int64_t tick, TraceFrame& frame);
  TraceInfo info() const;

  const SampledArrays& arrays_;
  ReadNotes& notes_;
  std::vector<std::size_t> rows_;   // of the arrays, whose times rise
  std::vector<std::int64_t> even_;  // [ns] of rows_, whose own times come in groups; empty: those hold
  std::int64_t start_ = 0;
  std::uint32_t rate_ = 0;
  bool is_on_grid_ = false;
  std::vector<Lane> lanes_;  // of objects, then users: those that are there, in the order of the fields
  std::size_t last_row_ = 0;
  ContactDeclarations contacts_;
};

Result<void> ArrayWriter::take_times() {
  std::optional<std::int64_t> last;
  for (std::size_t row = 0; row < arrays_.time.size(); ++row) {
    const std::int64_t time = arrays_.time[row];
    const std::string location = "row " + std::to_string(row);
    if (time == SampledArrays::kNoTime) {
      notes_.add("time", "missing; the row is left out", location);
    } else if (last && time < *last) {
      notes_.add("time", "falls; the row is left out", location);
    } else {
      rows_.push_back(row);
      last = time;
    }
  }
  if (rows_.empty() || 2 * rows_.size() < arrays_.time.size()) return fail(Errc::invalid, "R-CSV-5");
  TACTUS_CHECK(spread_groups());
  start_ = even_.empty() ? arrays_.time[rows_.front()] : even_.front();
  if (static_cast<double>(*last) - static_cast<double>(start_) > 2147483648.0 * kSecond) return fail(Errc::invalid, "R-CSV-5");
  return {};
}

/// As one of a table: the first quantity that is there shows whether rows with one time are samples.
CsvRow ArrayWriter::row_of(std::size_t row) const {
  CsvRow out{.line = row, .time = arrays_.time[row], .bytes = 0, .segment = {}, .values = {CsvValue{}}};
  std::span<const double> values;
  if (!arrays_.objects.empty()) values = arrays_.objects.front().position;
  else if (!arrays_.users.empty())
    values = arrays_.users.front().device.empty() ? arrays_.users.front().force : arrays_.users.front().device;
  if (values.size() < 3 * row + 3) return out;
  const double* v = &values[3 * row];
  out.values[0].is_there = std::isfinite(v[0] + v[1] + v[2]);
  if (out.values[0].is_there) out.values[0].sample.pose.position = {v[0], v[1], v[2]};
  return out;
}

/// Times that repeat: rows in groups get even times; where they are copies, the last row of each time counts.
Result<void> ArrayWriter::spread_groups() {
  constexpr std::size_t kRowsForEstimate = 10'000;
  const auto repeats = [this](std::size_t i) { return arrays_.time[rows_[i]] == arrays_.time[rows_[i - 1]]; };
  std::size_t first = 1;
  while (first < rows_.size() && !repeats(first)) ++first;
  if (first >= rows_.size()) return {};
  const std::size_t from = first > kRowsForEstimate / 2 ? first - kRowsForEstimate / 2 : 0;
  std::vector<CsvRow> some;
  for (std::size_t i = from; i < std::min(rows_.size(), from + kRowsForEstimate); ++i) some.push_back(row_of(rows_[i]));
  CsvMapping mapping;
  mapping.tick_rate = arrays_.tick_rate;
  CsvNamedPlan plan;
  plan.time_is_stated = true;
  const auto rate = estimate_rate(some, mapping, plan);
  if (rate && rate->period > 0) {
    EvenTimes even(*rate);
    for (const std::size_t row : rows_) even_.push_back(even.time_of(row_of(row), 0));
    for (const ReadNote& note : plan.notes.all()) notes_.add("time", note.what);
    return {};
  }
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (i + 1 < rows_.size() && repeats(i + 1))
      notes_.add("time", "repeats; of equal times the last row counts", "row " + std::to_string(rows_[i]));
    else kept.push_back(rows_[i]);
  }
  rows_ = std::move(kept);
  return {};
}

Result<void> ArrayWriter::add_lane(std::string where, std::span<const double> values, std::size_t width) {
  Lane lane{.where = std::move(where), .values = values, .width = width};
  if (values.size() != width * arrays_.time.size()) {
    notes_.add(lane.where,
               "has " + std::to_string(values.size() / width) + " rows for " + std::to_string(arrays_.time.size()) + " times");
    return fail(Errc::invalid_argument, "R-CSV-8");
  }
  for (std::size_t row = 0; row < rows_.size(); ++row)
    if (is_sample(lane, rows_[row])) lane.rows.push_back(row);
  if (lane.rows.empty()) {
    notes_.add(lane.where, "every sample is missing");
    return fail(Errc::malformed, "R-CSV-4");
  }
  note_missing(lane);
  if (width == 4) note_repaired(lane);
  lane.track =
      SampleTrack<std::int64_t>({.gap = arrays_.gap * kSecond, .same = kOnGrid * kSecond / rate_, .tick = kSecond / rate_});
  lanes_.push_back(std::move(lane));
  return {};
}

/// Missing samples, one by one.
void ArrayWriter::note_missing(const Lane& lane) {
  std::size_t next = 0;  // sample at or after the row
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    if (next < lane.rows.size() && lane.rows[next] == row) {
      ++next;
      continue;
    }
    const char* what = "missing samples, the first one held backwards";
    if (next == lane.rows.size()) what = "missing samples, the last one held";
    else if (next > 0)
      what = time_of(lane.rows[next]) - time_of(lane.rows[next - 1]) <= arrays_.gap
                 ? "missing samples, interpolated"
                 : "missing samples, the one before the gap held";
    notes_.add(lane.where, what, "row " + std::to_string(rows_[row]) + ", " + seconds_text(arrays_.time[rows_[row]]));
  }
}

void ArrayWriter::note_repaired(const Lane& lane) {
  constexpr double kRounding = 1e-3;  // of rotations that are written with few digits
  for (const std::size_t row : lane.rows) {
    const auto q = lane.values.subspan(4 * rows_[row], 4);
    if (std::abs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1) > kRounding)
      notes_.add(lane.where, "rotations whose length is off 1 by less than 2 % are made 1 long",
                 "row " + std::to_string(rows_[row]));
  }
}

Result<void> ArrayWriter::take_lanes() {
  if (arrays_.objects.empty() && arrays_.users.empty()) return fail(Errc::invalid_argument, "R-CSV-8");
  const auto add = [&](const std::string& of, const char* field, std::span<const double> values, std::size_t width) {
    return values.empty() ? Result<void>() : add_lane(of + "." + field, values, width);
  };
  for (const SampledObject& object : arrays_.objects) {
    if (object.position.empty()) {
      notes_.add(object.name, "has no position");
      return fail(Errc::invalid_argument, "R-CSV-8");
    }
    TACTUS_CHECK(add(object.name, "position", object.position, 3));
    TACTUS_CHECK(add(object.name, "rotation", object.rotation, 4));
    TACTUS_CHECK(add(object.name, "velocity", object.velocity, 3));
    TACTUS_CHECK(add(object.name, "angular_velocity", object.angular_velocity, 3));
  }
  for (const SampledUser& user : arrays_.users) {
    if (user.device.empty() && user.force.empty()) {
      notes_.add(user.name, "has neither device nor force");
      return fail(Errc::invalid_argument, "R-CSV-8");
    }
    TACTUS_CHECK(add(user.name, "device", user.device, 3));
    TACTUS_CHECK(add(user.name, "rotation", user.rotation, 4));
    TACTUS_CHECK(add(user.name, "force", user.force, 3));
  }
  return {};
}

/// [ticks] Largest distance of a time from a grid of this rate.
double ArrayWriter::off_grid(double rate) const {
  double off = 0;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const double ticks = time_of(row) * rate;
    off = std::max(off, std::abs(ticks - std::round(ticks)));
  }
  return off;
}

/// From the median spacing if the times lie on its grid; of a clock with jitter from the mean one, without pauses.
Result<void> ArrayWriter::find_rate() {
  rate_ = arrays_.tick_rate;
  if (rate_ == 0) {
    std::vector<double> spacings;
    double all = 0;
    for (std::size_t row = 1; row < rows_.size(); ++row) {
      const double spacing = time_of(row) - time_of(row - 1);
      if (spacing > arrays_.gap) continue;
      spacings.push_back(spacing);
      all += spacing;
    }
    if (spacings.empty()) return fail(Errc::invalid_argument, "R-CSV-7");
    const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
    std::nth_element(spacings.begin(), middle, spacings.end());
    double rate = std::round(1 / *middle);
    const double mean = std::round(static_cast<double>(spacings.size()) / all);
    if (off_grid(rate) > kNearGrid && std::abs(mean - rate) <= 0.05 * rate) rate = mean;
    if (!(rate >= 1 && rate <= kMaxTickRate)) return fail(Errc::invalid_argument, "R-CSV-7");
    rate_ = static_cast<std::uint32_t>(rate);
  }
  if (rate_ > kMaxTickRate) return fail(Errc::invalid_argument, "R-TRC-17");
  const double off = off_grid(rate_);
  is_on_grid_ = off <= kOnGrid;
  if (!is_on_grid_) {
    char text[160];
    std::snprintf(text, sizeof text, "samples are up to %.3g ms off a grid of %u Hz; interpolated onto it", 1e3 * off / rate_,
                  rate_);
    notes_.add("time", text);
  }
  return {};
}

/// Rows between which no ticks are made.   in  time  rising
bool ArrayWriter::is_pause(double time) {
  const double tolerance = kOnGrid / rate_;
  while (last_row_ + 1 < rows_.size() && time_of(last_row_ + 1) <= time + tolerance) ++last_row_;
  if (last_row_ + 1 == rows_.size() || time <= time_of(last_row_) + tolerance) return false;
  const double spacing = time_of(last_row_ + 1) - time_of(last_row_);
  return spacing > arrays_.gap || (is_on_grid_ && spacing > 1.5 / rate_);  // an own grid's missing rows are missing ticks
}

/// A vector in the position, a rotation of unit length.
RigidSample ArrayWriter::sample_of(const Lane& lane, std::size_t row) const {
  const double* v = &lane.values[lane.width * rows_[row]];
  if (lane.width == 3) return {{{v[0], v[1], v[2]}, {}}, {}, {}};
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
  const double scale = std::abs(length - 1) < 1e-12 ? 1 : length;
  return {{{}, {v[0] / scale, v[1] / scale, v[2] / scale, v[3] / scale}}, {}, {}};
}

/// in  time  [ns] since the start, rising
SampleTrack<std::int64_t>& ArrayWriter::lane_at(Lane& lane, std::int64_t time) const {
  for (; lane.taken < lane.rows.size(); ++lane.taken) {
    const std::size_t row = lane.rows[lane.taken];
    const std::int64_t at = since_start(row);
    if (lane.taken > 0 && lane.track.is_settled(time, at)) break;
    lane.track.add({at, sample_of(lane, row)});
  }
  lane.track.move_to(time);
  return lane.track;
}

void ArrayWriter::make(std::int64_t tick, TraceFrame& frame) {
  const auto time = static_cast<std::int64_t>(time_of_tick(tick, rate_));
  std::size_t lane = 0;
  const auto next = [&]() -> SampleTrack<std::int64_t>& { return lane_at(lanes_[lane++], time); };
  const auto speed_of = [](const auto& track) { return track.is_known() ? track.value().pose.position : Vec3{}; };
  for (std::size_t i = 0; i < arrays_.objects.size(); ++i) {
    const SampledObject& of = arrays_.objects[i];
    RigidSample& out = frame.objects[i];
    out.pose.position = next().pose().position;
    if (!of.rotation.empty()) out.pose.rotation = next().pose().rotation;
    if (!of.velocity.empty()) out.velocity = speed_of(next());
    if (!of.angular_velocity.empty()) out.angular_velocity = speed_of(next());
  }
  for (std::size_t i = 0; i < arrays_.users.size(); ++i) {
    UserSample& out = frame.users[i];
    if (!arrays_.users[i].device.empty()) out.device.position = next().pose().position;
    if (!arrays_.users[i].rotation.empty()) out.device.orientation = next().pose().rotation;
    if (!arrays_.users[i].force.empty()) out.force = out.server_force = next().vector();
    out.contact = {};
    out.contact.device = out.device.position;
  }
  contacts_.apply(frame);
}

TraceInfo ArrayWriter::info() const {
  TraceInfo out;
  out.tick_rate = rate_;
  out.source = arrays_.source;
  for (const SampledObject& object : arrays_.objects) {
    const bool can_turn = !object.rotation.empty() || !object.angular_velocity.empty();
    out.objects.push_back({object.name, can_turn ? Dof::all : Dof::translation});
  }
  for (const SampledUser& user : arrays_.users)
    out.users.push_back({.name = user.name, .senses = {.orientation = !user.rotation.empty()}});
  return out;
}

Result<void> ArrayWriter::take_contacts() {
  auto contacts = ContactDeclarations::create(info(), arrays_.contacts);
  if (!contacts) {
    notes_.add("contacts", "a user or an object that there is not, a user twice, or a stiffness that is not above 0");
    return tl::make_unexpected(contacts.error());
  }
  contacts_ = *std::move(contacts);
  return {};
}

Result<TickSpan> ArrayWriter::run(const std::string& path) {
  TACTUS_CHECK(take_times());
  TACTUS_CHECK(find_rate());
  TACTUS_CHECK(take_lanes());
  TACTUS_CHECK(take_contacts());
  TACTUS_TRY(TraceWriter writer, TraceWriter::create(path, info()));
  TraceFrame frame, before;
  frame.objects.resize(arrays_.objects.size());
  frame.users.resize(arrays_.users.size());
  TickSpan ticks;
  const auto last = static_cast<std::int64_t>(std::floor(time_of(rows_.size() - 1) * rate_ + kOnGrid));
  for (std::int64_t tick = 0; tick <= last; ++tick) {
    const double time = static_cast<double>(tick) / rate_;
    if (is_pause(time)) {  // on to the end of the pause
      tick = std::max(tick, static_cast<std::int64_t>(std::ceil(time_of(last_row_ + 1) * rate_ - kOnGrid)) - 1);
      continue;
    }
    frame.tick = tick;
    make(tick, frame);
    for (std::size_t i = 0; i < frame.objects.size(); ++i) {
      if (ticks.count() == 0) break;
      const double seconds = static_cast<double>(tick - before.tick) / rate_;
      const Twist motion = motion_between(before.objects[i].pose, frame.objects[i].pose, seconds);
      if (arrays_.objects[i].velocity.empty()) frame.objects[i].velocity = motion.linear;
      if (arrays_.objects[i].angular_velocity.empty()) frame.objects[i].angular_velocity = motion.angular;
    }
    if (const auto written = writer.write(frame); !written) {
      notes_.add("", "cannot be recorded", seconds_text(start_ + std::llround(time * kSecond)));
      return tl::make_unexpected(written.error());
    }
    ticks.add(tick);
    before = frame;
  }
  TACTUS_CHECK(writer.finish());
  return ticks;
}

}  // namespace

Result<TickSpan> write_arrays(const SampledArrays& arrays, const std::string& path, ReadNotes& notes) try {
  return ArrayWriter(arrays, notes).run(path);
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

}  // namespace tactus
