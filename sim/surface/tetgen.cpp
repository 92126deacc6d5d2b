// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/tetgen.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <optional>
#include <sstream>

#include <tactus/base/rule.h>
#include <tactus/sim/surface/program.h>
#include <tactus/sim/surface/solid.h>
#include <tactus/sim/tets/tet_files.h>

namespace tactus::sim {
namespace {

namespace fs = std::filesystem;

constexpr double kVolumeTolerance = 1e-9;  // relative; TetGen writes 16 digits
constexpr double kSamePosition = 1e-12;    // of the surface's size; likewise
constexpr double kFar = 1000;              // of the surface's size: so far from the origin 16 digits are too few

tl::unexpected<Diagnostic> unfilled(Errc code, RuleName rule, std::string detail) {
  return tl::unexpected(Diagnostic{.error = fail(code, rule).value(), .detail = std::move(detail)});
}

tl::expected<void, Diagnostic> check_options(const FillOptions& options) {
  const bool volume = options.max_volume == 0 || (std::isfinite(options.max_volume) && options.max_volume > 0);
  const bool quality = options.quality == 0 || (std::isfinite(options.quality) && options.quality >= 1.1);
  if (!volume || !quality || !(options.time_limit > 0)) return unfilled(Errc::invalid_argument, "R-TGN-7", "");
  return {};
}

tl::expected<void, Diagnostic> check_positions(const TriMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t v) {
    const Vec3& p = mesh.vertices[v];
    return std::array{p.x, p.y, p.z};
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  const auto twice =
      std::adjacent_find(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) == key(b); });
  if (twice != order.end())
    return unfilled(Errc::invalid, "R-TGN-8", "vertices " + std::to_string(twice[0]) + " and " + std::to_string(twice[1]));
  return {};
}

tl::expected<void, Diagnostic> check_volume(const TriMesh& mesh, const FillOptions& options) {
  TACTUS_TRY(const auto solid, solid_within(mesh));
  if (options.max_volume > 0 && solid.volume / options.max_volume > static_cast<double>(kMaxTets))
    return unfilled(Errc::limit_exceeded, "R-TGN-5", "");
  return {};
}

/// p: a surface, Y: which stays as it is, z: numbers from 0, S: at most so many new points, q and a: quality and volume.
std::string fill_switches(const FillOptions& options) {
  std::array<char, 32> digits{};
  const auto text = [&](double value) {
    return std::string(digits.data(),
                       std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::scientific).ptr);
  };
  std::string switches = std::string(options.boundary == Boundary::keep ? "-pYzS" : "-pzS") + std::to_string(kMaxMeshVertices);
  if (options.quality > 0) switches += "q" + text(options.quality);
  if (options.max_volume > 0) switches += "a" + text(options.max_volume);
  return switches;
}

/// "Facet #3 intersects facet #5 at triangles:", counted from 1; empty if no facet is named.
std::string first_two_facets(const std::string& words) {
  std::array<std::string, 2> found;
  std::size_t at = 0;
  for (std::string& number : found) {
    at = words.find("acet #", at);
    if (at == std::string::npos) return {};
    at += 6;
    std::uint32_t facet = 0;
    if (std::from_chars(words.data() + at, words.data() + words.size(), facet).ec != std::errc() || facet == 0) return {};
    number = std::to_string(facet - 1);
  }
  return "triangles " + found[0] + " and " + found[1];
}

std::string last_line(const std::string& words) {
  std::istringstream lines(words);
  std::string line, last;
  while (std::getline(lines, line))
    if (!line.empty()) last = line;
  return last;
}

