// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/surface_file.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <numeric>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/sim/surface/ear_clipping.h>
#include <tactus/sim/surface/gltf_scene.h>
#include <tactus/sim/surface/polygon_file.h>

namespace tactus::sim {
namespace {

constexpr std::size_t kMaxCorners = 1024;  // the search for a fan's first corner is quadratic
constexpr std::size_t kNamedCorners = 8;   // of a face, in an error

/// Twice the area, along the normal (Newell).
Vec3 polygon_normal(const std::vector<Vec3>& vertices, const Polygon& polygon) {
  Vec3 sum;
  const Vec3& origin = vertices[polygon[0]];
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum = sum + cross(vertices[polygon[i - 1]] - origin, vertices[polygon[i]] - origin);
  return sum;
}

std::string position_text(const Vec3& p) {
  std::string out = "(";
  for (const double c : {p.x, p.y, p.z}) {
    char digits[32];
    out.append(digits, std::to_chars(digits, digits + sizeof digits, c).ptr) += ' ';
  }
  out.back() = ')';
  return out;
}

/// Makes triangles of polygons. Errors name the file's own face, line and vertices.
class SurfaceMaker {
 public:
  SurfaceMaker(PolygonSoup&& soup, SurfaceOptions options) : soup_(std::move(soup)), options_(std::move(options)) {}

  tl::expected<SurfaceFile, Diagnostic> make() {
    for (std::size_t f = 0; f < soup_.polygons.size(); ++f) TACTUS_CHECK(check_corners(f));
    TACTUS_CHECK(number_vertices());
    for (std::size_t f = 0; f < soup_.polygons.size(); ++f) TACTUS_CHECK(append(f));
    if (degenerate_ > 0 && !options_.drop_degenerate) return degenerate();
    file_.dropped_faces = degenerate_;
    if (file_.mesh.triangles.empty()) return broken(Errc::invalid, "R-SRF-7", "no face has an area");
    if (degenerate_ > 0) drop_unused();
    file_.unused_vertices = soup_.vertices.size() - file_.mesh.vertices.size();
    auto checked = check(file_.mesh);
    if (!checked && checked.error().error.rule == std::string_view("R-SRF-13")) {
      split_fans();
      checked = check(file_.mesh);
    }
    if (!checked) return in_file(checked.error());
    file_.notes = std::move(soup_.notes);
    return std::move(file_);
  }

 private:
  tl::expected<void, Diagnostic> check_corners(std::size_t face) {
    const Polygon& polygon = soup_.polygons[face];
    const std::size_t vertices = soup_.vertices.size();
    const auto wrong = std::find_if(polygon.begin(), polygon.end(), [&](std::uint32_t v) { return v >= vertices; });
    if (wrong != polygon.end())
      return at_face(face, fail(Errc::invalid, "R-SRF-9").value(),
                     "no vertex " + number(*wrong) + " among " + std::to_string(vertices));
    if (polygon.size() < 3 || polygon.size() > kMaxCorners)
      return at_face(face, fail(Errc::invalid, "R-SRF-6").value(), std::to_string(polygon.size()) + " corners");
    return {};
  }

  /// Keep the vertices that faces use.
  tl::expected<void, Diagnostic> number_vertices() {
    number_.assign(soup_.vertices.size(), 0);
    for (const Polygon& polygon : soup_.polygons)
      for (const std::uint32_t v : polygon) number_[v] = 1;
    for (std::uint32_t v = 0; v < number_.size(); ++v) {
      if (number_[v] == 0) continue;
      if (!is_finite(soup_.vertices[v])) return at_vertex(v, fail(Errc::invalid, "R-SRF-8").value());
      number_[v] = static_cast<std::uint32_t>(file_.vertex.size());
      file_.vertex.push_back(v);
      file_.mesh.vertices.push_back(soup_.vertices[v]);
    }
    return {};
  }

  tl::expected<void, Diagnostic> append(std::size_t face) {
    Polygon polygon;
    for (const std::uint32_t v : soup_.polygons[face]) polygon.push_back(number_[v]);
    if (polygon.size() > 3) {  // a corner that is there twice in a row changes nothing
      polygon.erase(std::unique(polygon.begin(), polygon.end()), polygon.end());
      while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
      if (polygon.size() < soup_.polygons[face].size() && polygon.size() >= 3)
        soup_.notes.add("faces", "a corner that is there twice in a row counts once", "face " + std::to_string(face));
    }
    const std::vector<Vec3>& v = file_.mesh.vertices;
    if (polygon.size() < 3 || (polygon.size() == 3 && has_no_area(polygon)) ||
        (polygon.size() > 3 && polygon_normal(v, polygon) == Vec3{})) {
      if (degenerate_++ == 0) first_degenerate_ = face;
      return {};
    }
    if (polygon.size() == 3) {
      file_.mesh.triangles.push_back({polygon[0], polygon[1], polygon[2]});
    } else {
      if (!append_fan(polygon)) TACTUS_CHECK(append_ears(face, polygon));
      ++file_.polygons;
    }
    face_.resize(file_.mesh.triangles.size(), static_cast<std::uint32_t>(face));
    return {};
  }

