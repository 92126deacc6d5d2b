// SPDX-License-Identifier: Apache-2.0
/// A sheet of triangles that is pushed about, and what a client sees of it against the hard bounds.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/mesh/graph.h>
#include <tactus/tactus.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus::testing {

/// nx x ny squares of 4 mm, two triangles each.
inline TriMesh sheet(std::uint32_t nx, std::uint32_t ny) {
  constexpr double kEdge = 0.004;
  TriMesh mesh;
  for (std::uint32_t j = 0; j <= ny; ++j)
    for (std::uint32_t i = 0; i <= nx; ++i) mesh.vertices.push_back({i * kEdge, j * kEdge, 0});
  for (std::uint32_t j = 0; j < ny; ++j) {
    for (std::uint32_t i = 0; i < nx; ++i) {
      const std::uint32_t a = j * (nx + 1) + i, b = a + nx + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  }
  return mesh;
}

struct SheetFrame {
  std::vector<float> displacements;  ///< [m] x y z of vertex 0 first
  std::optional<SurfaceTouch> touch;

  DeformableTruth truth() const { return {displacements, touch}; }
};

inline void set_vertex(std::vector<float>& displacements, std::size_t vertex, const Vec3& u) {
  displacements[3 * vertex] = static_cast<float>(u.x);
  displacements[3 * vertex + 1] = static_cast<float>(u.y);
  displacements[3 * vertex + 2] = static_cast<float>(u.z);
}
inline Vec3 vertex_of(std::span<const float> displacements, std::size_t vertex) {
  return {displacements[3 * vertex], displacements[3 * vertex + 1], displacements[3 * vertex + 2]};
}
/// The same displacement of every vertex.
inline std::vector<float> moved_by(std::size_t vertices, const Vec3& u) {
  std::vector<float> out(3 * vertices);
  for (std::size_t v = 0; v < vertices; ++v) set_vertex(out, v, u);
  return out;
}

/// A dent of 15 mm that walks over the sheet, rises and falls, and leaves it now and then.
class DentedSheet {
 public:
  DentedSheet(const TriMesh& mesh, std::uint32_t squares, double noise = 0) : mesh_(mesh), squares_(squares), noise_(noise) {}

  SheetFrame frame(std::int64_t k) {
    const double t = static_cast<double>(k) / 60, width = squares_ * 0.004;
    const Vec3 at{width * (0.5 + 0.35 * std::cos(1.9 * t)), width * (0.5 + 0.35 * std::sin(1.4 * t)), 0};
    const double depth = 0.015 * std::sin(2.7 * t);
    SheetFrame out{std::vector<float>(3 * mesh_.vertices.size()), {}};
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
      const Vec3& x = mesh_.vertices[v];
      const double d2 = ((x.x - at.x) * (x.x - at.x) + (x.y - at.y) * (x.y - at.y)) / (width * width);
      const double z = -std::max(depth, 0.0) * std::exp(-8 * d2);
      const Vec3 noise{normal_(random_), normal_(random_), normal_(random_)};
      set_vertex(out.displacements, v, Vec3{0.1 * z, 0.05 * z, z} + noise_ * noise);
    }
    if (depth > 0.001) {
      const auto i = static_cast<std::uint32_t>(at.x / 0.004), j = static_cast<std::uint32_t>(at.y / 0.004);
      out.touch = SurfaceTouch{2 * (j * squares_ + i), 500 * 0.3 * depth, 500};
    }
    return out;
  }

 private:
  const TriMesh& mesh_;
  std::uint32_t squares_;
  double noise_;
  std::mt19937_64 random_{7};
  std::normal_distribution<double> normal_;
};

/// A few smooth vectors, not orthogonal.
inline ModeBasis wave_basis(const TriMesh& mesh, std::uint32_t squares, std::size_t modes) {
  std::vector<double> vectors;
  const double width = squares * 0.004;
  for (std::size_t k = 0; k < modes; ++k) {
    const std::size_t along = 1 + k % 4, across = 1 + k / 4;
    for (const Vec3& x : mesh.vertices) {
      const double z =
          std::sin(3.1 * static_cast<double>(along) * x.x / width) * std::sin(3.2 * static_cast<double>(across) * x.y / width);
      vectors.insert(vectors.end(), {0.1 * z, 0.05 * z, z});
    }
  }
  return make_mode_basis(vectors, modes).value();
}

/// A scene of one deformable object at 60 ticks per second.
inline SceneSpec sheet_spec(const TriMesh& mesh, DeformableProfile profile = DeformableProfile::main,
                            const ModeBasis& basis = {}) {
  SceneSpec spec;
  spec.tick_rate = 60;
  DeformableObject object = make_deformable_object("sheet", mesh, spec.grid.position).value();
  object.profile = profile;
  object.basis = basis;
  spec.deformables.push_back(std::move(object));
  return spec;
}

