// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <deque>
#include <set>
#include <utility>
#include <variant>

#include <tactus/base/rule.h>
#include <tactus/trace/differences.h>
#include <tactus/trace/frame_assembler.h>
#include <tactus/trace/messages.h>
#include <tactus/trace/schemas.h>
#include <tactus/trace/text.h>

namespace tactus {
namespace {

// The look-ahead ends when one topic has had so many poses, which give the rate, or after so many poses and twists of all topics.
constexpr std::size_t kPosesForRate = 64;
constexpr std::size_t kLookAhead = 4096;

// [bytes] of the budget for each object of a frame, changed or not: about its size in a table.
constexpr std::uint64_t kCostOfObject = 256;

struct Sample {
  std::uint16_t channel = 0;
  std::uint64_t time = 0;  // [ns] log time
  std::variant<Pose, Twist> value;
};

std::string_view path_of(std::string_view topic) { return topic.substr(0, std::min(topic.rfind('/'), topic.size())); }

/// "/robot/arm/pose" becomes "robot.arm".
std::string object_name(std::string_view topic) {
  if (topic.ends_with("/pose")) topic = path_of(topic);
  if (topic.starts_with('/')) topic.remove_prefix(1);
  std::string name(topic);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

std::uint32_t median_rate(std::vector<std::uint64_t> times) {
  std::vector<std::uint64_t> gaps;
  for (std::size_t i = 1; i < times.size(); ++i) gaps.push_back(times[i] - times[i - 1]);
  if (gaps.empty()) return TraceInfo().tick_rate;
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  const std::uint64_t gap = std::clamp<std::uint64_t>(*middle, 1'000'000'000 / kMaxTickRate, 1'000'000'000);
  return static_cast<std::uint32_t>((1'000'000'000 + gap / 2) / gap);
}

class RosAssembler final : public FrameAssembler {
 public:
  Result<void> start(mcap::Reader& mcap, const Preamble& preamble);
  Result<bool> next(mcap::Reader& mcap, TraceFrame& frame) override;
  const TraceInfo& info() const noexcept override { return info_; }
  std::optional<std::uint16_t> frame_channel() const noexcept override { return std::nullopt; }

 private:
  struct Track {
    bool known = false;      // has had a pose
    bool has_twist = false;  // its motion comes from a twist topic
    std::uint64_t time = 0;  // of its last pose
  };
  Result<void> look_ahead(mcap::Reader& mcap);
  Result<void> find_objects(const mcap::Reader& mcap);
  Result<std::optional<Sample>> read(mcap::Reader& mcap);
  Result<std::optional<Sample>> next_sample(mcap::Reader& mcap);
  Result<void> apply(const mcap::Reader& mcap, const Sample& sample);

  TraceInfo info_;
  mcap::Item item_ = mcap::Item::end;  // where the reader stands
  std::deque<Sample> ahead_;
  std::map<std::uint16_t, std::size_t> objects_;  // channel of poses or twists -> object
  std::uint64_t start_ = 0;                       // [ns] log time of tick 0
  std::vector<Track> tracks_;
  std::size_t known_ = 0;  // tracks that have had a pose
  TraceFrame current_;
  bool pending_ = false;  // current_ holds a tick that was not delivered
};

tl::unexpected<Error> refuse(const mcap::Reader& mcap, Errc code, RuleName rule) noexcept {
  return fail(code, rule, 8 * mcap.offset());
}

Result<void> RosAssembler::start(mcap::Reader& mcap, const Preamble& preamble) {
  item_ = preamble.item;
  info_.source = "ROS 2 recording";
  info_.scene = preamble.scene;
  TACTUS_CHECK(look_ahead(mcap));
  TACTUS_CHECK(find_objects(mcap));
  start_ = ahead_.front().time;
  tracks_.resize(info_.objects.size());
  current_.objects.resize(info_.objects.size());
  for (const auto& [channel, object] : objects_)
    if (carries(mcap, mcap.channels().at(channel), schema_name(MessageType::twist))) tracks_[object].has_twist = true;
  return {};
}

Result<void> RosAssembler::look_ahead(mcap::Reader& mcap) {
  std::map<std::uint16_t, std::vector<std::uint64_t>> times;
  const std::vector<std::uint64_t>* densest = nullptr;
  while (ahead_.size() < kLookAhead && (densest == nullptr || densest->size() < kPosesForRate)) {
    TACTUS_TRY(auto sample, read(mcap));
    if (!sample) break;
    if (!ahead_.empty() && sample->time < ahead_.back().time) return refuse(mcap, Errc::invalid, "R-TRC-15");
    if (std::holds_alternative<Pose>(sample->value)) {
      auto& own = times[sample->channel];
      own.push_back(sample->time);
      if (densest == nullptr || own.size() > densest->size()) densest = &own;
    }
    ahead_.push_back(*sample);
  }
  if (densest == nullptr && mcap.cut_short()) return refuse(mcap, Errc::truncated, "R-TRC-3");
  if (densest == nullptr) return refuse(mcap, Errc::unsupported, "R-TRC-16");
  info_.tick_rate = median_rate(*densest);
  return {};
}

/// Objects are the topics with poses in the look-ahead, in order of their channel ids.
Result<void> RosAssembler::find_objects(const mcap::Reader& mcap) {
  std::set<std::uint16_t> poses, twists;
  for (const Sample& sample : ahead_) (std::holds_alternative<Pose>(sample.value) ? poses : twists).insert(sample.channel);
  std::map<std::string_view, std::size_t> by_path;
  std::set<std::string> names;
  for (const std::uint16_t id : poses) {
    const std::string& topic = mcap.channels().at(id).topic;
    std::string name = object_name(topic);
    if (!is_plain_name(name) || !names.insert(name).second) return refuse(mcap, Errc::unsupported, "R-TRC-16");
    objects_[id] = by_path[path_of(topic)] = info_.objects.size();
    info_.objects.push_back({std::move(name), Dof::all});
  }
  for (const std::uint16_t id : twists)
    if (const auto found = by_path.find(path_of(mcap.channels().at(id).topic)); found != by_path.end())
      objects_[id] = found->second;
  return {};
}

/// The next pose or twist of the file.
Result<std::optional<Sample>> RosAssembler::read(mcap::Reader& mcap) {
  while (item_ != mcap::Item::end) {
    std::optional<Sample> sample;
    if (item_ == mcap::Item::message) {
      const mcap::Message& message = mcap.message();
      const mcap::Channel& channel = mcap.channels().at(message.channel_id);
      if (carries(mcap, channel, schema_name(MessageType::pose))) {
        const auto pose = decode_pose(message.data);
        if (!pose) return fail_at(pose.error(), 8 * mcap.offset());
        sample = Sample{channel.id, message.log_time, pose->value};
      } else if (carries(mcap, channel, schema_name(MessageType::twist))) {
        const auto twist = decode_twist(message.data);
        if (!twist) return fail_at(twist.error(), 8 * mcap.offset());
        sample = Sample{channel.id, message.log_time, twist->value};
      }
    }
    TACTUS_TRY(item_, mcap.next());
    if (sample) return sample;
  }
  return std::nullopt;
}

Result<std::optional<Sample>> RosAssembler::next_sample(mcap::Reader& mcap) {
  if (ahead_.empty()) return read(mcap);
  std::optional<Sample> sample = ahead_.front();
  ahead_.pop_front();
  return sample;
}

Result<bool> RosAssembler::next(mcap::Reader& mcap, TraceFrame& frame) {
  while (true) {
    TACTUS_TRY(const auto sample, next_sample(mcap));
    if (!sample) break;
    if (sample->time < start_) return refuse(mcap, Errc::invalid, "R-TRC-15");
    const std::int64_t tick = tick_of_time(sample->time - start_, info_.tick_rate);
    if (tick < current_.tick || tick / info_.tick_rate >= kMaxSeconds) return refuse(mcap, Errc::invalid, "R-TRC-15");
    const bool is_due = pending_ && tick > current_.tick;
    if (is_due) {
      TACTUS_CHECK(mcap.spend(current_.objects.size() * kCostOfObject));
      frame = current_;
    }
    current_.tick = tick;
    TACTUS_CHECK(apply(mcap, *sample));
    pending_ = known_ == tracks_.size();
    if (is_due) return true;
  }
  if (!std::exchange(pending_, false)) return false;
  frame = current_;
  return true;
}

Result<void> RosAssembler::apply(const mcap::Reader& mcap, const Sample& sample) {
  const auto found = objects_.find(sample.channel);
  const Pose* const pose = std::get_if<Pose>(&sample.value);
  if (found == objects_.end()) return pose == nullptr ? Result<void>() : refuse(mcap, Errc::unsupported, "R-TRC-16");
  RigidSample& object = current_.objects[found->second];
  if (pose == nullptr) {
    object.velocity = std::get<Twist>(sample.value).linear;
    object.angular_velocity = std::get<Twist>(sample.value).angular;
    return {};
  }
  Track& track = tracks_[found->second];
  if (!track.has_twist && track.known && sample.time > track.time) {
    const Twist motion = motion_between(object.pose, *pose, 1e-9 * static_cast<double>(sample.time - track.time));
    if (!is_finite(motion.linear) || !is_finite(motion.angular)) return refuse(mcap, Errc::invalid, "R-TRC-14");
    object.velocity = motion.linear;
    object.angular_velocity = motion.angular;
  }
  object.pose = *pose;
  known_ += track.known ? 0 : 1;
  track.known = true;
  track.time = sample.time;
  return {};
}

}  // namespace

Result<std::unique_ptr<FrameAssembler>> assemble_ros(mcap::Reader& mcap, const Preamble& preamble) {
  auto assembler = std::make_unique<RosAssembler>();
  TACTUS_CHECK(assembler->start(mcap, preamble));
  return assembler;
}

}  // namespace tactus
