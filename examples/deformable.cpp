// SPDX-License-Identifier: Apache-2.0
/// A sheet is pressed in the middle. One shape every 17 ms; the error is at most 0.3 mm everywhere, and below the haptic threshold near
/// the probe.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <tactus/tactus.h>

namespace {

constexpr std::uint32_t kSide = 20;  // squares
constexpr double kEdge = 0.005;      // [m]
constexpr std::int64_t kFrame = 17;  // ticks
constexpr double kStiffness = 500;   // [N/m] of the coupling between probe and surface

tactus::TriMesh sheet() {
  tactus::TriMesh mesh;
  for (std::uint32_t j = 0; j <= kSide; ++j)
    for (std::uint32_t i = 0; i <= kSide; ++i) mesh.vertices.push_back({i * kEdge, j * kEdge, 0});
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t a = j * (kSide + 1) + i, b = a + kSide + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  }
  return mesh;
}

/// Displacements [m], x y z of vertex 0 first.
std::vector<float> dent(const tactus::TriMesh& rest, double depth) {
  std::vector<float> out;
  const double middle = kSide * kEdge / 2;
  for (const tactus::Vec3& p : rest.vertices) {
    const double r = std::hypot(p.x - middle, p.y - middle);
    out.insert(out.end(), {0, 0, static_cast<float>(-depth * std::exp(-1500 * r * r))});
  }
  return out;
}

}  // namespace

int main() {
  const tactus::TriMesh rest = sheet();
  const auto scene = tactus::SceneBuilder().deformable("sheet", rest, {.frame_period = kFrame}).build();
  if (!scene) return std::printf("%s: %s\n", scene.error().object.c_str(), describe(scene.error())), 1;
  auto sender = tactus::Sender::create(*scene);
  auto receiver = tactus::Receiver::create(*scene);
  if (!sender || !receiver) return 1;
  std::size_t bytes = 0, frames = 0;
  double worst = 0;  // [m]
  for (std::int64_t tick = 0; tick < 3000; tick += kFrame, ++frames) {
    const double depth = 0.01 * std::sin(1e-3 * static_cast<double>(tick));
    const std::vector<float> shape = dent(rest, depth);
    tactus::DeformableTruth truth{.displacements = shape, .touch = {}};
    if (depth > 1e-3) truth.touch = {.triangle = kSide * (kSide + 1), .force = 0.3 * kStiffness * depth, .stiffness = kStiffness};
    const auto sent = sender->encode(tick, {.deformables = {&truth, 1}});
    if (!sent) return std::printf("%s\n", describe(sent.error())), 1;
    for (const tactus::Packet& packet : *sent) {
      bytes += packet.bytes.size();
      if (!receiver->push(packet.number, packet.bytes)) return 1;
    }
    const auto shown = receiver->displacements(0, tick);
    for (std::size_t v = 0; v < shown.size(); v += 3) {
      const tactus::Vec3 off{double{shown[v]} - shape[v], double{shown[v + 1]} - shape[v + 1],
                             double{shown[v + 2]} - shape[v + 2]};
      worst = std::max(worst, tactus::norm(off));
    }
  }
  std::printf("%zu shapes of %zu vertices in %zu bytes, at most %.3f mm off\n", frames, rest.vertices.size(), bytes, 1e3 * worst);
  return worst <= 3e-4 ? 0 : 1;
}
