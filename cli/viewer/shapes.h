// SPDX-License-Identifier: Apache-2.0
/// What the objects of a stream look like: a stream holds where they are, a scene what they are.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include <tactus/scene/scene.h>
#include "cli/report/messages.h"

namespace tactus::cli {

/// Shapes and floor of a scene that a trace brought along, as far as it holds them without other files. Never an error: what cannot be
/// read is not shown.
nlohmann::ordered_json attached_shapes(const std::string& text);

/// The same of a scene that the user named: with the surfaces of solids.   err  of find_scene(), load_scene()
tl::expected<nlohmann::ordered_json, Failure> scene_shapes(const std::string& name);

}  // namespace tactus::cli
