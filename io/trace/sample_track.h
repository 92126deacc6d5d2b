// SPDX-License-Identifier: Apache-2.0
/// Samples of one quantity around a time, where some are missing or come at another rate than ticks: one rule for tables, ROS 2 recordings
/// and arrays. Internal to the library.
///
/// Between two samples that are not farther apart than the gap, values follow a line and rotations the shorter arc. Elsewhere the value is
/// that of the first sample ahead of it, of the last one behind it, and between two that are too far apart that of the one before, without
/// velocity. What has no place to rest at, as a force, is 0 where no such sample is within the gap. Of samples with the same time the last
/// counts.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>

#include <tactus/rigid/rigid_state.h>
#include <tactus/trace/differences.h>
#include <tactus/trace/interpolation.h>

namespace tactus {

/// [ns]
inline double since(std::int64_t time, std::int64_t other) noexcept { return static_cast<double>(time - other); }

/// in  Time  what since(Time, Time) gives the distance of, as a double in any unit
template <class Time>
class SampleTrack {
 public:
  struct Sample {
    Time at{};
    RigidSample value{};      ///< a vector alone has its place in the position
    std::uint32_t frame = 0;  ///< in which it is told: samples of different frames have nothing between them
  };
  struct Limits {
    double gap = 0;   ///< longest distance between two samples that is interpolated over
    double same = 0;  ///< up to here times are the same
    double tick = 0;  ///< shortest span over which a velocity is taken
  };
  enum class Place : std::uint8_t {
    nowhere,  ///< there is no sample
    before,   ///< the first
    on,       ///< a sample
    between,  ///< two samples
    after,    ///< a sample, and no other one within the gap
  };

  SampleTrack() = default;
  explicit SampleTrack(const Limits& limits) : limits_(limits) {}
  /// pre  times do not fall
  void add(const Sample& sample) {
    has_slopes_ = false;
    if (!samples_.empty() && since(sample.at, samples_.back().at) <= limits_.same) samples_.back() = sample;
    else samples_.push_back(sample);
  }
  void clear() noexcept { samples_.clear(), at_ = 0, has_slopes_ = false, place_ = Place::nowhere; }
  /// pre  times do not fall
  void move_to(const Time& time);

  Place place() const noexcept { return place_; }
  bool is_known() const noexcept { return place_ == Place::on || place_ == Place::between; }
  /// The value is that of a sample at another time, no farther away than the gap.
  bool is_held() const noexcept {
    const bool is_beside = place_ == Place::before || place_ == Place::after;
    return is_beside && std::abs(since(time_, samples_[at_].at)) <= limits_.gap;
  }
  /// A sample is so near, or two are around.
  bool is_near(double most) const noexcept;
  /// Distance of the two samples around.   pre  place() is between
  double span() const noexcept { return since(samples_[at_ + 1].at, samples_[at_].at); }
  std::uint32_t frame() const noexcept { return samples_[at_].frame; }
  /// pre  place() is not nowhere
  RigidSample value() const noexcept;
  /// The sample before, as it was told, or the first.   pre  likewise
  const RigidSample& last() const noexcept { return samples_[at_].value; }
  /// Of what is 0 where nothing is known.
  Vec3 vector() const noexcept { return is_known() || is_held() ? value().pose.position : Vec3{}; }
  /// With velocities that follow from the poses: at a sample over the two beside it, between samples on the line between theirs. So a
  /// quantity that comes more seldom than ticks has velocities as smooth as its motion, not the steps of its chords.
  /// in  seconds  of a unit of time
  RigidSample moving(double seconds) noexcept;

  const Sample* next() const noexcept;  ///< behind the time
  bool is_empty() const noexcept { return samples_.empty(); }
  const Sample* newest() const noexcept { return samples_.empty() ? nullptr : &samples_.back(); }
  /// Nothing that comes later changes what is said at `time`, if it lies behind `known`.
  bool is_settled(const Time& time, const Time& known) const noexcept;

