// SPDX-License-Identifier: Apache-2.0
/// The surfaces of the vectors.
#include <array>
#include <map>

#include "conformance/make_vectors/deformable_build.h"

namespace tactus::conformance {
namespace {

/// Vertices by place in a lattice, numbered as they come.
class Lattice {
 public:
  explicit Lattice(std::int32_t size) : size_(size) {}

  std::uint32_t vertex(int x, int y, int z) {
    const auto [at, added] = numbers_.try_emplace({x, y, z}, static_cast<std::uint32_t>(shape.rest.size()));
    if (added) shape.rest.push_back({x * size_, y * size_, z * size_});
    return at->second;
  }
  /// A braced list, because the order in which arguments are evaluated is the compiler's.
  void quad(const std::array<std::uint32_t, 4>& c) {
    shape.triangles.push_back({c[0], c[1], c[2]});
    shape.triangles.push_back({c[0], c[2], c[3]});
  }

  Shape shape;

 private:
  std::int32_t size_;
  std::map<std::array<int, 3>, std::uint32_t> numbers_;
};

}  // namespace

Shape one_vertex() { return {{{7, -8, 9}}, {}}; }

Shape one_triangle() { return {{{0, 0, 0}, {4000, 0, 0}, {0, 4000, 0}}, {{0, 1, 2}}}; }

Shape sheet(int nx, int ny, std::int32_t size) {
  Lattice out(size);
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y)
      out.quad({out.vertex(x, y, 0), out.vertex(x + 1, y, 0), out.vertex(x + 1, y + 1, 0), out.vertex(x, y + 1, 0)});
  }
  for (std::size_t i = 0; i < out.shape.rest.size(); ++i)
    out.shape.rest[i][2] += static_cast<std::int32_t>(i * i % 7) * (size / 16);
  return out.shape;
}

Shape box(int nx, int ny, int nz, std::int32_t size) {
  Lattice out(size);
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y) {
      out.quad({out.vertex(x, y, 0), out.vertex(x, y + 1, 0), out.vertex(x + 1, y + 1, 0), out.vertex(x + 1, y, 0)});
      out.quad({out.vertex(x, y, nz), out.vertex(x + 1, y, nz), out.vertex(x + 1, y + 1, nz), out.vertex(x, y + 1, nz)});
    }
  }
  for (int z = 0; z < nz; ++z) {
    for (int x = 0; x < nx; ++x) {
      out.quad({out.vertex(x, 0, z), out.vertex(x + 1, 0, z), out.vertex(x + 1, 0, z + 1), out.vertex(x, 0, z + 1)});
      out.quad({out.vertex(x, ny, z), out.vertex(x, ny, z + 1), out.vertex(x + 1, ny, z + 1), out.vertex(x + 1, ny, z)});
    }
    for (int y = 0; y < ny; ++y) {
      out.quad({out.vertex(0, y, z), out.vertex(0, y, z + 1), out.vertex(0, y + 1, z + 1), out.vertex(0, y + 1, z)});
      out.quad({out.vertex(nx, y, z), out.vertex(nx, y + 1, z), out.vertex(nx, y + 1, z + 1), out.vertex(nx, y, z + 1)});
    }
  }
  return out.shape;
}

Shape flat_fan(int triangles) {
  Shape out;
  const auto count = static_cast<std::uint32_t>(triangles);
  for (int i = 0; i < triangles; ++i) out.rest.push_back({100 * i, 0, 0});
  for (int i = 0; i < triangles; ++i) out.rest.push_back({100 * i, 1, 0});
  out.rest.push_back({100 * triangles, 0, 0});
  for (std::uint32_t i = 0; i < count; ++i) out.triangles.push_back({i, count + i, 2 * count});
  return out;
}

Shape slivers(int triangles) {
  Shape out;
  for (int i = 0; i < triangles + 2; ++i) out.rest.push_back({10 * i, i % 2 == 0 ? 0 : 10000, i % 3});
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(triangles); ++i)
    out.triangles.push_back(i % 2 == 0 ? Triangle{i, i + 1, i + 2} : Triangle{i + 1, i, i + 2});
  return out;
}

Shape moved(Shape shape, const Vec3i& by) {
  for (Vec3i& p : shape.rest)
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] += by[axis];
  return shape;
}

Shape both(const Shape& a, const Shape& b) {
  Shape out = a;
  const auto first = static_cast<std::uint32_t>(a.rest.size());
  out.rest.insert(out.rest.end(), b.rest.begin(), b.rest.end());
  for (const Triangle& t : b.triangles) out.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return out;
}

}  // namespace tactus::conformance
