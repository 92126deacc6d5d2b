// SPDX-License-Identifier: Apache-2.0
/// The keys of [[deformable]].
#pragma once

#include <filesystem>

#include "sim/scene/toml_reader.h"

namespace tactus {

/// in  folder  mesh files are named relative to it
///     touch   stiffness and friction of deformables that name none
SceneDeformable read_deformable(TomlReader& in, const toml::table& table, const std::filesystem::path& folder,
                                const SceneTouch& touch);

}  // namespace tactus
