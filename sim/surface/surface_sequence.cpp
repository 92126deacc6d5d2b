// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/surface_sequence.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>

#include <tactus/base/rule.h>
#include <tactus/sim/surface/polygon_file.h>

namespace tactus::sim {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

/// Take the digits at the front of `text`; the result is without leading zeros.
std::string_view take_number(std::string_view& text) noexcept {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  std::string_view digits = text.substr(0, end);
  text.remove_prefix(end);
  while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
  return digits;
}

bool is_surface(const std::string& format) noexcept {
  constexpr std::array<std::string_view, 4> kFormats{".obj", ".ply", ".off", ".stl"};
  return std::find(kFormats.begin(), kFormats.end(), format) != kFormats.end();
}

tl::expected<std::vector<std::string>, Diagnostic> surfaces_in(const std::string& folder) {
  std::vector<std::string> files;
  std::set<std::string> formats;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().string(), format = surface_format(name);
    if (!is_surface(format)) continue;
    files.push_back(name);
    formats.insert(format);
  }
  if (error) return broken(Errc::io, "R-SEQ-1", "", folder);
  if (files.empty()) return broken(Errc::invalid, "R-SEQ-2", "no .obj, .ply or .off file", folder);
  if (formats.size() > 1)
    return broken(Errc::invalid, "R-SEQ-2", *formats.begin() + " and " + *formats.rbegin() + " files", folder);
  if (*formats.begin() == ".stl") return broken(Errc::unsupported, "R-SEQ-3", "", folder);
  std::sort(files.begin(), files.end(), natural_less);
  return files;
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) noexcept {
  std::string_view x = a, y = b;
  while (!x.empty() && !y.empty()) {
    if (is_digit(x.front()) && is_digit(y.front())) {
      const std::string_view m = take_number(x), n = take_number(y);
      if (m.size() != n.size()) return m.size() < n.size();
      if (m != n) return m < n;
    } else {
      if (x.front() != y.front()) return x.front() < y.front();
      x.remove_prefix(1);
      y.remove_prefix(1);
    }
  }
  if (x.empty() != y.empty()) return x.empty();
  return a < b;  // "f1" and "f01": any fixed order
}

tl::expected<SurfaceSequence, Diagnostic> SurfaceSequence::open(const std::string& folder) {
  TACTUS_TRY(auto files, surfaces_in(folder));
  SurfaceSequence out;
  out.files_ = std::move(files);
  TACTUS_TRY(auto soup, read_polygons(out.files_[0]));
  out.polygons_ = soup.polygons;
  out.vertices_ = soup.vertices.size();
  std::set<std::uint32_t> used;
  for (const Polygon& polygon : out.polygons_) used.insert(polygon.begin(), polygon.end());
  out.used_.assign(used.begin(), used.end());
  auto surface = make_surface(std::move(soup));
  if (!surface) {
    surface.error().file = out.files_[0];
    return tl::unexpected(surface.error());
  }
  out.rest_ = std::move(surface->mesh);
  return out;
}

tl::expected<std::vector<Vec3>, Diagnostic> SurfaceSequence::positions(std::size_t frame) const {
  const std::string& file = files_[frame];
  TACTUS_TRY(const auto soup, read_polygons(file));
  if (soup.vertices.size() != vertices_)
    return broken(Errc::invalid, "R-SEQ-4",
                  std::to_string(soup.vertices.size()) + " vertices, the first frame has " + std::to_string(vertices_), file);
  if (soup.polygons.size() != polygons_.size())
    return broken(Errc::invalid, "R-SEQ-4",
                  std::to_string(soup.polygons.size()) + " faces, the first frame has " + std::to_string(polygons_.size()), file);
  const auto differs = std::mismatch(polygons_.begin(), polygons_.end(), soup.polygons.begin());
  if (differs.first != polygons_.end())
    return broken(Errc::invalid, "R-SEQ-4", "face " + std::to_string(differs.first - polygons_.begin()), file);
  std::vector<Vec3> out;
  out.reserve(used_.size());
  for (const std::uint32_t v : used_) {
    const Vec3& p = soup.vertices[v];
    if (!(std::abs(p.x) <= 1e6 && std::abs(p.y) <= 1e6 && std::abs(p.z) <= 1e6))
      return tl::unexpected(
          Diagnostic{.error = fail(Errc::invalid, "R-SRF-8").value(), .file = file, .kind = "vertex", .element = v});
    out.push_back(p);
  }
  return out;
}

}  // namespace tactus::sim
