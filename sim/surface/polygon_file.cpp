// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/polygon_file.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <limits>

#include <tactus/base/rule.h>

namespace tactus::sim {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{512} << 20;
constexpr std::size_t kLongestQuote = 60;  // bytes of a line that an error repeats

/// A format that others read, by the name's ending: what turns it into one that is read here.
std::string converter_of(std::string_view format) {
  if (format == ".fbx" || format == ".dae" || format == ".abc" || format == ".blend" || format == ".usd" || format == ".usdz" ||
      format == ".3ds")
    return "Write it as .obj or .ply with a modelling program: in Blender, File, Import, then File, Export.";
  if (format == ".vtk" || format == ".vtu" || format == ".vtp" || format == ".xdmf" || format == ".inp")
    return "Write it as .ply or .off: meshio convert FILE surface.ply.";
  return {};
}

}  // namespace

tl::expected<std::string, Diagnostic> read_bytes(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return broken(Errc::io, "R-SRF-1", "a folder");
  std::ifstream in(path, std::ios::binary);
  std::string text;
  std::array<char, 1 << 16> piece{};
  while (in) {
    in.read(piece.data(), piece.size());
    const auto count = static_cast<std::size_t>(in.gcount());
    if (count > kMaxFileBytes - text.size()) return broken(Errc::limit_exceeded, "R-SRF-2", "");
    text.append(piece.data(), count);
  }
  if (!in.eof() || in.bad()) return broken(Errc::io, "R-SRF-1", "");
  return text;
}

tl::unexpected<Diagnostic> broken(Errc code, RuleName rule, std::string detail, std::string file) {
  return tl::unexpected(Diagnostic{.error = fail(code, rule).value(), .file = std::move(file), .detail = std::move(detail)});
}

tl::unexpected<Diagnostic> broken_line(const LineReader& lines, std::string_view why, Errc code, RuleName rule) {
  std::string detail = '\'' + std::string(lines.whole_line().substr(0, kLongestQuote)) + '\'';
  if (!why.empty()) detail += ": " + std::string(why);
  return tl::unexpected(Diagnostic{.error = fail(code, rule).value(), .line = lines.line_number(), .detail = std::move(detail)});
}

std::string folder_of(const std::string& path) {
  const std::string parent = std::filesystem::path(path).parent_path().string();
  return parent.empty() ? "." : parent;
}

std::string surface_format(const std::string& path) {
  std::string format = std::filesystem::path(path).extension().string();
  std::transform(format.begin(), format.end(), format.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return format;
}

std::optional<double> parse_coordinate(std::string_view word) noexcept {
  if (const auto value = parse_number<double>(word)) return value;
  if (word.starts_with('-')) word.remove_prefix(1);
  if (word.starts_with("1.#")) return std::numeric_limits<double>::quiet_NaN();  // "-1.#IND", "1.#QNAN", "1.#INF"
  return std::nullopt;
}

std::optional<Vec3> take_vertex(LineReader& lines) noexcept {
  Vec3 v;
  for (double* c : {&v.x, &v.y, &v.z}) {
    const auto value = parse_coordinate(lines.word());
    if (!value) return std::nullopt;
    *c = *value;
  }
  return v;
}

tl::expected<std::uint32_t, Diagnostic> parse_corner(std::string_view word, const LineReader& lines) {
  const auto number = parse_number<std::int64_t>(word);
  if (!number) return broken_line(lines);
  if (*number < 0 || *number >= std::numeric_limits<std::uint32_t>::max())
    return broken_line(lines, "no vertex " + std::string(word), Errc::invalid, "R-SRF-9");
  return static_cast<std::uint32_t>(*number);
}

tl::expected<void, Diagnostic> check_counts(std::size_t vertices, std::size_t faces, std::size_t bytes) {
  if (vertices > kMaxMeshVertices || faces > kMaxMeshTriangles)
    return broken(Errc::limit_exceeded, "R-SRF-2", std::to_string(vertices) + " vertices, " + std::to_string(faces) + " faces");
  if (vertices + faces > bytes) return broken(Errc::malformed, "R-SRF-5", "the file is shorter than its header says");
  return {};
}

void note_open_end(std::string_view text, PolygonSoup& soup) {
  if (!text.empty() && !text.ends_with('\n'))
    soup.notes.add("", "the last line has no end, as that of a file that was cut; it is read as it is");
}

SoupResult parse_polygons(std::string_view bytes, std::string_view format) {
  const auto read = [&]() -> SoupResult {
    if (format == ".obj") return read_obj(bytes);
    if (format == ".off") return read_off(bytes);
    if (format == ".ply") return read_ply(bytes);
    if (format == ".stl") return read_stl(bytes);
    auto refused = broken(Errc::unsupported, "R-SRF-3", std::string(format));
    refused.value().remedy = converter_of(format);
    return refused;
  };
  auto soup = read();
  if (soup && soup->polygons.empty())
    return broken(Errc::invalid, "R-SRF-7", std::to_string(soup->vertices.size()) + " vertices");
  return soup;
}

SoupResult read_polygons(const std::string& path) {
  const auto named = [&](Diagnostic e) {
    e.file = path;
    return e;
  };
  const auto bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(named(bytes.error()));
  return parse_polygons(*bytes, surface_format(path)).map_error(named);
}

}  // namespace tactus::sim
