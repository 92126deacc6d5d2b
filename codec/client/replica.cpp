// SPDX-License-Identifier: Apache-2.0
#include <tactus/client/replica.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <tactus/base/bytes.h>
#include <tactus/base/fixed.h>
#include <tactus/base/rule.h>
#include <tactus/deformable/deformable_decoder.h>
#include <tactus/rigid/curve.h>

namespace tactus {

// ==== timeline ====

// ==== timeline ====

namespace {

bool is_before(const Timeline::Update& a, const Timeline::Update& b) noexcept {
  return std::tie(a.state.tick, a.number) < std::tie(b.state.tick, b.number);
}

}  // namespace

void Timeline::reset(const RigidState& initial) noexcept {
  updates_[0] = {0, initial};
  count_ = 1;
}

void Timeline::add(const Update& update) noexcept {
  std::size_t at = count_;
  while (at > 0 && is_before(update, updates_[at - 1])) --at;
  const auto begin = updates_.begin();
  if (count_ < kMost) {
    std::move_backward(begin + at, begin + count_, begin + count_ + 1);
    ++count_;
  } else {
    if (at == 0) return;
    std::move(begin + 1, begin + at, begin);
    --at;
  }
  updates_[at] = update;
}

Timeline::Around Timeline::around(std::int64_t tick) const noexcept {
  std::size_t after = count_;
  while (after > 0 && updates_[after - 1].state.tick > tick) --after;
  const std::size_t before = after > 0 ? after - 1 : 0;
  return {updates_[before], before + 1 < count_ ? &updates_[before + 1] : nullptr};
}

void HeardPackets::add(std::uint64_t number) noexcept {
  if (newest_ == 0 || number > newest_ + kReach) {
    bits_ = {};
    newest_ = number;
  }
  for (; newest_ < number; bits_[word(newest_)] &= ~(std::uint64_t{1} << (newest_ % 64))) ++newest_;
  if (newest_ - number < kReach) bits_[word(number)] |= std::uint64_t{1} << (number % 64);
}

bool HeardPackets::all_between(std::uint64_t first, std::uint64_t last) const noexcept {
  if (last > first + kReach) return false;
  for (std::uint64_t number = first + 1; number < last; ++number)
    if (!has(number)) return false;
  return true;
}

// ==== bend ====

RigidPose bend(const Scene& scene, const RigidState& a, const RigidState& b, std::int64_t tick) noexcept {
  const RigidPredictor predictor(scene);
  const std::int64_t whole = b.tick - a.tick;
  const std::int64_t share = round_div((tick - a.tick) << 30, whole);
  const Cubic curve = cubic(share);
  const bool is_moving = !is_zero(a.velocity) || !is_zero(b.velocity);
  const bool is_turning = !is_zero(a.angular_velocity) || !is_zero(b.angular_velocity);
  const PoseOffset error = offset_between(predictor.pose(a, b.tick), {b.position, b.rotation});
  const PoseOffset change = change_between(scene, predictor.motion(a, b.tick, {}), {b.velocity, b.angular_velocity}, whole);
  return displaced(predictor.pose(a, tick), error, change,
                   {is_moving ? curve.error : share, is_turning ? curve.error : share, curve.change});
}

// ==== replica ====

Result<void> Replica::check(const ReplicaOptions& options, const Scene& scene) noexcept {
  const bool valid = options.share > 0 && options.share <= 1 && options.shortest >= 0 && options.shortest <= options.longest &&
                     options.longest <= 10;
  const bool smooths = options.interpolation != Interpolation::none && options.interpolation != Interpolation::playout;
  if (!valid || (smooths && scene.is_eased)) return fail(Errc::invalid_argument, "R-API-4");
  return {};
}

Replica::Replica(const Scene& scene, const ReplicaOptions& options, std::vector<DeformableDecoder*> shapes)
    : scene_(scene),
      predictor_(scene),
      interpolation_(options.interpolation),
      share_(static_cast<std::uint32_t>(std::floor(options.share * 65536 + 0.5))),
      shortest_(static_cast<std::int64_t>(std::floor(options.shortest * scene.tick_rate + 0.5))),
      longest_(static_cast<std::int64_t>(std::floor(options.longest * scene.tick_rate + 0.5))),
      reach_(std::min<std::int64_t>(round_div(300 * std::int64_t{scene.tick_rate}, 1000), scene.max_extrapolation)),
      tracks_(interpolation_ == Interpolation::playout ? 0 : scene.objects.size()),
      timelines_(interpolation_ == Interpolation::playout ? scene.objects.size() : 0),
      shapes_(std::move(shapes)) {
  reset_timelines();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    tracks_[i].path.object = static_cast<std::uint32_t>(i);
    tracks_[i].path.state.position = scene.objects[i].initial.position;
    tracks_[i].path.state.rotation = scene.objects[i].initial.rotation;
  }
}

/// t_N in ticks: share of the mean gap, clipped; 0 while no gap is known. spec 60-client 3
std::int64_t Replica::interval(const Track& track) const noexcept {
  if (track.gap_count == 0) return 0;
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < track.gap_count; ++i) sum += track.gaps[i];
  const std::int64_t mean_share = round_div(sum * share_, static_cast<std::int64_t>(track.gap_count) << 16);
  return std::clamp(mean_share, shortest_, longest_);
}

