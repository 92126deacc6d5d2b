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
#include <string>
#include <vector>

#include <tactus/deformable/decoder.h>
#include <tactus/deformable/displacement.h>
#include <tactus/deformable/encoder.h>
#include <tactus/deformable/graph.h>

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
  std::vector<Vec3> displacement;
  std::optional<SurfaceTouch> touch;
};

/// A dent of 15 mm that walks over the sheet, rises and falls, and leaves it now and then.
class DentedSheet {
 public:
  DentedSheet(const TriMesh& mesh, std::uint32_t squares, double noise = 0) : mesh_(mesh), squares_(squares), noise_(noise) {}

  SheetFrame frame(std::int64_t k) {
    const double t = static_cast<double>(k) / 60, width = squares_ * 0.004;
    const Vec3 at{width * (0.5 + 0.35 * std::cos(1.9 * t)), width * (0.5 + 0.35 * std::sin(1.4 * t)), 0};
    const double depth = 0.015 * std::sin(2.7 * t);
    SheetFrame out;
    for (const Vec3& x : mesh_.vertices) {
      const double d2 = ((x.x - at.x) * (x.x - at.x) + (x.y - at.y) * (x.y - at.y)) / (width * width);
      const double z = -std::max(depth, 0.0) * std::exp(-8 * d2);
      out.displacement.push_back(Vec3{0.1 * z, 0.05 * z, z} +
                                 noise_ * Vec3{normal_(random_), normal_(random_), normal_(random_)});
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
    for (const Vec3& x : mesh.vertices) {
      const double z = std::sin(3.1 * (1 + static_cast<double>(k % 4)) * x.x / width) *
                       std::sin(3.2 * (1 + static_cast<double>(k / 4)) * x.y / width);
      vectors.insert(vectors.end(), {0.1 * z, 0.05 * z, z});
    }
  }
  return make_mode_basis(vectors, modes).value();
}

inline StreamHeader mesh_header(const TriMesh& mesh, DeformableProfile profile = DeformableProfile::main,
                                const ModeBasis& basis = {}) {
  StreamHeader header;
  header.tick_rate = 60;
  DeformableObject object = make_deformable_object("sheet", mesh, header.grid.position).value();
  object.profile = profile;
  object.basis = basis;
  header.meshes.push_back(object);
  return header;
}

/// Counts what breaks a bound on what the decoder shows.
class BoundWatch {
 public:
  BoundWatch(const StreamHeader& header, const DeformableThresholds& thresholds)
      : mesh_(header.meshes[0]), position_(header.grid.position), thresholds_(thresholds), rings_(mesh_) {}

  void look(const SheetFrame& frame, std::span<const DeformableDecoder::Displacement> shown) {
    look(frame, shown, thresholds_.visual);
  }
  /// At the area of interest alone.
  void look_at_area(const SheetFrame& frame, std::span<const DeformableDecoder::Displacement> shown) {
    look(frame, shown, std::numeric_limits<double>::infinity());
  }
  std::size_t broken() const { return broken_; }
  double worst() const { return worst_; }  ///< [m]

 private:
  void look(const SheetFrame& frame, std::span<const DeformableDecoder::Displacement> shown, double outside) {
    std::vector<double> bound(shown.size(), outside);
    if (frame.touch && thresholds_.weber_fraction) {
      const double h =
          *thresholds_.weber_fraction * std::max(frame.touch->force / frame.touch->stiffness, thresholds_.depth_floor);
      rings_.triangles_around(frame.touch->triangle, mesh_.rings);
      for (const std::uint32_t v : rings_.vertices()) bound[v] = std::min(thresholds_.visual, h);
    }
    const double grid = 0.8660255 * std::ldexp(1.0, -static_cast<int>(position_));
    for (std::size_t v = 0; v < shown.size(); ++v) {
      const double error = norm(to_metres(shown[v], position_) - frame.displacement[v]);
      worst_ = std::max(worst_, error);
      if (!(error <= std::max(bound[v], grid))) ++broken_;
    }
  }

  DeformableObject mesh_;
  unsigned position_;
  DeformableThresholds thresholds_;
  Rings rings_;
  std::size_t broken_ = 0;
  double worst_ = 0;
};

/// Both ends of a stream of one mesh. They must agree after every packet.
class MeshEnds {
 public:
  MeshEnds(const StreamHeader& header, const DeformableEncoderOptions& options)
      : encoder(DeformableEncoder::create(header, 0, options).value()), decoder(DeformableDecoder::create(header, 0).value()) {}

  void send(std::int64_t tick, const SheetFrame& frame) {
    const auto packet = encoder.encode(tick, frame.displacement, frame.touch);
    ASSERT_TRUE(packet) << packet.error().rule << " at tick " << tick;
    deliver(*packet, tick);
  }
  void deliver(const EncodedDeformablePacket& packet, std::int64_t tick) {
    if (packet.bytes.empty()) return;
    const auto decoded = decoder.decode(packet.bytes);
    ASSERT_TRUE(decoded) << decoded.error().rule << " at tick " << tick;
    ASSERT_EQ(decoded->tick, tick);
    ASSERT_EQ(decoded->updates, packet.updates);
    ASSERT_EQ(decoder.state_hash(), encoder.state_hash()) << "at tick " << tick;
    bytes += packet.bytes.size();
    ++packets;
    ++halves[static_cast<std::size_t>(packet.half)];
  }

  DeformableEncoder encoder;
  DeformableDecoder decoder;
  std::size_t bytes = 0, packets = 0;
  std::array<std::size_t, 3> halves{};  ///< packets by half
};

}  // namespace tactus::testing
