// SPDX-License-Identifier: Apache-2.0
/// What a client makes of the delay of what it shows: it renders what its users touch softer, as much as keeps their forces right
/// (thesis algorithm 1 for rigid objects, 4.52 to 4.56 for those that yield). codec/client/stiffness_reduction.h
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tactus/client/stiffness_reduction.h>
#include <tactus/receiver.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/touchable.h>

namespace tactus::sim {

/// [N] What all users but this one push an object with.   in  load  of Receiver::load
Vec3 others_push(std::span<const GridForce> load, std::size_t user, unsigned force_exp) noexcept;

/// Of all users of one client.
class Compensation {
 public:
  /// pre  scene.compensation, and the scene outlives this.
  /// err  R-API-4: its filter
  static Result<Compensation> create(const Scene& scene);

  /// The user's device in this tick, before what it touches.   no allocation
  void move(std::size_t user, const DeviceSample& device) noexcept { reductions_[user].move(device.position); }
  /// What the object that a user touches is shown as.
  struct Shown {
    const DeformableObject* deformable = nullptr;  ///< as declared, of touch.surface; none: its stiffness is not told
    std::span<const GridForce> load{};             ///< Receiver::load, of touch.contact.object
    unsigned force_exp = 0;
    Pose pose;
    bool moves = false;
  };
  /// The force [N] to render in place of that of a touch.
  /// in   delay  [ticks] of what is shown
  /// no allocation
  Vec3 soften(std::size_t user, const Touch& touch, const Vec3& device, const Shown& shown, std::uint32_t delay) noexcept;
  /// The user touches nothing in this tick.
  void release(std::size_t user) noexcept { reductions_[user].release(); }
  /// [N/m] rendered in the last soften() of the user.
  double stiffness(std::size_t user) const noexcept { return stiffness_[user]; }

 private:
  explicit Compensation(const Scene& scene) : scene_(&scene), stiffness_(scene.users.size()) {}
  double reduced(std::size_t user, const Touch& touch, const Vec3& stretch, const Shown& shown, std::uint32_t delay) noexcept;

  const Scene* scene_;
  std::vector<StiffnessReduction> reductions_;  // one per user
  std::vector<double> stiffness_;               // [N/m] one per user
};

}  // namespace tactus::sim