 private:
  bool are_joined(std::size_t a, std::size_t b) const noexcept {
    return samples_[a].frame == samples_[b].frame && since(samples_[b].at, samples_[a].at) <= limits_.gap + limits_.same;
  }
  Twist slope(std::size_t at, double seconds) const noexcept;

  Limits limits_;
  std::deque<Sample> samples_;
  std::size_t at_ = 0;  // the last one not behind the time, or the first
  Time time_{};
  Place place_ = Place::nowhere;
  double share_ = 0;
  bool has_slopes_ = false;
  Twist from_, to_;
};

template <class Time>
void SampleTrack<Time>::move_to(const Time& time) {
  time_ = time;
  while (at_ + 1 < samples_.size() && since(samples_[at_ + 1].at, time) <= limits_.same) ++at_, has_slopes_ = false;
  while (at_ > 1 && 2 * since(samples_[at_].at, samples_[1].at) >= limits_.tick) samples_.pop_front(), --at_;
  share_ = 0;
  place_ = Place::nowhere;
  if (samples_.empty()) return;
  const double past = since(time, samples_[at_].at);
  if (std::abs(past) <= limits_.same) place_ = Place::on;
  else if (past < 0) place_ = Place::before;
  else if (at_ + 1 == samples_.size() || !are_joined(at_, at_ + 1)) place_ = Place::after;
  else place_ = Place::between, share_ = past / span();
}

template <class Time>
bool SampleTrack<Time>::is_near(double most) const noexcept {
  if (place_ == Place::nowhere || is_known()) return is_known();
  const Sample* after = next();
  return std::abs(since(time_, samples_[at_].at)) <= most || (after != nullptr && since(after->at, time_) <= most);
}

template <class Time>
RigidSample SampleTrack<Time>::value() const noexcept {
  if (place_ == Place::between) return mixed(samples_[at_].value, samples_[at_ + 1].value, share_);
  RigidSample value = samples_[at_].value;
  if (place_ != Place::on) value.velocity = value.angular_velocity = {};
  return value;
}

template <class Time>
RigidSample SampleTrack<Time>::moving(double seconds) noexcept {
  RigidSample value = this->value();
  if (!is_known()) return value;
  if (!has_slopes_) {
    from_ = slope(at_, seconds);
    to_ = at_ + 1 < samples_.size() ? slope(at_ + 1, seconds) : Twist{};
    has_slopes_ = true;
  }
  value.velocity = mixed(from_.linear, to_.linear, share_);
  value.angular_velocity = mixed(from_.angular, to_.angular, share_);
  return value;
}

/// From the nearest sample before that is half a tick away to such a one after; one of them, where the other is not joined.
template <class Time>
Twist SampleTrack<Time>::slope(std::size_t at, double seconds) const noexcept {
  const auto is_far = [&](std::size_t a, std::size_t b) {
    return a != b && 2 * since(samples_[b].at, samples_[a].at) >= limits_.tick;
  };
  std::size_t from = at, to = at;
  while (from > 0 && !is_far(from, at) && are_joined(from - 1, from)) --from;
  while (to + 1 < samples_.size() && !is_far(at, to) && are_joined(to, to + 1)) ++to;
  if (from == to) return {};
  return motion_between(samples_[from].value.pose, samples_[to].value.pose, seconds * since(samples_[to].at, samples_[from].at));
}

template <class Time>
auto SampleTrack<Time>::next() const noexcept -> const Sample* {
  for (std::size_t i = at_; i < samples_.size(); ++i)
    if (since(samples_[i].at, time_) > 0) return &samples_[i];
  return nullptr;
}

template <class Time>
bool SampleTrack<Time>::is_settled(const Time& time, const Time& known) const noexcept {
  std::size_t after = at_;
  while (after < samples_.size() && since(samples_[after].at, time) <= limits_.same) ++after;
  const Time& at = after < samples_.size() ? samples_[after].at : time;
  const double reach = limits_.gap + limits_.same + limits_.tick;
  return since(known, at) > reach ||
         (after < samples_.size() && since(samples_.back().at, at) > 0 && 2 * since(samples_.back().at, at) >= limits_.tick);
}

}  // namespace tactus
