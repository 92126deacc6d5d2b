// SPDX-License-Identifier: Apache-2.0
/// The keys of [[deformable]].
#pragma once

#include <filesystem>

#include <tactus/sim/scene/toml_reader.h>

namespace tactus::sim {

/// in  folder  mesh files are named relative to it
///     touch   stiffness and friction of deformables that name none
SceneDeformable read_deformable(TomlReader& in, const toml::table& table, const std::filesystem::path& folder,
                                const SceneTouch& touch);

/// Whether memory suffices for so many tetrahedra in one scene. If not, the reader fails with the estimate.   err  R-SCN-6
bool affords_tets(TomlReader& in, const toml::node& node, const std::string& key, std::uint64_t tets);

}  // namespace tactus::sim
