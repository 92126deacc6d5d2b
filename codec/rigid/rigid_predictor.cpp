// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_predictor.h>

#include <algorithm>
#include <optional>

#include <tactus/base/fixed.h>
#include <tactus/rigid/device_path.h>

namespace tactus {

// ==== driven body ====

namespace {

using Vec = std::array<std::int64_t, 3>;
using Rows = std::array<Vec, 3>;

constexpr std::int64_t bit(unsigned n) noexcept { return std::int64_t{1} << n; }
constexpr std::int64_t limited(std::int64_t v, unsigned n) noexcept { return std::clamp(v, -bit(n), bit(n)); }

/// From one exponent to another.
constexpr std::int64_t scaled(std::int64_t v, int from, int to) noexcept {
  return to >= from ? v << (to - from) : round_shift(v, static_cast<unsigned>(from - to));
}

std::int64_t dot(const Vec& a, const Vec& b) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vec cross(const Vec& a, const Vec& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// From the object's frame to the world's.   pre  |v[i]| <= 2^30
Vec turned(const Rows& rows, const Vec& v) noexcept {
  Vec out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = round_shift(dot(rows[i], v), 30);
  return out;
}

/// From the world's frame to the object's.   pre  |v[i]| <= 2^30
Vec turned_back(const Rows& rows, const Vec& v) noexcept {
  Vec out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = round_shift(rows[0][i] * v[0] + rows[1][i] * v[1] + rows[2][i] * v[2], 30);
  return out;
}

Rows rows_of(const Quat30& q) noexcept {
  const auto product = [&q](std::size_t a, std::size_t b) { return static_cast<std::int64_t>(q[a]) * q[b]; };
  const auto entry = [](std::int64_t v) { return limited(round_shift(v, 29), 30); };
  const std::int64_t half = bit(59);
  return {Vec{entry(half - product(2, 2) - product(3, 3)), entry(product(1, 2) - product(0, 3)),
              entry(product(1, 3) + product(0, 2))},
          Vec{entry(product(1, 2) + product(0, 3)), entry(half - product(1, 1) - product(3, 3)),
              entry(product(2, 3) - product(0, 1))},
          Vec{entry(product(1, 3) - product(0, 2)), entry(product(2, 3) + product(0, 1)),
              entry(half - product(1, 1) - product(2, 2))}};
}

std::int64_t length(const Vec& v) noexcept {  // pre  |v[i]| <= 2^31
  return isqrt(static_cast<std::uint64_t>(v[0] * v[0]) + static_cast<std::uint64_t>(v[1] * v[1]) +
               static_cast<std::uint64_t>(v[2] * v[2]));
}

/// length(v) <= limit, without the root.   pre  |v[i]| <= 2^30, limit >= 0
bool is_within(const Vec& v, std::int64_t limit) noexcept { return limit >= bit(31) || dot(v, v) < (limit + 1) * (limit + 1); }

/// A small turn; its half-angle vector x 2^-30.
Quat30 small_turn(const Vec& half) noexcept {
  Quat30 out{kOne30, 0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) out[i + 1] = static_cast<std::int32_t>(limited(half[i], 28));
  return renormalise(renormalise(out));
}

}  // namespace

RigidPose DrivenBody::pose(const Scene& scene, std::uint32_t object, const DevicePath& path, const RigidState& state,
                           std::int64_t tick) noexcept {
  tick = std::min<std::int64_t>(tick, state.tick + scene.max_extrapolation);
  if (tick < tick_ || tick_ < from_.tick || from_ != state || revision_ != path.revision()) {
    revision_ = path.revision();
    start(scene, object, state);
  }
  for (; tick_ < tick; ++tick_) step(scene, object, path);
  return shown(scene, object);
}

void DrivenBody::start(const Scene& scene, std::uint32_t object, const RigidState& state) noexcept {
  const DrivenConstants::Body& body = scene.driven->bodies[object];
  from_ = state;
  tick_ = state.tick;
  is_touching_ = true;
  rotation_ = state.rotation;
  for (std::size_t i = 0; i < 3; ++i) {
    position_[i] = static_cast<std::int64_t>(state.position[i]) << (32 - scene.grid.position);
    point_[i] = limited(static_cast<std::int64_t>(state.contact.point[i]) << (28 - DrivenContact::kPoint), 28);
    normal_[i] = limited(static_cast<std::int64_t>(state.contact.normal[i]) << (30 - DrivenContact::kNormal), 30);
    gravity_[i] = scene.motion ? limited(scaled(scene.motion->gravity[i], scene.grid.velocity, 16), 30) : 0;
    velocity_[i] = limited(scaled(state.velocity[i], scene.grid.velocity, 27), 30);
    angular_[i] = limited(scaled(state.angular_velocity[i], scene.grid.angular_velocity, 22), 30);
  }
  const std::int64_t weight = length(gravity_), thickness = length(normal_);
  for (std::size_t i = 0; i < 3; ++i) {
    down_[i] = weight > 0 ? round_div(gravity_[i] << 30, weight) : 0;
    normal_[i] = thickness > 0 ? round_div(normal_[i] << 30, thickness) : 0;
  }
  if (!state.contact.is_held) start_screw(scene, body);
}

/// The screw of the velocities, as one velocity of 1 m/s in the mean over the object's mass.
void DrivenBody::start_screw(const Scene& scene, const DrivenConstants::Body& body) noexcept {
  const Rows rows = rows_of(rotation_);
  const Vec velocity = turned_back(rows, velocity_), angular = turned_back(rows, angular_);
  Vec rim{};  // of the turn
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t radius = isqrt(static_cast<std::uint64_t>(body.inertia[i]) << 30);  // x 2^-30 m
    rim[i] = limited(round_shift(radius * angular[i], 25), 30);
  }
  const std::int64_t speed =
      isqrt(static_cast<std::uint64_t>(dot(velocity, velocity)) + static_cast<std::uint64_t>(dot(rim, rim)));
  speed_ = speed < bit(10) ? 0 : speed;
  if (speed_ == 0) return;
  for (std::size_t i = 0; i < 3; ++i) {
    along_[i] = limited(round_div(velocity[i] << 24, speed), 24);
    about_[i] = limited(round_div(angular[i] << 24, speed), 30);
  }
  const std::int64_t weight = length(gravity_);
  const Vec direction = turned(rows, along_);
  const std::int64_t fall = round_shift(dot(direction, down_), 30);
  Vec level;
  for (std::size_t i = 0; i < 3; ++i) level[i] = direction[i] - round_shift(fall * down_[i], 30);
  rub_ = 0;
  if (weight > 0) {
    const std::int64_t slide = limited(scaled(scene.motion->slide_deceleration, scene.grid.velocity, 16), 30);
    rub_ = limited(round_div(length(level) * slide, weight), 30);
  }
  first_load_ = -1;  // known at the first step
}

/// The proxy follows the device on its face; it slides where the push leaves the cone of friction.
void DrivenBody::slide(const DrivenConstants::Body& body, const Vec& device) noexcept {
  Vec gap;
  for (std::size_t i = 0; i < 3; ++i) gap[i] = point_[i] - device[i];
  const std::int64_t depth = round_shift(dot(gap, normal_), 30);
  if (depth <= 0) {
    is_touching_ = false;
    return;
  }
  Vec foot, lag;
  for (std::size_t i = 0; i < 3; ++i) {
    foot[i] = device[i] + round_shift(depth * normal_[i], 30);
    lag[i] = limited(point_[i] - foot[i], 30);
  }
  const std::int64_t rim = round_shift(body.friction * depth, 8);
  if (is_within(lag, rim)) return;
  const std::int64_t far = length(lag);
  for (std::size_t i = 0; i < 3; ++i) point_[i] = limited(foot[i] + round_div(lag[i] * rim, far), 28);
}

/// Acceleration of the object by the spring of the device, object frame [2^-16 m/s^2].
Vec DrivenBody::pull(const Scene& scene, const DrivenConstants::Body& body, const DevicePath& path, const Rows& rows) noexcept {
  const std::optional<Vec3i> at = is_touching_ ? path.at(tick_) : std::nullopt;
  if (!at) {
    is_touching_ = false;
    return {};
  }
  Vec device;
  for (std::size_t i = 0; i < 3; ++i) {
    device[i] = round_shift((static_cast<std::int64_t>((*at)[i]) << (32 - scene.grid.position)) - position_[i], 4);
    if (device[i] < -bit(28) || device[i] > bit(28)) is_touching_ = false;
  }
  if (!is_touching_) return {};
  device = turned_back(rows, device);
  if (!from_.contact.is_held) slide(body, device);
  if (!is_touching_) return {};
  const std::int64_t coupling = from_.contact.is_held ? body.hold : body.coupling;
  Vec out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = limited(round_shift(coupling * (device[i] - point_[i]), 20), 30);
  return out;
}

void DrivenBody::hold(const Scene& scene, const DrivenConstants::Body& body, const Rows& rows, const Vec& pull) noexcept {
  const std::int64_t rate = scene.tick_rate, damping = body.damping;
  const Vec acceleration = turned(rows, pull), moment = cross(point_, pull);
  Vec spin;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t angular = round_div(limited(round_shift(moment[i], 16), 37) << 24, body.inertia[i]);
    spin[i] = limited(round_div(angular, rate), 30);
  }
  spin = turned(rows, spin);
  Vec half;
  for (std::size_t i = 0; i < 3; ++i) {
    velocity_[i] = limited(velocity_[i] + round_div((acceleration[i] + gravity_[i]) << 11, rate), 33);
    angular_[i] = limited(angular_[i] + spin[i], 33);
    position_[i] = limited(position_[i] + round_div(velocity_[i] << 5, rate), 58);
    half[i] = round_div(angular_[i] << 7, rate);
    velocity_[i] -= round_shift(velocity_[i] * damping, 20);
    angular_[i] -= round_shift(angular_[i] * damping, 20);
  }
  rotation_ = renormalise(multiply(small_turn(half), rotation_));
}

