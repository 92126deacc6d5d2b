// SPDX-License-Identifier: Apache-2.0
/// Samples of one quantity around a time, where some are missing or come at another rate than ticks: one rule for tables, ROS 2 recordings
/// and arrays. Internal to the library.
///
/// Between two samples that are not farther apart than the gap, values follow a line and rotations the shorter arc; poses a parabola in place
/// of them where the motion bends alike at both samples (Curve). Elsewhere the value is that of the first sample ahead of it, of the last one
/// behind it, and between two that are too far apart that of the one before, without velocity. What has no position to rest at, as a force, is 0
/// where no such sample is within the gap. Of samples with the same time the last counts.
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
/// Motion from one sample to the next. With h the time between them, v the velocity of their chord, u and w those of the chords before and
/// after, and b0, b1 the accelerations from u to v and from v to w, it has the constant acceleration
///   b = (b0 + b1)/2, so limited that |b| <= 2 |b0|, 2 |b1| and |b| h/2 <= |u - v|, |w - v|;  0 where b0 and b1 point apart
/// (the monotonised central limiter of van Leer 1977). So it is off its line by |b| h^2/8 at most, its velocity off that of the line by no
/// more than those beside are, and a motion that stops, begins, touches or jumps stays on its lines. At a sample it is where the sample is.
/// Where samples swing to and fro, as those of a noisy tracker do, the velocity is (u + 2v + w)/4: that of one chord is noise.
struct SampleCurve {
  struct Part {
    Vec3 chord, bend;  // v, b, of positions or of angular velocities
    Vec3 mean;         // (u + 2v + w)/4
    bool is_noise = false;
    Vec3 velocity(double h, double fraction) const noexcept { return is_noise ? mean : chord + ((fraction - 0.5) * h) * bend; }
    Vec3 off(double h, double fraction) const noexcept { return (-0.5 * h * h * fraction * (1 - fraction)) * bend; }
  };
  Part linear, angular;
  double span = 0;  ///< h

  /// in  before, after  times of the chords beside
  static Part part(const Vec3& u, const Vec3& v, const Vec3& w, double before, double h, double after) noexcept {
    constexpr double kAlike = 4;  // a jump is much faster than what is beside it, and at a stop one side rests
    const double gained = norm(v - u), lost = norm(w - v), from = std::max(h, (before + h) / 2),
                 to = std::max(h, (h + after) / 2);
    const Vec3 b = (1 / (before + h)) * (v - u) + (1 / (h + after)) * (w - v);
    Part out{v, {}, 0.25 * (u + w) + 0.5 * v};
    if (dot(v - u, w - v) > 0) out.bend = std::min(1.0, 2 * std::min(gained / from, lost / to) / norm(b)) * b;
    else out.is_noise = std::max(gained, lost) < kAlike * std::min({gained, lost, norm(u), norm(w)});
    return out;
  }
};

template <class Time>
class SampleTrack {
 public:
  struct Sample {
    Time at{};
    RigidSample value{};      ///< a vector alone is in the position
    std::uint32_t frame = 0;  ///< in which it is expressed: samples of different frames have nothing between them
  };
  struct Limits {
    double gap = 0;   ///< longest distance between two samples that is interpolated over
    double same = 0;  ///< up to here times are the same
    double tick = 0;  ///< shortest span over which a velocity is taken
  };
  enum class Relation : std::uint8_t {
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
    has_slopes_ = has_curve_ = false;
    if (!samples_.empty() && since(sample.at, samples_.back().at) <= limits_.same) samples_.back() = sample;
    else samples_.push_back(sample);
  }
  void clear() noexcept { samples_.clear(), at_ = 0, has_slopes_ = has_curve_ = false, relation_ = Relation::nowhere; }
  /// pre  times do not fall
  void move_to(const Time& time);

  Relation relation() const noexcept { return relation_; }
  bool is_known() const noexcept { return relation_ == Relation::on || relation_ == Relation::between; }
  /// The value is that of a sample at another time, no farther away than the gap.
  bool is_held() const noexcept {
    const bool is_beside = relation_ == Relation::before || relation_ == Relation::after;
    return is_beside && std::abs(since(time_, samples_[at_].at)) <= limits_.gap;
  }
  /// A sample is so near, or two are around.
  bool is_near(double most) const noexcept;
  /// Distance of the two samples around.   pre  relation() is between
  double span() const noexcept { return since(samples_[at_ + 1].at, samples_[at_].at); }
  std::uint32_t frame() const noexcept { return samples_[at_].frame; }
  /// On lines.   pre  relation() is not nowhere
  RigidSample value() const noexcept;
  /// On curves.   pre  likewise
  Pose pose() noexcept;
  /// The sample before, as it was published, or the first.   pre  likewise
  const RigidSample& last() const noexcept { return samples_[at_].value; }
  /// Of what is 0 where nothing is known.
  Vec3 vector() const noexcept { return is_known() || is_held() ? value().pose.position : Vec3{}; }
  /// On curves, with their velocities: those of what follows a sample. Of samples about as dense as ticks, velocities over the two beside a
  /// sample, and between samples on the line between theirs.
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
  bool is_sparse(std::size_t at) const noexcept {
    return at + 1 < samples_.size() && are_joined(at, at + 1) &&
           since(samples_[at + 1].at, samples_[at].at) > kSparse * limits_.tick;
  }
  std::size_t before(std::size_t at) const noexcept;
  std::size_t after(std::size_t at) const noexcept;
  Twist slope(std::size_t at, double seconds) const noexcept;
  const SampleCurve& curve() noexcept;

