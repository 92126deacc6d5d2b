// SPDX-License-Identifier: Apache-2.0
#include "cli/live/rendered.h"

#include <algorithm>
#include <utility>

namespace tactus::cli {

// ==== rendered ====

TraceInfo RenderedNothing::info() const {
  TraceInfo info;
  info.users.push_back({.name = "hand", .forces = RecordedForces::rendered});
  return info;
}

tl::expected<Vec3, Failure> RenderedNothing::step(const device::ServoTick& tick, TraceFrame& frame) {
  frame.users.front().device = tick.reading.sample;
  return Vec3{};
}

// ==== rendered recording ====

namespace {

using device::Time;

constexpr Time kGrowth = 1000 * device::kMillisecond;  // until the spring has its whole stiffness
constexpr double kDamping = 2;                         // [N s/m] too little to make a device with coarse steps hum
constexpr double kSmoothing = 0.1;                     // of the speed, per tick

}  // namespace

RenderedRecording::RenderedRecording(device::Recording recording, Exerted exerted, double stiffness, double scale)
    : recording_(std::move(recording)), exerted_(exerted), stiffness_(stiffness), frame_{.scale = scale} {}

TraceInfo RenderedRecording::info() const {
  TraceInfo info;
  info.users.push_back({.name = recording_.user().name, .forces = RecordedForces::rendered});
  return info;
}

tl::expected<Vec3, Failure> RenderedRecording::step(const device::ServoTick& tick, TraceFrame& frame) {
  if (begin_ < 0 && tick.reading.state == device::Reading::State::valid) {
    begin_ = tick.due;
    frame_.origin = recording_.begin() - frame_.scale * tick.reading.sample.position;
    position_ = recording_.begin();
    position_at_ = tick.due;
  }
  const DeviceSample sample = frame_.to_world(tick.reading.sample);
  frame.users.front().device = sample;
  if (begin_ < 0) return Vec3{};
  const device::Recording::Moment moment = recording_.at(tick.due - begin_);
  is_over_ = moment.is_over;
  const Vec3 displacement = moment.sample.position - sample.position;
  const double distance = norm(displacement);
  sum_ += distance;
  largest_ = std::max(largest_, distance);
  ++ticks_;
  if (exerted_ == Exerted::path) return spring(displacement, sample.position, moment.into, tick.due);
  return exerted_ == Exerted::force ? moment.force : Vec3{};
}

/// It grows from nothing, also when the recording begins again and the hand is far away.
Vec3 RenderedRecording::spring(const Vec3& displacement, const Vec3& hand, Time into, Time now) noexcept {
  if (now > position_at_) {
    const Vec3 speed = (1e9 / static_cast<double>(now - position_at_)) * (hand - position_);
    speed_ = speed_ + kSmoothing * (speed - speed_);
    position_ = hand;
    position_at_ = now;
  }
  const double fraction = std::min(static_cast<double>(into) / static_cast<double>(kGrowth), 1.0);
  return fraction * (stiffness_ * displacement - kDamping * speed_);
}

RenderedRecording::Distance RenderedRecording::distance() const noexcept {
  return {ticks_ > 0 ? sum_ / static_cast<double>(ticks_) : 0, largest_};
}

// ==== rendered scene ====

RenderedScene::RenderedScene(const sim::Scene& scene, std::size_t user, std::uint64_t seed, const ChosenDevice& device)
    : scene_(scene), user_(user), seed_(seed), hand_(device.hand), frame_(device.frame) {}

Outcome RenderedScene::begin() {
  auto simulation = sim::Simulation::create(scene_, {.seed = seed_, .grip = {}, .channel = {}});
  if (!simulation) return refuse(scene_.name, simulation.error());
  simulation_.emplace(std::move(*simulation));
  show();
  return {};
}

tl::expected<Vec3, Failure> RenderedScene::step(const device::ServoTick& tick, TraceFrame& frame) {
  if (const auto stepped = simulation_->step(user_, frame_.to_world(tick.reading.sample)); !stepped)
    return refuse(stepped.error());
  frame = simulation_->frame();
  show();
  return frame.users[user_].force;
}

void RenderedScene::show() noexcept {
  if (hand_ != nullptr) hand_->watch(simulation_->watched(user_));
}

}  // namespace tactus::cli
