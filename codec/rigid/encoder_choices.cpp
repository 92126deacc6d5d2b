// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/rigid/encoder_choices.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <tactus/base/fixed.h>
#include <tactus/rigid/device_path.h>
#include <tactus/rigid/rigid_syntax.h>

namespace tactus {

// ==== contacts ====

RuleName broken_rule(const Contact& c, const Scene& scene) noexcept {
  if (c.kind == ContactKind::none) return {};
  if (!is_finite(c.point) || !is_finite(c.normal) || !is_finite(c.device) || !is_finite(c.stiffness)) return "R-API-1";
  const bool is_unit = c.kind == ContactKind::spring || std::abs(norm(c.normal) - 1) <= 1e-6;
  if (c.kind > ContactKind::spring || c.object >= scene.objects.size() || !is_unit || !(c.stiffness > 0)) return "R-API-15";
  return {};
}

bool Contacts::Filter::counts(const Contact& contact) const noexcept {
  return !broken_rule(contact, *scene) && (contact.kind == ContactKind::none || !held->has(TruthPart::object, contact.object));
}

// ==== acceleration ====

namespace {

constexpr double kLongest = 0.01;  // [s] of two differences: older ones say nothing of now

/// The smaller of two numbers of one sign; else 0.
double agreed(double a, double b) noexcept {
  if (a * b <= 0) return 0;
  return std::abs(a) < std::abs(b) ? a : b;
}

Vec3 agreed(const Vec3& a, const Vec3& b) noexcept { return {agreed(a.x, b.x), agreed(a.y, b.y), agreed(a.z, b.z)}; }

}  // namespace

double Acceleration::departure(double seconds) noexcept {
  return kFade * (seconds - kFade * (1 - exponential(-seconds / kFade)));
}

Acceleration::Acceleration(const Scene& scene) : scene_(scene) {
  ticks_.fill(std::numeric_limits<std::int64_t>::min() / 4);
  for (auto& motions : motions_) motions.resize(scene.objects.size());
}

void Acceleration::read(std::int64_t tick, std::span<const RigidSample> samples,
                        std::span<const std::uint32_t> objects) noexcept {
  std::rotate(ticks_.begin(), ticks_.end() - 1, ticks_.end());
  std::rotate(motions_.begin(), motions_.end() - 1, motions_.end());
  ticks_[0] = tick;
  for (const std::uint32_t i : objects) motions_[0][i] = {samples[i].velocity, samples[i].angular_velocity};
}

double Acceleration::seconds(std::size_t from, std::size_t to) const noexcept {
  return static_cast<double>(ticks_[to] - ticks_[from]) / scene_.tick_rate;
}

Acceleration::Motion Acceleration::of(std::uint32_t object) const noexcept {
  if (seconds(2, 0) > kLongest) return {};
  const Motion &a = motions_[2][object], &b = motions_[1][object], &c = motions_[0][object];
  const double before = 1 / seconds(2, 1), now = 1 / seconds(1, 0);
  return {agreed(before * (b.linear - a.linear), now * (c.linear - b.linear)),
          agreed(before * (b.angular - a.angular), now * (c.angular - b.angular))};
}

// ==== force trend ====

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

}  // namespace

ForceTrend::ForceTrend(const Scene& scene) : scene_(scene) {
  for (auto& forces : forces_) forces.assign(scene.objects.size(), kNone);
  for (auto& touched : touched_) touched.reserve(scene.objects.size());
}

void ForceTrend::read(std::int64_t tick, std::span<const RigidSample> samples, const Contacts& contacts) noexcept {
  std::rotate(ticks_.begin(), ticks_.end() - 1, ticks_.end());
  std::rotate(forces_.begin(), forces_.end() - 1, forces_.end());
  std::rotate(touched_.begin(), touched_.end() - 1, touched_.end());
  ticks_[0] = tick;
  for (const std::uint32_t i : touched_[0]) forces_[0][i] = kNone;
  touched_[0].clear();
  for (const Contact& contact : contacts) {
    if (contact.kind == ContactKind::none) continue;
    double& least = forces_[0][contact.object];
    const double force = norm(contact_force(contact, samples[contact.object].pose));
    if (least == kNone && force < kNone) touched_[0].push_back(contact.object);
    least = std::min(least, force);
  }
}

