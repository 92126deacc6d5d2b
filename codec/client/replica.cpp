// SPDX-License-Identifier: Apache-2.0
#include <tactus/client/replica.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include <tactus/base/bytes.h>
#include <tactus/base/fixed.h>
#include <tactus/base/rule.h>
#include <tactus/client/update_interpolation.h>
#include <tactus/deformable/deformable_decoder.h>
#include <tactus/rigid/curve.h>
#include <tactus/rigid/rigid_states.h>
#include <tactus/scene/thesis_component.h>

namespace tactus {

// ==== timelines ====

Timelines::Timelines(std::size_t objects) : first_(objects), last_(objects) {
  if (objects > 0) updates_.reserve(objects + std::clamp<std::size_t>(128 * objects, 4096, 32768));
}

void Timelines::reset(const Scene& scene) noexcept {
  updates_.clear();
  for (std::size_t i = 0; i < first_.size(); ++i) {
    updates_.push_back({.number = 0, .state = initial_state(scene, i)});
    first_[i] = last_[i] = static_cast<Index>(i);
  }
  free_ = kNone;
  newest_ = 0;
}

/// Forget what no tick from the horizon on needs.
void Timelines::trim(std::uint32_t object, std::int64_t horizon) noexcept {
  while (first_[object] != last_[object] && updates_[updates_[first_[object]].next].state.tick <= horizon) {
    const Index gone = first_[object];
    first_[object] = updates_[gone].next;
    updates_[first_[object]].previous = kNone;
    updates_[gone].next = free_;
    free_ = gone;
  }
}

void Timelines::make_room() noexcept {
  std::int64_t oldest = newest_;
  for (std::size_t i = 0; i < first_.size(); ++i)
    if (first_[i] != last_[i]) oldest = std::min(oldest, updates_[updates_[first_[i]].next].state.tick);
  for (std::int64_t span = newest_ - oldest; free_ == kNone; span /= 2)
    for (std::uint32_t i = 0; i < first_.size(); ++i) trim(i, newest_ - span / 2);
}

Timelines::Index Timelines::take() noexcept {
  if (free_ == kNone && updates_.size() < updates_.capacity()) {
    updates_.emplace_back();
    return static_cast<Index>(updates_.size() - 1);
  }
  if (free_ == kNone) make_room();
  return std::exchange(free_, updates_[free_].next);
}

void Timelines::add(std::uint32_t object, std::uint64_t number, const RigidState& state) noexcept {
  newest_ = std::max(newest_, state.tick);
  trim(object, newest_ - kept_);
  swept_ = (swept_ + 1) % static_cast<std::uint32_t>(first_.size());
  trim(swept_, newest_ - kept_);
  const Index at = take();
  Index before = last_[object];
  const auto is_later = [&](const Update& u) { return std::tie(u.state.tick, u.number) > std::tie(state.tick, number); };
  while (before != kNone && is_later(updates_[before])) before = updates_[before].previous;
  const Index after = before == kNone ? first_[object] : updates_[before].next;
  updates_[at] = {number, state, before, after};
  (before == kNone ? first_[object] : updates_[before].next) = at;
  (after == kNone ? last_[object] : updates_[after].previous) = at;
}

Timelines::Around Timelines::around(std::uint32_t object, std::int64_t tick) const noexcept {
  Index before = last_[object];
  while (updates_[before].state.tick > tick && updates_[before].previous != kNone) before = updates_[before].previous;
  return {before, updates_[before].next};
}

std::size_t Timelines::size(std::uint32_t object) const noexcept {
  std::size_t out = 1;
  for (Index i = first_[object]; i != last_[object]; i = updates_[i].next) ++out;
  return out;
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

// ==== gap interpolation ====

RigidPose interpolate_gap(const Scene& scene, const RigidState& a, const RigidState& b, std::int64_t tick) noexcept {
  const RigidPredictor predictor(scene);
  const std::int64_t whole = b.tick - a.tick;
  const std::int64_t fraction = round_div((tick - a.tick) << 30, whole);
  const Cubic curve = cubic(fraction);
  const bool is_moving = !is_zero(a.velocity) || !is_zero(b.velocity);
  const bool is_turning = !is_zero(a.angular_velocity) || !is_zero(b.angular_velocity);
  const PoseOffset error = offset_between(predictor.pose(a, b.tick), {b.position, b.rotation});
  const PoseOffset change = change_between(scene, predictor.motion(a, b.tick, {}), {b.velocity, b.angular_velocity}, whole);
  return displaced(predictor.pose(a, tick), error, change,
                   {is_moving ? curve.error : fraction, is_turning ? curve.error : fraction, curve.change});
}

// ==== replica ====

namespace {

bool is_of_thesis(Interpolation mode) noexcept { return mode != Interpolation::none && mode != Interpolation::playout; }

}  // namespace

Result<void> Replica::check(const ReplicaOptions& options, const Scene& scene, const ThesisComponent* thesis) noexcept {
  const bool valid = options.fraction > 0 && options.fraction <= 1 && options.shortest >= 0 &&
                     options.shortest <= options.longest && options.longest <= 10;
  const bool interpolates = is_of_thesis(options.interpolation);
  if (interpolates && thesis == nullptr) return fail(Errc::unsupported, "R-API-16");
  if (!valid || (interpolates && scene.is_smoothed)) return fail(Errc::invalid_argument, "R-API-4");
  return {};
}

Replica::Replica(const Scene& scene, const ReplicaOptions& options, std::vector<DeformableDecoder*> shapes,
                 const DevicePath* device, const ThesisComponent* thesis)
    : scene_(scene),
      predictor_(scene, device),
      is_late_(options.interpolation == Interpolation::playout),
      reach_(std::min<std::int64_t>(round_div(300 * std::int64_t{scene.tick_rate}, 1000), scene.max_extrapolation)),
      updates_(is_of_thesis(options.interpolation) ? thesis->interpolation(scene, options, device) : nullptr),
      tracks_(is_late_ || updates_ ? 0 : scene.objects.size()),
      timelines_(is_late_ ? scene.objects.size() : 0),
      shapes_(std::move(shapes)) {
  heard_.reset();
  timelines_.reset(scene_);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    tracks_[i].path.object = static_cast<std::uint32_t>(i);
    tracks_[i].path.state = initial_state(scene, i);
  }
}

Replica::Replica(Replica&&) noexcept = default;
Replica::~Replica() = default;

void Replica::add_to_timelines(const DecodedPacket& packet, const RigidStates& states) noexcept {
  heard_.add(packet.number);
  for (const RigidUpdate& update : packet.updates) timelines_.add(update.object, packet.number, states.objects[update.object]);
}

void Replica::apply(const DecodedPacket& packet, const RigidStates& states, std::int64_t arrival) noexcept {
  if (is_late_) return add_to_timelines(packet, states);
  if (updates_) return updates_->apply(packet, states, arrival);
  for (const RigidUpdate& update : packet.updates) {
    Track& track = tracks_[update.object];
    if (packet.number < track.number) continue;  // reordered: there is a newer update of this object
    track.number = packet.number;
    track.begin = std::max({arrival, packet.tick, track.begin});
    track.path.follow(predictor_, states.objects[update.object]);
  }
}

/// From an update to the next. spec 60-client 7.   pre  a.state.tick <= tick, and tick is not after the next
RigidPose Replica::path_from(std::uint32_t object, const Timelines::Update& a, std::int64_t tick) const noexcept {
  const Timelines::Update* const b = a.next != Timelines::kNone ? &timelines_[a.next] : nullptr;
  const bool is_whole = b == nullptr || a.number == 0 || a.state.lod == kOutOfInterest || b->state.tick == a.state.tick ||
                        b->state.tick - a.state.tick > reach_ || heard_.all_between(a.number, b->number);
  return is_whole ? predictor_.shown(object, a.state, tick) : interpolate_gap(scene_, a.state, b->state, tick);
}

/// What was left to go at the tick of an update: from the updates before it, back to one whose own smoothing was over when the next came.
PoseOffset Replica::past_offset(std::uint32_t object, Timelines::Index update) const noexcept {
  Timelines::Index at = update;
  for (unsigned back = 0; back < kMostSmoothed; ++back) {
    const Timelines::Index z = timelines_[at].previous;
    if (z == Timelines::kNone || !is_smoothing(timelines_[z].state, timelines_[at].state.tick)) break;
    at = z;
  }
  PoseOffset out;
  for (;; at = timelines_[at].next) {
    const Timelines::Update& to = timelines_[at];
    if (to.previous == Timelines::kNone) {
      out = {};
    } else {
      const Timelines::Update& z = timelines_[to.previous];
      out = kept_offset(smoothed(path_from(object, z, to.state.tick), z.state, out, to.state.tick), to.state);
    }
    if (at == update) return out;
  }
}

/// spec 60-client 7 and 8
RigidPose Replica::past_pose(std::uint32_t object, std::int64_t tick) const noexcept {
  const Timelines::Index before = timelines_.around(object, tick).before;
  const Timelines::Update& a = timelines_[before];
  tick = std::max(tick, a.state.tick);
  const RigidPose path = path_from(object, a, tick);
  return is_smoothing(a.state, tick) ? smoothed(path, a.state, past_offset(object, before), tick) : path;
}

RigidPose Replica::pose(std::uint32_t object, std::int64_t now) const noexcept {
  if (is_late_) return past_pose(object, now);
  if (updates_) return updates_->pose(object, now);
  const Track& track = tracks_[object];
  return track.path.pose(predictor_, std::max(now, track.begin));
}

std::uint8_t Replica::lod(std::uint32_t object, std::int64_t now) const noexcept {
  if (is_late_) return timelines_[timelines_.around(object, now).before].state.lod;
  return updates_ ? updates_->lod(object) : tracks_[object].path.state.lod;
}

std::span<const Vec3i> Replica::displacements(std::size_t object, std::int64_t now) noexcept {
  return is_late_ ? shapes_[object]->displacements_of(now) : shapes_[object]->displacements_at(now);
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
