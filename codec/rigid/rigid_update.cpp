// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_update.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/rule.h>

namespace tactus {
namespace {

constexpr double kHapticFraction = 0.2;  // of a bound may the rounding of an update use up

Vec3 to_vector(const Vec3i& v, unsigned exponent) noexcept {
  const double unit = std::ldexp(1.0, -static_cast<int>(exponent));
  return {unit * v[0], unit * v[1], unit * v[2]};
}

/// From the true pose to a shown one that is near it.
SmallError error_of(const Pose& truth, const Pose& shown) noexcept {
  const Quat turn = shown.rotation * conjugate(truth.rotation);
  return {shown.position - truth.position, (turn.w < 0 ? -2.0 : 2.0) * Vec3{turn.x, turn.y, turn.z}};
}

}  // namespace

RigidUpdateCoder::RigidUpdateCoder(const Scene& scene, const RigidTruth& truth, const RigidBounds& bounds,
                                   const RigidPredictor& predictor, const DevicePath* device)
    : scene_(scene), truth_(truth), bounds_(bounds), predictor_(predictor) {
  if (predictor_.has_device_path()) driven_.emplace(scene, *device);
  if (truth.past() != nullptr) choice_.emplace(scene, driven_ ? driven_->past : *truth.past(), device);
}

void RigidUpdateCoder::read(bool drives) noexcept {
  if (!driven_) return;
  if (drives) driven_->choice.read(truth_.tick(), truth_.samples(), truth_.contacts(), driven_->signalled);
  else std::ranges::fill(driven_->signalled, DrivenContact{});
  driven_->past.read(truth_.tick(), truth_.states(), scene_.moving(), driven_->signalled);
}

/// With the tick of now.
RigidState RigidUpdateCoder::truth_of(const Request& request) const noexcept {
  RigidState out = truth_.state(request.object);
  out.tick = truth_.tick();
  if (driven_) out.contact = driven_->signalled[request.object];
  out.lod = request.lod;
  return out;
}

/// A predictor other than the linear one counts as knowing the acceleration.
/// A key packet is not smoothed: a client may begin with it, and has shown nothing of what the path would begin with. So is what was out of
/// interest. What is held rests: it has no look-ahead.
Result<RigidUpdateCoder::Update> RigidUpdateCoder::code(const Request& request) const noexcept {
  const std::uint32_t object = request.object;
  const RigidState truth = truth_of(request);
  if ((truth_.acceleration() == nullptr && !choice_) || truth_.is_held(object)) return quantise(request, truth);
  const RigidTriggers bounds = bounds_.scaled_triggers(request.lod);
  const Predictor predictor = choice_ ? chosen(request, truth, bounds) : Predictor::linear;
  const bool is_linear = predictor == Predictor::linear;
  const bool looks_ahead = truth_.acceleration() != nullptr && is_linear;
  const Outlook outlook{looks_ahead ? truth_.acceleration()->of(object) : Acceleration::Motion{},
                        {object, truth_.samples()[object].pose, truth_.contacts(), bounds,
                         truth_.force_trend() != nullptr ? truth_.force_trend()->relative_decay_rate(object) : 0}};
  RigidState signalled = looks_ahead && looks_ahead_ ? with_look_ahead(truth, object, outlook) : truth;
  signalled.predictor = predictor;
  TACTUS_TRY(Update update, quantise(request, signalled));
  const bool is_shown = request.shown.state.lod != kOutOfInterest;
  if (truth_.acceleration() != nullptr && !request.key && is_shown) choose_smoothing(request, outlook, update);
  return update;
}

Predictor RigidUpdateCoder::chosen(const Request& request, const RigidState& truth, const RigidTriggers& bounds) const noexcept {
  const std::uint32_t object = request.object;
  PermittedError permitted{bounds.visual_position, bounds.visual_rotation};
  for (const Contact& contact : truth_.contacts()) {
    if (contact.kind == ContactKind::none || contact.object != object || bounds.haptic == HapticRule::off) continue;
    const double force = norm(contact_force(contact, truth_.samples()[object].pose));
    const bool fixed = bounds.haptic == HapticRule::fixed;
    permitted.position =
        std::min(permitted.position, fixed ? bounds.fixed_position : force_budget(bounds, force) / contact.stiffness);
    if (fixed) permitted.rotation = std::min(permitted.rotation, bounds.fixed_rotation);
  }
  return choice_->choose(object, truth, permitted, bounds_.is_touched(object), request.shown.state);
}

/// The true state with the velocities that an update is to send.   pre  it is predicted linearly
RigidState RigidUpdateCoder::with_look_ahead(const RigidState& truth, std::uint32_t object,
                                             const Outlook& outlook) const noexcept {
  RigidSample sample = truth_.samples()[object];
  const Acceleration::Motion more = look_ahead_velocity(outlook.acceleration, outlook.ratio);
  sample.velocity = sample.velocity + more.linear;
  sample.angular_velocity = sample.angular_velocity + more.angular;
  return to_grid(sample, truth.tick, scene_.grid).value_or(truth);
}

/// The coarsest level whose rounding leaves room inside every bound; without one, the finest that keeps them; where the grid is too
/// coarse for the permitted force error, or the distance too long for one update, the nearest point that it can name.
Result<RigidUpdateCoder::Update> RigidUpdateCoder::quantise(const Request& request, const RigidState& signalled) const noexcept {
  const std::uint32_t object = request.object;
  const Prediction prediction{request.base, predictor_.pose(request.base, truth_.tick())};
  const RigidState& truth = truth_.state(object);
  const std::uint8_t dof = scene_.objects[object].dof;
  std::optional<Update> finest;
  const RigidBounds::Level& bounds = bounds_.of(request.lod);
  const bool is_fixed = bounds_.triggers().haptic == HapticRule::fixed && bounds_.is_touched(object);
  const unsigned coarsest = is_fixed ? bounds.fixed.level : bounds.visual.level;
  for (unsigned levels = coarsest + 1; levels > 0; --levels) {
    const unsigned level = levels - 1;
    CodedUpdate coded{.reason = request.reason,
                      .level = static_cast<std::uint8_t>(level),
                      .residual = quantise_pose(prediction.pose, truth, dof, level, scene_.grid),
                      .predictor = signalled.predictor,
                      .lod = static_cast<std::uint8_t>((request.lod - prediction.base.lod) & 7)};
    if (signalled.predictor == Predictor::driven) set_contact(prediction.base, signalled.contact, coded);
    quantise_motion(predictor_, prediction, signalled, dof, coded);
    const auto state = reconstruct(predictor_, prediction, truth_.tick(), coded, scene_.grid);
    if (!state) return fail(Errc::internal, "R-RIG-6");
    const RigidPose shown{state->position, state->rotation};
    if (level > 0 && !within(bounds.visual, shown, truth)) continue;
    const double force_ratio = bounds_.haptic_ratio_of(object, request.lod, shown);
    if ((level > 0 || finest) && force_ratio > bounds.scale) continue;
    finest = Update{coded, *state};
    if (force_ratio <= kHapticFraction * bounds.scale) break;
  }
  return *finest;  // that of level 0, if no other
}

// ==== smoothing ====

/// In the ticks after an update whose offset leads to `kept` now.
ErrorTrajectory RigidUpdateCoder::error_trajectory(const RigidState& state, const RigidPose& kept, const RigidSample& truth,
                                                   const Acceleration::Motion& acceleration) const noexcept {
  const Pose own = to_pose({state.position, state.rotation}, scene_.grid.position);
  const Acceleration::Motion drift{to_vector(state.velocity, scene_.grid.velocity) - truth.velocity,
                                   to_vector(state.angular_velocity, scene_.grid.angular_velocity) - truth.angular_velocity};
  return {error_of(own, to_pose(kept, scene_.grid.position)), error_of(truth.pose, own), drift, acceleration};
}

/// As much of the pose shown so far as the bounds permit, for as long as they are likely to.
void RigidUpdateCoder::choose_smoothing(const Request& request, const Outlook& outlook, Update& update) const noexcept {
  const std::uint32_t object = request.object;
  const RigidPose shown = request.shown.pose(predictor_, truth_.tick());
  RigidState tried = update.state;
  const RigidPose own{tried.position, tried.rotation};
  const PoseOffset offset = offset_between(own, shown);
  const RigidBounds::Level& bounds = bounds_.of(request.lod);
  tried.smoothing_exp = 1;
  tried.retained = request.reason == Reason::haptic ? 1 : 0;  // all of it acts on the rendered force
  for (; tried.retained < 4; ++tried.retained) {
    const RigidPose kept = smoothed(own, tried, part_kept(offset, tried.retained), tried.tick);
    if (!within(bounds.visual, kept, truth_.state(object)) || bounds_.haptic_ratio_of(object, request.lod, kept) > bounds.scale)
      continue;
    tried.smoothing_exp = longest_smoothing_exp(error_trajectory(tried, kept, truth_.samples()[object], outlook.acceleration),
                                                outlook.ratio, scene_.tick_rate);
    if (tried.smoothing_exp == 0) return;
    update.state = tried;
    update.coded.smoothing_exp = tried.smoothing_exp;
    update.coded.retained = tried.retained;
    return;
  }
}

}  // namespace tactus
