// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_encoder.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include <tactus/base/rule.h>

namespace tactus {
namespace {

// Unless packets build on the one before and nobody repairs them, objects near their bounds join a packet that goes out anyway: a datagram's
// headers cost more than an update. Where packets wait for their turn few objects join whenever they move at all.
constexpr double kEarly = 0.5, kEarlyAtHeavyLoss = 0.3, kFewEarly = 0.3, kVeryFewEarly = 0.15;  // fractions of a bound
constexpr std::size_t kFew = 24, kVeryFew = 12;                                                 // objects that are awake
// Baseline::acknowledged: what is not acknowledged goes again.
constexpr double kSomeLoss = 0.003, kMoreLoss = 0.01, kHeavyLoss = 0.15;  // fractions of packets
constexpr std::array kFollowUp{0.020, 0.040, 0.060};                      // [s] since the last sending

}  // namespace

RigidEncoder::RigidEncoder(const Scene& scene, const RigidTriggers& triggers, const SenderPolicy& policy, const RigidTruth& truth,
                           RigidWork* work, const DevicePath* device)
    : scene_(scene),
      bounds_(scene, triggers, truth),
      predictor_(scene, truth.past() != nullptr ? device : nullptr),
      updates_(scene, truth, bounds_, predictor_, device),
      acknowledges_(policy.baseline == Baseline::acknowledged),
      joins_early_(policy.baseline != Baseline::previous),
      heartbeat_(static_cast<std::int64_t>(std::ceil(triggers.heartbeat * scene.tick_rate))),
      silence_(static_cast<std::int64_t>(std::ceil(policy.silence * scene.tick_rate))),
      truth_(truth),
      work_(work),
      awake_(scene.objects.size()) {
  static_cast<void>(start_models());  // they are unpacked once, and not within a tick
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
  if (joins_early_) bounds_.set_early(kEarly);
}

void RigidEncoder::set_bound_scale(double factor) noexcept {
  bounds_.set_scale(factor);
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
  updates_.set_looks_ahead(link.loss < kSomeLoss);
  for (std::size_t i = 0; i < follow_up_.size(); ++i) {
    const auto soon = static_cast<std::int64_t>(std::ceil(kFollowUp[i] * scene_.tick_rate));
    follow_up_[i] = link.ack_timeout <= 0 ? 0 : link.loss >= kSomeLoss && !link.copies ? soon : link.ack_timeout;
  }
}

/// From which fraction of its bounds on an object joins a packet.
void RigidEncoder::choose_early() noexcept {
  if (!joins_early_) return;
  double early = acknowledges_ && loses_much_ ? kEarlyAtHeavyLoss : kEarly;
  if (waits_ && awake_.objects().size() <= kFew) early = awake_.objects().size() <= kVeryFew ? kVeryFewEarly : kFewEarly;
  bounds_.set_early(early);
}

// ==== what is awake ====

/// At first what has never left its initial state is where a receiver shows it, within every bound; with interest all are out of it, and those
/// that are not are found by turns.
void RigidEncoder::wake() noexcept {
  const std::uint64_t last = std::exchange(read_, truth_.reads());
  const bool begins = !std::exchange(has_begun_, true) && heartbeat_ == 0 && (!levels_ || levels_->looks());
  const bool wakes_all = std::exchange(wakes_all_, false) && !begins;
  if (wakes_all || is_reference()) return awake_.wake(scene_.moving());
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
  const RigidDecision decision = decide(object, joins_early_);
  if (decision.reason != Reason::request || decision.is_early) return std::nullopt;
  return heartbeat_ > 0 ? sent.path.state.tick + heartbeat_ : AwakeObjects::kNever;
}

void RigidEncoder::sleep() noexcept {
  if (is_reference()) return;
  awake_.sleep([this](std::uint32_t object) { return sleeps_until(object); });
}

// ==== what to send ====

RigidDecision RigidEncoder::decide_alone(const SmoothedPath& path, bool early) const noexcept {
  RigidDecision out = bounds_.decide(path, predictor_, lod_of(path.object), early);
  const bool is_due = heartbeat_ > 0 && truth_.tick() - path.state.tick >= heartbeat_;
  if (out.reason == Reason::request && is_due) out.reason = Reason::heartbeat;
  return out;
}

/// The same, or what another encoder found.
RigidDecision RigidEncoder::decide(std::uint32_t object, bool early) noexcept {
  const SmoothedPath& path = sent_[object].path;
  if (work_ == nullptr || path.state.predictor == Predictor::driven) return decide_alone(path, early);
  const RigidWork::Asked asked{sent_[object].version, object, bounds_.of(lod_of(object)).scale, early ? bounds_.early() : 1};
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
    const bool fires = reason != Reason::request || lod != sent_[i].path.state.lod || (is_reference() && !is_out);
    if (fires || is_follow_up_due(i)) pending_.push_back({.object = i, .reason = reason, .follow_up = !fires, .after = {}});
  }
  if (pending_.empty() && is_silent())
    pending_.push_back({.object = scene_.moving()[0], .reason = Reason::heartbeat, .follow_up = false, .after = {}});
  if ((pending_.empty() && !request.requested) || (!request.head.key && !joins_early_)) return;
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
    if (is_new || (joins_early_ && awake_.is_awake(i) && decide(i, true).is_early))
      pending_.push_back({.object = i, .reason = Reason::request, .follow_up = false, .after = {}});
  }
  std::ranges::sort(pending_, {}, &Pending::object);
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
    const SmoothedPath& shown = sent_[update.object].path;
    TACTUS_TRY(auto made, updates_.code({.object = update.object,
                                         .reason = update.reason,
                                         .lod = lod_of(update.object),
                                         .base = request.base.objects[update.object],
                                         .shown = shown,
                                         .key = request.head.key}));
    code_update(coder, models, scene_, update.object, made.coded);
    strongest = std::max(strongest, update.reason);
    update.after.path = shown;
    update.after.path.follow(predictor_, made.state);
  }
  const std::size_t size = coder.finish();
  if (coder.overflow() || coder.too_wide()) return fail(Errc::internal, "R-PKT-1");
  return Payload{size, strongest, static_cast<std::uint32_t>(pending_.size())};
}

// ==== what is shared ====

/// Not where a device drives objects: no other receiver has it.
bool RigidEncoder::uses_common_work() const noexcept {
  return work_ != nullptr && !predictor_.has_device_path() && pending_.size() <= RigidWork::kMostUpdates;
}

/// All that the payload depends on.
void RigidEncoder::make_key(const EncodeRequest<RigidStates>& request) noexcept {
  key_.clear();
  const auto bound_scale = std::bit_cast<std::array<std::uint32_t, 2>>(bounds_.of(0).scale);
  for (const std::uint32_t word : {request.head.baseline_delta, request.head.tick_delta, request.head.key ? 1u : 0u,
                                   updates_.looks_ahead() ? 1u : 0u, bound_scale[0], bound_scale[1]})
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
  updates_.read(!loses_more_);
  wake();
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
