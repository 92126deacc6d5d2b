// SPDX-License-Identifier: Apache-2.0
/// The states of all rigid objects at either end. Internal to the library.
#pragma once

#include <cstdint>

#include <tactus/base/paged_array.h>
#include <tactus/rigid/rigid_state.h>

namespace tactus {

/// The states of all objects of a scene after a packet.
struct RigidStates {
  std::int64_t tick = 0;           ///< of the packet
  PagedArray<RigidState> objects;  ///< order of Scene::objects
};

/// All objects at rest where the scene declares them; room for as many states as an end keeps.   allocates
RigidStates initial_states(const Scene& scene);

/// FNV-1a (64 bit) over the states of all objects that can move. spec 40-rigid 6
std::uint64_t state_hash(const Scene& scene, const RigidStates& states) noexcept;

}  // namespace tactus
