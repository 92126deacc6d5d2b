// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/sim/prediction/prediction.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

namespace tactus::sim {

// ==== past shapes ====

namespace {

std::int32_t in_steps(float metres) noexcept {
  constexpr float kSteps = 1U << PastShapes::kExp;
  return static_cast<std::int32_t>(std::lround(std::clamp(kSteps * metres, -1e9F, 1e9F)));
}

}  // namespace

PastShapes::PastShapes(std::size_t vertices, double ticks, double period)
    : size_(3 * vertices),
      period_(period),
      ticks_(static_cast<std::size_t>(std::ceil(ticks / period)) + 2, INT64_MIN / 2),
      shapes_(size_ * ticks_.size()),
      offset_(size_),
      heard_(size_),
      shown_(vertices) {}

void PastShapes::add(std::int64_t tick, std::span<const float> displacements) noexcept {
  next_ = (next_ + 1) % ticks_.size();
  ticks_[next_] = tick;
  std::ranges::copy(displacements, shapes_.begin() + static_cast<std::ptrdiff_t>(next_ * size_));
}

void PastShapes::hear(std::span<const Displacement> displacements, unsigned position_exp, double age) noexcept {
  const auto metres = static_cast<float>(std::ldexp(1.0, -static_cast<int>(position_exp)));
  for (std::size_t i = 0; i < size_; ++i) heard_[i] = metres * static_cast<float>(displacements[i / 3][i % 3]);
  age_ = age;
}

void PastShapes::compare(double tick, double fraction) noexcept {
  std::size_t before = 0;
  while (before + 1 < ticks_.size() && static_cast<double>(tick_back(before)) > tick) ++before;
  const std::size_t after = before > 0 ? before - 1 : 0;
  // Between two shapes it moves; after a longer rest, in the last period of it.
  const double progress = std::clamp(1 - (static_cast<double>(tick_back(after)) - tick) / period_, 0.0, 1.0);
  const auto part = static_cast<float>(progress), taken = static_cast<float>(fraction);
  const float *a = back(before), *b = back(after);
  for (std::size_t i = 0; i < size_; ++i) {
    const float own = a[i] + part * (b[i] - a[i]);
    offset_[i] += taken * (heard_[i] - own - offset_[i]);
  }
  age_ = -1;
}

void PastShapes::show() noexcept {
  const float* own = back(0);
  for (std::size_t i = 0; i < size_; ++i) shown_[i / 3][i % 3] = in_steps(own[i] + offset_[i]);
}

void PastShapes::show_heard() noexcept {
  for (std::size_t i = 0; i < size_; ++i) shown_[i / 3][i % 3] = in_steps(heard_[i]);
  age_ = -1;
}

// ==== prediction ====

namespace {

constexpr double kSettle = 0.1, kSettleYielding = 0.02;  // tau [s]: a rigid object, and those that yield
constexpr double kFraction = kTick / kSettle, kFractionYielding = kTick / kSettleYielding;
constexpr double kClose = 1e-4, kCloseTurn = 2e-3;  // [m, rad]
constexpr double kFar = 0.3, kFarTurn = 1.0;        // [m, rad] then the object is set to the server's pose

/// Rotation vector of a unit quaternion [rad].
Vec3 turn_of(const Quat& q) noexcept {
  const Vec3 axis{q.x, q.y, q.z};
  const double sine = norm(axis);
  if (!(sine > 0)) return {};
  const double angle = 2 * angle_of(sine, std::abs(q.w));
  return ((q.w < 0 ? -angle : angle) / sine) * axis;
}

Quat quaternion_of(const Vec3& turn) noexcept {
  const double angle = norm(turn);
  if (!(angle > 0)) return {};
  const Vec3 axis = (sine(angle / 2) / angle) * turn;
  return {cosine(angle / 2), axis.x, axis.y, axis.z};
}

Quat normalised(const Quat& q) noexcept {
  const double s = 1 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {s * q.w, s * q.x, s * q.y, s * q.z};
}

/// Of an error, what to correct in this tick.
Vec3 part(const Vec3& error, double close) noexcept {
  const double size = norm(error);
  return size > close ? (kFraction * (1 - close / size)) * error : Vec3{};
}

/// Components along the axes whose bits are set, from bit `first` on.
Vec3 along_free(const Vec3& v, unsigned dof, unsigned first) noexcept {
  const auto free = [&](unsigned axis, double component) { return (dof >> (first + axis) & 1) != 0 ? component : 0.0; };
  return {free(0, v.x), free(1, v.y), free(2, v.z)};
}

/// The scene as one user is alone in it.
Scene own_scene(const Scene& scene, std::size_t user) {
  Scene own = scene;
  own.compensation.reset();
  own.users = {scene.users[user]};
  return own;
}

}  // namespace

Prediction::Prediction(const Scene& scene, std::unique_ptr<Server> own)
    : rigid_(scene.objects.size()), own_(std::move(own)), pushes_(rigid_), corrections_(rigid_) {
  for (const SceneObject& object : scene.objects) {
    poses_.push_back(object.pose);
    free_.push_back(object.dof);
    pasts_.emplace_back(object.pose, object.dof == Dof::none ? 1 : kMostDelay + 1);
  }
  for (const SceneMsd& msd : scene.msds) {
    poses_.push_back({msd.position, {}});
    pasts_.emplace_back(poses_.back(), kMostDelay + 1);
    yielding_.push_back({.period = msd.rate});
  }
  heard_ = poses_;
  if (own_->deformables() == nullptr) return;
  for (const TraceDeformable& mesh : own_->deformables()->meshes())
    meshes_.push_back({PastShapes(mesh.rest.vertices.size(), kMostDelay, mesh.period), mesh.period});
}

Result<std::unique_ptr<Prediction>> Prediction::create(const Scene& scene, std::size_t user) {
  TACTUS_TRY(auto own, Server::create(own_scene(scene, user), {.codec = {}, .has_clients = false}));
  return std::unique_ptr<Prediction>(new Prediction(scene, std::move(own)));
}

void Prediction::hear(std::uint32_t object, const Pose& pose, std::int64_t tick) noexcept {
  heard_[object] = pose;
  if (object >= rigid_) yielding_[object - rigid_].age = tick % yielding_[object - rigid_].period;
  has_heard_ = true;
}

void Prediction::hear(std::size_t mesh, Shape displacements, unsigned position_exp, std::int64_t tick) noexcept {
  meshes_[mesh].past.hear(displacements, position_exp, std::fmod(static_cast<double>(tick), meshes_[mesh].period));
  has_heard_ = true;
}

void Prediction::correct(std::uint32_t delay) noexcept {
  if (is_broken_) return show_heard();
  own_->observe();
  const TraceFrame& own = own_->frame();
  for (std::uint32_t i = 0; i < poses_.size(); ++i) pasts_[i].add(own.tick, without_corrections(i));
  for (std::size_t i = 0; i < meshes_.size(); ++i)
    if (own.meshes[i].updated) meshes_[i].past.add(own.tick, own.meshes[i].displacements);
  if (!has_heard_) return show_own();
  if (delay == 0) return follow();
  const std::int64_t then = own.tick - std::min(delay, kMostDelay) + 1;  // a sample is answered by the state after it
  for (std::uint32_t i = 0; i < rigid_; ++i) correct_rigid(i, then);
  for (std::size_t i = rigid_; i < poses_.size(); ++i) correct_yielding(i, then);
  for (std::size_t i = 0; i < meshes_.size(); ++i) correct_shape(i, then);
}

/// The own pose of this tick, as if nothing had been corrected.
Pose Prediction::without_corrections(std::size_t object) const noexcept {
  const Pose& own = own_->frame().objects[object].pose;
  if (object >= rigid_) return own;
  const Pose& sum = corrections_[object];
  return {own.position - sum.position, conjugate(sum.rotation) * own.rotation};
}

/// As long as there is no other state.
void Prediction::show_own() noexcept {
  for (std::size_t i = 0; i < poses_.size(); ++i) poses_[i] = own_->frame().objects[i].pose;
  for (Mesh& mesh : meshes_) {
    mesh.is_new = mesh.past.newest() == own_->frame().tick;
    if (mesh.is_new) mesh.past.show();
  }
}

/// The server's state, as it is.
void Prediction::follow() noexcept {
  for (std::uint32_t i = 0; i < rigid_; ++i) {
    const Pose& own = own_->frame().objects[i].pose;
    move(i, heard_[i].position - own.position, turn_of(heard_[i].rotation * conjugate(own.rotation)));
  }
  show_heard();
}

void Prediction::show_heard() noexcept {
  std::ranges::copy(heard_, poses_.begin());
  for (Mesh& mesh : meshes_) {
    mesh.is_new = mesh.past.heard_age() >= 0;
    if (mesh.is_new) mesh.past.show_heard();
  }
}

/// Correct the own pose of this tick, as far as the object can move.   in  turn  rotation vector [rad]
void Prediction::move(std::uint32_t object, const Vec3& by, const Vec3& turn_by) noexcept {
  const Pose& own = own_->frame().objects[object].pose;
  poses_[object] = own;
  const Vec3 displacement = along_free(by, free_[object], 0), turn = along_free(turn_by, free_[object], 3);
  if (displacement == Vec3{} && turn == Vec3{}) return;
  const Quat rotation = quaternion_of(turn);
  Pose& sum = corrections_[object];
  sum = {sum.position + displacement, normalised(rotation * sum.rotation)};
  poses_[object] = {own.position + displacement, normalised(rotation * own.rotation)};
  own_->rigid().move_to(object, poses_[object]);
}

void Prediction::correct_rigid(std::uint32_t object, std::int64_t then) noexcept {
  const Pose &sum = corrections_[object], &past = pasts_[object].at(then), &heard = heard_[object];
  const Vec3 displacement = heard.position - (past.position + sum.position);
  const Vec3 turn = turn_of(heard.rotation * conjugate(sum.rotation * past.rotation));
  const bool is_far = norm(displacement) > kFar || norm(turn) > kFarTurn;
  move(object, is_far ? displacement : part(displacement, kClose), is_far ? turn : part(turn, kCloseTurn));
}

/// The surface stays for a period, and server and own simulation begin theirs at different times: between two own positions lies that which
/// it would have had when the server's began. What is shown stays for a period, too: forces approach a new surface from there.
void Prediction::correct_yielding(std::size_t object, std::int64_t then) noexcept {
  auto& [period, age, offset] = yielding_[object - rigid_];
  const std::int64_t began = then - age, into = (began % period + period) % period;
  const Vec3 &a = pasts_[object].at(began).position, &b = pasts_[object].at(began + period).position;
  const Vec3 own = a + (static_cast<double>(into) / static_cast<double>(period)) * (b - a);
  offset = offset + kFractionYielding * (heard_[object].position - own - offset);
  if (own_->frame().tick % period == 0) poses_[object].position = own_->frame().objects[object].pose.position + offset;
}

void Prediction::correct_shape(std::size_t number, std::int64_t then) noexcept {
  auto& [past, period, is_new] = meshes_[number];
  const std::int64_t now = own_->frame().tick;
  const bool heard = past.heard_age() >= 0;
  if (heard) past.compare(static_cast<double>(then) - past.heard_age(), 1 - exponential(-period * kTick / kSettleYielding));
  // While the own simulation goes on, its shapes take along what was heard: one new shape in each period.
  is_new = past.newest() == now || (heard && static_cast<double>(now - past.newest()) >= period);
  if (is_new) past.show();
}

void Prediction::step(const DeviceSample& device) noexcept try {
  if (is_broken_) return;
  own_->touch({&device, 1});
  for (std::uint32_t i = 0; i < rigid_; ++i)
    if (pushes_[i] != Vec3{}) own_->rigid().push_centre(i, pushes_[i]);
  is_broken_ = !own_->step();
} catch (const std::bad_alloc&) {
  is_broken_ = true;
}

}  // namespace tactus::sim
