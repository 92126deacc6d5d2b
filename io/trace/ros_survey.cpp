// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/ros_survey.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/base/shown.h>

namespace tactus {
namespace {

using Kind = RosSource::Kind;

constexpr double kLeastGap = 0.1, kMostGap = 10, kGapsOfMedian = 3;  // [s], [s], medians
constexpr double kSlow = 10;                                         // [1/s]
constexpr double kStray = 60, kOtherEpoch = 3e7;                     // [s] between log times that do not belong together
constexpr std::size_t kMostStrays = 4096;
constexpr double kSwing = 1e-3;  // [m] shortest path to and fro between positions

std::string text(double value, const char* format = "%.6g") {
  std::array<char, 40> out{};
  std::snprintf(out.data(), out.size(), format, value);
  return out.data();
}

std::string seconds(double value) { return text(value, "%.3f") + " s"; }
std::string counted(std::uint64_t count, const char* one) { return std::to_string(count) + " " + one + (count == 1 ? "" : "s"); }

RuleName rule_of(RosFault fault) noexcept {
  if (fault == RosFault::malformed) return "R-TRC-13";
  if (fault == RosFault::encoding) return "R-TRC-7";
  if (fault == RosFault::own_parent || fault == RosFault::no_name) return "R-TRC-16";
  if (fault == RosFault::impossible_time) return "R-TRC-15";
  return "R-TRC-14";
}

Errc class_of(RosFault fault) noexcept {
  if (fault == RosFault::malformed) return Errc::malformed;
  const bool is_unsupported = fault == RosFault::encoding || fault == RosFault::own_parent || fault == RosFault::no_name;
  return is_unsupported ? Errc::unsupported : Errc::invalid;
}

}  // namespace

std::string RosSurvey::location_of(std::uint32_t source) const {
  const RosSource& s = samples_.sources()[source];
  if (s.kind == Kind::link) return "frame " + samples_.name(s.child) + " of " + s.topic;
  return s.kind == Kind::twist && s.is_odometry ? "twist of " + s.topic : s.topic;
}

std::string RosSurvey::text_of_time(std::uint64_t log) const {
  const double since = 1e-9 * static_cast<double>(static_cast<std::int64_t>(log - log_start_));
  return "at " + seconds(since);
}

void RosSurvey::add(const RosSample& sample) {
  if (facts_.size() < samples_.sources().size()) facts_.resize(samples_.sources().size());
  if (sample.fault != RosFault::none || samples_.sources()[sample.source].is_static) return take(sample);
  if (!pending_.empty() && pending_.front().ordinal != sample.ordinal) settle(sample.log);
  pending_.push_back(sample);
}

/// A log time that fits neither the messages around it nor its source is none: 0, or that of an unset clock.   in  next  of the message after
void RosSurvey::settle(std::optional<std::uint64_t> next) {
  if (pending_.empty()) return;
  const RosSample& sample = pending_.front();
  const auto apart = [](std::uint64_t a, std::uint64_t b) { return 1e-9 * static_cast<double>(a < b ? b - a : a - b); };
  const auto own = own_log_.find(sample.source);
  bool is_stray = false;
  if (last_log_ && next)
    is_stray = apart(*last_log_, sample.log) > kStray && apart(*next, sample.log) > kStray && apart(*last_log_, *next) < kStray &&
               (own == own_log_.end() || apart(own->second, sample.log) > kStray);
  else if (last_log_ || next) is_stray = apart(last_log_ ? *last_log_ : *next, sample.log) > kOtherEpoch;
  own_log_[sample.source] = sample.log;
  if (is_stray && strays_.size() < kMostStrays) {
    const std::uint64_t before = last_log_ ? *last_log_ : *next, after = next ? *next : before;
    strays_[sample.ordinal] = std::min(before, after) + (std::max(before, after) - std::min(before, after)) / 2;
    for (RosSample& one : pending_) one.log = strays_[sample.ordinal];
  }
  last_log_ = sample.log;
  for (const RosSample& one : pending_) take(one);
  pending_.clear();
}

std::uint64_t RosSurvey::log_of(const RosSample& sample) const {
  const auto found = strays_.find(sample.ordinal);
  return found == strays_.end() ? sample.log : found->second;
}

void RosSurvey::take(const RosSample& sample) {
  if (sample.fault != RosFault::none) {
    Seen& seen = faults_[{sample.source, sample.fault}];
    if (seen.count++ == 0) seen.log = sample.log;
    if (!first_fault_) first_fault_ = sample;
    return;
  }
  const RosSource& source = samples_.sources()[sample.source];
  if (!source.is_static) steps_.add(sample.ordinal, sample.source, sample.log);
  add_good(sample, static_cast<std::uint64_t>(static_cast<std::int64_t>(sample.log) + steps_.added()));
}

void RosSurvey::add_motion(SourceFacts& facts, const RosSample& sample) const {
  const RigidSample &value = sample.value, &first = facts.first->value;
  facts.speed = std::max({facts.speed, norm(value.velocity), norm(value.angular_velocity)});
  if (samples_.sources()[sample.source].kind != Kind::pose && samples_.sources()[sample.source].kind != Kind::link) return;
  facts.moved = std::max(facts.moved, norm(value.pose.position - first.pose.position));
  facts.turned = std::max(facts.turned, angle_between(first.pose.rotation, value.pose.rotation));
  const double there = norm(value.pose.position - facts.before), back = norm(value.pose.position - facts.before_that);
  if (facts.samples > 2 && sample.frame == facts.last_parent && there > kSwing && back < 0.1 * there) {
    ++facts.returns;
    facts.return_distance = std::max(facts.return_distance, there);
  }
  facts.before_that = std::exchange(facts.before, value.pose.position);
}

void RosSurvey::add_good(const RosSample& sample, std::uint64_t log) {
  SourceFacts& facts = facts_[sample.source];
  facts.log.add(log);
  const auto lag = static_cast<std::int64_t>(log - sample.stamp);
  if (sample.stamp == 0) ++facts.stampless;
  else {
    facts.least_lag = facts.stamps.count() == 0 ? lag : std::min(facts.least_lag, lag);
    facts.most_lag = facts.stamps.count() == 0 ? lag : std::max(facts.most_lag, lag);
    facts.stamps.add(sample.stamp);
  }
  if (sample.ignored) {
    Seen& seen = ignored_[sample.source];
    if (seen.count++ == 0) seen.log = log;
  }
  if (facts.samples++ == 0) {
    facts.first = sample;
  } else if (facts.last_parent != sample.frame) {
    Change& change = changes_[sample.source];
    if (change.count++ == 0) change = {1, sample.log, facts.last_parent, sample.frame};
  }
  add_motion(facts, sample);
  facts.last_parent = sample.frame;
}

/// A recording is refused if nothing of it can be used, or anything is wrong and that was asked for.
tl::expected<void, Diagnostic> RosSurvey::check() const {
  const bool any = std::ranges::any_of(samples_.sources(), [&](const RosSource& s) {
    return s.kind != Kind::twist && facts_[static_cast<std::size_t>(&s - samples_.sources().data())].samples > 0;
  });
  if (first_fault_ && (options_.strict || !any)) {
    const RosFault fault = first_fault_->fault;
    return tl::unexpected(Diagnostic{.error = fail(class_of(fault), rule_of(fault)).value(),
                                     .detail = location_of(first_fault_->source) + ", " + text_of_time(first_fault_->log),
                                     .cause = text_of(fault),
                                     .remedy = options_.strict ? "Without --strict such samples count as missing."
                                                               : "No sample of the recording can be used: check what wrote it."});
  }
  return {};
}

tl::expected<void, Diagnostic> RosSurvey::end(const mcap::Reader& mcap) {
  settle({});
  facts_.resize(samples_.sources().size());
  steps_.end();
  const auto& sources = samples_.sources();
  bool any = false, several = false;
  log_start_ = std::numeric_limits<std::uint64_t>::max();
  for (std::size_t i = 0; i < sources.size(); ++i) {
    any = any || (sources[i].kind != Kind::twist && facts_[i].samples > 0);
    several = several || (!sources[i].is_static && facts_[i].samples > 1);
    if (facts_[i].samples > 0 && !sources[i].is_static) log_start_ = std::min(log_start_, facts_[i].log.first());
  }
  if (log_start_ == std::numeric_limits<std::uint64_t>::max()) log_start_ = first_fault_ ? first_fault_->log : 0;
  TACTUS_CHECK(check());
  if (!any) {
    std::string detail;
    for (const auto& other : samples_.others(mcap))
      detail += (detail.empty() ? "it has " : ", ") + counted(other.topics, "topic") + " of " + shown(other.type);
    if (detail.empty()) detail = "it has no messages of poses, transforms or forces";
    if (mcap.cut_short() && !first_fault_) return tl::unexpected(Diagnostic{.error = fail(Errc::truncated, "R-TRC-3").value()});
    return tl::unexpected(Diagnostic{.error = fail(Errc::unsupported, "R-TRC-16").value(), .cause = detail});
  }
  moving_.assign(sources.size(), false);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const bool counts = facts_[i].samples > 0 && !(sources[i].is_static && several);
    moving_[i] = counts && (facts_[i].samples > 1 || !several);
  }
  clock_.choose(facts_, moving_, options_.stamps);
  find_start();
  return {};
}

