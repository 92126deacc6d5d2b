// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/rigid/rigid_probe.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace tactus::sim {
namespace {

constexpr double kAround = 0.1;           // [m]
constexpr std::uint64_t kLookAgain = 64;  // moves

double& component(Vec3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
double component(const Vec3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// Height of a point over a face, negative below.
double height(const Vec3& point, const BoxFace& face, const Vec3& half) {
  const double along = component(point, face.axis);
  return (face.negative ? -along : along) - component(half, face.axis);
}

void put_on(Vec3& point, const BoxFace& face, const Vec3& half) {
  const double extent = component(half, face.axis);
  component(point, face.axis) = face.negative ? -extent : extent;
}

}  // namespace

Vec3 BoxProxy::normal() const noexcept {
  Vec3 normal;
  component(normal, face_->axis) = face_->negative ? -1 : 1;
  return normal;
}

void BoxProxy::move_to(const Vec3& probe) noexcept {
  proxy_ = probe;
  face_.reset();
  double nearest = -std::numeric_limits<double>::infinity();
  BoxFace face;
  for (std::uint8_t axis = 0; axis < 3; ++axis) {
    const BoxFace candidate{axis, component(probe, axis) < 0};
    if (const double h = height(probe, candidate, half_); h > nearest) {
      nearest = h;
      face = candidate;
    }
  }
  if (nearest >= 0) return;
  face_ = face;
  put_on(proxy_, face, half_);
}

void BoxProxy::move(const Vec3& probe) noexcept {
  if (face_ && height(probe, *face_, half_) >= 0) face_.reset();
  if (face_ || enter(probe)) slide(probe);
  else proxy_ = probe;
}

/// Move the proxy to where its path to the probe first meets the box (slab test); false if it does not.   pre  the proxy is outside
bool BoxProxy::enter(const Vec3& probe) noexcept {
  double first = 0, last = 1;
  std::optional<BoxFace> met;
  for (std::uint8_t axis = 0; axis < 3; ++axis) {
    const double from = component(proxy_, axis), displacement = component(probe, axis) - from, extent = component(half_, axis);
    if (displacement == 0) {
      if (std::abs(from) >= extent) return false;
      continue;
    }
    const double near = (-std::copysign(extent, displacement) - from) / displacement,
                 far = (std::copysign(extent, displacement) - from) / displacement;
    if (near >= first) {
      first = near;
      met = BoxFace{axis, displacement > 0};
    }
    last = std::min(last, far);
  }
  if (!met || first >= last) return false;
  proxy_ = proxy_ + first * (probe - proxy_);
  put_on(proxy_, *met, half_);
  face_ = met;
  return true;
}

void BoxProxy::slide(const Vec3& probe) noexcept {
  const double depth = -height(probe, *face_, half_);
  Vec3 foot = probe;
  put_on(foot, *face_, half_);
  const Vec3 lag = proxy_ - foot;
  const double distance = norm(lag), rim = friction_ * depth;
  if (distance <= rim) return;
  proxy_ = foot + (rim / distance) * lag;
  for (std::uint8_t axis = 0; axis < 3; ++axis) {
    if (axis == face_->axis || std::abs(component(proxy_, axis)) <= component(half_, axis)) continue;
    proxy_ = probe;
    face_.reset();
    return;
  }
}

RigidProbe::RigidProbe(std::span<const SceneObject> objects, const SceneTouch& touch) : touch_(touch) {
  proxies_.reserve(objects.size());
  near_.resize(objects.size());
  std::iota(near_.begin(), near_.end(), 0U);
  for (const SceneObject& object : objects) {
    Seen& seen = seen_.emplace_back();
    seen.reach = object.surface.triangles.empty() ? 0.5 * norm(object.size) : 0;
    for (const Vec3& v : object.surface.vertices) seen.reach = std::max(seen.reach, norm(v));
    if (object.surface.triangles.empty()) proxies_.emplace_back(BoxProxy(0.5 * object.size, touch.friction));
    else proxies_.emplace_back(SurfaceProxy(std::make_shared<const TouchSurface>(object.surface), touch.friction));
  }
}

void RigidProbe::move_to(std::uint32_t object, const Vec3& device, const Pose& pose) noexcept {
  std::visit([&](auto& proxy) { proxy.move_to(to_object(pose, device)); }, proxies_[object]);
}

void RigidProbe::move_all(const Vec3& device, std::span<const Pose> poses) noexcept {
  device_ = device;
  if (attended_only_) look_around(device, poses);
  for (const std::uint32_t i : near_) move_to(i, device, poses[i]);
}

void RigidProbe::attend(std::uint32_t object, const Pose& pose) {
  if (!placed_) return;
  Seen& seen = seen_[object];
  seen.attended_at = moves_ + 1;
  if (seen.near) return;
  seen.near = true;
  move_to(object, device_, pose);
  near_.insert(std::lower_bound(near_.begin(), near_.end(), object), object);
}

/// Find the objects that the probe may meet on its path to the device, and a little beyond.
void RigidProbe::look_around(const Vec3& device, std::span<const Pose> poses) noexcept {
  looked_from_ = device;
  const Vec3 middle = 0.5 * (device_ + device);
  const double around = kAround + 0.5 * norm(device - device_);
  near_.clear();
  for (std::uint32_t i = 0; i < seen_.size(); ++i) {
    Seen& seen = seen_[i];
    const Vec3 away = poses[i].position - middle;
    const double reach = around + seen.reach;
    const bool is_near = seen.attended_at == moves_ || dot(away, away) <= reach * reach;
    if (is_near && !seen.near) move_to(i, device_, poses[i]);
    seen.near = is_near;
    if (is_near) near_.push_back(i);
  }
}

/// Move one proxy; true if it touches afterwards.
bool RigidProbe::move_one(std::size_t object, const Vec3& device, std::span<const Pose> poses) noexcept {
  return std::visit(
      [&](auto& proxy) {
        proxy.move(to_object(poses[object], device));
        return proxy.touches();
      },
      proxies_[object]);
}

/// Move the proxies; while one object is touched, the others ignore the probe.
void RigidProbe::follow(const Vec3& device, std::span<const Pose> poses) noexcept {
  if (touched_) {
    if (move_one(*touched_, device, poses)) return;
    touched_.reset();
    move_all(device, poses);
  }
  const bool looks =
      norm(device - looked_from_) > 0.5 * kAround || moves_ % kLookAgain == 0;  // some of those near may rest by now
  if (attended_only_ && looks) look_around(device, poses);
  for (const std::uint32_t i : near_)
    if (move_one(i, device, poses) && !touched_) touched_ = i;
}

Touch RigidProbe::move(const Vec3& device, bool button, std::span<const Pose> poses) noexcept {
  ++moves_;
  if (!placed_ || (anchor_ && !button)) {
    anchor_.reset();
    touched_.reset();
    move_all(device, poses);
    placed_ = true;
  }
  if (!anchor_) follow(device, poses);
  device_ = device;

  Touch out{.contact = {}, .proxy = device, .force = {}};
  out.contact.device = device;
  if (!touched_) return out;
  std::visit(
      [&](const auto& proxy) {
        if (button && !anchor_) anchor_ = proxy.position();
        out.contact = {.kind = anchor_ ? ContactKind::spring : ContactKind::surface,
                       .object = *touched_,
                       .point = anchor_ ? *anchor_ : proxy.position(),
                       .normal = proxy.normal(),
                       .device = device,
                       .stiffness = anchor_ ? touch_.lift_stiffness : touch_.stiffness};
      },
      proxies_[*touched_]);
  out.proxy = to_world(poses[*touched_], out.contact.point);
  out.force = out.contact.stiffness * (out.proxy - device);
  return out;
}

}  // namespace tactus::sim