  bool has_no_area(const Polygon& t) const {
    const std::vector<Vec3>& v = file_.mesh.vertices;
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return true;
    return cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]) == Vec3{};
  }

  /// Cut the polygon into a fan of triangles from the first corner where all of them face its way.   out  false: there is none
  bool append_fan(const Polygon& polygon) {
    TriMesh& mesh = file_.mesh;
    const std::size_t n = polygon.size();
    const Vec3 normal = polygon_normal(mesh.vertices, polygon);
    for (std::size_t first = 0; first < n; ++first) {
      const std::size_t start = mesh.triangles.size();
      for (std::size_t i = 1; i + 1 < n; ++i) {
        const Triangle t{polygon[first], polygon[(first + i) % n], polygon[(first + i + 1) % n]};
        const Vec3& origin = mesh.vertices[t[0]];
        if (dot(cross(mesh.vertices[t[1]] - origin, mesh.vertices[t[2]] - origin), normal) <= 0) break;
        mesh.triangles.push_back(t);
      }
      if (mesh.triangles.size() - start == n - 2) return true;
      mesh.triangles.resize(start);
    }
    return false;
  }

  tl::expected<void, Diagnostic> append_ears(std::size_t face, const Polygon& polygon) {
    std::vector<Vec3> positions;
    for (const std::uint32_t v : polygon) positions.push_back(file_.mesh.vertices[v]);
    const EarClipping ears(positions, polygon_normal(file_.mesh.vertices, polygon));
    const Error error = fail(Errc::invalid, "R-SRF-6").value();
    if (const auto crossing = ears.crossing()) {
      const auto edge = [&](std::size_t from) {
        const std::size_t ends[] = {from, (from + 1) % polygon.size()};
        std::string out;
        for (const std::size_t at : ends)
          out += (out.empty() ? "" : " to ") +
                 (soup_.first_number ? number(file_.vertex[polygon[at]]) : position_text(positions[at]));
        return out;
      };
      return at_face(face, error, "its edges " + edge(crossing->first) + " and " + edge(crossing->second) + " cross");
    }
    const auto triangles = ears.clip();
    if (!triangles) return at_face(face, error, corners(face));
    for (const auto& [a, b, c] : *triangles) file_.mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
    return {};
  }

  /// Give each fan of triangles around a vertex a vertex of its own: surfaces that touch at a point are apart there.
  /// pre  every edge belongs to two triangles at most, of opposite direction
  void split_fans() {
    TriMesh& mesh = file_.mesh;
    std::vector<std::size_t> fan(3 * mesh.triangles.size());  // of a corner: another one of the same fan, or itself
    std::iota(fan.begin(), fan.end(), std::size_t{0});
    const auto root = [&fan](std::size_t corner) {
      while (fan[corner] != corner) corner = fan[corner] = fan[fan[corner]];
      return corner;
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> leaving;  // edge: the corner that it leaves
    for (std::size_t i = 0; i < fan.size(); ++i) {
      const Triangle& t = mesh.triangles[i / 3];
      leaving[{t[i % 3], t[(i + 1) % 3]}] = i;
    }
    for (std::size_t i = 0; i < fan.size(); ++i) {
      const Triangle& t = mesh.triangles[i / 3];
      const auto beside = leaving.find({t[i % 3], t[(i + 2) % 3]});
      if (beside != leaving.end()) fan[std::max(root(i), root(beside->second))] = std::min(root(i), root(beside->second));
    }
    std::vector<bool> is_taken(mesh.vertices.size(), false);
    std::map<std::size_t, std::uint32_t> own;  // of fans behind the first
    for (std::size_t i = 0; i < fan.size(); ++i) {
      std::uint32_t& corner = mesh.triangles[i / 3][i % 3];
      if (root(i) != i) {
        if (const auto found = own.find(root(i)); found != own.end()) corner = found->second;
      } else if (!is_taken[corner]) {
        is_taken[corner] = true;
      } else {
        soup_.notes.add(
            "vertices", "one that joins parts of the surface at a point alone is split: each part has its own",
            soup_.first_number ? "vertex " + number(file_.vertex[corner]) : "at " + position_text(mesh.vertices[corner]));
        file_.vertex.push_back(file_.vertex[corner]);
        const Vec3 position = mesh.vertices[corner];
        mesh.vertices.push_back(position);
        corner = own[i] = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
      }
    }
  }

  /// Vertices that only dropped faces used.
  void drop_unused() {
    std::vector<std::uint32_t> number(file_.mesh.vertices.size(), 0);
    for (const Triangle& t : file_.mesh.triangles)
      for (const std::uint32_t v : t) number[v] = 1;
    std::uint32_t kept = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (number[v] == 0) continue;
      file_.mesh.vertices[kept] = file_.mesh.vertices[v];
      file_.vertex[kept] = file_.vertex[v];
      number[v] = kept++;
    }
    file_.mesh.vertices.resize(kept);
    file_.vertex.resize(kept);
    for (Triangle& t : file_.mesh.triangles)
      for (std::uint32_t& v : t) v = number[v];
  }

