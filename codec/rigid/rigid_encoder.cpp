// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_encoder.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <tactus/base/rule.h>

namespace tactus {
namespace {

constexpr double kHapticFraction = 0.2;  // of a bound may the rounding of an update use up
// Unless packets build on the one before and nobody repairs them, objects near their bounds join a packet that goes out anyway: a datagram's
// headers cost more than an update. Where packets wait for their turn few objects join whenever they move at all.
constexpr double kEarly = 0.5, kEarlyAtHeavyLoss = 0.3, kFewEarly = 0.3, kVeryFewEarly = 0.15;  // fractions of a bound
constexpr std::size_t kFew = 24, kVeryFew = 12;                                                 // objects that are awake
// Baseline::acknowledged: what is not acknowledged goes again.
constexpr double kSomeLoss = 0.003, kMoreLoss = 0.01, kHeavyLoss = 0.15;  // fractions of packets
constexpr std::array kFollowUp{0.020, 0.040, 0.060};                      // [s] since the last sending

Vec3 to_vector(const Vec3i& v, unsigned exponent) noexcept {
  const double unit = std::ldexp(1.0, -static_cast<int>(exponent));
  return {unit * v[0], unit * v[1], unit * v[2]};
}

/// From the true pose to a shown one that is near it.
SmallError error_of(const Pose& truth, const Pose& shown) noexcept {
  const Quat turn = shown.rotation * conjugate(truth.rotation);
  return {shown.position - truth.position, (turn.w < 0 ? -2.0 : 2.0) * Vec3{turn.x, turn.y, turn.z}};
}

bool are_valid(const RigidTriggers& t) noexcept {
  return std::isfinite(t.heartbeat) && t.heartbeat >= 0 && t.heartbeat <= 3600 && t.weber_fraction > 0 && t.weber_fraction <= 1 &&
         t.perceptual_fraction > 0 && t.perceptual_fraction <= 1 && std::isfinite(t.force_floor) && t.force_floor > 0 &&
         std::isfinite(t.cone_angle) && t.cone_angle > 0 && t.cone_angle <= std::numbers::pi;
}

}  // namespace

Result<void> RigidEncoder::check(const RigidTriggers& triggers, const GridExponents& grid) noexcept {
  if (!are_valid(triggers)) return fail(Errc::invalid_argument, "R-API-4");
  TACTUS_CHECK(pose_thresholds(triggers.visual_position, triggers.visual_rotation, grid));
  if (triggers.haptic == HapticRule::fixed) TACTUS_CHECK(pose_thresholds(triggers.fixed_position, triggers.fixed_rotation, grid));
  return {};
}

RigidEncoder::RigidEncoder(const Scene& scene, const RigidTriggers& triggers, const SenderPolicy& policy, const RigidTruth& truth,
                           RigidWork* work, const DevicePath* device)
    : scene_(scene),
      triggers_(triggers),
      predictor_(scene, truth.past() != nullptr ? device : nullptr),
      acknowledges_(policy.baseline == Baseline::acknowledged),
      early_(policy.baseline == Baseline::previous ? 1 : kEarly),
      heartbeat_(static_cast<std::int64_t>(std::ceil(triggers.heartbeat * scene.tick_rate))),
      silence_(static_cast<std::int64_t>(std::ceil(policy.silence * scene.tick_rate))),
      truth_(truth),
      work_(work),
      awake_(scene.objects.size()) {
  static_cast<void>(start_models());  // they are unpacked once, and not within a tick
  if (predictor_.has_device_path()) driven_.emplace(scene, *device);
  if (truth.past() != nullptr) choice_.emplace(scene, driven_ ? driven_->past : *truth.past(), device);
  pending_.reserve(scene.moving().size());
  before_.reserve(scene.moving().size());
  if (work != nullptr) {
    const std::size_t most = std::min(scene.moving().size(), RigidWork::kMostUpdates);
    key_.reserve(RigidWork::kAll + RigidWork::kEach * most);
    after_.reserve(most);
  }
  sent_.reserve(scene.objects.size());
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i)
    sent_.push_back({.path = {.object = i, .state = initial_state(scene, i)}});
  if (scene.interest) levels_.emplace(scene);
  set_bound_scale(1);
}

