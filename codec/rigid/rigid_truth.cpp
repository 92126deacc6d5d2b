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

bool is_same(const RigidSample& a, const RigidSample& b) noexcept {
  return a.pose.position == b.pose.position && a.pose.rotation == b.pose.rotation && a.velocity == b.velocity &&
         a.angular_velocity == b.angular_velocity;
}

}  // namespace

RigidTruth::RigidTruth(const Scene& scene, const RigidTriggers& triggers, HeldList& held)
    : scene_(scene),
      held_(held),
      filter_{&scene, &held},
      has_left_(scene.objects.size(), 0),
      moved_at_(scene.objects.size(), 0),
      touched_at_(scene.objects.size(), 0) {
  states_.reserve(scene.objects.size());
  last_.reserve(scene.objects.size());
  for (const RigidObject& object : scene.objects) {
    states_.push_back({.position = object.initial.position, .rotation = object.initial.rotation});
    last_.push_back({.pose = to_pose(object.initial, scene.grid.position), .velocity = {}, .angular_velocity = {}});
  }
  for (auto* list : {&moved_, &recent_, &touched_, &left_}) list->reserve(scene.objects.size());
  if (triggers.reduction == Reduction::none) return;
  if (scene.is_smoothed) acceleration_.emplace(scene);
  if (scene.is_smoothed && triggers.haptic != HapticRule::off) force_trend_.emplace(scene);
  if (has_predictors(scene)) past_.emplace(scene);
}

void RigidTruth::take(std::uint32_t object, const RigidSample& sample) noexcept {
  const auto state = to_grid(sample, tick_, scene_.grid);
  if (!state) return hold(object, state.error().rule);
  if (!obeys_dof(scene_.objects[object], *state)) return hold(object, RuleName("R-API-6"));
  states_[object] = *state;
  last_[object] = sample;
  moved_.push_back(object);
  const RigidPose& initial = scene_.objects[object].initial;
  if (has_left_[object] != 0 || (states_[object].position == initial.position && states_[object].rotation == initial.rotation))
    return;
  has_left_[object] = 1;
  left_.push_back(object);
}

/// Where it was last, at rest.
void RigidTruth::hold(std::uint32_t object, const char* rule) noexcept {
  if (!held_.hold({.part = TruthPart::object, .index = object, .since = tick_, .rule = rule})) return;
  RigidState& state = states_[object];
  state = {.tick = tick_, .position = state.position, .rotation = state.rotation};
  last_[object] = {.pose = last_[object].pose, .velocity = {}, .angular_velocity = {}};
  moved_.push_back(object);
}

/// Those that were not looked at, as they are not named as moved, are what they were; those that are where they are held are good again.
/// out  one is held
bool RigidTruth::look_at_held(std::span<const RigidSample> samples) noexcept {
  bool out = false;
  const auto parts = held_.parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].part != TruthPart::object) continue;
    const std::uint32_t object = parts[i].index;
    if (!held_.is_seen(i) && !is_same(samples[object], last_[object])) held_.keep(i);
    out = out || held_.is_seen(i);
  }
  return out;
}

/// One that has not moved is where it was, to the bit.
void RigidTruth::read(std::span<const RigidSample> samples, std::optional<std::span<const std::uint32_t>> moved) noexcept {
  moved_.clear();
  const bool all = reads_ == 0;
  for (const std::uint32_t i : all ? scene_.moving() : moved.value_or(scene_.moving())) {
    const bool is_known = i < samples.size() && scene_.objects[i].dof != Dof::none;
    if (is_known && (all || !is_same(samples[i], last_[i]))) take(i, samples[i]);
  }
}

void RigidTruth::read(std::span<const Contact> contacts) noexcept {
  bool is_sound = true;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const RuleName rule = broken_rule(contacts[i], scene_);
    if (!rule) continue;
    is_sound = false;
    held_.hold({.part = TruthPart::contact, .index = static_cast<std::uint32_t>(i), .since = tick_, .rule = rule});
  }
  const bool is_whole = is_sound && samples_.data() != last_.data();  // nothing is held
  contacts_ = Contacts(contacts, is_whole ? nullptr : &filter_);
  touched_.clear();
  for (const Contact& contact : contacts_) {
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
  if (samples.size() != scene_.objects.size()) return fail(Errc::invalid_argument, "R-API-5");
  tick_ = tick;
  read(samples, moved);
  const bool holds = !held_.empty() && look_at_held(samples);
  ++reads_;
  samples_ = holds ? std::span<const RigidSample>(last_) : samples;
  read(contacts);
  look_back();
  return {};
}

}  // namespace tactus