/// Runs the program in its folder, within the time limit of the whole task.
class TetGen {
 public:
  TetGen(const FillOptions& options, const fs::path& folder)
      : options_(options),
        folder_(folder),
        deadline_(std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                         std::chrono::duration<double>(std::min(options.time_limit, 1e6)))) {}

  tl::expected<ProgramResult, Diagnostic> run(const std::string& switches) const {
    auto result = run_program({options_.program, switches, "surface.smesh"}, folder_, deadline_);
    if (result) return *result;
    if (result.error() == ProgramFailure::not_there) return unfilled(Errc::unsupported, "R-TGN-1", options_.program);
    if (result.error() == ProgramFailure::too_long) return unfilled(Errc::limit_exceeded, "R-TGN-5", "");
    return unfilled(Errc::io, "R-TGN-6", "");
  }

  /// Why it failed. Its result does not say, but a second run can look for facets that cut each other.
  Diagnostic reason(const ProgramResult& failed) const {
    const auto asked = run("-dz");
    if (!asked) return asked.error();
    if (const std::string facets = first_two_facets(asked->words); !facets.empty())
      return unfilled(Errc::invalid, "R-TGN-3", facets).value();
    const std::string words = last_line(failed.words);
    return unfilled(Errc::io, "R-TGN-6", words.empty() ? options_.program : options_.program + " says '" + words + '\'').value();
  }

 private:
  const FillOptions& options_;
  const fs::path& folder_;
  std::chrono::steady_clock::time_point deadline_;
};

/// What to take away from the coordinates of a surface far from the origin; nothing near it.
Vec3 far_middle(const TriMesh& surface) {
  const Bounds box = bounds(surface.vertices);
  const Vec3 middle = 0.5 * (box.low + box.high);
  return norm(middle) > kFar * norm(box.high - box.low) ? middle : Vec3{};
}

/// Restore the bits of the surface's vertices: TetGen writes only 16 digits.
void restore_vertices(const TriMesh& surface, TetMesh& mesh) {
  const Bounds box = bounds(surface.vertices);
  const double near = kSamePosition * norm(box.high - box.low);
  for (std::size_t v = 0; v < std::min(surface.vertices.size(), mesh.vertices.size()); ++v)
    if (norm(mesh.vertices[v] - surface.vertices[v]) <= near) mesh.vertices[v] = surface.vertices[v];
}

tl::expected<void, Diagnostic> check_filled(const TriMesh& surface, const TetMesh& mesh) {
  if (const auto checked = check(mesh); !checked)
    return unfilled(checked.error().error.code, "R-TGN-6", to_string(checked.error()));
  double sum = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) sum += volume(mesh, t);
  const double wanted = solid_within(surface)->volume;
  if (std::abs(sum - wanted) <= kVolumeTolerance * wanted) return {};
  std::ostringstream figures;
  figures << sum << " m^3 filled, " << wanted << " m^3 enclosed";
  return unfilled(Errc::invalid, "R-TGN-9", figures.str());
}

}  // namespace

tl::expected<TetMesh, Diagnostic> fill(const TriMesh& surface, const FillOptions& options) {
  TACTUS_CHECK(check(surface));
  TACTUS_CHECK(check_options(options)
                   .and_then([&] { return check_closed(surface); })
                   .and_then([&] { return check_positions(surface); })
                   .and_then([&] { return check_volume(surface, options); }));

  const PrivateFolder folder;
  std::ofstream out(folder.path() / "surface.smesh", std::ios::binary);
  const Vec3 middle = far_middle(surface);
  TriMesh near = surface;
  for (Vec3& v : near.vertices) v = v - middle;
  write_smesh(out, near);
  out.close();
  if (!out) return unfilled(Errc::io, "R-TGN-6", "no room for temporary files");

  const TetGen tetgen(options, folder.path());
  TACTUS_TRY(const auto done, tetgen.run(fill_switches(options)));
  if (done.status != 0) return tl::unexpected(tetgen.reason(done));
  auto file = read_tet_mesh(folder.path() / "surface.1.ele");
  if (!file && file.error().error.code == Errc::limit_exceeded) return unfilled(Errc::limit_exceeded, "R-TGN-5", "");
  if (!file) return tl::unexpected(tetgen.reason(done));
  if (file->ignored_vertices > 0) return unfilled(Errc::io, "R-TGN-6", "vertices of no tetrahedron came out");
  restore_vertices(near, file->mesh);
  for (std::size_t v = 0; v < file->mesh.vertices.size(); ++v)
    file->mesh.vertices[v] = v < surface.vertices.size() && file->mesh.vertices[v] == near.vertices[v]
                                 ? surface.vertices[v]
                                 : file->mesh.vertices[v] + middle;
  TACTUS_CHECK(check_filled(surface, file->mesh));
  return std::move(file->mesh);
}

}  // namespace tactus::sim