  static constexpr double kSparse = 1.5;  // ticks

  Limits limits_;
  std::deque<Sample> samples_;
  std::size_t at_ = 0;  // the last one not behind the time, or the first
  Time time_{};
  Relation relation_ = Relation::nowhere;
  double fraction_ = 0;
  bool has_slopes_ = false, has_curve_ = false;
  Twist from_, to_;
  SampleCurve curve_;
};

template <class Time>
void SampleTrack<Time>::move_to(const Time& time) {
  time_ = time;
  while (at_ + 1 < samples_.size() && since(samples_[at_ + 1].at, time) <= limits_.same) ++at_, has_slopes_ = has_curve_ = false;
  while (at_ > 1 && 2 * since(samples_[at_].at, samples_[1].at) >= limits_.tick) samples_.pop_front(), --at_;
  fraction_ = 0;
  relation_ = Relation::nowhere;
  if (samples_.empty()) return;
  const double past = since(time, samples_[at_].at);
  if (std::abs(past) <= limits_.same) relation_ = Relation::on;
  else if (past < 0) relation_ = Relation::before;
  else if (at_ + 1 == samples_.size() || !are_joined(at_, at_ + 1)) relation_ = Relation::after;
  else relation_ = Relation::between, fraction_ = past / span();
}

template <class Time>
bool SampleTrack<Time>::is_near(double most) const noexcept {
  if (relation_ == Relation::nowhere || is_known()) return is_known();
  const Sample* after = next();
  return std::abs(since(time_, samples_[at_].at)) <= most || (after != nullptr && since(after->at, time_) <= most);
}

template <class Time>
RigidSample SampleTrack<Time>::value() const noexcept {
  if (relation_ == Relation::between) return mixed(samples_[at_].value, samples_[at_ + 1].value, fraction_);
  RigidSample value = samples_[at_].value;
  if (relation_ != Relation::on) value.velocity = value.angular_velocity = {};
  return value;
}

template <class Time>
Pose SampleTrack<Time>::pose() noexcept {
  Pose pose = value().pose;
  if (relation_ != Relation::between || !is_sparse(at_)) return pose;
  const SampleCurve& motion = curve();
  pose.position = pose.position + motion.linear.off(motion.span, fraction_);
  if (motion.angular.bend != Vec3{}) pose.rotation = rotation_of(motion.angular.off(motion.span, fraction_)) * pose.rotation;
  return pose;
}

template <class Time>
RigidSample SampleTrack<Time>::moving(double seconds) noexcept {
  if (!is_known()) return value();
  RigidSample value{pose(), {}, {}};
  if (is_sparse(at_)) {
    const SampleCurve& motion = curve();
    value.velocity = (1 / seconds) * motion.linear.velocity(motion.span, fraction_);
    value.angular_velocity = (1 / seconds) * motion.angular.velocity(motion.span, fraction_);
    return value;
  }
  if (!has_slopes_) {
    from_ = slope(at_, seconds);
    to_ = at_ + 1 < samples_.size() ? slope(at_ + 1, seconds) : Twist{};
    has_slopes_ = true;
  }
  value.velocity = mixed(from_.linear, to_.linear, fraction_);
  value.angular_velocity = mixed(from_.angular, to_.angular, fraction_);
  return value;
}

/// Nearest sample before that is half a tick away, or the farthest that is joined; itself if none is.
template <class Time>
std::size_t SampleTrack<Time>::before(std::size_t at) const noexcept {
  std::size_t from = at;
  while (from > 0 && (from == at || 2 * since(samples_[at].at, samples_[from].at) < limits_.tick) && are_joined(from - 1, from))
    --from;
  return from;
}

template <class Time>
std::size_t SampleTrack<Time>::after(std::size_t at) const noexcept {
  std::size_t to = at;
  while (to + 1 < samples_.size() && (to == at || 2 * since(samples_[to].at, samples_[at].at) < limits_.tick) &&
         are_joined(to, to + 1))
    ++to;
  return to;
}

/// Over the two samples beside; of one, where the other is not joined.
template <class Time>
Twist SampleTrack<Time>::slope(std::size_t at, double seconds) const noexcept {
  const std::size_t from = before(at), to = after(at);
  if (from == to) return {};
  return motion_between(samples_[from].value.pose, samples_[to].value.pose, seconds * since(samples_[to].at, samples_[from].at));
}

/// From the sample at_ to the next.   pre  is_sparse(at_)
template <class Time>
const SampleCurve& SampleTrack<Time>::curve() noexcept {
  if (has_curve_) return curve_;
  const auto time = [&](std::size_t a, std::size_t b) { return since(samples_[b].at, samples_[a].at); };
  const auto chord = [&](std::size_t a, std::size_t b) {
    return motion_between(samples_[a].value.pose, samples_[b].value.pose, time(a, b));
  };
  const std::size_t first = before(at_), last = after(at_ + 1);
  const Twist motion = chord(at_, at_ + 1);
  curve_ = {{motion.linear, {}, {}}, {motion.angular, {}, {}}, time(at_, at_ + 1)};
  if (first != at_ && last != at_ + 1) {
    const Twist from = chord(first, at_), to = chord(at_ + 1, last);
    curve_.linear = SampleCurve::part(from.linear, motion.linear, to.linear, time(first, at_), curve_.span, time(at_ + 1, last));
    curve_.angular =
        SampleCurve::part(from.angular, motion.angular, to.angular, time(first, at_), curve_.span, time(at_ + 1, last));
  }
  has_curve_ = true;
  return curve_;
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