void RosSurvey::find_start() {
  const auto& sources = samples_.sources();
  start_ = std::numeric_limits<std::uint64_t>::max();
  if (std::ranges::find(moving_, true) != moving_.end()) log_start_ = start_;
  std::uint64_t most = 0;
  gaps_.assign(sources.size(), static_cast<std::uint64_t>(1e9 * kLeastGap));
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    if (!moving_[i]) continue;
    log_start_ = std::min(log_start_, facts_[i].log.first());
    const auto timing = clock_.timing(i, facts_);
    gaps_[i] = static_cast<std::uint64_t>(
        1e9 * (options_.gap > 0 ? options_.gap
                                : std::clamp(kGapsOfMedian * std::max(timing.median, timing.period), kLeastGap, kMostGap)));
    const std::uint64_t first =
        clock_.takes_stamp(i) ? facts_[i].stamps.first() + static_cast<std::uint64_t>(clock_.offset(i)) : facts_[i].log.first();
    start_ = std::min(start_, first);
    const bool is_better = sources[i].kind != Kind::twist && facts_[i].samples > most;
    if (is_better) most = facts_[i].samples, densest_ = i;
  }
  if (start_ == std::numeric_limits<std::uint64_t>::max()) start_ = log_start_;
  tick_rate_ = options_.tick_rate > 0 ? options_.tick_rate : rate_of(clock_.timing(densest_, facts_));
}

