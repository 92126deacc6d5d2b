// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <set>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/trace/frame_assembler.h>
#include <tactus/trace/ros_frames.h>
#include <tactus/trace/ros_survey.h>

namespace tactus {
namespace {

using Kind = RosSource::Kind;

constexpr std::size_t kLookAhead = 4096;          // samples of a pipe
constexpr std::uint64_t kPipeSlack = 50'000'000;  // [ns] that later samples may cross by, beyond twice what was seen
constexpr std::size_t kMostSorted = 1u << 18;     // samples that are held back to be sorted
constexpr std::uint64_t kCostOfObject = 256;      // [bytes] of the budget per frame, changed or not: about its size in a table

std::string_view path_of(std::string_view topic) { return topic.substr(0, std::min(topic.rfind('/'), topic.size())); }

/// "/robot/arm/pose" becomes "robot.arm", if the ending is "/pose"; "/pose" becomes "pose".
std::string object_name(std::string_view topic, std::string_view ending) {
  if (!ending.empty() && topic.size() > ending.size() && topic.ends_with(ending)) topic = path_of(topic);
  if (topic.starts_with('/')) topic.remove_prefix(1);
  std::string name(topic);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

/// Gives samples in the order of their times, as far as a window allows.
class RosOrder {
 public:
  void add(RosSample sample) { waiting_.push({sample, number_++}); }
  /// Times below this one are final.
  void reach(std::uint64_t time) noexcept { final_ = std::max(final_, time); }
  void end() noexcept { final_ = std::numeric_limits<std::uint64_t>::max(); }
  /// The next sample whose order is certain, or that the window has no room to hold back.
  std::optional<RosSample> take() {
    if (waiting_.empty() || (waiting_.top().sample.time > final_ && waiting_.size() <= kMostSorted)) return std::nullopt;
    const RosSample sample = waiting_.top().sample;
    waiting_.pop();
    return sample;
  }

 private:
  struct Entry {
    RosSample sample;
    std::uint64_t number = 0;
    friend bool operator<(const Entry& a, const Entry& b) noexcept {  // the queue gives the largest
      return a.sample.time != b.sample.time ? a.sample.time > b.sample.time : a.number > b.number;
    }
  };
  std::priority_queue<Entry> waiting_;
  std::uint64_t final_ = 0, number_ = 0;
};

class RosAssembler final : public FrameAssembler {
 public:
  RosAssembler(const Preamble& preamble, const ReadOptions& options)
      : options_(options), samples_({options.topics, options.skip}), survey_(samples_, options_) {
    info_.source = "ROS 2 recording";
    info_.scene = preamble.scene;
  }
  tl::expected<void, Diagnostic> start(mcap::Reader& mcap, mcap::Item first, std::optional<mcap::Reader> ahead);
  Result<bool> next(mcap::Reader& mcap, TraceFrame& frame) override;
  const TraceInfo& info() const noexcept override { return info_; }
  std::optional<std::uint16_t> frame_channel() const noexcept override { return std::nullopt; }
  const ReadNotes* notes() const noexcept override { return &notes_; }
  const Diagnostic* refused() const noexcept override { return refused_ ? &*refused_ : nullptr; }

 private:
  struct Object {
    std::uint32_t source = 0;
    std::optional<std::uint32_t> twist{};
  };
  struct User {
    std::uint32_t source = 0;
    std::optional<std::size_t> beside{};  // object where the force acts, if its frame does not show it
  };
  Result<void> look(mcap::Reader& mcap, std::size_t most, bool keeps);
  std::vector<std::string> find_objects();
  void take_twist(Object& object, std::uint32_t twist);
  void note_unknown(const mcap::Reader& mcap, const std::vector<std::string>& left_out);
  void find_users();
  std::string free_name(std::string name, const std::string& of, std::set<std::string>& names);
  Result<std::optional<RosSample>> read(mcap::Reader& mcap);
  Result<bool> take(mcap::Reader& mcap);
  Result<bool> skip(mcap::Reader& mcap, std::uint64_t time);
  void fill(TraceFrame& out);
  RigidSample sample_of(const Object& object);
  UserSample press(const User& user, const TraceFrame& out);

  ReadOptions options_;
  TraceInfo info_;
  ReadNotes notes_;
  std::optional<Diagnostic> refused_;
  RosSamples samples_;
  RosSurvey survey_;
  std::deque<RosSample> kept_;  // of a pipe's look-ahead
  RosOrder order_;
  std::uint64_t newest_ = 0, released_ = 0, window_ = 0;
  bool ended_ = false, is_whole_ = true;
  std::vector<RosTrack> tracks_;  // per source
  std::optional<RosFrames> frames_;
  std::vector<Object> objects_;
  std::vector<User> users_;
  std::int64_t tick_ = 0;
};

Result<void> RosAssembler::look(mcap::Reader& mcap, std::size_t most, bool keeps) {
  for (std::size_t count = 0; count < most; ++count) {
    TACTUS_TRY(const auto sample, samples_.next(mcap));
    if (!sample) break;
    survey_.add(*sample);
    if (keeps) kept_.push_back(*sample);
  }
  return {};
}

tl::expected<void, Diagnostic> RosAssembler::start(mcap::Reader& mcap, mcap::Item first, std::optional<mcap::Reader> ahead) {
  constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
  is_whole_ = ahead.has_value();
  mcap::Reader& looked = ahead ? *ahead : mcap;
  if (ahead) {
    while (true) {  // to where the other reader stands, if that is the end: only then it knows whether the file was cut
      const auto item = ahead->next();
      if (!item || *item == mcap::Item::message || *item == mcap::Item::end) break;
    }
  }
  samples_.restart(first);
  const auto done = look(looked, ahead ? kAll : kLookAhead, !ahead);
  // what was read ahead of a damage can be used: the second pass stops there, too
  auto decided = survey_.end(looked);
  if (!decided && !done && decided.error().error.rule == std::string_view("R-TRC-16"))
    return tl::unexpected(Diagnostic{.error = done.error()});
  if (!decided) return decided;
  is_whole_ = is_whole_ || kept_.size() < kLookAhead;
  samples_.close();
  survey_.add_notes(looked, is_whole_, notes_);
  if (ahead) samples_.restart(first);
  window_ = is_whole_ ? survey_.disorder() : 2 * survey_.disorder() + kPipeSlack;
  const auto& sources = samples_.sources();
  info_.tick_rate = survey_.tick_rate();
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    tracks_.emplace_back(survey_.facts(i).first, survey_.moves(i), survey_.moves(i) ? survey_.gap(i) : 0,
                         1'000'000'000 / info_.tick_rate);
  }
  frames_.emplace(samples_, tracks_, notes_);
  std::vector<std::string> left_out = find_objects();
  find_users();
  note_unknown(looked, left_out);
  return {};
}

/// Names of topics and frames are made fit for a trace; where two are alike, a number distinguishes them.
std::string RosAssembler::free_name(std::string name, const std::string& of, std::set<std::string>& names) {
  for (char& c : name)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '_';
  std::string wanted = is_plain_name(name) ? name : "unnamed";
  std::string free = wanted;
  for (int n = 2; !names.insert(free).second; ++n) free = wanted + "_" + std::to_string(n);
  if (free != name) notes_.add(of, "is called " + free);
  return free;
}

/// Objects are the topics with poses, then the frames that hang on others.   out  names of those that are left out
std::vector<std::string> RosAssembler::find_objects() {
  std::vector<std::string> left_out;
  std::map<std::string_view, std::size_t> by_path;
  std::set<std::string> names;
  const auto& sources = samples_.sources();
  const RosSelection wanted{options_.topics, options_.skip};
  for (const Kind kind : {Kind::pose, Kind::link})
    for (std::uint32_t i = 0; i < sources.size(); ++i) {
      const RosSource& source = sources[i];
      if (source.kind != kind || survey_.facts(i).samples == 0 || !wanted.has(source.topic)) continue;
      std::string name = object_name(source.topic, "/pose");
      if (kind == Kind::link) {
        const std::string frame = samples_.name(source.child);
        std::string space = samples_.name(source.space);
        if (!space.empty()) space += '/';
        name = object_name(frame.starts_with(space) ? frame : space + frame, "");
      }
      if (std::ranges::find(options_.skip, name) != options_.skip.end()) {
        left_out.push_back(std::move(name));
        continue;
      }
      if (kind == Kind::pose && !source.is_odometry) by_path[path_of(source.topic)] = objects_.size();
      info_.objects.push_back({free_name(std::move(name), survey_.location_of(i), names), Dof::all});
      objects_.push_back({i});
    }
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    if (sources[i].kind != Kind::twist || survey_.facts(i).samples == 0) continue;
    if (sources[i].is_odometry) {
      for (Object& object : objects_)
        if (sources[object.source].kind == Kind::pose && sources[object.source].topic == sources[i].topic) take_twist(object, i);
    } else if (const auto found = by_path.find(path_of(sources[i].topic)); found != by_path.end()) {
      take_twist(objects_[found->second], i);
    } else {
      notes_.add(sources[i].topic, "no topic of poses is beside it: this twist is ignored");
    }
  }
  return left_out;
}

/// Many programs leave velocities at 0 that they do not know.
void RosAssembler::take_twist(Object& object, std::uint32_t twist) {
  constexpr double kMoved = 0.01, kTurned = 0.02;  // [m], [rad]
  const SourceFacts& pose = survey_.facts(object.source);
  const bool is_left_open = survey_.facts(twist).speed == 0 && (pose.moved > kMoved || pose.turned > kTurned);
  if (!is_left_open) object.twist = twist;
  else notes_.add(survey_.location_of(twist), "is 0 throughout, though the object moves: velocities follow from the poses");
}

/// A name that was typed wrong takes or leaves out nothing.
void RosAssembler::note_unknown(const mcap::Reader& mcap, const std::vector<std::string>& left_out) {
  const auto note = [&](const std::string& name, const char* what) {
    const auto is_it = [&](const auto& channel) { return RosSelection{{name}, {}}.has(channel.second.topic); };
    if (std::ranges::none_of(mcap.channels(), is_it)) notes_.add(name, what);
  };
  for (const std::string& topic : options_.topics) note(topic, "is to be read, but no topic is called so");
  for (const std::string& name : options_.skip)
    if (std::ranges::find(left_out, name) == left_out.end()) note(name, "is to be left out, but no topic or object is called so");
}

/// Users are the topics with forces. They are where the frame of the force is, or the object of a topic beside, if there is one alone.
void RosAssembler::find_users() {
  std::set<std::string> names;
  const auto& sources = samples_.sources();
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    if (sources[i].kind != Kind::force || survey_.facts(i).samples == 0) continue;
    info_.users.push_back({free_name(object_name(sources[i].topic, "/wrench"), sources[i].topic, names)});
    User user{i};
    std::size_t beside = 0;
    for (std::size_t k = 0; k < objects_.size(); ++k) {
      const RosSource& object = sources[objects_[k].source];
      if (object.kind != Kind::pose || path_of(object.topic) != path_of(sources[i].topic)) continue;
      ++beside;
      user.beside = k;
    }
    if (beside != 1) user.beside.reset();
    users_.push_back(user);
  }
}

// ==== samples in order ====

Result<std::optional<RosSample>> RosAssembler::read(mcap::Reader& mcap) {
  if (kept_.empty()) return samples_.next(mcap);
  std::optional<RosSample> sample = kept_.front();
  kept_.pop_front();
  return sample;
}

/// Bring the next sample in order to its track; false when there is none.
Result<bool> RosAssembler::take(mcap::Reader& mcap) {
  while (true) {
    if (const auto sample = order_.take()) {
      if (sample->time < released_) {
        notes_.add(survey_.location_of(sample->source), "came too late to be sorted: left out",
                   survey_.text_of_time(sample->log));
        continue;
      }
      released_ = sample->time;
      tracks_[sample->source].add(*sample);
      return true;
    }
    if (ended_) return false;
    TACTUS_TRY(auto sample, read(mcap));
    if (!sample) {
      ended_ = true;
      order_.end();
      for (const auto& [topic, count] : samples_.late())
        notes_.add(topic, "begins after what of a pipe is looked at: left out; give the file itself");
      continue;
    }
    if (sample->fault != RosFault::none) continue;
    sample->log = survey_.log_of(*sample);
    const std::int64_t added = samples_.sources()[sample->source].is_static ? 0 : survey_.steps().added_at(sample->ordinal);
    const auto time = survey_.clock().time_of(*sample, added);
    if (!time) {
      notes_.add(survey_.location_of(sample->source), "its header stamp is far from its log time: left out",
                 survey_.text_of_time(sample->log));
      continue;
    }
    sample->time = *time;
    if (!survey_.moves(sample->source)) sample->time = std::max(sample->time, released_);
    else
      newest_ = std::max(newest_, std::min(static_cast<std::uint64_t>(static_cast<std::int64_t>(sample->log) + added),
                                           sample->time + window_ / 2));
    order_.add(*sample);
    if (survey_.moves(sample->source) && newest_ > window_) order_.reach(newest_ - window_);
  }
}

// ==== frames ====

Result<bool> RosAssembler::next(mcap::Reader& mcap, TraceFrame& frame) {
  while (true) {
    const std::uint64_t since = time_of_tick(tick_, info_.tick_rate), time = survey_.start() + since;
    bool more = true;
    for (const RosTrack& track : tracks_)
      while (more && !track.is_settled(time, released_)) {
        TACTUS_TRY(more, take(mcap));
      }
    const std::uint64_t near = 500'000'000 / info_.tick_rate;
    bool is_covered = false;
    for (RosTrack& track : tracks_) {
      track.move_to(time);
      is_covered = is_covered || (track.moves() && track.covers(near));
    }
    if (is_covered) {
      TACTUS_CHECK(mcap.spend((objects_.size() + users_.size() + 1) * kCostOfObject));
      fill(frame);
      ++tick_;
      return true;
    }
    TACTUS_TRY(more, skip(mcap, time));
    if (!more) return false;
  }
}

/// On to the tick of the next sample; false at the end.
Result<bool> RosAssembler::skip(mcap::Reader& mcap, std::uint64_t time) {
  while (true) {
    std::optional<std::uint64_t> next;
    std::uint32_t source = 0;  // that goes on first
    for (std::uint32_t i = 0; i < tracks_.size(); ++i)
      if (const auto own = tracks_[i].moves() ? tracks_[i].next_time() : std::nullopt; own && (!next || *own < *next))
        next = own, source = i;
    if (next) {
      const std::uint64_t since = *next - survey_.start();
      if (since / 1'000'000'000 >= static_cast<std::uint64_t>(kMaxSeconds) - 1) {
        const Error error = fail(Errc::invalid, "R-TRC-15", 8 * mcap.offset()).value();
        refused_ = {.error = error,
                    .detail = survey_.location_of(source) + ", at " + std::to_string(since / 1'000'000'000) + " s",
                    .cause = "times go on to more than the 2^31 s that a trace holds",
                    .remedy = "Convert it with `tactus import ros`: --stamps header takes the times of the headers, --skip " +
                              samples_.sources()[source].topic + " leaves the topic out."};
        return tl::unexpected(error);
      }
      tick_ = std::max(tick_ + 1, tick_of_time(since, info_.tick_rate));
      return true;
    }
    TACTUS_TRY(const bool more, take(mcap));
    if (!more) return false;
    for (RosTrack& track : tracks_) track.move_to(time);
  }
}

void RosAssembler::fill(TraceFrame& out) {
  frames_->move();
  out = {};
  out.tick = tick_;
  for (const Object& object : objects_) out.objects.push_back(sample_of(object));
  for (const User& user : users_) out.users.push_back(press(user, out));
}

RigidSample RosAssembler::sample_of(const Object& object) {
  const RosSource& source = samples_.sources()[object.source];
  if (source.kind == Kind::link) return frames_->of_link(object.source);
  RosTrack& track = tracks_[object.source];
  RigidSample placed = hung(frames_->at(source.space, track.frame()), track.state());
  if (!object.twist) return placed;
  const RosTrack& twist_track = tracks_[*object.twist];
  const auto twist = twist_track.twist(500'000'000 / info_.tick_rate);
  if (!twist) return placed;
  const std::uint32_t space = samples_.sources()[*object.twist].space;
  Quat turn = frames_->at(space, twist_track.frame()).pose.rotation;
  const bool is_of_body =
      source.is_odometry && twist_track.frame() != track.frame() && !samples_.link_of(space, twist_track.frame());
  if (is_of_body) turn = placed.pose.rotation;
  placed.velocity = rotate(turn, twist->linear);
  placed.angular_velocity = rotate(turn, twist->angular);
  return placed;
}

UserSample RosAssembler::press(const User& user, const TraceFrame& out) {
  const RosTrack& track = tracks_[user.source];
  const std::uint32_t space = samples_.sources()[user.source].space;
  const Pose frame = frames_->at(space, track.frame()).pose;
  UserSample sample;
  sample.force = sample.server_force = rotate(frame.rotation, track.force());
  if (samples_.link_of(space, track.frame())) sample.device.position = frame.position;
  else if (user.beside) sample.device.position = out.objects[*user.beside].pose.position;
  sample.contact.device = sample.device.position;
  return sample;
}

}  // namespace

tl::expected<std::unique_ptr<FrameAssembler>, Diagnostic> assemble_ros(mcap::Reader& mcap, std::optional<mcap::Reader> ahead,
                                                                       const Preamble& preamble, const ReadOptions& options) {
  auto assembler = std::make_unique<RosAssembler>(preamble, options);
  TACTUS_CHECK(assembler->start(mcap, preamble.item, std::move(ahead)));
  return assembler;
}

}  // namespace tactus
