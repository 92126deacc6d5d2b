// SPDX-License-Identifier: Apache-2.0
/// A byte that picks the format, then any bytes as a surface file: an error, or a mesh that check() finds nothing wrong with. From 128 on it
/// is a glTF scene, which also moves.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include <tactus/sim/surface/gltf_scene.h>
#include <tactus/sim/surface/surface_file.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<std::string_view, 4> kFormats{".obj", ".off", ".ply", ".stl"};
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  if (data[0] >= 0x80) {
    const auto scene = tactus::sim::GltfScene::open(std::string(text), "", {.node = {}, .animation = {}, .moves = true});
    if (scene && scene->positions(scene->duration() / 2).size() != scene->rest().mesh.vertices.size()) std::abort();
    if (!scene && to_string(scene.error()).find("R-") == std::string::npos) std::abort();
    return 0;
  }
  const auto file = tactus::sim::parse_surface(text, kFormats[data[0] % kFormats.size()]);
  if (file && (file->mesh.triangles.empty() || !check(file->mesh))) std::abort();
  if (!file && to_string(file.error()).find("R-") == std::string::npos) std::abort();
  return 0;
}
