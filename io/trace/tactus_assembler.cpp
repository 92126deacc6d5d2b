// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/trace/frame_assembler.h>
#include <tactus/trace/message_schemas.h>
#include <tactus/trace/messages.h>
#include <tactus/trace/trace_bounds.h>
#include <tactus/trace/trace_capture.h>
#include <tactus/trace/trace_layout.h>

namespace tactus {
namespace {

// [bytes] of the budget for each static object repeated at a tick. Less than its true size, so that scenes with a thousand static
// objects stay readable.
constexpr std::uint64_t kCostOfStatic = 32;

std::vector<std::string> split_lines(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::string_view entry(const mcap::TextMap& map, const char* key) {
  const auto found = map.find(key);
  return found == map.end() ? std::string_view() : found->second;
}

/// Read fixed vertices and period; false if the text is malformed.
bool read_metadata(const mcap::TextMap& metadata, TraceDeformable& mesh) {
  std::string_view fixed = entry(metadata, "fixed"), period = entry(metadata, "period");
  while (!fixed.empty()) {
    const std::size_t end = std::min(fixed.find(' '), fixed.size());
    const auto vertex = parse_number<std::uint32_t>(fixed.substr(0, end));
    if (!vertex) return false;
    mesh.fixed.push_back(*vertex);
    fixed.remove_prefix(std::min(end + 1, fixed.size()));
  }
  if (period.empty()) return true;
  const auto ticks = parse_number<double>(period);
  mesh.period = ticks.value_or(0);
  return ticks.has_value();
}

class TactusAssembler final : public FrameAssembler {
 public:
  Result<void> start(mcap::Reader& mcap, const Preamble& preamble);
  Result<bool> next(mcap::Reader& mcap, TraceFrame& frame) override;
  const TraceInfo& info() const noexcept override { return info_; }
  std::optional<std::uint16_t> frame_channel() const noexcept override { return frame_channel_; }

 private:
  struct Route {
    TraceChannel channel;
    std::int64_t last_tick = -1;
  };
  Result<void> find_channels(const mcap::Reader& mcap, Errc missing);
  Result<void> read_rest(mcap::Reader& mcap);
  enum class Assembled : std::uint8_t { whole, left_out, ended };
  Result<bool> assemble(mcap::Reader& mcap);
  Result<Assembled> assemble_tick(mcap::Reader& mcap);
  Result<void> advance(mcap::Reader& mcap);
  Result<void> take(const mcap::Reader& mcap, std::int64_t tick);
  Result<std::uint64_t> store(const mcap::Reader& mcap, const TraceChannel& channel);
  Result<std::uint64_t> store_shown(std::span<const std::uint8_t> data);
  Result<std::uint64_t> store_user(std::span<const std::uint8_t> data, const TraceChannel& channel);
  bool is_complete(std::int64_t tick, bool skips_damage) const noexcept;
  void deliver(TraceFrame& frame) const;

  TraceInfo info_;
  std::map<std::uint16_t, Route> routes_;  // by channel id
  std::uint64_t static_objects_ = 0;
  std::optional<std::uint16_t> frame_channel_;
  mcap::Item item_ = mcap::Item::end;  // where the reader stands: at a message of a route, or at the end
  std::int64_t last_tick_ = -1;
  bool poses_come_every_tick_ = false;
  TraceFrame current_;
  bool ahead_ = false;  // current_ was not delivered
};

tl::unexpected<Error> refuse(const mcap::Reader& mcap, Errc code, RuleName rule) noexcept {
  return fail(code, rule, 8 * mcap.offset());
}

tl::unexpected<Error> refuse(const mcap::Reader& mcap, const Error& error) noexcept { return fail_at(error, 8 * mcap.offset()); }

Result<void> TactusAssembler::start(mcap::Reader& mcap, const Preamble& preamble) {
  const mcap::TextMap& tactus = *preamble.tactus;
  const std::string_view version = entry(tactus, "format_version");
  if (version != "1" && version != "2") return refuse(mcap, Errc::unsupported, "R-TRC-7");
  poses_come_every_tick_ = version == "1";
  const auto tick_rate = parse_number<std::uint32_t>(entry(tactus, "tick_rate"));
  if (!tick_rate || *tick_rate < 1 || *tick_rate > kMaxTickRate) return refuse(mcap, Errc::invalid, "R-TRC-12");
  info_.tick_rate = *tick_rate;
  info_.source = entry(tactus, "source");
  info_.scene = preamble.scene;
  for (std::string& name : split_lines(entry(tactus, "objects"))) info_.objects.push_back({std::move(name), Dof::all});
  for (std::string& name : split_lines(entry(tactus, "users"))) info_.users.push_back({std::move(name)});
  for (std::string& name : split_lines(entry(tactus, "meshes"))) info_.meshes.push_back({std::move(name), {}});
  const bool has_names =
      std::all_of(info_.objects.begin(), info_.objects.end(), [](const auto& o) { return is_plain_name(o.name); }) &&
      std::all_of(info_.users.begin(), info_.users.end(), [](const auto& u) { return is_plain_name(u.name); }) &&
      std::all_of(info_.meshes.begin(), info_.meshes.end(), [](const auto& m) { return is_plain_name(m.name); });
  if (!has_names || (info_.objects.empty() && info_.users.empty() && info_.meshes.empty()))
    return refuse(mcap, Errc::invalid, "R-TRC-12");
  if (preamble.bounds) {
    info_.bounds = bounds_from(*preamble.bounds, info_);
    if (!info_.bounds) return refuse(mcap, Errc::invalid, "R-TRC-12");
  }
  if (preamble.capture) {
    info_.capture = capture_from(*preamble.capture);
    if (!info_.capture) return refuse(mcap, Errc::invalid, "R-TRC-12");
  }
  item_ = preamble.item;
  const bool ended_early = item_ == mcap::Item::end && mcap.cut_short();
  TACTUS_CHECK(find_channels(mcap, ended_early ? Errc::truncated : Errc::invalid));
  current_.objects.resize(info_.objects.size());
  current_.users.resize(info_.users.size());
  if (item_ == mcap::Item::message && !routes_.contains(mcap.message().channel_id)) TACTUS_CHECK(advance(mcap));
  return info_.meshes.empty() ? Result<void>() : read_rest(mcap);
}

/// Read the first tick: it holds the rest shapes, which belong to the description.
Result<void> TactusAssembler::read_rest(mcap::Reader& mcap) {
  current_.meshes.resize(info_.meshes.size());
  if (item_ == mcap::Item::end && !mcap.cut_short()) return refuse(mcap, Errc::invalid, "R-TRC-15");
  TACTUS_TRY(ahead_, assemble(mcap));
  return ahead_ ? Result<void>() : refuse(mcap, Errc::truncated, "R-TRC-3");
}

/// None: the channels say that neither is known.
std::optional<RecordedForces> recorded_forces(const std::map<std::string_view, const mcap::Channel*>& by_topic,
                                              const std::string& user) {
  const auto is_known = [&](const char* force) {
    const auto found = by_topic.find("/users/" + user + force);
    return found == by_topic.end() || entry(found->second->metadata, "known") != "no";
  };
  if (is_known("/server_force")) return is_known("/force") ? RecordedForces::both : RecordedForces::server;
  return is_known("/force") ? std::optional(RecordedForces::rendered) : std::nullopt;
}

/// Channels are found by topic: ids may change when other tools rewrite a file.
Result<void> TactusAssembler::find_channels(const mcap::Reader& mcap, Errc missing) {
  const RuleName rule = missing == Errc::truncated ? RuleName("R-TRC-3") : RuleName("R-TRC-12");
  std::map<std::string_view, const mcap::Channel*> by_topic;
  for (const auto& [id, channel] : mcap.channels())
    if (!by_topic.emplace(channel.topic, &channel).second) return refuse(mcap, Errc::invalid, "R-TRC-12");
  for (TraceObject& object : info_.objects) {
    const auto found = by_topic.find("/objects/" + object.name + "/pose");
    if (found == by_topic.end()) return refuse(mcap, missing, rule);
    const auto dof = parse_number<std::uint8_t>(entry(found->second->metadata, "dof"));
    if (!dof || *dof > Dof::all) return refuse(mcap, Errc::invalid, "R-TRC-12");
    object.dof = *dof;
    static_objects_ += object.dof == Dof::none ? 1 : 0;
  }
  for (TraceDeformable& mesh : info_.meshes) {
    const auto found = by_topic.find("/meshes/" + mesh.name + "/rest");
    if (found == by_topic.end()) return refuse(mcap, missing, rule);
    if (!read_metadata(found->second->metadata, mesh)) return refuse(mcap, Errc::invalid, "R-TRC-12");
  }
  for (TraceUser& user : info_.users) {
    const auto has = [&](const char* channel) { return by_topic.contains("/users/" + user.name + channel); };
    user.senses = {has("/device_orientation"), has("/device_velocity"), has("/device_buttons"), has("/device_time")};
    user.has_servo = has("/servo");
    const auto forces = recorded_forces(by_topic, user.name);
    if (!forces) return refuse(mcap, Errc::invalid, "R-TRC-12");
    user.forces = *forces;
    if (!has("/device_reports")) continue;
    const mcap::Channel& reports = *by_topic.at("/users/" + user.name + "/device_reports");
    user.report_descriptor = bytes_of_hex(entry(reports.metadata, "report_descriptor"));
    if (!user.report_descriptor) return refuse(mcap, Errc::invalid, "R-TRC-12");
  }
  info_.shows_past = by_topic.contains(kShownTopic);
  for (TraceChannel& wanted : trace_channels(info_)) {
    const auto found = by_topic.find(wanted.topic);
    if (found == by_topic.end()) return refuse(mcap, missing, rule);
    const mcap::Channel& channel = *found->second;
    if (!carries(mcap, channel, schema_name(message_type(wanted.role)))) return refuse(mcap, Errc::invalid, "R-TRC-12");
    if (wanted.occurs == Occurs::when_changed && poses_come_every_tick_) wanted.occurs = Occurs::every_tick;
    if (wanted.occurs == Occurs::every_tick && !frame_channel_) frame_channel_ = channel.id;
    if (!routes_.emplace(channel.id, Route{std::move(wanted)}).second) return refuse(mcap, Errc::invalid, "R-TRC-12");
  }
  return {};
}

Result<void> TactusAssembler::advance(mcap::Reader& mcap) {
  do {
    TACTUS_TRY(item_, mcap.next());
  } while (item_ != mcap::Item::end && (item_ != mcap::Item::message || !routes_.contains(mcap.message().channel_id)));
  return {};
}

Result<bool> TactusAssembler::next(mcap::Reader& mcap, TraceFrame& frame) {
  if (!std::exchange(ahead_, false)) {
    TACTUS_TRY(const bool more, assemble(mcap));
    if (!more) return false;
  }
  deliver(frame);
  return true;
}

/// A shape that is not new is still in the frame from the previous call, unless the caller gives another frame.
void TactusAssembler::deliver(TraceFrame& frame) const {
  frame.tick = current_.tick;
  frame.shown = current_.shown;
  frame.marker = current_.marker;
  frame.objects = current_.objects;
  frame.changed.reset();
  frame.users = current_.users;
  frame.meshes.resize(current_.meshes.size());
  for (std::size_t i = 0; i < current_.meshes.size(); ++i) {
    const DeformableSample& shape = current_.meshes[i];
    frame.meshes[i].updated = shape.updated;
    if (shape.updated || frame.meshes[i].displacements.size() != shape.displacements.size())
      frame.meshes[i].displacements = shape.displacements;
  }
}

/// Put the messages of the next tick into current_; false at the end.
Result<bool> TactusAssembler::assemble(mcap::Reader& mcap) {
  for (;;) {
    TACTUS_TRY(const Assembled assembled, assemble_tick(mcap));
    if (assembled != Assembled::left_out) return assembled == Assembled::whole;
  }
}

Result<TactusAssembler::Assembled> TactusAssembler::assemble_tick(mcap::Reader& mcap) {
  if (item_ == mcap::Item::end) return Assembled::ended;
  const std::uint64_t time = mcap.message().log_time;
  const std::int64_t tick = tick_of_time(time, info_.tick_rate);
  if (tick <= last_tick_ || tick / info_.tick_rate >= kMaxSeconds) {
    if (!mcap.skips_damage()) return refuse(mcap, Errc::invalid, "R-TRC-15");
    mcap.lose_message(fail(Errc::invalid, "R-TRC-15").value());
    TACTUS_CHECK(advance(mcap));
    return Assembled::left_out;
  }
  TACTUS_CHECK(mcap.spend(static_objects_ * kCostOfStatic));
  current_.tick = tick;
  current_.marker.clear();
  for (DeformableSample& mesh : current_.meshes) mesh.updated = false;
  for (UserSample& user : current_.users) {
    user.contact = Contact{};
    user.surface_contact.reset();
    user.reports.sizes.clear();
    user.reports.bytes.clear();
  }
  bool is_spoilt = false;
  while (item_ == mcap::Item::message && mcap.message().log_time == time) {
    if (const auto taken = take(mcap, tick); !taken) {
      if (!mcap.skips_damage()) return tl::unexpected(taken.error());
      mcap.lose_message(taken.error());
      is_spoilt = true;
    }
    TACTUS_CHECK(advance(mcap));
  }
  if (is_spoilt || !is_complete(tick, mcap.skips_damage())) {
    if (item_ == mcap::Item::end && mcap.cut_short()) return Assembled::ended;
    if (!mcap.skips_damage()) return refuse(mcap, Errc::invalid, "R-TRC-15");
    if (!is_spoilt) mcap.lose_tick(fail(Errc::invalid, "R-TRC-15").value(), time);
    return Assembled::left_out;
  }
  last_tick_ = tick;
  return Assembled::whole;
}

Result<void> TactusAssembler::take(const mcap::Reader& mcap, std::int64_t tick) {
  const mcap::Message& message = mcap.message();
  Route& route = routes_.at(message.channel_id);
  const auto stamp = store(mcap, route.channel);
  if (!stamp) return refuse(mcap, stamp.error());
  const std::uint64_t time = time_of_tick(tick, info_.tick_rate);
  const bool agrees = message.log_time == time && *stamp == time && message.sequence == static_cast<std::uint32_t>(tick);
  const bool is_due = route.last_tick < tick && (route.channel.occurs != Occurs::first_tick || last_tick_ < 0);
  if (!agrees || !is_due) return refuse(mcap, Errc::invalid, "R-TRC-15");
  route.last_tick = tick;
  return {};
}

/// Put a message's value into the current frame; the result is the time of its header.
Result<std::uint64_t> TactusAssembler::store(const mcap::Reader& mcap, const TraceChannel& channel) {
  const auto data = mcap.message().data;
  if (channel.role == Role::pose) {
    TACTUS_TRY(const auto pose, decode_pose(data));
    current_.objects[channel.index].pose = pose.value;
    return pose.time;
  }
  if (channel.role == Role::twist) {
    TACTUS_TRY(const auto twist, decode_twist(data));
    current_.objects[channel.index].velocity = twist.value.linear;
    current_.objects[channel.index].angular_velocity = twist.value.angular;
    return twist.time;
  }
  if (channel.role == Role::rest) {
    TriMesh& rest = info_.meshes[channel.index].rest;
    TACTUS_TRY(rest, decode_mesh(data));
    if (!is_valid(info_.meshes[channel.index])) return fail(Errc::invalid, "R-TRC-12");
    current_.meshes[channel.index].displacements.assign(3 * rest.vertices.size(), 0.0F);
    return mcap.message().log_time;  // it has no header
  }
  if (channel.role == Role::displacement) {
    DeformableSample& mesh = current_.meshes[channel.index];
    mesh.updated = true;
    return decode_displacements(data, mesh.displacements);
  }
  if (channel.role == Role::marker) {
    TACTUS_TRY(const auto entry, decode_log(data));
    current_.marker = entry.value;
    return entry.time;
  }
  return channel.role == Role::shown ? store_shown(data) : store_user(data, channel);
}

Result<std::uint64_t> TactusAssembler::store_shown(std::span<const std::uint8_t> data) {
  TACTUS_TRY(const auto reference, decode_time_reference(data));
  const auto time = static_cast<std::uint64_t>(reference.value);
  const std::int64_t shown = tick_of_time(time, info_.tick_rate);
  if (shown < current_.shown || time_of_tick(shown, info_.tick_rate) != time) return fail(Errc::invalid, "R-TRC-15");
  current_.shown = shown;
  return reference.time;
}

/// Put a user's value into its member; the result is the time of its header.
template <class T>
Result<std::uint64_t> keep(const Result<Stamped<T>>& message, T& member) noexcept {
  if (!message) return tl::unexpected(message.error());
  member = message->value;
  return message->time;
}

Result<std::uint64_t> TactusAssembler::store_user(std::span<const std::uint8_t> data, const TraceChannel& channel) {
  UserSample& user = current_.users[channel.index];
  if (channel.role == Role::surface_contact) {
    TACTUS_TRY(const auto contact, decode_mesh_contact(data));
    const SurfaceContact& touch = contact.value;
    const bool is_there = touch.mesh < info_.meshes.size() && touch.triangle < info_.meshes[touch.mesh].rest.triangles.size();
    if (!is_there) return fail(Errc::invalid, "R-TRC-14");
    user.surface_contact = touch;
    return contact.time;
  }
  if (channel.role == Role::contact) {
    TACTUS_TRY(auto contact, decode_contact(data));
    if (contact.value.object >= info_.objects.size()) return fail(Errc::invalid, "R-TRC-14");
    contact.value.device = user.device.position;
    user.contact = contact.value;
    return contact.time;
  }
  if (channel.role == Role::orientation) {
    TACTUS_TRY(const auto orientation, decode_quaternion(data));
    user.device.orientation = orientation.value;
    if (!is_valid(user.device)) return fail(Errc::invalid, "R-TRC-14");
    return orientation.time;
  }
  if (channel.role == Role::buttons) return keep(decode_buttons(data), user.device.buttons);
  if (channel.role == Role::servo) return keep(decode_servo(data), user.servo);
  if (channel.role == Role::reports) return decode_reports(data, user.reports);
  if (channel.role == Role::device_time) return keep(decode_time_reference(data), user.device.time);
  TACTUS_TRY(const auto vector, decode_vector(data));
  if (channel.role == Role::device) user.device.position = vector.value;
  if (channel.role == Role::velocity) user.device.velocity = vector.value;
  if (channel.role == Role::force) user.force = vector.value;
  if (channel.role == Role::server_force) user.server_force = vector.value;
  return vector.time;
}

/// What is said once may have been said in a tick that is left out.
bool TactusAssembler::is_complete(std::int64_t tick, bool skips_damage) const noexcept {
  return std::all_of(routes_.begin(), routes_.end(), [&](const auto& entry) {
    const Route& route = entry.second;
    const Occurs occurs = route.channel.occurs;
    const bool is_due =
        occurs == Occurs::every_tick || (last_tick_ < 0 && (occurs == Occurs::first_tick || occurs == Occurs::when_changed));
    return !is_due || route.last_tick == tick || (skips_damage && occurs != Occurs::every_tick && route.last_tick >= 0);
  });
}

}  // namespace

Result<std::unique_ptr<FrameAssembler>> assemble_tactus(mcap::Reader& mcap, const Preamble& preamble) {
  auto assembler = std::make_unique<TactusAssembler>();
  TACTUS_CHECK(assembler->start(mcap, preamble));
  return assembler;
}

}  // namespace tactus
