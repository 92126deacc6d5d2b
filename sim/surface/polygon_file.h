// SPDX-License-Identifier: Apache-2.0
/// A surface file's polygons as stored, complete but not validated. Rules: surface_file.h. Internal to the library.
#pragma once

#include <string_view>

#include <tactus/base/rule.h>
#include <tactus/sim/surface/openmesh_io.h>
#include <tactus/sim/surface/surface_file.h>

namespace tactus::sim {

/// An error of this library, with its place.
tl::unexpected<Diagnostic> broken(Errc code, RuleName rule, std::string detail, std::string file = {});

/// The name's ending in small letters.
std::string surface_format(const std::string& path);

/// err  R-SRF-1..5, 7
tl::expected<PolygonSoup, Diagnostic> parse_polygons(std::string_view text, std::string_view format);
tl::expected<PolygonSoup, Diagnostic> read_polygons(const std::string& path);

/// Triangles of it, if they make a mesh.   err  R-SRF-5, R-SRF-6, R-SRF-8..14
tl::expected<SurfaceFile, Diagnostic> make_surface(PolygonSoup&& soup);

}  // namespace tactus::sim
