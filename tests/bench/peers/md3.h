// SPDX-License-Identifier: Apache-2.0
/// Animated models of id Software's MD3 format: header "IDP3" version 15; surfaces with triangles and, for every frame, vertices as
/// three i16 in 1/64 of a unit.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/tri_mesh.h>

namespace tactus::peers {

struct Md3Model {
  std::vector<Triangle> triangles;
  std::vector<std::vector<Vec3>> frames;
};

/// in   surface  name of the surface to take; empty: all
/// err  why not, in a few words
tl::expected<Md3Model, std::string> parse_md3(std::string_view bytes, std::string_view surface);

}  // namespace tactus::peers