// ==== notes ====

void RosSurvey::add_notes(const mcap::Reader& mcap, bool whole, ReadNotes& notes) {
  if (!whole)
    notes.add("",
              "read from a pipe: topics, rates, clocks and frames are those of its first samples; give the file itself to have "
              "all of them seen");
  note_clock(notes);
  note_rate(notes);
  for (std::uint32_t i = 0; i < facts_.size(); ++i) note_source(i, notes);
  note_frames(notes);
  note_topics(mcap, notes);
}

void RosSurvey::note_clock(ReadNotes& notes) const {
  if (!strays_.empty())
    notes.add("", "a message with a log time far from those around: taken between them",
              "message " + std::to_string(strays_.begin()->first), strays_.size());
  for (const auto& step : steps_.steps()) {
    const std::int64_t before = steps_.added_at(step.ordinal - 1);
    notes.add("",
              std::string("the clock was set ") + (step.added > before ? "back" : "forward") + " by " +
                  seconds(1e-9 * std::abs(static_cast<double>(step.added - before))) + "; what follows goes on there",
              text_of_time(step.at));
  }
  if (steps_.disorder() > 0)
    notes.add("", "messages cross in time by up to " + seconds(1e-9 * static_cast<double>(steps_.disorder())) + "; sorted");
  note_stamps(notes);
  for (std::uint32_t i = 0; i < facts_.size(); ++i) {
    if (!moving_[i] || facts_[i].samples < 8 || facts_[i].stampless > 0) continue;
    const double log = facts_[i].log.length(), stamps = facts_[i].stamps.length();
    const double slack = 2 * facts_[i].log.timing().bursts * facts_[i].log.timing().period;
    if (std::abs(log - stamps) > 0.01 * std::max(log, stamps) + slack)
      notes.add(location_of(i),
                "log times span " + seconds(log) + ", header stamps " + seconds(stamps) + "; check which clock is right");
  }
}

