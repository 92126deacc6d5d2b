// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/polygon_file.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>

#include <tactus/base/rule.h>
#include <tactus/sim/surface/surface_text.h>

namespace tactus::sim {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{512} << 20;

tl::expected<std::string, Diagnostic> read_text(const std::string& path) {
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

std::string of(std::size_t read, std::size_t announced, const char* noun) {
  return std::to_string(read) + " of " + std::to_string(announced) + ' ' + noun;
}

}  // namespace

tl::unexpected<Diagnostic> broken(Errc code, RuleName rule, std::string detail, std::string file) {
  return tl::unexpected(Diagnostic{.error = fail(code, rule).value(), .file = std::move(file), .detail = std::move(detail)});
}

std::string surface_format(const std::string& path) {
  std::string format = std::filesystem::path(path).extension().string();
  std::transform(format.begin(), format.end(), format.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return format;
}

tl::expected<PolygonSoup, Diagnostic> parse_polygons(std::string_view text, std::string_view format) {
  TACTUS_TRY(const auto prepared, prepare_surface(text, format));
  if (prepared.faces == 0) return broken(Errc::invalid, "R-SRF-7", "");
  auto soup = openmesh_read(prepared.text, prepared.format);
  if (!soup) return broken(Errc::malformed, "R-SRF-4", soup.error());
  if (prepared.vertices && soup->vertices.size() != *prepared.vertices)
    return broken(Errc::malformed, "R-SRF-5", of(soup->vertices.size(), *prepared.vertices, "vertices"));
  if (soup->polygons.size() != prepared.faces)
    return broken(Errc::malformed, "R-SRF-5", of(soup->polygons.size(), prepared.faces, "faces"));
  return std::move(*soup);
}

tl::expected<PolygonSoup, Diagnostic> read_polygons(const std::string& path) {
  const auto named = [&](Diagnostic e) {
    e.file = path;
    return e;
  };
  const auto text = read_text(path);
  if (!text) return tl::unexpected(named(text.error()));
  return parse_polygons(*text, surface_format(path)).map_error(named);
}

}  // namespace tactus::sim
