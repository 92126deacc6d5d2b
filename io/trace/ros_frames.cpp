// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/ros_frames.h>

namespace tactus {
namespace {

constexpr double kNanosecond = 1e-9;  // [s]

}  // namespace

// ==== track ====

RosTrack::RosTrack(const std::optional<RosSample>& first, bool moves, std::uint64_t gap, std::uint64_t tick)
    : first_(first), track_({.gap = static_cast<double>(gap), .tick = static_cast<double>(tick)}), moves_(moves) {}

void RosTrack::add(const RosSample& sample) { track_.add({static_cast<std::int64_t>(sample.time), sample.value, sample.frame}); }

bool RosTrack::is_settled(std::uint64_t time, std::uint64_t known) const noexcept {
  return !moves_ || track_.is_settled(static_cast<std::int64_t>(time), static_cast<std::int64_t>(known));
}

std::optional<std::uint64_t> RosTrack::next_time() const noexcept {
  const auto* next = track_.next();
  return next == nullptr ? std::nullopt : std::optional(static_cast<std::uint64_t>(next->at));
}

RigidSample RosTrack::state() noexcept { return has_samples() ? track_.moving(kNanosecond) : first_->value; }

std::optional<Twist> RosTrack::twist(std::uint64_t near) const noexcept {
  const bool has_twist = track_.is_known() || (track_.relation() == Track::Relation::after && covers(near));
  if (!has_twist) return std::nullopt;
  const RigidSample sample = track_.is_known() ? track_.value() : track_.last();
  return Twist{sample.velocity, sample.angular_velocity};
}

// ==== frames ====

RigidSample hung(const RigidSample& frame, const RigidSample& own) noexcept {
  const Vec3 arm = rotate(frame.pose.rotation, own.pose.position);
  return {{frame.pose.position + arm, frame.pose.rotation * own.pose.rotation},
          frame.velocity + cross(frame.angular_velocity, arm) + rotate(frame.pose.rotation, own.velocity),
          frame.angular_velocity + rotate(frame.pose.rotation, own.angular_velocity)};
}

RosFrames::RosFrames(RosSamples& samples, std::vector<RosTrack>& tracks, ReadNotes& notes)
    : samples_(samples), tracks_(tracks), notes_(notes), states_(tracks.size()) {}

RigidSample RosFrames::at(std::uint32_t space, std::uint32_t frame) {
  const auto link = samples_.link_of(space, frame);
  return link ? of_link(*link) : RigidSample{};
}

RigidSample RosFrames::of_link(std::uint32_t link) {
  chain_.clear();
  RigidSample above;
  for (std::optional<std::uint32_t> at = link; at;) {
    State& state = states_[*at];
    if (state.computed == generation_) {
      above = state.placed;
      break;
    }
    if (state.seen == generation_ && !state.is_cut) {
      state.is_cut = true;
      notes_.add(samples_.name(samples_.sources()[*at].child),
                 "this frame hangs on itself by way of others: its transform is left out");
      for (const std::uint32_t one : chain_) states_[one].seen = 0;
      return of_link(link);
    }
    if (state.is_cut || !tracks_[*at].is_known()) break;
    state.seen = generation_;
    chain_.push_back(*at);
    at = samples_.link_of(samples_.sources()[*at].space, tracks_[*at].frame());
  }
  for (; !chain_.empty(); chain_.pop_back()) {
    above = hung(above, tracks_[chain_.back()].state());
    states_[chain_.back()].placed = above;
    states_[chain_.back()].computed = generation_;
    states_[chain_.back()].seen = 0;
  }
  return above;
}

}  // namespace tactus
