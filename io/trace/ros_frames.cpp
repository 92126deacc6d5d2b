// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/ros_frames.h>

#include <algorithm>

#include <tactus/base/rule.h>

namespace tactus {

std::uint32_t RosFrames::number_of(std::string_view name) {
  const auto found = numbers_.find(name);
  if (found != numbers_.end()) return found->second;
  const auto number = static_cast<std::uint32_t>(links_.size());
  const auto added = numbers_.emplace(name, number).first;
  links_.push_back({.name = &added->first});
  return number;
}

std::optional<std::uint32_t> RosFrames::find(std::string_view name) const {
  const auto found = numbers_.find(name);
  return found == numbers_.end() ? std::nullopt : std::optional(found->second);
}

Result<void> RosFrames::place(std::uint32_t child, std::uint32_t parent, const Pose& pose, std::uint64_t time) {
  Link& link = links_[child];
  if (link.parent && *link.parent != parent) return fail(Errc::unsupported, "R-TRC-16");
  if (!link.parent) {
    for (std::optional<std::uint32_t> above = parent; above; above = links_[*above].parent)
      if (*above == child) return fail(Errc::unsupported, "R-TRC-16");
    link.parent = parent;
  }
  link.in_parent = {pose, time};
  ++generation_;
  return {};
}

const RosFrames::Placed& RosFrames::placed(std::uint32_t frame) {
  chain_.clear();
  std::optional<std::uint32_t> at = frame;
  for (; at && links_[*at].computed != generation_; at = links_[*at].parent) chain_.push_back(*at);
  for (; !chain_.empty(); chain_.pop_back()) {
    Link& link = links_[chain_.back()];
    link.computed = generation_;
    link.in_world = link.in_parent;
    if (!link.parent) continue;
    const Placed& above = links_[*link.parent].in_world;
    link.in_world.pose = {to_world(above.pose, link.in_parent.pose.position), above.pose.rotation * link.in_parent.pose.rotation};
    link.in_world.time = std::max(above.time, link.in_parent.time);
  }
  return links_[frame].in_world;
}

}  // namespace tactus
