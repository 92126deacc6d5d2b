// SPDX-License-Identifier: Apache-2.0
/// Bounds in C and in C++.
#pragma once

#include <tactus/scene/scene_objects.h>

#include "handles.h"

namespace tactus::c {

tactus_rigid_bounds bounds_of(const RigidTriggers& bounds) noexcept;
tactus_deformable_bounds bounds_of(const DeformableBounds& bounds) noexcept;
tactus_load_bounds bounds_of(const LoadThresholds& bounds) noexcept;

/// Null: defaults.   err  as given_or(); invalid_argument R-API-4 there is no such haptic rule
Result<RigidTriggers> bounds_of(const tactus_rigid_bounds* bounds) noexcept;
Result<DeformableThresholds> bounds_of(const tactus_deformable_bounds* bounds) noexcept;
Result<LoadThresholds> bounds_of(const tactus_load_bounds* bounds) noexcept;

}  // namespace tactus::c
