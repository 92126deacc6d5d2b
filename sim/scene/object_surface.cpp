// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/scene/object_surface.h>

#include <tactus/sim/surface/solid.h>
#include <tactus/sim/surface/surface_file.h>

namespace tactus::sim {

tl::expected<ObjectSurface, Diagnostic> read_object_surface(const std::string& file) {
  const auto refuse = [&](Diagnostic error) {
    error.file = file;
    return tl::unexpected(std::move(error));
  };
  auto read = read_surface(file);
  if (!read) return refuse(read.error());
  if (const auto closed = check_closed(read->mesh); !closed) return refuse(closed.error());
  const auto solid = solid_within(read->mesh);
  if (!solid) return refuse(solid.error());
  return ObjectSurface{std::move(read->mesh), solid->centroid};
}

}  // namespace tactus::sim