void RigidEncoder::set_bound_scale(double factor) noexcept {
  for (std::size_t lod = 0; lod < (levels_ ? bounds_.size() : 1); ++lod) {
    Bounds& b = bounds_[lod];
    b.bound_scale = std::ldexp(factor, static_cast<int>(lod));
    b.visual = scaled(triggers_.visual_position, triggers_.visual_rotation, b.bound_scale, scene_.grid);
    b.fixed = scaled(triggers_.fixed_position, triggers_.fixed_rotation, b.bound_scale, scene_.grid);
    if (triggers_.reduction == Reduction::none) b.visual.level = b.fixed.level = 0;  // the reference is as exact as the grid
    b.early = scaled(b.visual, early_);
  }
  wakes_all_ = true;
}

void RigidEncoder::set_viewpoints(std::span<const Vec3> viewpoints) noexcept {
  if (levels_) levels_->set_viewpoints(viewpoints);
}

void RigidEncoder::set_link(const LinkState& link) noexcept {
  loses_more_ = link.loss >= kMoreLoss;
  waits_ = link.waits;
  if (!acknowledges_) return;  // what is lost comes again, as it was
  loses_much_ = link.loss > kHeavyLoss;
  loses_ = link.loss >= kSomeLoss;
  for (std::size_t i = 0; i < follow_up_.size(); ++i) {
    const auto soon = static_cast<std::int64_t>(std::ceil(kFollowUp[i] * scene_.tick_rate));
    follow_up_[i] = link.ack_timeout <= 0 ? 0 : link.loss >= kSomeLoss && !link.copies ? soon : link.ack_timeout;
  }
}

/// The truth of this tick, and what the receiver's device means for it.
void RigidEncoder::take() noexcept {
  if (driven_) {
    if (loses_more_) std::ranges::fill(driven_->signalled, DrivenContact{});
    else driven_->choice.read(truth_.tick(), truth_.samples(), truth_.contacts(), driven_->signalled);
    driven_->past.read(truth_.tick(), truth_.states(), scene_.moving(), driven_->signalled);
  }
  wake();
}

/// From which fraction of its bounds on an object joins a packet.
void RigidEncoder::choose_early() noexcept {
  if (early_ == 1) return;
  double early = acknowledges_ && loses_much_ ? kEarlyAtHeavyLoss : kEarly;
  if (waits_ && awake_.objects().size() <= kFew) early = awake_.objects().size() <= kVeryFew ? kVeryFewEarly : kFewEarly;
  if (early == early_) return;
  early_ = early;
  for (Bounds& b : bounds_) b.early = scaled(b.visual, early_);
}

bool RigidEncoder::is_touched(std::uint32_t object) const noexcept {
  return triggers_.haptic != HapticRule::off && truth_.is_touched(object);
}

/// With the tick of now.
RigidState RigidEncoder::truth_of(std::uint32_t object) const noexcept {
  RigidState out = truth_.state(object);
  out.tick = truth_.tick();
  if (driven_) out.contact = driven_->signalled[object];
  out.lod = lod_of(object);
  return out;
}

// ==== what is awake ====

/// At first what has never left its initial state is where a receiver shows it, within every bound; with interest all are out of it, and those
/// that are not are found by turns.
void RigidEncoder::wake() noexcept {
  const std::uint64_t last = std::exchange(read_, truth_.reads());
  const bool begins = !std::exchange(has_begun_, true) && heartbeat_ == 0 && (!levels_ || levels_->looks());
  const bool wakes_all = std::exchange(wakes_all_, false) && !begins;
  if (wakes_all || triggers_.reduction == Reduction::none) return awake_.wake(scene_.moving());
  if (begins) {
    for (const std::uint32_t i : truth_.left()) wake(i);
  } else if (last + 1 == read_) {
    for (const std::uint32_t i : truth_.moved()) wake(i);
  } else {
    for (const std::uint32_t i : scene_.moving())
      if (truth_.has_moved_since(last, i)) wake(i);
  }
  for (const std::uint32_t i : truth_.touched())
    if (scene_.objects[i].dof != 0) wake(i);
  awake_.wake_due(truth_.tick());
}

