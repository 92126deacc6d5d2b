// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_encoder.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <tactus/base/out_of_memory.h>
#include <tactus/packet/packet_order.h>
#include <tactus/rigid/rigid_syntax.h>

namespace tactus {
namespace {

// Shares of a bound that the quantisation of an update may use up; the rest is left for the motion until the next update.
constexpr double kVisualShare = 0.125;
constexpr double kHapticShare = 0.35;
constexpr std::int32_t kDofTolerance = 64;  // x 2^-30: a locked axis may be off by rounding only

/// Visual thresholds in grid units, shrunk so that the bound also holds for the unrounded truth.
struct Thresholds {
  std::int64_t distance_squared = 0;
  std::int64_t half_angle_squared = 0;  // (sin(angle / 2))^2 x 2^-60 of a quaternion of length 1
  unsigned level = 0;                   // coarsest grid level whose rounding stays within kVisualShare
};

Result<Thresholds> make_thresholds(double distance, double angle, const GridExponents& grid) {
  const double unit = std::ldexp(1.0, -grid.position);
  const double turn_unit = std::ldexp(4.0, -grid.rotation);
  if (!(distance >= 8 * unit && distance < 1e6) || !(angle >= 8 * turn_unit && angle <= std::numbers::pi)) {
    return fail(Errc::invalid_argument, "R-API-4");
  }
  Thresholds out;
  const auto units = static_cast<std::int64_t>(std::min(distance / unit, 1073741824.0)) - 1;
  out.distance_squared = units * units;
  const auto quarter = static_cast<std::uint32_t>(angle / (4 * std::numbers::pi) * 4294967296.0);
  const std::int64_t sine = sin30(quarter) - 8;
  out.half_angle_squared = sine * sine;
  const double worst = std::sqrt(0.75);
  while (out.level < 7 && worst * unit * std::ldexp(4.0, 2 * static_cast<int>(out.level)) <= kVisualShare * distance &&
         worst * turn_unit * std::ldexp(4.0, 2 * static_cast<int>(out.level)) <= kVisualShare * angle) {
    ++out.level;
  }
  return out;
}

bool within(const Thresholds& t, const RigidPose& shown, const RigidState& truth) noexcept {
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

bool is_valid(const Contact& c, const StreamHeader& header) noexcept {
  if (c.kind == ContactKind::none) return true;
  const bool unit = c.kind == ContactKind::spring || std::abs(norm(c.normal) - 1) <= 1e-6;
  return c.kind <= ContactKind::spring && c.object < header.objects.size() && is_finite(c.point) && is_finite(c.normal) && unit &&
         is_finite(c.device) && std::isfinite(c.stiffness) && c.stiffness > 0;
}

bool are_valid(const RigidTriggers& t) noexcept {
  return std::isfinite(t.heartbeat) && t.heartbeat >= 0 && t.heartbeat <= 3600 && std::isfinite(t.weber_fraction) &&
         t.weber_fraction > 0 && std::isfinite(t.force_floor) && t.force_floor > 0 && std::isfinite(t.cone_angle) &&
         t.cone_angle > 0 && t.cone_angle <= std::numbers::pi;
}

}  // namespace

struct RigidEncoder::Impl {
  struct Pending {
    std::uint32_t object = 0;  // index into the header
    Reason reason = Reason::request;
    RigidState state;  // what the decoder will hold
  };

  StreamHeader header;
  RigidTriggers triggers;
  Thresholds visual, fixed;
  std::int64_t heartbeat = 0;     // [ticks], 0: off
  std::int64_t key_interval = 0;  // [ticks], 0: never
  std::vector<std::uint32_t> moving;
  std::vector<RigidState> held;   // what the decoder holds
  std::vector<RigidState> truth;  // this tick, on the grid
  std::vector<Pending> pending;
  std::vector<std::uint8_t> buffer;
  std::uint16_t sequence = 0;
  std::int64_t last_tick = -1;   // of the last call
  std::int64_t packet_tick = 0;  // of the last packet
  std::int64_t key_tick = -1;    // of the last key packet; -1: none yet
  bool key_requested = false;    // by request_key(), since the last packet

