// SPDX-License-Identifier: Apache-2.0
#include <tactus/metrics/compare.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/out_of_memory.h>

namespace tactus {

Result<StreamHeader> stream_header(const TraceInfo& info, const TraceFrame& first, const DeformableCoding& coding) try {
  if (first.objects.size() != info.objects.size()) return fail(Errc::invalid_argument, "R-API-5");
  StreamHeader header;
  header.tick_rate = info.tick_rate;
  constexpr std::uint64_t kSeconds = 2;
  header.max_extrapolation = static_cast<std::uint16_t>(std::clamp<std::uint64_t>(kSeconds * info.tick_rate, 1, 65535));
  for (std::size_t i = 0; i < info.objects.size(); ++i) {
    TACTUS_TRY(const RigidState state, to_grid({first.objects[i].pose, {}, {}}, 0, header.grid));
    header.objects.push_back({info.objects[i].name, info.objects[i].dof, state});
  }
  for (const TraceDeformable& mesh : info.meshes) {
    TACTUS_TRY(DeformableObject object, deformable_object(mesh, coding, header.grid.position));
    header.meshes.push_back(std::move(object));
  }
  TACTUS_CHECK(check_header(header));
  return header;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

StreamPlayer::StreamPlayer(std::span<const std::uint8_t> file, StreamFileReader reader, RigidDecoder decoder,
                           Replica replica) noexcept
    : file_(file), reader_(std::move(reader)), decoder_(std::move(decoder)), replica_(std::move(replica)) {}

Result<StreamPlayer> StreamPlayer::open(std::span<const std::uint8_t> file, const ReplicaOptions& options) try {
  TACTUS_TRY(StreamFileReader reader, StreamFileReader::open(file));
  TACTUS_TRY(RigidDecoder decoder, RigidDecoder::create(reader.header()));
  TACTUS_TRY(Replica replica, Replica::create(reader.header(), options));
  StreamPlayer player(file, std::move(reader), std::move(decoder), std::move(replica));
  for (std::size_t i = 0; i < player.header().meshes.size(); ++i) {
    TACTUS_TRY(DeformableDecoder mesh, DeformableDecoder::create(player.header(), i));
    player.meshes_.push_back(std::move(mesh));
  }
  return player;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<std::optional<std::int64_t>> StreamPlayer::next_tick() noexcept {
  if (!waiting_) {
    TACTUS_TRY(waiting_, reader_.next());
  }
  return waiting_ ? std::optional(waiting_->tick) : std::nullopt;
}

Result<std::optional<StreamPlayer::Played>> StreamPlayer::play(std::int64_t tick) noexcept {
  TACTUS_TRY(const auto due, next_tick());
  if (!due || *due > tick) return std::optional<Played>{};
  const std::span<const std::uint8_t> bytes = waiting_->bytes;
  const auto offset = static_cast<std::size_t>(bytes.data() - file_.data());
  waiting_.reset();
  const auto refuse = [offset](const Error& error, std::size_t skipped) {
    return fail(error.code, error.rule, 8 * std::uint64_t{offset + skipped} + error.bit_offset);
  };
  const auto split = split_part(header(), bytes);
  if (!split) return refuse(split.error(), 0);
  auto played = decode(*split);
  if (!played) return refuse(played.error(), bytes.size() - split->bytes.size());
  if (played->tick() != *due) return fail(Errc::invalid, "R-FIL-7", 8 * std::uint64_t{offset});
  if (played->part == 0) replica_.apply(played->packet, decoder_.objects(), *due);
  played->bytes = bytes.size();
  played->offset = offset;
  return std::optional(*played);
}

Result<StreamPlayer::Played> StreamPlayer::decode(const PartPacket& packet) noexcept {
  Played out;
  out.part = packet.part;
  if (packet.part == 0) {
    TACTUS_TRY(out.packet, decoder_.decode(packet.bytes));
  } else {
    TACTUS_TRY(out.mesh, meshes_[packet.part - 1].decode(packet.bytes));
  }
  return out;
}

Pose StreamPlayer::pose(std::uint32_t object, std::int64_t tick) const noexcept {
  return to_pose(replica_.pose(object, tick), header().grid);
}

void RateMetrics::add(Reason reason, std::uint64_t update_count, std::uint64_t byte_count, bool key) noexcept {
  ++packets[static_cast<std::size_t>(reason)];
  updates += update_count;
  bytes += byte_count;
  keys += key ? 1 : 0;
}

Reason strongest_reason(const DecodedPacket& packet) noexcept {
  Reason strongest = Reason::request;
  for (const RigidUpdate& update : packet.updates) strongest = std::max(strongest, update.reason);
  return strongest;
}

void ErrorSeries::add(double error, bool over) noexcept {
  ++samples_;
  square_sum_ += error * error;
  max_ = std::max(max_, error);
  sampled_ = true;
  over_ = over_ || over;
}

void ErrorSeries::end_tick(std::int64_t tick) noexcept {
  ticks_ += sampled_ ? 1 : 0;
  ticks_over_ += over_ ? 1 : 0;
  if (over_) run_.add(tick);
  else run_ = {};
  longest_run_ = std::max(longest_run_, run_.length());
  sampled_ = over_ = false;
}

double ErrorSeries::rms() const noexcept { return samples_ == 0 ? 0 : std::sqrt(square_sum_ / static_cast<double>(samples_)); }

ErrorMetrics::ErrorMetrics(const TraceInfo& info, const RigidTriggers& bounds) : bounds_(bounds) {
  for (std::uint32_t i = 0; i < info.objects.size(); ++i) {
    if (info.objects[i].dof != Dof::none) moving_.push_back(i);
  }
}

bool ErrorMetrics::breaks_rule(const Pose& truth, const Pose& shown, const Vec3& force, const Vec3& estimate) noexcept {
  if (bounds_.haptic == HapticRule::fixed) {
    const double distance = norm(shown.position - truth.position) / bounds_.fixed_position;
    const double angle = angle_between(truth.rotation, shown.rotation) / bounds_.fixed_rotation;
    worst_ratio_ = std::max({worst_ratio_, distance, angle});
    return std::max(distance, angle) > 1;
  }
  const double ratio = haptic_ratio(bounds_, force, estimate);
  worst_ratio_ = std::max(worst_ratio_, ratio);
  return ratio > 1;
}

/// Below the force floor the permitted error stays that of the floor, as in the haptic rule.
bool ErrorMetrics::is_perceptible(double force, double error) const noexcept {
  return error > perceptual_fraction(force) * std::max(force, bounds_.force_floor);
}

void ErrorMetrics::add(const TraceFrame& truth, std::span<const Pose> shown) noexcept {
  for (const std::uint32_t i : moving_) {
    const Pose& pose = truth.objects[i].pose;
    const double distance = norm(shown[i].position - pose.position);
    const double angle = angle_between(pose.rotation, shown[i].rotation);
    position_.add(distance, distance > bounds_.visual_position);
    rotation_.add(angle, angle > bounds_.visual_rotation);
  }
  for (const UserSample& user : truth.users) {
    if (user.contact.kind == ContactKind::none) continue;
    const std::uint32_t object = user.contact.object;
    const Pose& pose = truth.objects[object].pose;
    const Vec3 force = contact_force(user.contact, pose);
    const Vec3 estimate = contact_force(user.contact, shown[object]);
    const double error = norm(estimate - force);
    force_.add(error, breaks_rule(pose, shown[object], force, estimate));
    perceived_.add(error, is_perceptible(norm(force), error));
  }
  for (ErrorSeries* series : {&position_, &rotation_, &force_, &perceived_}) series->end_tick(truth.tick);
}

void ErrorMetrics::add_rendered(const TraceFrame& truth) noexcept {
  for (const UserSample& user : truth.users) {
    const double force = norm(user.server_force);
    if (force == 0 && norm(user.force) == 0) continue;
    const double error = norm(user.force - user.server_force);
    rendered_.add(error, is_perceptible(force, error));
  }
  rendered_.end_tick(truth.tick);
}

}  // namespace tactus
