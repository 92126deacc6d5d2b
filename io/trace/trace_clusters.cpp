// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_clusters.h>

#include <algorithm>
#include <utility>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/deformable/motion_clusters.h>

namespace tactus {
namespace {

/// So many shapes, or up to twice as many; fewer of large meshes, which would take long.
std::size_t shapes_of(const TraceDeformable& mesh) noexcept {
  constexpr std::size_t kLeast = 4, kMostVertices = 1 << 22;
  return std::clamp(kMostVertices / mesh.rest.vertices.size(), kLeast, kClusterShapes);
}

/// Every n-th shape, n doubled as often as it must be.
class EvenShapes {
 public:
  explicit EvenShapes(std::size_t least) : least_(least) {}
  void add(const std::vector<float>& shape) {
    if (seen_++ % stride_ != 0) return;
    if (shapes_.size() == 2 * least_) {
      for (std::size_t i = 1; i < least_; ++i) shapes_[i] = std::move(shapes_[2 * i]);
      shapes_.resize(least_);
      stride_ *= 2;
    }
    shapes_.push_back(shape);
  }
  const std::vector<std::vector<float>>& shapes() const noexcept { return shapes_; }

 private:
  std::vector<std::vector<float>> shapes_;
  std::size_t least_, seen_ = 0, stride_ = 1;
};

}  // namespace

Result<std::map<std::string, ClusterBasis>> find_clusters(TraceReader& reader, std::size_t count) try {
  const std::vector<TraceDeformable>& meshes = reader.info().meshes;
  std::vector<EvenShapes> shapes;
  shapes.reserve(meshes.size());
  for (const TraceDeformable& mesh : meshes) shapes.emplace_back(shapes_of(mesh));
  TraceFrame frame;
  while (true) {
    TACTUS_TRY(const bool more, reader.next(frame));
    if (!more) break;
    for (std::size_t i = 0; i < meshes.size(); ++i)
      if (frame.meshes[i].updated) shapes[i].add(frame.meshes[i].displacements);
  }
  std::map<std::string, ClusterBasis> out;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (shapes[i].shapes().empty()) continue;
    TACTUS_TRY(out[meshes[i].name], motion_clusters(meshes[i].rest, shapes[i].shapes(), count));
  }
  return out;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

}  // namespace tactus
