// SPDX-License-Identifier: Apache-2.0
/// A user of the component modes: a basis for a square of two triangles.
#include <tactus/sim/modes/spring_modes.h>

#include <cstdio>

int main() {
  const tactus::TriMesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const auto modes = tactus::sim::spring_modes(square, {}, 3);
  if (!modes || modes->size() != 3 * 12) {
    std::puts("a square has no modes");
    return 1;
  }
  std::puts("modes of a square");
  return 0;
}
