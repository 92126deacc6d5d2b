// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_truth.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/base/fixed.h>
#include <tactus/base/rule.h>
#include <tactus/rigid/rigid_syntax.h>

namespace tactus {
namespace {

constexpr std::int32_t kDofTolerance = 64;  // x 2^-30: a locked axis may be off by rounding only

/// Does the truth keep to the axes that the header declares?
bool obeys_dof(const RigidObject& object, const RigidState& truth) noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(object.dof >> i & 1u) && std::abs(static_cast<std::int64_t>(truth.position[i]) - object.initial.position[i]) > 1)
      return false;
  }
  if (object.dof >> 3 == 7) return true;
  const Quat30 turn = multiply(truth.rotation, conjugate(object.initial.rotation));
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(object.dof >> (3 + i) & 1u) && std::abs(turn[i + 1]) > kDofTolerance) return false;
  }
  return true;
}

bool is_valid(const Contact& c, const Scene& scene) noexcept {
  if (c.kind == ContactKind::none) return true;
  const bool unit = c.kind == ContactKind::spring || std::abs(norm(c.normal) - 1) <= 1e-6;
  return c.kind <= ContactKind::spring && c.object < scene.objects.size() && is_finite(c.point) && is_finite(c.normal) && unit &&
         is_finite(c.device) && std::isfinite(c.stiffness) && c.stiffness > 0;
}

bool is_same(const RigidSample& a, const RigidSample& b) noexcept {
  return a.pose.position == b.pose.position && a.pose.rotation == b.pose.rotation && a.velocity == b.velocity &&
         a.angular_velocity == b.angular_velocity;
}

}  // namespace

RigidTruth::RigidTruth(const Scene& scene, const RigidTriggers& triggers)
    : scene_(scene),
      states_(scene.objects.size()),
      last_(scene.objects.size()),
      has_left_(scene.objects.size(), 0),
      moved_at_(scene.objects.size(), 0),
      touched_at_(scene.objects.size(), 0) {
  for (auto* list : {&moved_, &recent_, &touched_, &left_}) list->reserve(scene.objects.size());
  if (triggers.reduction == Reduction::none) return;
  if (scene.is_eased) acceleration_.emplace(scene);
  if (scene.is_eased && triggers.haptic != HapticRule::off) force_trend_.emplace(scene);
  if (has_predictors(scene)) past_.emplace(scene);
}

Result<void> RigidTruth::take(std::uint32_t object, const RigidSample& sample) noexcept {
  TACTUS_TRY(states_[object], to_grid(sample, tick_, scene_.grid));
  if (!obeys_dof(scene_.objects[object], states_[object])) return fail(Errc::invalid_argument, "R-API-6");
  last_[object] = sample;
  moved_.push_back(object);
  const RigidPose& initial = scene_.objects[object].initial;
  if (has_left_[object] != 0 || (states_[object].position == initial.position && states_[object].rotation == initial.rotation))
    return {};
  has_left_[object] = 1;
  left_.push_back(object);
  return {};
}

/// One that has not moved is where it was, to the bit.
Result<void> RigidTruth::read(std::span<const RigidSample> samples,
                              std::optional<std::span<const std::uint32_t>> moved) noexcept {
  moved_.clear();
  const bool all = std::exchange(failed_, true);
  for (const std::uint32_t i : all ? scene_.moving() : moved.value_or(scene_.moving())) {
    const bool is_known = i < samples.size() && scene_.objects[i].dof != Dof::none;
    if (is_known && (all || !is_same(samples[i], last_[i]))) TACTUS_CHECK(take(i, samples[i]));
  }
  failed_ = false;
  return {};
}

void RigidTruth::read(std::span<const Contact> contacts) noexcept {
  touched_.clear();
  for (const Contact& contact : contacts) {
    if (contact.kind == ContactKind::none || touched_at_[contact.object] == reads_) continue;
    touched_at_[contact.object] = reads_;
    touched_.push_back(contact.object);
  }
}

void RigidTruth::look_back() noexcept {
  for (const std::uint32_t i : moved_) {
    if (moved_at_[i] == 0 || reads_ - moved_at_[i] >= Acceleration::kKept) recent_.push_back(i);
    moved_at_[i] = reads_;
  }
  if (acceleration_) acceleration_->read(tick_, samples_, recent_);
  std::erase_if(recent_, [this](std::uint32_t i) { return reads_ + 1 - moved_at_[i] >= Acceleration::kKept; });
  if (force_trend_) force_trend_->read(tick_, samples_, contacts_);
  if (past_) past_->read(tick_, states_, moved_);
}

Result<void> RigidTruth::read(std::int64_t tick, std::span<const RigidSample> samples, std::span<const Contact> contacts,
                              std::optional<std::span<const std::uint32_t>> moved) noexcept {
  const bool sound = std::ranges::all_of(contacts, [&](const Contact& c) { return is_valid(c, scene_); });
  if (samples.size() != scene_.objects.size() || !sound) return fail(Errc::invalid_argument, "R-API-5");
  const std::int64_t before = std::exchange(tick_, tick);
  if (const auto done = read(samples, moved); !done) {
    tick_ = before;
    return done;
  }
  ++reads_;
  samples_ = samples;
  contacts_ = contacts;
  read(contacts);
  look_back();
  return {};
}

}  // namespace tactus