/// Not for what is not signalled to the client.
void RigidEncoder::wake(std::uint32_t object) noexcept {
  if (!levels_ || !levels_->is_left_out(object)) awake_.wake(object);
}

/// Levels of what is awake, and of what the client comes to or goes away from.
void RigidEncoder::look() noexcept {
  levels_->scan(truth_, [this](std::uint32_t object) { awake_.wake(object); });
  for (const std::uint32_t i : awake_.objects()) levels_->look(i, truth_);
}

/// Neither the object nor its prediction moves, and nothing is left to send: nothing changes before its heartbeat.
std::optional<std::int64_t> RigidEncoder::sleeps_until(std::uint32_t object) noexcept {
  const Sent& sent = sent_[object];
  if (levels_ && lod_of(object) != sent.path.state.lod) return std::nullopt;
  if (lod_of(object) == kOutOfInterest) {
    if (acknowledges_ && !sent.acknowledged) return std::nullopt;
    levels_->leave_out(object);
    return AwakeObjects::kNever;
  }
  if (truth_.has_moved(object) || truth_.is_touched(object)) return std::nullopt;
  const std::int64_t tick = truth_.tick();
  if (is_smoothing(sent.path.state, tick) || !predictor_.is_at_rest(sent.path.state, tick)) return std::nullopt;
  if (acknowledges_ && !sent.acknowledged) return std::nullopt;
  const RigidDecision decision = decide(object, early_ < 1);
  if (decision.reason != Reason::request || decision.is_early) return std::nullopt;
  return heartbeat_ > 0 ? sent.path.state.tick + heartbeat_ : AwakeObjects::kNever;
}

void RigidEncoder::sleep() noexcept {
  if (triggers_.reduction == Reduction::none) return;
  awake_.sleep([this](std::uint32_t object) { return sleeps_until(object); });
}

// ==== what to send ====

/// The largest haptic_ratio() of the contacts on the object; with the rule `fixed` 0 or infinite.
double RigidEncoder::haptic_ratio_of(std::uint32_t object, const RigidPose& shown) const noexcept {
  constexpr double kOutside = std::numeric_limits<double>::infinity();
  double out = 0;
  if (!is_touched(object)) return out;
  for (const Contact& contact : truth_.contacts()) {
    if (contact.kind == ContactKind::none || contact.object != object) continue;
    if (triggers_.haptic == HapticRule::fixed) return within(bounds_of(object).fixed, shown, truth_.state(object)) ? 0 : kOutside;
    const Vec3 estimate = contact_force(contact, to_pose(shown, scene_.grid.position));
    const double ratio = haptic_ratio(triggers_, contact_force(contact, truth_.samples()[object].pose), estimate);
    if (std::isnan(ratio)) return kOutside;  // forces too large to compare
    out = std::max(out, ratio);
  }
  return out;
}

/// An update would bring the shown pose nearer to the truth: they are not at the same point of the grid.
bool RigidEncoder::can_improve(std::uint32_t object, const RigidPose& shown) const noexcept {
  const Residual rest = quantise_pose(shown, truth_.state(object), scene_.objects[object].dof, 0, scene_.grid);
  return rest.of != Residual{}.of;
}