double ForceTrend::relative_decay_rate(std::uint32_t object) const noexcept {
  const double now = forces_[0][object], before = forces_[2][object];
  const double seconds = static_cast<double>(ticks_[0] - ticks_[2]) / scene_.tick_rate;
  if (!(now > 0 && now < before && before < kNone) || seconds > kLongest) return 0;
  return (before - now) / (now * seconds);
}

// ==== error ratio ====

ErrorRatio::ErrorRatio(std::uint32_t object, const Pose& truth, const Contacts& contacts, const RigidTriggers& triggers,
                       double decay_rate) noexcept
    : per_metre_(1 / triggers.visual_position), per_radian_(1 / triggers.visual_rotation), decay_rate_(decay_rate) {
  if (triggers.haptic == HapticRule::off) return;
  for (const Contact& contact : contacts) {
    if (contact.kind == ContactKind::none || contact.object != object) continue;
    if (triggers.haptic == HapticRule::fixed) {
      per_metre_ = std::max(per_metre_, 1 / triggers.fixed_position);
      per_radian_ = std::max(per_radian_, 1 / triggers.fixed_rotation);
      return;
    }
    if (count_ == kMostContacts) return;
    const bool is_spring = contact.kind == ContactKind::spring;
    const double force = norm(contact_force(contact, truth)), budget = force_budget(triggers, force);
    const bool is_cone = triggers.haptic == HapticRule::cone;
    touches_[count_++] = {
        rotate(truth.rotation, contact.point),   is_spring ? Vec3{} : rotate(truth.rotation, contact.normal),
        is_cone ? 0 : force / contact.stiffness, contact.stiffness / budget,
        force_budget(triggers, 0) / budget,      is_cone && force >= triggers.force_floor ? 1 / triggers.cone_angle : 0};
  }
}

double ErrorRatio::operator()(const Vec3& moved, const Vec3& turned, double later) const noexcept {
  double out = std::max(per_metre_ * norm(moved), per_radian_ * norm(turned));
  for (std::size_t i = 0; i < count_; ++i) {
    const Touch& touch = touches_[i];
    const Vec3 at_point = moved + cross(turned, touch.lever);
    const Vec3 effective = touch.normal == Vec3{}
                               ? at_point
                               : dot(at_point, touch.normal) * touch.normal + touch.depth * cross(turned, touch.normal);
    const double left = std::max(touch.least, 1 - decay_rate_ * later);
    out = std::max({out, touch.per_metre / left * norm(effective), touch.per_radian * norm(turned)});
  }
  return out;
}

// ==== look-ahead velocity ====

namespace {

constexpr double kTau = Acceleration::kFade;
constexpr double kMargin =
    0.6;  // fraction of a bound; the rest is for the error at the update and for what the truth really does

/// [s] s of B [s^2].
double lead(double ratio) noexcept {
  const double y = std::sqrt(std::min(2 * ratio, 2 * kTau * kTau)) / kTau;
  return kTau * std::min(y - y * y / 6, 1.0);
}

}  // namespace

Acceleration::Motion look_ahead_velocity(const Acceleration::Motion& acceleration, const ErrorRatio& ratio) noexcept {
  const double per_second_squared = ratio(acceleration.linear, acceleration.angular);
  if (per_second_squared == 0) return {};
  const double s = lead(kMargin / per_second_squared);
  return {s * acceleration.linear, s * acceleration.angular};
}

// ==== smoothing choice ====