/// What the ground supports of the object, over its mass [2^-16 m/s^2].   in  pull  world frame
std::int64_t DrivenBody::load(const Vec& pull) const noexcept {
  Vec sum;
  for (std::size_t i = 0; i < 3; ++i) sum[i] = limited(pull[i] + gravity_[i], 30);
  return std::max<std::int64_t>(0, round_shift(dot(sum, down_), 30));
}

void DrivenBody::push(const Scene& scene, const DrivenConstants::Body& body, const Rows& rows, const Vec& pull) noexcept {
  if (speed_ == 0) return;
  const Vec acceleration = turned(rows, pull), direction = turned(rows, along_), lever = cross(about_, point_);
  const std::int64_t loaded = load(acceleration);
  if (first_load_ < 0) first_load_ = loaded;
  Vec driven;  // motion of the point at speed 1
  for (std::size_t i = 0; i < 3; ++i) driven[i] = limited(along_[i] + round_shift(lever[i], 23), 30);
  const std::int64_t drive = round_shift(dot(pull, driven) + dot(gravity_, direction), 24);
  const std::int64_t drag =
      (std::int64_t{from_.contact.drag} << (16 - DrivenContact::kDrag)) + round_shift(rub_ * (loaded - first_load_), 24);
  const std::int64_t rate = scene.tick_rate;
  speed_ = std::clamp<std::int64_t>(speed_ + round_div((drive - drag) << 11, rate), 1, bit(33));
  const std::int64_t step = std::min(round_div(speed_ << 5, rate), bit(31));
  Vec half;
  for (std::size_t i = 0; i < 3; ++i) {
    position_[i] = limited(position_[i] + round_shift(step * direction[i], 24), 58);
    half[i] = round_shift(step * about_[i], 22);
  }
  rotation_ = renormalise(multiply(rotation_, small_turn(half)));
  speed_ -= round_shift(speed_ * body.damping, 20);
}