/// in   early  ask whether it would soon cause a packet, too
RigidDecision RigidEncoder::decide_alone(const SmoothedPath& path, bool early) const noexcept {
  const std::uint32_t object = path.object;
  const std::int64_t tick = truth_.tick();
  const RigidState& truth = truth_.state(object);
  const RigidPose predicted = predictor_.shown(object, path.state, tick);
  const RigidPose shown = smoothed(predicted, path.state, path.offset, tick);
  const double force_ratio = haptic_ratio_of(object, shown);
  const Bounds& bounds = bounds_of(object);
  RigidDecision out;
  if (force_ratio > bounds.bound_scale && can_improve(object, shown)) out.reason = Reason::haptic;
  else if (!within(bounds.visual, shown, truth) || (is_smoothing(path.state, tick) && !within(bounds.visual, predicted, truth)))
    out.reason = Reason::visual;
  else if (heartbeat_ > 0 && tick - path.state.tick >= heartbeat_) out.reason = Reason::heartbeat;
  out.is_early =
      early && (!within(bounds.early, shown, truth) || (force_ratio > early_ * bounds.bound_scale && can_improve(object, shown)));
  return out;
}

/// The same, or what another encoder found.
RigidDecision RigidEncoder::decide(std::uint32_t object, bool early) noexcept {
  const SmoothedPath& path = sent_[object].path;
  if (work_ == nullptr || (driven_ && path.state.predictor == Predictor::driven)) return decide_alone(path, early);
  const RigidWork::Asked asked{sent_[object].version, object, bounds_of(object).bound_scale, early ? early_ : 1};
  if (const RigidDecision* const known = work_->find(read_, asked)) return *known;
  const RigidDecision out = decide_alone(path, early);
  work_->put(read_, asked, out);
  return out;
}

bool RigidEncoder::is_follow_up_due(std::uint32_t object) const noexcept {
  const Sent& sent = sent_[object];
  const std::int64_t wait = follow_up_[std::min<std::size_t>(sent.follow_ups, follow_up_.size() - 1)];
  return !sent.acknowledged && wait > 0 && truth_.tick() - sent.path.state.tick >= wait;
}

/// Nothing is pending without at least one trigger, follow-up or request.
void RigidEncoder::collect(const EncodeRequest<RigidStates>& request) noexcept {
  pending_.clear();
  for (const std::uint32_t i : awake_.objects()) {
    const std::uint8_t lod = lod_of(i);
    const bool is_out = lod == kOutOfInterest;
    const Reason reason = is_out ? Reason::request : decide(i, false).reason;
    const bool fires =
        reason != Reason::request || lod != sent_[i].path.state.lod || (triggers_.reduction == Reduction::none && !is_out);
    if (fires || is_follow_up_due(i)) pending_.push_back({.object = i, .reason = reason, .follow_up = !fires, .after = {}});
  }
  if (pending_.empty() && is_silent())
    pending_.push_back({.object = scene_.moving()[0], .reason = Reason::heartbeat, .follow_up = false, .after = {}});
  if ((pending_.empty() && !request.requested) || (!request.head.key && early_ == 1)) return;
  add_joining(request);
}

/// Objects whose trigger did not fire are named in a packet that others have caused: in a key packet if they have left their initial
/// state; else if they would soon cause a packet of their own. What sleeps would not. What is out of interest is never named.
void RigidEncoder::add_joining(const EncodeRequest<RigidStates>& request) noexcept {
  const std::size_t causes = pending_.size();
  std::size_t next = 0;  // of the causes
  for (const std::uint32_t i : request.head.key ? scene_.moving() : awake_.objects()) {
    if (next < causes && pending_[next].object == i) {
      ++next;
      continue;
    }
    if (lod_of(i) == kOutOfInterest) continue;
    const bool is_new = request.head.key && sent_[i].path.state != request.base.objects[i];
    if (is_new || (early_ < 1 && awake_.is_awake(i) && decide(i, true).is_early))
      pending_.push_back({.object = i, .reason = Reason::request, .follow_up = false, .after = {}});
  }
  std::ranges::sort(pending_, {}, &Pending::object);
}

RigidTriggers RigidEncoder::scaled_triggers(std::uint32_t object) const noexcept {
  RigidTriggers out = triggers_;
  for (double* bound : {&out.visual_position, &out.visual_rotation, &out.weber_fraction, &out.perceptual_fraction,
                        &out.fixed_position, &out.fixed_rotation})
    *bound *= bounds_of(object).bound_scale;
  return out;
}

