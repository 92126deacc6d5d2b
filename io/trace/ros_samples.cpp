// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/ros_samples.h>

#include <tactus/base/rule.h>
#include <tactus/trace/frame_assembler.h>
#include <tactus/trace/messages.h>

namespace tactus {
namespace {

template <class T>
Result<T> located(Result<T> decoded, const mcap::Reader& mcap) {
  if (!decoded) return fail_at(decoded.error(), 8 * mcap.offset());
  return decoded;
}

}  // namespace

Result<std::optional<RosSample>> RosSamples::next(mcap::Reader& mcap) {
  while (waiting_.empty()) {
    if (item_ == mcap::Item::end) return std::nullopt;
    if (item_ == mcap::Item::message) TACTUS_CHECK(take(mcap));
    TACTUS_TRY(item_, mcap.next());
  }
  std::optional<RosSample> sample = waiting_.front();
  waiting_.pop_front();
  return sample;
}

Result<std::uint32_t> RosSamples::frame(std::string_view name) {
  if (!frames_are_closed_) return frames_.number_of(name);
  const auto known = frames_.find(name);
  if (!known) return fail(Errc::unsupported, "R-TRC-16");
  return *known;
}

Result<void> RosSamples::take(mcap::Reader& mcap) {
  using Kind = RosSample::Kind;
  const mcap::Message& message = mcap.message();
  const mcap::Channel& channel = mcap.channels().at(message.channel_id);
  const auto add = [&](Kind kind) -> RosSample& {
    return waiting_.emplace_back(RosSample{.kind = kind, .source = channel.id, .time = message.log_time});
  };
  if (carries(mcap, channel, schema_name(MessageType::pose))) {
    TACTUS_TRY(const auto pose, located(decode_pose(message.data), mcap));
    add(Kind::pose).pose = pose.value;
  } else if (carries(mcap, channel, schema_name(MessageType::twist))) {
    TACTUS_TRY(const auto twist, located(decode_twist(message.data), mcap));
    add(Kind::twist).twist = twist.value;
  } else if (carries(mcap, channel, kOdometrySchema)) {
    TACTUS_TRY(const auto odometry, located(decode_odometry(message.data), mcap));
    add(Kind::pose).pose = odometry.pose;
    add(Kind::twist).twist = odometry.twist;
  } else if (carries(mcap, channel, kWrenchSchema)) {
    TACTUS_TRY(const auto wrench, located(decode_wrench(message.data), mcap));
    TACTUS_TRY(const std::uint32_t number, located(frame(wrench.frame), mcap));
    RosSample& sample = add(Kind::force);
    sample.frame = number;
    sample.force = wrench.force;
  } else if (carries(mcap, channel, kTransformsSchema)) {
    return located(take_transforms(mcap, true), mcap);
  } else if (carries(mcap, channel, kTransformSchema)) {
    return located(take_transforms(mcap, false), mcap);
  }
  return {};
}

Result<void> RosSamples::take_transforms(mcap::Reader& mcap, bool is_list) {
  const mcap::Message& message = mcap.message();
  transforms_.clear();
  TACTUS_CHECK(decode_transforms(message.data, is_list, transforms_));
  TACTUS_CHECK(mcap.spend(transforms_.size() * sizeof(RosSample)));
  for (const RosTransform& transform : transforms_) {
    TACTUS_TRY(const std::uint32_t parent, frame(transform.parent));
    TACTUS_TRY(const std::uint32_t child, frame(transform.child));
    waiting_.push_back(RosSample{
        .kind = RosSample::Kind::transform, .source = child, .frame = parent, .time = message.log_time, .pose = transform.pose});
  }
  return {};
}

}  // namespace tactus
