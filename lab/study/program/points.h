// SPDX-License-Identifier: Apache-2.0
/// The studies of tactus-study, each a function from one request to one JSON object. lab/study/README.md says what they take and yield.
/// Numbers that were not measured are null.
#pragma once

#include <tactus/sim/link/link.h>
#include <tactus/sim/scene/scene.h>
#include "lab/study/program/request.h"

namespace tactus::study {

// For `tactus bench`.
Json precision_point(Request& request);
Json stability_point(Request& request);
Json delay_point(Request& request);
Json session_point(Request& request);
Json scale_point(Request& request);
Json join_point(Request& request);
Json signals_point(Request& request);

// For `tactus reproduce`: simulations of chapter 3 ...
Json push_point(Request& request);
Json interpolations_point(Request& request);
Json rates_point(Request& request);
// ... and simulations and models of chapter 4.
Json touch_point(Request& request);
Json press_point(Request& request);
Json impedance_point(Request& request);
Json round_trips_point(Request& request);
Json stiffness_map_point(Request& request);

/// What several of them take: "scene", a file or the name of one that comes with Tactus, and "duration_s", at most so much of it.
sim::Scene scene_of(Request& request);
sim::LinkOptions link_of(Request& request, const std::string& key);
sim::Grip grip_of_request(Request& request);

}  // namespace tactus::study
