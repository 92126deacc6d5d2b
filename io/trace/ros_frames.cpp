// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/ros_frames.h>

#include <algorithm>

#include <tactus/trace/interpolation.h>

namespace tactus {

// ==== track ====

RosTrack::RosTrack(const std::optional<RosSample>& first, bool moves, std::uint64_t gap)
    : first_(first), moves_(moves), gap_(gap) {}

bool RosTrack::are_joined(const RosSample& a, const RosSample& b) const noexcept {
  return a.frame == b.frame && b.time - a.time <= gap_;
}

void RosTrack::move_to(std::uint64_t time) {
  time_ = time;
  while (samples_.size() > 1 && samples_[1].time <= time) {
    if (!are_joined(samples_[0], samples_[1])) ++jumps_;
    samples_.pop_front();
  }
  has_begun_ = !samples_.empty() && samples_.front().time <= time;
  is_between_ = has_begun_ && samples_.size() > 1 && are_joined(samples_[0], samples_[1]);
  share_ = 0;
  if (is_between_)
    share_ = static_cast<double>(time - samples_[0].time) / static_cast<double>(samples_[1].time - samples_[0].time);
}

bool RosTrack::covers(std::uint64_t near) const noexcept {
  if (is_between_) return true;
  const auto is_near = [&](const RosSample& s) { return (s.time > time_ ? s.time - time_ : time_ - s.time) <= near; };
  return (!samples_.empty() && is_near(samples_.front())) || (samples_.size() > 1 && is_near(samples_[1]));
}

std::optional<std::uint64_t> RosTrack::next_time() const noexcept {
  for (std::size_t i = 0; i < std::min<std::size_t>(samples_.size(), 2); ++i)
    if (samples_[i].time > time_) return samples_[i].time;
  return std::nullopt;
}

Pose RosTrack::pose() const noexcept { return mixed(before().pose(), after().pose(), share_); }

Twist RosTrack::twist() const noexcept {
  const Twist a = before().twist(), b = after().twist();
  return {mixed(a.linear, b.linear, share_), mixed(a.angular, b.angular, share_)};
}

Vec3 RosTrack::force() const noexcept { return mixed(before().force(), after().force(), share_); }

// ==== frames ====

RosFrames::RosFrames(RosSamples& samples, const std::vector<RosTrack>& tracks, ReadNotes& notes)
    : samples_(samples), tracks_(tracks), notes_(notes), states_(tracks.size()) {}

RosFrames::Placed RosFrames::at(std::uint32_t space, std::uint32_t frame) {
  const auto link = samples_.link_of(space, frame);
  return link ? of_link(*link) : Placed{};
}

RosFrames::Placed RosFrames::of_link(std::uint32_t link) {
  chain_.clear();
  Placed above;
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
    const RosTrack& track = tracks_[chain_.back()];
    const Pose own = track.pose();
    above.pose = {to_world(above.pose, own.position), above.pose.rotation * own.rotation};
    above.chain = 31 * above.chain + std::uint64_t{7} * chain_.back() + track.jumps() + 1;
    states_[chain_.back()].placed = above;
    states_[chain_.back()].computed = generation_;
    states_[chain_.back()].seen = 0;
  }
  return above;
}

}  // namespace tactus
