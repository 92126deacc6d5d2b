// SPDX-License-Identifier: Apache-2.0
/// Loads: the forces on rigid objects at the server, by which a client behind a delay finds the force that its user should feel
/// (thesis 4.2.3.4: f_e and f_u of the object state). A substream of their own, absent unless the scene asks. spec/45-load.md
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// Of one rigid object at one tick, world frame.
struct ObjectLoad {
  Vec3 external;  ///< [N] f_e: all forces on it but those of users: gravity, contacts with other objects, damping
  Vec3 hold;      ///< along the normal of the surfaces that hold it, as long as their largest friction [N]; 0: none
  std::span<const Vec3> pushes{};  ///< [N] f_u: of each user of the scene on it
};

using GridForce = std::array<std::int32_t, 3>;  ///< x 2^-force_exp N

/// Where the vectors of an object are.
inline constexpr std::size_t kExternal = 0, kHold = 1, kPushes = 2;

/// The loads of all objects that can move after a packet, vectors_of_load() each.
struct LoadState {
  std::int64_t tick = 0;           ///< of the packet
  std::vector<GridForce> vectors;  ///< order of Scene::moving()
};

/// pre  the scene has loads
inline std::size_t vectors_of_load(const Scene& scene) noexcept { return kPushes + scene.loads->users; }
/// Number of their substream.
inline std::size_t load_substream(const Scene& scene) noexcept { return scene.deformables.size() + 1; }
LoadState initial_loads(const Scene& scene);  ///< all zero.   pre  the scene has loads

/// To the grid.   err  invalid_argument R-API-1 not finite; R-API-2 it leaves the grid's range
Result<GridForce> to_grid_force(const Vec3& force, unsigned force_exp) noexcept;
Vec3 to_force(const GridForce& force, unsigned force_exp) noexcept;  ///< [N]

/// FNV-1a (64 bit) over tick and vectors. spec 45-load 5
std::uint64_t state_hash(const LoadState& state) noexcept;

}  // namespace tactus
