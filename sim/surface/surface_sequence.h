// SPDX-License-Identifier: Apache-2.0
/// A mesh that moves, as a folder of surface files: one per frame, in the order of the numbers in their names ("f_-1" before "f2" before
/// "f10", "t=0.05" before "t=0.1"), the first is the shape at rest. Missing numbers keep their time. Hidden files, copies and files of other
/// kinds are left out with a note. Or as a glTF 2.0 scene with an animation of nodes, morph targets or skins, from which frames are taken one
/// period apart, from time 0 to the last key.
///
/// rule      class        broken when
/// R-SEQ-1   io           the folder cannot be read
/// R-SEQ-2   invalid      it holds no surface file, or such of more than one format
/// R-SEQ-3   unsupported  the files are STL, which does not say which vertex is which
/// R-SEQ-4   invalid      a frame has another number of vertices than the first, or other faces
/// R-SEQ-5   invalid      names differ in more than one number, have no number, or two have the same
/// R-SEQ-6   invalid      a glTF scene has several animations and none is chosen, or none of the name, or no such node with a mesh
/// R-SEQ-7   limit_exceeded  a glTF scene uses more than 2^25 numbers, or has more than 2^18 frames or 2^31 positions in all
/// R-SRF-n                a file is broken, see surface_file.h; triangles without area are refused in the first frame only
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <tactus/base/tri_mesh.h>
#include <tactus/sim/surface/surface_file.h>
#include <tactus/trace/read_notes.h>

namespace tactus::sim {

struct SequenceOptions {
  std::string series;            ///< form of the names to take, * stands for anything; empty: all
  bool drop_degenerate = false;  ///< leave out faces that have no area in the first frame
  Axes axes = Axes::as_the_format_says;
  std::string node{},
      animation{};           ///< of a glTF scene: what hangs on a node of this name, and its animation; empty: all, the only one
  double period = 1.0 / 60;  ///< [s] between frames of a glTF scene
};

class GltfScene;

class SurfaceSequence {
 public:
  /// Find the files and read the first, or read the scene.   in  path  folder, or a .gltf or .glb   err  R-SEQ-1..3, R-SEQ-5..7, R-SRF-n
  static tl::expected<SurfaceSequence, Diagnostic> open(const std::string& path, const SequenceOptions& options = {});

  std::size_t size() const noexcept { return offsets_.size(); }
  /// Where a frame is: of a scene, the same file for all.
  const std::string& file(std::size_t frame) const noexcept { return files_[scene_ ? 0 : frame]; }
  /// When a frame comes, [frame periods] after the first.
  double offset(std::size_t frame) const noexcept { return offsets_[frame]; }
  const std::vector<ReadNote>& notes() const noexcept { return notes_.all(); }
  const TriMesh& rest() const noexcept { return rest_; }
  /// Positions of the vertices of rest(), [file's unit].   pre  frame < size().   err  R-SEQ-4, R-SRF-n
  tl::expected<std::vector<Vec3>, Diagnostic> positions(std::size_t frame) const;

 private:
  static tl::expected<SurfaceSequence, Diagnostic> open_scene(const std::string& path, const SequenceOptions& options);
  void take(SurfaceFile&& first);

  std::vector<std::string> files_;
  std::shared_ptr<const GltfScene> scene_;  // null: a folder
  double period_ = 0;
  bool turns_ = false;  // y up becomes z up
  std::vector<double> offsets_;
  ReadNotes notes_;
  std::vector<std::vector<std::uint32_t>> polygons_;  // of the first file
  std::size_t vertices_ = 0;                          // of the first file
  std::vector<std::uint32_t> used_;                   // which of them rest_ has
  TriMesh rest_;
};

}  // namespace tactus::sim
