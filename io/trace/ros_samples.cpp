// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/ros_samples.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/base/rule.h>

namespace tactus {
namespace {

using Kind = RosSource::Kind;

// [bytes] of the budget for each source, frame or name, so that a recording of names alone has earned its memory
constexpr std::uint64_t kCostOfName = 512;
constexpr std::uint64_t kLatest = std::uint64_t{1} << 62;  // [ns] in 2116

/// "r1/arm" of "/r1/arm/pose"
std::string_view path_of(std::string_view topic) noexcept {
  if (topic.starts_with('/')) topic.remove_prefix(1);
  const std::size_t slash = topic.rfind('/');
  return slash == std::string_view::npos ? std::string_view() : topic.substr(0, slash);
}

bool holds(const std::vector<std::string>& list, const std::string& topic) {
  return std::ranges::any_of(list, [&](const std::string& one) { return one == topic || "/" + one == topic; });
}

}  // namespace

bool RosSelection::has(const std::string& topic) const { return (only.empty() || holds(only, topic)) && !holds(skip, topic); }

std::uint32_t RosSamples::number_of(std::string_view name) {
  const auto found = numbers_.find(name);
  if (found != numbers_.end()) return found->second;
  const auto number = static_cast<std::uint32_t>(names_.size());
  names_.push_back(&numbers_.emplace(name, number).first->first);
  spent_ += kCostOfName;
  return number;
}

std::optional<std::uint32_t> RosSamples::source_of(Kind kind, const std::string& topic, std::uint32_t space,
                                                   std::uint32_t child) {
  const auto number = static_cast<std::uint32_t>(sources_.size());
  const RosSource source{kind, topic, space, child, false, topic.ends_with("tf_static")};
  if (kind == Kind::link) {
    if (const auto found = links_.find({space, child}); found != links_.end()) return found->second;
    if (is_closed_) return std::nullopt;
    links_[{space, child}] = number;
  } else {
    if (const auto found = by_topic_.find({kind, topic}); found != by_topic_.end()) return found->second;
    if (is_closed_) return std::nullopt;
    by_topic_[{kind, topic}] = number;
  }
  sources_.push_back(source);
  spent_ += kCostOfName;
  return number;
}

const RosSamples::ChannelUse& RosSamples::use_of(const mcap::Reader& mcap, std::uint16_t id) {
  if (const auto found = uses_.find(id); found != uses_.end()) return found->second;
  ChannelUse use;
  const mcap::Channel& channel = mcap.channels().at(id);
  const auto schema = mcap.schemas().find(channel.schema_id);
  if (channel.message_encoding == "cdr" && schema != mcap.schemas().end()) use.type = ros_type(schema->second.name);
  const bool is_tree = use.type == RosType::transform || use.type == RosType::transforms;
  // a tree places what other topics hold, whether or not its frames are wanted as objects
  if (is_tree ? holds(selection_.skip, channel.topic) : !selection_.has(channel.topic)) use.type = RosType::none;
  if (use.type != RosType::none) {
    ++channels_of_topic_[channel.topic];
    use.space = number_of(use.type == RosType::transform ? std::string_view() : path_of(channel.topic));
    const bool has_pose = use.type == RosType::pose || use.type == RosType::odometry;
    if (has_pose) use.main = source_of(Kind::pose, channel.topic, use.space, 0);
    if (use.type == RosType::wrench) use.main = source_of(Kind::force, channel.topic, use.space, 0);
    if (use.type == RosType::twist || use.type == RosType::odometry)
      use.twist = source_of(Kind::twist, channel.topic, use.space, 0);
    if (use.type == RosType::odometry && use.main) sources_[*use.main].is_odometry = true;
    if (use.type == RosType::odometry && use.twist) sources_[*use.twist].is_odometry = true;
  }
  return uses_.emplace(id, use).first->second;
}

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

Result<void> RosSamples::take(mcap::Reader& mcap) {
  const mcap::Message& message = mcap.message();
  ++ordinal_;
  const ChannelUse& use = use_of(mcap, message.channel_id);
  if (use.type == RosType::none) return {};
  items_.clear();
  decode_ros(message.data, use.type, items_);
  TACTUS_CHECK(mcap.spend(items_.size() * sizeof(RosSample) + std::exchange(spent_, 0)));
  const std::string& topic = mcap.channels().at(message.channel_id).topic;
  for (RosItem& item : items_) {
    if (message.log_time >= kLatest) item.fault = item.twist_fault = RosFault::impossible_time;
    take_item(use, topic, item, {.ordinal = ordinal_, .log = message.log_time, .stamp = item.stamp});
  }
  return {};
}

void RosSamples::take_item(const ChannelUse& use, const std::string& topic, const RosItem& item, RosSample sample) {
  if (use.type == RosType::odometry) return take_odometry(use, topic, item, sample);
  sample.fault = item.fault;
  sample.ignored = item.ignored;
  sample.frame = number_of(item.frame);
  std::optional<std::uint32_t> source = use.type == RosType::twist ? use.twist : use.main;
  if (use.type == RosType::transform || use.type == RosType::transforms) {
    const bool is_lost = item.fault == RosFault::malformed || item.fault == RosFault::encoding;
    if (is_lost && is_closed_) return;
    source = source_of(Kind::link, topic, use.space, number_of(is_lost ? topic : std::string(item.child)));
    if (!is_closed_ && item.fault == RosFault::none) parents_[{use.space, sample.frame}] = true;
  }
  if (!source) {
    ++late_[topic];
    return;
  }
  sample.source = *source;
  if (use.type == RosType::twist) sample.value = {{}, item.twist.linear, item.twist.angular};
  else if (use.type == RosType::wrench) sample.value.pose.position = item.force;
  else sample.value.pose = item.pose;
  push(sample);
}

void RosSamples::take_odometry(const ChannelUse& use, const std::string& topic, const RosItem& item, RosSample sample) {
  if (!use.main || !use.twist) {
    ++late_[topic];
    return;
  }
  sample.frame = number_of(item.frame);
  sample.source = *use.main;
  sample.fault = item.fault;
  sample.ignored = item.ignored;
  sample.value.pose = item.pose;
  push(sample);
  sample.source = *use.twist;
  sample.frame = number_of(item.child);
  sample.ignored = false;
  sample.fault = item.twist_fault;
  sample.value = {{}, item.twist.linear, item.twist.angular};
  push(sample);
}

/// A copy of a sample holds nothing new, and makes what moves look as if it rested. Where stamps stand still there are no copies.
void RosSamples::push(const RosSample& sample) {
  constexpr std::int64_t kLongestRun = 1'000'000'000;  // [ns]
  if (sample.fault == RosFault::none && sample.stamp != 0 && !sources_[sample.source].is_static) {
    Run& run = runs_[sample.source];
    const RigidSample &now = sample.value, &first = run.first.value;
    const bool is_same = now.pose.position == first.pose.position && now.pose.rotation == first.pose.rotation &&
                         now.velocity == first.velocity && now.angular_velocity == first.angular_velocity;
    if (run.number == 0 || sample.stamp != run.first.stamp) {
      run = {sample, run.number + 1};
    } else if (run.number > 1 && is_same && sample.frame == run.first.frame &&
               std::abs(static_cast<std::int64_t>(sample.log - run.first.log)) < kLongestRun) {
      if (!is_closed_) ++copies_[sample.source];
      return;
    }
  }
  waiting_.push_back(sample);
}

std::optional<std::uint32_t> RosSamples::link_in(std::string_view tree, std::string_view frame) const {
  const auto space = numbers_.find(tree), child = numbers_.find(frame);
  if (space == numbers_.end() || child == numbers_.end()) return std::nullopt;
  const auto found = links_.find({space->second, child->second});
  return found == links_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::uint32_t> RosSamples::prefixed(std::uint32_t space, std::uint32_t frame) const {
  for (std::string path = name(space); !path.empty(); path.resize(path.find('/') == std::string::npos ? 0 : path.rfind('/'))) {
    const std::string prefix = path + '/', &own = name(frame);
    if (const auto link = link_in("", prefix + own)) return link;
    if (!own.starts_with(prefix)) continue;
    if (const auto link = link_in(path, std::string_view(own).substr(prefix.size()))) return link;
  }
  return std::nullopt;
}

std::optional<std::uint32_t> RosSamples::link_of(std::uint32_t space, std::uint32_t frame) {
  if (const auto known = found_.find({space, frame}); known != found_.end()) return known->second;
  std::optional<std::uint32_t> link;
  bool is_parent = false;
  for (std::string_view path = name(space);;) {
    const auto tree = numbers_.find(path);
    is_parent = is_parent || (tree != numbers_.end() && parents_.contains({tree->second, frame}));
    link = link_in(path, name(frame));
    if (link || path.empty()) break;
    const std::size_t slash = path.rfind('/');
    path = slash == std::string_view::npos ? std::string_view() : path.substr(0, slash);
  }
  if (!link && !is_parent) link = prefixed(space, frame);
  if (is_closed_) found_[{space, frame}] = link;
  return link;
}

bool RosSamples::is_in_tree(std::uint32_t space, std::uint32_t frame) {
  if (link_of(space, frame)) return true;
  for (std::string_view path = name(space);;) {
    const auto tree = numbers_.find(path);
    if (tree != numbers_.end() && parents_.contains({tree->second, frame})) return true;
    if (path.empty()) return false;
    const std::size_t slash = path.rfind('/');
    path = slash == std::string_view::npos ? std::string_view() : path.substr(0, slash);
  }
}

std::vector<RosSamples::Other> RosSamples::others(const mcap::Reader& mcap) const {
  std::map<std::string, Other> by_type;
  for (const auto& [id, channel] : mcap.channels()) {
    const auto use = uses_.find(id);
    if ((use != uses_.end() && use->second.type != RosType::none)) continue;
    const auto schema = mcap.schemas().find(channel.schema_id);
    std::string type = schema == mcap.schemas().end() ? "no type" : schema->second.name;
    if (channel.message_encoding != "cdr") type += " (" + channel.message_encoding + ")";
    else if (ros_type(type) != RosType::none && !selection_.has(channel.topic)) type += " (not chosen)";
    else if (ros_type(type) != RosType::none) continue;  // without a message
    Other& other = by_type[type];
    other.type = type;
    if (other.topics++ == 0) other.first = channel.topic;
  }
  std::vector<Other> all;
  all.reserve(by_type.size());
  for (auto& [type, other] : by_type) all.push_back(std::move(other));
  return all;
}

}  // namespace tactus
