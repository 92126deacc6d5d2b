// SPDX-License-Identifier: Apache-2.0
/// A user of the component surface: a tetrahedron written to the file named, read again and measured.
#include <tactus/sim/surface/solid.h>
#include <tactus/sim/surface/surface_file.h>

#include <cmath>
#include <cstdio>

namespace {

const char* there_and_back(const char* file) {
  const tactus::TriMesh corner{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  if (!tactus::sim::write_surface(file, corner)) return "the file cannot be written";
  const auto read = tactus::sim::read_surface(file);
  if (!read || read->mesh.triangles != corner.triangles) return "other triangles came back";
  const auto solid = tactus::sim::solid_within(read->mesh);
  if (!solid || !(std::abs(solid->volume - 1.0 / 6) < 1e-12)) return "it encloses another volume";
  return nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  const char* complaint = argc == 2 ? there_and_back(argv[1]) : "name a file";
  std::puts(complaint ? complaint : "a surface, there and back");
  return complaint ? 1 : 0;
}
