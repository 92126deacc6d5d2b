// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <set>
#include <string_view>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/trace/mcap_writer.h>
#include <tactus/trace/message_schemas.h>
#include <tactus/trace/messages.h>
#include <tactus/trace/trace_bounds.h>
#include <tactus/trace/trace_capture.h>
#include <tactus/trace/trace_file.h>
#include <tactus/trace/trace_layout.h>

namespace tactus {
namespace {

constexpr std::size_t kChunkBytes = 1u << 20;

template <class Range, class Name>
bool are_names(const Range& range, Name name) {
  std::set<std::string_view> seen;
  return std::all_of(range.begin(), range.end(),
                     [&](const auto& item) { return is_plain_name(name(item)) && seen.insert(name(item)).second; });
}

Result<void> check(const TraceInfo& info) {
  const auto mesh_name = [](const TraceDeformable& mesh) -> const std::string& { return mesh.name; };
  const bool has_names = are_names(info.objects, [](const TraceObject& object) -> const std::string& { return object.name; }) &&
                         are_names(info.users, [](const TraceUser& user) -> const std::string& { return user.name; }) &&
                         are_names(info.meshes, mesh_name);
  const bool has_dofs = std::all_of(info.objects.begin(), info.objects.end(), [](const auto& o) { return o.dof <= Dof::all; });
  const bool is_empty = info.objects.empty() && info.users.empty() && info.meshes.empty();
  const bool has_rate = info.tick_rate >= 1 && info.tick_rate <= kMaxTickRate;
  if (!has_names || !has_dofs || is_empty || !has_rate) return fail(Errc::invalid_argument, "R-TRC-17");
  if (!is_utf8(info.source)) return fail(Errc::invalid_argument, "R-TRC-11");
  for (const TraceDeformable& mesh : info.meshes) {
    if (const auto sound = check(mesh.rest); !sound)
      return tl::unexpected(Error{Errc::invalid_argument, sound.error().error.rule, 0});
    if (!is_valid(mesh)) return fail(Errc::invalid_argument, "R-TRC-17");
  }
  const bool bounds_fit = !info.bounds || (info.bounds->stream.deformables.size() == info.meshes.size() &&
                                           info.bounds->rings.size() == info.meshes.size());
  if (info.capture && !is_valid(*info.capture)) return fail(Errc::invalid_argument, "R-TRC-11");
  if (!bounds_fit) return fail(Errc::invalid_argument, "R-TRC-17");
  return {};
}

bool is_finite(const RigidSample& sample) noexcept {
  return is_finite(sample.pose.position) && is_finite(sample.pose.rotation) && is_finite(sample.velocity) &&
         is_finite(sample.angular_velocity);
}

bool is_finite(const UserSample& user) noexcept {
  return is_finite(user.device.position) && is_finite(user.device.orientation) && is_finite(user.device.velocity) &&
         is_finite(user.force) && is_finite(user.server_force);
}

bool is_finite(const DeformableSample& mesh) noexcept {
  return std::all_of(mesh.displacements.begin(), mesh.displacements.end(), [](float value) { return std::isfinite(value); });
}

static_assert(sizeof(RigidSample) == 13 * sizeof(double), "compared as bytes");

/// Bit for bit.
bool are_same(std::span<const RigidSample> a, std::span<const RigidSample> b) noexcept {
  return std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

bool is_same_pose(const Pose& a, const Pose& b) noexcept { return a.position == b.position && a.rotation == b.rotation; }

template <class Range, class Name>
std::string lines(const Range& range, Name name) {
  std::string text;
  for (const auto& item : range) text.append(text.empty() ? "" : "\n").append(name(item));
  return text;
}

mcap::Metadata metadata_of(const TraceInfo& info) {
  mcap::Metadata metadata{"tactus",
                          {{"format_version", "2"},
                           {"tick_rate", std::to_string(info.tick_rate)},
                           {"source", info.source},
                           {"objects", lines(info.objects, [](const TraceObject& object) { return object.name; })},
                           {"users", lines(info.users, [](const TraceUser& user) { return user.name; })}}};
  if (!info.meshes.empty())
    metadata.entries["meshes"] = lines(info.meshes, [](const TraceDeformable& mesh) { return mesh.name; });
  return metadata;
}

mcap::TextMap metadata_of(const TraceDeformable& mesh) {
  mcap::TextMap metadata;
  std::string fixed;
  for (const std::uint32_t vertex : mesh.fixed) fixed.append(fixed.empty() ? "" : " ").append(std::to_string(vertex));
  if (!fixed.empty()) metadata["fixed"] = std::move(fixed);
  std::array<char, 32> period{};
  const auto end = std::to_chars(period.data(), period.data() + period.size(), mesh.period).ptr;
  if (mesh.period != 1) metadata["period"] = std::string(period.data(), end);
  return metadata;
}

bool is_unknown(const TraceChannel& channel, const TraceInfo& info) {
  if (channel.role == Role::force) return info.users[channel.index].forces == RecordedForces::server;
  return channel.role == Role::server_force && info.users[channel.index].forces == RecordedForces::rendered;
}

/// How ROS 2 is to offer a channel, as rosbag2 writes it: profile "ros2" wants it of every channel. What is sent once must still reach
/// who comes later.
std::string quality_of_service(Occurs occurs) {
  const bool once = occurs == Occurs::first_tick;
  const std::string never = "    sec: 9223372036\n    nsec: 854775807\n";
  return std::string("- history: 1\n  depth: ") + (once ? "1" : "10") +
         "\n  reliability: 1\n  durability: " + (once ? "1" : "2") + "\n  deadline:\n" + never + "  lifespan:\n" + never +
         "  liveliness: 1\n  liveliness_lease_duration:\n" + never + "  avoid_ros_namespace_conventions: false\n";
}

mcap::Attachment scene_of(const TraceInfo& info) {
  return {0, 0, "scene.toml", "application/toml", {reinterpret_cast<const std::uint8_t*>(info.scene.data()), info.scene.size()}};
}

}  // namespace

struct TraceWriter::Impl {
  Impl(mcap::Writer writer, const TraceInfo& trace_info, const TraceWriterOptions& options)
      : mcap(std::move(writer)),
        info(trace_info),
        chunk_time(static_cast<std::uint64_t>(1e9 * options.chunk_time)),
        channels(trace_channels(trace_info)) {
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const Role role = channels[i].role;
      if (role == Role::pose) of_object.push_back(i);
      if (role == Role::pose || role == Role::twist) others = i + 1;
    }
    of_object.push_back(others);
    buttons.resize(info.users.size());
  }
  ~Impl() {
    if (finished) return;
    try {
      (void)mcap.end_chunk();
    } catch (const std::bad_alloc&) {  // the file ends with the chunk before
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Result<void> declare();
  void find_changed(const TraceFrame& frame);
  void keep_time();
  Result<void> check(const TraceFrame& frame) const;
  void write(std::size_t channel, std::uint64_t time, const TraceFrame& frame);
  bool only_meshes() const noexcept { return info.objects.empty() && info.users.empty(); }
  bool can_hold(const UserSample& user) const;
  bool is_due(const TraceChannel& channel, const TraceFrame& frame) const;
  void encode(const TraceChannel& channel, std::uint64_t time, const TraceFrame& frame);

  mcap::Writer mcap;
  TraceInfo info;
  std::uint64_t chunk_time;            // [ns]
  std::vector<TraceChannel> channels;  // channel i has id i + 1
  std::vector<std::uint8_t> message;
  std::int64_t last_tick = -1, last_shown = 0;
  std::vector<std::size_t> of_object;  // first channel of each object, and of what follows them
  std::size_t others = 0;              // first channel of no object
  std::vector<RigidSample> written;    // last
  std::vector<std::uint32_t> changed;  // objects that are not as written
  std::vector<std::uint32_t> buttons;  // of each user, as written last
  bool finished = false;
};

Result<void> TraceWriter::Impl::declare() {
  TACTUS_CHECK(mcap.add(metadata_of(info)));
  if (info.bounds) TACTUS_CHECK(mcap.add(mcap::Metadata{kBoundsMetadata, entries_of(*info.bounds)}));
  if (info.capture) TACTUS_CHECK(mcap.add(mcap::Metadata{kCaptureMetadata, entries_of(*info.capture)}));
  if (!info.scene.empty()) TACTUS_CHECK(mcap.add(scene_of(info)));
  std::set<MessageType> types;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const TraceChannel& channel = channels[i];
    const MessageType type = message_type(channel.role);
    const auto schema_id = static_cast<std::uint16_t>(static_cast<unsigned>(type) + 1);
    if (types.insert(type).second)
      TACTUS_CHECK(mcap.add(mcap::Schema{schema_id, std::string(schema_name(type)), "ros2msg", schema_text(type)}));
    mcap::TextMap metadata;
    if (channel.role == Role::pose) metadata["dof"] = std::to_string(info.objects[channel.index].dof);
    if (channel.role == Role::rest) metadata = metadata_of(info.meshes[channel.index]);
    if (is_unknown(channel, info)) metadata["known"] = "no";
    if (channel.role == Role::reports) metadata["report_descriptor"] = hex_of(*info.users[channel.index].report_descriptor);
    metadata["offered_qos_profiles"] = quality_of_service(channel.occurs);
    TACTUS_CHECK(mcap.add(mcap::Channel{static_cast<std::uint16_t>(i + 1), schema_id, channel.topic, "cdr", metadata}));
  }
  return {};
}

Result<TraceWriter> TraceWriter::create(const std::string& path, const TraceInfo& info, const TraceWriterOptions& options) try {
  TACTUS_CHECK(check(info));
  if (!(options.chunk_time > 0 && options.chunk_time <= 3600)) return fail(Errc::invalid_argument, "R-TRC-17");
  const std::size_t channel_count = trace_channels(info).size();
  if (channel_count > UINT16_MAX) return fail(Errc::invalid_argument, "R-TRC-17");
  TACTUS_TRY(auto mcap, mcap::Writer::create(path, "ros2"));
  auto impl = std::make_unique<Impl>(std::move(mcap), info, options);
  TACTUS_CHECK(impl->declare());
  return TraceWriter(std::move(impl));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

/// Whether a user's contacts are valid, name what is there and belong to the device sample.
bool TraceWriter::Impl::can_hold(const UserSample& user) const {
  if (!is_valid(user.device) || user.device.time / 1'000'000'000 >= kMaxSeconds) return false;
  if (user.servo.lateness < 0 || user.servo.age < 0 || !is_valid(user.reports)) return false;
  const Contact& contact = user.contact;
  if (contact.kind != ContactKind::none &&
      (!is_valid(contact) || contact.object >= info.objects.size() || contact.device != user.device.position))
    return false;
  if (!user.surface_contact) return true;
  const SurfaceContact& touch = *user.surface_contact;
  return is_valid(touch) && touch.mesh < info.meshes.size() && touch.triangle < info.meshes[touch.mesh].rest.triangles.size();
}

Result<void> TraceWriter::Impl::check(const TraceFrame& frame) const {
  const bool has_counts = frame.objects.size() == info.objects.size() && frame.users.size() == info.users.size() &&
                          frame.meshes.size() == info.meshes.size();
  const bool has_tick = frame.tick > last_tick && frame.tick / info.tick_rate < kMaxSeconds;
  const bool has_shown = !info.shows_past || (frame.shown >= last_shown && frame.shown / info.tick_rate < kMaxSeconds);
  if (!has_counts || !has_tick || !has_shown || !is_utf8(frame.marker)) return fail(Errc::invalid_argument, "R-API-5");
  for (const std::uint32_t i : changed) {
    const RigidSample& sample = frame.objects[i];
    if (!is_finite(sample)) return fail(Errc::invalid_argument, "R-API-1");
    if (info.objects[i].dof != Dof::none) continue;
    const bool rests = sample.velocity == Vec3{} && sample.angular_velocity == Vec3{};
    const bool stays = written.empty() || is_same_pose(sample.pose, written[i].pose);
    if (!rests || !stays) return fail(Errc::invalid_argument, "R-API-6");
  }
  for (const UserSample& user : frame.users) {
    if (!is_finite(user)) return fail(Errc::invalid_argument, "R-API-1");
    if (!can_hold(user)) return fail(Errc::invalid_argument, "R-API-5");
  }
  for (std::size_t i = 0; i < frame.meshes.size(); ++i) {
    if (frame.meshes[i].displacements.size() != 3 * info.meshes[i].rest.vertices.size())
      return fail(Errc::invalid_argument, "R-API-5");
    if ((frame.meshes[i].updated || only_meshes()) && !is_finite(frame.meshes[i])) return fail(Errc::invalid_argument, "R-API-1");
  }
  return {};
}

void TraceWriter::Impl::encode(const TraceChannel& channel, std::uint64_t time, const TraceFrame& frame) {
  switch (channel.role) {
    case Role::pose:
      return encode_pose(message, time, frame.objects[channel.index].pose);
    case Role::twist: {
      const RigidSample& sample = frame.objects[channel.index];
      return encode_twist(message, time, {sample.velocity, sample.angular_velocity});
    }
    case Role::device:
      return encode_vector(message, time, frame.users[channel.index].device.position);
    case Role::orientation:
      return encode_quaternion(message, time, frame.users[channel.index].device.orientation);
    case Role::velocity:
      return encode_vector(message, time, frame.users[channel.index].device.velocity);
    case Role::buttons:
      return encode_buttons(message, time, frame.users[channel.index].device.buttons);
    case Role::device_time:
      return encode_time_reference(message, time, frame.users[channel.index].device.time);
    case Role::force:
      return encode_vector(message, time, frame.users[channel.index].force);
    case Role::server_force:
      return encode_vector(message, time, frame.users[channel.index].server_force);
    case Role::contact: {
      const Contact& contact = frame.users[channel.index].contact;
      return encode_contact(message, time, contact, info.objects[contact.object].name);
    }
    case Role::surface_contact: {
      const SurfaceContact& contact = *frame.users[channel.index].surface_contact;
      return encode_mesh_contact(message, time, contact, info.meshes[contact.mesh].name);
    }
    case Role::rest:
      return encode_mesh(message, info.meshes[channel.index].rest);
    case Role::servo:
      return encode_servo(message, time, frame.users[channel.index].servo);
    case Role::reports:
      return encode_reports(message, time, frame.users[channel.index].reports);
    case Role::marker:
      return encode_log(message, time, frame.marker);
    case Role::shown:
      return encode_time_reference(message, time, static_cast<std::int64_t>(time_of_tick(frame.shown, info.tick_rate)));
    case Role::displacement:
      return encode_displacements(message, time, frame.meshes[channel.index].displacements);
  }
}

bool TraceWriter::Impl::is_due(const TraceChannel& channel, const TraceFrame& frame) const {
  switch (channel.occurs) {
    case Occurs::every_tick:
      return true;
    case Occurs::when_changed:  // for objects, only called for those that changed
      return channel.role != Role::buttons || last_tick < 0 ||
             frame.users[channel.index].device.buttons != buttons[channel.index];
    case Occurs::first_tick:
      return last_tick < 0;
    case Occurs::when_marked:
      return !frame.marker.empty();
    case Occurs::when_reported:
      return !frame.users[channel.index].reports.sizes.empty();
    case Occurs::when_updated:
      return frame.meshes[channel.index].updated;
    case Occurs::in_contact:
      break;
  }
  const UserSample& user = frame.users[channel.index];
  return channel.role == Role::surface_contact ? user.surface_contact.has_value() : user.contact.kind != ContactKind::none;
}

/// Many at a time: most of the objects of a large scene rest.
void TraceWriter::Impl::find_changed(const TraceFrame& frame) {
  constexpr std::size_t kAtOnce = 16;
  changed.clear();
  const std::size_t count = std::min(frame.objects.size(), info.objects.size());
  const auto differ = [&](std::size_t i, std::size_t n) {
    return written.empty() || !are_same(std::span(frame.objects).subspan(i, n), std::span(written).subspan(i, n));
  };
  if (frame.changed && !written.empty() && frame.tick == last_tick + 1) {
    for (const std::uint32_t i : *frame.changed)
      if (i < count && differ(i, 1)) changed.push_back(i);
    return keep_time();
  }
  for (std::size_t block = 0; block < count; block += kAtOnce) {
    const std::size_t end = std::min(block + kAtOnce, count);
    if (!differ(block, end - block)) continue;
    for (std::size_t i = block; i < end; ++i)
      if (differ(i, 1)) changed.push_back(static_cast<std::uint32_t>(i));
  }
  keep_time();
}

/// Some channel has every tick.
void TraceWriter::Impl::keep_time() {
  const bool always = !channels.empty() && channels[0].role == Role::pose && channels[0].occurs == Occurs::every_tick;
  if (always && (changed.empty() || changed[0] != 0)) changed.insert(changed.begin(), 0);
}

void TraceWriter::Impl::write(std::size_t channel, std::uint64_t time, const TraceFrame& frame) {
  if (!is_due(channels[channel], frame)) return;
  encode(channels[channel], time, frame);
  mcap.add(mcap::Message{static_cast<std::uint16_t>(channel + 1), static_cast<std::uint32_t>(frame.tick), time, time, message});
}

Result<void> TraceWriter::write(const TraceFrame& frame) try {
  impl_->find_changed(frame);
  TACTUS_CHECK(impl_->check(frame));
  const std::uint64_t time = time_of_tick(frame.tick, impl_->info.tick_rate);
  for (const std::uint32_t i : impl_->changed)
    for (std::size_t k = impl_->of_object[i]; k < impl_->of_object[i + 1]; ++k) impl_->write(k, time, frame);
  for (std::size_t k = impl_->others; k < impl_->channels.size(); ++k) impl_->write(k, time, frame);
  if (impl_->written.empty()) impl_->written = frame.objects;
  for (const std::uint32_t i : impl_->changed) impl_->written[i] = frame.objects[i];
  for (std::size_t i = 0; i < frame.users.size(); ++i) impl_->buttons[i] = frame.users[i].device.buttons;
  impl_->last_tick = frame.tick;
  if (impl_->info.shows_past) impl_->last_shown = frame.shown;
  const bool is_full = impl_->mcap.chunk_size() >= kChunkBytes || time - impl_->mcap.chunk_start_time() >= impl_->chunk_time;
  return is_full ? impl_->mcap.end_chunk() : Result<void>();
} catch (const std::bad_alloc&) {
  impl_->finished = true;  // what it holds of this tick is not whole
  return out_of_memory();
}

Result<void> TraceWriter::finish() try {
  impl_->finished = true;
  return impl_->mcap.finish();
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

TraceWriter::TraceWriter(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
TraceWriter::TraceWriter(TraceWriter&&) noexcept = default;
TraceWriter& TraceWriter::operator=(TraceWriter&&) noexcept = default;
TraceWriter::~TraceWriter() = default;

}  // namespace tactus