void DrivenBody::step(const Scene& scene, std::uint32_t object, const DevicePath& path) noexcept {
  const DrivenConstants::Body& body = scene.driven->bodies[object];
  const Rows rows = rows_of(rotation_);
  const Vec pulled = pull(scene, body, path, rows);
  if (from_.contact.is_held) hold(scene, body, rows, pulled);
  else push(scene, body, rows, pulled);
}

/// Axes that are locked stay where they were.
RigidPose DrivenBody::shown(const Scene& scene, std::uint32_t object) const noexcept {
  const std::uint8_t dof = scene.objects[object].dof;
  RigidPose out{from_.position, from_.rotation};
  for (std::size_t i = 0; i < 3; ++i)
    if (dof >> i & 1u) out.position[i] = saturate32(round_shift(position_[i], 32u - scene.grid.position));
  if (dof >> 3 != 0) out.rotation = rotation_;
  return out;
}

// ==== rigid predictor ====

bool has_predictors(const Scene& scene) noexcept { return scene.motion || scene.driven; }

bool is_declared(const Scene& scene, std::uint32_t object, Predictor predictor) noexcept {
  switch (predictor) {
    case Predictor::linear:
      return true;
    case Predictor::ballistic:
      return scene.motion && !is_zero(scene.motion->gravity);
    case Predictor::slide:
      return scene.motion && scene.motion->slide_deceleration != 0;
    case Predictor::driven:
      return scene.driven && scene.driven->bodies[object].coupling != 0;
  }
  return false;
}

