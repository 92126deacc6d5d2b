// SPDX-License-Identifier: Apache-2.0
/// What a client shows, as a trace: the other way round than trace_scene.h.
#pragma once

#include <cstdint>
#include <string>

#include <tactus/client/replica.h>
#include <tactus/scene/scene.h>
#include <tactus/trace/frame.h>

namespace tactus {

/// The objects of a scene, and the bounds that it tells; no users.
TraceInfo replica_info(const Scene& scene, std::string source);

/// A frame with room for the objects of a scene; shapes are at rest.
TraceFrame replica_frame(const Scene& scene);

/// Poses and shapes that a replica shows at a tick; a shape is new if any vertex is elsewhere than in the frame. A replica has no
/// velocities of its own.
/// pre  all are of the same scene   time O(objects + vertices)
void take_shown(Replica& replica, const Scene& scene, std::int64_t tick, TraceFrame& frame);

}  // namespace tactus
