// SPDX-License-Identifier: Apache-2.0
/// The membrane in Bullet's deformable world, as a peer. Bullet's "linear elasticity" is co-rotated; "explicit" is symplectic Euler.
#pragma once

#include <cstdint>
#include <memory>

#include <tactus/sim/fem/model.h>

namespace tactus::testing {

class BulletSlab {
 public:
  /// All vertices of one material; `model` gives mesh, masses and fixed vertices.
  BulletSlab(const sim::FemModel& model, const sim::Material& material);
  ~BulletSlab();
  BulletSlab(const BulletSlab&) = delete;
  BulletSlab& operator=(const BulletSlab&) = delete;

  /// One step of h [s] with `force` [N] along z on `vertex`.
  void step(double h, std::uint32_t vertex, double force);
  double z(std::uint32_t vertex) const;  ///< displacement [m]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus::testing
