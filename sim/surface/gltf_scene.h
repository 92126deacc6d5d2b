// SPDX-License-Identifier: Apache-2.0
/// A glTF scene as one mesh that moves: what hangs on a node, joined, in the axes of the world. Rules: surface_file.h, surface_sequence.h.
/// Internal to the library.
#pragma once

#include <string>
#include <vector>

#include <tactus/sim/surface/gltf_file.h>
#include <tactus/sim/surface/polygon_file.h>
#include <tactus/sim/surface/surface_file.h>

namespace tactus::sim {

struct GltfOptions {
  std::string node;       ///< take what hangs on it; empty: everything
  std::string animation;  ///< its name; empty: the only one
  bool moves = false;     ///< an animation is looked for; else the shape is that without any
  bool drop_degenerate = false;
  Axes axes = Axes::as_the_format_says;
};

/// Corners of triangles that are alike in position and in what moves them are one vertex, as programs split vertices where normals or textures
/// differ. Positions between keys are those of the specification: lines, arcs, steps or cubic splines.
class GltfScene {
 public:
  /// in   folder  of the files that it names; empty: none
  /// err  R-SRF-1..14, R-SEQ-6, R-SEQ-7
  static tl::expected<GltfScene, Diagnostic> open(std::string bytes, const std::string& folder, const GltfOptions& options);

  const SurfaceFile& rest() const noexcept { return rest_; }  ///< the shape at time 0, and notes
  double duration() const noexcept { return duration_; }      ///< [s] time of the last key; 0: nothing moves
  /// Of the vertices of rest(), in the same order.   time O(vertices (morph targets + joints))
  std::vector<Vec3> positions(double time) const;

 private:
  struct Row {  // of a matrix of three rows
    Vec3 linear;
    double offset = 0;
  };
  using Affine = std::array<Row, 3>;

  struct Track {  // one channel: keys and what they hold
    std::size_t node = 0, width = 0;
    GltfPath path{};
    GltfInterpolation interpolation{};
    std::vector<double> times, values;
  };
  struct Influence {
    std::size_t joint = 0;  // of the skin
    double weight = 0;
  };
  struct Skin {
    std::vector<std::size_t> joints;
    std::vector<Affine> inverse_bind;
  };
  /// Vertices of one primitive under one node.
  struct Part {
    std::size_t node = 0;
    Index skin;  // of skins_
    std::vector<Vec3> base;
    std::vector<std::vector<Vec3>> targets;  // empty: moves nothing
    std::vector<Influence> influences;       // as many for each vertex
  };

  tl::expected<void, Diagnostic> choose_nodes(const std::string& name);
  tl::expected<void, Diagnostic> choose_animation(const GltfOptions& options);
  tl::expected<void, Diagnostic> add_track(const GltfChannel& channel);
  tl::expected<void, Diagnostic> add_mesh(std::size_t node);
  tl::expected<void, Diagnostic> add_primitive(std::size_t node, const GltfPrimitive& primitive);
  tl::expected<void, Diagnostic> add_influences(const GltfPrimitive& primitive, Part& part);
  tl::expected<void, Diagnostic> add_faces(const GltfPrimitive& primitive, std::size_t vertices, bool mirrored);
  tl::expected<std::vector<Vec3>, Diagnostic> read_positions(std::size_t accessor);
  tl::expected<void, Diagnostic> make_rest(const GltfOptions& options);
  std::vector<std::uint32_t> alike() const;
  template <class Use>
  void each_number(const Part& part, std::size_t vertex, Use use) const;

  Affine local(const GltfNode& node) const;
  std::vector<double> value_at(const Track& track, double time) const;
  std::vector<GltfNode> posed(double time) const;
  std::vector<Affine> world(const std::vector<GltfNode>& nodes) const;
  std::vector<Vec3> all_positions(double time) const;

  GltfFile file_;
  std::vector<std::size_t> order_;   // nodes, parents first
  std::vector<std::size_t> parent_;  // of each node; their number: none
  std::vector<bool> chosen_;
  std::vector<Affine> at_rest_;  // of each node
  std::vector<Track> tracks_;
  std::vector<Skin> skins_;
  std::vector<Part> parts_;
  std::vector<Polygon> polygons_;
  std::size_t vertices_ = 0, budget_ = std::size_t{1} << 25;
  bool turns_ = false;  // y up becomes z up
  double duration_ = 0;
  SurfaceFile rest_;
};

}  // namespace tactus::sim
