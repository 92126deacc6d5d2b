// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/sim/user/hand.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::sim {
namespace {

constexpr double kTremorLow = 8, kTremorHigh = 12;  // [Hz]

HandImpedance varied(HandImpedance hand, double variation, Random& random) {
  hand.mass *= random.uniform(1 - variation, 1 + variation);
  hand.stiffness *= random.uniform(1 - variation, 1 + variation);
  hand.damping *= random.uniform(1 - variation, 1 + variation);
  return hand;
}

std::int64_t ticks(double duration) { return std::max<std::int64_t>(1, std::llround(duration / kTick)); }

Vec3 only(const Vec3& v, std::uint8_t axes) {
  return {axes & Dof::x ? v.x : 0, axes & Dof::y ? v.y : 0, axes & Dof::z ? v.z : 0};
}

double length_of(double x, double y) { return std::sqrt(x * x + y * y); }

/// Unit vector along the horizontal part of v; world x if there is none.
Vec3 horizontal(const Vec3& v) {
  const double length = length_of(v.x, v.y);
  return length > 1e-9 ? Vec3{v.x / length, v.y / length, 0} : Vec3{1, 0, 0};
}

/// The face normal (of either sign) that points most along world x.
Vec3 facing_x(const Quat& rotation) {
  Vec3 best{-1, 0, 0};
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Vec3 normal = rotate(rotation, axis);
    const Vec3 forward = normal.x < 0 ? -normal : normal;
    if (forward.x > best.x) best = forward;
  }
  return best;
}

}  // namespace

Tremor::Tremor(double rms, const HandImpedance& hand, Random& random) {
  const double position = rms * std::sqrt(2.0 / kSines);  // amplitude of each sine
  for (auto& axis : axes_) {
    for (Sine& wave : axis) {
      const double w = 2 * std::numbers::pi * random.uniform(kTremorLow, kTremorHigh);
      const double gain = length_of(hand.stiffness - hand.mass * w * w, hand.damping * w);  // force per displacement
      wave = {w, random.uniform(0, 2 * std::numbers::pi), position * gain};
    }
  }
}

Vec3 Tremor::force(double time) const noexcept {
  std::array<double, 3> out{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const Sine& wave : axes_[axis]) out[axis] += wave.amplitude * sine(wave.frequency * time + wave.phase);
  return {out[0], out[1], out[2]};
}

DeviceFilter::DeviceFilter(const SceneDevice& device, const Vec3& start)
    : resolution_(device.resolution), window_(device.filter) {
  for (std::size_t i = 0; i < window_.size(); ++i) read(start);
}

Vec3 DeviceFilter::read(const Vec3& position) noexcept {
  const auto step = [&](double v) { return resolution_ * std::round(v / resolution_); };
  window_[next_] = {step(position.x), step(position.y), step(position.z)};
  next_ = (next_ + 1) % window_.size();
  Vec3 sum;
  for (const Vec3& sample : window_) sum = sum + sample;
  return (1.0 / static_cast<double>(window_.size())) * sum;
}

Vec3 waypoint(PathFrame frame, const Vec3& to, const Pose& object, const Vec3& goal, const Vec3& hand) noexcept {
  if (frame == PathFrame::world) return to;
  if (frame == PathFrame::hand) return hand + to;
  const Vec3 x = horizontal(frame == PathFrame::object ? facing_x(object.rotation) : goal - object.position);
  const Vec3 y{-x.y, x.x, 0};
  const Vec3& origin = frame == PathFrame::at_goal ? goal : object.position;
  return origin + to.x * x + to.y * y + Vec3{0, 0, to.z};
}

Spiral::Spiral(const Vec3& from, const Vec3& to, const Vec3& centre, double turns)
    : centre_(centre),
      radius_(length_of(from.x - centre.x, from.y - centre.y)),
      height_(from.z),
      angle_(angle_of(from.y - centre.y, from.x - centre.x)),
      growth_(length_of(to.x - centre.x, to.y - centre.y) - radius_),
      rise_(to.z - from.z) {
  const double end = angle_of(to.y - centre.y, to.x - centre.x);
  constexpr double kTurn = 2 * std::numbers::pi;
  sweep_ = kTurn * turns + std::remainder(end - angle_, kTurn);
}

Aim Spiral::at(double fraction) const noexcept {
  const double radius = radius_ + fraction * growth_, angle = angle_ + fraction * sweep_;
  const Vec3 outward{cosine(angle), sine(angle), 0}, onward{-outward.y, outward.x, 0};
  return {Vec3{centre_.x, centre_.y, height_ + fraction * rise_} + radius * outward,
          growth_ * outward + (radius * sweep_) * onward + Vec3{0, 0, rise_}};
}

std::uint64_t hand_seed(std::uint64_t seed, std::size_t user) noexcept {
  Random seeds(seed);
  for (std::size_t i = 0; i < user; ++i) seeds.next();
  return seeds.next();
}

Hand::Hand(const SceneUser& user, Grip grip, std::uint64_t seed)
    : user_(user),
      random_(seed),
      impedance_(varied(hand_impedance(grip), user.variation, random_)),
      tremor_(user.tremor, impedance_, random_),
      filter_(user.device, user.start),
      position_(user.start),
      from_(user.start),
      to_(user.start) {
  for (PathPhase& phase : user_.path) {
    phase.duration *= user.duration_scale * random_.uniform(1 - user.variation, 1 + user.variation);
    for (double* part : {&phase.to.x, &phase.to.y, &phase.to.z}) *part += random_.uniform(-user.scatter, user.scatter);
  }
}

void Hand::begin_phase(const Pose& object) noexcept {
  if (tick_ < end_ || next_ == user_.path.size()) return;
  const PathPhase& phase = user_.path[next_++];
  from_ = to_;
  to_ = waypoint(phase.frame, phase.to, object, user_.goal, from_);
  if (phase.turns != 0) spiral_.emplace(from_, to_, waypoint(phase.frame, phase.centre, object, user_.goal, from_), phase.turns);
  else spiral_.reset();
  begin_ = tick_;
  end_ = begin_ + ticks(phase.duration);
}

DeviceSample Hand::step(const Vec3& rendered, const Pose& object) noexcept {
  begin_phase(object);
  const bool moving = tick_ < end_;
  const double duration = static_cast<double>(end_ - begin_) * kTick;
  const double fraction = moving ? static_cast<double>(tick_ - begin_) * kTick / duration : 1;
  const MinimumJerk done = minimum_jerk(fraction);
  Aim target{from_ + done.position * (to_ - from_), moving ? (done.slope / duration) * (to_ - from_) : Vec3{}};
  if (moving && spiral_) {
    target = spiral_->at(fraction);
    target.velocity = (1 / duration) * target.velocity;
  }
  aim_speed_ = norm(target.velocity);

  const Vec3 pull = impedance_.stiffness * (target.position - position_) + impedance_.damping * (target.velocity - velocity_);
  const Vec3 force = only(pull + rendered + tremor_.force(static_cast<double>(tick_) * kTick), user_.device.axes);
  velocity_ = velocity_ + (kTick / impedance_.mass) * force;
  position_ = position_ + kTick * velocity_;
  const bool held = moving && user_.path[next_ - 1].button;
  ++tick_;
  return {.position = filter_.read(position_), .buttons = held ? 1U : 0U};
}

}  // namespace tactus::sim