namespace {

constexpr double kInside = 0.7;  // fraction of the bounds at the end, 1 at the begin: the truth will not do exactly what is taken
constexpr std::array kParts{0.25, 0.5, 0.75, 1.0};

bool stays_inside(const ErrorTrajectory& c, const ErrorRatio& ratio, double duration) noexcept {
  for (const double part : kParts) {
    const double t = part * duration, left = 1 - part, gone = Acceleration::departure(t);
    const Vec3 moved = left * c.offset.moved + c.error.moved + t * c.drift.linear - gone * c.acceleration.linear;
    const Vec3 turned = left * c.offset.turned + c.error.turned + t * c.drift.angular - gone * c.acceleration.angular;
    if (!(ratio(moved, turned, t) <= 1 - (1 - kInside) * part)) return false;
  }
  return true;
}

}  // namespace

std::uint8_t longest_smoothing_exp(const ErrorTrajectory& trajectory, const ErrorRatio& ratio, std::uint32_t tick_rate) noexcept {
  for (int smoothing_exp = usual_smoothing_exp(tick_rate); smoothing_exp > 0; --smoothing_exp)
    if (stays_inside(trajectory, ratio, static_cast<double>(1u << smoothing_exp) / tick_rate))
      return static_cast<std::uint8_t>(smoothing_exp);
  return 0;
}

// ==== driven choice ====