void Replica::reset_timelines() noexcept {
  heard_.reset();
  for (std::size_t i = 0; i < timelines_.size(); ++i) {
    const RigidPose& initial = scene_.objects[i].initial;
    timelines_[i].reset({.position = initial.position, .rotation = initial.rotation});
  }
}

void Replica::add_to_timelines(const DecodedPacket& packet, std::span<const RigidState> objects) noexcept {
  if (packet.restarts) reset_timelines();
  heard_.add(packet.number);
  for (const RigidUpdate& update : packet.updates) timelines_[update.object].add({packet.number, objects[update.object]});
}

void Replica::apply(const DecodedPacket& packet, std::span<const RigidState> objects, std::int64_t arrival) noexcept {
  if (interpolation_ == Interpolation::playout) return add_to_timelines(packet, objects);
  for (const RigidUpdate& update : packet.updates) {
    Track& track = tracks_[update.object];
    if (packet.number < track.number) continue;  // overtaken by a newer update of this object
    track.number = packet.number;
    const std::int64_t now = std::max({arrival, packet.tick, track.last_arrival});
    const RigidPose shown = pose(update.object, now);
    const RigidMotion before = motion(track, now);
    const bool running = now < track.end;
    if (track.last_arrival >= 0) {
      track.gaps[track.gap_next] = saturate32(now - track.last_arrival);
      track.gap_next = static_cast<std::uint8_t>((track.gap_next + 1) % kArrivals);
      track.gap_count = std::min<std::uint8_t>(static_cast<std::uint8_t>(track.gap_count + 1), kArrivals);
    }
    track.last_arrival = now;
    track.path.follow(predictor_, objects[update.object]);
    track.begin = track.end = now;
    if (interpolation_ == Interpolation::none || running) continue;
    track.end = now + interval(track);
    track.error = offset_between(predictor_.shown(update.object, track.path.state, now), shown);
    if (interpolation_ != Interpolation::linear)
      track.change = change_between(scene_, before, motion(track, now), track.end - now);
  }
}

/// Velocities of dead reckoning at `now`: none once it has come to rest.
RigidMotion Replica::motion(const Track& track, std::int64_t now) const noexcept {
  if (now - track.path.state.tick >= scene_.max_extrapolation) return {};
  return predictor_.motion(track.path.state, now, {});
}

/// spec 60-client 7.   pre  a.state.tick <= tick, and tick <= b->state.tick if there is a b
RigidPose Replica::path_between(std::uint32_t object, const Timeline::Update& a, const Timeline::Update* b,
                                std::int64_t tick) const noexcept {
  const bool is_whole = b == nullptr || a.number == 0 || b->state.tick == a.state.tick || b->state.tick - a.state.tick > reach_ ||
                        heard_.all_between(a.number, b->number);
  return is_whole ? predictor_.shown(object, a.state, tick) : bend(scene_, a.state, b->state, tick);
}

/// What was left to go at the tick of an update: from the updates before it, back to one whose own easing was over when the next came.
PoseOffset Replica::past_offset(std::uint32_t object, const Timeline::Update& update) const noexcept {
  const Timeline& timeline = timelines_[object];
  const Timeline::Update* at = &update;
  for (const auto* z = timeline.previous(*at); z != nullptr && is_easing(z->state, at->state.tick); z = timeline.previous(*at))
    at = z;
  PoseOffset out;
  for (;; ++at) {
    const Timeline::Update* z = timeline.previous(*at);
    const std::int64_t tick = at->state.tick;
    if (z == nullptr) out = {};
    else out = kept_offset(eased(path_between(object, *z, at, tick), z->state, out, tick), at->state);
    if (at == &update) return out;
  }
}

/// spec 60-client 7 and 8
RigidPose Replica::past_pose(std::uint32_t object, std::int64_t tick) const noexcept {
  const auto [a, b] = timelines_[object].around(tick);
  tick = std::max(tick, a.state.tick);
  const RigidPose path = path_between(object, a, b, tick);
  return is_easing(a.state, tick) ? eased(path, a.state, past_offset(object, a), tick) : path;
}

RigidPose Replica::pose(std::uint32_t object, std::int64_t now) const noexcept {
  if (interpolation_ == Interpolation::playout) return past_pose(object, now);
  const Track& track = tracks_[object];
  now = std::max(now, track.begin);
  if (now >= track.end) return track.path.pose(predictor_, now);
  const std::int64_t left = round_div((track.end - now) << 30, track.end - track.begin);
  const Cubic curve = cubic(left);
  const std::int64_t faded = interpolation_ == Interpolation::hermite ? curve.error : left;
  return displaced(predictor_.shown(object, track.path.state, now), track.error, track.change, {faded, faded, curve.change});
}

std::span<const Vec3i> Replica::displacements(std::size_t object, std::int64_t now) noexcept {
  return interpolation_ == Interpolation::playout ? shapes_[object]->displacements_of(now)
                                                  : shapes_[object]->displacements_at(now);
}

std::uint64_t Replica::pose_hash(std::int64_t now) const noexcept {
  Fnv1a hash;
  for (const std::uint32_t i : scene_.moving()) {
    const RigidPose shown = pose(i, now);
    for (const std::int32_t c : shown.position) hash.add32(c);
    for (const std::int32_t c : shown.rotation) hash.add32(c);
  }
  return hash.value();
}

}  // namespace tactus
