// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_timeline.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tactus/base/rule.h>
#include <tactus/base/shown.h>
#include <tactus/trace/csv_time.h>
#include <tactus/trace/differences.h>
#include <tactus/trace/interpolation.h>
#include <tactus/trace/messages.h>

namespace tactus {
namespace {

constexpr std::size_t kWindow = 64;            // rows that may be out of order
constexpr std::size_t kRowsForRate = 4096;     // looked at before the rate is settled
constexpr double kOnGrid = 0.1, kSame = 1e-3;  // [ticks]
constexpr double kDefaultGap = 0.1, kGapPeriods = 3;

std::string seconds_text(std::int64_t ns) { return number_text(static_cast<double>(ns) / 1e9, "%.9g") + " s"; }

}  // namespace

CsvTimeline::CsvTimeline(const CsvMapping& mapping, CsvNamedPlan& plan, const CsvRows& rows, std::string out_path)
    : mapping_(mapping), plan_(plan), rows_(rows), out_path_(std::move(out_path)) {}

Diagnostic CsvTimeline::mistake(Errc code, RuleName rule, std::uint64_t line, std::string detail, std::string remedy) const {
  return {.error = fail(code, rule).value(), .line = line, .detail = std::move(detail), .remedy = std::move(remedy)};
}

CsvResult<void> CsvTimeline::add(CsvRow row) {
  budget_.earn(row.bytes);
  if (!plan_.time) return deliver(std::move(row));
  falls_ = !last_time_ || row.time >= *last_time_ ? 0 : falls_ + 1;
  if (mapping_.restarts) mark_restart(row);
  last_time_ = row.time;
  if (!window_.empty() && window_.back().segment != row.segment) {
    while (!window_.empty()) TACTUS_CHECK(release());
    released_.reset();
  } else if (window_.empty() && released_ && has_segment_ && row.segment != segment_) {
    released_.reset();
  }
  if (released_ && row.time < *released_) return tl::unexpected(out_of_order(row));
  if (window_.empty() || window_.back().time <= row.time) {
    window_.push_back(std::move(row));
  } else {
    if (mapping_.strict || !mapping_.resample)
      return tl::unexpected(mistake(Errc::invalid, "R-CSV-5", row.line,
                                    "time " + seconds_text(row.time) + " after " + seconds_text(window_.back().time),
                                    "Sort the rows by time, or do not give --strict or --no-resample."));
    plan_.notes.add("", "rows out of order are sorted by time", "line " + std::to_string(row.line));
    auto at = window_.end();
    while (at != window_.begin() && std::prev(at)->time > row.time) --at;
    window_.insert(at, std::move(row));
  }
  return window_.size() > kWindow ? release() : CsvResult<void>();
}

/// Rows that cross are a few: a time ahead of all in the window begins another recording.
void CsvTimeline::mark_restart(CsvRow& row) {
  const std::int64_t earliest = !window_.empty() ? window_.front().time : released_.value_or(row.time);
  const bool is_own_segment = !window_.empty() && window_.back().segment != row.segment + restart_suffix();
  if (row.time < earliest && !is_own_segment) {
    ++restarts_;
    plan_.notes.add("", "the time falls: another segment begins", "line " + std::to_string(row.line));
  }
  row.segment += restart_suffix();
}

Diagnostic CsvTimeline::out_of_order(const CsvRow& row) const {
  const bool is_reversed = falls_ >= kWindow;
  return mistake(
      Errc::invalid, "R-CSV-5", row.line,
      is_reversed ? "times fall in " + std::to_string(falls_ + 1) + " rows one after the other"
                  : "time " + seconds_text(row.time) + " after " + seconds_text(*released_) + " in line " +
                        std::to_string(released_line_),
      is_reversed
          ? "Turn the rows around, as by tac."
          : "Name the column that separates the recordings (--segment COLUMN), give --restarts if another recording begins "
            "there, or sort the rows by time.");
}

/// The first row of the window is in order.
CsvResult<void> CsvTimeline::release() {
  CsvRow row = std::move(window_.front());
  window_.pop_front();
  released_ = row.time;
  released_line_ = row.line;
  if (writer_) return deliver(std::move(row));
  waiting_.push_back(std::move(row));
  return waiting_.size() < kRowsForRate ? CsvResult<void>() : start();
}

CsvResult<CsvImport> CsvTimeline::finish() {
  while (!window_.empty()) TACTUS_CHECK(release());
  if (!writer_ && waiting_.empty()) return tl::unexpected(mistake(Errc::truncated, "R-CSV-1", 0, ""));
  if (!writer_) TACTUS_CHECK(start());
  TACTUS_CHECK(end_segment());
  if (done_.ticks.count() == 0)
    return tl::unexpected(
        mistake(Errc::malformed, "R-CSV-4", 0, "every sample is missing", "Check that the mapping names the right columns."));
  const bool is_stated = mapping_.tick_rate > 0 || !mapping_.time_unit.empty();
  if (plan_.time && !is_stated && 2 * done_.ticks.left_out() > done_.ticks.length())
    return tl::unexpected(mistake(
        Errc::invalid, "R-CSV-11", 0,
        std::to_string(done_.ticks.left_out()) + " of " + std::to_string(done_.ticks.length()) + " ticks at " +
            std::to_string(plan_.info.tick_rate) + " Hz have no sample",
        "If that is right, say --tick-rate " + std::to_string(plan_.info.tick_rate) + "; else give the rate, or --time-unit."));
  if (const auto finished = writer_->finish(); !finished) return tl::unexpected(Diagnostic{finished.error()});
  const double period = 1.0 / plan_.info.tick_rate;
  const std::string gap = number_text(gap_ * period) + " s (--gap)";
  plan_.notes.add("", "a sample is interpolated, over at most " + number_text(largest_gap_ * period) + " s", {}, made_);
  plan_.notes.add("", "a tick is left out: nothing was recorded for more than " + gap, {}, left_out_);
  plan_.notes.add("", "a sample is held, as others of the table go on: none for more than " + gap, {}, rested_);
  plan_.notes.add("", "a row with the time, or the tick, of a row before; the last of each counts", {}, repeated_);
  done_.notes = std::move(plan_.notes);
  return done_;
}

/// Without a column of time the mapping states the rate.
CsvResult<void> CsvTimeline::find_rate() {
  plan_.info.tick_rate = mapping_.tick_rate;
  if (!plan_.time)
    return mapping_.tick_rate > 0 ? CsvResult<void>() : tl::unexpected(mistake(Errc::invalid_argument, "R-CSV-7", 1, ""));
  TACTUS_TRY(const CsvRate rate, estimate_rate(waiting_, mapping_, plan_));
  plan_.info.tick_rate = rate.tick_rate;
  resamples_ = rate.is_off_grid;
  if (rate.period > 0) even_.emplace(rate);
  return {};
}

CsvResult<void> CsvTimeline::start() {
  TACTUS_CHECK(find_rate());
  const double rate = plan_.info.tick_rate;
  gap_ = mapping_.gap > 0 ? mapping_.gap * rate : std::max(kDefaultGap * rate, kGapPeriods);
  std::size_t subjects = 1;
  if (plan_.object) {
    const std::vector<std::string>& names = long_objects_.empty() ? rows_.objects() : long_objects_;
    const TraceInfo one = plan_.info;
    plan_.info.objects.clear();
    plan_.info.users.clear();
    subjects = names.size();
    for (const std::string& name : names) {
      for (TraceObject object : one.objects) object.name = name, plan_.info.objects.push_back(object);
      for (TraceUser user : one.users) user.name = name, plan_.info.users.push_back(user);
    }
  }
  channels_.assign(subjects * plan_.channels.size(), SampleTrack<Instant>({.gap = gap_, .same = kSame, .tick = 1}));
  TACTUS_CHECK(take_contacts());
  auto writer = TraceWriter::create(out_path_, plan_.info);
  if (!writer) return tl::unexpected(Diagnostic{.error = writer.error(), .line = 1});
  writer_ = std::move(*writer);
  if (rows_.first_date() != 0)
    plan_.notes.add("", "time begins at 0 in the trace; the first row is of " + date_text(rows_.first_date()));
  frame_.objects.resize(plan_.info.objects.size());
  frame_.users.resize(plan_.info.users.size());
  for (CsvRow& row : waiting_) TACTUS_CHECK(deliver(std::move(row)));
  waiting_ = {};
  return {};
}

CsvResult<void> CsvTimeline::take_contacts() {
  auto contacts = ContactDeclarations::create(plan_.info, mapping_.contacts);
  if (contacts) return contacts_ = *std::move(contacts), CsvResult<void>();
  const auto names_of = [](const auto& list) {
    std::string names;
    for (const auto& of : list) names += (names.empty() ? "" : ", ") + shown(of.name);
    return names.empty() ? "none" : names;
  };
  return tl::unexpected(Diagnostic{.error = contacts.error(),
                                   .detail = "contact",
                                   .remedy = "Declare one contact for a user. Users of this table: " +
                                             names_of(plan_.info.users) + "; objects: " + names_of(plan_.info.objects) + "."});
}

CsvTimeline::Instant CsvTimeline::instant_of(std::int64_t time) const noexcept {
  const std::int64_t since = time - segment_time_, second = since / 1'000'000'000, rest = since % 1'000'000'000;
  const double ticks = static_cast<double>(rest) * plan_.info.tick_rate / 1e9, whole = std::round(ticks);
  return {second * plan_.info.tick_rate + static_cast<std::int64_t>(whole), ticks - whole};
}

CsvResult<void> CsvTimeline::begin_segment(const CsvRow& row) {
  TACTUS_CHECK(end_segment());
  segment_ = row.segment;
  segment_time_ = row.time;
  has_segment_ = begins_ = true;
  base_ = done_.ticks.count() == 0 ? 0 : done_.ticks.last() + 1;
  shift_ = next_tick_ = row_number_ = 0;
  now_ = {};
  return {};
}

CsvResult<void> CsvTimeline::end_segment() {
  ended_ = true;
  TACTUS_CHECK(emit(true));
  ended_ = false;
  for (auto& channel : channels_) channel.clear();
  return {};
}

/// Of a row that is in order.
CsvResult<void> CsvTimeline::deliver(CsvRow row) {
  if (!writer_) {
    if (!waiting_.empty() || plan_.time) return tl::unexpected(mistake(Errc::internal, "R-CSV-7", row.line, ""));
    TACTUS_CHECK(start());
  }
  if (even_) row.time = even_->time_of(row, row.values[0].channel / plan_.channels.size());
  if (!has_segment_ || row.segment != segment_) TACTUS_CHECK(begin_segment(row));
  Instant at = plan_.time ? instant_of(row.time) : Instant{row_number_++, 0};
  const std::int64_t most = kMaxSeconds * plan_.info.tick_rate;
  if (at.tick >= most - base_)
    return tl::unexpected(mistake(Errc::invalid, "R-CSV-5", row.line, "time " + seconds_text(row.time),
                                  "A trace holds 2^31 s: check --time-unit."));
  if (!resamples_ && mapping_.resample && std::abs(at.off) > kOnGrid) {
    resamples_ = true;
    plan_.notes.add("", "from here on times lie off the grid: resampled", "line " + std::to_string(row.line));
  }
  if (!resamples_) at.off = 0;
  TACTUS_CHECK(ask_for_ticks(row, at));
  now_ = at;
  for (CsvValue& value : row.values) {
    if (!value.is_there) continue;
    if (value.channel >= channels_.size())
      return tl::unexpected(mistake(Errc::malformed, "R-CSV-2", row.line, "an object that the first rows lack",
                                    "Give the table as a file, not by a pipe."));
    channels_[value.channel].add({at, value.sample});
  }
  return emit(false);
}

/// Which ticks a row brings.
CsvResult<void> CsvTimeline::ask_for_ticks(const CsvRow& row, const Instant& at) {
  const bool is_first = begins_ && ticks_.empty() && next_tick_ == 0;
  const double since = is_first ? 0 : at.since(now_);
  if (!resamples_) {
    const bool is_same = !is_first && at.tick < next_tick_;
    if (is_same && (mapping_.strict || !mapping_.resample) && (since == 0) && !plan_.object)
      return tl::unexpected(mistake(Errc::invalid, "R-CSV-5", row.line,
                                    "time " + seconds_text(row.time) + " is in the tick of the row before",
                                    "Resample (without --no-resample and --strict), or give a higher --tick-rate."));
    if (is_same) repeated_ += plan_.object ? 0u : 1u;
    else ticks_.push_back(at.tick), next_tick_ = at.tick + 1;
    return {};
  }
  if (!is_first && since < kSame && !plan_.object) ++repeated_;
  if (!is_first && since < kSame && mapping_.strict && !plan_.object)
    return tl::unexpected(mistake(Errc::invalid, "R-CSV-5", row.line, "time " + seconds_text(row.time) + " repeats",
                                  "Do not give --strict, or remove the row."));
  const auto last = at.tick + (at.off < -kSame ? -1 : 0);
  if (since > gap_) {
    left_out_ += static_cast<std::uint64_t>(std::max<std::int64_t>(last - next_tick_, 0));
    next_tick_ = std::max(next_tick_, at.tick + (at.off > kSame ? 1 : 0));
  }
  while (next_tick_ <= last) ticks_.push_back(next_tick_++);
  return {};
}

/// Nothing that comes later changes what is known at the tick.
bool CsvTimeline::is_ready(std::int64_t tick) const {
  const Instant at{tick, 0};
  if (now_.since(at) < kSame) return false;
  return std::ranges::all_of(channels_, [&](const SampleTrack<Instant>& track) {
    return track.is_empty() ? now_.since(at) > gap_ : track.is_settled(at, now_);
  });
}

CsvResult<void> CsvTimeline::emit(bool is_end) {
  while (!ticks_.empty() && (is_end || is_ready(ticks_.front()))) {
    const std::int64_t tick = ticks_.front();
    ticks_.pop_front();
    TACTUS_CHECK(write(tick));
  }
  return {};
}

/// out  false: the channel has no sample within the gap; then `out` is the nearest one, if there is any
bool CsvTimeline::sample_at(std::size_t channel, std::int64_t tick, RigidSample& out) {
  SampleTrack<Instant>& track = channels_[channel];
  track.move_to({tick, 0});
  if (track.is_empty()) return false;
  out = track.value();
  out.pose = track.pose();
  using Relation = SampleTrack<Instant>::Relation;
  if (track.relation() == Relation::on) return true;
  if (track.relation() == Relation::between) largest_gap_ = std::max(largest_gap_, track.span());
  const bool is_border =
      track.relation() == Relation::before || (ended_ && track.next() == nullptr);  // else the next is too far away
  const bool is_known = track.is_known() || (is_border && track.is_held());
  made_ += is_known;
  return is_known;
}

CsvResult<void> CsvTimeline::write(std::int64_t tick) {
  if (!budget_.spend(sizeof(RigidSample) * channels_.size()))
    return tl::unexpected(mistake(Errc::limit_exceeded, "R-CSV-9", 0, "", "Give a smaller --gap or --tick-rate."));
  std::size_t known = 0;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const CsvChannel& plan = plan_.channels[i % plan_.channels.size()];
    const auto subject = static_cast<std::uint32_t>(i / plan_.channels.size());
    const std::uint32_t index = plan.index + subject * (plan_.object ? 1 : 0);
    RigidSample sample;
    const bool is_known = sample_at(i, tick, sample);
    known += is_known;
    if (plan.kind == CsvChannel::Kind::object) {
      if (!channels_[i].is_empty() || begins_) frame_.objects[index] = sample;
      continue;
    }
    UserSample& user = frame_.users[index];
    if (plan.kind == CsvChannel::Kind::force) user.force = user.server_force = channels_[i].vector();
    else if (!channels_[i].is_empty()) {
      user.device.position = sample.pose.position;
      user.device.orientation = sample.pose.rotation;
    }
  }
  if (known == 0) return ++left_out_, CsvResult<void>();
  rested_ += channels_.size() - known;
  if (done_.ticks.count() == 0) shift_ = -tick;
  frame_.tick = base_ + shift_ + tick;
  if (frame_.tick < 0) return tl::unexpected(mistake(Errc::invalid, "R-CSV-5", 0, ""));
  for (UserSample& user : frame_.users) user.contact = {}, user.contact.device = user.device.position;
  contacts_.apply(frame_);
  derive_motion(frame_, begins_);
  if (const auto written = writer_->write(frame_); !written)
    return tl::unexpected(
        Diagnostic{.error = written.error(),
                   .detail = "time " + number_text(static_cast<double>(frame_.tick) / plan_.info.tick_rate) + " s"});
  done_.ticks.add(frame_.tick);
  if (!begins_) check_angular_velocity(frame_);
  if (begins_) ++done_.segments;
  begins_ = false;
  before_ = frame_;
  return {};
}

