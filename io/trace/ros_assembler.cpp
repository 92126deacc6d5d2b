// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <deque>
#include <set>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/trace/differences.h>
#include <tactus/trace/frame_assembler.h>
#include <tactus/trace/ros_samples.h>
#include <tactus/base/text.h>

namespace tactus {
namespace {

// Samples of the look-ahead. They give the rate, and what begins behind them is refused: a topic of 1 Hz beside one of 1 kHz has begun.
constexpr std::size_t kLookAhead = 4096;

// [bytes] of the budget for each object and user of a frame, changed or not: about its size in a table.
constexpr std::uint64_t kCostOfObject = 256;

std::string_view path_of(std::string_view topic) { return topic.substr(0, std::min(topic.rfind('/'), topic.size())); }

/// "/robot/arm/pose" becomes "robot.arm", if the ending is "/pose"; "/pose" becomes "pose".
std::string object_name(std::string_view topic, std::string_view ending) {
  if (!ending.empty() && topic.size() > ending.size() && topic.ends_with(ending)) topic = path_of(topic);
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
  explicit RosAssembler(const Preamble& preamble) : samples_(preamble.item) {
    info_.source = "ROS 2 recording";
    info_.scene = preamble.scene;
  }
  Result<void> start(mcap::Reader& mcap);
  Result<bool> next(mcap::Reader& mcap, TraceFrame& frame) override;
  const TraceInfo& info() const noexcept override { return info_; }
  std::optional<std::uint16_t> frame_channel() const noexcept override { return std::nullopt; }

 private:
  using Kind = RosSample::Kind;
  struct Track {
    bool known = false;      // something told its place
    bool has_twist = false;  // its motion comes from a twist topic
    bool placed = false;     // has a pose,
    std::uint64_t time = 0;  // of this time
  };
  struct Touch {
    std::optional<std::uint32_t> frame{};  // of the force
    std::optional<std::size_t> object{};   // where the force acts, if the frame does not tell
  };
  Result<void> look_ahead(mcap::Reader& mcap);
  Result<void> find_objects(const mcap::Reader& mcap);
  Result<void> find_users(const mcap::Reader& mcap);
  Result<std::optional<RosSample>> next_sample(mcap::Reader& mcap);
  Result<void> apply(const mcap::Reader& mcap, const RosSample& sample);
  Result<void> hang(const mcap::Reader& mcap, const RosSample& transform);
  void hear_of(std::size_t object) noexcept;
  Result<void> move(const mcap::Reader& mcap, std::size_t object, const Pose& pose, std::uint64_t time);
  Result<void> place_frames(const mcap::Reader& mcap);
  Result<void> deliver(mcap::Reader& mcap, TraceFrame& frame);

  TraceInfo info_;
  RosSamples samples_;
  std::deque<RosSample> ahead_;
  std::set<std::pair<Kind, std::uint32_t>> sources_;       // in the look-ahead
  std::map<std::uint32_t, std::size_t> objects_, framed_;  // channel of poses or twists -> object; frame -> object
  std::map<std::uint32_t, std::size_t> users_;             // channel of forces -> user
  std::uint64_t start_ = 0;                                // [ns] log time of tick 0
  std::vector<Track> tracks_;                              // per object
  std::vector<Touch> touches_;                             // per user
  std::size_t known_ = 0;                                  // tracks that have had a pose
  TraceFrame current_;
  bool pending_ = false;  // current_ holds a tick that was not delivered
};

tl::unexpected<Error> refuse(const mcap::Reader& mcap, Errc code, RuleName rule) noexcept {
  return fail(code, rule, 8 * mcap.offset());
}

Result<void> RosAssembler::start(mcap::Reader& mcap) {
  TACTUS_CHECK(look_ahead(mcap));
  samples_.close_frames();
  TACTUS_CHECK(find_objects(mcap));
  TACTUS_CHECK(find_users(mcap));
  start_ = ahead_.front().time;
  current_.objects.resize(info_.objects.size());
  current_.users.resize(info_.users.size());
  return {};
}

Result<void> RosAssembler::look_ahead(mcap::Reader& mcap) {
  std::map<std::pair<Kind, std::uint32_t>, std::vector<std::uint64_t>> times;
  const std::vector<std::uint64_t>* densest = nullptr;
  while (ahead_.size() < kLookAhead) {
    TACTUS_TRY(auto sample, samples_.next(mcap));
    if (!sample) break;
    if (!ahead_.empty() && sample->time < ahead_.back().time) return refuse(mcap, Errc::invalid, "R-TRC-15");
    sources_.emplace(sample->kind, sample->source);
    if (sample->kind != Kind::twist) {
      auto& own = times[{sample->kind, sample->source}];
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

/// Objects are the topics with poses in the look-ahead, in order of their channel ids, then the frames that hang on others.
Result<void> RosAssembler::find_objects(const mcap::Reader& mcap) {
  std::map<std::string_view, std::size_t> by_path;
  std::set<std::string> names;
  const auto add = [&](std::string name) {
    if (!is_plain_name(name) || !names.insert(name).second) return false;
    info_.objects.push_back({std::move(name), Dof::all});
    return true;
  };
  for (const auto& [kind, source] : sources_) {
    const std::size_t object = info_.objects.size();
    if (kind == Kind::pose) {
      const std::string& topic = mcap.channels().at(static_cast<std::uint16_t>(source)).topic;
      if (!add(object_name(topic, "/pose"))) return refuse(mcap, Errc::unsupported, "R-TRC-16");
      objects_[source] = object;
      if (!sources_.contains({Kind::twist, source})) by_path[path_of(topic)] = object;  // odometry has its own
    } else if (kind == Kind::transform) {
      if (!add(object_name(samples_.frames().name(source), ""))) return refuse(mcap, Errc::unsupported, "R-TRC-16");
      framed_[source] = object;
    }
  }
  tracks_.resize(info_.objects.size());
  for (const auto& [kind, source] : sources_) {
    if (kind != Kind::twist) continue;
    const auto own = objects_.find(source);
    const auto found = by_path.find(path_of(mcap.channels().at(static_cast<std::uint16_t>(source)).topic));
    if (own == objects_.end() && found == by_path.end()) continue;
    objects_[source] = own != objects_.end() ? own->second : found->second;
    tracks_[objects_[source]].has_twist = true;
  }
  return {};
}

/// Users are the topics with forces. They are where the frame of the force is, or the object of a topic beside, if there is one alone.
Result<void> RosAssembler::find_users(const mcap::Reader& mcap) {
  std::set<std::string> names;
  for (const RosSample& sample : ahead_) {
    if (sample.kind != Kind::force || users_.contains(sample.source)) continue;
    const std::string& topic = mcap.channels().at(static_cast<std::uint16_t>(sample.source)).topic;
    std::string name = object_name(topic, "/wrench");
    if (!is_plain_name(name) || !names.insert(name).second) return refuse(mcap, Errc::unsupported, "R-TRC-16");
    users_[sample.source] = info_.users.size();
    info_.users.push_back({std::move(name)});
    Touch touch;
    if (framed_.contains(sample.frame)) touch.frame = sample.frame;
    std::set<std::size_t> beside;
    for (const auto& [channel, object] : objects_)
      if (path_of(mcap.channels().at(static_cast<std::uint16_t>(channel)).topic) == path_of(topic)) beside.insert(object);
    if (beside.size() == 1) touch.object = *beside.begin();
    touches_.push_back(touch);
  }
  return {};
}

Result<std::optional<RosSample>> RosAssembler::next_sample(mcap::Reader& mcap) {
  if (ahead_.empty()) return samples_.next(mcap);
  std::optional<RosSample> sample = ahead_.front();
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
    if (is_due) TACTUS_CHECK(deliver(mcap, frame));
    current_.tick = tick;
    TACTUS_CHECK(apply(mcap, *sample));
    pending_ = known_ == tracks_.size();
    if (is_due) return true;
  }
  if (!std::exchange(pending_, false)) return false;
  TACTUS_CHECK(deliver(mcap, frame));
  return true;
}

Result<void> RosAssembler::deliver(mcap::Reader& mcap, TraceFrame& frame) {
  TACTUS_CHECK(mcap.spend((current_.objects.size() + current_.users.size()) * kCostOfObject));
  TACTUS_CHECK(place_frames(mcap));
  frame = current_;
  return {};
}

/// What hangs on a frame that moved has moved, too.
Result<void> RosAssembler::place_frames(const mcap::Reader& mcap) {
  for (const auto& [number, object] : framed_) {
    const RosFrames::Placed& placed = samples_.frames().placed(number);
    if (!tracks_[object].placed || placed.time > tracks_[object].time) TACTUS_CHECK(move(mcap, object, placed.pose, placed.time));
  }
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    UserSample& user = current_.users[i];
    if (touches_[i].frame) user.device.position = samples_.frames().placed(*touches_[i].frame).pose.position;
    else if (touches_[i].object) user.device.position = current_.objects[*touches_[i].object].pose.position;
    user.contact.device = user.device.position;
  }
  return {};
}

Result<void> RosAssembler::apply(const mcap::Reader& mcap, const RosSample& sample) {
  if (sample.kind == Kind::transform) return hang(mcap, sample);
  if (sample.kind == Kind::force) {
    const auto user = users_.find(sample.source);
    if (user == users_.end()) return refuse(mcap, Errc::unsupported, "R-TRC-16");
    const std::optional<std::uint32_t>& frame = touches_[user->second].frame;
    const Vec3 force = frame ? rotate(samples_.frames().placed(*frame).pose.rotation, sample.force) : sample.force;
    current_.users[user->second].force = current_.users[user->second].server_force = force;
    return {};
  }
  const auto found = objects_.find(sample.source);
  if (found == objects_.end()) return sample.kind == Kind::twist ? Result<void>() : refuse(mcap, Errc::unsupported, "R-TRC-16");
  if (sample.kind == Kind::pose) {
    hear_of(found->second);
    return move(mcap, found->second, sample.pose, sample.time);
  }
  current_.objects[found->second].velocity = sample.twist.linear;
  current_.objects[found->second].angular_velocity = sample.twist.angular;
  return {};
}

Result<void> RosAssembler::hang(const mcap::Reader& mcap, const RosSample& transform) {
  const auto found = framed_.find(transform.source);
  if (found == framed_.end()) return refuse(mcap, Errc::unsupported, "R-TRC-16");
  const auto placed = samples_.frames().place(transform.source, transform.frame, transform.pose, transform.time);
  if (!placed) return fail_at(placed.error(), 8 * mcap.offset());
  hear_of(found->second);
  return {};
}

void RosAssembler::hear_of(std::size_t object) noexcept {
  if (!tracks_[object].known) ++known_;
  tracks_[object].known = true;
}

Result<void> RosAssembler::move(const mcap::Reader& mcap, std::size_t object, const Pose& pose, std::uint64_t time) {
  Track& track = tracks_[object];
  RigidSample& moved = current_.objects[object];
  if (!track.has_twist && track.placed && time > track.time) {
    const Twist motion = motion_between(moved.pose, pose, 1e-9 * static_cast<double>(time - track.time));
    if (!is_finite(motion.linear) || !is_finite(motion.angular)) return refuse(mcap, Errc::invalid, "R-TRC-14");
    moved.velocity = motion.linear;
    moved.angular_velocity = motion.angular;
  }
  moved.pose = pose;
  track.placed = true;
  track.time = time;
  return {};
}

}  // namespace

Result<std::unique_ptr<FrameAssembler>> assemble_ros(mcap::Reader& mcap, const Preamble& preamble) {
  auto assembler = std::make_unique<RosAssembler>(preamble);
  TACTUS_CHECK(assembler->start(mcap));
  return assembler;
}

}  // namespace tactus