bool is_free_to(const Scene& scene, std::uint32_t object, Predictor predictor) noexcept {
  if (!is_declared(scene, object, predictor)) return false;
  if (predictor != Predictor::ballistic) return true;
  for (std::size_t i = 0; i < 3; ++i)
    if (scene.motion->gravity[i] != 0 && !(scene.objects[object].dof >> i & 1u)) return false;
  return true;
}

namespace {

constexpr std::int64_t kWhole = 1 << 15;

/// in   fraction  x 2^-15
std::int64_t part_of(std::int64_t whole, std::int64_t fraction) noexcept {
  return fraction == kWhole ? whole : round_shift(whole * fraction, 15);
}

/// Half the angle turned in `dt` ticks, 2^32 to the full circle, and the axis. spec 40-rigid 4
struct Turn {
  Vec3i axis{};
  std::uint32_t half = 0;
};

/// in   fraction  of dt that is turned through, x 2^-15
Turn turn_of(const Vec3i& angular_velocity, std::int64_t dt, std::int64_t fraction, std::uint32_t tick_rate,
             unsigned exponent) noexcept {
  std::int64_t square = 0;
  for (const std::int32_t c : angular_velocity) square += static_cast<std::int64_t>(c) * c;
  const std::int64_t speed = isqrt(static_cast<std::uint64_t>(square) << 10);  // x 2^-(exponent + 5) rad/s
  if (speed == 0) return {};
  constexpr std::uint64_t kTurnPerHalfRadian = 341782638;  // 2^32 / (4 pi)
  const auto angle = static_cast<std::uint64_t>(part_of(round_div(speed * dt, tick_rate), fraction));
  Turn turn;
  turn.half = static_cast<std::uint32_t>((angle * kTurnPerHalfRadian + (std::uint64_t{1} << (exponent + 4))) >> (exponent + 5));
  for (std::size_t i = 0; i < 3; ++i) {
    turn.axis[i] = static_cast<std::int32_t>(round_div(static_cast<std::int64_t>(angular_velocity[i]) << 35, speed));
  }
  return turn;
}

/// How long an object slides until it rests [2^-8 ticks].
std::int64_t slide_time(const Vec3i& velocity, std::uint32_t tick_rate, std::int32_t deceleration) noexcept {
  std::uint64_t square = 0;
  for (const std::int32_t c : velocity) square += static_cast<std::uint64_t>(static_cast<std::int64_t>(c) * c);
  return round_div((static_cast<std::int64_t>(isqrt(square)) * tick_rate) << 8, deceleration);
}

/// The tick in which a sliding object comes to rest.
std::int64_t last_tick(std::int64_t rest) noexcept { return (rest + 255) >> 8; }

/// Fraction of the distance at constant velocity that is left of it after `dt` ticks of sliding, x 2^-15.   pre  0 < dt <= last_tick(rest)
std::int64_t slide_fraction(std::int64_t dt, std::int64_t rest) noexcept {
  const std::int64_t t = dt << 8;
  return t <= rest ? kWhole - round_div(t << 14, rest) : round_div(rest << 14, t);
}

}  // namespace

std::int64_t RigidPredictor::gained(std::size_t axis, std::int64_t dt) const noexcept {
  return saturate32(round_div(scene_.motion->gravity[axis] * dt, scene_.tick_rate));
}

void RigidPredictor::fall(std::int64_t dt, RigidPose& pose) const noexcept {
  const unsigned shift = static_cast<unsigned>(scene_.grid.position - scene_.grid.velocity);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t fallen = round_div((gained(i, dt) * dt) << shift, 2 * std::int64_t{scene_.tick_rate});
    pose.position[i] = saturate32(pose.position[i] + fallen);
  }
}