/// Backward differences: what a live system would know at that tick.
void CsvTimeline::derive_motion(TraceFrame& frame, bool begins) const {
  const double seconds = begins ? 0 : static_cast<double>(frame.tick - before_.tick) / plan_.info.tick_rate;
  for (std::size_t i = 0; i < frame.objects.size(); ++i) {
    const auto of = [&](const CsvChannel& c) { return c.kind == CsvChannel::Kind::object && (plan_.object || c.index == i); };
    const CsvChannel& channel = *std::ranges::find_if(plan_.channels, of);
    RigidSample& sample = frame.objects[i];
    const Twist motion = begins ? Twist{} : motion_between(before_.objects[i].pose, sample.pose, seconds);
    if (!channel.has_velocity) sample.velocity = motion.linear;
    if (!channel.has_angular_velocity && channel.turn != CsvChannel::Turn::none) sample.angular_velocity = motion.angular;
  }
}

/// Hold the angular velocity that was read against the turn since the frame before.
void CsvTimeline::check_angular_velocity(const TraceFrame& frame) {
  const CsvChannel& channel = plan_.channels[0];
  if (frame.objects.empty() || !channel.has_angular_velocity || channel.turn == CsvChannel::Turn::none) return;
  const RigidSample& sample = frame.objects[0];
  const double seconds = static_cast<double>(frame.tick - before_.tick) / plan_.info.tick_rate;
  const Vec3 seen = motion_between(before_.objects[0].pose, sample.pose, seconds).angular, given = sample.angular_velocity;
  if (norm(seen) * seconds > std::numbers::pi / 2 || norm(given) * seconds > std::numbers::pi / 2) return;
  const bool is_body = mapping_.angular_velocity_frame == AngularVelocityFrame::body;
  const Quat& q = sample.pose.rotation;
  AngularVelocityCheck& check = done_.angular_velocity;
  const auto take = [fraction = 1.0 / static_cast<double>(++check.rows)](double& mean, double value) {
    mean += fraction * (value - mean);
  };
  take(check.given, norm(given));
  take(check.off, norm(seen - given));
  take(check.off_other, norm(seen - rotate(is_body ? conjugate(q) : q, given)));
}

}  // namespace tactus
