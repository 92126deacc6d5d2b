// SPDX-License-Identifier: Apache-2.0
/// Bounds of a stream as the metadata record "tactus_bounds" of a trace: one entry per number, named as in StreamBounds.
///   position_exp                                                        always
///   heartbeat, visual_position, visual_rotation, haptic                 if the stream had a rigid object that moves
///   weber_fraction, perceptual_fraction, force_floor, cone_angle, fixed_position, fixed_rotation   those that `haptic` uses:
///                                                                       off, isotropic, cone, fixed or perceptual
///   meshes/I/visual, meshes/I/kept, meshes/I/rings                      for mesh I = 0, 1, ..; kept is 0 or 1
///   meshes/I/weber_fraction, meshes/I/depth_floor                       if it has a haptic bound
/// Numbers are written so that reading gives the same bits.
#pragma once

#include <optional>

#include <tactus/trace/frame.h>
#include <tactus/trace/mcap.h>

namespace tactus {

inline constexpr const char* kBoundsMetadata = "tactus_bounds";

mcap::TextMap entries_of(const TraceBounds& bounds);

/// Nothing when an entry is missing or invalid.   in  info  with its meshes
std::optional<TraceBounds> bounds_from(const mcap::TextMap& entries, const TraceInfo& info);

}  // namespace tactus
