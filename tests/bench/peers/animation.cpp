// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/peers/animation.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>

#include <tactus/mesh/graph.h>
#include <tactus/trace/trace_file.h>
#include "tests/bench/peers/md3.h"

namespace tactus::peers {
namespace {

using Shape = std::vector<Vec3>;

double diagonal(std::span<const Shape> shapes) {
  Vec3 low = shapes[0][0], high = low;
  for (const Shape& shape : shapes) {
    for (const Vec3& p : shape) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  return norm(high - low);
}

struct Grid {
  GridBox box;
  unsigned bits;
};

std::vector<Vec3i> on_grid(const Shape& shape, double unit) {
  const auto nearest = [unit](double x) { return static_cast<std::int32_t>(std::floor(x / unit + 0.5)); };
  std::vector<Vec3i> out;
  out.reserve(shape.size());
  for (const Vec3& p : shape) out.push_back({nearest(p.x), nearest(p.y), nearest(p.z)});
  return out;
}

tl::expected<Animation, std::string> make_animation(std::vector<Triangle> triangles, const Shape& rest,
                                                    const std::vector<Shape>& frames, const Grid& grid) {
  const double size = grid.box == GridBox::rest ? diagonal({&rest, 1}) : diagonal(frames);
  const double unit = size / std::ldexp(1.0, static_cast<int>(grid.bits));
  if (!(unit > 0)) return tl::unexpected<std::string>("the rest shape is a point");
  Animation out{{}, std::move(triangles), on_grid(rest, unit), {}, {}};
  for (const Shape& frame : frames) {
    out.frames.push_back(on_grid(frame, unit));
    out.fine.push_back(on_grid(frame, unit / kFine));
    for (const Vec3i& p : out.frames.back())
      for (const std::int32_t c : p)
        if (std::abs(c) > 1 << 20) return tl::unexpected<std::string>("a vertex moves farther than 2^20 grid units");
  }
  return out;
}

tl::expected<Animation, std::string> read_md3(const std::string& path, const std::string& surface, const Grid& grid,
                                              std::size_t limit) {
  std::ifstream in(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (!in) return tl::unexpected<std::string>("cannot be read");
  auto model = parse_md3(bytes, surface);
  if (!model) return tl::unexpected(model.error());
  model->frames.resize(std::min(limit, model->frames.size()));
  return make_animation(std::move(model->triangles), model->frames[0], model->frames, grid);
}

tl::expected<Animation, std::string> read_trace(const std::string& path, const Grid& grid, std::size_t limit) {
  auto reader = TraceReader::open(path);
  if (!reader) return tl::unexpected<std::string>(reader.error().rule);
  if (reader->info().meshes.empty()) return tl::unexpected<std::string>("no mesh in the trace");
  const TriMesh& rest = reader->info().meshes[0].rest;
  std::vector<Shape> frames;
  TraceFrame frame;
  while (frames.size() < limit) {
    const auto more = reader->next(frame);
    if (!more) return tl::unexpected<std::string>(more.error().rule);
    if (!*more) break;
    if (!frame.meshes[0].updated) continue;
    Shape shape = rest.vertices;
    const std::vector<float>& u = frame.meshes[0].displacements;
    for (std::size_t v = 0; v < shape.size(); ++v) shape[v] = shape[v] + Vec3{u[3 * v], u[3 * v + 1], u[3 * v + 2]};
    frames.push_back(std::move(shape));
  }
  if (frames.empty()) return tl::unexpected<std::string>("no shape in the trace");
  return make_animation(rest.triangles, rest.vertices, frames, grid);
}

/// Vertex with the longest path.
std::uint32_t liveliest(const Animation& animation) {
  std::vector<double> path(animation.rest.size(), 0);
  for (std::size_t f = 1; f < animation.frames.size(); ++f) {
    for (std::size_t v = 0; v < path.size(); ++v) {
      const Vec3i &a = animation.frames[f - 1][v], &b = animation.frames[f][v];
      path[v] += norm(Vec3{double(b[0] - a[0]), double(b[1] - a[1]), double(b[2] - a[2])});
    }
  }
  return static_cast<std::uint32_t>(std::max_element(path.begin(), path.end()) - path.begin());
}

}  // namespace

tl::expected<Animation, std::string> read_animation(const std::string& input, GridBox box, unsigned bits, std::size_t limit) {
  const std::size_t colon = input.rfind(':');
  const std::string path = input.substr(0, colon);
  const std::string surface = colon == std::string::npos ? "" : input.substr(colon + 1);
  const bool md3 = std::filesystem::path(path).extension() == ".md3";
  auto out = md3 ? read_md3(path, surface, {box, bits}, limit) : read_trace(input, {box, bits}, limit);
  if (!out) return tl::unexpected(input + ": " + out.error());
  if (out->frames.size() < 16) return tl::unexpected(input + ": fewer than 16 frames");
  out->name = std::filesystem::path(path).stem().string() + (surface.empty() ? "" : ":" + surface);
  return out;
}

Animation patch_of(const Animation& whole, std::size_t count) {
  DeformableObject mesh;
  mesh.rest = whole.rest;
  mesh.triangles = whole.triangles;
  const Neighbours near = neighbours(mesh);
  constexpr std::uint32_t kOutside = 0xffffffff;
  std::vector<std::uint32_t> taken{liveliest(whole)}, number(whole.rest.size(), kOutside);
  number[taken[0]] = 0;
  const auto take = [&](std::uint32_t v) {
    if (number[v] != kOutside || taken.size() >= count) return;
    number[v] = static_cast<std::uint32_t>(taken.size());
    taken.push_back(v);
  };
  for (std::size_t i = 0; i < taken.size(); ++i) {
    for (const std::uint32_t n : near[taken[i]]) take(n);
    for (std::uint32_t v = 0; i + 1 == taken.size() && taken.size() < count && v < number.size(); ++v)
      take(v);  // another component
  }
  Animation out;
  out.name = whole.name;
  for (const Triangle& t : whole.triangles)
    if (std::ranges::none_of(t, [&](std::uint32_t v) { return number[v] == kOutside; }))
      out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  const auto pick = [&](const std::vector<Vec3i>& all) {
    std::vector<Vec3i> some;
    for (const std::uint32_t v : taken) some.push_back(all[v]);
    return some;
  };
  out.rest = pick(whole.rest);
  for (const auto& frame : whole.frames) out.frames.push_back(pick(frame));
  for (const auto& frame : whole.fine) out.fine.push_back(pick(frame));
  return out;
}

}  // namespace tactus::peers