void RosSurvey::note_stamps(ReadNotes& notes) const {
  double least = 0, most = 0;
  bool any = false;
  for (std::uint32_t i = 0; i < facts_.size(); ++i) {
    const SourceFacts& facts = facts_[i];
    if (!moving_[i]) continue;
    const auto log = facts.log.timing();
    const std::string bursts = log.in_bursts() ? "log times come in bursts of " + text(log.bursts, "%.0f") : "log times jitter";
    if (clock_.takes_stamp(i)) {
      const double offset = 1e-9 * static_cast<double>(clock_.offset(i));
      notes.add(location_of(i),
                "header stamps taken: " + (options_.stamps == RosStamps::header ? std::string("as asked for") : bursts) +
                    (offset != 0 ? "; they are of another clock, moved by " + seconds(offset) : ""));
    } else if (clock_.spreads(i)) {
      notes.add(location_of(i),
                bursts + " and header stamps do not help: samples are spread evenly, " + text(1 / log.period) + " per second");
    } else if (clock_.takes_stamps()) {
      notes.add(location_of(i), "log times taken: header stamps are missing or fall");
    } else if (facts.stamps.count() > 0) {
      least = any ? std::min(least, 1e-9 * static_cast<double>(facts.least_lag)) : 1e-9 * static_cast<double>(facts.least_lag);
      most = any ? std::max(most, 1e-9 * static_cast<double>(facts.most_lag)) : 1e-9 * static_cast<double>(facts.most_lag);
      any = true;
    }
  }
  const bool is_ahead = most < 0;
  if (is_ahead) least = -std::exchange(most, -least);
  if (any && (least != 0 || most != 0))
    notes.add("", "log times are the clock; header stamps, which are " + text(least, "%.9g") + " to " + text(most, "%.9g") +
                      " s " + (is_ahead ? "after" : "before") + " them, are ignored");
}

void RosSurvey::note_rate(ReadNotes& notes) const {
  const auto timing = clock_.timing(densest_, facts_);
  if (!moving_[densest_] || !(timing.period > 0)) return;
  const double rate = 1 / timing.period;
  if (options_.tick_rate == 0 && rate < kSlow)
    notes.add(location_of(densest_), "only " + text(rate) + " samples per second: check the unit of the times, or give --rate");
  const double length = clock_.takes_stamp(densest_) ? facts_[densest_].stamps.length() : facts_[densest_].log.length();
  const double expected = length * rate + 1;
  if (static_cast<double>(facts_[densest_].samples) < 0.5 * expected)
    notes.add(location_of(densest_),
              "more than half of the time nothing is recorded: check the unit of the times, or give --rate");
  for (std::uint32_t i = 0; i < facts_.size(); ++i) {
    const auto own = clock_.timing(i, facts_);
    if (!moving_[i] || !(own.period > 0) || std::abs(tick_rate_ * own.period - 1) <= 0.1) continue;
    const Kind kind = samples_.sources()[i].kind;
    const bool is_curve = (kind == Kind::pose || kind == Kind::link) && tick_rate_ * own.period > 1.5;
    notes.add(location_of(i), text(1 / own.period, "%.4g") + " samples per second are interpolated to " +
                                  std::to_string(tick_rate_) + " ticks" +
                                  (is_curve ? ", on parabolas where the motion bends alike at neighbours, else on lines" : ""));
  }
}

void RosSurvey::note_source(std::uint32_t source, ReadNotes& notes) const {
  const SourceFacts& facts = facts_[source];
  const Kind kind = samples_.sources()[source].kind;
  for (const auto& [key, seen] : faults_)
    if (key.first == source)
      notes.add(location_of(source), std::string("a sample is missing: ") + text_of(key.second), text_of_time(seen.log),
                seen.count);
  if (const auto found = ignored_.find(source); found != ignored_.end())
    notes.add(location_of(source), kind == Kind::force ? "torques are ignored" : "covariances are ignored");
  if (const auto copies = samples_.copies().find(source); copies != samples_.copies().end())
    notes.add(location_of(source), "a sample with the stamp and the value of the one before: left out", {}, copies->second);
  if (facts.swings())
    notes.add(location_of(source), "its samples go to and fro between two positions, up to " +
                                       text(facts.return_distance, "%.3g") +
                                       " m apart, as of two publishers: let each have a topic of its own");
  if (facts.samples == 0) return;
  if (!moving_[source]) return note_rest(source, notes);
  const GapStatistics& times = clock_.takes_stamp(source) ? facts.stamps : facts.log;
  if (times.equal() > 0 && !clock_.spreads(source))
    notes.add(location_of(source), "a sample at the time of the one before: of equal times the last counts", {}, times.equal());
  if (facts.log.backward() > 0)
    notes.add(location_of(source),
              "a time before the one that stands before, by up to " +
                  seconds(1e-9 * static_cast<double>(facts.log.farthest_back())) + "; sorted",
              {}, facts.log.backward());
  note_gaps(source, notes);
}

/// Of what is published once, or by a static transform.
void RosSurvey::note_rest(std::uint32_t source, ReadNotes& notes) const {
  const SourceFacts& facts = facts_[source];
  if (facts.log.first() > log_start_ + gaps_[source])
    notes.add(location_of(source),
              std::string("is published ") + text_of_time(facts.log.first()) + "; it holds from the beginning");
  if (facts.moved > 0 || facts.turned > 0) notes.add(location_of(source), "is published with another value; it jumps then");
}