RigidPose RigidPredictor::pose(const RigidState& state, std::int64_t tick) const noexcept {
  std::int64_t dt = std::min<std::int64_t>(tick - state.tick, scene_.max_extrapolation);
  std::int64_t fraction = kWhole;  // of dt
  RigidPose pose{state.position, state.rotation};
  if (state.predictor == Predictor::slide && dt > 0) {
    const std::int64_t rest = slide_time(state.velocity, scene_.tick_rate, scene_.motion->slide_deceleration);
    dt = std::min(dt, last_tick(rest));  // so that it rests to the bit
    if (dt > 0) fraction = slide_fraction(dt, rest);
  }
  if (dt == 0) return pose;
  constexpr std::int64_t kFar = std::int64_t{1} << 33;  // half of it is beyond every position
  const unsigned shift = static_cast<unsigned>(scene_.grid.position - scene_.grid.velocity);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t moved = std::clamp(round_div((state.velocity[i] * dt) << shift, scene_.tick_rate), -kFar, kFar);
    pose.position[i] = saturate32(state.position[i] + part_of(moved, fraction));
  }
  if (state.predictor == Predictor::ballistic) fall(dt, pose);
  const Turn turn = turn_of(state.angular_velocity, dt, fraction, scene_.tick_rate, scene_.grid.angular_velocity);
  if (turn.half != 0) pose.rotation = renormalise(multiply(axis_turn(turn.axis, turn.half), state.rotation));
  return pose;
}

RigidPredictor::RigidPredictor(const Scene& scene, const DevicePath* device)
    : scene_(scene), path_(scene.driven ? device : nullptr), bodies_(path_ != nullptr ? scene.objects.size() : 0) {}

RigidPose RigidPredictor::shown(std::uint32_t object, const RigidState& state, std::int64_t tick) const noexcept {
  if (state.predictor != Predictor::driven || path_ == nullptr) return pose(state, tick);
  return bodies_[object].pose(scene_, object, *path_, state, tick);
}

bool RigidPredictor::is_at_rest(const RigidState& state, std::int64_t tick) const noexcept {
  if (state.predictor == Predictor::driven) return false;
  if (tick - state.tick >= scene_.max_extrapolation) return true;
  if (state.predictor == Predictor::ballistic) return false;
  if (state.velocity == Vec3i{} && state.angular_velocity == Vec3i{}) return true;
  if (state.predictor != Predictor::slide) return false;
  const RigidPose now = pose(state, tick), end = pose(state, state.tick + scene_.max_extrapolation);
  return now.position == end.position && now.rotation == end.rotation;
}

RigidMotion RigidPredictor::free_motion(const RigidState& state, std::int64_t dt) const noexcept {
  RigidMotion out{state.velocity, state.angular_velocity};
  if (state.predictor == Predictor::ballistic) {
    for (std::size_t i = 0; i < 3; ++i) out.velocity[i] = saturate32(state.velocity[i] + gained(i, dt));
  }
  if (state.predictor == Predictor::slide) {
    const std::int64_t rest = slide_time(state.velocity, scene_.tick_rate, scene_.motion->slide_deceleration);
    const std::int64_t left = (dt << 8) < rest ? kWhole - round_div(dt << 23, rest) : 0;
    for (std::size_t i = 0; i < 3; ++i) {
      out.velocity[i] = static_cast<std::int32_t>(round_shift(state.velocity[i] * left, 15));
      out.angular_velocity[i] = static_cast<std::int32_t>(round_shift(state.angular_velocity[i] * left, 15));
    }
  }
  return out;
}

RigidMotion RigidPredictor::motion(const RigidState& state, std::int64_t tick, const PoseError& error) const noexcept {
  const std::int64_t dt = tick - state.tick;
  if (dt == 0) return {state.velocity, state.angular_velocity};
  RigidMotion out = free_motion(state, std::min<std::int64_t>(dt, scene_.max_extrapolation));
  const std::int64_t moved = (2 * dt) << (scene_.grid.position - scene_.grid.velocity);
  const std::int64_t turned = dt << (scene_.grid.rotation - scene_.grid.angular_velocity);  // the error is a quarter of the angle
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t x = error.position[i], r = error.rotation[i];
    if (x != 0) out.velocity[i] = saturate32(out.velocity[i] + round_div(3 * x * scene_.tick_rate, moved));
    if (r != 0) out.angular_velocity[i] = saturate32(out.angular_velocity[i] + round_div(6 * r * scene_.tick_rate, turned));
  }
  return out;
}

}  // namespace tactus
