// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/resampler.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/trace/interpolation.h>

namespace tactus {

namespace {

UserSample mixed(const UserSample& a, const UserSample& b, double fraction) {
  UserSample out = a;
  out.device.position = mixed(a.device.position, b.device.position, fraction);
  out.device.orientation = mixed(a.device.orientation, b.device.orientation, fraction);
  out.device.velocity = mixed(a.device.velocity, b.device.velocity, fraction);
  out.device.time = a.device.time + std::llround(fraction * static_cast<double>(b.device.time - a.device.time));
  out.contact.device = out.device.position;
  out.force = mixed(a.force, b.force, fraction);
  out.server_force = mixed(a.server_force, b.server_force, fraction);
  return out;
}

}  // namespace

Resampler::Resampler(const TraceInfo& info, std::uint32_t tick_rate, double gap)
    : info_(info), from_rate_(info.tick_rate), gap_(gap), is_new_(info.meshes.size()), reported_(info.users.size()) {
  info_.tick_rate = tick_rate;
  info_.bounds.reset();
  for (TraceDeformable& mesh : info_.meshes) mesh.period *= static_cast<double>(tick_rate) / from_rate_;
}

Resampler::Instant Resampler::at(std::int64_t tick, std::uint32_t rate, std::uint32_t other) const noexcept {
  return {tick / rate, tick % rate * other};
}

double Resampler::between(const Instant& from, const Instant& to) const noexcept {
  return static_cast<double>(to.second - from.second) +
         static_cast<double>(to.part - from.part) / (static_cast<double>(from_rate_) * info_.tick_rate);
}

std::int64_t Resampler::first_at_or_after(const Instant& time) const noexcept {
  return time.second * info_.tick_rate + (time.part + from_rate_ - 1) / from_rate_;
}

void Resampler::add(const TraceFrame& frame) {
  std::swap(before_, after_);
  std::swap(from_, to_);
  after_ = frame;
  to_ = at(frame.tick, from_rate_, info_.tick_rate);
  if (frames_++ == 0) tick_ = first_at_or_after(to_);
  else note_news();
}

/// Those of `before_`.
void Resampler::note_news() {
  for (std::size_t i = 0; i < is_new_.size(); ++i) is_new_[i] = is_new_[i] || before_.meshes[i].updated;
  for (std::size_t i = 0; i < reported_.size(); ++i) {
    const auto& [sizes, bytes] = before_.users[i].reports;
    reported_[i].sizes.insert(reported_[i].sizes.end(), sizes.begin(), sizes.end());
    reported_[i].bytes.insert(reported_[i].bytes.end(), bytes.begin(), bytes.end());
  }
}

bool Resampler::next(TraceFrame& frame) {
  if (frames_ == 0) return false;
  const Instant now = at(tick_, info_.tick_rate, from_rate_);
  if (frames_ > 1 && now < to_ && between(from_, to_) > gap_ && from_ < now) tick_ = first_at_or_after(to_);
  else if (frames_ > 1 && now < to_) return make(between(from_, now) / between(from_, to_), frame), true;
  if (!ended_ || at(tick_, info_.tick_rate, from_rate_) != to_) return false;
  std::swap(before_, after_);
  from_ = to_;
  note_news();
  after_ = before_;
  return make(0, frame), true;
}

void Resampler::make(double fraction, TraceFrame& out) {
  out.tick = tick_++;
  out.changed.reset();
  out.objects.resize(before_.objects.size());
  out.users.resize(before_.users.size());
  out.meshes.resize(before_.meshes.size());
  for (std::size_t i = 0; i < out.objects.size(); ++i) out.objects[i] = mixed(before_.objects[i], after_.objects[i], fraction);
  for (std::size_t i = 0; i < out.users.size(); ++i) {
    out.users[i] = mixed(before_.users[i], after_.users[i], fraction);
    out.users[i].reports = std::exchange(reported_[i], {});
  }
  for (std::size_t i = 0; i < out.meshes.size(); ++i) {
    const std::vector<float>& shape = before_.meshes[i].displacements;
    out.meshes[i].updated = is_new_[i] || out.meshes[i].displacements.size() != shape.size();
    if (out.meshes[i].updated) out.meshes[i].displacements = shape;
    is_new_[i] = false;
  }
}

}  // namespace tactus
