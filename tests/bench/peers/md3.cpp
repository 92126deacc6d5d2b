// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/peers/md3.h"

#include <algorithm>
#include <cstdint>

namespace tactus::peers {
namespace {

constexpr std::size_t kHeaderBytes = 108, kSurfaceBytes = 108;
constexpr std::size_t kMaxFrames = 1024, kMaxVertices = 4096, kMaxTriangles = 8192, kMaxSurfaces = 32;

/// Little-endian fields of a file; beyond its end they read as 0 and `ok` turns false.
struct Fields {
  std::string_view bytes;
  bool ok = true;

  std::uint32_t take(std::size_t at, std::size_t size) {
    if (at > bytes.size() || size > bytes.size() - at) {
      ok = false;
      return 0;
    }
    std::uint32_t out = 0;
    for (std::size_t i = size; i-- > 0;) out = out << 8 | static_cast<std::uint8_t>(bytes[at + i]);
    return out;
  }
  std::uint32_t u32(std::size_t at) { return take(at, 4); }
  double coordinate(std::size_t at) { return static_cast<std::int16_t>(take(at, 2)) / 64.0; }
};

struct Surface {
  std::string_view name;
  std::size_t frames = 0, vertices = 0, triangles = 0, triangle_at = 0, vertex_at = 0, bytes = 0;
};

Surface surface_at(Fields& in, std::size_t at) {
  Surface s;
  if (in.take(at, 1) == 0 && !in.ok) return s;
  s.name = in.bytes.substr(std::min(at + 4, in.bytes.size()), 64);
  s.name = s.name.substr(0, s.name.find('\0'));
  s.frames = in.u32(at + 72);
  s.vertices = in.u32(at + 80);
  s.triangles = in.u32(at + 84);
  s.triangle_at = at + in.u32(at + 88);
  s.vertex_at = at + in.u32(at + 100);
  s.bytes = in.u32(at + 104);
  return s;
}

/// err  false: an index is not that of a vertex, or the surface is cut
bool append(Fields& in, const Surface& s, Md3Model& model) {
  const auto shift = static_cast<std::uint32_t>(model.frames[0].size());
  for (std::size_t t = 0; t < s.triangles && in.ok; ++t) {
    Triangle corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = in.u32(s.triangle_at + 12 * t + 4 * k);
      if (corners[k] >= s.vertices) return false;
      corners[k] += shift;
    }
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]) model.triangles.push_back(corners);
  }
  for (std::size_t f = 0; f < model.frames.size() && in.ok; ++f) {
    for (std::size_t v = 0; v < s.vertices; ++v) {
      const std::size_t at = s.vertex_at + 8 * (f * s.vertices + v);
      model.frames[f].push_back({in.coordinate(at), in.coordinate(at + 2), in.coordinate(at + 4)});
    }
  }
  return in.ok;
}

}  // namespace

tl::expected<Md3Model, std::string> parse_md3(std::string_view bytes, std::string_view surface) {
  Fields in{bytes};
  if (bytes.size() < kHeaderBytes || bytes.substr(0, 4) != "IDP3" || in.u32(4) != 15)
    return tl::unexpected<std::string>("not an MD3 model of version 15");
  const std::size_t frames = in.u32(76), surfaces = in.u32(84);
  if (frames == 0 || frames > kMaxFrames || surfaces > kMaxSurfaces)
    return tl::unexpected<std::string>("more frames or surfaces than MD3 allows, or none");
  Md3Model model;
  model.frames.resize(frames);
  std::size_t at = in.u32(100);
  for (std::size_t i = 0; i < surfaces; ++i) {
    const Surface s = surface_at(in, at);
    if (!in.ok || s.frames != frames || s.vertices > kMaxVertices || s.triangles > kMaxTriangles || s.bytes < kSurfaceBytes)
      return tl::unexpected("surface " + std::to_string(i) + " is cut or larger than MD3 allows");
    if ((surface.empty() || surface == s.name) && !append(in, s, model))
      return tl::unexpected("surface " + std::to_string(i) + " is cut or names a vertex that is not there");
    at += s.bytes;
  }
  if (model.frames[0].empty()) return tl::unexpected<std::string>("no such surface");
  return model;
}

}  // namespace tactus::peers