Predictor RigidEncoder::chosen(std::uint32_t object, const RigidState& truth, const RigidTriggers& bounds) const noexcept {
  PermittedError permitted{bounds.visual_position, bounds.visual_rotation};
  for (const Contact& contact : truth_.contacts()) {
    if (contact.kind == ContactKind::none || contact.object != object || bounds.haptic == HapticRule::off) continue;
    const double force = norm(contact_force(contact, truth_.samples()[object].pose));
    const bool fixed = bounds.haptic == HapticRule::fixed;
    permitted.position =
        std::min(permitted.position, fixed ? bounds.fixed_position : force_budget(bounds, force) / contact.stiffness);
    if (fixed) permitted.rotation = std::min(permitted.rotation, bounds.fixed_rotation);
  }
  return choice_->choose(object, truth, permitted, is_touched(object), sent_[object].path.state);
}

/// The true state with the velocities that an update is to send.   pre  it is predicted linearly
RigidState RigidEncoder::with_look_ahead(const RigidState& truth, std::uint32_t object, const Acceleration::Motion& acceleration,
                                         const ErrorRatio& ratio) const noexcept {
  if (truth_.acceleration() == nullptr || loses_) return truth;
  RigidSample sample = truth_.samples()[object];
  const Acceleration::Motion more = look_ahead_velocity(acceleration, ratio);
  sample.velocity = sample.velocity + more.linear;
  sample.angular_velocity = sample.angular_velocity + more.angular;
  return to_grid(sample, truth.tick, scene_.grid).value_or(truth);
}

/// In the ticks after an update whose offset leads to `kept` now.
ErrorTrajectory RigidEncoder::error_trajectory(const RigidState& state, const RigidPose& kept, const RigidSample& truth,
                                               const Acceleration::Motion& acceleration) const noexcept {
  const Pose own = to_pose({state.position, state.rotation}, scene_.grid.position);
  const Acceleration::Motion drift{to_vector(state.velocity, scene_.grid.velocity) - truth.velocity,
                                   to_vector(state.angular_velocity, scene_.grid.angular_velocity) - truth.angular_velocity};
  return {error_of(own, to_pose(kept, scene_.grid.position)), error_of(truth.pose, own), drift, acceleration};
}

/// As much of the pose shown so far as the bounds permit, for as long as they are likely to.
void RigidEncoder::choose_smoothing(Pending& update, CodedUpdate& coded, const Acceleration::Motion& acceleration,
                                    const ErrorRatio& ratio) const noexcept {
  const std::uint32_t object = update.object;
  const RigidPose shown = sent_[object].path.pose(predictor_, truth_.tick());
  RigidState tried = update.after.path.state;
  const RigidPose own{tried.position, tried.rotation};
  const PoseOffset offset = offset_between(own, shown);
  tried.smoothing_exp = 1;
  tried.retained = update.reason == Reason::haptic ? 1 : 0;  // all of it acts on the rendered force
  for (; tried.retained < 4; ++tried.retained) {
    const RigidPose kept = smoothed(own, tried, part_kept(offset, tried.retained), tried.tick);
    const Bounds& bounds = bounds_of(object);
    if (!within(bounds.visual, kept, truth_.state(object)) || haptic_ratio_of(object, kept) > bounds.bound_scale) continue;
    tried.smoothing_exp =
        longest_smoothing_exp(error_trajectory(tried, kept, truth_.samples()[object], acceleration), ratio, scene_.tick_rate);
    if (tried.smoothing_exp == 0) return;
    update.after.path.state = tried;
    coded.smoothing_exp = tried.smoothing_exp;
    coded.retained = tried.retained;
    return;
  }
}