void RosSurvey::note_gaps(std::uint32_t source, ReadNotes& notes) const {
  const SourceFacts& facts = facts_[source];
  const Kind kind = samples_.sources()[source].kind;
  const GapStatistics& times = clock_.takes_stamp(source) ? facts.stamps : facts.log;
  const double gap = 1e-9 * static_cast<double>(gaps_[source]);
  const bool is_force = kind == Kind::force;
  const char* before = is_force ? "before, the force is 0" : "before, it stands at its first pose";
  const auto& densest = clock_.takes_stamp(densest_) ? facts_[densest_].stamps : facts_[densest_].log;
  if (kind != Kind::twist && facts.log.first() > log_start_ + gaps_[source])
    notes.add(location_of(source), std::string("begins ") + text_of_time(facts.log.first()) + "; " + before);
  if (kind != Kind::twist && times.last() + gaps_[source] < densest.last() &&
      clock_.takes_stamp(source) == clock_.takes_stamp(densest_))
    notes.add(location_of(source),
              "ends " + text_of_time(facts.log.last()) + (is_force ? "; after, the force is 0" : "; after, it rests"));
  if (!clock_.spreads(source) && times.largest() > gap)
    notes.add(location_of(source),
              "a gap longer than " + text(gap, "%.3g") + " s, the largest " + seconds(times.largest()) +
                  (is_force ? ": the force is held for as long, then 0" : ": it rests there"),
              {}, times.longer_than(gap));
}

void RosSurvey::note_frames(ReadNotes& notes) {
  const auto& sources = samples_.sources();
  for (const auto& [source, change] : changes_) {
    const bool is_link = sources[source].kind == Kind::link;
    notes.add(location_of(source),
              std::string(is_link ? "hangs on another frame: " : "is expressed in another frame: ") + samples_.name(change.to) +
                  ", before on " + samples_.name(change.from) + "; followed",
              text_of_time(change.log), change.count);
  }
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    if (facts_[i].samples == 0) continue;
    const auto link = samples_.link_of(sources[i].space, facts_[i].first->frame);
    if (link && sources[*link].child != facts_[i].first->frame)
      notes.add(location_of(i), "frame '" + samples_.name(facts_[i].first->frame) + "' is taken for '" +
                                    samples_.name(sources[*link].child) + "' of " + sources[*link].topic);
  }
  std::map<std::string, std::vector<std::uint32_t>> roots;  // frames that are taken for the world
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    if (facts_[i].samples == 0) continue;
    const std::uint32_t frame = facts_[i].first->frame;
    const std::string& name = samples_.name(frame);
    const bool hangs = samples_.link_of(sources[i].space, frame).has_value();
    if (sources[i].kind == Kind::pose && !hangs) roots[name].push_back(i);
    if (sources[i].kind == Kind::link && !hangs) roots[name].push_back(i);
    if (sources[i].kind == Kind::twist && !hangs)
      notes.add(location_of(i), "frame '" + name + "' is in no tree: the twist is taken " +
                                    (sources[i].is_odometry ? "in the frame of the pose" : "in the world"));
  }
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    if (sources[i].kind != Kind::force || facts_[i].samples == 0) continue;
    const std::uint32_t frame = facts_[i].first->frame;
    if (roots.contains(samples_.name(frame)) || samples_.is_in_tree(sources[i].space, frame)) continue;
    notes.add(location_of(i), "frame '" + samples_.name(frame) +
                                  "' is in no tree: the force is not turned, and acts at the topic beside, if there is one");
  }
  for (const auto& [name, which] : roots) {
    if (roots.size() == 1) {
      notes.add("", "frame '" + name + "' is the world");
      continue;
    }
    std::set<std::string> noted;
    for (const std::uint32_t i : which)
      if (noted.insert(location_of(i)).second)
        notes.add(location_of(i), "hangs on frame '" + name + "', of which nothing is known: taken for the world, like others");
  }
}

void RosSurvey::note_topics(const mcap::Reader& mcap, ReadNotes& notes) const {
  for (const auto& [topic, channels] : samples_.channels())
    if (channels > 1) notes.add(topic, "comes on " + counted(static_cast<std::uint64_t>(channels), "channel") + "; taken as one");
  std::string text;
  for (const auto& other : samples_.others(mcap))
    text += (text.empty() ? "" : ", ") + counted(other.topics, "topic") + " of " + other.type + " (" + other.first + ")";
  if (!text.empty()) notes.add("", "not read: " + text);
}

}  // namespace tactus
