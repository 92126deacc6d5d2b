// SPDX-License-Identifier: Apache-2.0
#include <tactus/thesis/interpolation.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/fixed.h>

namespace tactus {

ThesisInterpolation::ThesisInterpolation(const Scene& scene, const ReplicaOptions& options, const DevicePath* device)
    : scene_(scene),
      predictor_(scene, device),
      interpolation_(options.interpolation),
      fraction_(static_cast<std::uint32_t>(std::floor(options.fraction * 65536 + 0.5))),
      shortest_(static_cast<std::int64_t>(std::floor(options.shortest * scene.tick_rate + 0.5))),
      longest_(static_cast<std::int64_t>(std::floor(options.longest * scene.tick_rate + 0.5))),
      tracks_(scene.objects.size()) {
  for (std::size_t i = 0; i < tracks_.size(); ++i) tracks_[i].state = initial_state(scene, i);
}

/// t_N in ticks: a fraction of the mean gap, clipped; 0 while no gap is known.
std::int64_t ThesisInterpolation::interval(const Track& track) const noexcept {
  if (track.gap_count == 0) return 0;
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < track.gap_count; ++i) sum += track.gaps[i];
  const std::int64_t wanted = round_div(sum * fraction_, static_cast<std::int64_t>(track.gap_count) << 16);
  return std::clamp(wanted, shortest_, longest_);
}

/// Velocities of dead reckoning at `now`: none once it has come to rest.
RigidMotion ThesisInterpolation::motion(const Track& track, std::int64_t now) const noexcept {
  if (now - track.state.tick >= scene_.max_extrapolation) return {};
  return predictor_.motion(track.state, now, {});
}

void ThesisInterpolation::apply(const DecodedPacket& packet, const RigidStates& states, std::int64_t arrival) noexcept {
  for (const RigidUpdate& of : packet.updates) {
    Track& track = tracks_[of.object];
    if (packet.number < track.number) continue;  // reordered: there is a newer update of this object
    track.number = packet.number;
    update(track, of.object, states.objects[of.object], std::max({arrival, packet.tick, track.last_arrival}));
  }
}

void ThesisInterpolation::update(Track& track, std::uint32_t object, const RigidState& state, std::int64_t now) noexcept {
  const RigidPose shown = pose(object, now);
  const RigidMotion before = motion(track, now);
  const bool running = now < track.end;
  if (track.last_arrival >= 0) {
    track.gaps[track.gap_next] = saturate32(now - track.last_arrival);
    track.gap_next = static_cast<std::uint8_t>((track.gap_next + 1) % kArrivals);
    track.gap_count = std::min<std::uint8_t>(static_cast<std::uint8_t>(track.gap_count + 1), kArrivals);
  }
  track.last_arrival = now;
  track.state = state;
  track.begin = track.end = now;
  if (running) return;
  track.end = now + interval(track);
  track.error = offset_between(predictor_.shown(object, track.state, now), shown);
  if (interpolation_ != Interpolation::linear) track.change = change_between(scene_, before, motion(track, now), track.end - now);
}

RigidPose ThesisInterpolation::pose(std::uint32_t object, std::int64_t now) const noexcept {
  const Track& track = tracks_[object];
  now = std::max(now, track.begin);
  const RigidPose target = predictor_.shown(object, track.state, now);
  if (now >= track.end) return target;
  const std::int64_t left = round_div((track.end - now) << 30, track.end - track.begin);
  const Cubic curve = cubic(left);
  const std::int64_t faded = interpolation_ == Interpolation::hermite ? curve.error : left;
  return displaced(target, track.error, track.change, {faded, faded, curve.change});
}

std::unique_ptr<UpdateInterpolation> thesis_interpolation(const Scene& scene, const ReplicaOptions& options,
                                                          const DevicePath* device) {
  return std::make_unique<ThesisInterpolation>(scene, options, device);
}

}  // namespace tactus