/// Counts what breaks a bound on what a receiver shows of a scene's first deformable object.
class BoundWatch {
 public:
  BoundWatch(const Scene& scene, const DeformableThresholds& thresholds)
      : object_(scene.deformables[0]), position_(scene.grid.position), thresholds_(thresholds), rings_(object_) {}

  void look(const SheetFrame& frame, std::span<const Vec3i> shown) { look(frame, shown, thresholds_.visual); }
  /// At the area of interest alone.
  void look_at_area(const SheetFrame& frame, std::span<const Vec3i> shown) {
    look(frame, shown, std::numeric_limits<double>::infinity());
  }
  std::size_t broken() const { return broken_; }
  double worst() const { return worst_; }  ///< [m]

 private:
  void look(const SheetFrame& frame, std::span<const Vec3i> shown, double outside) {
    std::vector<double> bound(shown.size(), outside);
    if (frame.touch && thresholds_.weber_fraction) {
      const double h = haptic_threshold(thresholds_, *frame.touch);
      rings_.triangles_around(frame.touch->triangle, object_.rings);
      for (const std::uint32_t v : rings_.vertices()) bound[v] = std::min(thresholds_.visual, h);
    }
    const double grid = 0.8660255 * std::ldexp(1.0, -static_cast<int>(position_));
    for (std::size_t v = 0; v < shown.size(); ++v) {
      const double error = norm(to_metres(shown[v], position_) - vertex_of(frame.displacements, v));
      worst_ = std::max(worst_, error);
      if (!(error <= std::max(bound[v], grid))) ++broken_;
    }
  }

  DeformableObject object_;
  unsigned position_;
  DeformableThresholds thresholds_;
  Rings rings_;
  std::size_t broken_ = 0;
  double worst_ = 0;
};

/// Both ends of a stream of one deformable object. They must agree after every frame.
class SheetEnds {
 public:
  static constexpr std::size_t kSubstream = 1;

  explicit SheetEnds(const SharedScene& scene, const SenderOptions& options = {})
      : sender(Sender::create(scene, options).value()), receiver(Receiver::create(scene).value()) {}

  /// Packets are valid until the next frame.
  Result<std::span<const Packet>> encode(std::int64_t tick, const SheetFrame& frame) {
    const DeformableTruth truth = frame.truth();
    return sender.encode(tick, {.deformables = {&truth, 1}});
  }
  void send(std::int64_t tick, const SheetFrame& frame) {
    const auto sent = encode(tick, frame);
    ASSERT_TRUE(sent) << sent.error().rule << " at tick " << tick;
    for (const Packet& packet : *sent) deliver(packet, tick);
    agree(tick);
  }
  void deliver(const Packet& packet, std::int64_t tick) {
    const auto decoded = receiver.push(packet.number, packet.bytes);
    ASSERT_TRUE(decoded) << decoded.error().rule << " at tick " << tick;
    ASSERT_EQ(decoded->substream, packet.substream);
    ASSERT_EQ(decoded->number, packet.number);
    ASSERT_EQ(decoded->tick, tick);
    ASSERT_EQ(decoded->key, packet.key);
    ASSERT_EQ(decoded->vertices, packet.updates);
    bytes += packet.bytes.size();
    ++packets;
    ++layers[static_cast<std::size_t>(packet.layer)];
  }
  void agree(std::int64_t tick) const {
    ASSERT_EQ(receiver.state_hash(kSubstream), sender.state_hash(kSubstream)) << "at tick " << tick;
  }
  std::span<const Vec3i> shown(std::int64_t tick) { return receiver.replica().displacements(0, tick); }

  Sender sender;
  Receiver receiver;
  std::size_t bytes = 0, packets = 0;
  std::array<std::size_t, 3> layers{};  ///< packets by layer
};

/// Two rigid objects that move, a wall, and deformable ones of profile main in layers, of main with a basis, and of profile thesis.
inline SharedScene scene_of_every_kind(std::uint32_t squares, std::uint8_t span = 1) {
  const TriMesh mesh = sheet(squares, squares);
  return SceneBuilder(60)
      .rigid("cube")
      .rigid("wall", {}, {.dof = Dof::none})
      .rigid("slider", {}, {.dof = Dof::x})
      .deformable("layered", mesh, {.layered = true})
      .deformable("waves", mesh, {.basis = wave_basis(mesh, squares, 3)})
      .deformable("thesis", mesh, {.profile = DeformableProfile::thesis, .models_kept = true})
      .baselines(span)
      .build(kWithThesis)
      .value();
}

/// So many sheets of two triangles, and a rigid object with these degrees of freedom.
inline SharedScene scene_of_sheets(std::size_t deformables, std::uint8_t dof) {
  SceneSpec spec = sheet_spec(sheet(1, 1));
  spec.deformables.resize(deformables, spec.deformables[0]);
  for (std::size_t i = 0; i < deformables; ++i) spec.deformables[i].name = "sheet " + std::to_string(i);
  spec.objects.push_back({"box", dof, {}});
  return shared(std::move(spec));
}

}  // namespace tactus::testing