  // ==== errors ====

  std::string number(std::uint32_t vertex) const {
    return std::to_string(std::uint64_t{vertex} + soup_.first_number.value_or(0));
  }

  /// "vertices 1 1 2", as the file counts; positions where it does not.
  std::string corners(std::size_t face) const {
    const Polygon& polygon = soup_.polygons[face];
    std::string out = soup_.first_number ? "vertices" : "corners";
    for (std::size_t i = 0; i < std::min(polygon.size(), kNamedCorners); ++i)
      out += ' ' + (soup_.first_number ? number(polygon[i]) : position_text(soup_.vertices[polygon[i]]));
    return polygon.size() > kNamedCorners ? out + " ..." : out;
  }

  tl::unexpected<Diagnostic> at_face(std::size_t face, const Error& error, std::string detail) const {
    const std::uint64_t line = face < soup_.polygon_lines.size() ? soup_.polygon_lines[face] : 0;
    return tl::unexpected(Diagnostic{.error = error, .line = line, .kind = "face", .element = face, .detail = std::move(detail)});
  }

  tl::unexpected<Diagnostic> at_vertex(std::uint32_t vertex, const Error& error) const {
    const std::uint64_t line = vertex < soup_.vertex_lines.size() ? soup_.vertex_lines[vertex] : 0;
    return tl::unexpected(Diagnostic{
        .error = error, .line = line, .kind = "vertex", .element = vertex, .detail = position_text(soup_.vertices[vertex])});
  }

  tl::unexpected<Diagnostic> degenerate() const {
    std::string detail = corners(first_degenerate_);
    if (degenerate_ > 1) detail += ", the first of " + std::to_string(degenerate_);
    auto refused = at_face(first_degenerate_, fail(Errc::invalid, "R-SRF-10").value(), std::move(detail));
    refused.value().remedy =
        "Remove it or merge its vertices; `tactus mesh` and `tactus import mesh` leave such faces out with --drop-degenerate.";
    return refused;
  }

  /// What is wrong with the mesh, in the file's numbers.
  tl::unexpected<Diagnostic> in_file(const Diagnostic& error) const {
    const std::string_view kind = error.kind == nullptr ? "" : error.kind;
    if (kind == "triangle") return at_face(face_[error.element], error.error, corners(face_[error.element]));
    if (kind == "vertex") return at_vertex(file_.vertex[error.element], error.error);
    return tl::unexpected(error);
  }

  PolygonSoup soup_;
  SurfaceOptions options_;
  SurfaceFile file_;
  std::vector<std::uint32_t> number_, face_;  // file's vertex -> mesh's; triangle -> file's face
  std::size_t degenerate_ = 0, first_degenerate_ = 0;
};

}  // namespace

tl::expected<SurfaceFile, Diagnostic> make_surface(PolygonSoup&& soup, const SurfaceOptions& options) {
  return SurfaceMaker(std::move(soup), options).make();
}

namespace {

bool is_gltf(std::string_view format) noexcept { return format == ".gltf" || format == ".glb"; }

tl::expected<SurfaceFile, Diagnostic> read_scene(std::string bytes, const std::string& folder, const SurfaceOptions& options) {
  TACTUS_TRY(const auto scene, GltfScene::open(std::move(bytes), folder,
                                               {.node = options.node,
                                                .animation = {},
                                                .moves = false,
                                                .drop_degenerate = options.drop_degenerate,
                                                .axes = options.axes}));
  return scene.rest();
}

tl::expected<SurfaceFile, Diagnostic> make_turned(PolygonSoup&& soup, const SurfaceOptions& options) {
  if (options.axes == Axes::y_up)
    for (Vec3& v : soup.vertices) v = turned_up(v);
  return make_surface(std::move(soup), options);
}

}  // namespace

tl::expected<SurfaceFile, Diagnostic> parse_surface(std::string_view bytes, std::string_view format,
                                                    const SurfaceOptions& options) {
  if (is_gltf(format)) return read_scene(std::string(bytes), "", options);
  TACTUS_TRY(auto soup, parse_polygons(bytes, format));
  return make_turned(std::move(soup), options);
}

tl::expected<SurfaceFile, Diagnostic> read_surface(const std::string& path, const SurfaceOptions& options) {
  const auto named = [&](Diagnostic e) {
    if (e.file.empty()) e.file = path;
    return e;
  };
  if (is_gltf(surface_format(path))) {
    auto bytes = read_bytes(path);
    if (!bytes) return tl::unexpected(named(bytes.error()));
    return read_scene(std::move(*bytes), folder_of(path), options).map_error(named);
  }
  TACTUS_TRY(auto soup, read_polygons(path));
  return make_turned(std::move(soup), options).map_error(named);
}

}  // namespace tactus::sim
