// SPDX-License-Identifier: Apache-2.0
#include <tactus/elastic/driven_shape.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <tactus/deformable/displacement.h>
#include <tactus/rigid/device_path.h>

namespace tactus {
namespace {

constexpr std::int64_t kFarthest = 64;  // shapes behind: a client that was away begins anew

/// Long enough for what is learnt of the past within a round trip, within 32 MB.
std::size_t ring_size(std::size_t vertices) noexcept {
  constexpr std::size_t kMost = 32, kLeast = 4, kNumbers = std::size_t{1} << 22;
  return std::clamp(kNumbers / (9 * vertices), kLeast, kMost);
}

constexpr std::int64_t kAll = std::int64_t{1} << 16;

/// Of what a state differs by, after so many shapes: an eighth fades with each.
std::int64_t left_after(std::int64_t shapes) noexcept {
  std::int64_t left = kAll;
  for (; shapes > 0 && left > 0; --shapes) left = (left * 7) >> 3;
  return left;
}

}  // namespace

KnownDevice::KnownDevice(std::shared_ptr<const DevicePath> known)
    : path(std::move(known)),
      make([](const Scene& scene, const DeformableObject& object, const DevicePath& device) -> std::unique_ptr<FollowedShape> {
        return std::make_unique<DrivenShape>(scene, object, device);
      }) {}

DrivenShape::DrivenShape(const Scene& scene, const DeformableObject& object, const DevicePath& path)
    : path_(path),
      solver_(scene, object),
      touch_(object),
      frames_(ring_size(solver_.vertices()), Frame(solver_)),
      surface_(object.rest.size()),
      load_(3 * solver_.vertices()),
      from_(object.rest.size()),
      shape_(object.rest.size()) {}

/// At rest.
void DrivenShape::begin(std::int64_t number) noexcept {
  first_ = newest_ = number;
  Frame& start = frame(number);
  std::ranges::fill(start.state.displacement, 0);
  std::ranges::fill(start.state.velocity, 0);
  std::ranges::fill(start.state.force, 0);
  start.moves = solver_.has_weight();
  start.touch = {};
  is_broken_ = false;
}

/// The shapes after the first one whose device was elsewhere than it is known to be now are made anew.
void DrivenShape::forget_what_changed() noexcept {
  revision_ = path_.revision();
  const std::int64_t ticks = solver_.ticks(), oldest = newest_ - static_cast<std::int64_t>(frames_.size()) + 1;
  for (std::int64_t n = std::max(first_, oldest); n < newest_ + (is_broken_ ? 1 : 0); ++n) {
    const std::vector<Position>& positions = frame(n).positions;
    for (std::int64_t i = 0; i < ticks; ++i) {
      if (path_.at(n * ticks + i) == positions[static_cast<std::size_t>(i)]) continue;
      newest_ = n;
      is_broken_ = false;
      return;
    }
  }
}

/// Move the device through the ticks of the newest shape. Returns whether it pushed.
bool DrivenShape::push() noexcept {
  Frame& now = frame(newest_);
  const std::int64_t ticks = solver_.ticks();
  const double unit = std::ldexp(1.0, -static_cast<int>(solver_.position_exp()));
  for (std::size_t v = 0; v < surface_.size(); ++v) {
    const double* u = now.state.displacement.data() + 3 * v;
    surface_[v] = solver_.rest()[v] + Vec3{u[0], u[1], u[2]};
  }
  solver_.weigh(load_);
  bool pushed = false;
  ElasticTouch::State touch = now.touch;
  for (std::int64_t i = 0; i < ticks; ++i) {
    const Position position = now.positions[static_cast<std::size_t>(i)] = path_.at(newest_ * ticks + i);
    if (!position) {
      touch = {};
      continue;
    }
    const Vec3 at{unit * (*position)[0], unit * (*position)[1], unit * (*position)[2]};
    const auto push = touch_.move(at, i == 0, surface_, touch);
    if (!push) continue;
    pushed = true;
    solver_.add(*push, load_);
  }
  frame(newest_ + 1).touch = touch;
  return pushed;
}

void DrivenShape::step() noexcept {
  const bool pushed = push();
  const Frame& now = frame(newest_);
  Frame& next = frame(newest_ + 1);
  next.state = now.state;  // as long: nothing is allocated
  next.moves = false;
  if (pushed || now.moves) {
    is_broken_ = !solver_.step(load_, next.state);
    if (is_broken_) return;
    next.moves = pushed || solver_.moves(next.state);  // what was held still moves once it is let go
  }
  ++newest_;
}

/// Make the shapes up to this one. Returns false if the path has not begun.
bool DrivenShape::advance(std::int64_t number) noexcept {
  if (!path_.begins()) return false;
  const std::int64_t origin = *path_.begins() / solver_.ticks();
  if (newest_ < first_ || (newest_ + kFarthest < number && !is_broken_)) begin(std::max(origin, number - kFarthest));
  if (revision_ != path_.revision()) forget_what_changed();
  while (newest_ < number && !is_broken_) step();
  return true;
}

/// A shape on the grid. Returns false if it is not there.   pre  advance()
bool DrivenShape::read(std::int64_t number, std::span<Vec3i> shape) noexcept {
  if (number <= *path_.begins() / solver_.ticks()) {
    std::ranges::fill(shape, Vec3i{});
    return true;
  }
  if (number > newest_ || number < first_ || number <= newest_ - static_cast<std::int64_t>(frames_.size())) return false;
  const double scale = std::ldexp(1.0, static_cast<int>(solver_.position_exp()));
  const double* u = frame(number).state.displacement.data();
  for (Vec3i& v : shape)
    for (std::int32_t& c : v) c = static_cast<std::int32_t>(std::floor(*u++ * scale + 0.5));
  return true;
}

bool DrivenShape::body_at(std::int64_t tick, std::span<Vec3i> shape) noexcept {
  const std::int64_t number = tick / solver_.ticks();
  return advance(number) && read(number, shape);
}

bool DrivenShape::show(const MainState& state, std::int64_t tick, std::span<Vec3i> shown) noexcept {
  const std::int64_t now = tick / solver_.ticks(), then = state.tick / solver_.ticks();
  if (!advance(std::max(now, then)) || !read(now, shape_)) return false;
  if (read(then, from_)) from_number_ = then;
  else if (from_number_ != then) return false;
  const std::int64_t left = state.following == Following::fading ? left_after(now - then) : kAll;
  for (std::size_t v = 0; v < shown.size(); ++v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t off = std::int64_t{state.displacement[v][axis]} - from_[v][axis];
      const std::int64_t kept = (std::abs(off) * left) >> 16;
      shown[v][axis] = limited_displacement(shape_[v][axis] + (off < 0 ? -kept : kept));
    }
  }
  return true;
}

}  // namespace tactus
