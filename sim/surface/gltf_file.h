// SPDX-License-Identifier: Apache-2.0
/// What a glTF 2.0 file says of shapes and how they move: Khronos, "glTF 2.0 Specification" (2021). Every reference is one that is there, every
/// view lies within its buffer; what accessors hold is read when it is asked for. Materials, textures, cameras, lights and extras are
/// passed over. Rules: surface_file.h. Internal to the library.
#pragma once

#include <array>
#include <list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/rule.h>
#include <tactus/sim/surface/surface_file.h>

namespace tactus::sim {

using Index = std::optional<std::size_t>;  ///< of an array of the file, from 0; nothing: the file has none

struct GltfView {
  std::string_view bytes;
  std::size_t stride = 0;  ///< 0: elements follow one another
};

/// Where `count` elements of `width` numbers lie.
struct GltfAccessor {
  Index view;  ///< nothing: all are 0
  std::size_t offset = 0, component = 0, count = 0, width = 0;
  bool normalized = false;
  struct Sparse {  ///< elements that replace others
    std::size_t count = 0, index_view = 0, index_offset = 0, index_component = 0, value_view = 0, value_offset = 0;
  };
  std::optional<Sparse> sparse;
};

struct GltfPrimitive {
  std::size_t mode = 4;
  Index indices, position;
  std::vector<Index> targets;                ///< displacements of each morph target
  std::vector<std::size_t> joints, weights;  ///< of the sets 0, 1, ...
};

struct GltfMesh {
  std::vector<GltfPrimitive> primitives;
  std::vector<double> weights;
};

struct GltfNode {
  std::string name;
  std::optional<std::array<double, 16>> matrix;  ///< column by column; else translation x rotation x scale
  Pose pose;
  Vec3 scale{1, 1, 1};
  Index mesh, skin;
  std::vector<std::size_t> children;
  std::vector<double> weights;
};

struct GltfSkin {
  std::vector<std::size_t> joints;
  Index inverse_bind_matrices;
};

enum class GltfPath { translation, rotation, scale, weights };
enum class GltfInterpolation { linear, step, cubic_spline };

struct GltfChannel {
  std::size_t node = 0, input = 0, output = 0;
  GltfPath path{};
  GltfInterpolation interpolation{};
};

struct GltfAnimation {
  std::string name;
  std::vector<GltfChannel> channels;
};

struct GltfFile {
  std::vector<GltfView> views;
  std::vector<GltfAccessor> accessors;
  std::vector<GltfMesh> meshes;
  std::vector<GltfNode> nodes;  ///< trees: each has at most one parent
  std::vector<GltfSkin> skins;
  std::vector<GltfAnimation> animations;
  std::vector<std::size_t> roots;  ///< of the scene that is shown
  std::list<std::string> held;     ///< bytes that views point to
  ReadNotes notes;
};

struct GltfChunks {
  std::string_view json, binary;  ///< binary: null if there is none
};
inline constexpr const char* kOldGltf =
    "Convert glTF 1.0 to 2.0, with gltf-pipeline -i FILE -o NEW.glb or by Blender's import and export.";
/// Of a GLB; of other bytes all is JSON.   err  R-SRF-3..5
tl::expected<GltfChunks, Diagnostic> split_chunks(std::string_view bytes, ReadNotes& notes);
/// Nothing: that is not base64.
std::optional<std::string> decode_base64(std::string_view text);
/// At most `size` bytes of a file beside the scene or below: no address, no way up, and no link that leads out.   err  R-SRF-1, R-SRF-3
tl::expected<std::string, Diagnostic> read_beside(const std::string& folder, std::string_view uri, std::size_t size);
/// Bytes of a number; 0: no such type.
std::size_t gltf_component_size(std::size_t component) noexcept;

/// in   folder  where files lie that it names; empty: it must bring all it needs
/// err  R-SRF-1..5
tl::expected<GltfFile, Diagnostic> parse_gltf(std::string bytes, const std::string& folder);

/// The numbers of an accessor, one element after another. Whole ones that are normalised become 0..1 or -1..1.
/// in   width  numbers per element; 0: any   in,out  budget  how many numbers may still be read
/// err  R-SRF-4 another width, R-SRF-5 outside its view, R-SEQ-7 more than the budget
tl::expected<std::vector<double>, Diagnostic> read_accessor(const GltfFile& file, std::size_t accessor, std::size_t width,
                                                            std::size_t& budget);

}  // namespace tactus::sim
