// SPDX-License-Identifier: Apache-2.0
/// Scenes and motions that several tests of the rigid codec share.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <tactus/tactus.h>
#include <tactus/thesis/thesis.h>

namespace tactus::testing {

/// Limits of a receiver that has component thesis.
inline constexpr DecodeLimits kWithThesis{.thesis = &thesis_component};

inline SceneSpec spec_of(std::size_t objects, std::uint8_t dof = Dof::all) {
  SceneSpec spec;
  spec.objects.resize(objects);
  for (std::size_t i = 0; i < objects; ++i) {
    spec.objects[i].name = "object " + std::to_string(i);
    spec.objects[i].dof = dof;
  }
  return spec;
}

/// pre  the declaration breaks no rule
inline SharedScene shared(SceneSpec spec, const DecodeLimits& limits = {}) {
  return Scene::create(std::move(spec), limits).value();
}
inline SharedScene scene_of(std::size_t objects, std::uint8_t dof = Dof::all) { return shared(spec_of(objects, dof)); }

/// The packets of a call. A span of its own: `for (auto& p : sender.encode(..).value())` would walk in what is gone.
inline std::span<const Packet> all(const Result<std::span<const Packet>>& packets) { return packets.value(); }

/// The packet of a call that makes one at most; without bytes: none.
inline Packet only(const Result<std::span<const Packet>>& packets) {
  const std::span<const Packet> made = all(packets);
  if (made.size() > 1) throw std::logic_error("more than one packet");
  return made.empty() ? Packet{} : made.front();
}

/// Smooth but eventful motion of one object from a seed: drifting sines in position and angle, with sudden kicks.
class Motion {
 public:
  explicit Motion(std::uint64_t seed) : random_(seed) {}

  RigidSample step(double dt) {
    if (random_() % 200 == 0) velocity_ = {0.2 * normal_(random_), 0.2 * normal_(random_), 0.2 * normal_(random_)};
    if (random_() % 200 == 0) spin_ = {3 * normal_(random_), 3 * normal_(random_), 3 * normal_(random_)};
    velocity_ = velocity_ - (0.5 * dt) * position_;
    position_ = position_ + dt * velocity_;
    const Quat rate = Quat{0, spin_.x, spin_.y, spin_.z} * rotation_;
    Quat q{rotation_.w + 0.5 * dt * rate.w, rotation_.x + 0.5 * dt * rate.x, rotation_.y + 0.5 * dt * rate.y,
           rotation_.z + 0.5 * dt * rate.z};
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    rotation_ = {q.w / length, q.x / length, q.y / length, q.z / length};
    return {{position_, rotation_}, velocity_, spin_};
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  Vec3 position_, velocity_, spin_;
  Quat rotation_;
};

/// A probe pressed into the object's top face by `depth` metres.
inline Contact touch(std::uint32_t object, const Pose& pose, double depth, double stiffness = 630) {
  Contact contact;
  contact.kind = ContactKind::surface;
  contact.object = object;
  contact.point = {0.005, -0.003, 0.02};
  contact.normal = {0, 0, 1};
  contact.stiffness = stiffness;
  contact.device = to_world(pose, contact.point) - depth * rotate(pose.rotation, contact.normal);
  return contact;
}

}  // namespace tactus::testing