namespace {

constexpr double kSlowest = 1e-4;  // [m/s]: a slower object has no direction that would last

Vec3i on_grid(const Vec3& v, int exponent) noexcept {
  const auto units = [exponent](double c) {
    return static_cast<std::int32_t>(std::lround(std::clamp(std::ldexp(c, exponent), -1048576.0, 1048576.0)));
  };
  return {units(v.x), units(v.y), units(v.z)};
}

Vec3 off_grid(const Vec3i& v, int exponent) noexcept {
  return std::ldexp(1.0, -exponent) * Vec3{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

Vec3 inertia_of(const DrivenConstants::Body& body) noexcept {
  return {std::ldexp(body.inertia[0], -30), std::ldexp(body.inertia[1], -30), std::ldexp(body.inertia[2], -30)};
}

Vec3 times(const Vec3& a, const Vec3& b) noexcept { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

}  // namespace

DrivenChoice::DrivenChoice(const Scene& scene, const DevicePath& path)
    : scene_(scene), path_(path), moments_((kWindow + 1) * scene.objects.size()) {
  if (scene.motion) gravity_ = off_grid(scene.motion->gravity, static_cast<int>(scene.grid.velocity));
}

/// The contact whose device is where the path is; null: there is none.
const Contact* DrivenChoice::own_contact(std::uint32_t object, const Contacts& contacts, const Vec3i& device) const noexcept {
  const auto exponent = static_cast<int>(scene_.grid.position);
  const Vec3 at = off_grid(device, exponent);
  for (const Contact& contact : contacts)
    if (contact.kind != ContactKind::none && contact.object == object && norm(contact.device - at) <= std::ldexp(2.0, -exponent))
      return &contact;
  return nullptr;
}

/// Deceleration along the screw that neither the device nor gravity explains [m/s^2].
/// pre  the moments of the window are there.   in  rounding  what the pull of a receiver has over the true one [m/s^2], world frame
double DrivenChoice::drag_of(std::uint32_t object, const RigidSample& now, const Vec3& rounding) const noexcept {
  const std::span<const Moment> moments = std::span(moments_).subspan((kWindow + 1) * object, kWindow + 1);
  const auto [first, last] = std::ranges::minmax_element(moments, {}, &Moment::tick);
  const Vec3 inertia = inertia_of(scene_.driven->bodies[object]);
  const double speed = std::sqrt(dot(last->velocity, last->velocity) + dot(times(inertia, last->angular), last->angular));
  if (speed < kSlowest) return 0;
  const auto along = [&now](const Vec3& pull, const Vec3& arm) {
    return dot(pull, now.velocity + cross(now.angular_velocity, arm));
  };
  double drive = along(rounding, last->arm);
  for (const Moment& moment : moments) {
    if (&moment == &*last) continue;
    drive += along(moment.pull, moment.arm) / kWindow;
  }
  const double gained =
      dot(last->velocity - first->velocity, last->velocity) + dot(times(inertia, last->angular - first->angular), last->angular);
  const double rate = static_cast<double>(scene_.tick_rate);
  const double damping = std::ldexp(scene_.driven->bodies[object].damping, -20) * rate * speed;
  return (drive + dot(gravity_, now.velocity) - gained * rate / kWindow) / speed - damping;
}

void DrivenChoice::read(std::int64_t tick, std::span<const RigidSample> samples, const Contacts& contacts,
                        std::span<DrivenContact> signalled) noexcept {
  const auto device = path_.at(tick);
  for (const std::uint32_t i : scene_.moving()) {
    signalled[i] = {};
    const DrivenConstants::Body& body = scene_.driven->bodies[i];
    const Contact* const contact = device && body.coupling != 0 ? own_contact(i, contacts, *device) : nullptr;
    Moment& moment = moments_[(kWindow + 1) * i + static_cast<std::size_t>(tick) % (kWindow + 1)];
    moment.tick = -1;
    if (contact == nullptr || (contact->kind == ContactKind::spring && body.hold == 0)) continue;
    const RigidSample& sample = samples[i];
    const Vec3 gap = contact->device - to_world(sample.pose, contact->point);
    moment = {.tick = tick,
              .velocity = sample.velocity,
              .angular = rotate(conjugate(sample.pose.rotation), sample.angular_velocity),
              .pull = std::ldexp(body.coupling, -8) * gap,
              .arm = rotate(sample.pose.rotation, contact->point)};
    DrivenContact out{.is_held = contact->kind == ContactKind::spring, .point = on_grid(contact->point, DrivenContact::kPoint)};
    if (!out.is_held) {
      const auto window = std::span(moments_).subspan((kWindow + 1) * i, kWindow + 1);
      const std::int64_t first = std::max<std::int64_t>(0, tick - static_cast<std::int64_t>(kWindow));
      const bool whole = std::ranges::all_of(window, [first](const Moment& m) { return m.tick >= first; });
      if (!whole) continue;
      out.normal = on_grid(contact->normal, DrivenContact::kNormal);
      const Vec3 off = contact->point - off_grid(out.point, DrivenContact::kPoint);
      const Vec3 rounding = std::ldexp(body.coupling, -8) * rotate(sample.pose.rotation, off);
      out.drag = on_grid({drag_of(i, sample, rounding), 0, 0}, DrivenContact::kDrag)[0];
    }
    signalled[i] = out;
  }
}

// ==== predictor choice ====

namespace {

constexpr double kSpacing = 0.005, kLongestTime = 0.15;  // [s]

/// Over what is permitted: 1 at the bound.
double error(const RigidPose& shown, const RigidState& truth, const PermittedError& permitted, unsigned exponent) noexcept {
  double distance = 0, half = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double d = static_cast<double>(truth.position[i]) - shown.position[i];
    distance += d * d;
  }
  const Quat30 turn = multiply(truth.rotation, conjugate(shown.rotation));
  for (std::size_t i = 1; i < 4; ++i) half += static_cast<double>(turn[i]) * turn[i];
  return std::max(std::ldexp(std::sqrt(distance), -static_cast<int>(exponent)) / permitted.position,
                  std::sqrt(half) * 0x1p-29 / permitted.rotation);
}

}  // namespace

PastStates::PastStates(const Scene& scene)
    : spacing_(static_cast<std::int64_t>(std::ceil(kSpacing * scene.tick_rate))),
      longest_(static_cast<std::int64_t>(std::floor(kLongestTime * scene.tick_rate))),
      states_(kKept * scene.objects.size()),
      alike_(scene.objects.size(), 0),
      unsettled_(scene.moving().begin(), scene.moving().end()) {}

void PastStates::read(std::int64_t tick, std::span<const RigidState> truth, std::span<const std::uint32_t> moved,
                      std::span<const DrivenContact> signalled) noexcept {
  for (const std::uint32_t i : moved)
    if (std::exchange(alike_[i], std::uint8_t{0}) == kKept) unsettled_.push_back(i);
  if (count_ > 0 && tick - ticks_[newest_] < spacing_) return;
  newest_ = (newest_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
  ticks_[newest_] = tick;
  std::erase_if(unsettled_, [&](std::uint32_t i) {
    RigidState& kept = states_[i * kKept + newest_];
    kept = truth[i];
    if (!signalled.empty()) kept.contact = signalled[i];
    return ++alike_[i] == kKept;
  });
}

std::optional<RigidState> PastStates::start(std::uint32_t object, std::int64_t now, std::size_t n) const noexcept {
  constexpr std::array<std::size_t, 8> kAges{0, 1, 2, 4, 7, 11, 17, 26};
  const auto slot = [&](std::size_t age) { return (newest_ + kKept - age) % kKept; };
  if (count_ > 0 && ticks_[slot(0)] == now) ++n;
  if (n >= kAges.size() || kAges[n] >= count_) return std::nullopt;
  const std::size_t at = slot(kAges[n]);
  if (now - ticks_[at] > longest_) return std::nullopt;
  RigidState out = states_[object * kKept + at];
  out.tick = ticks_[at];
  return out;
}

double PredictorChoice::error_of(Predictor predictor, std::uint32_t object, RigidState from, const RigidState& truth,
                                 const PermittedError& permitted) const noexcept {
  from.predictor = predictor;
  return error(predictor_.shown(object, from, truth.tick), truth, permitted, scene_.grid.position);
}

PredictorChoice::Record PredictorChoice::record_of(Predictor predictor, std::uint32_t object, const RigidState& truth,
                                                   const PermittedError& permitted) const noexcept {
  Record out;
  while (const auto from = past_.start(object, truth.tick, out.served)) {
    const double e = error_of(predictor, object, *from, truth, permitted);
    if (e > 1) break;
    out.error += e;
    ++out.served;
  }
  return out;
}

bool PredictorChoice::drives_on(std::uint32_t object, const RigidState& truth, const PermittedError& permitted,
                                const RigidState& current) const noexcept {
  if (current.predictor != Predictor::driven) return false;
  std::size_t n = 0;
  auto from = past_.start(object, truth.tick, n);
  while (from && from->tick > current.tick) from = past_.start(object, truth.tick, ++n);
  return from && error_of(Predictor::linear, object, *from, truth, permitted) > 1;
}

bool PredictorChoice::is_driven(std::uint32_t object, const RigidState& truth, const PermittedError& permitted, Predictor other,
                                std::size_t served) const noexcept {
  for (std::size_t n = served + 1; n-- > 0;) {
    const auto from = past_.start(object, truth.tick, n);
    if (!from || from->contact == DrivenContact{}) continue;
    return error_of(Predictor::driven, object, *from, truth, permitted) < error_of(other, object, *from, truth, permitted);
  }
  return false;
}

Predictor PredictorChoice::choose(std::uint32_t object, const RigidState& truth, const PermittedError& permitted, bool is_touched,
                                  const RigidState& current) const noexcept {
  const bool may_be_driven = predictor_.has_device_path() && truth.contact != DrivenContact{};
  Predictor best = Predictor::linear;
  if (is_touched && !may_be_driven) return best;
  if (may_be_driven && drives_on(object, truth, permitted, current)) return Predictor::driven;
  Record most = record_of(best, object, truth, permitted);
  for (const Predictor predictor : kFreePredictors) {
    if (is_touched || !is_free_to(scene_, object, predictor)) continue;
    const Record record = record_of(predictor, object, truth, permitted);
    if (record.served < most.served || (record.served == most.served && record.error >= most.error)) continue;
    best = predictor;
    most = record;
  }
  return may_be_driven && is_driven(object, truth, permitted, best, most.served) ? Predictor::driven : best;
}

}  // namespace tactus
