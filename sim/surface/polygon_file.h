// SPDX-License-Identifier: Apache-2.0
/// A surface file's polygons as stored, complete but not validated. Rules: surface_file.h. Internal to the library.
#pragma once

#include <optional>
#include <string_view>

#include <tactus/base/rule.h>
#include <tactus/sim/surface/surface_file.h>
#include <tactus/sim/tets/tokenizer.h>

namespace tactus::sim {

using Polygon = std::vector<std::uint32_t>;

/// Vertices and faces as stored in a file, without connectivity. Corners may name vertices that are not there, coordinates may be NaN.
struct PolygonSoup {
  std::vector<Vec3> vertices;
  std::vector<Polygon> polygons;
  std::vector<std::uint32_t> vertex_lines, polygon_lines;  ///< where they are in a text file, from 1; empty: it has no lines
  std::optional<std::uint32_t> first_number;  ///< of a vertex, as the file counts; nothing: vertices have no numbers in it
  ReadNotes notes;
};
using SoupResult = tl::expected<PolygonSoup, Diagnostic>;

/// An error of this library, with its location.
tl::unexpected<Diagnostic> broken(Errc code, RuleName rule, std::string detail, std::string file = {});
/// "'the line'" and its number: R-SRF-4 unless another rule is named.
tl::unexpected<Diagnostic> broken_line(const LineReader& lines, std::string_view why = {}, Errc code = Errc::malformed,
                                       RuleName rule = "R-SRF-4");

/// All of a file.   err  R-SRF-1, R-SRF-2
tl::expected<std::string, Diagnostic> read_bytes(const std::string& path);
/// Where a file lies: "." at least.
std::string folder_of(const std::string& path);
/// y up becomes z up.
constexpr Vec3 turned_up(const Vec3& p) noexcept { return {p.x, 0 - p.z, p.y}; }

/// The name's ending in small letters.
std::string surface_format(const std::string& path);

/// A coordinate, which may be NaN or infinite, also as old Windows programs spell it.
std::optional<double> parse_coordinate(std::string_view word) noexcept;
/// Three coordinates from the line's next words; nothing: they are not there.
std::optional<Vec3> take_vertex(LineReader& lines) noexcept;

/// A word that names a vertex, from 0.   err  R-SRF-4 it is no number, R-SRF-9 it is negative
tl::expected<std::uint32_t, Diagnostic> parse_corner(std::string_view word, const LineReader& lines);

/// What is announced fits the limits and the bytes that hold it, each at least `least` bytes.   err  R-SRF-2, R-SRF-4
tl::expected<void, Diagnostic> check_counts(std::size_t vertices, std::size_t faces, std::size_t bytes);

/// Note it when the last line has no end, as that of a file that was cut has none.
void note_open_end(std::string_view text, PolygonSoup& soup);

/// From the file's bytes.   err  R-SRF-2..5, 9
SoupResult read_obj(std::string_view bytes);
SoupResult read_off(std::string_view bytes);
SoupResult read_ply(std::string_view bytes);
SoupResult read_stl(std::string_view bytes);

/// err  R-SRF-1..5, 7, 9
SoupResult parse_polygons(std::string_view bytes, std::string_view format);
SoupResult read_polygons(const std::string& path);

/// Triangles of it, if they make a mesh.   err  R-SRF-6, R-SRF-8..14
tl::expected<SurfaceFile, Diagnostic> make_surface(PolygonSoup&& soup, const SurfaceOptions& options);

}  // namespace tactus::sim
