// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_encoder.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <tactus/base/rule.h>
#include <tactus/rigid/encoder_choices.h>

namespace tactus {
namespace {

// Shares of a bound that the quantisation of an update may use up; the rest is left for the motion until the next update.
constexpr unsigned kCoarsestLevel = 15;
constexpr double kVisualShare = 0.18;
constexpr double kHapticShare = 0.2;
// Baseline::acknowledged: objects near their bounds join a packet that goes out anyway, and what is not acknowledged goes again.
constexpr double kEarly = 0.5, kEarlyAtHeavyLoss = 0.3;                   // shares of a bound
constexpr double kSomeLoss = 0.003, kMoreLoss = 0.01, kHeavyLoss = 0.15;  // shares of packets
constexpr std::array kFollowUp{0.020, 0.040, 0.060};                      // [s] since the last sending
constexpr std::int32_t kDofTolerance = 64;                                // x 2^-30: a locked axis may be off by rounding only

Result<PoseThresholds> make_thresholds(double distance, double angle, const GridExponents& grid) {
  const double unit = std::ldexp(1.0, -grid.position);
  const double turn_unit = std::ldexp(4.0, -grid.rotation);
  if (!(distance >= 8 * unit && distance < 1e6) || !(angle >= 8 * turn_unit && angle <= std::numbers::pi)) {
    return fail(Errc::invalid_argument, "R-API-4");
  }
  PoseThresholds out;
  const auto units = static_cast<std::int64_t>(std::min(distance / unit, 1073741824.0)) - 1;
  out.distance_squared = units * units;
  const auto half = static_cast<std::uint32_t>(angle / (4 * std::numbers::pi) * 4294967296.0);
  const std::int64_t sine = sin30(half) - 8;
  out.half_angle_squared = sine * sine;
  const double worst = std::sqrt(0.75);
  const auto fits = [worst](double step, double bound) { return worst * step <= kVisualShare * bound; };
  while (out.level < kCoarsestLevel && fits(std::ldexp(unit, static_cast<int>(out.level) + 1), distance) &&
         fits(std::ldexp(turn_unit, static_cast<int>(out.level) + 1), angle)) {
    ++out.level;
  }
  return out;
}

/// pre  check()
PoseThresholds widened(double distance, double angle, double factor, const GridExponents& grid) {
  return make_thresholds(std::min(factor * distance, 999'999.0), std::min(factor * angle, std::numbers::pi), grid)
      .value_or(PoseThresholds{});
}

/// A share of what is permitted; the grid level stays.
PoseThresholds scaled(PoseThresholds t, double share) {
  t.distance_squared = static_cast<std::int64_t>(share * share * static_cast<double>(t.distance_squared));
  t.half_angle_squared = static_cast<std::int64_t>(share * share * static_cast<double>(t.half_angle_squared));
  return t;
}

bool within(const PoseThresholds& t, const RigidPose& shown, const RigidState& truth) noexcept {
  constexpr std::int64_t kFar = 1 << 30;
  std::int64_t distance = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t d = std::clamp(static_cast<std::int64_t>(truth.position[i]) - shown.position[i], -kFar, kFar);
    distance += d * d;
  }
  if (distance > t.distance_squared) return false;
  if (shown.rotation == truth.rotation) return true;
  const Quat30 turn = multiply(truth.rotation, conjugate(shown.rotation));
  double half = 0;
  for (std::size_t i = 1; i < 4; ++i) half += static_cast<double>(turn[i]) * turn[i];
  const double length_squared = (half + static_cast<double>(turn[0]) * turn[0]) * 0x1p-60;  // 1 but for rounding
  return half <= static_cast<double>(t.half_angle_squared) * length_squared;
}

Vec3 to_vector(const Vec3i& v, unsigned exponent) noexcept {
  const double unit = std::ldexp(1.0, -static_cast<int>(exponent));
  return {unit * v[0], unit * v[1], unit * v[2]};
}

/// From the true pose to a shown one that is near it.
SmallError error_of(const Pose& truth, const Pose& shown) noexcept {
  const Quat turn = shown.rotation * conjugate(truth.rotation);
  return {shown.position - truth.position, (turn.w < 0 ? -2.0 : 2.0) * Vec3{turn.x, turn.y, turn.z}};
}

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

bool are_valid(const RigidTriggers& t) noexcept {
  return std::isfinite(t.heartbeat) && t.heartbeat >= 0 && t.heartbeat <= 3600 && t.weber_fraction > 0 && t.weber_fraction <= 1 &&
         std::isfinite(t.perceptual_share) && t.perceptual_share > 0 && std::isfinite(t.force_floor) && t.force_floor > 0 &&
         std::isfinite(t.cone_angle) && t.cone_angle > 0 && t.cone_angle <= std::numbers::pi;
}

}  // namespace

Result<void> RigidEncoder::check(const RigidTriggers& triggers, const GridExponents& grid) noexcept {
  if (!are_valid(triggers)) return fail(Errc::invalid_argument, "R-API-4");
  TACTUS_CHECK(make_thresholds(triggers.visual_position, triggers.visual_rotation, grid));
  if (triggers.haptic == HapticRule::fixed) TACTUS_CHECK(make_thresholds(triggers.fixed_position, triggers.fixed_rotation, grid));
  return {};
}

RigidEncoder::RigidEncoder(const Scene& scene, const RigidTriggers& triggers, Baseline baseline)
    : scene_(scene),
      triggers_(triggers),
      predictor_(scene),
      early_(baseline == Baseline::acknowledged ? kEarly : 1),
      heartbeat_(static_cast<std::int64_t>(std::ceil(triggers.heartbeat * scene.tick_rate))),
      truth_(initial_states(scene).objects) {
  if (triggers.reduction != Reduction::none) {
    if (scene.is_eased) acceleration_.emplace(scene);
    if (scene.is_eased && triggers.haptic != HapticRule::off) force_trend_.emplace(scene);
    if (has_predictors(scene)) choice_.emplace(scene);
  }
  pending_.reserve(scene.moving().size());
  before_.reserve(scene.moving().size());
  for (std::uint32_t i = 0; i < truth_.size(); ++i) sent_.push_back({.path = {.object = i, .state = truth_[i]}});
  set_widening(1);
}

void RigidEncoder::know(const DevicePath& path) {
  if (!scene_.driven || !choice_) return;
  predictor_.know(path);
  choice_->know(path);
  driven_.emplace(scene_, path);
}

void RigidEncoder::set_widening(double factor) noexcept {
  widening_ = factor;
  visual_ = widened(triggers_.visual_position, triggers_.visual_rotation, factor, scene_.grid);
  fixed_ = widened(triggers_.fixed_position, triggers_.fixed_rotation, factor, scene_.grid);
  if (triggers_.reduction == Reduction::none) visual_.level = fixed_.level = 0;  // the reference is as exact as the grid
  early_visual_ = scaled(visual_, early_);
}

void RigidEncoder::set_link(const LinkState& link) noexcept {
  loses_more_ = link.loss >= kMoreLoss;
  if (early_ == 1) return;  // what is lost comes again, as it was
  early_ = link.loss > kHeavyLoss ? kEarlyAtHeavyLoss : kEarly;
  loses_ = link.loss >= kSomeLoss;
  early_visual_ = scaled(visual_, early_);
  for (std::size_t i = 0; i < follow_up_.size(); ++i) {
    const auto soon = static_cast<std::int64_t>(std::ceil(kFollowUp[i] * scene_.tick_rate));
    follow_up_[i] = link.answer <= 0 ? 0 : link.loss >= kSomeLoss ? soon : link.answer;
  }
}

Result<void> RigidEncoder::read(std::int64_t tick, std::span<const RigidSample> samples,
                                std::span<const Contact> contacts) noexcept {
  const bool sound = std::ranges::all_of(contacts, [&](const Contact& c) { return is_valid(c, scene_); });
  if (samples.size() != scene_.objects.size() || !sound) return fail(Errc::invalid_argument, "R-API-5");
  for (const std::uint32_t i : scene_.moving()) {
    TACTUS_TRY(truth_[i], to_grid(samples[i], tick, scene_.grid));
    if (!obeys_dof(scene_.objects[i], truth_[i])) return fail(Errc::invalid_argument, "R-API-6");
  }
  samples_ = samples;
  contacts_ = contacts;
  if (acceleration_) acceleration_->read(tick, samples);
  if (force_trend_) force_trend_->read(tick, samples, contacts);
  if (driven_ && !loses_more_) driven_->read(tick, samples, contacts, truth_);
  if (choice_) choice_->read(tick, truth_);
  return {};
}

bool RigidEncoder::is_touched(std::uint32_t object) const noexcept {
  return triggers_.haptic != HapticRule::off &&
         std::ranges::any_of(contacts_, [object](const Contact& c) { return c.kind != ContactKind::none && c.object == object; });
}

/// The largest haptic_ratio() of the contacts on the object; with the rule `fixed` 0 or infinite.
double RigidEncoder::haptic_ratio_of(std::uint32_t object, const RigidPose& shown) const noexcept {
  constexpr double kOutside = std::numeric_limits<double>::infinity();
  double out = 0;
  if (triggers_.haptic == HapticRule::off) return out;
  for (const Contact& contact : contacts_) {
    if (contact.kind == ContactKind::none || contact.object != object) continue;
    if (triggers_.haptic == HapticRule::fixed) return within(fixed_, shown, truth_[object]) ? 0 : kOutside;
    const Vec3 estimate = contact_force(contact, to_pose(shown, scene_.grid.position));
    const double ratio = haptic_ratio(triggers_, contact_force(contact, samples_[object].pose), estimate);
    if (std::isnan(ratio)) return kOutside;  // forces too large to compare
    out = std::max(out, ratio);
  }
  return out;
}

/// An update would bring the shown pose nearer to the truth: they are not at the same place of the grid.
bool RigidEncoder::can_improve(std::uint32_t object, const RigidPose& shown) const noexcept {
  const Residual rest = quantise_pose(shown, truth_[object], scene_.objects[object].dof, 0, scene_.grid);
  return rest.of != Residual{}.of;
}

Reason RigidEncoder::reason_for(std::uint32_t object) const noexcept {
  const EasedPath& path = sent_[object].path;
  const std::int64_t tick = truth_[object].tick;
  const RigidPose course = predictor_.shown(object, path.state, tick);
  const RigidPose shown = eased(course, path.state, path.offset, tick);
  if (haptic_ratio_of(object, shown) > widening_ && can_improve(object, shown)) return Reason::haptic;
  if (!within(visual_, shown, truth_[object])) return Reason::visual;
  if (is_easing(path.state, tick) && !within(visual_, course, truth_[object])) return Reason::visual;
  if (heartbeat_ > 0 && tick - path.state.tick >= heartbeat_) return Reason::heartbeat;
  return Reason::request;
}

bool RigidEncoder::is_follow_up_due(std::uint32_t object) const noexcept {
  const Sent& sent = sent_[object];
  const std::int64_t wait = follow_up_[std::min<std::size_t>(sent.follow_ups, follow_up_.size() - 1)];
  return !sent.acknowledged && wait > 0 && truth_[object].tick - sent.path.state.tick >= wait;
}

/// Whether an object whose trigger did not fire is named in a packet that others have caused: in a key packet if it has left its
/// initial state; else if it would soon cause a packet of its own.
bool RigidEncoder::joins(std::uint32_t object, const EncodeRequest<RigidStates>& request) const noexcept {
  const EasedPath& path = sent_[object].path;
  if (request.head.key && path.state != request.base.objects[object]) return true;
  if (early_ == 1) return false;
  const RigidPose shown = path.pose(predictor_, request.tick);
  return !within(early_visual_, shown, truth_[object]) ||
         (haptic_ratio_of(object, shown) > early_ * widening_ && can_improve(object, shown));
}

/// Nothing is pending without at least one trigger, follow-up or request.
void RigidEncoder::collect(const EncodeRequest<RigidStates>& request) noexcept {
  pending_.clear();
  for (const std::uint32_t i : scene_.moving()) {
    const Reason reason = reason_for(i);
    const bool fires = reason != Reason::request || triggers_.reduction == Reduction::none;
    if (fires || is_follow_up_due(i)) pending_.push_back({i, reason, {}, !fires});
  }
  const std::size_t causes = pending_.size();
  if ((causes == 0 && !request.requested) || (!request.head.key && early_ == 1)) return;
  std::size_t next = 0;  // of the causes
  for (const std::uint32_t i : scene_.moving()) {
    if (next < causes && pending_[next].object == i) ++next;
    else if (joins(i, request)) pending_.push_back({i, Reason::request, {}, false});
  }
  std::ranges::sort(pending_, {}, &Pending::object);
}

RigidTriggers RigidEncoder::widened_triggers() const noexcept {
  RigidTriggers out = triggers_;
  for (double* bound : {&out.visual_position, &out.visual_rotation, &out.weber_fraction, &out.perceptual_share,
                        &out.fixed_position, &out.fixed_rotation})
    *bound *= widening_;
  return out;
}

Predictor RigidEncoder::chosen(std::uint32_t object, const RigidTriggers& bounds) const noexcept {
  PermittedError permitted{bounds.visual_position, bounds.visual_rotation};
  for (const Contact& contact : contacts_) {
    if (contact.kind == ContactKind::none || contact.object != object || bounds.haptic == HapticRule::off) continue;
    const double force = norm(contact_force(contact, samples_[object].pose));
    const bool fixed = bounds.haptic == HapticRule::fixed;
    permitted.position =
        std::min(permitted.position, fixed ? bounds.fixed_position : force_budget(bounds, force) / contact.stiffness);
    if (fixed) permitted.rotation = std::min(permitted.rotation, bounds.fixed_rotation);
  }
  return choice_->choose(object, truth_[object], permitted, is_touched(object), sent_[object].path.state);
}

/// The true state with the velocities that an update is to tell.   pre  it is predicted linearly
RigidState RigidEncoder::leaned(std::uint32_t object, const Acceleration::Motion& acceleration,
                                const ErrorShare& share) const noexcept {
  const RigidState& truth = truth_[object];
  if (!acceleration_ || loses_) return truth;
  RigidSample sample = samples_[object];
  const Acceleration::Motion more = leaning(acceleration, share);
  sample.velocity = sample.velocity + more.linear;
  sample.angular_velocity = sample.angular_velocity + more.angular;
  return to_grid(sample, truth.tick, scene_.grid).value_or(truth);
}

/// In the ticks after an update whose offset leads to `kept` now.
UpdateCourse RigidEncoder::course_of(const RigidState& state, const RigidPose& kept, const RigidSample& truth,
                                     const Acceleration::Motion& acceleration) const noexcept {
  const Pose own = to_pose({state.position, state.rotation}, scene_.grid.position);
  const Acceleration::Motion drift{to_vector(state.velocity, scene_.grid.velocity) - truth.velocity,
                                   to_vector(state.angular_velocity, scene_.grid.angular_velocity) - truth.angular_velocity};
  return {error_of(own, to_pose(kept, scene_.grid.position)), error_of(truth.pose, own), drift, acceleration};
}

/// As much of the pose shown so far as the bounds permit, for as long as they are likely to.
void RigidEncoder::choose_ease(Pending& update, CodedUpdate& coded, const Acceleration::Motion& acceleration,
                               const ErrorShare& share) const noexcept {
  const std::uint32_t object = update.object;
  const RigidPose shown = sent_[object].path.pose(predictor_, truth_[object].tick);
  RigidState tried = update.state;
  const RigidPose own{tried.position, tried.rotation};
  const PoseOffset offset = offset_between(own, shown);
  tried.ease = 1;
  tried.keep = update.reason == Reason::haptic ? 1 : 0;  // all of it is what is felt
  for (; tried.keep < 4; ++tried.keep) {
    const RigidPose kept = eased(own, tried, part_kept(offset, tried.keep), tried.tick);
    if (!within(visual_, kept, truth_[object]) || haptic_ratio_of(object, kept) > widening_) continue;
    tried.ease = longest_ease(course_of(tried, kept, samples_[object], acceleration), share, scene_.tick_rate);
    if (tried.ease == 0) return;
    update.state = tried;
    coded.ease = tried.ease;
    coded.keep = tried.keep;
    return;
  }
}

/// The update of one object, and the state after it. A predictor other than the linear one counts as knowing the acceleration.
/// A key packet is not eased: a client may begin with it, and has shown nothing of what the path would begin with.
Result<CodedUpdate> RigidEncoder::code(Pending& update, const EncodeRequest<RigidStates>& request) const noexcept {
  const RigidState& base = request.base.objects[update.object];
  const Prediction prediction{base, predictor_.pose(base, request.tick)};
  const std::uint32_t object = update.object;
  if (!acceleration_ && !choice_) return quantise(update, prediction, truth_[object]);
  const RigidTriggers bounds = widened_triggers();
  const Predictor predictor = choice_ ? chosen(object, bounds) : Predictor::linear;
  const bool is_linear = predictor == Predictor::linear;
  const ErrorShare share(object, samples_[object].pose, contacts_, bounds, force_trend_ ? force_trend_->sinking(object) : 0);
  const auto acceleration = acceleration_ && is_linear ? acceleration_->of(object) : Acceleration::Motion{};
  RigidState told = is_linear ? leaned(object, acceleration, share) : truth_[object];
  told.predictor = predictor;
  TACTUS_TRY(CodedUpdate coded, quantise(update, prediction, told));
  if (acceleration_ && !request.head.key) choose_ease(update, coded, acceleration, share);
  return coded;
}

/// The coarsest level whose rounding leaves room inside every bound; without one, the finest that keeps them; where the grid is too
/// coarse for the permitted force error, the nearest place on it.
Result<CodedUpdate> RigidEncoder::quantise(Pending& update, const Prediction& prediction, const RigidState& told) const noexcept {
  const std::uint32_t object = update.object;
  const RigidState& truth = truth_[object];
  const std::uint8_t dof = scene_.objects[object].dof;
  std::optional<CodedUpdate> finest;
  const unsigned coarsest = triggers_.haptic == HapticRule::fixed && is_touched(object) ? fixed_.level : visual_.level;
  for (unsigned levels = coarsest + 1; levels > 0; --levels) {
    const unsigned level = levels - 1;
    CodedUpdate coded{.reason = update.reason,
                      .level = static_cast<std::uint8_t>(level),
                      .residual = quantise_pose(prediction.pose, truth, dof, level, scene_.grid),
                      .predictor = static_cast<std::uint8_t>(told.predictor)};
    if (told.predictor == Predictor::driven) tell_contact(prediction.base, told.contact, coded);
    quantise_motion(predictor_, prediction, told, dof, coded);
    const auto state = reconstruct(predictor_, prediction, truth.tick, coded, scene_.grid);
    if (!state) return fail(Errc::internal, "R-RIG-6");
    const RigidPose shown{state->position, state->rotation};
    if (!within(visual_, shown, truth)) continue;
    const double felt = haptic_ratio_of(object, shown);
    if ((level > 0 || finest) && felt > widening_) continue;
    update.state = *state;
    if (felt <= kHapticShare * widening_) return coded;
    finest = coded;
  }
  if (!finest) return fail(Errc::invalid_argument, "R-API-7");
  return *finest;
}

Result<Payload> RigidEncoder::encode(const EncodeRequest<RigidStates>& request, std::span<std::uint8_t> out) noexcept {
  collect(request);
  number_ = request.number;
  if (pending_.empty()) return Payload{};
  const auto moving = scene_.moving();
  RangeEncoder coder(out);
  RigidModels models = start_models();
  RigidHead head{request.head, static_cast<std::uint32_t>(pending_.size())};
  code_head(coder, models, scene_, head);
  Reason strongest = Reason::request;
  std::uint32_t next = 0;  // index into `moving`
  for (Pending& update : pending_) {
    const auto at = static_cast<std::uint32_t>(std::ranges::lower_bound(moving, update.object) - moving.begin());
    if (moving.size() > 1) coder.magnitude(models.gap, at - next);
    next = at + 1;
    TACTUS_TRY(CodedUpdate coded, code(update, request));
    code_update(coder, models, scene_, update.object, coded);
    strongest = std::max(strongest, update.reason);
  }
  const std::size_t size = coder.finish();
  if (coder.overflow() || coder.too_wide()) return fail(Errc::internal, "R-PKT-1");
  return Payload{size, strongest, static_cast<std::uint32_t>(pending_.size())};
}

void RigidEncoder::commit(const RigidStates& base, RigidStates& next) noexcept {
  if (&base != &next) std::copy(base.objects.begin(), base.objects.end(), next.objects.begin());
  before_.clear();
  for (const Pending& update : pending_) {
    next.objects[update.object] = update.state;
    Sent& sent = sent_[update.object];
    before_.emplace_back(update.object, sent);
    const auto follow_ups = static_cast<std::uint8_t>(update.follow_up ? std::min(sent.follow_ups + 1, 255) : 0);
    sent.path.follow(predictor_, update.state);
    sent.number = number_;
    sent.follow_ups = follow_ups;
    sent.acknowledged = false;
  }
}

void RigidEncoder::forget_last() noexcept {
  for (const auto& [object, sent] : before_) sent_[object] = sent;
  before_.clear();
}

void RigidEncoder::acknowledge(std::uint64_t number) noexcept {
  for (Sent& sent : sent_) sent.acknowledged = sent.acknowledged || sent.number == number;
  for (auto& [object, sent] : before_) sent.acknowledged = sent.acknowledged || sent.number == number;
}

}  // namespace tactus