/// The update of one object, and the state after it. A predictor other than the linear one counts as knowing the acceleration.
/// A key packet is not smoothed: a client may begin with it, and has shown nothing of what the path would begin with. So is what was out of
/// interest. What is held rests: it has no look-ahead.
Result<CodedUpdate> RigidEncoder::code(Pending& update, const EncodeRequest<RigidStates>& request) const noexcept {
  const std::uint32_t object = update.object;
  const RigidState& base = request.base.objects[object];
  const Prediction prediction{base, predictor_.pose(base, request.tick)};
  const RigidState truth = truth_of(object);
  if ((truth_.acceleration() == nullptr && !choice_) || truth_.is_held(object)) return quantise(update, prediction, truth);
  const RigidTriggers bounds = scaled_triggers(object);
  const Predictor predictor = choice_ ? chosen(object, truth, bounds) : Predictor::linear;
  const bool is_linear = predictor == Predictor::linear;
  const ErrorRatio ratio(object, truth_.samples()[object].pose, truth_.contacts(), bounds,
                         truth_.force_trend() != nullptr ? truth_.force_trend()->relative_decay_rate(object) : 0);
  const bool looks_ahead = truth_.acceleration() != nullptr && is_linear;
  const auto acceleration = looks_ahead ? truth_.acceleration()->of(object) : Acceleration::Motion{};
  RigidState signalled = is_linear ? with_look_ahead(truth, object, acceleration, ratio) : truth;
  signalled.predictor = predictor;
  TACTUS_TRY(CodedUpdate coded, quantise(update, prediction, signalled));
  const bool is_shown = sent_[object].path.state.lod != kOutOfInterest;
  if (truth_.acceleration() != nullptr && !request.head.key && is_shown) choose_smoothing(update, coded, acceleration, ratio);
  return coded;
}

/// The coarsest level whose rounding leaves room inside every bound; without one, the finest that keeps them; where the grid is too
/// coarse for the permitted force error, or the distance too long for one update, the nearest point that it can name.
Result<CodedUpdate> RigidEncoder::quantise(Pending& update, const Prediction& prediction,
                                           const RigidState& signalled) const noexcept {
  const std::uint32_t object = update.object;
  const RigidState& truth = truth_.state(object);
  const std::uint8_t dof = scene_.objects[object].dof;
  std::optional<CodedUpdate> finest;
  const Bounds& bounds = bounds_of(object);
  const bool is_fixed = triggers_.haptic == HapticRule::fixed && is_touched(object);
  const unsigned coarsest = is_fixed ? bounds.fixed.level : bounds.visual.level;
  for (unsigned levels = coarsest + 1; levels > 0; --levels) {
    const unsigned level = levels - 1;
    CodedUpdate coded{.reason = update.reason,
                      .level = static_cast<std::uint8_t>(level),
                      .residual = quantise_pose(prediction.pose, truth, dof, level, scene_.grid),
                      .predictor = signalled.predictor,
                      .lod = static_cast<std::uint8_t>((lod_of(object) - prediction.base.lod) & 7)};
    if (signalled.predictor == Predictor::driven) set_contact(prediction.base, signalled.contact, coded);
    quantise_motion(predictor_, prediction, signalled, dof, coded);
    const auto state = reconstruct(predictor_, prediction, truth_.tick(), coded, scene_.grid);
    if (!state) return fail(Errc::internal, "R-RIG-6");
    const RigidPose shown{state->position, state->rotation};
    if (level > 0 && !within(bounds.visual, shown, truth)) continue;
    const double force_ratio = haptic_ratio_of(object, shown);
    if ((level > 0 || finest) && force_ratio > bounds.bound_scale) continue;
    update.after.path.state = *state;
    if (force_ratio <= kHapticFraction * bounds.bound_scale) return coded;
    finest = coded;
  }
  return *finest;  // that of level 0, if no other
}

Result<Payload> RigidEncoder::code_all(const EncodeRequest<RigidStates>& request, std::span<std::uint8_t> out) noexcept {
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
    const RigidState state = update.after.path.state;
    update.after.path = sent_[update.object].path;
    update.after.path.follow(predictor_, state);
  }
  const std::size_t size = coder.finish();
  if (coder.overflow() || coder.too_wide()) return fail(Errc::internal, "R-PKT-1");
  return Payload{size, strongest, static_cast<std::uint32_t>(pending_.size())};
}