  Result<void> read_truth(std::int64_t tick, std::span<const RigidSample> samples) noexcept;
  Reason reason_for(std::uint32_t object, const RigidPose& shown, const Pose& pose, std::span<const Contact> contacts,
                    std::int64_t tick) const noexcept;
  bool can_improve(std::uint32_t object, const RigidPose& shown) const noexcept;
  bool haptic_within(std::uint32_t object, const RigidPose& shown, const Pose& pose, std::span<const Contact> contacts,
                     double share) const noexcept;
  void collect(std::int64_t tick, std::span<const RigidSample> samples, std::span<const Contact> contacts, bool key) noexcept;
  Result<CodedUpdate> quantise(Pending& update, const Prediction& prediction, const Pose& pose,
                               std::span<const Contact> contacts) const noexcept;
  Result<std::size_t> write(std::int64_t tick, PacketHead head, std::span<const RigidSample> samples,
                            std::span<const Contact> contacts) noexcept;
};

Result<void> RigidEncoder::Impl::read_truth(std::int64_t tick, std::span<const RigidSample> samples) noexcept {
  for (const std::uint32_t i : moving) {
    TACTUS_TRY(truth[i], to_grid(samples[i], tick, header.grid));
    if (!obeys_dof(header.objects[i], truth[i])) return fail(Errc::invalid_argument, "R-API-6");
  }
  return {};
}

/// Haptic rule for every contact on the object, at `share` of the permitted error.
bool RigidEncoder::Impl::haptic_within(std::uint32_t object, const RigidPose& shown, const Pose& pose,
                                       std::span<const Contact> contacts, double share) const noexcept {
  if (triggers.haptic == HapticRule::off) return true;
  for (const Contact& contact : contacts) {
    if (contact.kind == ContactKind::none || contact.object != object) continue;
    if (triggers.haptic == HapticRule::fixed) return within(fixed, shown, truth[object]);
    const Vec3 estimate = contact_force(contact, to_pose(shown, header.grid));
    const double ratio = haptic_ratio(triggers, contact_force(contact, pose), estimate);
    if (!(ratio <= share)) return false;  // forces too large to compare are outside, too
  }
  return true;
}

/// An update would bring the shown pose nearer to the truth: they are not at the same place of the grid.
bool RigidEncoder::Impl::can_improve(std::uint32_t object, const RigidPose& shown) const noexcept {
  const Residual rest = quantise_pose(shown, truth[object], header.objects[object].dof, 0, header.grid);
  return rest.of != Residual{}.of;
}

Reason RigidEncoder::Impl::reason_for(std::uint32_t object, const RigidPose& shown, const Pose& pose,
                                      std::span<const Contact> contacts, std::int64_t tick) const noexcept {
  if (!haptic_within(object, shown, pose, contacts, 1.0) && can_improve(object, shown)) return Reason::haptic;
  if (!within(visual, shown, truth[object])) return Reason::visual;
  if (heartbeat > 0 && tick - held[object].tick >= heartbeat) return Reason::heartbeat;
  return Reason::request;
}

/// Everything that a trigger asks for and, in a key packet, everything that has left the initial state on which it builds.
/// Nothing is pending without at least one trigger or a request.
void RigidEncoder::Impl::collect(std::int64_t tick, std::span<const RigidSample> samples, std::span<const Contact> contacts,
                                 bool key) noexcept {
  pending.clear();
  bool triggered = key_requested;
  for (const std::uint32_t i : moving) {
    const Reason reason = reason_for(i, predict(held[i], tick, header), samples[i].pose, contacts, tick);
    const bool fires = reason != Reason::request || triggers.reduction == Reduction::none;
    triggered = triggered || fires;
    if (fires || (key && held[i] != header.objects[i].initial)) pending.push_back({i, reason, {}});
  }
  if (!triggered) pending.clear();
}

/// The coarsest level whose rounding leaves room inside every bound; without one, the finest that keeps them; where the grid is too
/// coarse for the permitted force error, the nearest place on it.
Result<CodedUpdate> RigidEncoder::Impl::quantise(Pending& update, const Prediction& prediction, const Pose& pose,
                                                 std::span<const Contact> contacts) const noexcept {
  const std::uint32_t object = update.object;
  const std::uint8_t dof = header.objects[object].dof;
  const bool touched = triggers.haptic != HapticRule::off &&
                       std::any_of(contacts.begin(), contacts.end(),
                                   [object](const Contact& c) { return c.kind != ContactKind::none && c.object == object; });
  std::optional<CodedUpdate> finest;
  const unsigned coarsest = touched && triggers.haptic == HapticRule::fixed ? fixed.level : visual.level;
  for (unsigned levels = coarsest + 1; levels > 0; --levels) {
    const unsigned level = levels - 1;
    CodedUpdate coded{update.reason, static_cast<std::uint8_t>(level),
                      quantise_pose(prediction.pose, truth[object], dof, level, header.grid)};
    quantise_motion(prediction, truth[object], dof, header, coded);
    const auto state = reconstruct(prediction, truth[object].tick, coded, header);
    if (!state) return fail(Errc::internal, "R-RIG-6");
    const RigidPose shown{state->position, state->rotation};
    if (!within(visual, shown, truth[object])) continue;
    if ((level > 0 || finest) && !haptic_within(object, shown, pose, contacts, 1.0)) continue;
    update.state = *state;
    if (haptic_within(object, shown, pose, contacts, kHapticShare)) return coded;
    finest = coded;
  }
  if (!finest) return fail(Errc::invalid_argument, "R-API-7");
  return *finest;
}

Result<std::size_t> RigidEncoder::Impl::write(std::int64_t tick, PacketHead head, std::span<const RigidSample> samples,
                                              std::span<const Contact> contacts) noexcept {
  const auto next_sequence = static_cast<std::uint16_t>(sequence + 1);
  buffer[0] = static_cast<std::uint8_t>(next_sequence);
  buffer[1] = static_cast<std::uint8_t>(next_sequence >> 8);
  RangeEncoder coder(std::span<std::uint8_t>(buffer).subspan(2));
  RigidModels models = start_models();
  head.count = static_cast<std::uint32_t>(pending.size());
  code_head(coder, models, header, moving.size(), head);
  std::uint32_t next = 0;  // index into `moving`
  for (Pending& update : pending) {
    const auto at = static_cast<std::uint32_t>(std::lower_bound(moving.begin(), moving.end(), update.object) - moving.begin());
    if (moving.size() > 1) coder.magnitude(models.gap, at - next);
    next = at + 1;
    const RigidState& base = head.key ? header.objects[update.object].initial : held[update.object];
    TACTUS_TRY(CodedUpdate coded, quantise(update, {base, predict(base, tick, header)}, samples[update.object].pose, contacts));
    code_update(coder, models, header.objects[update.object].dof, coded);
  }
  const std::size_t size = 2 + coder.finish();
  if (coder.overflow() || coder.too_wide()) return fail(Errc::internal, "R-PKT-1");
  sequence = next_sequence;
  return size;
}

RigidEncoder::RigidEncoder(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
RigidEncoder::RigidEncoder(RigidEncoder&&) noexcept = default;
RigidEncoder& RigidEncoder::operator=(RigidEncoder&&) noexcept = default;
RigidEncoder::~RigidEncoder() = default;

Result<RigidEncoder> RigidEncoder::create(StreamHeader header, const RigidEncoderOptions& options) try {
  TACTUS_CHECK(check_header(header));
  if (!are_valid(options.triggers) || !(options.key_interval >= 0 && options.key_interval <= 86400)) {
    return fail(Errc::invalid_argument, "R-API-4");
  }
  auto impl = std::make_unique<Impl>();
  const RigidTriggers& t = impl->triggers = options.triggers;
  TACTUS_TRY(impl->visual, make_thresholds(t.visual_position, t.visual_rotation, header.grid));
  if (t.haptic == HapticRule::fixed) {
    TACTUS_TRY(impl->fixed, make_thresholds(t.fixed_position, t.fixed_rotation, header.grid));
  }
  const auto ticks = [&](double seconds) { return static_cast<std::int64_t>(std::ceil(seconds * header.tick_rate)); };
  if (t.reduction == Reduction::none) impl->visual.level = impl->fixed.level = 0;  // the reference is as exact as the grid
  impl->heartbeat = ticks(t.heartbeat);
  impl->key_interval = ticks(options.key_interval);
  impl->moving = moving_objects(header);
  for (const RigidObject& object : header.objects) impl->held.push_back(object.initial);
  impl->truth = impl->held;
  impl->sequence = static_cast<std::uint16_t>(options.first_sequence - 1);
  impl->pending.reserve(impl->moving.size());
  impl->buffer.resize(max_packet_size(header));
  impl->header = std::move(header);
  return RigidEncoder(std::move(impl));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<EncodedPacket> RigidEncoder::encode(std::int64_t tick, std::span<const RigidSample> samples,
                                           std::span<const Contact> contacts) noexcept {
  Impl& e = *impl_;
  const bool contacts_valid =
      std::all_of(contacts.begin(), contacts.end(), [&](const Contact& c) { return is_valid(c, e.header); });
  if (samples.size() != e.header.objects.size() || tick <= e.last_tick || tick >= 0xffffffff || !contacts_valid) {
    return fail(Errc::invalid_argument, "R-API-5");
  }
  TACTUS_CHECK(e.read_truth(tick, samples));
  PacketHead head;
  head.key = e.key_requested || e.key_tick < 0 || (e.key_interval > 0 && tick - e.key_tick >= e.key_interval) ||
             2 * (tick - e.packet_tick) > forget_ticks(e.header.tick_rate);
  e.collect(tick, samples, contacts, head.key);
  if (e.pending.empty()) {
    e.last_tick = tick;
    return EncodedPacket{};
  }
  head.tick_delta = static_cast<std::uint32_t>(tick - (head.key ? 0 : e.packet_tick));
  TACTUS_TRY(const std::size_t size, e.write(tick, head, samples, contacts));
  Reason strongest = Reason::request;
  for (const Impl::Pending& update : e.pending) {
    e.held[update.object] = update.state;
    strongest = std::max(strongest, update.reason);
  }
  e.last_tick = e.packet_tick = tick;
  if (head.key) e.key_tick = tick;
  e.key_requested = false;
  return EncodedPacket{std::span<const std::uint8_t>(e.buffer).first(size), strongest,
                       static_cast<std::uint32_t>(e.pending.size()), head.key};
}

void RigidEncoder::request_key() noexcept { impl_->key_requested = true; }

const StreamHeader& RigidEncoder::header() const noexcept { return impl_->header; }
std::uint64_t RigidEncoder::state_hash() const noexcept { return tactus::state_hash(impl_->header, impl_->held); }

}  // namespace tactus