// ==== what is shared ====

/// Not where a device drives objects: no other receiver has it.
bool RigidEncoder::uses_common_work() const noexcept {
  return work_ != nullptr && !driven_ && pending_.size() <= RigidWork::kMostUpdates;
}

/// All that the payload depends on.
void RigidEncoder::make_key(const EncodeRequest<RigidStates>& request) noexcept {
  key_.clear();
  const auto bound_scale = std::bit_cast<std::array<std::uint32_t, 2>>(bounds_[0].bound_scale);
  for (const std::uint32_t word : {request.head.baseline_delta, request.head.tick_delta, request.head.key ? 1u : 0u,
                                   loses_ ? 1u : 0u, bound_scale[0], bound_scale[1]})
    key_.push_back(word);
  for (const Pending& update : pending_) {
    const Sent& sent = sent_[update.object];
    const std::uint64_t version = sent.path.state.lod == kOutOfInterest ? 0 : sent.version;  // what was not shown does not count
    const std::uint64_t why = static_cast<std::uint64_t>(update.reason) | std::uint64_t{lod_of(update.object)} << 8;
    for (const auto word : {std::uint64_t{update.object}, why, version, version >> 32})
      key_.push_back(static_cast<std::uint32_t>(word));
    append_to(key_, request.base.objects[update.object]);
  }
}

Payload RigidEncoder::copy(const RigidWork::Body& body, std::span<std::uint8_t> out) noexcept {
  std::ranges::copy(body.bytes, out.begin());
  for (std::size_t i = 0; i < pending_.size(); ++i) pending_[i].after = body.after[i];
  return {body.bytes.size(), body.reason, static_cast<std::uint32_t>(pending_.size())};
}

Result<Payload> RigidEncoder::encode(const EncodeRequest<RigidStates>& request, std::span<std::uint8_t> out) noexcept {
  take();
  if (levels_) look();
  choose_early();
  collect(request);
  number_ = request.number;
  if (pending_.empty()) {
    sleep();
    return Payload{};
  }
  if (!uses_common_work()) {
    const auto alone = code_all(request, out);
    for (Pending& update : pending_) update.after.version = work_ != nullptr ? work_->next_version() : 0;
    return alone;
  }
  make_key(request);
  if (const RigidWork::Body* const known = work_->find(read_, key_)) return copy(*known, out);
  const auto payload = code_all(request, out);
  if (!payload) return payload;
  after_.clear();
  for (Pending& update : pending_) after_.push_back(&update.after);
  work_->put(read_, key_, out.first(payload->size), payload->reason, after_);
  return payload;
}

void RigidEncoder::commit(const RigidStates& base, RigidStates& next) noexcept {
  if (&base != &next) next.objects = base.objects;
  before_last_ = std::exchange(last_, truth_.tick());
  before_.clear();
  for (const Pending& update : pending_) {
    next.objects.set(update.object, update.after.path.state);
    Sent& sent = sent_[update.object];
    before_.emplace_back(update.object, sent);
    const auto follow_ups = static_cast<std::uint8_t>(update.follow_up ? std::min(sent.follow_ups + 1, 255) : 0);
    sent = {.path = update.after.path,
            .version = update.after.version,
            .number = number_,
            .follow_ups = follow_ups,
            .acknowledged = false};
    awake_.wake(update.object);
  }
  sleep();
}

void RigidEncoder::forget_last() noexcept {
  for (const auto& [object, sent] : before_) {
    sent_[object] = sent;
    awake_.wake(object);
  }
  last_ = before_last_;
  before_.clear();
}

/// What sleeps is acknowledged.
void RigidEncoder::acknowledge(std::uint64_t number) noexcept {
  for (const std::uint32_t i : awake_.objects()) sent_[i].acknowledged = sent_[i].acknowledged || sent_[i].number == number;
  for (auto& [object, sent] : before_) sent.acknowledged = sent.acknowledged || sent.number == number;
}

}  // namespace tactus
